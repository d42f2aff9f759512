//! Conoscopic map (viewing cone): colours and contrast from all directions, without spectra.

use papilio_colour::Lab;

use crate::result::ReferenceWhite;
use crate::scene::Scene;
use crate::setup::angle_index;
use crate::{DisplayError, RowErrors};

/// Directions of a conoscopic map: all combinations of `theta_deg` and `phi_deg`.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeGrid {
    /// Inclination and azimuth of the direction with which the colour of each state is compared, degrees; (0,
    /// 0) is the normal.
    pub reference_deg: [f64; 2],
    /// Inclinations, ascending, 0 to less than 90 degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, ascending, 0 to less than 360 degrees.
    pub phi_deg: Vec<f64>,
}

impl Default for ConeGrid {
    /// Inclinations from 0 to 89 in steps of 1 degree, azimuths in steps of 5 degrees.
    fn default() -> Self {
        Self {
            reference_deg: [0.0, 0.0],
            theta_deg: (0..90).map(f64::from).collect(),
            phi_deg: (0..72).map(|k| 5.0 * f64::from(k)).collect(),
        }
    }
}

impl ConeGrid {
    /// Returns the default directions for which all of the scene's field of view is above the
    /// horizon in air (in the medium of the scene's angles).
    ///
    /// # Errors
    /// If the scene's angles are in a glass whose index depends on wavelength.
    pub fn within(scene: &Scene) -> Result<Self, DisplayError> {
        let horizon_deg = (1.0 / angle_index(scene)?).asin().to_degrees();
        let mut grid = Self::default();
        grid.theta_deg.retain(|theta| theta + 0.5 * scene.viewer.field_deg < horizon_deg - 1e-9);
        Ok(grid)
    }
}

/// Conoscopic map: views from all directions of a [`ConeGrid`].
#[derive(Debug, Clone, PartialEq)]
pub struct ConeResult {
    /// Inclinations, degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    pub phi_deg: Vec<f64>,
    /// Inclination and azimuth of the direction with which the colour of each state is compared, degrees.
    pub reference_deg: [f64; 2],
    /// White of L*, a*, b* and the colour differences.
    pub reference_white: ReferenceWhite,
    /// Names of the drive states, in the order of the scenario.
    pub states: Vec<String>,
    /// One view for each direction, with theta varying fastest.
    pub views: Vec<ConeView>,
    /// Directed sources.
    pub lights: Vec<ConeLight>,
    /// Inclination and azimuth of the scenario's own views, degrees; an inclination may be negative.
    pub views_deg: Vec<[f64; 2]>,
    /// Number of nodes of the quadrature.
    pub nodes: u64,
    /// Largest relative discretisation error of Y over states and directions.
    pub discretisation_error: f64,
    /// Errors of Y of each state in each direction, `[direction][state]`, with directions as in `views`; 0
    /// where there is no value.
    pub row_errors: RowErrors,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// View from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeView {
    /// Y of white over Y of black.
    pub contrast_ratio: Option<f64>,
    /// Area of the red, green and blue states in u'v', % of the sRGB gamut.
    pub gamut_percent_srgb: Option<f64>,
    /// The same, % of the EBU gamut.
    pub gamut_percent_ebu: Option<f64>,
    /// States, in the order of the map.
    pub states: Vec<ConeState>,
}

/// Drive state viewed from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeState {
    /// Luminance factor (1: a perfect white in the same light); NaN where the diffuser was not
    /// measured, or too faint for adding.
    pub reflectance_factor_y: f64,
    /// Luminance, cd/m2; NaN in the same places.
    pub luminance_cd_m2: f64,
    /// CIE 1976 u'.
    pub u_prime: Option<f64>,
    /// CIE 1976 v'.
    pub v_prime: Option<f64>,
    /// u'v' distance from the same state viewed from the reference direction, which is the normal by default.
    pub uv_shift: Option<f64>,
    /// CIELAB: L*, a* and b*.
    pub lab: Option<Lab>,
    /// CIEDE2000 difference from the same state viewed from the reference direction.
    pub delta_e_2000: Option<f64>,
    /// CIE 1976 difference, Delta E*ab, from the same state viewed from the reference direction.
    pub delta_e_1976: Option<f64>,
}

/// Directed source, with its direction as specified in the scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeLight {
    /// Inclination, degrees; negative: towards phi + 180.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Angular radius, degrees; 0: collimated.
    pub radius_deg: f64,
}

impl ConeView {
    /// Returns a view of this number of states without values.
    pub(crate) fn unknown(states: usize) -> Self {
        let state = ConeState {
            reflectance_factor_y: f64::NAN,
            luminance_cd_m2: f64::NAN,
            u_prime: None,
            v_prime: None,
            uv_shift: None,
            lab: None,
            delta_e_2000: None,
            delta_e_1976: None,
        };
        Self {
            contrast_ratio: None,
            gamut_percent_srgb: None,
            gamut_percent_ebu: None,
            states: vec![state; states],
        }
    }
}

impl ConeResult {
    /// Checks that the error of each row is at most the allowed error, or the scenario's target if none is
    /// given.
    ///
    /// # Errors
    /// If a row exceeds the limit; the message names the worst rows.
    pub fn allowing(mut self, error: Option<f64>) -> Result<Self, DisplayError> {
        let (states, thetas) = (self.states.len().max(1), self.theta_deg.len().max(1));
        let name = |row: usize| {
            let (direction, state) = (row / states, row % states);
            let (theta, phi) = (self.theta_deg[direction % thetas], self.phi_deg[direction / thetas]);
            format!("theta {theta} deg, phi {phi} deg, state {}", self.states[state])
        };
        self.row_errors = std::mem::take(&mut self.row_errors).allow(error, "cone", name)?;
        Ok(self)
    }

    /// Returns the view from `theta_deg[theta]`, `phi_deg[phi]`; `None` if an index is out of range.
    pub fn view(&self, theta: usize, phi: usize) -> Option<&ConeView> {
        (theta < self.theta_deg.len()).then(|| self.views.get(phi * self.theta_deg.len() + theta)).flatten()
    }
}

//! The viewing cone: what is seen from every direction, kept as numbers of the eye (no spectra).

use crate::scene::Scene;
use crate::setup::angle_index;
use crate::{DisplayError, RowErrors};

/// The directions of a cone: the product of all `theta_deg` and `phi_deg`.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeGrid {
    /// Inclinations, ascending, 0 to less than 90 degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, ascending, 0 to less than 360 degrees.
    pub phi_deg: Vec<f64>,
}

impl Default for ConeGrid {
    /// Every degree from 0 to 89, every 5 degrees around.
    fn default() -> Self {
        Self {
            theta_deg: (0..90).map(f64::from).collect(),
            phi_deg: (0..72).map(|k| 5.0 * f64::from(k)).collect(),
        }
    }
}

impl ConeGrid {
    /// The default directions, those from which all of a scene's field of view lies above the
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

/// What is seen from every direction of a [`ConeGrid`].
#[derive(Debug, Clone, PartialEq)]
pub struct ConeResult {
    /// Inclinations, degrees.
    pub theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    pub phi_deg: Vec<f64>,
    /// Names of the drive states, in the order of the scenario.
    pub states: Vec<String>,
    /// One for each direction, theta fastest.
    pub views: Vec<ConeView>,
    /// Where the directed light comes from.
    pub lights: Vec<ConeLight>,
    /// Nodes of the quadrature.
    pub nodes: u64,
    /// The largest relative discretisation error of Y found, over states and directions.
    pub discretisation_error: f64,
    /// Of the Y of each state in each direction, `[direction][state]`, directions as in `views`; 0 where nothing was measured.
    pub row_errors: RowErrors,
    /// Remarks that the reader should see.
    pub warnings: Vec<String>,
}

/// What is seen from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeView {
    /// Y of white over Y of black.
    pub contrast_ratio: Option<f64>,
    /// Area of the red, green and blue states in u'v', % of sRGB's.
    pub gamut_percent_srgb: Option<f64>,
    /// The same, % of EBU's.
    pub gamut_percent_ebu: Option<f64>,
    /// One for each of the cone's states, in their order.
    pub states: Vec<ConeState>,
}

/// A state as seen from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeState {
    /// Luminous reflectance factor (1: a perfect white in the same light); NaN where nothing was measured.
    pub reflectance_factor_y: f64,
    /// Luminance, cd/m2; NaN where nothing was measured.
    pub luminance_cd_m2: f64,
    /// CIE 1976 u'.
    pub u_prime: Option<f64>,
    /// CIE 1976 v'.
    pub v_prime: Option<f64>,
    /// u'v' distance from the same state seen along the normal.
    pub uv_shift: Option<f64>,
}

/// A directed source, its direction as the scenario gives it.
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
    /// Of so many states, none of which is known.
    pub(crate) fn unknown(states: usize) -> Self {
        let state = ConeState {
            reflectance_factor_y: f64::NAN,
            luminance_cd_m2: f64::NAN,
            u_prime: None,
            v_prime: None,
            uv_shift: None,
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
    /// The cone, if no row's error is larger than the scenario's target or, if an error is allowed, than that.
    ///
    /// # Errors
    /// Names the worst rows.
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

    /// What is seen from `theta_deg[theta]`, `phi_deg[phi]`, if it is there.
    pub fn view(&self, theta: usize, phi: usize) -> Option<&ConeView> {
        (theta < self.theta_deg.len()).then(|| self.views.get(phi * self.theta_deg.len() + theta)).flatten()
    }
}

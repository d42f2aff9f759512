//! BSDF of a whole display at viewers that move with the light: each direction of the light has viewers of
//! its own.
//!
//! A lobe lies around the mirror direction. Where the viewers lie about that direction, too, values can be
//! interpolated between directions of the light, which values at fixed directions of the viewer cannot (their
//! peaks would be doubled). Grids of such viewers are [`HalfVectorGrid`](crate::HalfVectorGrid) and
//! [`RingGrid`](crate::RingGrid).

use crate::brdf::{BrdfGrid, BrdfTable, SameViewers};
use crate::{DisplayError, RowErrors};

/// Direction of a viewer, in air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewer {
    /// Cosine of the inclination.
    pub cos_theta_o: f64,
    /// Inclination, degrees.
    pub theta_o_deg: f64,
    /// Azimuth relative to that of the light: 0 (towards the light) to 180 (mirror direction) degrees, and to below 360 where the
    /// display depends on azimuth.
    pub dphi_deg: f64,
}

/// Cosine of the inclination below which a viewer (from 89.994 deg) is taken to be below the horizon. Such a
/// direction receives at most this fraction of what leaves along the normal of a Lambertian display.
pub(crate) const HORIZON_COS: f64 = 1e-4;

impl Viewer {
    /// Viewer in the direction of a unit vector, with the light at azimuth 0; `None` below the horizon.
    pub(crate) fn of_vector([x, y, z]: [f64; 3]) -> Option<Self> {
        Self::of_either_side([x, y.abs(), z])
    }

    /// The same, without its mirror image in the plane of incidence.
    pub(crate) fn of_either_side([x, y, z]: [f64; 3]) -> Option<Self> {
        let across = x.hypot(y);
        (z > HORIZON_COS).then(|| Self {
            cos_theta_o: z,
            theta_o_deg: across.atan2(z).to_degrees(),
            // Along the normal, the azimuth is arbitrary.
            dphi_deg: if across < 1e-9 { 0.0 } else { turned(y.atan2(x).to_degrees()) },
        })
    }
}

/// An azimuth from 0 to below 360 degrees.
fn turned(phi_deg: f64) -> f64 {
    if phi_deg < 0.0 { (phi_deg + 360.0).min(360.0 - 1e-9) } else { phi_deg }
}

/// Directions of a [`ViewerTable`].
pub trait ViewerGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    fn theta_i_deg(&self) -> &[f64];

    /// Azimuths of the light, ascending, degrees; none for a display that is isotropic in azimuth, whose light is at azimuth 0.
    fn phi_i_deg(&self) -> &[f64] {
        &[]
    }

    /// Returns the directions of the light, inclination and azimuth, degrees: all azimuths of the first inclination first.
    fn lights_deg(&self) -> Vec<[f64; 2]> {
        directions_of_light(self.theta_i_deg(), self.phi_i_deg())
    }

    /// Returns the different viewers of one direction of the light, by its number, and for each node of the
    /// grid the number of its viewer; `None` below the horizon.
    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>);
}

/// Directions of the light of these inclinations and azimuths, the azimuth fastest; without azimuths, at azimuth 0.
pub(crate) fn directions_of_light(theta_i_deg: &[f64], phi_i_deg: &[f64]) -> Vec<[f64; 2]> {
    let azimuths = if phi_i_deg.is_empty() { &[0.0] } else { phi_i_deg };
    theta_i_deg.iter().flat_map(|theta| azimuths.iter().map(|phi| [*theta, *phi])).collect()
}

/// Spectral BSDF of a display for each drive state, at the viewers of a grid `G`. A row has a direction of the
/// light and of a viewer; where each direction of the light has viewers of its own, they are those of
/// [`ViewerGrid::viewers`].
#[derive(Debug, Clone, PartialEq)]
pub struct ViewerTable<G> {
    /// The directions.
    pub grid: G,
    /// Wavelengths, nm.
    pub wavelength_nm: Vec<f64>,
    /// The drive states, in the order of the scenario.
    pub states: Vec<BrdfState>,
    /// Number of nodes of the quadrature.
    pub nodes: u64,
    /// Largest relative discretisation error.
    pub discretisation_error: f64,
    /// Errors of the luminous BRDF (in an equal-energy light), `[state][row]`.
    pub row_errors: RowErrors,
}

/// BSDF of one drive state.
#[derive(Debug, Clone, PartialEq)]
pub struct BrdfState {
    /// Name of the state.
    pub name: String,
    /// Scattered part, `dL_o/dE_i` in 1/sr, `[row][wavelength]` (the last fastest), rows by the directions of
    /// the light. Single precision, because the table is large and its errors exceed those of seven digits.
    pub brdf: Vec<f32>,
    /// Specular reflectance: fraction of a beam that leaves in the mirror direction, `[light][wavelength]`.
    pub specular: Vec<f64>,
    /// Directional-hemispherical reflectance, scattered and specular, `[light][wavelength]`.
    pub directional_hemispherical: Vec<f64>,
}

impl<G> ViewerTable<G> {
    /// Keeps the states of these numbers, in ascending order, with their errors.
    #[must_use]
    pub fn with_states(mut self, numbers: &[usize]) -> Self {
        self.discretisation_error = self.row_errors.keep_states(numbers, self.states.len());
        let all = self.states.into_iter().enumerate();
        self.states = all.filter(|(k, _)| numbers.contains(k)).map(|(_, state)| state).collect();
        self
    }

    /// The table, if all its numbers are finite.
    pub(crate) fn finite(self) -> Result<Self, DisplayError> {
        let mut states = self.states.iter();
        let finite = states.all(|BrdfState { brdf, directional_hemispherical, .. }| {
            brdf.iter().all(|value| value.is_finite())
                && directional_hemispherical.iter().all(|value| value.is_finite())
        });
        if finite { Ok(self) } else { Err(DisplayError::NotFinite) }
    }
}

impl ViewerTable<SameViewers> {
    /// The same table as one of fixed directions.
    pub(crate) fn of_grid(self) -> BrdfTable {
        BrdfTable {
            grid: self.grid.0,
            wavelength_nm: self.wavelength_nm,
            states: self.states,
            nodes: self.nodes,
            discretisation_error: self.discretisation_error,
            row_errors: self.row_errors,
        }
    }
}

impl<G: ViewerGrid> ViewerTable<G> {
    /// Returns what depends on the light alone, as a table without viewers: specular and
    /// directional-hemispherical reflectances.
    pub fn of_beams(&self) -> BrdfTable {
        let state = |state: &BrdfState| BrdfState {
            name: state.name.clone(),
            brdf: Vec::new(),
            specular: state.specular.clone(),
            directional_hemispherical: state.directional_hemispherical.clone(),
        };
        BrdfTable {
            grid: BrdfGrid {
                theta_i_deg: self.grid.theta_i_deg().to_vec(),
                phi_i_deg: self.grid.phi_i_deg().to_vec(),
                theta_o_deg: Vec::new(),
                dphi_deg: Vec::new(),
            },
            wavelength_nm: self.wavelength_nm.clone(),
            states: self.states.iter().map(state).collect(),
            nodes: self.nodes,
            discretisation_error: self.discretisation_error,
            row_errors: RowErrors { relative: Vec::new(), ..self.row_errors },
        }
    }

    /// Checks that the error of each row is at most the allowed error, or the scenario's target if none is
    /// given.
    ///
    /// # Errors
    /// If a row exceeds the limit; the message names the worst rows.
    pub fn allowing(mut self, error: Option<f64>) -> Result<Self, DisplayError> {
        let from = self.grid.lights_deg();
        let lights: Vec<Vec<Viewer>> = (0..from.len()).map(|light| self.grid.viewers(light).0).collect();
        let rows: usize = lights.iter().map(Vec::len).sum();
        let name = |row: usize| {
            let (state, mut rest) = (row / rows.max(1), row % rows.max(1));
            let mut light = 0;
            while rest >= lights[light].len() {
                rest -= lights[light].len();
                light += 1;
            }
            let viewer = lights[light][rest];
            let azimuth = azimuth_words(self.grid.phi_i_deg(), from[light][1]);
            format!(
                "state {}, theta_i {} deg{azimuth}, theta_o {:.1} deg, dphi {:.1} deg",
                self.states[state].name, from[light][0], viewer.theta_o_deg, viewer.dphi_deg
            )
        };
        self.row_errors = std::mem::take(&mut self.row_errors).allow(error, "BRDF", name)?;
        Ok(self)
    }
}

/// The azimuth of the light in the name of a row, where there is any.
pub(crate) fn azimuth_words(phi_i_deg: &[f64], phi_deg: f64) -> String {
    if phi_i_deg.is_empty() { String::new() } else { format!(", phi_i {phi_deg} deg") }
}

//! What results of a single view state about their light and their view: those of palettes and pictures.

use papilio_colour::colour_temperature;
use papilio_spectra::Spectrum;
use schemars::JsonSchema;
use serde::Serialize;

use crate::DisplayError;
use crate::result::{Illuminant, RunResult};
use crate::scene::{Scene, Viewer};

/// The light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct LightSummary {
    /// Illuminance, lx.
    pub illuminance_lx: f64,
    /// CIE 1931 x of a perfect white.
    pub x: f64,
    /// CIE 1931 y of a perfect white.
    pub y: f64,
    /// Correlated colour temperature, K; null far from the Planckian locus.
    pub colour_temperature_k: Option<f64>,
}

/// The view.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct SingleView {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
}

impl LightSummary {
    /// Describes the light of a scene by its result.
    pub(crate) fn of(scene: &Scene, result: &RunResult) -> Self {
        let Illuminant { ref radiance_of_white, x, y, .. } = result.illuminant;
        let white = Spectrum::from_values(radiance_of_white.clone());
        let colour_temperature_k = colour_temperature(&white, &scene.grid).map(|found| found.cct_k);
        Self { illuminance_lx: scene.lighting.illuminance_lx, x, y, colour_temperature_k }
    }
}

impl SingleView {
    /// Returns the only view.
    ///
    /// # Errors
    /// [`DisplayError::OneView`], with `what` is computed, if there are several.
    pub(crate) fn of(viewer: &Viewer, what: &'static str) -> Result<Self, DisplayError> {
        match (viewer.theta_deg.as_slice(), viewer.phi_deg.as_slice()) {
            ([theta_deg], [phi_deg]) => Ok(Self { theta_deg: *theta_deg, phi_deg: *phi_deg }),
            (theta, phi) => Err(DisplayError::OneView { what, views: theta.len() * phi.len() }),
        }
    }
}

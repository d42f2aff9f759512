//! The synthetic samples of the project.
//!
//! Three diffusers like H65, H78 and H81 of the dissertation (Feng 2012, sections 3.3 and 5.4), whose files
//! are not public. They are k-correlation lobes of given haze, with a total transmittance of 0.90 and an edge
//! in the near ultraviolet, `1/(1 + exp(-(lambda - 392 nm)/7 nm))`, as in figure 3.10. The peaks in figures
//! 3.8 and 5.16 are lower than those of lobes of that haze. An instrument blur of 0.0483 in direction cosines
//! explains the difference; see [`SyntheticSample::instrument`].

use papilio_optics::lobe::{Lobe, width_from_haze};
use papilio_optics::{Beta, Scatterer};

use super::{Instrument, View};
use crate::{GoniometryError, Measurement, ScatterMode};

/// Instrument blur that reproduces the published peaks, direction cosines.
const BLUR: f64 = 0.0483;
const TOTAL: f64 = 0.90;
const EDGE_NM: f64 = 392.0;
const EDGE_WIDTH_NM: f64 = 7.0;

/// Diffuser with an exactly known BTDF.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SyntheticSample {
    /// Haze, 0 to 1.
    pub haze: f64,
    /// Width of the k-correlation lobe, direction cosines.
    pub width: f64,
    /// Total transmittance at normal incidence, at wavelengths beyond the edge.
    pub total_transmittance: f64,
}

impl SyntheticSample {
    /// Sample of given haze; the project includes data for 0.65, 0.78 and 0.81.
    ///
    /// # Errors
    /// If no k-correlation lobe has this haze.
    pub fn new(haze: f64) -> Result<Self, GoniometryError> {
        let expected = "above 0 and below 1";
        let error = GoniometryError::OutOfRange { what: "the haze", value: haze, expected };
        let width = width_from_haze(haze, 0.0).ok_or(error)?;
        Ok(Self { haze, width, total_transmittance: TOTAL })
    }

    /// Name: `H78 (synthetic)`.
    pub fn name(&self) -> String {
        format!("H{:.0} (synthetic)", 100.0 * self.haze)
    }

    /// f, 1/sr, at wavelengths beyond the edge.
    pub fn btdf(&self, from: Beta, to: Beta) -> f64 {
        let lobe = Lobe::KCorrelation { width: self.width };
        self.total_transmittance / lobe.hemispherical_fraction() * lobe.density(from, to)
    }

    /// Total transmittance at normal incidence and one wavelength, as measured by a spectroradiometer.
    pub fn transmission(&self, wavelength_nm: f64) -> f64 {
        self.total_transmittance * edge(wavelength_nm)
    }

    /// Instrument that reproduces the published peaks: the dissertation's grid with blur, renormalised.
    pub fn instrument() -> Instrument {
        Instrument { blur: BLUR, ..Instrument::imaging_sphere() }
    }

    /// Simulates a measurement; `factors` as from [`Self::factors`], one for each channel of the instrument.
    ///
    /// # Errors
    /// Those of [`Instrument::measure`].
    pub fn measured(&self, instrument: &Instrument, factors: &[f64]) -> Result<Measurement, GoniometryError> {
        let f = |from: Beta, to: Beta| self.btdf(from, to);
        let mut measurement = instrument.measure(
            &self.name(),
            &[View { way: ScatterMode::FrontTransmission, f: &f, straight: 0.0, factors }],
        )?;
        measurement.provenance.remarks.push(format!(
            "truth: k-correlation lobe, width {:.5} in direction cosines, total transmittance {}, \
             edge at {EDGE_NM} nm",
            self.width, self.total_transmittance
        ));
        Ok(measurement)
    }

    /// Returns the [`tristimulus_factors`] of the edge.
    pub fn factors(&self, wavelengths_nm: &[f64], light: &[f64], weights: [&[f64]; 3]) -> [f64; 3] {
        let spectrum: Vec<f64> = wavelengths_nm.iter().map(|nm| edge(*nm)).collect();
        tristimulus_factors(&spectrum, light, weights)
    }
}

fn edge(wavelength_nm: f64) -> f64 {
    1.0 / (1.0 + (-(wavelength_nm - EDGE_NM) / EDGE_WIDTH_NM).exp())
}

/// Returns the factors of X, Y and Z by a transmission or reflection spectrum, relative to the light's own:
/// `sum T S w/sum S w`. All arguments are on one grid of wavelengths; the weights are those of an observer.
pub fn tristimulus_factors(transmission: &[f64], light: &[f64], weights: [&[f64]; 3]) -> [f64; 3] {
    weights.map(|weight| {
        let both = transmission.iter().zip(light.iter().zip(weight));
        let [through, all] = both.fold([0.0; 2], |[through, all], (t, (light, weight))| {
            [through + t * light * weight, all + light * weight]
        });
        // A channel without light has a value of 0.
        if all > 0.0 { through / all } else { 0.0 }
    })
}

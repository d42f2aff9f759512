//! The synthetic samples that ship with the project.
//!
//! Three diffusers like the dissertation's H65, H78 and H81 (Feng 2012, sections 3.3 and 5.4), whose files
//! are not public: k-correlation lobes by haze, total transmittance .90, and an edge in the near
//! ultraviolet, `1/(1 + exp(-(lambda - 392 nm)/7 nm))`, as in figure 3.10. Their peaks in figures 3.8 and
//! 5.16 are lower than lobes of that haze can have. An instrument's blur of .0483 in direction cosines
//! reconciles them; see [`SyntheticSample::instrument`].

use papilio_optics::lobe::{Lobe, width_from_haze};
use papilio_optics::{Beta, Scatterer};

use super::{Instrument, View};
use crate::{GoniometryError, Measurement, Way};

/// Blur of the instrument that would have seen the published peaks, direction cosines.
const BLUR: f64 = 0.0483;
const TOTAL: f64 = 0.90;
const EDGE_NM: f64 = 392.0;
const EDGE_WIDTH_NM: f64 = 7.0;

/// A diffuser that is known exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SyntheticSample {
    /// Its haze, 0 to 1.
    pub haze: f64,
    /// Width of its k-correlation lobe, direction cosines.
    pub width: f64,
    /// Share of light of normal incidence that it transmits, beyond its edge.
    pub total_transmittance: f64,
}

impl SyntheticSample {
    /// By its haze: .65, .78 and .81 are those that ship.
    ///
    /// # Errors
    /// If no k-correlation lobe has that haze.
    pub fn new(haze: f64) -> Result<Self, GoniometryError> {
        let expected = "above 0 and below 1";
        let error = GoniometryError::OutOfRange { what: "the haze", value: haze, expected };
        let width = width_from_haze(haze, 0.0).ok_or(error)?;
        Ok(Self { haze, width, total_transmittance: TOTAL })
    }

    /// Its name: `H78 (synthetic)`.
    pub fn name(&self) -> String {
        format!("H{:.0} (synthetic)", 100.0 * self.haze)
    }

    /// f, 1/sr, beyond its edge.
    pub fn btdf(&self, from: Beta, to: Beta) -> f64 {
        let lobe = Lobe::KCorrelation { width: self.width };
        self.total_transmittance / lobe.hemispherical_fraction() * lobe.density(from, to)
    }

    /// Total transmittance at normal incidence, of one wavelength: what a spectroradiometer finds.
    pub fn transmission(&self, wavelength_nm: f64) -> f64 {
        self.total_transmittance * edge(wavelength_nm)
    }

    /// The instrument that finds its published peak: the dissertation's grid with blur, renormalised.
    pub fn instrument() -> Instrument {
        Instrument { blur: BLUR, ..Instrument::imaging_sphere() }
    }

    /// What an instrument finds; `factors` as [`Self::factors`] gives them, one for each of its channels.
    ///
    /// # Errors
    /// As [`Instrument::measure`].
    pub fn measured(&self, instrument: &Instrument, factors: &[f64]) -> Result<Measurement, GoniometryError> {
        let f = |from: Beta, to: Beta| self.btdf(from, to);
        let mut measurement = instrument
            .measure(&self.name(), &[View { way: Way::FrontTransmission, f: &f, straight: 0.0, factors }])?;
        measurement.provenance.remarks.push(format!(
            "truth: k-correlation lobe, width {:.5} in direction cosines, total transmittance {}, \
             edge at {EDGE_NM} nm",
            self.width, self.total_transmittance
        ));
        Ok(measurement)
    }

    /// [`tristimulus_factors`] of its edge.
    pub fn factors(&self, wavelengths_nm: &[f64], light: &[f64], weights: [&[f64]; 3]) -> [f64; 3] {
        let spectrum: Vec<f64> = wavelengths_nm.iter().map(|nm| edge(*nm)).collect();
        tristimulus_factors(&spectrum, light, weights)
    }
}

fn edge(wavelength_nm: f64) -> f64 {
    1.0 / (1.0 + (-(wavelength_nm - EDGE_NM) / EDGE_WIDTH_NM).exp())
}

/// What a spectrum of transmission (or reflection) does to X, Y and Z, each relative to the light's own:
/// `sum T S w/sum S w`. All on one grid of wavelengths; the weights are an observer's.
pub fn tristimulus_factors(transmission: &[f64], light: &[f64], weights: [&[f64]; 3]) -> [f64; 3] {
    weights.map(|weight| {
        let both = transmission.iter().zip(light.iter().zip(weight));
        let [through, all] = both.fold([0.0; 2], |[through, all], (t, (light, weight))| {
            [through + t * light * weight, all + light * weight]
        });
        // A channel without light sees nothing.
        if all > 0.0 { through / all } else { 0.0 }
    })
}

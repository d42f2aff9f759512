//! What lies under the last medium: the pixel.

use papilio_spectra::Spectrum;

use crate::{AngularTable, Medium};

/// What lies under the medium and sends light back.
#[derive(Debug, Clone, PartialEq)]
pub struct Base {
    /// How it reflects.
    pub reflector: Reflector,
    /// Absorptance of the inactive share of the panel, times that share, per wavelength.
    pub inactive_absorptance: Spectrum,
}

/// How a base reflects.
#[derive(Debug, Clone, PartialEq)]
pub enum Reflector {
    /// Like a mirror.
    Specular(AngularTable),
    /// The same basic radiance in every direction of the medium; shape `[state][wavelength]`.
    Lambertian(Vec<f64>),
}

impl Base {
    /// The number of wavelengths.
    pub fn bins(&self) -> usize {
        self.inactive_absorptance.len()
    }

    /// The number of states.
    pub fn states(&self) -> usize {
        match &self.reflector {
            Reflector::Specular(table) => table.state_count(),
            Reflector::Lambertian(reflectance) => reflectance.len() / self.bins(),
        }
    }

    /// The reflectance of every state at `|beta|^2`; `out` has shape `[state][wavelength]`.
    pub fn reflectance(&self, beta_squared: f64, medium: &Medium, out: &mut [f64]) {
        match &self.reflector {
            Reflector::Specular(table) => table.reflectance(beta_squared, medium, out),
            Reflector::Lambertian(reflectance) => out.copy_from_slice(reflectance),
        }
    }

    /// An upper bound of every state's reflectance at any angle.
    pub(crate) fn largest_reflectance(&self) -> f64 {
        // Side by side, as registers hold them: tables are large.
        let largest = |values: &[f64]| {
            let mut most = [0.0_f64; 16];
            for values in values.chunks(most.len()) {
                most.iter_mut()
                    .zip(values)
                    .for_each(|(most, value)| *most = if value > most { *value } else { *most });
            }
            most.into_iter().fold(0.0, f64::max)
        };
        match &self.reflector {
            Reflector::Specular(table) => (largest(&table.basis) + largest(&table.common)).min(1.0),
            Reflector::Lambertian(reflectance) => largest(reflectance).min(1.0),
        }
    }
}

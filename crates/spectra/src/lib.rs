//! Wavelength grids, spectra, dispersion (n + ik) and illuminants.

mod error;
mod grid;
mod illuminant;
mod spectrum;

pub use error::SpectraError;
pub use grid::Grid;
pub use illuminant::{daylight, illuminant, illuminant_names, ohno_led, planck};
pub use spectrum::{Spectrum, Tabulated};

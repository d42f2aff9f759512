//! Wavelength grids, spectra, dispersion (n + ik) and illuminants.

mod error;
mod grid;
mod spectrum;

pub use error::SpectraError;
pub use grid::Grid;
pub use spectrum::{Spectrum, Tabulated};

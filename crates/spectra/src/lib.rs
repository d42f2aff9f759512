//! Wavelength grids, spectra, dispersion (n + ik) and illuminants.

mod dispersion;
mod error;
mod grid;
mod illuminant;
mod material;
mod spectrum;

pub use dispersion::Dispersion;
pub use error::SpectraError;
pub use grid::Grid;
pub use illuminant::{daylight, illuminant, illuminant_names, ohno_led, planck};
pub use material::{material, material_names};
pub use spectrum::{Spectrum, Tabulated};

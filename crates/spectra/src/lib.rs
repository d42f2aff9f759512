//! Wavelength grids, spectra, dispersion (n + ik) and illuminants.
//!
//! - [`Grid`]: the wavelengths of one computation; [`Spectrum`]: a value at each,
//!   [`StateSpectra`]: one for each state of a pixel;
//! - [`Tabulated`]: a table from which spectra are interpolated, never extrapolated;
//! - [`Dispersion`]: the complex refractive index of a medium; [`material`]: named materials;
//! - [`illuminant`], [`daylight`], [`planck`], [`ohno_led`]: spectra of light; [`LightSpectrum`]: a light
//!   with narrow lines.
//!
//! ```
//! use papilio_spectra::{material, Grid};
//! let silica = material("SiO2")?;
//! let n_d = silica.index(587.5618)?.re;
//! assert!((n_d - 1.458464).abs() < 1e-6); // Malitson 1965
//! let visible = Grid::new(380.0, 780.0, 5.0)?;
//! assert_eq!(silica.on(&visible)?.len(), 81);
//! # Ok::<(), papilio_spectra::SpectraError>(())
//! ```
//!
//! **Limits.** Wavelengths are vacuum wavelengths in nm; indices are scalars (no
//! birefringence) and do not depend on temperature.
//!
//! **Out of scope.** File formats (`formats`), observers and colours (`colour`).

mod catalogue;
mod dispersion;
mod error;
mod grid;
mod illuminant;
mod light;
mod liquid_crystal;
mod material;
mod primaries;
mod spectrum;
mod state_spectra;
mod table;

pub use catalogue::MaterialInfo;
pub use dispersion::{Absorption, Dispersion, DispersionModel, OscillatorTerm, SellmeierTerm};
pub use error::SpectraError;
pub use grid::Grid;
pub use illuminant::{
    IlluminantInfo, daylight, illuminant, illuminant_info, illuminant_name, illuminant_names,
    illuminants_called, named_daylight_k, ohno_led, planck,
};
pub use light::{EveryNm, LightSpectrum};
pub use liquid_crystal::{LIQUID_CRYSTAL_RANGE_NM, LiquidCrystal, liquid_crystal, liquid_crystal_names};
pub use material::{material, material_info, material_names, materials_called};
pub use primaries::srgb_primaries;
pub use spectrum::{Spectrum, Tabulated, sum_of_products};
pub use state_spectra::StateSpectra;

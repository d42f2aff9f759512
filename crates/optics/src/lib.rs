//! Interfaces, coherent thin films and scattering lobes, in direction cosines.
//!
//! What a layer of a display does to light, each kind by itself; `transport` joins them.
//!
//! - [`interface`]: Fresnel's reflectances between transparent media;
//! - [`film`]: any stack of coherent thin layers, metals and evanescent waves included:
//!   [`film::coherent`] tells everything about one wavelength and direction,
//!   [`film::GapFilm`] the reflectances of very many, in a nanosecond each;
//! - [`scatterer`]: the interface of everything that scatters;
//! - [`lobe`]: the angular kernels of diffusers, with their densities and samplers;
//! - [`film::Coating`]: such films between two transparent media, tabulated over direction;
//! - [`rough`]: a rough face that sends light to both sides and loses none;
//! - [`scatter`]: scattering faces by numbers or formulas;
//! - [`phase`]: the phase function of scattering media;
//! - [`Beta`]: the direction cosines that all of them speak.
//!
//! ```
//! use papilio_optics::film::{coherent, Film, Layer, Polarisation};
//! use papilio_optics::interface::fresnel_reflectance;
//!
//! // Uncoated glass reflects 4.26 %; a quarter wave of MgF2 (1.38) leaves 1.26 %.
//! let bare = fresnel_reflectance(1.0, 1.52, 0.0);
//! let mgf2 = Layer { index: 1.38.into(), thickness_nm: 550.0 / (4.0 * 1.38) };
//! let film = Film { incidence: 1.0, layers: vec![mgf2], substrate: 1.52.into() };
//! let coated = coherent(&film, 550.0, 0.0, Polarisation::S)?.reflectance;
//! assert!((bare - 0.0426).abs() < 1e-4);
//! assert!((coated - 0.0126).abs() < 1e-4);
//! # Ok::<(), papilio_optics::OpticsError>(())
//! ```
//!
//! **Limits.** Flat (but for rough faces), homogeneous, isotropic layers; geometric optics outside the
//! films; the films keep s and p apart, lobes and layers take their mean.
//!
//! **Out of scope.** Stacks of layers that exchange light (`transport`), colour
//! (`colour`), where the indices come from (`spectra`), files and threads.

mod chebyshev;
mod direction;
mod error;
pub mod film;
pub mod interface;
pub mod lobe;
pub mod phase;
pub mod rough;
pub mod scatter;
pub mod scatterer;
mod wide;

pub use direction::{Beta, sine_of_inclination};
pub use error::OpticsError;
pub use scatterer::{Sample, Scatterer};
pub use wide::wide;

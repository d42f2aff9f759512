//! Interfaces, coherent thin films and scattering lobes, in direction cosines.
//!
//! The effect of each kind of layer on light, independent of the others; `transport` combines them.
//!
//! - [`interface`]: Fresnel reflectances between transparent media;
//! - [`film`]: any stack of coherent thin layers, metals and evanescent waves included:
//!   [`film::coherent`] computes all properties at one wavelength and direction,
//!   [`film::absorbed`] the absorptance of each layer,
//!   [`film::GapFilm`] the reflectances of very many, in a nanosecond each;
//! - [`berreman`]: stacks of anisotropic layers, coherent and thick: liquid crystals, retarders, polarisers;
//! - [`frank_oseen`]: the director of a liquid crystal at a voltage;
//! - [`scatterer`]: the interface of all scatterers;
//! - [`lobe`]: the angular kernels of diffusers, with their densities and samplers;
//! - [`film::Coating`]: such films between two transparent media, tabulated over direction;
//! - [`rough`]: a rough interface that scatters light to both sides without losses;
//! - [`RandomFace`]: statistics of a Gaussian random face;
//! - [`scatter`]: scattering interfaces given by tables or formulas;
//! - [`phase`]: phase functions and matrices of scattering media;
//! - [`Beta`]: the direction cosines that all of them use.
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
//! **Limits.** Flat (except for rough interfaces), homogeneous layers, isotropic except in `berreman`; geometric optics outside
//! the films; films are computed separately for s and p, lobes and layers for their mean.
//!
//! **Out of scope.** Stacks of layers that exchange light (`transport`), colour (`colour`), sources of the
//! indices (`spectra`), files and threads.

pub mod berreman;
mod chebyshev;
mod direction;
mod error;
pub mod film;
pub mod frank_oseen;
pub mod interface;
pub mod lobe;
pub mod phase;
pub mod quadrature;
mod random_face;
pub mod rough;
pub mod saunderson;
pub mod scatter;
pub mod scatterer;
mod simd;

pub use direction::{Beta, sine_of_inclination};
pub use error::OpticsError;
pub use random_face::RandomFace;
pub use scatterer::{Sample, Scatterer};
pub use simd::{clear_wide_registers, with_widest_simd};

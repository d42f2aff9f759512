//! Colorimetry of displays: from a spectral radiance to tristimulus values, colour differences and gamuts.
//!
//! The main types:
//!
//! - [`Observer`]: the CIE 1931 standard observer (2 degrees), or that of 1964 (10 degrees), on a wavelength
//!   grid. It converts spectra to [`Xyz`] and to luminance in cd/m2, and scales light to an illuminance in
//!   lx. [`spectral_locus`] draws chromaticity diagrams.
//! - [`Xyz`]: tristimulus values, from which [`Xy`], [`UvPrime`], [`Lab`] and sRGB colours are computed.
//! - [`gamut_percent`], [`coverage_percent`]: area and coverage of the triangle of three primaries in u'v' or
//!   xy, relative to sRGB, EBU, NTSC and DCI-P3.
//! - [`Corners`]: the colour gamut of eight states as a solid in CIELAB, with its volume and rings.
//! - [`Adaptation`]: complete chromatic adaptation from one white to another (CAT16).
//! - [`Oklab`]: lightness, chroma and hue of pictures, in which lines of constant hue are straight.
//! - [`mapping`]: gamut mapping, from a source picture's colours to those of a display, exactly or by a
//!   table.
//! - [`states`]: which colours mixtures of a display's states have, and with which coverages.
//! - [`Observer::smoothest`]: the smoothest reflectance spectrum of a colour.
//! - [`Viewing`]: the viewing conditions of the colour appearance model CIECAM16; [`Cam16Ucs`]: its uniform
//!   coordinates, and the colours that have them.
//! - [`colour_temperature`], [`rendering_index`]: correlated colour temperature and Ra of a light.
//! - [`reader`]: what a reader sees: luminance threshold of small details, contrast sensitivity of the eye,
//!   age.
//! - [`pictures`]: how much two pictures differ for a reader at a distance: S-CIELAB, FLIP.
//! - [`peak_nm`]: the wavelength at which a reflectance spectrum is largest.
//!
//! All functions are pure and cheap, because standard errors are computed by evaluating every
//! metric once per replicate. Slightly negative values (noise) are accepted, and a quantity that
//! is not defined is `None`.
//!
//! ```
//! use papilio_colour::Observer;
//! use papilio_spectra::{Grid, Spectrum, illuminant};
//!
//! let grid = Grid::new(380.0, 780.0, 5.0)?;
//! let observer = Observer::new(&grid)?;
//!
//! // Office light of 500 lx, and a perfect white in it: its radiance is the irradiance over pi.
//! let light = observer.scale_to_illuminance(&illuminant("D65", &grid)?, 500.0)?;
//! let white = light.map(|irradiance| irradiance / std::f64::consts::PI);
//! assert!((observer.luminance(&white) - 159.155).abs() < 1e-3); // cd/m2
//!
//! // D65 has u' = 0.1978, v' = 0.4683 (CIE 15:2018).
//! let white = observer.xyz(&white);
//! let uv = white.uv_prime().expect("the white has a chromaticity");
//! assert!((uv.u - 0.1978).abs() < 1e-4 && (uv.v - 0.4683).abs() < 1e-4);
//!
//! // A surface that reflects 18.42 % of this light has L* = 50.
//! let grey = light.map(|irradiance| 0.1842 * irradiance / std::f64::consts::PI);
//! let lab = observer.xyz(&grey).lab(white).expect("all tristimulus values of the white are positive");
//! assert!((lab.l - 50.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Limits.** The observers are tabulated from 380 to 780 nm; wavelengths of a grid outside this range are
//! ignored. **Out of scope.** Metrics of displays and their states, such as contrast: see `papilio-display`.

mod adaptation;
mod appearance;
mod cam16_ucs;
mod error;
mod gamut;
mod lab;
pub mod mapping;
mod matrix;
mod observer;
mod oklab;
mod peak;
pub mod pictures;
pub mod reader;
mod rendering;
mod smoothest;
mod solid;
mod srgb;
pub mod states;
mod xyz;

pub use adaptation::Adaptation;
pub use appearance::{Appearance, Surround, Viewing};
pub use cam16_ucs::Cam16Ucs;
pub use error::ColourError;
pub use gamut::{Chromaticity, GamutReference, coverage_percent, gamut_percent, triangle_area};
pub use lab::{Lab, Luv};
pub use observer::{Between, LUMENS_PER_WATT, Observer, Standard, spectral_locus};
pub use oklab::Oklab;
pub use peak::{peak_nm, peak_slopes};
pub use rendering::{ColourTemperature, colour_temperature, rendering_index};
pub use solid::{CORNERS, Corners, GamutSolid, HUES, RINGS};
pub use srgb::{ScreenSpace, decoded_byte, displayed, encoded_byte};
pub use xyz::{D65_UV, D65_WHITE, UvPrime, Xy, Xyz};

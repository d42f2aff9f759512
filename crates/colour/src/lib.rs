//! From a radiance spectrum to what an observer sees.
//!
//! A tour:
//!
//! - [`Observer`]: the CIE 1931 2 degree observer (or the 1964 10 degree one) on a wavelength grid; spectra become
//!   [`Xyz`], luminance in cd/m2, light of so many lux. [`spectral_locus`] for diagrams.
//! - [`Xyz`]: tristimulus values, and from them [`Xy`], [`UvPrime`], [`Lab`] and screen colours.
//! - [`gamut_percent`], [`coverage_percent`]: the u'v' triangle of three primaries against sRGB's, EBU's,
//!   NTSC's and DCI-P3's.
//! - [`Corners`]: the gamut of eight states as a solid in CIELAB, its volume and rings.
//! - [`Viewing`]: what a colour looks like in a room (CIECAM16).
//! - [`peak_nm`]: where a reflectance spectrum peaks.
//!
//! Everything is pure and cheap, because standard errors are found by computing every
//! metric once per replicate; slightly negative values (noise) are taken as they come,
//! and what is not defined is `None`.
//!
//! ```
//! use papilio_colour::Observer;
//! use papilio_spectra::{Grid, Spectrum, illuminant};
//!
//! let grid = Grid::new(380.0, 780.0, 5.0)?;
//! let observer = Observer::new(&grid)?;
//!
//! // Office light, and a perfect white in it: radiance is irradiance over pi.
//! let light = observer.scale_to_illuminance(&illuminant("D65", &grid)?, 500.0)?;
//! let white = light.map(|irradiance| irradiance / std::f64::consts::PI);
//! assert!((observer.luminance(&white) - 159.155).abs() < 1e-3); // cd/m2
//!
//! // D65 lies at u' = .1978, v' = .4683 (CIE 15:2018).
//! let white = observer.xyz(&white);
//! let uv = white.uv_prime().expect("a white has a chromaticity");
//! assert!((uv.u - 0.1978).abs() < 1e-4 && (uv.v - 0.4683).abs() < 1e-4);
//!
//! // A surface that reflects 18.42 % of it has L* = 50.
//! let grey = light.map(|irradiance| 0.1842 * irradiance / std::f64::consts::PI);
//! let lab = observer.xyz(&grey).lab(white).expect("a white has every colour");
//! assert!((lab.l - 50.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Limits.** Observers are tabulated from 380 to 780 nm; a grid is cut there.
//! **Out of scope.** What a colour means for a display (contrast, states), which is `papilio-display`'s.

mod appearance;
mod error;
mod gamut;
mod lab;
mod observer;
mod peak;
mod solid;
mod srgb;
mod xyz;

pub use appearance::{Appearance, Surround, Viewing};
pub use error::ColourError;
pub use gamut::{GamutReference, coverage_percent, gamut_percent, triangle_area};
pub use lab::{Lab, Luv};
pub use observer::{LUMENS_PER_WATT, Observer, Standard, spectral_locus};
pub use peak::{peak_nm, peak_slopes};
pub use solid::{CORNERS, Corners, GamutSolid, HUES, RINGS};
pub use xyz::{D65_UV, D65_WHITE, UvPrime, Xy, Xyz};

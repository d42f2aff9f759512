//! Pictures for a panel, on its pixels.
//!
//! - [`halftone`]: the state of each pixel of a picture, for a display with a few states.
//! - [`text`]: text from the outlines of a font as black and white pixels, with the middles of its strokes
//!   and gaps, or in the lines of a page.
//! - [`TestPattern`]: edges, stripes, squares and stars, with the fraction of each pixel that is black.
//! - [`Areas`]: drawings in a picture, flat areas and the text between them.
//! - [`guided`]: the smooth base of a picture, which follows its edges.
//! - [`push_halves`]: colours as numbers of 16 bits.
//!
//! ```
//! use papilio_imaging::text::{Font, Setting};
//!
//! let setting = Setting { size_pt: 10.0, per_inch: [300.0, 300.0], margin: 8 };
//! let bitmap = Font::bundled().bitmap("Papilio", setting)?;
//! let middles = bitmap.middles();
//! assert!(middles.strokes.iter().all(|pixel| bitmap.black[*pixel]));
//! # Ok::<(), papilio_imaging::ImagingError>(())
//! ```
//!
//! Bitmaps of text have their rows from the bottom, halftones from the top, as files of pictures; columns are
//! from the left.
//!
//! **Out of scope.** Shaping of complex scripts, kerning, hinting, fonts of the system.

mod error;
mod fit;
mod guided;
mod half;
pub mod halftone;
mod in_turn;
mod pattern;
mod regions;
pub mod text;

pub use error::ImagingError;
pub use fit::{Fit, fitted};
pub use guided::{guided, window_means};
pub use half::{half_bits, push_halves};
pub use in_turn::in_turn;
pub use pattern::TestPattern;
pub use regions::Areas;

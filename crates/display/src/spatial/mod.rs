//! Where light leaves: blur, crosstalk and sparkle of displays with thickness.
//!
//! [`mtf`] computes how sharp a display is. What a view sees of one light is a [`Response`]: its light by spatial frequency and
//! by place. One file for each kind of display implements it:
//!
//! | display | file |
//! |---|---|
//! | a lobe over mirror-like pixels | `lobe.rs` |
//! | Lambertian pixels under a flat face | `paper.rs` |
//! | mirror-like pixels under a flat face | `ghosts.rs` |
//!
//! Luminous quantities are Y relative to a perfect white in the scene's light, as in [`result`](crate::result).

mod curve;
mod ghosts;
mod lobe;
mod mtf;
mod paper;
mod profile;
mod response;
mod result;

pub use mtf::mtf;
use response::{Level, Response, Seen};
pub use result::{Curves, Kernel, LineContrast, MtfResult, MtfState, MtfView, SpatialScalars, SpreadTable};

//! Where light leaves: blur, crosstalk and sparkle of displays with thickness.
//!
//! [`mtf`] computes how sharp a display is. What a view sees of one light is a `Response`: its light by
//! spatial frequency and by place. One file for each kind of display implements it:
//!
//! | display | file |
//! |---|---|
//! | a lobe over pixels | `lobe.rs`; over mirror-like ones with light that a front returns, `returned.rs`, `meetings.rs`, `figures.rs` |
//! | Lambertian pixels under a flat face, or under a diffuser and a front | `paper.rs` |
//! | mirror-like pixels under a flat face | `ghosts.rs` |
//! | Lambertian pixels below general layers | `below_layers.rs` |
//!
//! `layered.rs` computes mirror-like pixels below general layers, by frequency alone.
//!
//! [`crosstalk`] computes which sub-pixel lights which.
//!
//! [`sparkle`] computes the random brightness of equal pixels below an antiglare face.
//!
//! [`picture`] computes X, Y and Z of each pixel of a picture whose light the face returns to it.
//!
//! `blur.rs` computes what a diffuser makes of a picture, `blur_walk.rs` what general layers make of it.
//!
//! [`walk`] is the second method, for all displays: Monte Carlo with places. `mtf_walk` computes from it what
//! [`mtf`] does.
//!
//! Luminous quantities are Y relative to a perfect white in the scene's light, as in
//! [`result`](crate::result).

mod below_layers;
mod bessel;
mod blur;
mod blur_walk;
mod bounds;
mod contrast;
mod crosstalk;
mod curve;
mod figures;
mod ghosts;
mod irradiance;
mod layered;
mod lobe;
mod measured;
mod meetings;
mod mtf;
mod mtf_walk;
mod paper;
mod patterns;
mod picture;
mod profile;
mod refused;
mod response;
mod result;
mod returned;
mod scalars;
mod series;
mod sparkle;
mod target;
pub mod walk;

pub use crate::metrics::{CrosstalkMetrics, SparkleMetrics};
pub use blur::PictureSurround;
pub(crate) use blur::{Blur, BlurredPicture};
pub use crosstalk::{
    CrosstalkResult, CrosstalkView, Figure, PatternColours, PatternValues, Shares, crosstalk,
};
pub use mtf::mtf;
pub(crate) use mtf::sharpness;
pub use papilio_sparkle::{Extent, Face, Relief, Tile};
pub use papilio_transport::spatial::{Cells, Precision};
pub use patterns::{PatternKind, PatternMean, Patterns};
pub(crate) use picture::LitPicture;
pub use picture::{Picture, PictureColours, picture};
pub(crate) use refused::Refused;
use response::{Level, Response, Seen};
pub use result::{
    Curves, Kernel, LineContrast, MtfResult, MtfState, MtfView, Sharpness, SharpnessMetrics, SpatialScalars,
    SpreadTable,
};
pub use sparkle::{Antiglare, SparkleMap, SparkleResult, SparkleRow, first_sparkle, sparkle};

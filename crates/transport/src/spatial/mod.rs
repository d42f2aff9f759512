//! Light and place: how far from where it entered light leaves again.
//!
//! A crossing of a medium (thickness d, index n) moves light that propagates with direction cosines beta by
//! `D(beta) = d beta / sqrt(n^2 - |beta|^2)` in the plane of the panel ([`displacement`]). Layers are
//! uniform, so that the response of the panel to a pattern is a convolution; its Fourier transform, at f
//! cycles per mm, replaces D by the phase `exp(-2 pi i f.D)`.
//!
//! - [`FaceReturn`]: light that a flat face returns to a Lambertian plane below it.
//! - [`LambertianReturn`]: the same with a front of screen above an air gap or a diffuser, for many
//!   frequencies.
//! - [`LayeredPaper`]: what a view sees of Lambertian pixels below general layers, and what returns to them.
//! - [`Spread`]: what a lobe over a mirror-like pixel shows of its places, to first order.
//! - [`PointSpread`]: the same by place: strips, rings and cells.
//! - [`LineSpread`]: its light along one axis, with exact transforms.
//! - [`FrontWays`]: light that a front of several components reflects to and fro.
//! - [`PanelSpread`]: what a view sees of the pixel plane of an ordinary panel, by the places of all
//!   directions.
//! - [`Recycling`]: a pattern of reflectances in this light, through all orders.
//! - [`LitPage`]: the same for pictures of many states, pixels and wavelengths.
//! - [`PixelSpread`]: light that spreads sideways inside Lambertian pixels.
//! - [`PixelSquare`], [`Shapes`]: kernels of pictures below a lobe.
//! - [`Window`]: sub-pixels in the period of a pixel, with exact areas; [`stripes`] and [`rows`] arrange
//!   them. What is seen of one through another: [`shares_by_transfer`].
//! - [`TwoPlanes`]: pixels below a colour filter at a height, through all orders.
//! - [`closed`]: closed forms of lobes and plates, a second method for all of these.
//!
//! Lengths are in mm, spatial frequencies in cycles per mm, both in the plane of the panel.

mod blur;
pub mod closed;
mod face;
mod fronts;
mod layered_paper;
mod layout;
mod line;
mod page;
mod panel_spread;
mod places;
mod recycling;
mod spread;
mod two_planes;

pub use crate::pixel_spread::PixelSpread;
pub use crate::window::{Rectangle, Window, shares_by_transfer};
pub use blur::{PixelSquare, Shapes};
pub use face::FaceReturn;
pub use fronts::{FrontWay, FrontWays, fraction_of_order, orders_between};
pub use layered_paper::LayeredPaper;
pub use layout::{rows, stripes};
pub use line::LineSpread;
pub use page::{LitPage, Page, PageLight, Precision};
pub use panel_spread::{LambertianReturn, PanelSpread, Part, SpreadError, air_below_front_mm};
pub use places::{Binned, Image, Peak, PointSpread};
pub use recycling::{Cells, Recycling};
pub use spread::{Accuracy, Gap, Light, Sample, Spread};
pub use two_planes::{
    Asked, Direction, Division, FilteredPixels, Passed, PeriodCells, Shown, TwoPlanes, diffuse_directions,
    diffused_directions, diffused_directions_of_field,
};

use papilio_optics::Beta;

/// Place at which light of these direction cosines leaves a medium, relative to where it entered, mm.
/// `|beta|` is below the index.
pub fn displacement(beta: Beta, thickness_mm: f64, index: f64) -> [f64; 2] {
    let per_beta = thickness_mm / (index * index - beta.squared()).sqrt();
    [beta.x * per_beta, beta.y * per_beta]
}

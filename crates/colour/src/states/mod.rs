//! Mixtures of the states of a display: which colours it can show, and with which coverage of each state.
//!
//! **What.** A display mixes its states by area: seen from a distance, the colour of a pattern is the mean of
//! the X, Y and Z of its states, weighted with their coverages (the states are the Neugebauer primaries of
//! print). All mixtures are the convex hull of the states.
//!
//! - [`StateHull`]: the hull of any states; also of greys, or of black, white and red, which have no volume.
//! - [`SubPixels`]: coverages of three independent sub-pixels; they are unique.
//! - [`LeastVariance`]: coverages of any states, with the least variance of luminance.

mod hull;
mod mixture;
mod span;
mod subpixels;
#[cfg(test)]
mod tests;

pub(crate) use hull::HalfSpace;
pub use hull::{StateHull, TOLERANCE};
pub(crate) use mixture::nearest_weights;
pub use mixture::{Coverages, LeastVariance};
pub use subpixels::SubPixels;

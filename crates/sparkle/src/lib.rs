//! Sparkle: random brightness of equal pixels below a rough face.
//!
//! **What.** A view ray that meets an antiglare face where its slope is m lands on the pixel plane at
//! `u = x - D(beta_v) + K m(x)`: the face is a random lens in front of every pixel. A pixel's light is the
//! mean over its area of the face, `N = mean of M(u(x)) V(x)`; M is 1 where the ray lands on lit windows of
//! the matrix, and V is the light that the pixel plane sends back along the ray. The *pixel power deviation*
//! (PPD) is the standard deviation of N over its mean, for pixels of equal state.
//!
//! Two causes. The *matrix* term: rays miss the windows. The *source* term: the light reaches the pixel
//! through the face, too, so that V varies where light comes from few directions. A uniform plane in uniform
//! light has no sparkle, since the face conserves radiance.
//!
//! - [`Plan`]: rays through random faces, the estimate that holds without restrictions;
//! - [`closed`]: the matrix term of Gaussian faces in closed form;
//! - [`Face`]: Gaussian heights, or a [`Relief`]: measured ones, and those of any other surface;
//! - [`Deflection`], [`Matrix`], [`Room`], [`Pupil`]: what they depend on.
//!
//! **Parameters.** Everything is in mm, the frequencies in cycles per mm. Sparkle depends on the product of
//! slope and distance, on the correlation length over the size of windows, on the aperture of the viewer, and
//! on the size of lamps.
//!
//! **Validity.** Geometric optics, within a few percent of wave optics where the correlation length ξ
//! satisfies `ξ² ≥ 0.5 λ d/n`. Small slopes: refraction is linear in the slope, and no ray meets the face
//! twice. Fresnel losses do not vary with the slope. The viewer's eye or camera resolves pixels and nothing
//! smaller. Light meets the face once on each way.
//!
//! **Sources.** M. E. Becker, J. Neumeier, "Optical Characterization of Scattering Anti-Glare Layers", SID
//! Digest 42, paper 70.4 (2011), for the quantity. The displacement follows from Snell's law at a tilted
//! face.

pub mod closed;
mod deflection;
mod faces;
mod grid;
mod matrix;
mod meetings;
mod plan;
mod relief;
mod replicate;
mod room;
mod statistics;
#[cfg(test)]
mod tests;

pub use deflection::{Deflection, Pupil};
pub use faces::FaceSampler;
pub use matrix::{Matrix, Window};
pub use plan::{Effort, Panel, Plan, SparkleError};
pub use relief::{Extent, Face, Relief, Tile};
pub use replicate::PixelLight;
pub use room::{Pixel, Room, Source};
pub use statistics::{Deviation, Moments, Sparkle, band_contrast};

//! Uniform numbers for Monte Carlo integration, and warps that convert them to directions.
//!
//! - [`SampleStream`]: the sample stream of one replicate: independent counter-based random numbers, or
//!   points of low-discrepancy and stratified sets ([`Sampler`]). A path requests blocks of four numbers by
//!   position. Its numbers depend on (seed, replicate, path, block) alone, not on threads or other paths.
//! - [`table_4_1`]: the gain from importance sampling and stratification, on an integral with known value.
//! - [`warp`]: maps from the unit square to discs and cones, each with its density.
//! - [`Distribution`]: probability distributions by quantile functions; [`Correlation`]: correlated numbers;
//!   [`erfc`] and its inverse, from which the normal distribution is computed.
//!
//! Limits: only the first [`PLANNED_BLOCKS`] blocks of a path are points of such sets; a longer
//! path continues with independent random numbers. Sobol points are one set of sixteen
//! dimensions. Stratified and best-candidate sets are two-dimensional and combined in random
//! order (padding). A set of best candidates has at most 4096 points; further paths use further sets.
//!
//! ```
//! use papilio_sampling::{SampleStream, Sampler};
//!
//! let numbers = SampleStream::new(Sampler::Sobol, 0, 7);
//! let mean = (0..4096).map(|path| numbers.block(path, 0)[0]).sum::<f64>() / 4096.0;
//! assert!((mean - 0.5).abs() < 1e-4);
//! ```

mod candidates;
mod copula;
mod distribution;
mod erf;
mod numbers;
mod sobol;
mod strata;
pub mod table_4_1;
pub mod warp;

pub use copula::{Coefficient, Correlation};
pub use distribution::Distribution;
pub use erf::{erfc, erfc_inv};
pub use numbers::{PLANNED_BLOCKS, SampleStream, Sampler};

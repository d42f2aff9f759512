//! Uniform numbers for Monte Carlo, and the warps that turn them into directions.
//!
//! - [`Numbers`]: the source of one replicate: independent counter-based random
//!   numbers, or points of better sets ([`Sampler`]). A path asks for blocks of four numbers
//!   by position, so its numbers depend on (seed, replicate, path, block) alone and
//!   never on which thread ran it or what other paths did.
//! - [`table_4_1`]: what importance and strata are worth, on an integral that all know.
//! - [`warp`]: maps from the unit square to discs and cones, each with its density.
//! - [`Distribution`]: even numbers as numbers that scatter as production does; [`Correlation`]: several that scatter
//!   together; [`erfc`] and its inverse, which the normal distribution is made of.
//!
//! Limits: only the first [`PLANNED_BLOCKS`] blocks of a path are points of such sets; a path
//! that lives longer goes on with independent random numbers. Sobol's are one set of sixteen
//! dimensions. Stratified and best-candidate sets are two-dimensional, and stand beside each other in random
//! order; a set of best candidates has at most 4096 points, then come others.
//!
//! ```
//! use papilio_sampling::{Numbers, Sampler};
//!
//! let numbers = Numbers::new(Sampler::Sobol, 0, 7);
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
pub use numbers::{Numbers, PLANNED_BLOCKS, Sampler};

//! A rough face between two transparent media (GGX), nothing lost.

use crate::Beta;

/// The side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// In the medium above.
    Above,
    /// In the medium below.
    Below,
}

/// A rough face.
#[derive(Debug, Clone, PartialEq)]
pub struct Rough {}

impl Rough {
    /// A face of this roughness between media of these indices.
    pub fn new(_alpha: f64, _above: f64, _below: f64) -> Self {
        Self {}
    }

    /// Density per unit area of `beta_o` on side `to`, for light that arrives with `beta_i` on
    /// side `from`: over both sides it integrates to one. Symmetric.
    pub fn density(&self, _from: Side, _beta_i: Beta, _to: Side, _beta_o: Beta) -> f64 {
        0.0
    }

    /// A side and direction drawn with [`Self::density`].
    pub fn sample(&self, from: Side, beta_i: Beta, _u: [f64; 4]) -> (Side, Beta) {
        (from, beta_i)
    }
}

//! A rough interface as a [`Scatterer`] to both sides.

use super::{Rough, Side};
use crate::Beta;
use crate::scatterer::{Sample, Scatterer};

/// A direction on one side of an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnSide {
    /// The side that the light is on.
    pub side: Side,
    /// Its direction of propagation.
    pub beta: Beta,
}

/// Lossless: the albedo is 1. Light is sampled in proportion to `evaluate`, within 1e-5 of the whole.
impl Scatterer for Rough {
    type Direction = OnSide;

    fn evaluate(&self, from: OnSide, to: OnSide) -> f64 {
        self.density(from.side, from.beta, to.side, to.beta)
    }

    fn sample(&self, from: OnSide, u: [f64; 4]) -> Option<Sample<OnSide>> {
        let (side, beta) = Rough::sample(self, from.side, from.beta, u);
        let to = OnSide { side, beta };
        let density = self.evaluate(from, to);
        (density > 0.0).then(|| Sample::exact(to, density))
    }

    fn density(&self, from: OnSide, to: OnSide) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, _: OnSide) -> f64 {
        1.0
    }
}

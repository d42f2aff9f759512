//! Directions half way between the view and a source.
//!
//! Between two lobes that fall as fast as Gaussians, light mostly travels in directions half way between the
//! view and the source: two lobes `exp(-r²/s²)` at a distance d have a product that is largest there,
//! `exp(-d²/(2 s²))`, whereas it is `exp(-d²/s²)` at the ends. A path, which samples from the view's end, and
//! a relay, which samples from the source's, rarely find these directions, and the variance of both grows
//! like `exp(d²/(4 s²))`. So relays sample a part of their directions from their kernel for light that would
//! arrive half way; the balance heuristic then uses the density of the mixture.
//!
//! Lobes with heavier tails do not need it: the product is largest at the ends.

use papilio_optics::Beta;

use super::scatterers::ScatterEvent;
use crate::{Cone, Source};

/// Fraction of the directions that are sampled from half way.
const FRACTION: f64 = 0.5;

/// Ratio of the kernel half way to its maximum above which the ends sample directions half way often enough.
const FAR: f64 = 0.05;

/// Directions half way that an event needs; usually none.
#[derive(Debug, Clone, Default)]
pub(super) struct HalfWay(Vec<Beta>);

impl HalfWay {
    /// Returns the directions that an event which relays light needs.
    pub(super) fn of(event: &ScatterEvent<'_>, view: Cone, sources: &[Source]) -> Self {
        let view = view.axis_towards();
        let needed = |source: &Source| {
            let from = source.direction()?;
            let middle = Beta { x: 0.5 * (from.x + view.x), y: 0.5 * (from.y + view.y) };
            let largest = event.density(middle, middle)?;
            let [half, whole] = [event.density(from, middle)?, event.density(from, view)?];
            (half < FAR * largest && half * half > largest * whole).then_some(middle)
        };
        Self(sources.iter().filter_map(needed).collect())
    }

    /// Chooses a direction, and replaces the number by one that is uniform again; `None`: the light's own.
    pub(super) fn choose(&self, u: &mut f64) -> Option<Beta> {
        if self.0.is_empty() {
            return None;
        }
        if *u >= FRACTION {
            *u = (*u - FRACTION) / (1.0 - FRACTION);
            return None;
        }
        let place = *u / FRACTION * self.0.len() as f64;
        *u = place.fract();
        self.0.get(place as usize).copied()
    }

    /// Returns the mean density from these directions, given that from one; `None` if there are no
    /// directions.
    pub(super) fn density(&self, from: impl Fn(Beta) -> Option<f64>) -> Option<f64> {
        let sum: f64 = self.0.iter().filter_map(|middle| from(*middle)).sum();
        (!self.0.is_empty()).then(|| sum / self.0.len() as f64)
    }
}

/// Returns the density of the mixture of the light's own kernel and those of light that arrives half way.
pub(super) fn mixed(own: f64, half_way: Option<f64>) -> f64 {
    half_way.map_or(own, |half_way| (1.0 - FRACTION) * own + FRACTION * half_way)
}

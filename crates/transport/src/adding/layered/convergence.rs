//! Convergence of the series of azimuthal orders.

use std::cmp::Ordering;

use super::base::Above;

/// Stage of the series of azimuthal orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// All light is computed.
    All,
    /// Light scattered more than once has converged; only light scattered once from a source towards a view
    /// is computed.
    Once,
    /// The rest is below the tolerance.
    Done,
}

/// Tests whether the azimuthal orders so far suffice between all views and sources.
pub(super) struct Convergence {
    views: Vec<usize>,
    /// Indices of lights that have more orders than the first.
    lights: Vec<usize>,
    /// Sums of the upper bounds of each order, by view and light.
    sums: Vec<f64>,
    /// Number of successive orders with negligible contributions, in total and by multiple scattering.
    quiet: [usize; 2],
    order: usize,
}

/// Number of successive orders that must be negligible: one may vanish by chance.
const QUIET_ORDERS: usize = 3;

impl Convergence {
    pub(super) fn new(views: Vec<usize>, lights: Vec<usize>) -> Self {
        Self { sums: vec![0.0; views.len() * lights.len()], views, lights, quiet: [0; 2], order: 0 }
    }

    /// Adds an order.
    pub(super) fn add(&mut self, above: &Above, tolerance: f64) -> Stage {
        // Orders decrease geometrically, by about e^14 from the first to the last: this is the remainder
        // after this one, in units of it.
        let rest = 1.0 + self.order as f64 / 14.0;
        let mut quiet = [true; 2];
        let lights = &self.lights;
        let pairs = self.views.iter().flat_map(|v| lights.iter().map(move |l| (*v, *l)));
        for ((v, l), sum) in pairs.zip(&mut self.sums) {
            let [all, often] = above.at_most(v, l);
            *sum += all;
            // NaN compares as small: it ends the series, too.
            let small = |part: f64| (part * rest).partial_cmp(&(tolerance * *sum)) != Some(Ordering::Greater);
            quiet[0] &= small(all);
            quiet[1] &= small(often);
        }
        for (count, quiet) in self.quiet.iter_mut().zip(quiet) {
            *count = if quiet { *count + 1 } else { 0 };
        }
        self.order += 1;
        match self.quiet.map(|count| count >= QUIET_ORDERS) {
            [true, _] => Stage::Done,
            _ if self.sums.is_empty() => Stage::Done,
            [false, true] => Stage::Once,
            [false, false] => Stage::All,
        }
    }
}

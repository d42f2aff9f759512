//! Phases per um of height, q, for which the powers of a screen are computed, and the powers between them.
//!
//! **Random faces.** The power of a circle of many orders changes smoothly with q: few phases in equal ratios
//! are enough, with cubics in ln q between them.
//!
//! **Other surfaces.** The power of an order oscillates with q, as J_m(q a)² of a grating does. It is a sum of
//! exp(i q (h₁ - h₂)) over pairs of heights, none of which differ by more than the range H of the heights. Over
//! a range of q of the half width W, the Chebyshev coefficients of these terms are Bessel functions J_k(W H),
//! which vanish for k somewhat above W H: a polynomial through that many Chebyshev points is exact within
//! 1e-6. With fewer points, or with cubics, it would be wrong by as much as the power itself.

use std::f64::consts::PI;

/// Heights of a random face that are transformed for a realisation, all phases together.
const MOST_HEIGHTS: usize = 1 << 25;

/// Fewest phases of large random faces.
const FEWEST: usize = 12;

/// Phases that differ by less, relative to them, are equal.
const ROUNDING: f64 = 1e-12;

/// The heights of a screen, as far as the phases depend on them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScreenHeights {
    /// Number of heights.
    pub(crate) count: usize,
    /// Difference of the highest and the lowest one, um.
    pub(crate) range_um: f64,
    /// Whether powers change smoothly with the phase: a random face with Gaussian heights.
    pub(crate) is_gaussian: bool,
}

/// Phases with the powers between them.
#[derive(Debug, Clone)]
pub(crate) struct PhaseNodes {
    /// Ascending, above 0.
    nodes: Vec<f64>,
    between: Between,
}

/// What lies between the phases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Between {
    /// Cubics through four phases, in their logarithm.
    Cubics,
    /// One polynomial through all phases, which are Chebyshev points.
    Polynomial,
}

impl PhaseNodes {
    /// The phases to compute for those that are wanted: all different ones, if there are few.
    pub(crate) fn new(wanted: &[f64], heights: ScreenHeights) -> Self {
        let mut all: Vec<f64> = wanted.iter().copied().filter(|phase| *phase > 0.0).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|one, other| *one <= *other * (1.0 + ROUNDING));
        let (Some(first), Some(last)) = (all.first().copied(), all.last().copied()) else {
            return Self { nodes: all, between: Between::Cubics };
        };
        if heights.is_gaussian {
            let most = (MOST_HEIGHTS / heights.count).max(FEWEST);
            if all.len() > most {
                let step = (last / first).ln() / (most - 1) as f64;
                all = (0..most).map(|k| first * (step * k as f64).exp()).collect();
            }
            return Self { nodes: all, between: Between::Cubics };
        }
        let half = 0.5 * (last - first);
        let turns = half * heights.range_um;
        let most = (turns + 5.0 * turns.cbrt()).ceil() as usize + 8;
        if all.len() > most {
            let at = |k: usize| first + half * (1.0 - (PI * k as f64 / (most - 1) as f64).cos());
            all = (0..most).map(at).collect();
        }
        Self { nodes: all, between: Between::Polynomial }
    }

    pub(crate) fn all(&self) -> &[f64] {
        &self.nodes
    }

    /// Nodes, by their numbers, with the weights with which they give the powers of a phase.
    pub(crate) fn weights(&self, phase: f64) -> Vec<(usize, f64)> {
        let after = self.nodes.partition_point(|known| *known < phase * (1.0 - ROUNDING));
        match self.nodes.get(after) {
            Some(known) if *known <= phase * (1.0 + ROUNDING) => vec![(after, 1.0)],
            // Without phase, nothing is scattered.
            _ if phase == 0.0 || self.nodes.is_empty() => Vec::new(),
            _ if self.between == Between::Polynomial => self.polynomial(phase),
            _ => self.cubic(phase, after),
        }
    }

    fn cubic(&self, phase: f64, after: usize) -> Vec<(usize, f64)> {
        let first = after.saturating_sub(2).min(self.nodes.len().saturating_sub(4));
        let four = first..(first + 4).min(self.nodes.len());
        let of = |i: usize| {
            let others = four.clone().filter(|j| *j != i);
            let term = |j: usize| (phase / self.nodes[j]).ln() / (self.nodes[i] / self.nodes[j]).ln();
            (i, others.map(term).product())
        };
        four.clone().map(of).collect()
    }

    /// The barycentric formula of Chebyshev points that include both ends.
    fn polynomial(&self, phase: f64) -> Vec<(usize, f64)> {
        let last = self.nodes.len() - 1;
        let term = |k: usize| {
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            let end = if k == 0 || k == last { 0.5 } else { 1.0 };
            sign * end / (phase - self.nodes[k])
        };
        let terms: Vec<f64> = (0..=last).map(term).collect();
        let sum: f64 = terms.iter().sum();
        terms.into_iter().map(|term| term / sum).enumerate().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves of all differences of heights up to the range, between as few nodes as there are.
    #[test]
    fn polynomials_follow_the_powers_of_all_heights() {
        for range_um in [1e-3, 0.3, 2.0, 40.0] {
            let wanted: Vec<f64> = (0..5000).map(|k| 1.2 + 0.008 * f64::from(k)).collect();
            let heights = ScreenHeights { count: 1 << 20, range_um, is_gaussian: false };
            let nodes = PhaseNodes::new(&wanted, heights);
            assert!((nodes.all().len() as f64) < 1.1 * 20.0 * range_um + 40.0, "{}", nodes.all().len());
            for part in [0.1, 0.7, 1.0] {
                let power = |phase: f64| (part * range_um * phase).cos();
                for phase in wanted.iter().step_by(61) {
                    let found: f64 =
                        nodes.weights(*phase).iter().map(|(k, weight)| weight * power(nodes.all()[*k])).sum();
                    let exact = power(*phase);
                    assert!((found - exact).abs() < 1e-6, "{range_um} {part} {phase}: {found} {exact}");
                }
            }
        }
    }
}

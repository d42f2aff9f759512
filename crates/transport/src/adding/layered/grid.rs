//! Grid of directions: nodes in `|beta|`.
//!
//! The response of a stack is smooth in `|beta|` except for square roots `sqrt(n^2 - beta^2)` at every index
//! n (1 for air). Between two of them, a and b, `beta^2 = a^2 + (b^2 - a^2) sin^2(pi t/2)` removes the root
//! at either end, and the Gauss-Legendre rule in t converges exponentially.
//!
//! The kernel of a surface is linear in `beta^2` between many kinks. Between two of these the rule in
//! `beta^2` has few nodes: two are exact for the products of two such kernels.

use std::f64::consts::{FRAC_PI_2, PI};

use super::splits::{Between, Splits};
use crate::numerics::quadrature::legendre;

/// Nodes in `|beta|`: those with weight ascend; then extra ones, the directions of views and beams.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// `|beta|` of each node.
    pub(super) beta: Vec<f64>,
    /// Square root of the weight, which is an area of direction cosines; 1 for an extra node.
    pub(super) scale: Vec<f64>,
    /// Number of nodes with weight.
    pub(super) regular: usize,
    /// Ranges of `|beta|` between two indices or kinks.
    ranges: Vec<Between>,
}

/// Required density of the nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Density {
    /// Smallest number between two indices.
    pub(super) least: usize,
    /// Largest distance from each other.
    pub(super) spacing: f64,
    /// Largest distance from each other as angles in a medium that scatters in its volume: its index and the
    /// spacing in radians.
    pub(super) angle: Option<(f64, f64)>,
}

impl Density {
    /// Returns the number of nodes with weight between these splits.
    pub(super) fn total(&self, splits: &Splits) -> usize {
        splits.ranges(self).iter().map(|range| range.count).sum()
    }

    /// Returns the number of nodes from a to b.
    pub(super) fn count(&self, a: f64, b: f64) -> usize {
        // The nodes of the rule are least dense in the middle: pi/2 times the uniform distance.
        let steepest = FRAC_PI_2 * if a > 0.0 { b - a } else { b };
        let by_spacing = FRAC_PI_2 * steepest / self.spacing;
        let by_angle = self.angle.map_or(0.0, |(index, spacing)| {
            let angle = |beta: f64| (beta / index).min(1.0).asin();
            FRAC_PI_2 * (angle(b) - angle(a)) / spacing
        });
        (by_spacing.max(by_angle)).ceil() as usize + self.least
    }
}

/// Returns, at x of a range (-1 to 1), the share of `|beta|^2` between its ends, and its derivative by x.
pub(super) fn share_and_density(x: f64, roots: bool) -> [f64; 2] {
    if !roots {
        return [0.5 * (x + 1.0), 0.5];
    }
    // t is in (0, 1); d(beta^2) = (b^2 - a^2) sin(2 turn) d(turn).
    let turn = PI * 0.25 * (x + 1.0);
    [turn.sin().powi(2), (2.0 * turn).sin() * PI * 0.25]
}

/// Returns x, -1 to 1, of this `|beta|^2` in the range between these `|beta|`.
pub(super) fn variable(ends: [f64; 2], roots: bool, beta_squared: f64) -> f64 {
    let [low, high] = ends.map(|end| end * end);
    let share = ((beta_squared - low) / (high - low)).clamp(0.0, 1.0);
    if roots { share.sqrt().asin() * 4.0 / PI - 1.0 } else { 2.0 * share - 1.0 }
}

impl Grid {
    /// Builds a grid between these splits, with these extra nodes.
    pub(super) fn new(splits: &Splits, density: Density, extra: &[f64]) -> Self {
        let (mut beta, mut scale) = (Vec::new(), Vec::new());
        let ranges = splits.ranges(&density);
        for Between { ends: [a, b], count, roots } in &ranges {
            let all = b * b - a * a;
            for node in legendre(*count) {
                let [share, density] = share_and_density(node.x, *roots);
                beta.push((a * a + all * share).sqrt());
                scale.push((PI * all * density * node.weight).sqrt());
            }
        }
        let regular = beta.len();
        beta.extend_from_slice(extra);
        scale.resize(beta.len(), 1.0);
        Self { beta, scale, regular, ranges }
    }

    /// Returns the extra nodes alone.
    pub(super) fn extras(&self) -> Self {
        let beta = self.beta[self.regular..].to_vec();
        Self { scale: vec![1.0; beta.len()], beta, regular: 0, ranges: Vec::new() }
    }

    /// Returns the interpolation between its nodes with weight.
    pub(super) fn interpolation(&self) -> Interpolation {
        let mut first = 0;
        let range = |&Between { ends: [from, to], count, roots }: &Between| {
            let nodes: Vec<f64> = legendre(count).iter().map(|node| node.x).collect();
            let windows = nodes.windows(NEAREST.min(count)).map(barycentric_weights).collect();
            first += count;
            Range { from, to, roots, first: first - count, nodes, windows }
        };
        Interpolation(self.ranges.iter().map(range).collect())
    }

    /// Returns the ranges between two splits.
    pub(super) fn all_ranges(&self) -> &[Between] {
        &self.ranges
    }

    /// Returns the ranges between two splits, and their numbers of nodes.
    pub(super) fn ranges(&self) -> impl Iterator<Item = ([f64; 2], usize)> {
        self.ranges.iter().map(|range| (range.ends, range.count))
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.beta.len()
    }

    /// Returns the nodes that a medium of this index carries.
    pub(super) fn carried(&self, index: f64) -> Vec<usize> {
        (0..self.len()).filter(|&i| self.beta[i] < index).collect()
    }

    /// Returns the nodes with weight that a medium of this index carries, and all extra ones, which air
    /// carries.
    pub(super) fn kept(&self, index: f64) -> Vec<usize> {
        (0..self.len()).filter(|&i| i >= self.regular || self.beta[i] < index).collect()
    }

    /// Returns the sum of a kernel's column over the directions below `limit`, for each node of origin: the
    /// functional for [`Operator::pull_back`](super::algebra::Operator::pull_back).
    pub(super) fn below(&self, limit: f64) -> Vec<f64> {
        self.beta.iter().map(|beta| f64::from(u8::from(*beta < limit))).collect()
    }
}

/// Number of nodes between which a value is interpolated.
pub(super) const NEAREST: usize = 14;

/// Interpolation of a function of `|beta|` from its values at the nodes with weight: by the polynomial
/// through the nearest nodes of the range between two indices, in the variable of its rule. A function with a
/// peak may be smaller elsewhere by many orders of magnitude. Its error there is in proportion to its own
/// values, whereas the polynomial through all nodes of the range would spread the error of the peak.
#[derive(Debug)]
pub(super) struct Interpolation(Vec<Range>);

#[derive(Debug)]
struct Range {
    from: f64,
    to: f64,
    /// Whether roots are removed at its ends.
    roots: bool,
    /// Number of the first node.
    first: usize,
    /// Variable of each node, -1 to 1, ascending.
    nodes: Vec<f64>,
    /// For each series of successive nodes, by the number of its first, their barycentric weights.
    windows: Vec<Vec<f64>>,
}

impl Interpolation {
    /// Returns the nodes between which a value at this `|beta|` is interpolated, and the factor of each.
    pub(super) fn factors(&self, beta: f64) -> (std::ops::Range<usize>, [f64; NEAREST]) {
        let mut factors = [0.0; NEAREST];
        let Some(range) = self.0.iter().find(|range| beta < range.to) else { return (0..0, factors) };
        let x = variable([range.from, range.to], range.roots, beta * beta);
        let begin = range.window(x);
        let window = &range.windows[begin];
        let some = range.first + begin..range.first + begin + window.len();
        let nodes = &range.nodes[begin..][..window.len()];
        if let Some(k) = nodes.iter().position(|node| *node == x) {
            factors[k] = 1.0;
            return (some, factors);
        }
        for ((factor, node), weight) in factors.iter_mut().zip(nodes).zip(window) {
            *factor = weight / (x - node);
        }
        let sum: f64 = factors.iter().sum();
        (some, factors.map(|factor| factor / sum))
    }

    /// Adds `weight` times the factor of each node's value at this `|beta|` to `sum`; returns the nodes that
    /// have one.
    pub(super) fn add(&self, beta: f64, weight: f64, sum: &mut [f64]) -> std::ops::Range<usize> {
        let (some, factors) = self.factors(beta);
        sum[some.clone()].iter_mut().zip(factors).for_each(|(sum, factor)| *sum += weight * factor);
        some
    }
}

impl Range {
    /// Returns the first of the nodes between which the function is interpolated at `x`: as many on either
    /// side, but at the ends of the range.
    fn window(&self, x: f64) -> usize {
        let Some(windows) = self.windows.len().checked_sub(1) else { return 0 };
        let next = self.nodes.partition_point(|node| *node < x);
        next.saturating_sub(NEAREST / 2).min(windows)
    }
}

/// Returns the weights of the barycentric formula for these nodes, relative to the largest.
fn barycentric_weights(nodes: &[f64]) -> Vec<f64> {
    // The nodes of a window are at distances that are small compared with 1: their products are scaled.
    let size = nodes[nodes.len() - 1] - nodes[0];
    let weight = |k: usize| {
        let others = (0..nodes.len()).filter(|j| *j != k);
        1.0 / others.map(|j| (nodes[k] - nodes[j]) / size).product::<f64>()
    };
    (0..nodes.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Far from the peak of a lobe, errors are in proportion to its small values there.
    #[test]
    fn interpolation_of_a_narrow_lobe_is_accurate_far_from_its_peak() {
        let density = Density { least: 8, spacing: 0.02, angle: None };
        let grid = Grid::new(&Splits::at(&[1.0, 1.5]), density, &[]);
        let lobe = |beta: f64| (0.04_f64.powi(2) + (beta - 0.3).powi(2)).powi(-2);
        let interpolation = grid.interpolation();
        for beta in [0.305, 0.4, 0.7, 0.95, 1.2, 1.4] {
            let mut factors = vec![0.0; grid.regular];
            interpolation.add(beta, 1.0, &mut factors);
            let found: f64 = factors.iter().zip(&grid.beta).map(|(factor, node)| factor * lobe(*node)).sum();
            let error = found / lobe(beta) - 1.0;
            assert!(error.abs() < 3e-3 * ((beta - 0.3) / 0.04).powi(-2).min(1.0), "{beta}: {error}");
        }
    }

    /// A function with a square root at each index is a polynomial in the variables of the ranges, nearly.
    #[test]
    fn interpolation_contains_square_roots_at_indices() {
        let density = Density { least: 24, spacing: f64::INFINITY, angle: None };
        let grid = Grid::new(&Splits::at(&[1.0, 1.5]), density, &[0.3]);
        let function = |beta: f64| (2.25 - beta * beta).sqrt() + (1.0 - beta * beta).abs().sqrt();
        let interpolation = grid.interpolation();
        for beta in [0.0, 0.01, 0.5, 0.99, 1.0, 1.01, 1.3, 1.499, grid.beta[3]] {
            let mut factors = vec![0.0; grid.regular];
            interpolation.add(beta, 1.0, &mut factors);
            let found: f64 =
                factors.iter().zip(&grid.beta).map(|(factor, node)| factor * function(*node)).sum();
            assert!((found - function(beta)).abs() < 1e-9, "{beta}: {found} {}", function(beta));
        }
    }
}

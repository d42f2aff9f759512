//! Grid of directions: nodes in `|beta|`.
//!
//! The response of a stack is smooth in `|beta|` except for square roots `sqrt(n^2 - beta^2)` at every index
//! n (1 for air). Between two of them, a and b, `beta^2 = a^2 + (b^2 - a^2) sin^2(pi t/2)` removes the root
//! at either end, and the Gauss-Legendre rule in t converges exponentially.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::adding::quadrature::{Node, legendre};

/// Nodes in `|beta|`: those with weight ascend; then extra ones, the directions of views and beams.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// `|beta|` of each node.
    pub(super) beta: Vec<f64>,
    /// Square root of the weight, which is an area of direction cosines; 1 for an extra node.
    pub(super) scale: Vec<f64>,
    /// Number of nodes with weight.
    pub(super) regular: usize,
    /// Ranges of `|beta|` between two indices, and their numbers of nodes.
    ranges: Vec<([f64; 2], usize)>,
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
    /// Returns the number of nodes with weight if split at these indices (ascending).
    pub(super) fn total(&self, indices: &[f64]) -> usize {
        let starts = std::iter::once(&0.0).chain(indices);
        starts.zip(indices).map(|(a, b)| self.count(*a, *b)).sum()
    }

    /// Returns the number of nodes from a to b.
    fn count(&self, a: f64, b: f64) -> usize {
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

impl Grid {
    /// Builds a grid split at these indices (ascending), with these extra nodes.
    pub(super) fn new(indices: &[f64], density: Density, extra: &[f64]) -> Self {
        let (mut beta, mut scale, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        let mut a = 0.0;
        for &b in indices {
            let count = density.count(a, b);
            ranges.push(([a, b], count));
            for node in legendre(count) {
                // The nodes of the rule are in (-1, 1); t is in (0, 1).
                let turn = PI * 0.25 * (node.x + 1.0);
                beta.push((a * a + (b * b - a * a) * turn.sin().powi(2)).sqrt());
                // d(beta^2) = (b^2 - a^2) sin(2 turn) d(turn).
                let area = PI * (b * b - a * a) * (2.0 * turn).sin() * PI * 0.25 * node.weight;
                scale.push(area.sqrt());
            }
            a = b;
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
        let mut ranges = Vec::new();
        let mut first = 0;
        for &([from, to], count) in &self.ranges {
            let nodes = legendre(count);
            // Legendre nodes have these barycentric weights (Wang & Xiang, Math. Comp. 81, 861 (2012)).
            let factor = |(k, node): (usize, &Node)| {
                let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
                (node.x, sign * ((1.0 - node.x * node.x) * node.weight).sqrt())
            };
            ranges.push(Range { from, to, first, nodes: nodes.iter().enumerate().map(factor).collect() });
            first += count;
        }
        Interpolation(ranges)
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

/// Interpolation of a function of `|beta|` from its values at the nodes with weight, by the polynomial of each range
/// between two indices in the variable of its rule.
#[derive(Debug)]
pub(super) struct Interpolation(Vec<Range>);

#[derive(Debug)]
struct Range {
    from: f64,
    to: f64,
    /// Number of the first node.
    first: usize,
    /// Variable of each node, -1 to 1, and its barycentric weight.
    nodes: Vec<(f64, f64)>,
}

impl Interpolation {
    /// Adds `weight` times the factor of each node's value at this `|beta|` to `sum`.
    pub(super) fn add(&self, beta: f64, weight: f64, sum: &mut [f64]) {
        let Some(range) = self.0.iter().find(|range| beta < range.to) else { return };
        let [low, high] = [range.from, range.to].map(|end| end * end);
        let share = ((beta * beta - low) / (high - low)).clamp(0.0, 1.0);
        let x = share.sqrt().asin() * 4.0 / PI - 1.0;
        let sum = &mut sum[range.first..][..range.nodes.len()];
        if let Some(k) = range.nodes.iter().position(|node| node.0 == x) {
            sum[k] += weight;
            return;
        }
        let total: f64 = range.nodes.iter().map(|(node, factor)| factor / (x - node)).sum();
        let weight = weight / total;
        sum.iter_mut()
            .zip(&range.nodes)
            .for_each(|(sum, (node, factor))| *sum += weight * factor / (x - node));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A function with a square root at each index is a polynomial in the variables of the ranges, nearly.
    #[test]
    fn interpolation_contains_square_roots_at_indices() {
        let density = Density { least: 24, spacing: f64::INFINITY, angle: None };
        let grid = Grid::new(&[1.0, 1.5], density, &[0.3]);
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

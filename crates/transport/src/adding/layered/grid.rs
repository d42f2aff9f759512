//! Grid of directions: nodes in `|beta|`.
//!
//! The response of a stack is smooth in `|beta|` except for square roots `sqrt(n^2 - beta^2)` at every index
//! n (1 for air). Between two of them, a and b, `beta^2 = a^2 + (b^2 - a^2) sin^2(pi t/2)` removes the root
//! at either end, and the Gauss-Legendre rule in t converges exponentially.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::adding::quadrature::legendre;

/// Nodes in `|beta|`: those with weight ascend; then extra ones, the directions of views and beams.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grid {
    /// `|beta|` of each node.
    pub(super) beta: Vec<f64>,
    /// Square root of the weight, which is an area of direction cosines; 1 for an extra node.
    pub(super) scale: Vec<f64>,
    /// Number of nodes with weight.
    pub(super) regular: usize,
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
        let (mut beta, mut scale) = (Vec::new(), Vec::new());
        let mut a = 0.0;
        for &b in indices {
            for node in legendre(density.count(a, b)) {
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
        Self { beta, scale, regular }
    }

    /// Returns the extra nodes alone.
    pub(super) fn extras(&self) -> Self {
        let beta = self.beta[self.regular..].to_vec();
        Self { scale: vec![1.0; beta.len()], beta, regular: 0 }
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

//! Glass whose index depends on wavelength. The reflectance of a panel is a smooth function of the index. It
//! is computed at a few indices and interpolated between them (Chebyshev points of the range; every index
//! that occurs, if there are fewer).

use std::f64::consts::PI;

use super::Medium;

/// Indices at which to compute, and the weights of each at each wavelength.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Indices {
    pub(crate) nodes: Vec<f64>,
    /// Shape `[node][wavelength]`.
    blend: Vec<f64>,
}

impl Indices {
    pub(crate) fn new(medium: &Medium, digits: f64) -> Self {
        let index = medium.index();
        if let Some(index) = medium.constant_index() {
            return Self { nodes: vec![index], blend: vec![1.0; medium.index().len()] };
        }
        let mut nodes = index.to_vec();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        // Five digits per point, if the index varies by a fifth.
        let (low, high) = (index.min(), index.max());
        let each = (4.0 / ((high - low) / (low - 0.5))).max(2.0).ln();
        let count = 1 + (digits / each).ceil() as usize;
        if count < nodes.len() {
            let at = |k: usize| {
                let x = (PI * (k as f64 + 0.5) / count as f64).cos();
                0.5 * (low + high) + 0.5 * (high - low) * x
            };
            nodes = (0..count).map(at).collect();
        }
        let blend = nodes.iter().enumerate().flat_map(|(j, node)| {
            let others: Vec<f64> =
                nodes.iter().enumerate().filter(|(i, _)| *i != j).map(|(_, n)| *n).collect();
            index.iter().map(move |n| others.iter().map(|o| (n - o) / (node - o)).product::<f64>())
        });
        let blend = blend.collect();
        Self { nodes, blend }
    }

    /// Returns the weight of a node at a wavelength.
    pub(crate) fn blend_at(&self, node: usize, bin: usize) -> f64 {
        self.blend[node * (self.blend.len() / self.nodes.len()) + bin]
    }

    /// `sum[..][wavelength] += values[..][wavelength] * blend` of one node.
    pub(crate) fn add(&self, node: usize, values: &[f64], sum: &mut [f64]) {
        let bins = self.blend.len() / self.nodes.len();
        let blend = &self.blend[node * bins..][..bins];
        for (row, values) in sum.chunks_exact_mut(bins).zip(values.chunks_exact(bins)) {
            for ((s, v), b) in row.iter_mut().zip(values).zip(blend) {
                *s += v * b;
            }
        }
    }
}

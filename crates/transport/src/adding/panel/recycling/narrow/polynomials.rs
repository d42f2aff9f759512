//! Interpolation between given nodes.

use crate::adding::panel::lobes::LANES;

/// Polynomials that are one at one of the nodes and zero at the others, by the barycentric formula. They are
/// padded with zeros to a multiple of [`LANES`].
#[derive(Debug, Clone)]
pub(super) struct Polynomials {
    nodes: Vec<f64>,
    scales: Vec<f64>,
    count: usize,
}

impl Polynomials {
    pub(super) fn new(mut nodes: Vec<f64>) -> Self {
        let scale = |(p, node): (usize, &f64)| {
            let others = nodes.iter().enumerate().filter(|(i, _)| *i != p);
            1.0 / others.map(|(_, other)| node - other).product::<f64>()
        };
        let (mut scales, count): (Vec<f64>, usize) =
            (nodes.iter().enumerate().map(scale).collect(), nodes.len());
        let all = count.next_multiple_of(LANES);
        nodes.resize(all, f64::MAX);
        scales.resize(all, 0.0);
        Self { nodes, scales, count }
    }

    /// Returns the nodes, without those of padding.
    pub(super) fn nodes(&self) -> &[f64] {
        &self.nodes[..self.count]
    }

    /// Returns the number of polynomials, without those of padding.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Returns the number of polynomials, with those of padding.
    pub(super) fn padded_len(&self) -> usize {
        self.nodes.len()
    }

    /// Computes all of them, with padding.
    #[inline(always)]
    pub(super) fn at(&self, x: f64, out: &mut [f64]) {
        let (out, nodes, scales) = (
            out.as_chunks_mut::<LANES>().0,
            self.nodes.as_chunks::<LANES>().0,
            self.scales.as_chunks::<LANES>().0,
        );
        let mut sums = [0.0; LANES];
        for ((out, nodes), scales) in out.iter_mut().zip(nodes).zip(scales) {
            for k in 0..LANES {
                let away = x - nodes[k];
                // At a node, its own term exceeds all others by far more than the rounding error.
                out[k] = scales[k] / if away == 0.0 { f64::MIN_POSITIVE.sqrt() } else { away };
                sums[k] += out[k];
            }
        }
        let scale = 1.0 / sums.iter().sum::<f64>();
        for out in out {
            out.iter_mut().for_each(|out| *out *= scale);
        }
    }
}

//! Interpolation between given nodes.

/// Polynomials that are one at one of the nodes and zero at the others, by the barycentric formula.
#[derive(Debug, Clone)]
pub(super) struct Polynomials {
    pub(super) nodes: Vec<f64>,
    scales: Vec<f64>,
}

impl Polynomials {
    pub(super) fn new(nodes: Vec<f64>) -> Self {
        let scale = |(p, node): (usize, &f64)| {
            let others = nodes.iter().enumerate().filter(|(i, _)| *i != p);
            1.0 / others.map(|(_, other)| node - other).product::<f64>()
        };
        Self { scales: nodes.iter().enumerate().map(scale).collect(), nodes }
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Computes all of them.
    #[inline(always)]
    pub(super) fn at(&self, x: f64, out: &mut [f64]) {
        let mut all = 0.0;
        for ((out, node), scale) in out.iter_mut().zip(&self.nodes).zip(&self.scales) {
            let away = x - node;
            // At a node, its own term exceeds all others by far more than the rounding error.
            *out = scale / if away == 0.0 { f64::MIN_POSITIVE.sqrt() } else { away };
            all += *out;
        }
        let scale = 1.0 / all;
        out.iter_mut().for_each(|out| *out *= scale);
    }
}

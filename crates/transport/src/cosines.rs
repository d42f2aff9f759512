//! Nodes over cos(theta), close together where a film's reflectance changes fast.

use crate::angular::Stencil;

/// Panels that fill the cosines from 0 to 1, halves of halves, each with evenly spaced nodes at
/// its ends and between them.
///
/// A film's reflectance is analytic in the cosine, but a resonance may be a hundredth wide:
/// panels are small there alone.
#[derive(Debug, Clone, PartialEq)]
pub struct CosinePanels {
    /// In ascending order.
    panels: Vec<Panel>,
    /// For each of so many equal parts of 0 to 1 the panel that it lies in.
    panel_at: Vec<u16>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Panel {
    start: f64,
    width: f64,
}

impl CosinePanels {
    /// Intervals between the nodes of a panel.
    pub const INTERVALS: usize = 16;

    /// Nodes of a panel; neighbours have the one that they share each.
    pub const NODES: usize = Self::INTERVALS + 1;

    /// Panels of widths 1/2^k from 0 on, for these k (at most 12), which are to sum to 1.
    pub fn new(halvings: &[u32]) -> Self {
        let mut panels = Vec::with_capacity(halvings.len());
        let mut start = 0.0;
        for &k in halvings {
            let width = 0.5_f64.powi(k as i32);
            panels.push(Panel { start, width });
            start += width;
        }
        debug_assert_eq!(start, 1.0);
        let parts = 1 << halvings.iter().max().copied().unwrap_or(0);
        let panel_at = (0..parts).map(|part| {
            let cosine = part as f64 / f64::from(parts);
            (panels.partition_point(|panel| panel.start <= cosine).max(1) - 1) as u16
        });
        Self { panel_at: panel_at.collect(), panels }
    }

    /// The number of nodes.
    pub fn count(&self) -> usize {
        self.panels.len() * Self::NODES
    }

    /// The cosines of all nodes.
    pub fn nodes(&self) -> impl Iterator<Item = f64> {
        self.panels.iter().flat_map(|panel| {
            let step = panel.width / Self::INTERVALS as f64;
            (0..Self::NODES).map(move |node| panel.start + node as f64 * step)
        })
    }

    /// Where panels begin, and their middles.
    pub(crate) fn halves(&self) -> impl Iterator<Item = f64> {
        self.panels.iter().flat_map(|panel| [panel.start, panel.start + 0.5 * panel.width])
    }

    /// Eight-point interpolation within the panel of this cosine.
    #[inline]
    pub(crate) fn stencil(&self, cosine: f64) -> Stencil {
        let part = (cosine * self.panel_at.len() as f64) as usize;
        let number = usize::from(self.panel_at[part.min(self.panel_at.len() - 1)]);
        let panel = &self.panels[number];
        let x = (cosine - panel.start) / panel.width * Self::INTERVALS as f64;
        let within = Stencil::lagrange(x, Self::NODES);
        Stencil { first: number * Self::NODES + within.first, ..within }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panels_of_any_size_reproduce_a_septic() {
        let septic = |x: f64| 1.0 - 2.0 * x + 3.0 * x.powi(3) - 0.5 * x.powi(7);
        for halvings in [&[0_u32][..], &[1, 1], &[2, 3, 3, 1], &[1, 2, 4, 4, 3]] {
            let panels = CosinePanels::new(halvings);
            let nodes: Vec<f64> = panels.nodes().collect();
            assert_eq!((nodes.len(), nodes[0], nodes[nodes.len() - 1]), (panels.count(), 0.0, 1.0));
            for step in 0..=1000 {
                let cosine = f64::from(step) / 1000.0;
                let stencil = panels.stencil(cosine);
                let found: f64 = (0..8).map(|k| stencil.weights[k] * septic(nodes[stencil.first + k])).sum();
                assert!((found - septic(cosine)).abs() < 1e-12, "{halvings:?} {cosine}");
                assert!(nodes[stencil.first] <= cosine && cosine <= nodes[stencil.first + 7]);
            }
        }
    }
}

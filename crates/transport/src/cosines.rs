//! Nodes over cos(theta), close together where a film's reflectance changes fast.

use std::f64::consts::PI;
use std::sync::LazyLock;

use papilio_optics::with_widest_simd;
use papilio_sampling::warp::rounded;

use crate::angular::Stencil;

/// Panels that fill the cosines from 0 to 1 by repeated halving, each with the Chebyshev points of the first
/// kind as nodes, and interpolation among all nodes of a panel.
///
/// The reflectance of a film is analytic in the cosine, but a resonance may be only 0.01 wide: panels are
/// small only there.
#[derive(Debug, Clone, PartialEq)]
pub struct CosinePanels {
    /// In ascending order.
    panels: Vec<Panel>,
    /// For each of these equal parts of 0 to 1 the number of the panel that contains it.
    parts: Vec<u16>,
    /// Nodes of a panel from -1 to 1, and 1 over the product of differences from all others.
    nodes: [f64; Self::NODES],
    scale: [f64; Self::NODES],
}

/// Chebyshev polynomials at the nodes, `[degree][node]`, with the factors that turn them into Lagrange
/// polynomials.
static POLYNOMIALS: LazyLock<[[f64; CosinePanels::NODES]; CosinePanels::NODES]> = LazyLock::new(|| {
    let scale = |degree: usize| if degree == 0 { 1.0 } else { 2.0 } / CosinePanels::NODES as f64;
    std::array::from_fn(|degree| {
        // A node is -cos of its angle.
        std::array::from_fn(|node| scale(degree) * (degree as f64 * (PI - angle(node))).cos())
    })
});

#[derive(Debug, Clone, Copy, PartialEq)]
struct Panel {
    start: f64,
    width: f64,
    per_half_width: f64,
}

impl Panel {
    fn new(start: f64, width: f64) -> Self {
        Self { start, width, per_half_width: 2.0 / width }
    }
}

impl CosinePanels {
    /// Number of nodes of a panel.
    pub const NODES: usize = Stencil::LEN;

    /// Builds panels of widths 1/2^k from 0 on, for these k (at most 20); the widths must sum to 1.
    pub fn new(halvings: &[u32]) -> Self {
        let mut panels = Vec::with_capacity(halvings.len());
        let mut start = 0.0;
        for &k in halvings {
            let width = 0.5_f64.powi(k as i32);
            panels.push(Panel::new(start, width));
            start += width;
        }
        debug_assert_eq!(start, 1.0);
        let parts = 1 << halvings.iter().max().copied().unwrap_or(0);
        let panel_at = |part: i32| {
            let cosine = f64::from(part) / f64::from(parts);
            (panels.partition_point(|panel: &Panel| panel.start <= cosine).max(1) - 1) as u16
        };
        let count = Self::NODES as f64;
        // The product of differences is T'(x)/2^(n-1), T the Chebyshev polynomial of degree n.
        let scale = |k: usize| {
            let sign = if (Self::NODES - 1 - k).is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * angle(k).sin() * 2.0_f64.powi(Self::NODES as i32 - 1) / count
        };
        Self {
            parts: (0..parts).map(panel_at).collect(),
            panels,
            nodes: std::array::from_fn(|k| -angle(k).cos()),
            scale: std::array::from_fn(scale),
        }
    }

    /// Returns whether one of the panels has this start and width.
    pub fn holds(&self, start: f64, width: f64) -> bool {
        self.panels.contains(&Panel::new(start, width))
    }

    /// Returns the number of nodes.
    pub fn count(&self) -> usize {
        self.panels.len() * Self::NODES
    }

    /// Returns the cosines of all nodes.
    pub fn nodes(&self) -> impl Iterator<Item = f64> {
        self.panels.iter().flat_map(|panel| Self::nodes_between(panel.start, panel.start + panel.width))
    }

    /// Returns the cosines of the nodes of a panel.
    pub fn nodes_between(from: f64, to: f64) -> impl Iterator<Item = f64> {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        (0..Self::NODES).map(move |k| middle - half * angle(k).cos())
    }

    /// Returns the approximate number of nodes from one cosine to a larger one.
    pub(crate) fn nodes_from(&self, from: f64, to: f64) -> f64 {
        let share = |panel: &Panel| {
            let inside = to.min(panel.start + panel.width) - from.max(panel.start);
            inside.max(0.0) / panel.width
        };
        Self::NODES as f64 * self.panels.iter().map(share).sum::<f64>()
    }

    /// Returns the starts and the middles of the panels.
    pub(crate) fn halves(&self) -> impl Iterator<Item = f64> {
        self.panels.iter().flat_map(|panel| [panel.start, panel.start + 0.5 * panel.width])
    }

    /// Returns the number of equal parts of 0 to 1 of which panels are made.
    #[inline(always)]
    pub(crate) fn part_count(&self) -> f64 {
        self.parts.len() as f64
    }

    /// Returns the part, of `count`, that contains a cosine from 0 to 1.
    #[inline(always)]
    pub(crate) fn part(cosine: f64, count: f64) -> u32 {
        rounded(cosine * count - 0.5).1
    }

    /// Returns the panel that contains a part.
    #[inline(always)]
    pub(crate) fn panel_of(&self, part: u32) -> usize {
        usize::from(self.parts[(part as usize).min(self.parts.len() - 1)])
    }

    /// Returns the position of a cosine in a panel, from -1 to 1.
    #[inline(always)]
    fn place(&self, number: usize, cosine: f64) -> f64 {
        let panel = &self.panels[number];
        // Widths are powers of two.
        (cosine - panel.start) * panel.per_half_width - 1.0
    }

    /// Returns for each panel its start, and one over half its width.
    pub(crate) fn borders(&self) -> impl Iterator<Item = [f64; 2]> {
        self.panels.iter().map(|panel| [panel.start, panel.per_half_width])
    }

    /// Adds to the weights of a panel's nodes those of look-ups with these moments: sums of weights times
    /// Chebyshev polynomials T_0, T_1, ... of the positions. (The polynomials are orthogonal over the
    /// points, so that Lagrange polynomials are sums of them.)
    pub(crate) fn add_moments(moments: &[f64; Self::NODES], weights: &mut [f64; Self::NODES]) {
        let at_nodes = &*POLYNOMIALS;
        with_widest_simd(
            #[inline(always)]
            || {
                for (at_nodes, moment) in at_nodes.iter().zip(moments) {
                    weights.iter_mut().zip(at_nodes).for_each(|(weight, value)| *weight += moment * value);
                }
            },
        );
    }

    /// Returns Lagrange interpolation within the panel of this cosine.
    #[inline(always)]
    pub(crate) fn stencil(&self, cosine: f64) -> Stencil {
        let number = self.panel_of(Self::part(cosine, self.part_count()));
        let x = self.place(number, cosine);
        let away = self.nodes.map(|node| x - node);
        // Four products at a time.
        let (mut products, mut product) = ([1.0; 4], 1.0);
        for away in away.chunks_exact(4) {
            (0..4).for_each(|k| products[k] *= away[k]);
        }
        products.iter().for_each(|one| product *= one);
        let mut weights = self.scale;
        for (weight, away) in weights.iter_mut().zip(&away) {
            *weight = if *away == 0.0 { 1.0 } else { *weight * product / away };
        }
        Stencil { first: number * Self::NODES, weights }
    }
}

/// Returns the angle of a Chebyshev point from the lower end of its panel.
fn angle(k: usize) -> f64 {
    PI * (k as f64 + 0.5) / CosinePanels::NODES as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Moments of look-ups give the same weights as single look-ups.
    #[test]
    fn moments_equal_single_look_ups() {
        let panels = CosinePanels::new(&[2, 3, 3, 1]);
        let (mut one_by_one, mut by_moments) = (vec![0.0; panels.count()], vec![0.0; panels.count()]);
        let mut moments = vec![[0.0; CosinePanels::NODES]; panels.borders().count()];
        for step in 0..=1000 {
            let (cosine, weight) = (f64::from(step) / 1000.0, f64::from(step % 7) - 2.5);
            let stencil = panels.stencil(cosine);
            for (sum, w) in one_by_one[stencil.first..].iter_mut().zip(stencil.weights) {
                *sum += weight * w;
            }
            let number = panels.panel_of(CosinePanels::part(cosine, panels.part_count()));
            let place = panels.place(number, cosine);
            let angle = place.clamp(-1.0, 1.0).acos();
            for (k, moment) in moments[number].iter_mut().enumerate() {
                *moment += weight * (k as f64 * angle).cos();
            }
        }
        for (moments, weights) in moments.iter().zip(by_moments.as_chunks_mut().0) {
            CosinePanels::add_moments(moments, weights);
        }
        assert!(
            one_by_one.iter().zip(&by_moments).all(|(a, b)| (a - b).abs() < 1e-9),
            "{one_by_one:?} {by_moments:?}"
        );
    }

    #[test]
    fn panels_of_any_size_reproduce_polynomial_of_degree_fifteen() {
        let polynomial = |x: f64| 1.0 - 2.0 * x + 3.0 * x.powi(3) - 0.5 * x.powi(7) + 0.2 * x.powi(15);
        for halvings in [&[0_u32][..], &[1, 1], &[2, 3, 3, 1], &[1, 2, 4, 4, 3]] {
            let panels = CosinePanels::new(halvings);
            let nodes: Vec<f64> = panels.nodes().collect();
            assert!(nodes.len() == panels.count() && nodes.is_sorted());
            assert!(nodes[0] > 0.0 && nodes[nodes.len() - 1] < 1.0);
            for cosine in (0..=1000).map(|step| f64::from(step) / 1000.0).chain(nodes.iter().copied()) {
                let stencil = panels.stencil(cosine);
                let values = nodes[stencil.first..].iter().map(|x| polynomial(*x));
                let found: f64 = stencil.weights.iter().zip(values).map(|(w, value)| w * value).sum();
                assert!((found - polynomial(cosine)).abs() < 1e-12, "{halvings:?} {cosine}");
                let within = nodes[stencil.first]..=nodes[stencil.first + CosinePanels::NODES - 1];
                let width = 0.5_f64.powi(halvings.iter().min().copied().unwrap_or(0) as i32);
                assert!(*within.start() <= cosine + 0.01 * width && cosine <= within.end() + 0.01 * width);
            }
        }
    }
}

//! Functions of the radius that a narrow lobe has smoothed, and their averages by the lobe.
//!
//! Light that a lobe of width b has scattered is a smooth function of |beta|, except that around the rim of
//! the disc of air it changes over a distance of b: it has poles at 1 ± ib. With |beta| = 1 + b sinh u these
//! lie at u = ± i pi/2, so that one polynomial in u over the whole disc converges, with a number of nodes
//! that grows only as log(1/b). (In the glass, the same in the angle, of which the sine is |beta|/n.)
//! Averages of these polynomials by the lobe are integrals along the radius, graded around its centre.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::lobe::Lobe;

use super::super::super::first_pass::Pass;
use super::super::super::lobes;
use crate::Nodes;
use crate::numerics::quadrature::{Node, Pole, graded, legendre};

/// Nodes of a polynomial over a disc.
#[derive(Debug, Clone)]
pub(super) struct Basis {
    disc: Disc,
    /// Pole about which nodes are concentrated, in the disc's coordinate, and the range of u.
    rim: Pole,
    range: [f64; 2],
    /// |beta| of the nodes.
    pub(super) radii: Vec<f64>,
    /// Nodes in u, scaled to -1 to 1, and the scales of the barycentric formula (Berrut & Trefethen 2004).
    nodes: Vec<(f64, f64)>,
}

/// A disc of direction cosines and the coordinate along its radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Disc {
    /// The coordinate is |beta|.
    Air,
    /// The coordinate is the angle in a medium of this index.
    Glass(f64),
}

impl Disc {
    fn radius(self, x: f64) -> f64 {
        match self {
            Self::Air => x,
            Self::Glass(index) => index * x.sin(),
        }
    }

    fn coordinate(self, radius: f64) -> f64 {
        match self {
            Self::Air => radius,
            Self::Glass(index) => (radius / index).min(1.0).asin(),
        }
    }

    fn end(self) -> f64 {
        match self {
            Self::Air => 1.0,
            Self::Glass(_) => FRAC_PI_2,
        }
    }

    fn pole(self, at: f64, width: f64) -> Pole {
        let pole = Pole { at, off: width };
        match self {
            Self::Air => pole,
            Self::Glass(index) => pole.in_arc(index),
        }
    }

    /// Returns a rule over the disc for functions with these poles; weights contain `2 pi |beta| d|beta|`.
    fn rule(self, poles: &[Pole], digits: f64) -> Vec<Node> {
        let mut nodes = graded(0.0, self.end(), &[], poles, digits);
        for node in &mut nodes {
            let slope = match self {
                Self::Air => 1.0,
                Self::Glass(index) => index * node.x.cos(),
            };
            node.x = self.radius(node.x);
            node.weight *= 2.0 * PI * node.x * slope;
        }
        nodes
    }
}

impl Basis {
    /// Builds the basis for a lobe of this width and errors of `exp(-digits)`, with `more` nodes for other
    /// functions over the disc.
    pub(super) fn new(disc: Disc, width: f64, digits: f64, more: usize) -> Self {
        let rim = disc.pole(1.0, width);
        let u = |x: f64| ((x - rim.at) / rim.off).asinh();
        let range = [u(0.0), u(disc.end())];
        // Size of the ellipse about the range that contains the poles at ± i pi/2.
        let each = Pole { at: 0.0, off: FRAC_PI_2 }.ellipse(range[0], range[1]).ln();
        let count = (digits / each).ceil() as usize + LEAST + more;
        let scale = |(k, node): (usize, &Node)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            (node.x, sign * ((1.0 - node.x * node.x) * node.weight).sqrt())
        };
        let nodes: Vec<(f64, f64)> = legendre(count).iter().enumerate().map(scale).collect();
        let [from, to] = range;
        let radius = |(node, _): &(f64, f64)| {
            let u = 0.5 * (from + to) + 0.5 * (to - from) * node;
            disc.radius((rim.at + rim.off * u.sinh()).clamp(0.0, disc.end()))
        };
        Self { disc, rim, range, radii: nodes.iter().map(radius).collect(), nodes }
    }

    pub(super) fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Adds the polynomials of all nodes at a radius, times a weight.
    pub(super) fn add_values(&self, radius: f64, weight: f64, sum: &mut [f64]) {
        let [from, to] = self.range;
        let u = ((self.disc.coordinate(radius) - self.rim.at) / self.rim.off).asinh();
        let x = (2.0 * u - from - to) / (to - from);
        let mut all = 0.0;
        for (number, (node, scale)) in self.nodes.iter().enumerate() {
            let away = x - node;
            if away == 0.0 {
                sum[number] += weight;
                return;
            }
            all += scale / away;
        }
        let weight = weight / all;
        for (sum, (node, scale)) in sum.iter_mut().zip(&self.nodes) {
            *sum += weight * scale / (x - node);
        }
    }

    /// Returns the averages, by the lobe around these radii, of each polynomial over its disc:
    /// `[radius][node]`.
    pub(super) fn averages(&self, lobe: Lobe, width: f64, radii: &[f64], digits: f64) -> Vec<f64> {
        let mut all = vec![0.0; radii.len() * self.len()];
        for (radius, sum) in radii.iter().zip(all.chunks_exact_mut(self.len())) {
            let poles = [1.0, *radius].map(|at| self.disc.pole(at, width));
            let rule = self.disc.rule(&poles, digits);
            for (node, mean) in rule.iter().zip(lobes::means(lobe, &[(*radius, 1.0)], &rule)) {
                self.add_values(node.x, node.weight * mean, sum);
            }
        }
        all
    }
}

/// Number of nodes in addition to those that the rim requires.
const LEAST: usize = 4;

/// Returns the number of nodes for the table of the base: one for two of its nodes, and many where a
/// polynomial converges slowly. A film has few fringes over the disc; its table has more nodes than this
/// number of digits needs, where a resonance is narrow.
pub(super) fn for_table(pass: &Pass<'_>, disc: Disc, digits: f64) -> usize {
    let nodes = 0.5 * pass.table.between([0.0, disc.radius(disc.end())], pass.index);
    match pass.table {
        Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_) | Nodes::Azimuthal(..) => {
            (FOR_KINKS + nodes).min(MOST_FOR_TABLE) as usize
        }
        Nodes::Constant => 0,
        Nodes::Cosines(_) | Nodes::CosinePanels(_) => {
            nodes.min(FOR_FRINGES + digits / DIGITS_A_NODE) as usize
        }
    }
}

/// Number of nodes for kinks; the error decreases with its square.
const FOR_KINKS: f64 = 40.0;

/// Largest number of nodes for a table with kinks.
const MOST_FOR_TABLE: f64 = 80.0;

/// Number of nodes below which a polynomial does not follow the fringes of a film near the normal, where
/// nodes are sparse, and natural digits gained by each further one.
const FOR_FRINGES: f64 = 15.0;
const DIGITS_A_NODE: f64 = 1.2;

#[cfg(test)]
mod tests {
    use super::*;

    /// The average of a function that the lobe has smoothed, which is known: the fraction of a wider lobe
    /// within the disc, at the centre.
    #[test]
    fn averages_of_smoothed_functions_converge() {
        for width in [0.002, 0.009, 0.05] {
            for disc in [Disc::Air, Disc::Glass(1.5)] {
                let lobe = Lobe::KCorrelation { width };
                let [coarse, fine] = [5.0_f64, 9.0].map(|digits| {
                    let basis = Basis::new(disc, width, digits, 0);
                    let radii = [0.0, 0.3, 0.97, 1.0];
                    let averages = basis.averages(lobe, width, &radii, digits);
                    let values = lobe_within(lobe, &basis.radii);
                    let sum = |row: &[f64]| row.iter().zip(&values).map(|(a, b)| a * b).sum::<f64>();
                    let found: Vec<f64> = averages.chunks_exact(basis.len()).map(sum).collect();
                    let truth = radii.map(|radius| {
                        let poles = [1.0, radius].map(|at| disc.pole(at, width));
                        let rule = disc.rule(&poles, 20.0);
                        let means = lobes::means(lobe, &[(radius, 1.0)], &rule);
                        let values = lobe_within(lobe, &rule.iter().map(|node| node.x).collect::<Vec<_>>());
                        rule.iter().zip(means).zip(values).map(|((n, m), v)| n.weight * m * v).sum::<f64>()
                    });
                    found.iter().zip(truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
                });
                assert!(coarse < 3.0 * (-5.0_f64).exp(), "{width} {disc:?}: {coarse}");
                assert!(fine < 3.0 * (-9.0_f64).exp(), "{width} {disc:?}: {fine}");
            }
        }
    }

    /// Returns the fraction of the lobe around each radius within the disc of air.
    fn lobe_within(lobe: Lobe, radii: &[f64]) -> Vec<f64> {
        radii.iter().map(|radius| lobe.fraction_in_disc(*radius, 1.0)).collect()
    }
}

//! Terms of the reflectance over angle: polynomials in the cosine, and the values of each on the grid.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;

use super::forms::Places;
use super::grid::{Columns, End, Grid, NARROW};
use super::{Pass, Weights};
use crate::Nodes;
use crate::angular::Stencil;
use crate::numerics::quadrature::{Node, gauss, graded};

/// Polynomials in the cosine in the glass, each one at one point and zero at the others.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    /// Gauss points, or Chebyshev points under a narrow lobe.
    pub(super) cosines: Vec<f64>,
    /// Weights on the nodes of a table that give the term of the reflectance at each point.
    pub(super) terms: Vec<Weights>,
    /// `[glass][term]` and `[air][term]`.
    pub(super) glass: Vec<f64>,
    pub(super) air: Vec<f64>,
    /// Light by which a view's light is multiplied: diffuse light after one pass, and reflected by the base,
    /// for each term; and the fraction that arrives there.
    pub(super) leaving: End,
    pub(super) reflected: End,
    pub(super) arriving: End,
    /// Places of forms of this order, and of one degree less.
    pub(super) places: [Places; 2],
}

impl Profile {
    /// Builds the profile for forms of this degree.
    pub(super) fn new(grid: &Grid, pass: &Pass<'_>, count: usize, degree: u32) -> Self {
        let index = pass.index;
        // A Lambertian lobe sends nothing beyond the disc of air.
        let from = match pass.diffuser.lobe {
            Lobe::KCorrelation { .. } => 0.0,
            Lobe::Lambertian => (1.0 - index.powi(-2)).max(0.0).sqrt(),
        };
        let fitted = count == 1 || is_fitted(pass);
        let points: Vec<Node> = if fitted { gauss(from, 1.0, count).collect() } else { chebyshev(count) };
        let cosines = points.iter().map(|point| point.x).collect();
        let mut profile = Self {
            cosines,
            terms: vec![],
            glass: vec![],
            air: vec![],
            leaving: End::default(),
            reflected: End::default(),
            arriving: grid.end(grid.arriving.clone(), 1),
            places: [degree, degree - 1].map(|degree| Places::new(count, degree)),
        };
        profile.terms = if fitted { profile.fit(pass, from, &points) } else { profile.look_ups(pass) };
        let at = |nodes: &[Node]| -> Vec<f64> {
            nodes.iter().flat_map(|n| profile.at((1.0 - (n.x / index).powi(2)).max(0.0).sqrt())).collect()
        };
        let (glass, air) = (at(&grid.glass), at(&grid.air));
        let columns = Columns { count, glass: &glass, air: &air };
        let leaving = grid.diffuse(columns, &grid.leaving, &grid.leaving_straight);
        let reflected = grid.diffuse(columns, &vec![1.0; grid.glass.len()], &vec![1.0; grid.air.len()]);
        [profile.leaving, profile.reflected] = [leaving, reflected].map(|light| grid.end(light, 1));
        (profile.glass, profile.air) = (glass, air);
        profile
    }

    /// Fits by least squares: the polynomials are orthogonal, each with the weight of its point. A single
    /// term is the mean by projected area.
    fn fit(&self, pass: &Pass<'_>, from: f64, points: &[Node]) -> Vec<Weights> {
        let breaks: Vec<f64> = pass.table.breaks(pass.index);
        let breaks: Vec<f64> =
            breaks.iter().map(|b| (1.0 - (b / pass.index).powi(2)).max(0.0).sqrt()).collect();
        let mut terms = vec![Weights::new(pass.table); points.len()];
        for node in graded(from, 1.0, &breaks, &[], pass.digits.max(DIGITS_OF_FITS)) {
            let stencil = look_up(pass, node.x);
            for ((term, value), point) in terms.iter_mut().zip(self.at(node.x)).zip(points) {
                let area = if points.len() == 1 { node.x / point.x } else { 1.0 };
                term.add(&stencil, node.weight * area * value / point.weight);
            }
        }
        terms.into_iter().map(|term| term.finish(pass.table)).collect()
    }

    /// Interpolates.
    fn look_ups(&self, pass: &Pass<'_>) -> Vec<Weights> {
        let term = |cosine: &f64| {
            let mut term = Weights::new(pass.table);
            term.add(&look_up(pass, *cosine), 1.0);
            term.finish(pass.table)
        };
        self.cosines.iter().map(term).collect()
    }

    pub(super) fn columns(&self) -> Columns<'_> {
        Columns { count: self.cosines.len(), glass: &self.glass, air: &self.air }
    }

    /// Returns the polynomials at a cosine.
    pub(super) fn at(&self, cosine: f64) -> Vec<f64> {
        let factor = |node: f64, other: f64| (cosine - other) / (node - other);
        let term = |(p, node): (usize, &f64)| {
            let others = self.cosines.iter().enumerate().filter(|(i, _)| *i != p);
            others.map(|(_, other)| factor(*node, *other)).product()
        };
        self.cosines.iter().enumerate().map(term).collect()
    }
}

/// Natural digits of the rule for fits: it integrates the table's polynomials exactly, however fast they
/// change.
const DIGITS_OF_FITS: f64 = 43.0;

fn look_up(pass: &Pass<'_>, cosine: f64) -> Stencil {
    pass.look_up(pass.index * (1.0 - cosine * cosine).max(0.0).sqrt())
}

/// Returns whether terms are fitted to means. Interpolation is better near a direction, where narrow lobes
/// concentrate recycled light, and for tables over angles, which have no resonances.
pub(in super::super) fn is_fitted(pass: &Pass<'_>) -> bool {
    let narrow = matches!(pass.diffuser.lobe, Lobe::KCorrelation { width } if width <= NARROW);
    !narrow && matches!(pass.table, Nodes::Cosines(_) | Nodes::CosinePanels(_))
}

/// Returns Chebyshev points on (0, 1).
pub(super) fn chebyshev(count: usize) -> Vec<Node> {
    let x = |p: usize| 0.5 + 0.5 * (PI * (p as f64 + 0.5) / count as f64).cos();
    (0..count).map(|p| Node { x: x(p), weight: 1.0 }).collect()
}

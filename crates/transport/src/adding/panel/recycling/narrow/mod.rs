//! Light that the front of screen sends back into the panel through a narrow lobe.
//!
//! A lobe much narrower than the disc of air would need a large grid. But the light that it scatters is
//! simple, for two reasons. First, of the lobes on its way (two for each reflection by the base) at most one
//! deflects light far: the k-correlation lobe falls off with the third power of the distance, so that two
//! large deflections are rarer by another factor b. Second, the lobe is a Poisson kernel: n lobes make one
//! of n times the width.
//!
//! **Diffuse light** depends on the radius alone, and is smooth except around the rim of the disc of air. A
//! few nodes represent it, with the true lobe ([`basis`]).
//!
//! **Between a view v and a source l**, order j of the series has 2j lobes. If lobe number i deflects the
//! light from v to l, light meets the base around v before it, and around l after it. With R the reflectance
//! of the base in these directions, and P the lobe of 2j times the width, order j is therefore
//!
//! `P(v - l) (R_v^j + 2 R_v^(j-1) R_l + ... + 2 R_v R_l^(j-1) + R_l^j) / (2j)`,
//!
//! exactly for b = 0 and, over a uniform base without rims, for any b. Its error is of the order of b.
//!
//! Order 2, and under strong fronts order 3, are computed without this approximation: between points of light
//! (beams and discs) and a view ([`passes`]), and between a view and some directions around it, for fields
//! ([`field`]). Only the difference from the closed form is computed in this way, so that a few terms of the
//! reflectance are enough. The ratio to the closed form corrects the later orders ([`Extrapolation`]), which
//! are weaker by a factor of about g R each.
//!
//! Over a table with kinks, from the second level on a grid for a wider lobe W shows the error of
//! the closed form instead. The error at b is estimated from it ([`weights`]) and added, so that the rest is
//! of the order of b (W - b). The finer the level, the narrower W, down to b.

mod basis;
mod between;
mod diffuse;
mod field;
mod light;
mod one_pass;
mod passes;
mod polynomials;
mod weights;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use papilio_optics::lobe::Lobe;

use super::plan::{Extrapolation, NarrowPlan};
use super::product;
use crate::adding::panel::first_pass::Pass;
use crate::light::cone_points::Point;
use basis::{Basis, Disc, for_table};
use field::Surroundings;
pub(in super::super) use light::Light;
use passes::Passes;
pub(in super::super) use weights::{Lit, Towards};

/// One width of the lobe: averages between the nodes in air and in the glass.
#[derive(Debug, Clone)]
pub(in super::super) struct Narrow {
    width: f64,
    straight: f64,
    air: Basis,
    glass: Basis,
    /// Over the disc of the glass `[air][glass]`, over that of air `[glass][air]` and, if the diffuser has
    /// regular transmittance, `[air][air]`.
    up: Vec<f64>,
    down: Vec<f64>,
    within: Vec<f64>,
    /// Fraction of light at the underside of the diffuser that leaves, in directions of the glass and of air.
    leaving: Vec<f64>,
    leaving_straight: Vec<f64>,
    /// For each order 2, 3, ... the fractions of light that meets 0, 1, ... lobes.
    shares: Vec<Vec<f64>>,
    /// For each order 2, 3, ... that is exact between points.
    passes: Vec<Passes>,
    has_fields: bool,
    extrapolation: Extrapolation,
}

/// For each order 2, 3, ... that is exact, the difference from the closed form: a coefficient for each
/// product of terms.
pub(in super::super) type Exact = Vec<Vec<f64>>;

/// A view: its weights on the nodes of air, and if there are fields its surroundings, for each exact order.
#[derive(Debug, Clone)]
pub(in super::super) struct Seen {
    weights: Vec<f64>,
    /// Whether they belong to one |beta|.
    is_one_ring: bool,
    around: Arc<[Vec<Surroundings>]>,
}

impl Narrow {
    /// Prepares this width for `orders` orders of the series, with errors of `exp(-digits)`.
    pub(super) fn new(pass: &Pass<'_>, width: f64, plan: &NarrowPlan) -> Self {
        let NarrowPlan { orders, digits, .. } = *plan;
        let (lobe, straight) = (Lobe::KCorrelation { width }, pass.straight());
        let basis = |disc| Basis::new(disc, width, digits, for_table(pass, disc, digits));
        let (air, glass) = (basis(Disc::Air), basis(Disc::Glass(pass.index)));
        let averages = |of: &Basis, at: &Basis| of.averages(lobe, width, &at.radii, digits + MORE_DIGITS);
        let leaving = |basis: &Basis| {
            let of = |radius: &f64| {
                let seen = if *radius <= 1.0 { straight } else { 0.0 };
                seen + (1.0 - straight) * lobe.fraction_in_disc(*radius, 1.0)
            };
            basis.radii.iter().map(of).collect()
        };
        let exact = plan.exact.iter().flatten().zip(2..);
        let passes: Vec<Passes> = exact.map(|(plan, order)| Passes::new(pass, width, order, *plan)).collect();
        Self {
            width,
            straight,
            up: averages(&glass, &air),
            down: averages(&air, &glass),
            within: if straight > 0.0 { averages(&air, &air) } else { Vec::new() },
            leaving: leaving(&glass),
            leaving_straight: leaving(&air),
            shares: shares(straight, orders),
            passes,
            has_fields: plan.has_fields,
            extrapolation: plan.extrapolation,
            air,
            glass,
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }

    pub(super) fn orders(&self) -> usize {
        self.shares.len()
    }

    pub(super) fn nodes(&self) -> usize {
        self.air.len() + self.glass.len()
    }

    /// Returns the radii at which the reflectance of the base is needed: in the glass, and in air.
    pub(super) fn radii(&self) -> [&[f64]; 2] {
        [&self.glass.radii, &self.air.radii]
    }

    /// Returns |beta|² of the directions of the terms of each exact order.
    pub(super) fn squares(&self) -> impl Iterator<Item = Vec<f64>> {
        self.passes.iter().map(|passes| passes.once.squares())
    }

    /// Returns `pi` times the difference of the exact orders from their closed form between groups of points
    /// of a view and of a source, by group of the view and of the source.
    pub(super) fn between(&self, views: &[&[Point]], sources: &[&[Point]]) -> Vec<Vec<Exact>> {
        let mut all = vec![vec![Vec::new(); sources.len()]; views.len()];
        for passes in &self.passes {
            for (all, of_view) in all.iter_mut().zip(passes.between(views, sources)) {
                all.iter_mut().zip(of_view).for_each(|(all, form)| all.push(form));
            }
        }
        all
    }

    /// Returns a view, for all azimuths of its axis.
    pub(in super::super) fn seen(&self, view: &[Point]) -> Seen {
        let mut sum = vec![0.0; self.air.len()];
        for point in view {
            self.air.add_values(point.beta.length(), point.weight, &mut sum);
        }
        let passes = self.passes.iter().filter(|_| self.has_fields);
        let around = passes.map(|passes| passes.surroundings(view)).collect();
        Seen { weights: sum, is_one_ring: weights::are_one_ring(view), around }
    }
}

/// Natural digits of averages beyond those of the basis.
const MORE_DIGITS: f64 = 2.0;

/// Returns for each order 2, 3, ... the fractions of light that meets 0, 1, ... lobes: both ends of a path
/// are scattered at least once in their pass (see [`super`]), unscattered passes are possible between them.
fn shares(straight: f64, orders: usize) -> Vec<Vec<f64>> {
    let (s, t) = (straight, 1.0 - straight);
    let scattered = [0.0, 2.0 * s * t, t * t];
    let first = product(&scattered, &scattered);
    std::iter::successors(Some(first), |last| Some(product(last, &[s * s, 2.0 * s * t, t * t])))
        .take(orders)
        .collect()
}

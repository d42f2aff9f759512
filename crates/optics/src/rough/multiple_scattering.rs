//! Light that has met more than one microfacet: its fraction, and its distribution.
//!
//! Tables are over the square root of the cosine to the normal of the interface, in which grazing light is
//! smooth.

use std::convert::Infallible;
use std::f64::consts::TAU;

use papilio_sampling::warp;

use super::deficit::Rule;
use super::microfacets::Microfacets;
use super::several::{Split, WalkGrid};
use super::{Side, invert};
use crate::Beta;
use crate::chebyshev::Piecewise;

/// Fineness of the tables.
#[derive(Debug)]
pub(super) struct Fineness {
    /// Order of the rule for the deficits.
    pub(super) order: usize,
    /// Largest error of the table between its nodes.
    tolerance: f64,
    /// Width below which pieces of the table are not divided.
    narrowest: f64,
    /// Directions of microfacets in the random walk: azimuths over half a turn, tilts in each of three parts.
    pub(super) azimuths: usize,
    pub(super) tilts: usize,
    /// Its heights and cosines, and the change of chances below which it ends.
    pub(super) walk: WalkGrid,
    pub(super) chance: f64,
}

/// First that of all results, with an error of the deficits below 1e-5; then those of the finer and of the
/// coarser level of a first answer, below 0.002 and 0.005.
pub(super) const FINENESS: [Fineness; 3] = [
    Fineness {
        order: 12,
        tolerance: 2e-6,
        // Beyond 89.99 deg the curvature of the deficit diverges, and there is no light.
        narrowest: 0.01,
        azimuths: 24,
        tilts: 16,
        walk: WalkGrid::Fine,
        chance: 1e-7,
    },
    Fineness {
        order: 7,
        tolerance: 3e-4,
        narrowest: 0.6,
        azimuths: 12,
        tilts: 8,
        walk: WalkGrid::Coarse,
        chance: 1e-4,
    },
    Fineness {
        order: 5,
        tolerance: 2e-3,
        narrowest: 1.1,
        azimuths: 8,
        tilts: 5,
        walk: WalkGrid::Coarsest,
        chance: 1e-3,
    },
];

/// Largest shift of log odds in the search; the result is below 0.05.
const SHIFT: f64 = 2.0;

/// Largest number of pieces; a table of roughness 0.01 has about a tenth of it.
const MOST_PIECES: usize = 100;

/// Mode in which light leaves the interface, relative to the side of incidence.
pub(super) const BACK: usize = 0;
pub(super) const ACROSS: usize = 1;

/// Light that several microfacets send back and across.
///
/// Light that comes from a and leaves to b of the same side X has met several microfacets with the density
/// `r(a) r(b)/R_X`; across, the density is `t(a) t(b)/T`. R and T are the integrals of r and t over the
/// directions of a side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Deficits {
    above: OneSide,
    below: OneSide,
}

#[derive(Debug, Clone, PartialEq)]
struct OneSide {
    /// `[BACK, ACROSS]`.
    table: Piecewise<2>,
    /// Pieces, with the cumulative value of each of the two integrals over directions before them.
    pieces: Vec<Piece>,
    totals: [f64; 2],
}

#[derive(Debug, Clone, PartialEq)]
struct Piece {
    before: [f64; 2],
    from: f64,
    to: f64,
}

impl Deficits {
    pub(super) fn new(facets: &Microfacets, fineness: &Fineness) -> Self {
        let rule = Rule::new(fineness.order);
        let lost = [Side::Above, Side::Below].map(|side| table(facets, &rule, side, fineness));
        let split = Split::new(facets, fineness);
        let both = |shift: f64| {
            let split = split.balanced(shift);
            let [above, below] = [Side::Above, Side::Below].map(|side| {
                let lost = &lost[side as usize];
                OneSide::new(facets.index(side), lost.map(|root, lost| split.of(side, root * root, lost)))
            });
            Self { above, below }
        };
        // The light that crosses is the same from both sides: the smallest change of the odds of crossing
        // that achieves this.
        let unlike = |shift: f64| both(shift).excess();
        let shift =
            invert([-SHIFT, SHIFT], 0.0, |x| -unlike(x), |x| (unlike(x - 1e-4) - unlike(x + 1e-4)) / 2e-4);
        both(shift)
    }

    /// Returns the logarithm of the light that crosses from above, over that from below.
    fn excess(&self) -> f64 {
        let [above, below] = [&self.above, &self.below].map(|side| side.totals[ACROSS]);
        if above > 0.0 && below > 0.0 { (above / below).ln() } else { 0.0 }
    }

    /// Returns the fractions of light at this cosine that are sent back and across.
    pub(super) fn at(&self, side: Side, cosine: f64) -> [f64; 2] {
        self.of(side).table.at(cosine.sqrt()).map(|share| share.max(0.0))
    }

    /// Returns the density per unit area of `beta_o`.
    pub(super) fn density(&self, from: (Side, f64), to: (Side, f64)) -> f64 {
        let way = if from.0 == to.0 { BACK } else { ACROSS };
        let total = self.total(from.0, to.0);
        if total > 0.0 { self.at(from.0, from.1)[way] * self.at(to.0, to.1)[way] / total } else { 0.0 }
    }

    /// Returns the divisor of the products: the integral over directions of a mode; the same from both
    /// sides.
    pub(super) fn total(&self, from: Side, to: Side) -> f64 {
        if from == to {
            self.of(from).totals[BACK]
        } else {
            (self.above.totals[ACROSS] * self.below.totals[ACROSS]).sqrt()
        }
    }

    /// Samples a side and a direction for light from this side at this cosine, with the density above, from
    /// two numbers.
    pub(super) fn sample(&self, facets: &Microfacets, from: (Side, f64), u: [f64; 2]) -> (Side, Beta) {
        let share = self.share_back(from.0, from.1);
        let (to, way, u0) = if u[0] < share {
            (from.0, BACK, u[0] / share)
        } else {
            (from.0.other(), ACROSS, (u[0] - share) / (1.0 - share))
        };
        let n = facets.index(to);
        // There is no direction exactly along the interface.
        let cosine = self.of(to).cosine(n, way, u0).max(1e-7);
        let (x, y) = warp::polar(n * ((1.0 - cosine) * (1.0 + cosine)).sqrt(), u[1]);
        (to, Beta { x, y })
    }

    /// Returns the fraction of light that has met several microfacets which returns to its side.
    pub(super) fn share_back(&self, side: Side, cosine: f64) -> f64 {
        let [back, across] = self.at(side, cosine);
        if back + across > 0.0 { back / (back + across) } else { 0.5 }
    }

    fn of(&self, side: Side) -> &OneSide {
        match side {
            Side::Above => &self.above,
            Side::Below => &self.below,
        }
    }
}

impl OneSide {
    fn new(n: f64, table: Piecewise<2>) -> Self {
        let (mut pieces, mut totals) = (Vec::new(), [0.0; 2]);
        for (number, (from, to)) in table.pieces().enumerate() {
            pieces.push(Piece { before: totals, from, to });
            for (way, total) in totals.iter_mut().enumerate() {
                *total += area(n) * table.moment(way, 3, number)(to).max(0.0);
            }
        }
        Self { table, pieces, totals }
    }

    /// Returns the cosine below which this fraction of one of the integrals lies.
    fn cosine(&self, n: f64, way: usize, share: f64) -> f64 {
        let wanted = share * self.totals[way];
        let number = self.pieces.partition_point(|piece| piece.before[way] <= wanted).saturating_sub(1);
        let piece = &self.pieces[number];
        let density = |root: f64| root.powi(3) * self.table.at(root)[way];
        let moment = self.table.moment(way, 3, number);
        invert([piece.from, piece.to], (wanted - piece.before[way]) / area(n), moment, density).powi(2)
    }
}

/// Returns `d^2 beta` over `x^3 dx`, x the square root of the cosine, for all azimuths together.
fn area(n: f64) -> f64 {
    2.0 * TAU * n * n
}

fn table(facets: &Microfacets, rule: &Rule, side: Side, fineness: &Fineness) -> Piecewise<1> {
    let mut tolerance = fineness.tolerance;
    loop {
        let deficit = |root: f64| Ok::<_, Infallible>([facets.deficit(rule, side, root * root)]);
        let Ok(table) = Piecewise::no_narrower(fineness.narrowest, tolerance, MOST_PIECES, deficit);
        if let Some(table) = table {
            return table;
        }
        // Never needed for the permitted roughnesses.
        tolerance *= 10.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rough::Distribution;

    fn deficits(distribution: Distribution, alpha: f64) -> (Microfacets, Deficits) {
        let facets = Microfacets::new(distribution, alpha, 1.0, 1.5);
        let deficits = Deficits::new(&facets, &FINENESS[0]);
        (facets, deficits)
    }

    /// Compared with the midpoint rule over the cumulative integral up to each sampled direction.
    #[test]
    fn samples_invert_cumulative_deficit() {
        let (facets, deficits) = deficits(Distribution::Ggx, 0.1);
        let steps = 4000;
        let share = |side, way: usize, to: f64| {
            let cosine = |step: i32| to * (f64::from(step) + 0.5) / f64::from(steps);
            let sum: f64 = (0..steps).map(|step| cosine(step) * deficits.at(side, cosine(step))[way]).sum();
            0.5 * area(facets.index(side)) * sum * to / f64::from(steps) / deficits.of(side).totals[way]
        };
        let from = (Side::Below, 0.7);
        let [back, across] = deficits.at(from.0, from.1);
        for step in 0..400 {
            let u = (f64::from(step) + 0.5) / 400.0;
            let (side, beta) = deficits.sample(&facets, from, [u, 0.3]);
            let cosine = (1.0 - beta.squared() / facets.index(side).powi(2)).sqrt();
            let (way, before, all) = if side == from.0 { (BACK, 0.0, back) } else { (ACROSS, back, across) };
            let reached = (before + all * share(side, way, cosine)) / (back + across);
            assert!((reached - u).abs() < 1e-5, "{u}: {side:?} {cosine}: {reached}");
        }
    }

    /// The equations of the random walk are reciprocal except for the grid on which they are solved: the
    /// light that crosses is the same from both sides already before the correction.
    #[test]
    fn crossing_light_is_equal_from_both_sides() {
        for (distribution, alpha) in [(Distribution::Ggx, 0.3), (Distribution::Beckmann, 0.6)] {
            let (facets, balanced) = deficits(distribution, alpha);
            assert!(balanced.excess().abs() < 1e-9);
            let split = Split::new(&facets, &FINENESS[0]);
            let crosses = [Side::Above, Side::Below].map(|side| {
                let steps = 2000;
                let at = |step: i32| {
                    let cosine = (f64::from(step) + 0.5) / f64::from(steps);
                    cosine * split.of(side, cosine, balanced.at(side, cosine).iter().sum())[ACROSS]
                };
                facets.index(side).powi(2) * (0..steps).map(at).sum::<f64>()
            });
            assert!((crosses[0] / crosses[1] - 1.0).abs() < 0.01, "{distribution:?} {alpha}: {crosses:?}");
        }
    }

    /// The coarser tables are as close as they claim, and differ from each other: the two levels of a first
    /// answer do not agree on their error.
    #[test]
    fn coarser_tables_are_within_their_errors() {
        let mut largest = [0.0_f64; 2];
        for (distribution, alpha) in
            [(Distribution::Ggx, 0.05), (Distribution::Ggx, 0.4), (Distribution::Beckmann, 0.2)]
        {
            let (facets, exact) = deficits(distribution, alpha);
            for (fineness, largest) in FINENESS[1..].iter().zip(&mut largest) {
                let coarse = Deficits::new(&facets, fineness);
                for (side, step) in
                    [Side::Above, Side::Below].into_iter().flat_map(|s| (1..=50).map(move |k| (s, k)))
                {
                    let cosine = f64::from(step) / 50.0;
                    let [a, b] = [&coarse, &exact].map(|table| table.at(side, cosine));
                    let error = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
                    // What arrives at this cosine is proportional to it.
                    *largest = largest.max(error * cosine);
                }
            }
        }
        assert!(largest[0] < 0.002 && largest[1] < 0.005 && largest[1] > 1.5 * largest[0], "{largest:?}");
    }
}

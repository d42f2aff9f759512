//! Light that met more than one microfacet: how much there is, and where it goes.

use std::convert::Infallible;
use std::f64::consts::TAU;

use papilio_sampling::warp;

use super::Side;
use super::deficit::Rule;
use super::microfacets::Microfacets;
use crate::Beta;
use crate::chebyshev::Piecewise;

/// Order of the rule that the deficits are integrated with: error below 5e-6.
const ORDER: usize = 12;

/// The largest error of the table between its nodes.
const TOLERANCE: f64 = 2e-6;

/// A table of roughness .01 has about a tenth of this.
const MOST_PIECES: usize = 100;

/// The deficits from both sides, tabulated over the cosine to the face's normal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Deficits {
    above: Piecewise<1>,
    below: Piecewise<1>,
    /// Each piece of both tables, with what lies before it of the integral over directions.
    pieces: Vec<Piece>,
    /// The integral over the directions of both sides.
    pub(super) total: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct Piece {
    before: f64,
    side: Side,
    number: usize,
    from: f64,
    to: f64,
}

impl Deficits {
    pub(super) fn new(facets: &Microfacets) -> Self {
        let rule = Rule::new(ORDER);
        let mut deficits = Self {
            above: table(facets, &rule, Side::Above),
            below: table(facets, &rule, Side::Below),
            pieces: Vec::new(),
            total: 0.0,
        };
        for side in [Side::Above, Side::Below] {
            let table = deficits.of(side).clone();
            for (number, (from, to)) in table.pieces().enumerate() {
                deficits.pieces.push(Piece { before: deficits.total, side, number, from, to });
                deficits.total += area(facets.index(side)) * table.first_moment(number)(to).max(0.0);
            }
        }
        deficits
    }

    /// The deficit at this cosine.
    pub(super) fn at(&self, side: Side, cosine: f64) -> f64 {
        self.of(side).at(cosine)[0].max(0.0)
    }

    /// A side and a direction, with a density in proportion to the deficit.
    pub(super) fn sample(&self, facets: &Microfacets, u: [f64; 2]) -> (Side, Beta) {
        let wanted = u[0] * self.total;
        let next = self.pieces.partition_point(|piece| piece.before <= wanted);
        let piece = &self.pieces[next.saturating_sub(1)];
        let n = facets.index(piece.side);
        let table = self.of(piece.side);
        let moment = table.first_moment(piece.number);
        let density = |cosine: f64| cosine * table.at(cosine)[0];
        let cosine = invert(piece.from, piece.to, (wanted - piece.before) / area(n), moment, density);
        // Along the face itself there is no direction to go to.
        let cosine = cosine.max(1e-7);
        let (x, y) = warp::polar(n * ((1.0 - cosine) * (1.0 + cosine)).sqrt(), u[1]);
        (piece.side, Beta { x, y })
    }

    fn of(&self, side: Side) -> &Piecewise<1> {
        match side {
            Side::Above => &self.above,
            Side::Below => &self.below,
        }
    }
}

/// `d^2 beta` over `cos d cos`, all azimuths together.
fn area(n: f64) -> f64 {
    TAU * n * n
}

fn table(facets: &Microfacets, rule: &Rule, side: Side) -> Piecewise<1> {
    let mut tolerance = TOLERANCE;
    loop {
        let deficit = |cosine| Ok::<_, Infallible>([facets.deficit(rule, side, cosine)]);
        let Ok(table) = Piecewise::new(tolerance, MOST_PIECES, deficit);
        if let Some(table) = table {
            return table;
        }
        // Never for the roughnesses that are allowed.
        tolerance *= 10.0;
    }
}

/// Where the rising function is `wanted`: Newton's method, with bisection where that strays.
fn invert(
    mut from: f64,
    mut to: f64,
    wanted: f64,
    f: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
) -> f64 {
    let mut x = 0.5 * (from + to);
    for _ in 0..60 {
        let miss = f(x) - wanted;
        if miss < 0.0 {
            from = x
        } else {
            to = x
        }
        let step = miss / slope(x);
        if step.abs() < 1e-14 {
            break;
        }
        let newton = x - step;
        x = if newton > from && newton < to { newton } else { 0.5 * (from + to) };
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the midpoint rule over what lies before each direction that is drawn.
    #[test]
    fn drawn_directions_invert_the_cumulative_deficit() {
        let facets = Microfacets { alpha: 0.1, above: 1.0, below: 1.5 };
        let deficits = Deficits::new(&facets);
        let steps = 4000;
        let share = |side, to: f64| {
            let cosine = |step: i32| to * (f64::from(step) + 0.5) / f64::from(steps);
            let sum: f64 = (0..steps).map(|step| cosine(step) * deficits.at(side, cosine(step))).sum();
            area(facets.index(side)) * sum * to / f64::from(steps) / deficits.total
        };
        for step in 0..400 {
            let u = (f64::from(step) + 0.5) / 400.0;
            let (side, beta) = deficits.sample(&facets, [u, 0.3]);
            let cosine = (1.0 - beta.squared() / facets.index(side).powi(2)).sqrt();
            let before = if side == Side::Above { 0.0 } else { share(Side::Above, 1.0) };
            assert!((before + share(side, cosine) - u).abs() < 1e-6, "{u}: {side:?} {cosine}");
        }
    }
}

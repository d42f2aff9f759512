//! Light that the front of screen sends back into the panel, over a specular base.
//!
//! One pass of light above the diffuser is `P = d + S`: `d = s^2 R` keeps the direction, `S`
//! scatters. With `g = r T^2` (r the front's reflectance from below) and `E = 1/(1 - g d)`, all
//! orders are
//!
//! `E [S + g S (1 - g P)^-1 S] E`,
//!
//! the first of which is [`first_pass`](super::first_pass)'s. Since g is small, the rest needs
//! few digits, and the reflectance R in it few terms: order k of the series is a form of degree
//! k in the terms of R (Lagrange's polynomials between a few cosines; under wide lobes fitted, so
//! that means over directions are right even where R is sharper than a polynomial), whose
//! coefficients ([`Forms`]) depend neither on the pixel nor on spectra. Later orders get fewer
//! terms. Where g is too large for that, the series is summed on the grid for each state and
//! wavelength.
//!
//! Lobes narrower than .01 to .03, by what else is asked of it, would need too large a grid: theirs is made for a wider one,
//! the narrower the finer the level. What is recycled between two directions is then multiplied by what the true
//! lobe has there over what the wider one has, of all orders together in closed form ([`Recycling::closed`]). What
//! the rims and the pixel's angles do to recycled light then errs in proportion to the wider lobe's
//! width, times g; the difference between levels shows it.

mod forms;
mod grid;
mod spectra;
mod values;

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::quadrature::{Node, Point, gauss, graded};
use super::first_pass::{Pass, Weights};
use crate::Nodes;
use crate::angular::Stencil;
use forms::Places;
use grid::{Columns, End, Grid, Meridian, NARROW};
pub(super) use spectra::Reflectances;

/// Lobes of this width and wider are on the grid themselves, at every level.
pub(super) const NARROWEST: f64 = 0.035;

/// How far recycled light is followed.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    /// Of the whole result, natural.
    digits: f64,
    /// Natural digits by which a pass weakens the light, rounded down to halves.
    weakening: f64,
    /// Terms of the reflectance in orders 2, 3, ... of the series; none: each column by itself.
    terms: Vec<usize>,
    /// Azimuthal orders.
    orders: usize,
    /// Of recycled light, natural.
    recycled_digits: f64,
    /// The lobe's width on the grid.
    width: f64,
}

/// Terms before which a polynomial does not follow the swings of a film's reflectance over angle
/// at all: about half its phase, 9 rad for a gap of 280 nm at 380 nm.
const TERMS_OF_SWINGS: f64 = 5.0;
/// Natural digits that one more term of the reflectance gives from there on (films, over 0 to 90 deg).
const DIGITS_A_TERM: f64 = 1.2;
/// The same for tables with kinks.
const DIGITS_A_KINK: f64 = 0.5;
/// The largest forms.
const MOST_COEFFICIENTS: usize = 5000;

impl Plan {
    /// For light that loses all but the share `strength` between passes; `reach` is the largest
    /// `sqrt(|beta_v| |beta_l|)` of a view and a directed source. `None` where nothing is sent back.
    pub(super) fn new(pass: &Pass<'_>, strength: f64, reach: Option<f64>) -> Option<Self> {
        let digits = pass.digits;
        let weakening = (-2.0 * strength.min(1.0).ln()).floor() / 2.0;
        if strength <= 0.0 || weakening > digits {
            return None;
        }
        let needed = (digits - weakening).max(LEAST_DIGITS);
        let mut plan =
            Self { digits, weakening, terms: Vec::new(), orders: 1, recycled_digits: needed, width: WIDEST };
        if let Lobe::KCorrelation { width } = pass.diffuser.lobe {
            plan.width = width.min(WIDEST);
            plan.fit(pass, reach);
        }
        plan.terms = plan.forms(pass.table).unwrap_or_default();
        Some(plan)
    }

    /// Gives up digits, then widens the lobe, until the grid is small enough; a finer level has a larger one.
    fn fit(&mut self, pass: &Pass<'_>, reach: Option<f64>) {
        let most = MOST_ELEMENTS * (self.digits / 7.0).exp();
        self.orders = self.orders_for(pass, reach);
        while self.size(pass) > most && self.width < WIDEST {
            if self.recycled_digits > FEWEST_DIGITS_ON_A_LARGE_GRID {
                self.recycled_digits -= 0.5;
            } else {
                self.width *= 1.02;
            }
            self.orders = self.orders_for(pass, reach);
        }
    }

    /// Away from a narrow lobe's peak light is fainter than there, by the cube of the distance; the
    /// grid's error is not.
    fn grid_digits(&self) -> f64 {
        self.recycled_digits + 3.0 * (WIDTH_WITHOUT_PEAK / self.width).ln().max(0.0)
    }

    fn orders_for(&self, pass: &Pass<'_>, reach: Option<f64>) -> usize {
        let lobes = if pass.straight() > 0.0 { 2.0 } else { 4.0 };
        1 + reach.map_or(0, |reach| rounded_up(self.grid_digits() * reach / (lobes * self.width)))
    }

    /// Elements of the lobe between the grid's nodes, roughly.
    fn size(&self, pass: &Pass<'_>) -> f64 {
        let nodes = 0.4 * self.grid_digits() / self.width;
        nodes * nodes * pass.index * self.orders as f64
    }

    /// The azimuthal orders that order `k + 2` of the series needs: fewer where less is left of the light.
    fn orders_of(&self, k: usize) -> usize {
        let left = (self.digits - (k + 1) as f64 * self.weakening) / (self.digits - self.weakening).max(1e-9);
        let orders = ((self.orders - 1) as f64 * left).ceil().max(0.0) as usize;
        (1 + orders).min(self.orders)
    }

    /// The terms of each order, if forms are not too large.
    fn forms(&self, table: &Nodes) -> Option<Vec<usize>> {
        let mut terms = Vec::new();
        let mut size = 0_usize;
        for k in 2_i32.. {
            let left = self.digits - f64::from(k - 1) * self.weakening;
            if left < 0.0 {
                return Some(terms);
            }
            let count = match table {
                Nodes::Constant => 1,
                Nodes::Cosines(_) | Nodes::CosinePanels(_) => {
                    1 + (left / DIGITS_A_TERM + left.min(1.0) * TERMS_OF_SWINGS).ceil() as usize
                }
                Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_) => {
                    1 + (left / DIGITS_A_KINK).ceil() as usize
                }
            };
            size = size.saturating_add(count.saturating_pow(k as u32));
            if size > MOST_COEFFICIENTS || k > 30 {
                return None;
            }
            terms.push(count);
        }
        None
    }
}

/// The coarsest level's grid holds some five times as many elements of the lobe at most ...
const MOST_ELEMENTS: f64 = 6e5;
/// ... in no fewer natural digits than these, if need be with a wider lobe.
const FEWEST_DIGITS_ON_A_LARGE_GRID: f64 = 6.0;
/// The recycled light of lobes from this width on is much the same in all directions.
const WIDTH_WITHOUT_PEAK: f64 = 0.08;
/// No grid is coarser than for lobes of this width.
const WIDEST: f64 = 1.0;

/// Recycled light has at least these natural digits.
const LEAST_DIGITS: f64 = 3.0;

/// The next of 4, 6, 8, 12, 16, 24, ...: so that a light that moves keeps its kernels.
fn rounded_up(orders: f64) -> usize {
    let mut step = 4_usize;
    while (step as f64) < orders {
        step += if step.is_power_of_two() { step / 2 } else { step / 3 };
    }
    step
}

/// Everything that does not depend on views and sources.
#[derive(Debug, Clone)]
pub(super) struct Recycling {
    pub(super) plan: Plan,
    grid: Grid,
    /// One for each order.
    profiles: Vec<Profile>,
}

/// Polynomials in the cosine in the glass, one at one point and zero at the others.
#[derive(Debug, Clone)]
struct Profile {
    /// Gauss's points, or Chebyshev's under a narrow lobe.
    cosines: Vec<f64>,
    /// What makes the reflectance's term at each of a table.
    terms: Vec<Weights>,
    /// `[glass][term]` and `[air][term]`.
    glass: Vec<f64>,
    air: Vec<f64>,
    /// What a view's light is multiplied by: diffuse light after one pass, and reflected by the base,
    /// for each term; and the share that arrives there.
    leaving: End,
    reflected: End,
    arriving: End,
    /// Of forms of this order, and of one degree less.
    places: [Places; 2],
}

/// A group of directions on the grid.
#[derive(Debug, Clone)]
pub(super) struct Group {
    azimuth: f64,
    odd: bool,
    /// In the glass, of its axis.
    cosine: f64,
    /// Shared, as the light is, by groups that are this one at another azimuth.
    meridian: Arc<Meridian>,
    /// For each order of the series: a source's scattered light, and a view's after all passes but one;
    /// of order 2, where there is no such pass, a view needs none.
    light: Arc<Vec<End>>,
}

/// A group's direction itself, in columns `[state][wavelength]`; both empty where no light goes straight.
#[derive(Debug, Clone)]
pub(super) struct Direction {
    /// The base's reflectance.
    pub(super) reflectance: Vec<f64>,
    /// All orders of straight round trips, E.
    pub(super) round_trips: Vec<f64>,
}

impl Group {
    /// The same group at another azimuth, that of its axis there.
    pub(super) fn turned_to(&self, axis: Point) -> Self {
        Self { azimuth: azimuth(axis), ..self.clone() }
    }
}

fn azimuth(axis: Point) -> f64 {
    axis.beta.y.atan2(axis.beta.x)
}

/// Coefficients for each order of the series, one for each product of terms.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Forms(Vec<Vec<f64>>);

/// Forms of what a view sees of diffuse light, and of where its own light goes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OwnForms {
    pub(super) leaving: Forms,
    pub(super) reflected: Forms,
    /// One degree less.
    pub(super) arriving: Forms,
}

impl Recycling {
    pub(super) fn new(pass: &Pass<'_>, plan: Plan) -> Self {
        let lobe = match pass.diffuser.lobe {
            Lobe::KCorrelation { width } => Lobe::KCorrelation { width: width.max(plan.width) },
            Lobe::Lambertian => Lobe::Lambertian,
        };
        let grid = Grid::new(
            pass,
            lobe,
            plan.orders,
            plan.grid_digits(),
            plan.terms.iter().copied().max().unwrap_or(0),
        );
        let profile = |(k, count): (usize, &usize)| Profile::new(&grid, pass, *count, k as u32 + 2);
        let profiles = plan.terms.iter().enumerate().map(profile).collect();
        Self { plan, grid, profiles }
    }

    pub(super) fn nodes(&self) -> usize {
        self.grid.air.len() + self.grid.glass.len()
    }

    /// A view's or a source's group of points, symmetric about the axis's azimuth: alike on both sides, or
    /// opposite (odd; no view is).
    pub(super) fn group(
        &self,
        (points, odd): (&[Point], bool),
        axis: Point,
        index: f64,
        is_view: bool,
    ) -> Group {
        let azimuth = azimuth(axis);
        let radius = axis.beta.length();
        let meridian = self.grid.meridian(points, azimuth, odd);
        let cosine = (1.0 - (radius / index).powi(2)).max(0.0).sqrt();
        let light = |k: usize| match (is_view, k) {
            (true, 0) => End::default(),
            (true, _) => self.scattered(&meridian, cosine, k, k - 1),
            (false, _) => self.scattered(&meridian, cosine, k, 0),
        };
        let light = Arc::new((0..self.profiles.len()).map(light).collect());
        Group { azimuth, odd, cosine, light, meridian: meridian.into() }
    }

    /// A group's light of order `k + 2` after one pass in which it was scattered, and more.
    fn scattered(&self, meridian: &Meridian, cosine: f64, k: usize, passes: usize) -> End {
        let profile = &self.profiles[k];
        let (own, columns, orders) = (profile.at(cosine), profile.columns(), self.plan.orders_of(k));
        let scattered = |m| {
            let light = self.grid.scattered(meridian, m, columns, &own);
            (0..passes).fold(light, |light, _| self.grid.pass(m, &light, columns, false))
        };
        let light: Vec<Vec<f64>> = (0..orders).map(scattered).collect();
        self.grid.end(light.concat(), orders)
    }

    /// `pi` times the recycled kernel between two groups.
    pub(super) fn between(&self, view: &Group, source: &Group) -> Forms {
        let turn = source.azimuth - view.azimuth;
        let form = |(k, profile): (usize, &Profile)| {
            let factors: Vec<f64> =
                (0..self.plan.orders_of(k)).map(|m| PI * azimuth_factor(m, turn, source.odd)).collect();
            profile.places[0].folded(&self.form((k, profile), view, &source.light[k], &factors))
        };
        Forms(self.profiles.iter().enumerate().map(form).collect())
    }

    /// What of a view's light meets other light in order `k + 2` of the series.
    fn form(&self, (k, profile): (usize, &Profile), view: &Group, other: &End, factors: &[f64]) -> Vec<f64> {
        let columns = profile.columns();
        if k == 0 {
            return self.grid.form_of_two(&view.meridian, &profile.at(view.cosine), other, factors, columns);
        }
        self.grid.form(&view.light[k], other, factors, columns)
    }

    /// Orders 2, 3, ... between two sets of points in closed form, by the true lobe and by the grid's if that is
    /// wider, without the powers of g and of the base's reflectance: lobes that follow each other add
    /// their widths, rims apart. `None` where the grid has the lobe itself.
    pub(super) fn closed(&self, lobe: Lobe, view: &[Point], source: &[Point]) -> Option<Closed> {
        let width = match lobe {
            Lobe::KCorrelation { width } if width < self.plan.width => width,
            _ => return None,
        };
        // By the number of lobes on the way: of S, and of a pass P in the middle (see above).
        let (s, t) = (self.grid.straight, 1.0 - self.grid.straight);
        let scattered = [0.0, 2.0 * s * t, t * t];
        let pass = [s * s, 2.0 * s * t, t * t];
        let mut shares = product(&scattered, &scattered);
        let mut closed = Closed::default();
        for order in 0..closed[0].len() {
            for (orders, width) in closed.iter_mut().zip([width, self.plan.width]) {
                let seen = |distance: Beta| -> f64 {
                    let lobes = shares.iter().enumerate().skip(1).filter(|(_, share)| **share > 0.0);
                    let density =
                        |n: f64| Lobe::KCorrelation { width: n * width }.density(Beta::default(), distance);
                    lobes.map(|(n, share)| share * density(n as f64)).sum()
                };
                let of = |v: &Point, l: &Point| v.weight * l.weight * seen(l.beta - v.beta);
                orders[order] = view.iter().flat_map(|v| source.iter().map(move |l| of(v, l))).sum();
            }
            shares = product(&shares, &pass);
        }
        Some(closed)
    }

    pub(super) fn alone(&self, view: &Group) -> OwnForms {
        let form = |k: usize, less: usize, end: fn(&Profile) -> &End| {
            let profile = &self.profiles[k];
            profile.places[less].folded(&self.form((k, profile), view, end(profile), &[1.0]))
        };
        let all = |one: &dyn Fn(usize) -> Vec<f64>| Forms((0..self.profiles.len()).map(one).collect());
        OwnForms {
            leaving: all(&|k| form(k, 0, |profile| &profile.leaving)),
            reflected: all(&|k| form(k, 0, |profile| &profile.reflected)),
            arriving: all(&|k| form(k, 1, |profile| &profile.arriving)),
        }
    }
}

/// Orders 2, 3, ... of the series by a narrow lobe, and by the wider one that a grid has in its place.
pub(super) type Closed = [[f64; 5]; 2];

/// The product of two polynomials.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            out[i + j] += a * b;
        }
    }
    out
}

/// The factor of azimuthal order `m` in the sum over both signs of it.
fn azimuth_factor(m: usize, turn: f64, odd: bool) -> f64 {
    let angle = m as f64 * turn;
    match (m, odd) {
        (_, true) => -2.0 * angle.sin(),
        (0, false) => 1.0,
        (_, false) => 2.0 * angle.cos(),
    }
}

impl Profile {
    /// For forms of this degree.
    fn new(grid: &Grid, pass: &Pass<'_>, count: usize, degree: u32) -> Self {
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

    /// Least squares: the polynomials are orthogonal, each with its point's weight. One term alone is
    /// the mean by projected area.
    fn fit(&self, pass: &Pass<'_>, from: f64, points: &[Node]) -> Vec<Weights> {
        let breaks: Vec<f64> = pass.table.breaks(pass.index);
        let breaks: Vec<f64> =
            breaks.iter().map(|b| (1.0 - (b / pass.index).powi(2)).max(0.0).sqrt()).collect();
        let mut terms = vec![Weights::new(pass.table); points.len()];
        for node in graded(from, 1.0, &breaks, &[], pass.digits) {
            let stencil = look_up(pass, node.x);
            for ((term, value), point) in terms.iter_mut().zip(self.at(node.x)).zip(points) {
                let area = if points.len() == 1 { node.x / point.x } else { 1.0 };
                term.add(&stencil, node.weight * area * value / point.weight);
            }
        }
        terms.into_iter().map(|term| term.finish(pass.table)).collect()
    }

    /// Interpolation.
    fn look_ups(&self, pass: &Pass<'_>) -> Vec<Weights> {
        let term = |cosine: &f64| {
            let mut term = Weights::new(pass.table);
            term.add(&look_up(pass, *cosine), 1.0);
            term.finish(pass.table)
        };
        self.cosines.iter().map(term).collect()
    }

    fn columns(&self) -> Columns<'_> {
        Columns { count: self.cosines.len(), glass: &self.glass, air: &self.air }
    }

    /// The polynomials at a cosine.
    fn at(&self, cosine: f64) -> Vec<f64> {
        let factor = |node: f64, other: f64| (cosine - other) / (node - other);
        let term = |(p, node): (usize, &f64)| {
            let others = self.cosines.iter().enumerate().filter(|(i, _)| *i != p);
            others.map(|(_, other)| factor(*node, *other)).product()
        };
        self.cosines.iter().enumerate().map(term).collect()
    }
}

fn look_up(pass: &Pass<'_>, cosine: f64) -> Stencil {
    pass.look_up(pass.index * (1.0 - cosine * cosine).max(0.0).sqrt())
}

/// Whether means count: interpolation is better near a direction, where narrow lobes keep recycled
/// light, and of tables over angles, which have no resonances.
fn is_fitted(pass: &Pass<'_>) -> bool {
    let narrow = matches!(pass.diffuser.lobe, Lobe::KCorrelation { width } if width <= NARROW);
    !narrow && matches!(pass.table, Nodes::Cosines(_) | Nodes::CosinePanels(_))
}

/// Chebyshev's points on (0, 1).
fn chebyshev(count: usize) -> Vec<Node> {
    let x = |p: usize| 0.5 + 0.5 * (PI * (p as f64 + 0.5) / count as f64).cos();
    (0..count).map(|p| Node { x: x(p), weight: 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Diffuser;

    /// From [`NARROWEST`] on the grid has the lobe itself, at every level and for all directions; well below it has not.
    #[test]
    fn only_narrow_lobes_are_widened() {
        for (level, index, straight_through) in
            [(0.0, 1.5, 0.0), (0.0, 2.0, 0.3), (1.0, 1.5, 0.3), (3.0, 1.7, 0.0)]
        {
            let planned = |width: f64| {
                let lobe = Lobe::KCorrelation { width };
                let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), straight_through };
                let table = &Nodes::Constant;
                let pass = Pass { diffuser: &diffuser, table, index, digits: 11.5 + 3.5 * level };
                Plan::new(&pass, 0.9, Some(1.0)).map(|plan| plan.width)
            };
            assert_eq!(planned(NARROWEST), Some(NARROWEST), "{level} {index} {straight_through}");
            assert!(planned(0.004) > Some(0.01), "{level} {index} {straight_through}");
        }
    }
}

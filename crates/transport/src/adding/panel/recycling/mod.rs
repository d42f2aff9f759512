//! Light that the front of screen sends back into the panel, over a specular base.
//!
//! One pass of light above the diffuser is `P = d + S`: `d = s^2 R` preserves the direction, `S` scatters.
//! With `g = r T^2` (r the front's reflectance from below) and `E = 1/(1 - g d)`, all orders are
//!
//! `E [S + g S (1 - g P)^-1 S] E`,
//!
//! the first of which is computed by [`first_pass`](super::first_pass). Since g is small, the rest needs few
//! digits, and the reflectance R in it few terms: order k of the series is a form of degree k in the terms
//! of R (Lagrange polynomials between a few cosines; under wide lobes fitted, so that means over directions
//! are right even where R varies faster than a polynomial). The coefficients ([`Forms`]) depend neither on
//! the pixel nor on spectra. Later orders get fewer terms. Where g is too large for that, the series is
//! summed on the grid for each state and wavelength.
//!
//! Narrow lobes would need too large a grid. Their light has a basis of its own ([`narrow`]), and a grid for
//! a wider lobe only corrects it; the finer the level, the narrower this lobe.

mod forms;
mod grid;
mod narrow;
mod plan;
mod profile;
mod spectra;
mod values;

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::lobe::Lobe;

use super::first_pass::{Pass, Weights};
use super::projected::Circle;
use crate::light::cone_points::Point;
use grid::{End, Grid, Meridian};
use narrow::Narrow;
pub(super) use narrow::{Exact, Lit, Seen, Towards};
pub(super) use plan::{NARROWEST, Plan};
use profile::Profile;
pub(super) use profile::is_fitted;
pub(super) use spectra::Reflectances;

/// All data that do not depend on views and sources.
#[derive(Debug, Clone)]
pub(super) struct Recycling {
    pub(super) plan: Plan,
    grid: Grid,
    /// One for each order.
    profiles: Vec<Profile>,
    /// The lobe if it is narrow.
    narrow: Option<Narrow>,
}

/// A group of directions on the grid.
#[derive(Debug, Clone)]
pub(super) struct Group {
    azimuth: f64,
    odd: bool,
    /// Cosine of its axis in the glass.
    cosine: f64,
    /// Shared, as the light is, by groups that differ only by a rotation in azimuth.
    meridian: Arc<Meridian>,
    /// For each order of the series: a source's scattered light, and a view's after all passes but one; of
    /// order 2, where there is no such pass, a view needs none.
    light: Arc<Vec<End>>,
}

/// Unscattered light of a group, in columns `[state][wavelength]`; both empty if the diffuser has no regular
/// transmittance.
#[derive(Debug, Clone)]
pub(super) struct Direction {
    /// Reflectance of the base.
    pub(super) reflectance: Vec<f64>,
    /// All orders of unscattered round trips, E.
    pub(super) round_trips: Vec<f64>,
}

impl Group {
    /// Returns how many numbers it has.
    pub(super) fn numbers(&self) -> usize {
        self.meridian.numbers() + self.light.iter().map(End::numbers).sum::<usize>()
    }

    /// Returns the same group rotated to the azimuth of this axis.
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

/// Forms of the diffuse light that a view sees, and of the distribution of its own light.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OwnForms {
    pub(super) leaving: Forms,
    pub(super) reflected: Forms,
    /// Of one degree less.
    pub(super) arriving: Forms,
}

impl Recycling {
    pub(super) fn new(pass: &Pass<'_>, plan: Plan) -> Self {
        let lobe = match pass.diffuser.lobe {
            Lobe::KCorrelation { .. } => Lobe::KCorrelation { width: plan.width },
            Lobe::Lambertian => Lobe::Lambertian,
        };
        let narrow = match (plan.narrow, pass.diffuser.lobe) {
            (Some(narrow), Lobe::KCorrelation { width }) => Some(Narrow::new(pass, width, &narrow)),
            _ => None,
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
        Self { plan, grid, profiles, narrow }
    }

    pub(super) fn nodes(&self) -> usize {
        let narrow = self.narrow.as_ref().map_or(0, Narrow::nodes);
        let grid = if self.plan.has_grid() { self.grid.air.len() + self.grid.glass.len() } else { 0 };
        narrow + grid
    }

    /// Returns a view's or a source's group of points, symmetric about the azimuth of the axis.
    pub(super) fn group(&self, points: &[Point], axis: Point, index: f64, is_view: bool) -> Group {
        self.group_of(self.grid.meridian(points, azimuth(axis)), false, axis, index, is_view)
    }

    /// Returns the group of a part of a field, symmetric about azimuth 0; `axis` is a direction of azimuth 0.
    pub(super) fn group_of_circles(&self, circles: &[Circle], odd: bool, axis: Point, index: f64) -> Group {
        self.group_of(self.grid.meridian_of_circles(circles), odd, axis, index, false)
    }

    fn group_of(&self, meridian: Meridian, odd: bool, axis: Point, index: f64, is_view: bool) -> Group {
        let azimuth = azimuth(axis);
        let cosine = (1.0 - (axis.beta.length() / index).powi(2)).max(0.0).sqrt();
        let light = |k: usize| match (is_view, k) {
            (true, 0) => End::default(),
            (true, _) => self.scattered(&meridian, cosine, k, k - 1),
            (false, _) => self.scattered(&meridian, cosine, k, 0),
        };
        let light = Arc::new((0..self.profiles.len()).map(light).collect());
        Group { azimuth, odd, cosine, light, meridian: meridian.into() }
    }

    /// Returns the light of a group of order `k + 2` after one pass in which it was scattered, and after
    /// further passes.
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

    /// Returns `pi` times the recycled kernel between two groups.
    pub(super) fn between(&self, view: &Group, source: &Group) -> Forms {
        let turn = source.azimuth - view.azimuth;
        let form = |(k, profile): (usize, &Profile)| {
            let factors: Vec<f64> =
                (0..self.plan.orders_of(k)).map(|m| PI * azimuth_factor(m, turn, source.odd)).collect();
            profile.places[0].folded(&self.form((k, profile), view, &source.light[k], &factors))
        };
        Forms(self.profiles.iter().enumerate().map(form).collect())
    }

    /// Returns the kernel for each azimuthal order alone, without its [`azimuth_factor`].
    pub(super) fn between_by_order(&self, view: &Group, source: &Group) -> Vec<Forms> {
        let order = |m: usize| {
            let form = |(k, profile): (usize, &Profile)| {
                if m >= self.plan.orders_of(k) {
                    return Vec::new();
                }
                let mut factors = vec![0.0; m + 1];
                factors[m] = PI;
                profile.places[0].folded(&self.form((k, profile), view, &source.light[k], &factors))
            };
            Forms(self.profiles.iter().enumerate().map(form).collect())
        };
        (0..self.plan.orders).map(order).collect()
    }

    /// Returns the product of a view's light with other light in order `k + 2` of the series.
    fn form(&self, (k, profile): (usize, &Profile), view: &Group, other: &End, factors: &[f64]) -> Vec<f64> {
        let columns = profile.columns();
        if k == 0 {
            return self.grid.form_of_two(&view.meridian, &profile.at(view.cosine), other, factors, columns);
        }
        self.grid.form(&view.light[k], other, factors, columns)
    }

    /// Returns a view's weights under a narrow lobe; `None` under others.
    pub(super) fn seen(&self, view: &[Point]) -> Option<Seen> {
        Some(self.narrow.as_ref()?.seen(view))
    }

    /// Returns a source as seen by a view under a narrow lobe. `None` under others, and if the grid has the
    /// lobe itself.
    pub(super) fn towards(&self, view: (&[Point], &Seen), source: Lit<'_>) -> Option<Towards> {
        let narrow = self.narrow.as_ref()?;
        if !self.plan.has_grid() {
            return Some(narrow.towards(view, source, None));
        }
        let orders = if self.sums_columns() { narrow.orders() } else { self.plan.terms.len() };
        let is_wider = self.plan.width > narrow.width();
        is_wider.then(|| narrow.towards(view, source, Some((self.plan.width, orders))))
    }

    /// See [`Narrow::between`].
    pub(super) fn between_points(&self, views: &[&[Point]], sources: &[&[Point]]) -> Option<Vec<Vec<Exact>>> {
        Some(self.narrow.as_ref()?.between(views, sources))
    }

    /// Returns whether diffuse light has the basis of narrow lobes, not the grid.
    pub(super) fn is_narrow(&self) -> bool {
        self.narrow.is_some()
    }

    /// Returns the sum of forms.
    pub(super) fn total<'a>(&self, forms: impl Iterator<Item = &'a Forms>) -> Forms {
        let zero = |profile: &Profile| vec![0.0; profile.places[0].count()];
        let mut sum = Forms(self.profiles.iter().map(zero).collect());
        for one in forms {
            for (sum, one) in sum.0.iter_mut().zip(&one.0) {
                sum.iter_mut().zip(one).for_each(|(sum, value)| *sum += value);
            }
        }
        sum
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

/// Returns the product of two polynomials.
fn product(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            out[i + j] += a * b;
        }
    }
    out
}

impl Forms {
    /// Returns the sum of forms by azimuthal order, each times its factor.
    pub(super) fn sum(by_order: &[Self], factor: impl Fn(usize) -> f64) -> Self {
        let Some((first, others)) = by_order.split_first() else { return Self(Vec::new()) };
        let mut sum = first.clone();
        sum.0.iter_mut().flatten().for_each(|value| *value *= factor(0));
        for (m, order) in others.iter().enumerate() {
            let factor = factor(m + 1);
            for (sum, order) in sum.0.iter_mut().zip(&order.0) {
                sum.iter_mut().zip(order).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        sum
    }
}

/// Returns the factor of azimuthal order `m` in the sum over both signs of it.
pub(super) fn azimuth_factor(m: usize, turn: f64, odd: bool) -> f64 {
    let angle = m as f64 * turn;
    match (m, odd) {
        (_, true) => -2.0 * angle.sin(),
        (0, false) => 1.0,
        (_, false) => 2.0 * angle.cos(),
    }
}

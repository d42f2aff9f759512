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
//! Lobes narrower than 0.01 to 0.03, by what else is asked of it, would need too large a grid: theirs is made for a wider one,
//! the narrower the finer the level. What is recycled between two directions is then multiplied by what the true
//! lobe has there over what the wider one has, of all orders together in closed form ([`Recycling::closed`]). What
//! the rims and the pixel's angles do to recycled light then errs in proportion to the wider lobe's
//! width, times g; the difference between levels shows it.

mod forms;
mod grid;
mod plan;
mod profile;
mod spectra;
mod values;

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::super::quadrature::Point;
use super::first_pass::{Pass, Weights};
use grid::{End, Grid, Meridian};
pub(super) use plan::{NARROWEST, Plan};
use profile::Profile;
pub(super) use spectra::Reflectances;

/// Everything that does not depend on views and sources.
#[derive(Debug, Clone)]
pub(super) struct Recycling {
    pub(super) plan: Plan,
    grid: Grid,
    /// One for each order.
    profiles: Vec<Profile>,
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

    /// A view's or a source's group of points, symmetric about the axis's azimuth: the same on both sides, or
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

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
//! k in R at a few cosines (Lagrange's polynomials between Chebyshev's points), whose
//! coefficients ([`Forms`]) depend neither on the pixel nor on spectra. Later orders get fewer
//! terms. Where g is too large for that, the series is summed on the grid for each state and
//! wavelength.

mod grid;
mod spectra;

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;

use super::super::quadrature::{Node, Point};
use super::first_pass::Pass;
use crate::Nodes;
use grid::{Columns, Grid, Meridian};
pub(super) use spectra::Reflectances;

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
}

/// Natural digits that one more term of the reflectance gives (films, over 0 to 90 deg).
const DIGITS_A_TERM: f64 = 1.2;
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
        let orders = 1 + match (pass.diffuser.lobe, reach) {
            (Lobe::KCorrelation { width }, Some(reach)) => {
                let width = if pass.straight() > 0.0 { 2.0 * width } else { 4.0 * width };
                rounded_up((digits - weakening).max(LEAST_DIGITS) * reach / width)
            }
            _ => 0,
        };
        let mut plan = Self { digits, weakening, terms: Vec::new(), orders };
        plan.terms = plan.forms(pass.table).unwrap_or_default();
        Some(plan)
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
            let count = (1.0 + (left / DIGITS_A_TERM).ceil()).min(table.count() as f64) as usize;
            size = size.saturating_add(count.saturating_pow(k as u32));
            if size > MOST_COEFFICIENTS || k > 30 {
                return None;
            }
            terms.push(count);
        }
        None
    }
}

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
    /// Chebyshev's points.
    cosines: Vec<f64>,
    /// `[glass][term]` and `[air][term]`.
    glass: Vec<f64>,
    air: Vec<f64>,
    /// Diffuse light after one pass, and reflected by the base: `[air][term]`.
    leaving: Vec<f64>,
    reflected: Vec<f64>,
}

/// A group of directions on the grid.
#[derive(Debug, Clone)]
pub(super) struct Group {
    meridian: Meridian,
    /// For each order of the series and azimuth: scattered light at the air's nodes.
    scattered: Vec<Vec<Vec<f64>>>,
    /// A view's, in all orders but the last pass.
    chains: Vec<Vec<Vec<f64>>>,
}

/// Coefficients for each order of the series.
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
        let digits = (plan.digits - plan.weakening).max(LEAST_DIGITS);
        let grid = Grid::new(pass, plan.orders, digits);
        let profiles = plan.terms.iter().map(|count| Profile::new(&grid, pass.index, *count)).collect();
        Self { plan, grid, profiles }
    }

    pub(super) fn nodes(&self) -> usize {
        self.grid.air.len() + self.grid.glass.len()
    }

    /// A view's or a source's group of points, symmetric about `azimuth`.
    pub(super) fn group(&self, points: &[Point], axis: Point, index: f64, is_view: bool) -> Group {
        let azimuth = axis.beta.y.atan2(axis.beta.x);
        let radius = axis.beta.length();
        let meridian = self.grid.meridian(points, azimuth);
        let orders = 0..self.plan.orders;
        let cosine = (1.0 - (radius / index).powi(2)).max(0.0).sqrt();
        let mut group = Group { meridian, scattered: Vec::new(), chains: Vec::new() };
        for (k, profile) in self.profiles.iter().enumerate() {
            let own = profile.at(cosine);
            let first = |m| self.grid.scattered(&group.meridian, m, profile.columns(), &own);
            let scattered: Vec<Vec<f64>> = orders.clone().map(first).collect();
            if is_view {
                let mut chain = scattered.clone();
                for (m, light) in chain.iter_mut().enumerate() {
                    for _ in 0..k {
                        *light = self.grid.pass(m, light, profile.columns(), false);
                    }
                }
                group.chains.push(chain);
            }
            group.scattered.push(scattered);
        }
        group
    }

    /// `pi` times the recycled kernel between two groups.
    pub(super) fn between(&self, view: &Group, source: &Group) -> Forms {
        let turn = source.meridian.azimuth - view.meridian.azimuth;
        let form = |(k, profile): (usize, &Profile)| {
            let n = profile.cosines.len();
            let mut form = vec![0.0; n.pow(k as u32 + 2)];
            for m in 0..self.plan.orders {
                let scale = PI * azimuth_factor(m, turn);
                self.grid.product(&view.chains[k][m], &source.scattered[k][m], n, scale, &mut form);
            }
            form
        };
        Forms(self.profiles.iter().enumerate().map(form).collect())
    }

    pub(super) fn alone(&self, view: &Group) -> OwnForms {
        let forms = |n: &dyn Fn(&Profile) -> usize, other: &dyn Fn(&Profile) -> Vec<f64>| {
            let form = |(k, profile): (usize, &Profile)| {
                let mut form = vec![0.0; profile.cosines.len().pow(k as u32 + 1) * n(profile)];
                self.grid.product(&view.chains[k][0], &other(profile), n(profile), 1.0, &mut form);
                form
            };
            Forms(self.profiles.iter().enumerate().map(form).collect())
        };
        let terms = |profile: &Profile| profile.cosines.len();
        OwnForms {
            leaving: forms(&terms, &|profile| profile.leaving.clone()),
            reflected: forms(&terms, &|profile| profile.reflected.clone()),
            arriving: forms(&|_| 1, &|_| self.grid.arriving.clone()),
        }
    }
}

/// The factor of azimuthal order `m` in the sum over both signs of it.
fn azimuth_factor(m: usize, turn: f64) -> f64 {
    if m == 0 { 1.0 } else { 2.0 * (m as f64 * turn).cos() }
}

impl Profile {
    fn new(grid: &Grid, index: f64, count: usize) -> Self {
        let cosines: Vec<f64> = if count == 1 {
            vec![TYPICAL_COSINE]
        } else {
            (0..count).map(|p| 0.5 + 0.5 * (PI * (p as f64 + 0.5) / count as f64).cos()).collect()
        };
        let mut profile = Self { cosines, glass: vec![], air: vec![], leaving: vec![], reflected: vec![] };
        let at = |nodes: &[Node]| -> Vec<f64> {
            nodes.iter().flat_map(|n| profile.at((1.0 - (n.x / index).powi(2)).max(0.0).sqrt())).collect()
        };
        let (glass, air) = (at(&grid.glass), at(&grid.air));
        let columns = Columns { count, glass: &glass, air: &air };
        let leaving = grid.diffuse(columns, &grid.leaving, &grid.leaving_straight);
        let reflected = grid.diffuse(columns, &vec![1.0; grid.glass.len()], &vec![1.0; grid.air.len()]);
        (profile.glass, profile.air, profile.leaving, profile.reflected) = (glass, air, leaving, reflected);
        profile
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

/// Where a reflectance of one term is taken: diffuse light in glass, on average.
const TYPICAL_COSINE: f64 = 0.87;

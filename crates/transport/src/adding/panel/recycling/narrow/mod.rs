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
//! For points of light (beams and discs), order 2 is computed without this approximation ([`two_passes`]). The
//! ratio to its closed form corrects the later orders ([`Extrapolation`]), which are weaker by a factor of
//! about g R each.
//!
//! For fields, from the second level on a grid for a wider lobe W shows the error there. The error at b is
//! estimated from it ([`relative_error`]) and added, so that the rest is of the order of b (W - b). The finer
//! the level, the narrower W, down to b.

mod basis;
mod between;
mod two_passes;

#[cfg(test)]
mod tests;

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::forms::Products;
use super::grid::Columns;
use super::plan::{Extrapolation, NarrowPlan};
use super::{azimuth_factor, product};
use crate::adding::panel::first_pass::Pass;
use crate::adding::panel::lobes;
use crate::adding::panel::projected::Circle;
use crate::adding::quadrature::{Node, Point};
use crate::product::add_product;
use basis::{Basis, Disc, for_table};
use between::density;
use two_passes::TwoPasses;

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
    /// If there are points of light.
    two_passes: Option<TwoPasses>,
    extrapolation: Extrapolation,
}

/// Light at the nodes of air over a base, `[node][column]`; columns are `[state][wavelength]`.
#[derive(Debug, Clone)]
pub(in super::super) struct Light {
    /// Powers 0, 1, ... of the reflectance of the base.
    powers: Vec<Vec<f64>>,
    /// For each power of g, 1, 2, ...: diffuse light that a direction sees, and the distribution of its own
    /// light.
    own: Vec<Own<Vec<f64>>>,
    /// Products of two terms of the reflectance.
    products: Option<Products>,
    extrapolation: Extrapolation,
}

/// Diffuse light that leaves, is reflected by the base, and arrives there.
#[derive(Debug, Clone)]
pub(in super::super) struct Own<T> {
    pub(in super::super) leaving: T,
    pub(in super::super) reflected: T,
    pub(in super::super) arriving: T,
}

/// A view's weights on the nodes of air.
#[derive(Debug, Clone)]
pub(in super::super) struct Seen(Vec<f64>);

/// Light of a source, for a closed form.
#[derive(Debug, Clone)]
pub(in super::super) enum Lit<'a> {
    /// Points, and their two passes to the view, a coefficient for each product of terms.
    Points(&'a [Point], Option<Vec<f64>>),
    /// A part of a field and whether it is odd in azimuth.
    Circles(&'a [Circle], bool),
}

/// A source as seen by a view.
#[derive(Debug, Clone)]
pub(in super::super) struct Towards {
    /// Two passes between points, a coefficient for each product of terms; `None` towards a field.
    two_passes: Option<Vec<f64>>,
    /// For each order 2, 3, ... weights on the nodes of air that contain the lobe between view and source.
    lobe: Weights,
    /// The same of the wider lobe of the grid, if there is one, for the orders of the grid.
    wider: Option<Weights>,
    /// Lobe of order 2, times the ratio of its relative error to that of the wider lobe, and the wider lobe.
    correction: [f64; 2],
}

/// By order, `[node]`.
type Weights = Vec<Vec<f64>>;

impl Towards {
    /// Returns the ratio of the error of the closed form to that of the wider lobe for all groups of a
    /// source.
    pub(super) fn correction(groups: &[&Self]) -> f64 {
        let sum = |k: usize| groups.iter().map(|one| one.correction[k]).sum::<f64>();
        if sum(1) > 0.0 { sum(0) / sum(1) } else { 0.0 }
    }
}

/// Returns the relative error of the closed form at this distance between view and source, up to a factor.
/// Far from the peak, one lobe of several deflects the light, and the others are averages over the tails of
/// the lobe: the error is proportional to their width. Around the peak all lobes together deflect it by no
/// more than this distance or the width of all, and the error is proportional to that, too.
fn relative_error(distance: f64, width: f64) -> f64 {
    width * distance.hypot(4.0 * width)
}

impl Narrow {
    /// Prepares this width for `orders` orders of the series, with errors of `exp(-digits)`.
    pub(super) fn new(pass: &Pass<'_>, width: f64, plan: &NarrowPlan) -> Self {
        let NarrowPlan { orders, digits, .. } = *plan;
        let (lobe, straight) = (Lobe::KCorrelation { width }, pass.straight());
        let basis = |disc| Basis::new(disc, width, digits, for_table(pass, disc));
        let (air, glass) = (basis(Disc::Air), basis(Disc::Glass(pass.index)));
        let averages = |of: &Basis, at: &Basis| of.averages(lobe, width, &at.radii, digits + MORE_DIGITS);
        let leaving = |basis: &Basis| {
            let of = |radius: &f64| {
                let seen = if *radius <= 1.0 { straight } else { 0.0 };
                seen + (1.0 - straight) * lobe.fraction_in_disc(*radius, 1.0)
            };
            basis.radii.iter().map(of).collect()
        };
        Self {
            width,
            straight,
            up: averages(&glass, &air),
            down: averages(&air, &glass),
            within: if straight > 0.0 { averages(&air, &air) } else { Vec::new() },
            leaving: leaving(&glass),
            leaving_straight: leaving(&air),
            shares: shares(straight, orders),
            two_passes: (plan.terms > 0).then(|| TwoPasses::new(pass, width, plan.digits_of_two, plan.terms)),
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

    /// Returns |beta|² of the directions of the terms of [`Self::two_passes`].
    pub(super) fn squares(&self) -> Vec<f64> {
        self.two_passes.as_ref().map(TwoPasses::squares).unwrap_or_default()
    }

    /// Returns `pi` times two passes between groups of points of a view and of a source, by group of the view
    /// and of the source; `None` if they are not needed.
    pub(super) fn two_passes(&self, views: &[&[Point]], sources: &[&[Point]]) -> Option<Vec<Vec<Vec<f64>>>> {
        let shares = &self.shares[0];
        let lobe = |away: Beta| {
            let one = |(n, share): (usize, &f64)| share * density(n as f64 * self.width, away);
            shares.iter().enumerate().skip(1).map(one).sum()
        };
        Some(self.two_passes.as_ref()?.between(views, sources, lobe))
    }

    /// Computes the light over a base; `terms` are its reflectances at [`Self::squares`].
    pub(super) fn light(&self, r: Columns<'_>, terms: Vec<f64>) -> Light {
        let (n, s) = (r.count, self.straight);
        let ones = vec![1.0; self.air.len() * n];
        let times_r = |light: &Vec<f64>| Some(light.iter().zip(r.air).map(|(l, r)| l * r).collect());
        let powers = std::iter::successors(Some(ones), times_r).take(self.shares.len() + 2).collect();
        let reaching = |row: &[f64]| s + (1.0 - s) * row.iter().sum::<f64>();
        let arriving = self.up.chunks_exact(self.glass.len()).map(reaching);
        let mut now = Own {
            leaving: self.reflected(r, &self.leaving, &self.leaving_straight),
            reflected: self.reflected(r, &vec![1.0; self.glass.len()], &vec![1.0; self.air.len()]),
            arriving: arriving.flat_map(|share| std::iter::repeat_n(share, n)).collect(),
        };
        let mut own = Vec::with_capacity(self.shares.len());
        for _ in &self.shares {
            let scattered = now.each(|light| self.scattered(light, r));
            if s > 0.0 {
                now = now.with(&scattered, |light, scattered| {
                    let unscattered = light.iter().zip(r.air).map(|(light, r)| s * s * r * light);
                    unscattered.zip(scattered).map(|(a, b)| a + b).collect()
                });
            } else {
                now.clone_from(&scattered);
            }
            own.push(scattered);
        }
        Light {
            powers,
            own,
            products: (!terms.is_empty()).then(|| Products::new(terms, n, 2)),
            extrapolation: self.extrapolation,
        }
    }

    /// Returns light above the diffuser after one reflection by the base, of which these fractions are seen.
    fn reflected(&self, r: Columns<'_>, of_scattered: &[f64], of_straight: &[f64]) -> Vec<f64> {
        let (n, s) = (r.count, self.straight);
        let mut below = r.glass.to_vec();
        for (row, share) in below.chunks_exact_mut(n).zip(of_scattered) {
            row.iter_mut().for_each(|value| *value *= (1.0 - s) * share);
        }
        let mut light = vec![0.0; self.air.len() * n];
        add_product(&self.up, &below, self.glass.len(), &mut light);
        for ((row, r), share) in light.chunks_exact_mut(n).zip(r.air.chunks_exact(n)).zip(of_straight) {
            row.iter_mut().zip(r).for_each(|(value, r)| *value += s * share * r);
        }
        light
    }

    /// Returns light above the diffuser after one pass in which it was scattered.
    fn scattered(&self, light: &[f64], r: Columns<'_>) -> Vec<f64> {
        let s = self.straight;
        let mut below = vec![0.0; self.glass.len() * r.count];
        add_product(&self.down, light, self.air.len(), &mut below);
        below.iter_mut().zip(r.glass).for_each(|(value, r)| *value *= (1.0 - s) * (1.0 - s) * r);
        let mut out = vec![0.0; light.len()];
        add_product(&self.up, &below, self.glass.len(), &mut out);
        if s > 0.0 {
            let mut across = vec![0.0; light.len()];
            add_product(&self.within, light, self.air.len(), &mut across);
            let once = s * (1.0 - s);
            out.iter_mut().zip(&across).zip(r.air).for_each(|((o, a), r)| *o += once * r * a);
            let before: Vec<f64> = light.iter().zip(r.air).map(|(l, r)| once * l * r).collect();
            add_product(&self.within, &before, self.air.len(), &mut out);
        }
        out
    }

    /// Returns a view's weights.
    pub(in super::super) fn seen(&self, view: &[Point]) -> Seen {
        let mut sum = vec![0.0; self.air.len()];
        for point in view {
            self.air.add_values(point.beta.length(), point.weight, &mut sum);
        }
        Seen(sum)
    }

    /// Returns a source as seen by a view; `wider`: width of the grid's lobe and the number of its orders.
    pub(in super::super) fn towards(
        &self,
        view: &[Point],
        source: Lit<'_>,
        wider: Option<(f64, usize)>,
    ) -> Towards {
        let (lobe, _) = self.weights(view, &source, self.width, self.shares.len(), &|_| 1.0);
        let two_passes = if let Lit::Points(_, two_passes) = &source { two_passes.clone() } else { None };
        let Some((width, orders)) = wider else {
            return Towards { two_passes, lobe, wider: None, correction: [0.0; 2] };
        };
        let ratio = |distance: f64| relative_error(distance, self.width) / relative_error(distance, width);
        let (_, times_ratio) = self.weights(view, &source, self.width, 1, &ratio);
        let (wider, of_wider) = self.weights(view, &source, width, orders, &|_| 1.0);
        Towards { two_passes, lobe, wider: Some(wider), correction: [times_ratio, of_wider] }
    }

    /// Returns the lobe of each order between view and source, times a factor of the distance, and the sum of
    /// the first order.
    fn weights(
        &self,
        view: &[Point],
        source: &Lit<'_>,
        width: f64,
        orders: usize,
        factor: &dyn Fn(f64) -> f64,
    ) -> (Weights, f64) {
        let mut all = vec![vec![0.0; self.air.len()]; orders];
        let mut first = 0.0;
        for (order, (shares, sum)) in self.shares.iter().zip(&mut all).enumerate() {
            let met = || shares.iter().enumerate().skip(1).filter(|(_, share)| **share > 0.0);
            let mut add = |radius: f64, weight: f64| {
                if order == 0 {
                    first += weight;
                }
                self.air.add_values(radius, PI * weight, sum);
            };
            match source {
                Lit::Points(points, _) => {
                    let lobe = |away: Beta| {
                        let one = |(n, share): (usize, &f64)| share * density(n as f64 * width, away);
                        met().map(one).sum::<f64>() * factor(away.length())
                    };
                    // Points of a ring follow each other.
                    let same = |a: &Point, b: &Point| (a.beta.length() - b.beta.length()).abs() < SAME_RING;
                    for ring in points.chunk_by(same) {
                        let of = |v: &Point, l: &Point| v.weight * l.weight * lobe(l.beta - v.beta);
                        let both = view.iter().flat_map(|v| ring.iter().map(move |l| of(v, l)));
                        add(ring[0].beta.length(), both.sum());
                    }
                }
                Lit::Circles(circles, odd) => {
                    let mut weights = vec![0.0; circles.len()];
                    for (n, share) in met() {
                        add_circles(view, (circles, *odd), n as f64 * width, |k, away, value| {
                            weights[k] += share * factor(away) * value;
                        });
                    }
                    circles.iter().zip(weights).for_each(|(circle, weight)| add(circle.radius, weight));
                }
            }
        }
        (all, first)
    }
}

/// Calls `each` with the number of each circle of light, its distance from a point of the view, and the sum
/// of a lobe of this width between them.
fn add_circles(
    view: &[Point],
    (circles, odd): (&[Circle], bool),
    width: f64,
    mut each: impl FnMut(usize, f64, f64),
) {
    let nodes: Vec<Node> = circles.iter().map(|circle| Node { x: circle.radius, weight: 1.0 }).collect();
    let count = circles.iter().map(|circle| circle.orders.len()).max().unwrap_or(0);
    for v in view {
        let (radius, turn) = (v.beta.length(), -v.beta.y.atan2(v.beta.x));
        lobes::orders_of_nodes(Lobe::KCorrelation { width }, radius, &nodes, count, |m, first, values| {
            let factor = v.weight * azimuth_factor(m, turn, odd);
            for (k, (circle, value)) in (first..).zip(circles[first..].iter().zip(values)) {
                let light = circle.orders.get(m).copied().unwrap_or(0.0);
                each(k, (circle.radius - radius).abs(), factor * value * light);
            }
        });
    }
}

impl<T> Own<T> {
    fn each(&self, f: impl Fn(&T) -> T) -> Self {
        Self { leaving: f(&self.leaving), reflected: f(&self.reflected), arriving: f(&self.arriving) }
    }

    fn with(&self, other: &Self, f: impl Fn(&T, &T) -> T) -> Self {
        Self {
            leaving: f(&self.leaving, &other.leaving),
            reflected: f(&self.reflected, &other.reflected),
            arriving: f(&self.arriving, &other.arriving),
        }
    }
}

/// Natural digits of averages beyond those of the basis.
const MORE_DIGITS: f64 = 2.0;

/// Difference below which two radii belong to one ring.
const SAME_RING: f64 = 1e-12;

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

impl Light {
    /// Returns the values at these weights of a function at the nodes.
    fn at(function: &[f64], weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; function.len() / weights.len().max(1)];
        add_product(weights, function, weights.len(), &mut sum);
        sum
    }

    /// Returns the recycled light of a view that does not depend on directed sources.
    pub(in super::super) fn own(&self, view: &Seen, g: &[f64]) -> Own<Vec<f64>> {
        let sum = |of: fn(&Own<Vec<f64>>) -> &Vec<f64>| {
            series(self.own.iter().map(|own| Self::at(of(own), &view.0)).collect(), g, false)
        };
        Own {
            leaving: sum(|own| &own.leaving),
            reflected: sum(|own| &own.reflected),
            arriving: sum(|own| &own.arriving),
        }
    }

    /// Returns `pi` times the recycled kernel between a view and a source.
    pub(in super::super) fn between(&self, view: &Seen, source: &Towards, g: &[f64]) -> Vec<f64> {
        let mut orders = self.orders(view, &source.lobe);
        if let (Some(form), Some(products)) = (&source.two_passes, &self.products) {
            let mut two = vec![0.0; g.len()];
            products.add((form, 1), false, g.len(), &mut two);
            let closed = std::mem::replace(&mut orders[0], two);
            let ratio = |(two, closed): (&f64, &f64)| {
                if *closed > 0.0 { (two / closed).clamp(0.0, LARGEST_CORRECTION) } else { 1.0 }
            };
            let ratios: Vec<f64> = orders[0].iter().zip(&closed).map(ratio).collect();
            for (k, order) in orders.iter_mut().enumerate().skip(1) {
                let exponent = self.extrapolation.exponent(k + 2);
                order.iter_mut().zip(&ratios).for_each(|(order, ratio)| *order *= ratio.powf(exponent));
            }
        }
        series(orders, g, false)
    }

    /// Returns the same under the wider lobe; without orders that the grid does not have if `truncated`.
    pub(in super::super) fn under_wider(
        &self,
        view: &Seen,
        source: &Towards,
        g: &[f64],
        truncated: bool,
    ) -> Option<Vec<f64>> {
        Some(series(self.orders(view, source.wider.as_ref()?), g, truncated))
    }

    /// Returns orders 2, 3, ... of the series, without the powers of g.
    fn orders(&self, view: &Seen, weights: &Weights) -> Vec<Vec<f64>> {
        let of_view: Vec<Vec<f64>> =
            self.powers.iter().take(weights.len() + 2).map(|power| Self::at(power, &view.0)).collect();
        let order = |(k, weights): (usize, &Vec<f64>)| {
            let passes = k + 2;
            let mut sum = vec![0.0; of_view[0].len()];
            for (met, of_view) in of_view.iter().enumerate().take(passes + 1) {
                // The first and the last lobe deflect from or to the end of the path.
                let times = if met == 0 || met == passes { 1.0 } else { 2.0 };
                let scale = times / (2 * passes) as f64;
                let of_source = Self::at(&self.powers[passes - met], weights);
                for ((sum, v), l) in sum.iter_mut().zip(of_view).zip(of_source) {
                    *sum += scale * v * l;
                }
            }
            sum
        };
        weights.iter().enumerate().map(order).collect()
    }
}

/// Returns the sum of terms times g, g², ...; those that follow, unless it is truncated, are a geometric
/// series.
fn series(terms: Vec<Vec<f64>>, g: &[f64], truncated: bool) -> Vec<f64> {
    let mut sum = vec![0.0; g.len()];
    for (k, (sum, g)) in sum.iter_mut().zip(g).enumerate() {
        let (mut power, mut last, mut ratio) = (1.0, 0.0, 0.0);
        for term in &terms {
            power *= g;
            let next = power * term[k];
            ratio = if last > 0.0 { next / last } else { 0.0 };
            last = next;
            *sum += next;
        }
        if !truncated && ratio > 0.0 && ratio < LARGEST_RATIO {
            *sum += last * ratio / (1.0 - ratio);
        }
    }
    sum
}

/// Largest ratio of two passes to their closed form that is extrapolated to more.
const LARGEST_CORRECTION: f64 = 1.5;

/// Largest ratio of terms that is taken for that of a geometric series.
const LARGEST_RATIO: f64 = 0.95;

//! Closed form of the light between a view and a source, as weights on the nodes of air.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::azimuth_factor;
use super::between::density;
use super::{Exact, Narrow, Seen};
use crate::adding::panel::projected::Circle;
use crate::adding::panel::{add_scaled, lobes};
use crate::light::cone_points::Point;
use crate::numerics::quadrature::Node;

/// Light of a source, for a closed form.
#[derive(Debug, Clone)]
pub(in super::super::super) enum Lit<'a> {
    /// Points, and their exact passes to the view.
    Points(&'a [Point], Exact),
    /// A part of a field and whether it is odd in azimuth.
    Circles(&'a [Circle], bool),
}

/// A source as seen by a view.
#[derive(Debug, Clone)]
pub(in super::super::super) struct Towards {
    pub(super) exact: Exact,
    /// For each order 2, 3, ... weights on the nodes of air that contain the lobe between view and source.
    pub(super) lobe: Weights,
    /// The same of the wider lobe of the grid, if there is one, for the orders of the grid.
    pub(super) wider: Option<Weights>,
    /// Lobe of order 2, times the ratio of its relative error to that of the wider lobe, and the wider lobe.
    correction: [f64; 2],
}

/// Weights on the nodes of air.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    /// By order, `[node]`.
    pub(super) rows: Vec<Vec<f64>>,
    /// Whether they belong to one |beta|: rows differ only by a factor.
    pub(super) is_one_ring: bool,
}

impl Weights {
    /// Returns the sum over groups; given are the numbers of orders and of nodes.
    pub(super) fn sum(groups: &[&Self], (orders, nodes): (usize, usize)) -> Self {
        if let [one] = groups {
            return (*one).clone();
        }
        let mut rows = vec![vec![0.0; nodes]; orders];
        for group in groups {
            rows.iter_mut().zip(&group.rows).for_each(|(sum, row)| add_scaled(sum, row, 1.0));
        }
        Self { rows, is_one_ring: false }
    }

    /// Returns the ratio of the weight of each order to that of the first one.
    pub(super) fn scales(&self) -> Vec<f64> {
        let weight = |row: &Vec<f64>| row.iter().sum::<f64>();
        let first = self.rows.first().map_or(1.0, weight);
        self.rows.iter().map(|row| weight(row) / first).collect()
    }
}

/// Returns whether points are so close to one |beta| that a power of the mean reflectance is the mean of the
/// power: the difference is of the second order.
pub(super) fn are_one_ring(points: &[Point]) -> bool {
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for radius in points.iter().map(|point| point.beta.length()) {
        (least, most) = (least.min(radius), most.max(radius));
    }
    most - least <= WIDTH_OF_RING
}

/// Largest difference of |beta| on one ring. Where a film's reflectance changes by twice itself over 0.1,
/// recycled light is wrong by 1e-3 at most, and all light by 1e-3 of the fraction that the front sends back.
const WIDTH_OF_RING: f64 = 2e-3;

impl Towards {
    /// Returns the ratio of the error of the closed form to that of the wider lobe for all groups of a
    /// source.
    pub(in super::super) fn correction(groups: &[&Self]) -> f64 {
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
    /// Returns a source as seen by a view; `wider`: width of the grid's lobe and the number of its orders.
    pub(in super::super::super) fn towards(
        &self,
        (view, seen): (&[Point], &Seen),
        source: Lit<'_>,
        wider: Option<(f64, usize)>,
    ) -> Towards {
        let (lobe, _) = self.weights(view, &source, self.width, self.shares.len(), &|_| 1.0);
        let exact = match &source {
            Lit::Points(_, exact) => exact.clone(),
            Lit::Circles(circles, odd) => {
                let orders = self.passes.iter().zip(&*seen.around);
                orders.map(|(passes, around)| passes.of_field((view, around), (circles, *odd))).collect()
            }
        };
        let Some((width, orders)) = wider else {
            return Towards { exact, lobe, wider: None, correction: [0.0; 2] };
        };
        let ratio = |distance: f64| relative_error(distance, self.width) / relative_error(distance, width);
        let (_, times_ratio) = self.weights(view, &source, self.width, 1, &ratio);
        let (wider, of_wider) = self.weights(view, &source, width, orders, &|_| 1.0);
        Towards { exact, lobe, wider: Some(wider), correction: [times_ratio, of_wider] }
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
        let shares = &self.shares[..orders];
        let met = |order: usize| shares[order].iter().enumerate().skip(1).filter(|(_, share)| **share > 0.0);
        let mut all = vec![vec![0.0; self.air.len()]; orders];
        let (mut first, mut values) = (0.0, vec![0.0; self.air.len()]);
        let is_one_ring = matches!(source, Lit::Points(points, _) if points.chunk_by(same_ring).count() == 1);
        let mut add = |radius: f64, weight: &dyn Fn(usize) -> f64| {
            values.fill(0.0);
            self.air.add_values(radius, PI, &mut values);
            first += weight(0);
            for (order, sum) in all.iter_mut().enumerate() {
                add_scaled(sum, &values, weight(order));
            }
        };
        match source {
            Lit::Points(points, _) => {
                let lobe = |order: usize, away: Beta| {
                    let one = |(n, share): (usize, &f64)| share * density(n as f64 * width, away);
                    met(order).map(one).sum::<f64>() * factor(away.length())
                };
                // Points of a ring follow each other.
                for ring in points.chunk_by(same_ring) {
                    add(ring[0].beta.length(), &|order| {
                        let of = |v: &Point, l: &Point| v.weight * l.weight * lobe(order, l.beta - v.beta);
                        view.iter().flat_map(|v| ring.iter().map(move |l| of(v, l))).sum()
                    });
                }
            }
            Lit::Circles(circles, odd) => {
                // By number of lobes, `[circle]`.
                let lobes = shares.iter().map(Vec::len).max().unwrap_or(0);
                let of_lobes = |n: usize| {
                    let mut sums = vec![0.0; circles.len()];
                    if (0..orders).any(|order| met(order).any(|(met, _)| met == n)) {
                        add_circles(view, (circles, *odd), n as f64 * width, |k, away, value| {
                            sums[k] += factor(away) * value;
                        });
                    }
                    sums
                };
                let of_lobes: Vec<Vec<f64>> = (0..lobes).map(of_lobes).collect();
                for (k, circle) in circles.iter().enumerate() {
                    add(circle.radius, &|order| met(order).map(|(n, share)| share * of_lobes[n][k]).sum());
                }
            }
        }
        (Weights { rows: all, is_one_ring }, first)
    }
}

/// Returns whether two points have the same |beta|.
fn same_ring(a: &Point, b: &Point) -> bool {
    (a.beta.length() - b.beta.length()).abs() < SAME_RING
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
    // Orders of the lobe decrease as `exp(-m width)`, or faster.
    let count = count.min((DIGITS_OF_ORDERS / width).ceil() as usize + 2);
    let light = by_order(circles, count);
    let mut sums = vec![0.0; circles.len()];
    for v in view {
        let (radius, turn) = (v.beta.length(), -v.beta.y.atan2(v.beta.x));
        let factors: Vec<f64> = (0..count).map(|m| v.weight * azimuth_factor(m, turn, odd)).collect();
        sums.fill(0.0);
        lobes::orders_of_nodes(Lobe::KCorrelation { width }, radius, &nodes, count, |m, first, values| {
            let light = &light[m * circles.len() + first..];
            for ((sum, light), value) in sums[first..].iter_mut().zip(light).zip(values) {
                *sum += factors[m] * light * value;
            }
        });
        for (k, (circle, sum)) in circles.iter().zip(&sums).enumerate() {
            each(k, (circle.radius - radius).abs(), *sum);
        }
    }
}

/// Returns this number of azimuthal orders of light, `[order][circle]`.
pub(super) fn by_order(circles: &[Circle], count: usize) -> Vec<f64> {
    let order = |m: usize| circles.iter().map(move |circle| circle.orders.get(m).copied().unwrap_or(0.0));
    (0..count).flat_map(order).collect()
}

/// Natural digits of the orders of a lobe, relative to its peak: far from it, light is fainter by a factor of
/// 1e4.
const DIGITS_OF_ORDERS: f64 = 24.0;

/// Difference below which two radii belong to one ring.
const SAME_RING: f64 = 1e-12;

//! Closed form of the light between a view and a source, as weights on the nodes of air.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::azimuth_factor;
use super::between::density;
use super::{Exact, Narrow};
use crate::adding::panel::lobes;
use crate::adding::panel::projected::Circle;
use crate::adding::quadrature::{Node, Point};

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

/// By order, `[node]`.
pub(super) type Weights = Vec<Vec<f64>>;

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
        view: &[Point],
        source: Lit<'_>,
        wider: Option<(f64, usize)>,
    ) -> Towards {
        let (lobe, _) = self.weights(view, &source, self.width, self.shares.len(), &|_| 1.0);
        let exact = match &source {
            Lit::Points(_, exact) => exact.clone(),
            Lit::Circles(..) => Vec::new(),
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

/// Difference below which two radii belong to one ring.
const SAME_RING: f64 = 1e-12;

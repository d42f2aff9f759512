//! Exact passes between a view and a field, under a narrow lobe.
//!
//! Divided by the lobe of all its passes, the light that reaches a view from a direction is the closed form
//! and a difference from it that changes slowly with the direction ([`Passes`]). A few directions around the
//! view represent the difference, whatever the field. Over azimuth it is a sum of few cosines, so that its
//! product with the lobe has orders that are means of those of the lobe, `n` before and after.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::azimuth_factor;
use super::passes::{Cluster, Passes, clusters};
use super::weights::by_order;
use crate::adding::panel::lobes;
use crate::adding::panel::projected::Circle;
use crate::light::cone_points::Point;
use crate::numerics::quadrature::Node;

/// Light from all directions that reaches points of a view close together.
#[derive(Debug, Clone)]
pub(super) struct Surroundings {
    /// Numbers of the points.
    members: Vec<usize>,
    /// Differences from the closed form, `[|l|][n][sequence of terms]` with n of `cos n phi`.
    differences: Vec<f64>,
}

impl Passes {
    /// Returns the surroundings of a view.
    pub(super) fn surroundings(&self, view: &[Point]) -> Vec<Surroundings> {
        let clusters = clusters(&[view], self.digits);
        let one = |cluster: &Cluster| {
            let end = self.once.end(Beta { x: cluster.centre.length(), y: 0.0 });
            let differences = self.cosines(&self.differences_around(&end));
            Surroundings { members: cluster.members.iter().map(|(_, point)| *point).collect(), differences }
        };
        clusters.iter().map(one).collect()
    }

    /// Returns the coefficients of cosines of functions given at the azimuths of each ring.
    fn cosines(&self, at_azimuths: &[f64]) -> Vec<f64> {
        let (turns, row) = (self.turns.len(), self.sequences(self.count));
        // The azimuths are Chebyshev points in the cosine.
        let cosine = |n: usize, turn: usize| {
            let scale = if n == 0 { 1.0 } else { 2.0 };
            scale / turns as f64 * (PI * n as f64 * (turn as f64 + 0.5) / turns as f64).cos()
        };
        let mut out = vec![0.0; at_azimuths.len()];
        for (ring, out) in at_azimuths.chunks_exact(turns * row).zip(out.chunks_exact_mut(turns * row)) {
            for (n, sum) in out.chunks_exact_mut(row).enumerate() {
                for (turn, values) in ring.chunks_exact(row).enumerate() {
                    let factor = cosine(n, turn);
                    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
                }
            }
        }
        out
    }

    /// Returns `pi` times the difference from the closed form of all passes between a view and a part of a
    /// field (and whether it is odd in azimuth), a coefficient for each product of terms.
    pub(super) fn of_field(
        &self,
        (view, around): (&[Point], &[Surroundings]),
        (circles, odd): (&[Circle], bool),
    ) -> Vec<f64> {
        let (rings, turns) = (self.rings.len(), self.turns.len());
        let mut form = vec![0.0; self.sequences(self.count)];
        for one in around {
            let points: Vec<Point> = one.members.iter().map(|point| view[*point]).collect();
            let lit = self.lit(&points, (circles, odd));
            let mut at_rings = vec![0.0; rings * turns];
            let mut at_circle = vec![0.0; rings];
            for (circle, lit) in circles.iter().zip(lit.chunks_exact(turns)) {
                at_circle.fill(0.0);
                self.rings.add_values(circle.radius, 1.0, &mut at_circle);
                for (sums, ring) in at_rings.chunks_exact_mut(turns).zip(&at_circle) {
                    sums.iter_mut().zip(lit).for_each(|(sum, lit)| *sum += ring * lit);
                }
            }
            for (weight, row) in at_rings.iter().zip(one.differences.chunks_exact(form.len())) {
                form.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        self.folded(&form)
    }

    /// Returns `pi` times the light of each circle that reaches points of a view by the lobe of all passes
    /// times `cos n phi`: `[circle][n]`.
    fn lit(&self, view: &[Point], (circles, odd): (&[Circle], bool)) -> Vec<f64> {
        let turns = self.turns.len();
        let nodes: Vec<Node> = circles.iter().map(|circle| Node { x: circle.radius, weight: 1.0 }).collect();
        let count = circles.iter().map(|circle| circle.orders.len()).max().unwrap_or(0);
        let light = by_order(circles, count);
        // Orders of the lobe, `[order][circle]`.
        let all = count + turns;
        let mut orders = vec![0.0; all * circles.len()];
        // `[n][circle]`, and the light of an order.
        let mut sums = vec![0.0; turns * circles.len()];
        let mut now = vec![0.0; circles.len()];
        for v in view {
            orders.fill(0.0);
            for (share, width) in self.lobes(self.count) {
                let lobe = Lobe::KCorrelation { width };
                lobes::orders_of_nodes(lobe, v.beta.length(), &nodes, all, |m, first, values| {
                    let row = &mut orders[m * circles.len() + first..][..values.len()];
                    row.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
                });
            }
            let turn = -v.beta.y.atan2(v.beta.x);
            let row = |order: usize| &orders[order * circles.len()..][..circles.len()];
            for (m, light) in light.chunks_exact(circles.len().max(1)).enumerate() {
                let factor = 0.5 * PI * v.weight * azimuth_factor(m, turn, odd);
                now.iter_mut().zip(light).for_each(|(now, light)| *now = factor * light);
                for (n, sums) in sums.chunks_exact_mut(circles.len()).enumerate() {
                    let both = row(m.abs_diff(n)).iter().zip(row(m + n));
                    for ((sum, light), (before, after)) in sums.iter_mut().zip(&now).zip(both) {
                        *sum += light * (before + after);
                    }
                }
            }
        }
        let of_circle = |k: usize| sums.iter().skip(k).step_by(circles.len()).copied();
        (0..circles.len()).flat_map(of_circle).collect()
    }
}

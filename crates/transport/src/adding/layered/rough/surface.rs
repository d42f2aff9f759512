//! A rough interface that is the surface of a display, with flat layers below it alone: orders on a coarse
//! grid.
//!
//! A surface of small roughness alpha refracts light into a lobe of width `alpha |q_1 - q_2|` around its own
//! `beta`, a third of the width `alpha (q + q)` of the lobe into which it reflects light back inside. Nothing
//! above sends light back, so that light crosses the surface twice: when it enters and when it leaves. All
//! light that is reflected inside in between is as smooth as the wide lobe and needs a grid for that alone.
//! The narrow lobe of a beam acts on it by *product integration*: the factor of a node is the integral of the
//! lobe times the polynomial that interpolates between the nodes
//! ([`Interpolation`](super::super::grid::Interpolation)), by a rule around the beam. Only light that the
//! layers below reflect once, between two narrow lobes, would need more: it has a rule of its own
//! ([`first_bounce`](super::super::first_bounce)).
//!
//! Between nodes only the fraction of refracted light matters, of light that falls from or leaves to all
//! directions. Its kernel there is the product of both fractions over the total, and reflection outside is
//! entered as regular.

use std::sync::atomic::{AtomicBool, Ordering};

use papilio_optics::rough::{Rough, Side};

use super::super::azimuth::Sampling;
use super::super::grid::{Grid, Interpolation};
use super::super::matrix::Matrix;
use super::transforms::Transforms;
use super::{RoughOrders, missing, refraction_width};
use crate::numerics::quadrature::{Pole, radial};

/// Natural digits of orders beyond those of the nodes: the poles of each of three lobes are double,
/// `(1 + m y) exp(-m y)`.
const MORE_DIGITS: f64 = 10.0;
/// Natural digits of the rule around a beam, beyond those of the nodes.
const MORE_DIGITS_OF_LOBES: f64 = 4.0;
/// Largest number of orders.
const MOST_ORDERS: usize = 400;

/// Returns the width of the lobe into which the surface of a medium reflects light inside, at the critical
/// angle.
pub(in super::super) fn inside_width(alpha: f64, index: f64) -> f64 {
    2.0 * alpha * (index * index - 1.0).max(0.0).sqrt()
}

/// Returns the number of orders of light that is reflected inside at least once, between a view and a light
/// with these `|beta|`: it decreases as `exp(-m y)`, y the sum of the distances of the poles of its lobes.
fn orders(face: &Rough, [a, b]: [f64; 2], digits: f64) -> usize {
    let [a, b] = [a, b].map(|radius| radius.max(1e-3));
    let inside = inside_width(face.alpha(), face.index(Side::Below));
    let distance = (1.0 + ((a - b).powi(2) + inside * inside) / (2.0 * a * b)).acosh();
    let lobes: f64 =
        [a, b].iter().map(|radius| (0.5 * refraction_width(face, *radius) / radius).asinh()).sum();
    // Not rounded: each level has more orders than the one before.
    (((digits + MORE_DIGITS) / (distance + 2.0 * lobes)).ceil() as usize).min(MOST_ORDERS)
}

impl RoughOrders {
    /// Computes the orders of a surface, as [`RoughOrders::new`] does; orders beyond the first only if they
    /// are requested, for the largest `|beta|` of views and of lights with an azimuth.
    pub(in super::super) fn of_surface(
        face: &Rough,
        beyond_first: Option<[f64; 2]>,
        sampling: Sampling<'_>,
        known: Option<&Self>,
    ) -> Self {
        let Sampling { grid, digits, stop } = sampling;
        let count = beyond_first.map_or(1, |ends| orders(face, ends, digits));
        let (mut all, known) = Self::between_nodes(grid, count, known);
        let mut transforms = Transforms::new(count, digits);
        if known.is_none() {
            all.reflect_inside(face, grid, &mut transforms, stop);
        }
        all.returned = all.fractions_returned(face, grid, digits as usize + 7, known);
        all.refract_between_nodes(face, grid);
        let interpolation = grid.interpolation();
        for extra in grid.regular..grid.len() {
            if stop.load(Ordering::Relaxed) {
                return all;
            }
            all.refract(face, grid, extra, &interpolation, &mut transforms);
        }
        all.missing = missing(face, &all.part(face, 0, grid), grid);
        all
    }

    /// Computes reflection inside among the nodes with weight.
    fn reflect_inside(&mut self, face: &Rough, grid: &Grid, transforms: &mut Transforms, stop: &AtomicBool) {
        const INSIDE: usize = 2;
        let carried = (0..grid.regular).take_while(|&i| grid.beta[i] < face.index(Side::Below)).count();
        for j in (0..carried).take_while(|_| !stop.load(Ordering::Relaxed)) {
            let rows = (j..carried).map(|i| (i, grid.beta[i])).collect();
            for (i, values) in transforms.between(face, (Side::Below, grid.beta[j]), Side::Below, rows) {
                let scale = grid.scale[i] * grid.scale[j];
                self.set(INSIDE, i, j, grid.len(), &values, scale);
                self.set(INSIDE, j, i, grid.len(), &values, scale);
            }
        }
    }

    /// Returns the fraction of light that one microfacet must send across the interface, besides that which
    /// several send to the nodes on the other side.
    fn crosses(&self, face: &Rough, grid: &Grid, side: Side, node: usize) -> f64 {
        let beta = grid.beta[node];
        if beta >= face.index(side) {
            return 0.0;
        }
        let [_, across] = face.several(side, beta);
        1.0 - self.returned[side as usize][node] - across * several_found(face, grid, side.other())
    }

    /// Computes the kernel of refraction between all nodes but from extra ones above: that of constant light.
    fn refract_between_nodes(&mut self, face: &Rough, grid: &Grid) {
        let [above, below] = [Side::Above, Side::Below].map(|side| -> Vec<f64> {
            (0..grid.len()).map(|i| grid.scale[i] * self.crosses(face, grid, side, i)).collect()
        });
        let total =
            |all: &[f64]| all.iter().zip(&grid.scale).take(grid.regular).map(|(x, s)| x * s).sum::<f64>();
        let mean = 0.5 * (total(&above) + total(&below));
        self.zeroth[1] = Matrix::from_fn(grid.len(), grid.len(), |out, from| {
            let extras = out >= grid.regular && from >= grid.regular;
            if extras { 0.0 } else { below[out] * above[from] / mean }
        });
    }

    /// Computes the light of a beam that is refracted to the nodes.
    fn refract(
        &mut self,
        face: &Rough,
        grid: &Grid,
        extra: usize,
        interpolation: &Interpolation,
        transforms: &mut Transforms,
    ) {
        let (beta, inside) = (grid.beta[extra], face.index(Side::Below));
        // Beyond this, microfacets would have to be steeper than vertical.
        let edge = (beta * beta + inside * inside - 1.0).sqrt();
        let pole = Pole { at: beta, off: refraction_width(face, beta) };
        let digits = transforms.digits() + MORE_DIGITS_OF_LOBES;
        let rule = radial(edge.min(inside), &[1.0], &[pole], digits);
        let rows = rule.iter().enumerate().map(|(k, node)| (k, node.x)).collect();
        let orders = transforms.between(face, (Side::Above, beta), Side::Below, rows);
        let single: f64 = orders.iter().map(|(k, values)| values[0] * rule[*k].weight).sum();
        let whole = self.crosses(face, grid, Side::Above, extra);
        // What the rule misses is little, and lacks everywhere.
        let factor = if single > 0.0 { whole / single } else { 1.0 };
        let mut kernel = Matrix::zeros(grid.regular, self.orders());
        let mut factors = vec![0.0; grid.regular];
        for (k, values) in orders {
            let some = interpolation.add(rule[k].x, factor * rule[k].weight, &mut factors);
            for (order, value) in values.iter().enumerate() {
                let column = kernel.column_mut(order)[some.clone()].iter_mut();
                column.zip(&factors[some.clone()]).for_each(|(sum, factor)| *sum += factor * value);
            }
            factors[some].fill(0.0);
        }
        for i in 0..grid.regular {
            let values: Vec<f64> = (0..self.orders()).map(|order| kernel[(i, order)]).collect();
            self.set(1, i, extra, grid.len(), &values, 1.0 / grid.scale[i]);
        }
    }
}

/// Returns the sum over the nodes of light that several microfacets send to this side, over its integral.
fn several_found(face: &Rough, grid: &Grid, side: Side) -> f64 {
    let total = face.several_total(side, side.other());
    let inside = |node: &(&f64, &f64)| *node.0 < face.index(side);
    let nodes = grid.beta.iter().zip(&grid.scale).take(grid.regular).filter(inside);
    let sum: f64 = nodes.map(|(beta, scale)| scale * scale * face.several(side, *beta)[1]).sum();
    if total > 0.0 { sum / total } else { 1.0 }
}

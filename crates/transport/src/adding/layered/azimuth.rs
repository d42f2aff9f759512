//! Fourier orders over the azimuth of kernels without a closed series.
//!
//! `K_m = 1/pi integral of K(phi) cos(m phi)` over 0 to pi. Where the kernel is wide, the trapezoid rule
//! converges exponentially. Where both directions are near the horizon, microfacets about the normal connect
//! directions that are ever closer in azimuth: there, panels are graded about 0.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use super::grid::Grid;
use crate::numerics::quadrature::gauss;

/// Largest number of intervals of the trapezoid rule from 0 to pi; finer kernels take graded panels.
pub(super) const MOST_INTERVALS: usize = 1024;

/// Nodes and accuracy for which a kernel is sampled.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sampling<'a> {
    pub(super) grid: &'a Grid,
    /// Natural digits in azimuth.
    pub(super) digits: f64,
    /// If it is set during the computation, the orders are incomplete.
    pub(super) stop: &'a AtomicBool,
}

/// Points of a graded panel: enough for its poles, and for this many radians of the highest order.
const POINTS: usize = 14;
const RADIANS: f64 = 16.0;
/// Longest panel, so that the values of tabulated kernels off their peaks are resolved.
const LONGEST: f64 = 0.5;

/// Returns a number of orders of at least this, 8, 12, 16, 24, 32, ...: few numbers, so that similar
/// directions need equally many.
pub(super) fn rounded_up(orders: usize) -> usize {
    let power = orders.max(8).next_power_of_two();
    if orders <= power / 4 * 3 { power / 4 * 3 } else { power }
}

/// Computes the orders of an even function that changes over this width of azimuth about 0 into `out`.
pub(super) fn graded(width: f64, out: &mut [f64], value: impl Fn(f64) -> f64) {
    let longest = (RADIANS / out.len().max(1) as f64).min(LONGEST);
    let mut points = Vec::new();
    let mut from = 0.0;
    while from < PI {
        let to = (from + (1.2 * from).clamp(width.min(longest), longest)).min(PI);
        points.extend(gauss(from, to, POINTS).map(|node| (node.x, node.weight / PI * value(node.x))));
        from = to;
    }
    sum(&points, out);
}

/// Computes the same by the trapezoid rule of `half` intervals; orders that it aliases with lower ones are
/// set to zero.
pub(super) fn trapezoid(half: usize, out: &mut [f64], value: impl Fn(f64) -> f64) {
    let point = |k: usize| {
        let phi = PI * k as f64 / half as f64;
        let ends = if k == 0 || k == half { 0.5 } else { 1.0 };
        (phi, ends / half as f64 * value(phi))
    };
    let told = out.len().min(half + 1);
    out[told..].fill(0.0);
    sum(&(0..=half).map(point).collect::<Vec<_>>(), &mut out[..told]);
}

/// Number of azimuths that are computed together.
const LANES: usize = 8;

/// Sums `value cos(m phi)` over azimuths and values, for each order m, by the recurrence of the cosine.
fn sum(points: &[(f64, f64)], out: &mut [f64]) {
    out.fill(0.0);
    for points in points.chunks(LANES) {
        let mut values = [0.0; LANES];
        let mut cos = [0.0; LANES];
        for (k, (phi, value)) in points.iter().enumerate() {
            (values[k], cos[k]) = (*value, phi.cos());
        }
        let (mut now, mut before) = ([1.0; LANES], cos);
        for sum in out.iter_mut() {
            let mut next = [0.0; LANES];
            for k in 0..LANES {
                *sum += values[k] * now[k];
                next[k] = 2.0 * cos[k] * now[k] - before[k];
            }
            (now, before) = (next, now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The orders of a periodic Gaussian are Gaussians; those of a periodic Lorentzian decrease
    /// geometrically.
    #[test]
    fn narrow_functions_have_the_orders_of_their_closed_series() {
        for width in [0.3_f64, 0.01, 1e-4] {
            let mut out = [0.0; 300];
            graded(width, &mut out, |phi| (-(phi / width).powi(2)).exp());
            for (m, found) in out.iter().enumerate() {
                let closed = width / (2.0 * PI.sqrt()) * (-(m as f64 * width / 2.0).powi(2)).exp();
                assert!((found - closed).abs() < 1e-9 * width, "{width} {m}: {found} {closed}");
            }
            graded(width, &mut out, |phi| width.sinh() / (width.cosh() - phi.cos()));
            for (m, found) in out.iter().enumerate() {
                let closed = (-(m as f64) * width).exp();
                // Accuracy of 14 points at their distance from the poles.
                assert!((found - closed).abs() < 1e-8, "{width} {m}: {found} {closed}");
            }
        }
    }
}

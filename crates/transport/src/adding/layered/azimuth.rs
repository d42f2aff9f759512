//! Fourier orders of kernels over the azimuth that have no closed series.
//!
//! `K_m = 1/pi integral of K(phi) cos(m phi)` over 0 to pi. Where the kernel is wide, the trapezoid rule
//! converges exponentially. Where both directions are near the horizon, facets about the normal join directions
//! that are ever closer in azimuth: there, panels are graded about 0.

use std::f64::consts::PI;

use crate::adding::quadrature::gauss;

/// Intervals of the trapezoid rule from 0 to pi, at most; finer kernels take graded panels.
pub(super) const MOST_INTERVALS: usize = 512;

/// Points of a graded panel: enough for its poles, and for so many radians of the highest order.
const POINTS: usize = 14;
const RADIANS: f64 = 16.0;
/// No panel is longer, for what kernels by numbers do off their peaks.
const LONGEST: f64 = 0.5;

/// The orders of an even function that changes over this width of azimuth about 0, into `out`.
pub(super) fn graded(width: f64, out: &mut [f64], value: impl Fn(f64) -> f64) {
    out.fill(0.0);
    let longest = (RADIANS / out.len().max(1) as f64).min(LONGEST);
    let mut from = 0.0;
    while from < PI {
        let to = (from + (1.2 * from).clamp(width.min(longest), longest)).min(PI);
        for node in gauss(from, to, POINTS) {
            add(node.x, node.weight / PI * value(node.x), out);
        }
        from = to;
    }
}

/// Adds `value cos(m phi)` to each order m.
pub(super) fn add(phi: f64, value: f64, out: &mut [f64]) {
    let cos = phi.cos();
    let (mut now, mut before) = (1.0, cos);
    for sum in out {
        *sum += value * now;
        (now, before) = (2.0 * cos * now - before, now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a periodic Gaussian: orders are Gaussians; of a periodic Lorentzian: they fall geometrically.
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
                assert!((found - closed).abs() < 1e-9, "{width} {m}: {found} {closed}");
            }
        }
    }
}

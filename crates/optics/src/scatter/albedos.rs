//! Albedo: the fraction of light that a kernel scatters into its disc, by incidence.

use std::f64::consts::{FRAC_PI_2, PI};

use super::axis::Axis;
use crate::Beta;
use crate::quadrature::gauss;

/// Integrals at nodes of `|beta|`, up to the last from which light is scattered.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Albedos {
    /// Ends of the two intervals of nodes: within the disc of air, and beyond.
    ends: [f64; 2],
    values: [Vec<f64>; 2],
}

/// Steps within the disc of air, and as many beyond.
const STEPS: usize = 36;

impl Albedos {
    /// Tabulates a function of `|beta|`, the integral; beyond `end`, 1 in air, it is 0.
    pub(super) fn new(end: f64, integral: impl Fn(f64) -> f64) -> Self {
        let ends = [end.min(1.0), end];
        let at = |step: usize| FRAC_PI_2 * step as f64 / STEPS as f64;
        let within = (0..=STEPS).map(|step| integral(ends[0] * at(step).sin()));
        // Beyond the horizon lobes decrease, steeply at first.
        let beyond =
            (0..=STEPS).filter(|_| end > 1.0).map(|step| integral(end - (end - 1.0) * at(step).cos()));
        Self { values: [within.collect(), beyond.collect()], ends }
    }

    /// Returns the albedo at `|beta|`, 0 to 1, or up to the end of the incident disc.
    #[inline]
    pub(super) fn at(&self, length: f64) -> f64 {
        let [within, end] = self.ends;
        // Without light from beyond the disc of air, values above 1 are rounding and count as 1.
        if length > end && end != 1.0 {
            0.0
        } else if length <= within || end <= 1.0 {
            // An end at the normal leaves one value.
            let share = (length / within.max(f64::MIN_POSITIVE)).min(1.0);
            interpolated(&self.values[0], share.asin() / FRAC_PI_2)
        } else {
            interpolated(&self.values[1], ((end - length) / (end - 1.0)).min(1.0).acos() / FRAC_PI_2)
        }
    }
}

/// Integrals interpolated on intervals of `|beta|`, by polynomials through Chebyshev nodes: with one more
/// node in each interval the error decreases by about a factor of five.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Totals {
    /// Ends of the intervals, ascending from 0.
    ends: Vec<f64>,
    points: usize,
    values: Vec<f64>,
}

impl Totals {
    /// Tabulates a function of `|beta|` from 0 to the last of `ends`, by this many nodes between two of them.
    pub(super) fn new(ends: Vec<f64>, points: usize, integral: impl Fn(f64) -> f64) -> Self {
        let values = ends.windows(2).flat_map(|pair| {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            (0..points).map(move |k| middle + half * chebyshev(k, points).0)
        });
        Self { values: values.map(integral).collect(), points, ends }
    }

    /// Returns the integral at `|beta|`; beyond the last end that of the end.
    pub(super) fn at(&self, length: f64) -> f64 {
        let count = self.ends.len() - 1;
        let interval = (self.ends.partition_point(|end| *end <= length).max(1) - 1).min(count - 1);
        let [from, to] = [self.ends[interval], self.ends[interval + 1]];
        let x = ((2.0 * length - from - to) / (to - from)).clamp(-1.0, 1.0);
        let values = &self.values[interval * self.points..][..self.points];
        // Barycentric interpolation.
        let (mut above, mut below) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let (node, weight) = chebyshev(k, self.points);
            if x == node {
                return *value;
            }
            above += weight / (x - node) * value;
            below += weight / (x - node);
        }
        above / below
    }
}

/// Returns Chebyshev node number `k` on [-1, 1], and its barycentric weight.
fn chebyshev(k: usize, points: usize) -> (f64, f64) {
    let (sin, cos) = (PI * (k as f64 + 0.5) / points as f64).sin_cos();
    (cos, if k.is_multiple_of(2) { sin } else { -sin })
}

/// Returns the ends of intervals from 0 to `last` on which the total of a lobe of this width is smooth: they
/// contain `nodes`, are no longer than `longest`, and are graded towards the `edges`, where the lobe leaves
/// its disc.
pub(super) fn intervals(last: f64, edges: &[f64], width: f64, nodes: &[f64], longest: f64) -> Vec<f64> {
    let mut ends = vec![0.0, last];
    ends.extend_from_slice(nodes);
    for edge in edges {
        ends.push(*edge);
        let mut distance = longest;
        while distance > 0.25 * width {
            ends.extend([edge - distance, edge + distance]);
            distance *= 0.5;
        }
    }
    ends.retain(|end| (0.0..=last).contains(end));
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|next, end| *next - *end < 1e-9);
    let parts = |pair: &[f64]| ((pair[1] - pair[0]) / longest - 1e-9).ceil().max(1.0) as usize;
    let divided = ends.windows(2).flat_map(|pair| {
        let (from, count) = (pair[0], parts(pair));
        let step = (pair[1] - from) / count as f64;
        (0..count).map(move |part| from + step * part as f64)
    });
    divided.chain(ends.last().copied()).collect()
}

/// Lagrange interpolation of four points among values at uniform positions from 0 to 1.
#[inline]
fn interpolated(values: &[f64], place: f64) -> f64 {
    four_points(values, place * STEPS as f64).max(0.0)
}

/// Lagrange interpolation of four points among values at positions 0, 1, ...
#[inline]
pub(super) fn four_points(values: &[f64], x: f64) -> f64 {
    let first = (x as usize).saturating_sub(1).min(values.len() - 4);
    let s = x - first as f64;
    let weights = [
        -(s - 1.0) * (s - 2.0) * (s - 3.0) / 6.0,
        s * (s - 2.0) * (s - 3.0) / 2.0,
        -s * (s - 1.0) * (s - 3.0) / 2.0,
        s * (s - 1.0) * (s - 2.0) / 6.0,
    ];
    weights.iter().zip(&values[first..]).map(|(w, v)| w * v).sum()
}

/// Returns the integral over a disc about 0, of radius 1 in air, of a function of distance and azimuth about
/// `|beta| = length` that is smooth between these nodes, by the Gauss rule of this many points in each cell.
pub(super) fn integral(
    radial: &Axis,
    azimuth: &Axis,
    (length, disc): (f64, f64),
    points: usize,
    value: impl Fn(f64, f64) -> f64,
) -> f64 {
    let mut radii = radial.nodes().to_vec();
    // Where circles begin and cease to intersect the rim of the disc, the integrand has a square root.
    let rims = [(disc - length).abs(), disc + length].into_iter();
    let graded =
        rims.flat_map(|r| [0.0, 0.001, 0.004, 0.016, 0.064].into_iter().flat_map(move |d| [r - d, r + d]));
    radii.extend(graded.filter(|r| (0.0..radial.last()).contains(r)));
    radii.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for pair in radii.windows(2).filter(|pair| pair[1] > pair[0]) {
        for (r, weight) in gauss(pair[0], pair[1], points) {
            // Light beyond this azimuth stays within the disc.
            let cosine = (disc * disc - length * length - r * r) / (2.0 * length * r).max(1e-300);
            if cosine <= -1.0 {
                continue;
            }
            let from = cosine.min(1.0).acos();
            for turn in azimuth.nodes().windows(2).filter(|turn| turn[1] > from) {
                for (angle, part) in gauss(turn[0].max(from), turn[1], points) {
                    sum += 2.0 * r * weight * part * value(r, angle);
                }
            }
        }
    }
    sum
}

/// Returns the direction `|beta| = length` along x, and the direction displaced from it by a distance at an
/// azimuth.
pub(super) fn turned(length: f64, distance: f64, azimuth: f64) -> [Beta; 2] {
    debug_assert!((-1e-9..=PI + 1e-9).contains(&azimuth));
    let (sin, cos) = azimuth.sin_cos();
    [Beta { x: length, y: 0.0 }, Beta { x: length + distance * cos, y: distance * sin }]
}

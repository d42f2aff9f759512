//! The matrix term of Gaussian faces in closed form.
//!
//! **All deflections** ([`pixel_power_deviation`]). With the Fourier series of the windows, the mean of the
//! product of two points' light is a sum over pairs of reciprocal vectors G and G' of Gaussians,
//!
//! `E[N²] = p⁻⁴ sum of M_G M_G'* integral over the pixel, twice, of exp(2πi (G·x - G'·y) - 2π² [K²σ² (G² + G'²) - 2 G·C(x-y)·G'])`,
//!
//! C being the correlation of `K m`. Expanded in powers of C, each power of G is a derivative of a window
//! that is blurred by `Kσ`: a Hermite function at each of its edges. The powers of the correlation along x
//! and along y separate. The sum needs few terms, and no reciprocal vectors.
//!
//! **A pupil** blurs the windows by a disc. The sum has a Gaussian of the same mean square instead, times what the disc has of it
//! for small deflections: their variance is the integral over frequencies of that of the windows, blurred by either, times the
//! spectrum of `K m` along the gradient, `(2π)⁴ (f·K·f)² S(f)`.
//!
//! **Small deflections** ([`of_one_window`]). For `Kσ << ξ << w`, only the first power contributes, as an
//! integral along the edges of the window.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::RandomFace;
use papilio_optics::quadrature::gauss;

use crate::{Matrix, Window};

/// Mean modulation transfer of a Gaussian face at a spatial frequency, cycles per mm, for the deflection per
/// slope `K` (mm: xx, xy, yy): `exp(-2 π² σ² |K f|²)`.
pub fn mean_transfer(face: RandomFace, per_slope_mm: [f64; 3], frequency_per_mm: [f64; 2]) -> f64 {
    let [x, y] = super::deflection::applied(per_slope_mm, frequency_per_mm);
    (-2.0 * (PI * face.slope_rms).powi(2) * (x * x + y * y)).exp()
}

/// Largest deflection over the correlation length, and correlation length over the smaller side of the
/// window, at which [`of_one_window`] is within 5 % of [`pixel_power_deviation`].
const SMALL: [f64; 2] = [0.16, 0.5];

/// Pixel power deviation of one dark-bordered window of each pixel, for small deflections along the normal:
/// `K σ sqrt(2 sqrt(π) ξ (w_x + w_y))/(w_x w_y)`.
///
/// `None` where this is in error by more than 5 %: for `Kσ > 0.16 ξ`, for `ξ` above half of the smaller side,
/// and for windows that are nearer to the border of the pixel than `1.5 Kσ`.
pub fn of_one_window(
    face: RandomFace,
    deflection_mm: f64,
    width_mm: f64,
    height_mm: f64,
    border_mm: f64,
) -> Option<f64> {
    let moved = deflection_mm * face.slope_rms;
    let in_range = moved <= SMALL[0] * face.correlation_mm
        && face.correlation_mm <= SMALL[1] * width_mm.min(height_mm)
        && border_mm >= 1.5 * moved;
    let edges = 2.0 * PI.sqrt() * face.correlation_mm * (width_mm + height_mm);
    in_range.then(|| moved * edges.sqrt() / (width_mm * height_mm))
}

/// Pixel power deviation of a matrix seen through a pinhole or a small pupil, by the sum over all powers of
/// the correlation.
///
/// - `per_slope_mm`: the deflection per slope, mm, xx, xy, yy
///   ([`per_slope_mm`](super::Deflection::per_slope_mm)).
/// - `blur_mm`: root mean square along x and along y of the places that a pupil sees, mm
///   ([`blur_mm`](super::Deflection::blur_mm)).
///
/// `None` unless the plane of view is along x or y (`xy` is 0), and the mean of the matrix is above 0.
pub fn pixel_power_deviation(
    face: RandomFace,
    per_slope_mm: [f64; 3],
    matrix: &Matrix,
    blur_mm: [f64; 2],
) -> Option<f64> {
    let [xx, xy, yy] = per_slope_mm;
    let mean = matrix.mean();
    if xy.abs() > 1e-12 * xx.max(yy) || mean.is_nan() || mean <= 0.0 {
        return None;
    }
    let powers = powers_for(face, xx.max(yy));
    let axis = |axis: usize, per_slope: f64| Axis {
        orders: powers[0] + powers[1],
        pitch: matrix.pitch_mm[axis],
        moved: per_slope * face.slope_rms,
        blur: blur_mm[axis],
        windows: matrix.windows.iter().map(|one| [0, 2].map(|end| one.rectangle_mm[end + axis])).collect(),
    };
    let axes = [axis(0, xx), axis(1, yy)];
    let variance = variance(face, &axes, &matrix.windows, powers);
    let disc = disc_over_gaussian(face, &axes, matrix);
    Some((disc * variance.max(0.0)).sqrt() / mean)
}

/// Highest frequency of the spectrum of a face times its correlation length, steps of the frequency in one over the pitch, and most steps
/// to either side.
const HIGHEST: f64 = 1.3;
const STEP: f64 = 0.15;
const MOST_STEPS: f64 = 256.0;

/// Variance for small deflections below a pupil over that of a Gaussian with its mean square.
fn disc_over_gaussian(face: RandomFace, axes: &[Axis; 2], matrix: &Matrix) -> f64 {
    if axes.iter().all(|axis| axis.blur == 0.0) {
        return 1.0;
    }
    let highest = HIGHEST / face.correlation_mm;
    let steps = axes.each_ref().map(|axis| (highest * axis.pitch / STEP).ceil().min(MOST_STEPS));
    let (mut disc, mut gaussian) = (0.0, 0.0);
    for (column, row) in
        (0..steps[0] as i32).flat_map(|x| (-(steps[1] as i32)..=steps[1] as i32).map(move |y| (x, y)))
    {
        // Half of the plane, without the zero.
        let f = [(f64::from(column) + 0.5) / steps[0] * highest, f64::from(row) / steps[1] * highest];
        let phase = |mm: [f64; 2]| 2.0 * PI * (mm[0] * f[0]).hypot(mm[1] * f[1]);
        let moved = phase(axes.each_ref().map(|axis| axis.moved));
        let blurred = phase(axes.each_ref().map(|axis| axis.blur));
        let along: f64 = (0..2).map(|k| axes[k].moved * f[k] * f[k]).sum();
        let spectrum =
            face.height_spectrum(f[0].hypot(f[1])) * (along * (-0.5 * moved * moved).exp()).powi(2);
        let light = spectrum * windows_at(matrix, f);
        // The radius of the disc is twice the root mean square along an axis.
        let radius = 2.0 * blurred;
        let of_disc = if radius < 1e-6 { 1.0 } else { 2.0 * libm::j1(radius) / radius };
        disc += light * of_disc.powi(2);
        gaussian += light * (-blurred * blurred).exp();
    }
    if gaussian > 0.0 { disc / gaussian } else { 1.0 }
}

/// Square of the Fourier transform of the windows of a pixel at a frequency.
fn windows_at(matrix: &Matrix, f: [f64; 2]) -> f64 {
    let mut sum = Complex64::ZERO;
    for Window { rectangle_mm, weight } in &matrix.windows {
        let along = |axis: usize| {
            let (from, to) = (rectangle_mm[axis], rectangle_mm[axis + 2]);
            let half = PI * f[axis] * (to - from);
            let size = if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
            Complex64::from_polar(
                (to - from) * size.abs(),
                PI * f[axis] * (from + to) + if size < 0.0 { PI } else { 0.0 },
            )
        };
        sum += along(0) * along(1) * *weight;
    }
    sum.norm_sqr()
}

/// Highest power of the correlation of the same component, and of different ones (at most 1/e), for errors
/// below 5e-4 of the result; 2e-3 where deflections are larger than the correlation length.
fn powers_for(face: RandomFace, per_slope_mm: f64) -> [usize; 2] {
    let moved = per_slope_mm * face.slope_rms / face.correlation_mm;
    match moved {
        _ if moved < 0.06 => [4, 2],
        _ if moved < 0.2 => [12, 6],
        _ => [24, 10],
    }
}

/// Distance from an edge, in units of the blur, beyond which a window is uniform.
const NEAR: f64 = 12.0;

/// Points of the rules over z, and over y, in each panel.
const POINTS: [usize; 2] = [6, 8];

/// The windows along one axis.
struct Axis {
    /// Number of derivatives.
    orders: usize,
    pitch: f64,
    /// Root mean square deflection.
    moved: f64,
    /// Blur that is not the face's.
    blur: f64,
    windows: Vec<[f64; 2]>,
}

/// A node of the distance z between two points, and the integrals over their place within a pixel.
struct Distance {
    z: f64,
    weight: f64,
    /// For each pair of windows, the terms of its series.
    terms: Vec<Vec<Vec<f64>>>,
}

impl Axis {
    fn blur(&self) -> f64 {
        self.moved.hypot(self.blur)
    }

    /// Integrals for z >= 0 up to a few correlation lengths, or to the pitch.
    fn distances(&self, correlation: f64, series: &Series) -> Vec<Distance> {
        const REACH: f64 = 8.0;
        let (end, blur) = (self.pitch.min(4.0 * correlation), self.blur());
        // Where an edge meets another, the overlap changes within the blur; the correlation changes quickly
        // at z = 0.
        let meetings = self.meetings();
        let mut ends = vec![0.0];
        let mut from = 0.0;
        while from < end {
            let near = meetings.iter().any(|place| (-REACH..REACH).contains(&((from - place) / blur)));
            let starts =
                meetings.iter().map(|place| place - 0.999 * REACH * blur).filter(|start| *start > from);
            let step = if from < REACH * blur { 0.5 * blur } else { blur };
            let next = if near { from + step } else { starts.fold(1.5 * from, f64::min) };
            from = next.min(from + 0.3 * correlation).min(end);
            ends.push(from);
        }
        let nodes = ends.windows(2).flat_map(|ends| gauss(ends[0], ends[1], POINTS[0]));
        let terms = |z: f64| self.overlaps(z).iter().map(|overlaps| series.terms(overlaps)).collect();
        nodes.map(|(z, weight)| Distance { z, weight, terms: terms(z) }).collect()
    }

    /// Distances, from 0 to the pitch, between two edges of windows.
    fn meetings(&self) -> Vec<f64> {
        let edges: Vec<f64> = self.windows.iter().flatten().copied().collect();
        let between = |a: &f64, b: &f64| (a - b).rem_euclid(self.pitch);
        let mut all: Vec<f64> = edges.iter().flat_map(|a| edges.iter().map(move |b| between(a, b))).collect();
        all.extend([0.0, self.pitch]);
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| *a - *b < 0.1 * self.blur());
        all
    }

    /// Integrals over y of derivative a of one window at y + z times derivative b of another at y, both
    /// points within the pixel.
    fn overlaps(&self, z: f64) -> Vec<Vec<f64>> {
        let count = self.windows.len();
        let mut overlaps = vec![vec![0.0; self.orders * self.orders]; count * count];
        for ends in self.panels(z).windows(2) {
            for (x, weight) in gauss(ends[0], ends[1], POINTS[1]) {
                let upper: Vec<_> = (0..count).map(|k| self.derivatives(k, x + z)).collect();
                let lower: Vec<_> = (0..count).map(|k| self.derivatives(k, x)).collect();
                for (pair, overlaps) in overlaps.iter_mut().enumerate() {
                    let (upper, lower) = (&upper[pair / count], &lower[pair % count]);
                    for (row, a) in overlaps.chunks_mut(self.orders).zip(upper) {
                        let a = a * weight;
                        if a != 0.0 {
                            row.iter_mut().zip(lower).for_each(|(sum, b)| *sum += a * b);
                        }
                    }
                }
            }
        }
        overlaps
    }

    /// Ends of panels over y: as wide as the blur near the edges of windows, at y or at y + z, as wide as
    /// possible elsewhere.
    fn panels(&self, z: f64) -> Vec<f64> {
        let (blur, length) = (self.blur(), self.pitch - z);
        let edges = self.windows.iter().flatten().flat_map(|edge| {
            let periods = [-1.0, 0.0, 1.0].map(|period| edge + period * self.pitch);
            periods.into_iter().flat_map(|edge| [edge, edge - z])
        });
        let edges: Vec<f64> = edges.collect();
        let mut ends = vec![0.0];
        let mut from = 0.0;
        while from < length {
            let near = edges.iter().any(|edge| (from - edge).abs() < NEAR * blur);
            let starts = edges.iter().map(|edge| edge - 0.999 * NEAR * blur).filter(|start| *start > from);
            let next = if near { from + blur } else { starts.fold(length, f64::min) };
            from = next.min(length);
            ends.push(from);
        }
        ends
    }

    /// Blurred window and its derivatives: number a times `moved^a/sqrt(a!)`.
    fn derivatives(&self, window: usize, place: f64) -> Vec<f64> {
        let blur = self.blur();
        let mut all = vec![0.0; self.orders];
        let reach = (9.0 * blur / self.pitch).ceil() as i64 + 1;
        for (sign, edge) in [1.0, -1.0].into_iter().zip(self.windows[window]) {
            for period in -reach..=reach {
                let t = (place - edge - period as f64 * self.pitch) / blur;
                all[0] += sign * 0.5 * libm::erfc(-t * std::f64::consts::FRAC_1_SQRT_2);
                if t.abs() > NEAR {
                    continue;
                }
                // Normalised Hermite functions He_k phi/sqrt(k!).
                let (mut last, mut now) = (0.0, (-0.5 * t * t).exp() / (2.0 * PI).sqrt());
                let mut factor = sign;
                for (a, value) in all.iter_mut().enumerate().skip(1) {
                    factor *= self.moved / blur;
                    let flip = if a % 2 == 1 { 1.0 } else { -1.0 };
                    *value += flip * factor * now / (a as f64).sqrt();
                    let next = (t * now - ((a - 1) as f64).sqrt() * last) / (a as f64).sqrt();
                    (last, now) = (now, next);
                }
            }
        }
        all
    }
}

/// Variance of the mean over a pixel.
fn variance(face: RandomFace, axes: &[Axis; 2], windows: &[Window], powers: [usize; 2]) -> f64 {
    let count = windows.len();
    let series = Series::new(axes[0].orders, powers[1]);
    let [x, y] = [0, 1].map(|axis| axes[axis].distances(face.correlation_mm, &series));
    let mut sum = 0.0;
    for along in &x {
        for across in &y {
            // Half of the plane of z: the other half has the windows exchanged.
            for is_exchanged in [false, true] {
                let sign = if is_exchanged { -1.0 } else { 1.0 };
                let correlation = face.slope_correlation([along.z, sign * across.z]);
                let correlation = series.powers(correlation);
                let mut both = 0.0;
                for (pair, terms) in along.terms.iter().enumerate() {
                    let (one, other) = (pair / count, pair % count);
                    // Below, the point at y + z is the lower one.
                    let pair = if is_exchanged { other * count + one } else { pair };
                    let weight = windows[one].weight * windows[other].weight;
                    both += weight * series.sum(&correlation, terms, &across.terms[pair], is_exchanged);
                }
                sum += 2.0 * along.weight * across.weight * both;
            }
        }
    }
    sum / (axes[0].pitch * axes[1].pitch).powi(2)
}

/// Sums over all powers of the correlation, 0 excluded.
struct Series {
    orders: usize,
    /// Highest power of the correlation of different components.
    cross: usize,
    /// For each p and q, at [`Series::at`], `sqrt(binomial(k + p, p) binomial(k + q, q))` for k from 0.
    factors: Vec<Vec<f64>>,
}

impl Series {
    fn new(orders: usize, cross: usize) -> Self {
        let factors = |p: usize, q: usize| {
            let count = if p + q > cross { 0 } else { orders - p.max(q) };
            let next = |last: f64, k: usize| {
                let k = k as f64;
                last * ((k + p as f64) * (k + q as f64)).sqrt() / k
            };
            let all = (1..count).scan(1.0, |last, k| {
                *last = next(*last, k);
                Some(*last)
            });
            std::iter::once(1.0).chain(all).take(count).collect()
        };
        let factors = (0..=cross).flat_map(|p| (0..=cross).map(move |q| factors(p, q))).collect();
        Self { orders, cross, factors }
    }

    fn at(&self, p: usize, q: usize) -> usize {
        p * (self.cross + 1) + q
    }

    /// For each p and q, the integrals of derivatives k + p and k + q, for k from 0, times their factors.
    fn terms(&self, overlaps: &[f64]) -> Vec<Vec<f64>> {
        let terms = |(at, factors): (usize, &Vec<f64>)| {
            let (p, q) = (at / (self.cross + 1), at % (self.cross + 1));
            let overlap = |k: usize| overlaps[(k + p) * self.orders + k + q];
            factors.iter().enumerate().map(|(k, factor)| factor * overlap(k)).collect()
        };
        self.factors.iter().enumerate().map(terms).collect()
    }

    /// Powers, from 0, of the correlation xx, xy and yy, as far as they contribute.
    fn powers(&self, correlation: [f64; 3]) -> [Vec<f64>; 3] {
        // A factor is at most 1e5.
        const LEAST: [f64; 3] = [1e-17, 1e-9, 1e-17];
        let powers = |component: usize| {
            let all = std::iter::successors(Some(1.0), |power| Some(power * correlation[component]));
            all.take(self.orders).take_while(|power: &f64| power.abs() >= LEAST[component]).collect()
        };
        [0, 1, 2].map(powers)
    }

    /// The sum for the [`terms`](Self::terms) along x and y; `is_exchanged`: the first derivative along y is
    /// that of the second point.
    fn sum(&self, [xx, xy, yy]: &[Vec<f64>; 3], x: &[Vec<f64>], y: &[Vec<f64>], is_exchanged: bool) -> f64 {
        let dot =
            |powers: &[f64], terms: &[f64]| -> f64 { powers.iter().zip(terms).map(|(a, b)| a * b).sum() };
        let mut sum = -x[0][0] * y[0][0];
        for p in 0..=self.cross {
            for q in 0..=self.cross - p {
                let Some(cross) = xy.get(p + q) else { break };
                let along_y = if is_exchanged { self.at(p, q) } else { self.at(q, p) };
                sum += cross * dot(xx, &x[self.at(p, q)]) * dot(yy, &y[along_y]);
            }
        }
        sum
    }
}

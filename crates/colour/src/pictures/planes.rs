//! Work on rows of a picture by planes, in single precision: loops that a compiler turns into vectors.
//!
//! All functions are inlined into the caller, which chooses the instructions of the processor.

use super::mapped::SingleMap;
use super::rows::{LANES, Ring, lanes};

/// A matrix times a colour.
#[inline(always)]
pub(super) fn times(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    let row = |k: usize| matrix[k][0] * a + matrix[k][1] * b + matrix[k][2] * c;
    [row(0), row(1), row(2)]
}

/// A colour after a map.
#[inline(always)]
pub(super) fn mapped(map: &SingleMap, pixel: [f32; 3]) -> [f32; 3] {
    let [a, b, c] = times(&map.matrix, pixel);
    [a + map.offset[0], b + map.offset[1], c + map.offset[2]]
}

/// Cube root of a ratio to the white, linear below the toe. Both branches are computed: vectors have no others.
#[inline(always)]
pub(super) fn root(ratio: f32) -> f32 {
    const TOE: f32 = 216.0 / 24_389.0;
    let cube = super::flip::cube_root(if ratio > TOE { ratio } else { TOE });
    let straight = 841.0 / 108.0 * ratio + 16.0 / 116.0;
    if ratio > TOE { cube } else { straight }
}

/// Replaces X, Y and Z relative to the white by CIELAB.
#[inline(always)]
pub(super) fn to_lab([x, y, z]: [&mut [f32]; 3]) {
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let (fx, fy, fz) = (root(*x), root(*y), root(*z));
        (*x, *y, *z) = (116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz));
    }
}

/// Variance of L* in a window below which it has no contrast: a hundredth of a unit, which rounding does not reach.
pub const NO_CONTRAST: f64 = 1e-4;

/// Standard deviations of the values in the windows about the samples of rows; windows end at the borders.
pub(super) struct Contrast {
    columns: usize,
    /// Weights of the samples in a window, from its middle to one side: the last one is only partly in it.
    weights: Vec<f64>,
    /// Weighted sums of the values and of their squares in the windows along rows.
    along: [Ring<f64>; 2],
    /// Values between margins.
    padded: Vec<f64>,
    /// Weights of the windows along rows.
    wide: Vec<f64>,
}

/// Windows that are computed at once.
const WINDOWS: usize = 16;

impl Contrast {
    /// For windows that reach this many pixels from their middle to each side; there is a sample every `step` pixels.
    pub(super) fn new(columns: usize, radius: usize, step: usize) -> Self {
        // The places of the samples vary as much as those of all pixels in the window.
        let variance = (radius * (radius + 1)) as f64 / 3.0;
        let squares = |whole: usize| (step * step * whole * (whole + 1)) as f64 / 3.0;
        let whole = (0..).take_while(|whole| squares(*whole) <= variance).last().unwrap_or(0);
        let mut weights = vec![1.0; whole + 1];
        let (count, next) = ((2 * whole + 1) as f64, ((whole + 1) * step) as f64);
        let rest = 0.5 * count * (variance - squares(whole)) / (next * next - variance);
        if rest > 1e-9 {
            weights.push(rest);
        }
        let (stride, reach) = (columns.next_multiple_of(WINDOWS), weights.len() - 1);
        let wide = |x: usize| {
            let window = x.saturating_sub(reach)..(x + reach + 1).min(columns).max(x + 1);
            window.map(|other| weights[other.abs_diff(x)]).sum()
        };
        Self {
            columns,
            along: [0; 2].map(|_| Ring::new(stride, 2 * reach + 1)),
            padded: vec![0.0; stride + 2 * reach],
            wide: (0..stride).map(wide).collect(),
            weights,
        }
    }

    /// Samples in a window on each side of its middle.
    pub(super) fn reach(&self) -> usize {
        self.weights.len() - 1
    }

    /// Takes the next row.
    #[inline(always)]
    pub(super) fn push(&mut self, row: usize, values: &[f32]) {
        let reach = self.reach();
        let Self { weights, padded, .. } = self;
        padded[reach..].iter_mut().zip(values).for_each(|(to, value)| *to = f64::from(*value));
        let [sums, squares] = self.along.each_mut().map(|ring| ring.row_mut(row));
        let blocks = sums.as_chunks_mut::<WINDOWS>().0.iter_mut().zip(squares.as_chunks_mut::<WINDOWS>().0);
        for (block, (sums, squares)) in blocks.enumerate() {
            let at = block * WINDOWS;
            let mut totals = [[0.0_f64; WINDOWS]; 2];
            for (distance, one) in padded[at..][..WINDOWS + 2 * reach].windows(WINDOWS).enumerate() {
                let weight = weights[distance.abs_diff(reach)];
                let [sums, squares] = &mut totals;
                for k in 0..WINDOWS {
                    sums[k] += weight * one[k];
                    squares[k] += weight * (one[k] * one[k]);
                }
            }
            [*sums, *squares] = totals;
        }
    }

    /// Adds up the standard deviations of a row, of a picture of `rows` rows of which those in the windows were taken.
    #[inline(always)]
    pub(super) fn of_row(&mut self, row: usize, rows: usize, sum: &mut f64) {
        let reach = self.reach();
        let window = row.saturating_sub(reach)..(row + reach + 1).min(rows);
        let high: f64 = window.clone().map(|other| self.weights[other.abs_diff(row)]).sum();
        let [values, squares] = &self.along;
        for first in (0..self.columns).step_by(WINDOWS) {
            let mut totals = [[0.0_f64; WINDOWS]; 2];
            for other in window.clone() {
                let weight = self.weights[other.abs_diff(row)];
                let (values, squares) = (&values.row(other)[first..], &squares.row(other)[first..]);
                let (values, squares) = (&values[..WINDOWS], &squares[..WINDOWS]);
                for k in 0..WINDOWS {
                    totals[0][k] += weight * values[k];
                    totals[1][k] += weight * squares[k];
                }
            }
            let mut deviations = [0.0; WINDOWS];
            let wide = &self.wide[first..first + WINDOWS];
            for k in 0..WINDOWS {
                let count = wide[k] * high;
                let mean = totals[0][k] / count;
                let variance = totals[1][k] / count - mean * mean;
                deviations[k] = if variance > NO_CONTRAST { variance.sqrt() } else { 0.0 };
            }
            deviations.iter().take(self.columns - first).for_each(|one| *sum += one);
        }
    }
}

/// Adds the chroma and hue of two rows of `columns` in CIELAB to sums such as
/// [`Comparison::chromas`](super::Comparison::chromas).
#[inline(always)]
pub(super) fn chromas(
    own: [&[f32]; 3],
    other: [&[f32]; 3],
    columns: usize,
    [coloured, with_hue]: [f32; 2],
    sums: &mut [f64; 4],
) {
    for at in (0..columns).step_by(LANES) {
        let [a, b] = [lanes(own[1], at), lanes(own[2], at)];
        let [other_a, other_b] = [lanes(other[1], at), lanes(other[2], at)];
        let mut parts = [[0.0_f32; LANES]; 4];
        for k in 0..LANES {
            let (a, b, other_a, other_b) = (a[k], b[k], other_a[k], other_b[k]);
            let (chroma, wanted) = ((a * a + b * b).sqrt(), (other_a * other_a + other_b * other_b).sqrt());
            let (across, along) = (other_a * b - other_b * a, other_a * a + other_b * b);
            let turned = wanted * angle(across, along).to_degrees();
            let is_coloured = (wanted > coloured) & (at + k < columns);
            let has_hue = is_coloured & (chroma > with_hue);
            parts[0][k] = if is_coloured { wanted } else { 0.0 };
            parts[1][k] = if is_coloured { chroma } else { 0.0 };
            parts[2][k] = if has_hue { wanted } else { 0.0 };
            parts[3][k] = if has_hue { turned } else { 0.0 };
        }
        for k in 0..LANES {
            for (sum, part) in sums.iter_mut().zip(&parts) {
                *sum += f64::from(part[k]);
            }
        }
    }
}

/// Angle between a vector and its first axis, 0 to pi, within 1e-5.
#[inline(always)]
pub(super) fn angle(across: f32, along: f32) -> f32 {
    let (a, b) = (across.abs(), along.abs());
    let ratio = if a < b { a / b } else { b / a };
    let s = ratio * ratio;
    let series = 0.193_543_46 + s * (-0.116_432_87 + s * (0.052_653_32 - s * 0.011_721_2));
    let small = ratio * (0.999_977_26 + s * (-0.332_623_47 + s * series));
    let first = if a < b { small } else { std::f32::consts::FRAC_PI_2 - small };
    if along < 0.0 { std::f32::consts::PI - first } else { first }
}

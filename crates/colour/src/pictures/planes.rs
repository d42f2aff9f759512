//! Work on the planes of a stripe of a picture, in single precision: loops that a compiler turns into vectors.
//!
//! All functions are inlined into the caller, which chooses the instructions of the processor.

use std::ops::Range;

use super::mapped::SingleMap;

/// A matrix times a colour.
#[inline(always)]
pub(super) fn times(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    let row = |k: usize| matrix[k][0] * a + matrix[k][1] * b + matrix[k][2] * c;
    [row(0), row(1), row(2)]
}

/// The planes of pixels after a map.
#[inline(always)]
pub(super) fn planes(pixels: &[[f32; 3]], map: &SingleMap) -> [Vec<f32>; 3] {
    let mut planes = [0; 3].map(|_| vec![0.0; pixels.len()]);
    let [one, two, three] = &mut planes;
    for (((pixel, one), two), three) in pixels.iter().zip(one).zip(two).zip(three) {
        let [a, b, c] = times(&map.matrix, *pixel);
        (*one, *two, *three) = (a + map.offset[0], b + map.offset[1], c + map.offset[2]);
    }
    planes
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
pub(super) fn to_lab([x, y, z]: &mut [Vec<f32>; 3]) {
    for ((x, y), z) in x.iter_mut().zip(y).zip(z) {
        let (fx, fy, fz) = (root(*x), root(*y), root(*z));
        (*x, *y, *z) = (116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz));
    }
}

/// Filters rows, which continue as their mirror images, with half a kernel.
#[inline(always)]
pub(super) fn along_rows(plane: &[f32], columns: usize, kernel: &[f32], lines: &mut Vec<f32>) {
    let reach = kernel.len() - 1;
    lines.clear();
    lines.resize(plane.len(), 0.0);
    let mut padded = vec![0.0; columns + 2 * reach];
    for (row, into) in plane.chunks_exact(columns).zip(lines.chunks_exact_mut(columns)) {
        padded[reach..][..columns].copy_from_slice(row);
        for k in 0..reach {
            padded[reach - 1 - k] = row[k.min(columns - 1)];
            padded[reach + columns + k] = row[columns - 1 - k.min(columns - 1)];
        }
        into.iter_mut().zip(row).for_each(|(sum, value)| *sum = kernel[0] * value);
        for (distance, weight) in kernel.iter().enumerate().skip(1) {
            let (before, after) = (&padded[reach - distance..], &padded[reach + distance..]);
            for ((sum, before), after) in into.iter_mut().zip(before).zip(after) {
                *sum += weight * (before + after);
            }
        }
    }
}

/// Variance of L* in a window below which it has no contrast: a hundredth of a unit, which rounding does not reach.
pub const NO_CONTRAST: f64 = 1e-4;

/// Sum of the standard deviations in the windows about the pixels of inner rows; windows end at the borders of the
/// plane.
#[inline(always)]
pub(super) fn local_contrast(plane: &[f32], columns: usize, radius: usize, inner: Range<usize>) -> f64 {
    let rows = plane.len() / columns;
    // Sums along the rows, of the values and of their squares.
    let mut along = [vec![0.0_f64; plane.len()], vec![0.0_f64; plane.len()]];
    let mut running = vec![[0.0_f64; 2]; columns + 1];
    let [values, squares] = &mut along;
    for ((row, values), squares) in plane
        .chunks_exact(columns)
        .zip(values.chunks_exact_mut(columns))
        .zip(squares.chunks_exact_mut(columns))
    {
        for (x, value) in row.iter().enumerate() {
            let value = f64::from(*value);
            running[x + 1] = [running[x][0] + value, running[x][1] + value * value];
        }
        for x in 0..columns {
            let (end, first) = (running[(x + radius + 1).min(columns)], running[x.saturating_sub(radius)]);
            (values[x], squares[x]) = (end[0] - first[0], end[1] - first[1]);
        }
    }
    let mut sum = 0.0;
    let mut columns_of = [vec![0.0_f64; columns], vec![0.0_f64; columns]];
    for y in inner {
        let window = y.saturating_sub(radius)..(y + radius + 1).min(rows);
        for (total, along) in columns_of.iter_mut().zip(&along) {
            total.fill(0.0);
            for row in window.clone() {
                total.iter_mut().zip(&along[row * columns..][..columns]).for_each(|(sum, one)| *sum += one);
            }
        }
        let [values, squares] = &columns_of;
        for (x, (value, square)) in values.iter().zip(squares).enumerate() {
            let wide = (x + radius + 1).min(columns) - x.saturating_sub(radius);
            let count = (wide * window.len()) as f64;
            let mean = value / count;
            let variance = square / count - mean * mean;
            sum += if variance > NO_CONTRAST { variance.sqrt() } else { 0.0 };
        }
    }
    sum
}

/// Sums of chroma and hue of two pictures in CIELAB, as [`Comparison::chromas`](super::Comparison::chromas).
#[inline(always)]
pub(super) fn chromas(
    own: &[Vec<f32>; 3],
    other: &[Vec<f32>; 3],
    [coloured, with_hue]: [f32; 2],
) -> [f64; 4] {
    let mut sums = [0.0; 4];
    for at in 0..own[0].len() {
        let (a, b, other_a, other_b) = (own[1][at], own[2][at], other[1][at], other[2][at]);
        let (chroma, wanted) = ((a * a + b * b).sqrt(), (other_a * other_a + other_b * other_b).sqrt());
        if wanted > coloured {
            sums[0] += f64::from(wanted);
            sums[1] += f64::from(chroma);
            if chroma > with_hue {
                let (across, along) = (other_a * b - other_b * a, other_a * a + other_b * b);
                sums[2] += f64::from(wanted);
                sums[3] += f64::from(wanted * angle(across, along).to_degrees());
            }
        }
    }
    sums
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

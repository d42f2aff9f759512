//! The filters of a reader: S-CIELAB's by small kernels and on blocks of pixels, and those of FLIP.

use std::f64::consts::{LN_2, PI};

use pulp::NullaryFnOnce;

use super::difference::Hues;
use super::flip_rows::FlipEye;
use super::mapped::{MappedPicture, SingleMap};
use super::rows::samples;
use super::scielab::{FILTERS, OPPONENT, gaussian};
use super::stripes::Reader;
use crate::matrix::{Matrix, inverse};
use crate::{Adaptation, D65_WHITE, Xyz};

/// Full width at half maximum, degrees, from which a Gaussian is a wide one.
const WIDE_DEG: f64 = 0.5;

/// A picture, and its wide blur by opponent colours and blocks.
pub(super) struct Source<'a> {
    pub(super) pixels: &'a [[f32; 3]],
    pub(super) coarse: [&'a [f32]; 3],
    /// From the pixels to opponent colours.
    pub(super) opponent: SingleMap,
    /// To X, Y, Z relative to the white.
    pub(super) relative: SingleMap,
    /// To linear sRGB on a screen.
    pub(super) screen: SingleMap,
}

/// The filters of a reader.
pub(super) struct Eye {
    pub(super) reader: Reader,
    pub(super) columns: usize,
    pub(super) rows: usize,
    /// Samples along a row, and rows with samples.
    pub(super) across: usize,
    pub(super) down: usize,
    /// From X, Y, Z to opponent colours.
    opponent: [[f32; 3]; 3],
    /// From opponent colours to X, Y, Z relative to the white.
    pub(super) back: [[f32; 3]; 3],
    /// From X, Y, Z relative to the white to linear sRGB on a screen.
    screen: [[f32; 3]; 3],
    /// Narrow kernels of each opponent colour, from the middle to one side.
    pub(super) narrow: [Vec<Vec<f32>>; 3],
    /// Wide kernels of each opponent colour, in blocks, with their weights.
    wide: [Vec<(f32, Vec<f32>)>; 3],
    /// Side of the blocks of wide filters, pixels.
    pub(super) block: usize,
    /// Rows and columns that a narrow kernel reaches.
    pub(super) reach: usize,
    pub(super) hues: Hues,
    pub(super) flip: FlipEye,
}

impl Eye {
    pub(super) fn new(reader: Reader, to_screen: Adaptation, [columns, rows]: [usize; 2]) -> Self {
        let Reader { white, per_degree, .. } = reader;
        let scale = [D65_WHITE.x / white.x, D65_WHITE.y / white.y, D65_WHITE.z / white.z];
        let opponent: Matrix = OPPONENT.map(|row| [0, 1, 2].map(|k| row[k] * scale[k]));
        let whites = white.to_array();
        let inverse = inverse(&opponent);
        let back = [0, 1, 2].map(|i| inverse[i].map(|one| one / whites[i]));
        let unit = |k: usize| {
            let mut xyz = [0.0; 3];
            xyz[k] = whites[k];
            let [x, y, z] = xyz;
            to_screen.apply(Xyz { x, y, z }).linear_srgb()
        };
        let units = [unit(0), unit(1), unit(2)];
        let screen = [0, 1, 2].map(|i| [0, 1, 2].map(|k| units[k][i] as f32));
        let single = |matrix: Matrix| matrix.map(|row| row.map(|one| one as f32));
        let is_wide = |width: f64| width >= WIDE_DEG;
        let narrow = FILTERS.map(|filter| {
            let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
            let kernels = filter.iter().filter(|(width, _)| !is_wide(*width));
            kernels.map(|(width, weight)| kernel(*width, weight / total, per_degree)).collect::<Vec<_>>()
        });
        let widest = FILTERS.iter().copied().flatten().map(|(width, _)| *width).filter(|one| is_wide(*one));
        let sigma = widest.fold(f64::INFINITY, f64::min) * per_degree / (8.0 * LN_2).sqrt();
        let block = 1 << ((sigma / LEAST_IN_BLOCKS).max(1.0).log2() as u32).min(5);
        let wide = FILTERS.map(|filter| {
            let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
            let kernels = filter.iter().filter(|(width, _)| is_wide(*width));
            let of = |(width, weight): &(f64, f64)| {
                ((weight / total) as f32, wide_kernel(*width, per_degree, block))
            };
            kernels.map(of).collect()
        });
        let reach = narrow.iter().flatten().map(|kernel| kernel.len() - 1).max().unwrap_or(0);
        let (opponent, back) = (single(opponent), single(back));
        let (hues, flip) = (Hues::new(), FlipEye::new(per_degree));
        let (across, down) = (columns / reader.step, rows / reader.step);
        Self {
            reader,
            columns,
            rows,
            across,
            down,
            opponent,
            back,
            screen,
            narrow,
            wide,
            block,
            reach,
            hues,
            flip,
        }
    }

    pub(super) fn source<'a>(&self, picture: &MappedPicture<'a>, coarse: [&'a [f32]; 3]) -> Source<'a> {
        let MappedPicture { pixels, map } = picture;
        let [x, y, z] = self.reader.white.to_array().map(|one| (1.0 / one) as f32);
        let relative = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
        let screen = self.screen.map(|[a, b, c]| [a * x, b * y, c * z]);
        let [opponent, relative, screen] =
            [&self.opponent, &relative, &screen].map(|matrix| map.then(matrix));
        Source { pixels, coarse, opponent, relative, screen }
    }

    /// The row of a sample, and the first column with one.
    #[inline(always)]
    pub(super) fn sample(&self, number: usize) -> (usize, usize) {
        let [row, column] = samples(number, self.reader.step);
        (number * self.reader.step + row, column)
    }

    /// Means of blocks of opponent colours, after the wide filters.
    pub(super) fn coarse(&self, picture: MappedPicture<'_>) -> [Vec<f32>; 3] {
        pulp::Arch::new().dispatch(Coarse { eye: self, picture })
    }
}

/// The wide blur of a picture.
struct Coarse<'a> {
    eye: &'a Eye,
    picture: MappedPicture<'a>,
}

/// Place in a row of `count` that continues as its mirror image, and so on.
#[inline(always)]
fn mirrored(at: isize, count: usize) -> usize {
    let at = at.rem_euclid(2 * count as isize) as usize;
    at.min(2 * count - 1 - at)
}

impl NullaryFnOnce for Coarse<'_> {
    type Output = [Vec<f32>; 3];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { eye, picture: MappedPicture { pixels, map } } = self;
        let opponent = map.then(&eye.opponent);
        let block = eye.block;
        let [across, down] = [eye.columns, eye.rows].map(|count| count.div_ceil(block));
        let mut planes = [0; 3].map(|_| vec![0.0_f32; across * down]);
        let scale = 1.0 / (block * block) as f32;
        let mut sums = vec![[0.0_f32; 3]; across * block];
        for row in 0..down {
            sums.fill([0.0; 3]);
            for y in row * block..(row + 1) * block {
                let line = &pixels[mirrored(y as isize, eye.rows) * eye.columns..][..eye.columns];
                let values = sums.as_flattened_mut().iter_mut().zip(line.as_flattened());
                values.for_each(|(sum, value)| *sum += value);
            }
            for x in eye.columns..across * block {
                sums[x] = sums[mirrored(x as isize, eye.columns)];
            }
            for (column, sums) in sums.chunks_exact(block).enumerate() {
                let mut sum = [0.0_f32; 3];
                for one in sums {
                    (0..3).for_each(|k| sum[k] += one[k]);
                }
                for (k, plane) in planes.iter_mut().enumerate() {
                    let mean: f32 = (0..3).map(|j| opponent.matrix[k][j] * (sum[j] * scale)).sum();
                    plane[row * across + column] = mean + opponent.offset[k];
                }
            }
        }
        for (plane, kernels) in planes.iter_mut().zip(&eye.wide) {
            let mut blurred = vec![0.0; plane.len()];
            for (weight, kernel) in kernels {
                add_blurred(plane, across, (*weight, kernel), &mut blurred);
            }
            *plane = blurred;
        }
        planes
    }
}

/// Adds a plane after a kernel along its rows and its columns, with a weight.
#[inline(always)]
fn add_blurred(plane: &[f32], columns: usize, (weight, kernel): (f32, &[f32]), into: &mut [f32]) {
    let (rows, reach) = (plane.len() / columns, kernel.len() - 1);
    let places = |count: usize| -> Vec<usize> {
        (0..count + 2 * reach).map(|at| mirrored(at as isize - reach as isize, count)).collect()
    };
    let [across, down] = [columns, rows].map(places);
    let mut padded = vec![0.0; columns + 2 * reach];
    let mut along = vec![0.0; plane.len()];
    for (row, along) in plane.chunks_exact(columns).zip(along.chunks_exact_mut(columns)) {
        padded.iter_mut().zip(&across).for_each(|(to, from)| *to = row[*from]);
        for (at, one) in padded.windows(columns).enumerate() {
            let weight = kernel[at.abs_diff(reach)];
            along.iter_mut().zip(one).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    for (y, into) in into.chunks_exact_mut(columns).enumerate() {
        for at in 0..=2 * reach {
            let weight = weight * kernel[at.abs_diff(reach)];
            let row = &along[down[y + at] * columns..][..columns];
            into.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
    }
}

/// Standard deviation of the narrowest wide Gaussian, in blocks, at least.
const LEAST_IN_BLOCKS: f64 = 2.5;

/// Samples of a wide Gaussian in blocks, from its middle to one side. The mean of a block and the straight line to the next one blur,
/// too: their variances are a twelfth and a sixth of the square of a block.
fn wide_kernel(width_deg: f64, per_degree: f64, block: usize) -> Vec<f32> {
    let sigma = width_deg * per_degree / (8.0 * LN_2).sqrt() / block as f64;
    let sigma = if block > 1 { (sigma * sigma - 0.25).sqrt() } else { sigma };
    let reach = (4.5 * sigma).ceil() as usize;
    let values: Vec<f64> = (0..=reach).map(|at| (-0.5 * (at as f64 / sigma).powi(2)).exp()).collect();
    let sum = values[0] + 2.0 * values[1..].iter().sum::<f64>();
    values.into_iter().map(|value| (value / sum) as f32).collect()
}

/// Samples of a narrow Gaussian with a weight, from its middle to one side: those that have its transfer function
/// up to half a cycle per pixel. Both axes have the root of the weight.
fn kernel(width_deg: f64, weight: f64, per_degree: f64) -> Vec<f32> {
    const STEPS: usize = 512;
    let sigma = width_deg * per_degree / (8.0 * LN_2).sqrt();
    let reach = ((4.5 * sigma).ceil() as usize).max(8);
    let value = |at: usize| {
        let part = |step: usize| {
            let frequency = (step as f64 + 0.5) / (2 * STEPS) as f64;
            gaussian(frequency * per_degree, width_deg) * (2.0 * PI * frequency * at as f64).cos()
        };
        (0..STEPS).map(part).sum::<f64>() / STEPS as f64
    };
    let values: Vec<f64> = (0..=reach).map(value).collect();
    let sum = values[0] + 2.0 * values[1..].iter().sum::<f64>();
    values.into_iter().map(|value| (value * weight.sqrt() / sum) as f32).collect()
}

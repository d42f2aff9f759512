//! The filters of a reader: S-CIELAB's by small kernels and on blocks of pixels, and those of FLIP.

use std::f64::consts::{LN_2, PI};
use std::ops::Range;

use papilio_fourier::{Separable, filtered};

use super::difference::Hues;
use super::flip_rows::FlipEye;
use super::mapped::{MappedPicture, SingleMap};
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
    /// From X, Y, Z to opponent colours.
    opponent: [[f32; 3]; 3],
    /// From opponent colours to X, Y, Z relative to the white.
    pub(super) back: [[f32; 3]; 3],
    /// From X, Y, Z relative to the white to linear sRGB on a screen.
    screen: [[f32; 3]; 3],
    /// Narrow kernels of each opponent colour, from the middle to one side.
    pub(super) narrow: [Vec<Vec<f32>>; 3],
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
        let block = 1 << ((sigma / 3.0).max(1.0).log2() as u32).min(5);
        let reach = narrow.iter().flatten().map(|kernel| kernel.len() - 1).max().unwrap_or(0);
        let (opponent, back) = (single(opponent), single(back));
        let (hues, flip) = (Hues::new(), FlipEye::new(per_degree));
        Self { reader, columns, rows, opponent, back, screen, narrow, block, reach, hues, flip }
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

    /// Means of blocks of opponent colours, after the wide filters: of the first two, or of the third.
    pub(super) fn coarse(
        &self,
        MappedPicture { pixels, map }: &MappedPicture<'_>,
        numbers: Range<usize>,
    ) -> Vec<Vec<f32>> {
        let opponent = map.then(&self.opponent);
        let block = self.block;
        let [across, down] = [self.columns, self.rows].map(|count| count.div_ceil(block));
        let mut planes = [0; 2].map(|_| Vec::new());
        planes.iter_mut().take(numbers.len()).for_each(|plane| *plane = vec![0.0_f64; across * down]);
        let mirrored =
            |at: usize, count: usize| if at < count { at } else { (2 * count - 1 - at).min(count - 1) };
        let scale = 1.0 / (block * block) as f64;
        let mut sums = vec![[0.0_f32; 3]; across * block];
        for row in 0..down {
            sums.fill([0.0; 3]);
            for y in row * block..(row + 1) * block {
                let line = &pixels[mirrored(y, self.rows) * self.columns..][..self.columns];
                let values = sums.as_flattened_mut().iter_mut().zip(line.as_flattened());
                values.for_each(|(sum, value)| *sum += value);
            }
            for x in self.columns..across * block {
                sums[x] = sums[mirrored(x, self.columns)];
            }
            for (column, sums) in sums.chunks_exact(block).enumerate() {
                let mut sum = [0.0_f64; 3];
                for one in sums {
                    (0..3).for_each(|k| sum[k] += f64::from(one[k]));
                }
                for (plane, k) in planes.iter_mut().zip(numbers.clone()) {
                    let mean: f64 = (0..3).map(|j| f64::from(opponent.matrix[k][j]) * (sum[j] * scale)).sum();
                    plane[row * across + column] = mean + f64::from(opponent.offset[k]);
                }
            }
        }
        let transfers: Vec<Vec<Separable>> = numbers.map(|k| self.wide(FILTERS[k], [across, down])).collect();
        let transfer = |k: usize| transfers.get(k).map_or(&[][..], Vec::as_slice);
        let [one, other] = &mut planes;
        filtered([one, other], across, [transfer(0), transfer(1)]);
        let single = |plane: Vec<f64>| plane.into_iter().map(|value| value as f32).collect();
        planes.into_iter().take(transfers.len()).map(single).collect()
    }

    /// The wide Gaussians of a filter at the frequencies of the blocks.
    fn wide(&self, filter: &[(f64, f64)], size: [usize; 2]) -> Vec<Separable> {
        let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
        let per_degree = self.reader.per_degree / self.block as f64;
        let values = |count: usize, scale: f64, width: f64| -> Vec<f64> {
            let value = |k: usize| {
                let frequency = k as f64 / (2 * count) as f64;
                // The mean of a block, and the triangle of the interpolation.
                let sinc = if k == 0 { 1.0 } else { (PI * frequency).sin() / (PI * frequency) };
                let correction = if self.block > 1 { sinc.powi(3) } else { 1.0 };
                scale * gaussian(frequency * per_degree, width) / correction
            };
            (0..count).map(value).collect()
        };
        let wide = filter.iter().filter(|(width, _)| *width >= WIDE_DEG);
        wide.map(|(width, weight)| Separable {
            along_x: values(size[0], weight / total, *width),
            along_y: values(size[1], 1.0, *width),
        })
        .collect()
    }
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

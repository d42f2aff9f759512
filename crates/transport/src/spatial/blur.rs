//! Kernels of a picture's pixels: cells that are small where the light is, and few shapes that represent many
//! kernels.
//!
//! **Cells.** A kernel is narrow at the view's own ray and at the mirrored rays of lamps, and smooth
//! elsewhere. Squares of 3^k pixels about the pixel that is seen are divided into nine until they are smaller
//! than a fraction of their distance from the nearest peak. Each square holds its light exactly; within it,
//! the light is uniform.
//!
//! **Shapes.** Kernels of several states in X, Y and Z differ little in shape: each is a mixture of a few,
//! found by pivoted Gram-Schmidt orthogonalisation, with the largest light that a mixture misses as its
//! error.

use super::Peak;

/// Square of pixels, relative to the pixel that is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelSquare {
    /// Offset of its first column and row, to the right and upwards.
    pub first: [i64; 2],
    /// Number of columns and of rows.
    pub side: i64,
}

/// Side of a square over its distance from the nearest peak, at most.
const SMALL: f64 = 0.25;

impl PixelSquare {
    /// The pixel that is seen.
    pub const OWN: Self = Self { first: [0; 2], side: 1 };

    /// Divides all places within `reach_mm` of the pixel that is seen, and those nearby. `peaks` are relative
    /// to the middle of the pixel.
    pub fn about(peaks: &[Peak], pitch_mm: [f64; 2], reach_mm: f64) -> Vec<Self> {
        let mut side = 1;
        while 0.5 * side as f64 * pitch_mm[0].min(pitch_mm[1]) < reach_mm {
            side *= 3;
        }
        let mut squares = Vec::new();
        Self { first: [-(side / 2); 2], side }.divide(peaks, pitch_mm, &mut squares);
        squares
    }

    /// Borders along x and along y, mm, relative to the middle of the pixel that is seen.
    pub fn borders_mm(&self, pitch_mm: [f64; 2]) -> [[f64; 2]; 2] {
        [0, 1].map(|k| {
            let from = self.first[k] as f64 - 0.5;
            [from * pitch_mm[k], (from + self.side as f64) * pitch_mm[k]]
        })
    }

    /// Calls a function with the offset of each pixel.
    pub fn each_pixel(&self, mut pixel: impl FnMut([i64; 2])) {
        let [x, y] = self.first;
        (y..y + self.side).for_each(|y| (x..x + self.side).for_each(|x| pixel([x, y])));
    }

    /// Largest offset of a pixel.
    pub fn reach(&self) -> usize {
        let ends = self.first.map(|first| first.abs().max((first + self.side - 1).abs()));
        ends[0].max(ends[1]).unsigned_abs() as usize
    }

    fn divide(self, peaks: &[Peak], pitch_mm: [f64; 2], squares: &mut Vec<Self>) {
        let [x, y] = self.borders_mm(pitch_mm);
        let beyond = |[from, to]: [f64; 2], at: f64| (from - at).max(at - to).max(0.0);
        let is_near = |peak: &Peak| {
            let distance = beyond(x, peak.at_mm[0]).hypot(beyond(y, peak.at_mm[1]));
            (x[1] - x[0]).max(y[1] - y[0]) > SMALL * distance
        };
        if self.side == 1 || !peaks.iter().any(is_near) {
            squares.push(self);
            return;
        }
        let side = self.side / 3;
        for (row, column) in (0..9).map(|k| (k / 3, k % 3)) {
            let first = [self.first[0] + column * side, self.first[1] + row * side];
            Self { first, side }.divide(peaks, pitch_mm, squares);
        }
    }
}

/// A few shapes, and each kernel as a mixture of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Shapes {
    /// Light of each cell, `[shape][cell]`.
    pub shapes: Vec<Vec<f64>>,
    /// Weights, `[kernel][shape]`.
    pub mixtures: Vec<Vec<f64>>,
    /// Largest sum over the cells of the light that a mixture misses.
    pub missed: f64,
}

impl Shapes {
    /// Represents kernels, `[kernel][cell]`, up to this light in the sum over the cells.
    pub fn of(kernels: &[Vec<f64>], missed: f64) -> Self {
        let mut rest = kernels.to_vec();
        let mut shapes: Vec<Vec<f64>> = Vec::new();
        let mut mixtures = vec![Vec::new(); kernels.len()];
        loop {
            let light = rest.iter().map(|kernel| kernel.iter().map(|value| value.abs()).sum::<f64>());
            let largest = light.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((pivot, _)) = largest.filter(|(_, most)| *most > missed) else {
                return Self { shapes, mixtures, missed: largest.map_or(0.0, |(_, most)| most) };
            };
            let length = rest[pivot].iter().map(|value| value * value).sum::<f64>().sqrt();
            let shape: Vec<f64> = rest[pivot].iter().map(|value| value / length).collect();
            for (kernel, mixture) in rest.iter_mut().zip(&mut mixtures) {
                let weight: f64 = kernel.iter().zip(&shape).map(|(value, shape)| value * shape).sum();
                kernel.iter_mut().zip(&shape).for_each(|(value, shape)| *value -= weight * shape);
                mixture.push(weight);
            }
            shapes.push(shape);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_cover_each_pixel_once_and_are_small_near_peaks() {
        let peaks = [Peak { at_mm: [0.0; 2], width_mm: 0.01 }, Peak { at_mm: [1.3, -0.4], width_mm: 0.1 }];
        let squares = PixelSquare::about(&peaks, [0.1, 0.08], 3.0);
        let mut covered = vec![0; 81 * 81];
        for square in &squares {
            square.each_pixel(|[x, y]| covered[((y + 40) * 81 + x + 40) as usize] += 1);
            assert!(square.reach() <= 40);
        }
        assert!(covered.iter().all(|count| *count == 1));
        let side_at = |x: i64, y: i64| {
            let holds = |one: &&PixelSquare| {
                (0..2).all(|k| (one.first[k]..one.first[k] + one.side).contains(&[x, y][k]))
            };
            squares.iter().find(holds).unwrap().side
        };
        assert_eq!((side_at(0, 0), side_at(13, -5)), (1, 1));
        assert!(side_at(-39, 39) >= 9, "{}", side_at(-39, 39));
        assert!(squares.len() < 2000, "{}", squares.len());
    }

    #[test]
    fn few_shapes_represent_kernels_of_low_rank() {
        let shape = |k: usize, cell: usize| (0.3 * (k + 1) as f64 * cell as f64).sin();
        let kernel = |j: usize| -> Vec<f64> {
            (0..40).map(|cell| (0..3).map(|k| ((j * k + 2) as f64).cos() * shape(k, cell)).sum()).collect()
        };
        let kernels: Vec<Vec<f64>> = (0..12).map(kernel).collect();
        let found = Shapes::of(&kernels, 1e-9);
        assert_eq!(found.shapes.len(), 3);
        for (kernel, mixture) in kernels.iter().zip(&found.mixtures) {
            for (cell, value) in kernel.iter().enumerate() {
                let sum: f64 =
                    mixture.iter().zip(&found.shapes).map(|(weight, shape)| weight * shape[cell]).sum();
                assert!((sum - value).abs() < 1e-10, "{sum} {value}");
            }
        }
        let rough = Shapes::of(&kernels, 20.0);
        assert!(rough.shapes.len() < 3 && rough.missed > 0.0 && rough.missed <= 20.0);
    }
}

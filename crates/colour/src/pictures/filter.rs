//! Filters of a picture's plane: by a transfer function, or by small kernels.

use std::sync::Arc;

use rustdct::{DctPlanner, TransformType2And3};

/// Multiplies the spatial spectrum of a plane by a real transfer function of the frequencies along x and y, cycles per
/// pixel (0 to 0.5). Beyond its borders the picture continues as its mirror image.
///
/// The cosine transform of type II is the spectrum of such a plane, so that nothing wraps around.
pub(super) fn transferred(plane: &[f64], columns: usize, transfer: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let rows = plane.len() / columns;
    let mut planner = DctPlanner::new();
    let (along_x, along_y) = (planner.plan_dct2(columns), planner.plan_dct2(rows));
    let mut spectrum = plane.to_vec();
    each_row(&mut spectrum, columns, &along_x, Direction::Forward);
    let mut spectrum = transposed(&spectrum, columns);
    each_row(&mut spectrum, rows, &along_y, Direction::Forward);
    // Each transform and its inverse together multiply by half of the length.
    let scale = 4.0 / (columns * rows) as f64;
    for (column, values) in spectrum.chunks_exact_mut(rows).enumerate() {
        let x = column as f64 / (2 * columns) as f64;
        for (row, value) in values.iter_mut().enumerate() {
            *value *= scale * transfer(x, row as f64 / (2 * rows) as f64);
        }
    }
    each_row(&mut spectrum, rows, &along_y, Direction::Back);
    let mut plane = transposed(&spectrum, rows);
    each_row(&mut plane, columns, &along_x, Direction::Back);
    plane
}

enum Direction {
    Forward,
    Back,
}

fn each_row(
    plane: &mut [f64],
    columns: usize,
    plan: &Arc<dyn TransformType2And3<f64>>,
    direction: Direction,
) {
    let mut scratch = vec![0.0; plan.get_scratch_len()];
    for row in plane.chunks_exact_mut(columns) {
        match direction {
            Direction::Forward => plan.process_dct2_with_scratch(row, &mut scratch),
            Direction::Back => plan.process_dct3_with_scratch(row, &mut scratch),
        }
    }
}

/// Exchanges rows and columns, in blocks that fit into the cache.
fn transposed(plane: &[f64], columns: usize) -> Vec<f64> {
    const BLOCK: usize = 32;
    let rows = plane.len() / columns;
    let mut result = vec![0.0; plane.len()];
    for top in (0..rows).step_by(BLOCK) {
        for left in (0..columns).step_by(BLOCK) {
            for row in top..rows.min(top + BLOCK) {
                for column in left..columns.min(left + BLOCK) {
                    result[column * rows + row] = plane[row * columns + column];
                }
            }
        }
    }
    result
}

/// Convolves a plane with the product of a kernel along x and one along y, both of odd length. Beyond its borders the
/// picture continues with the values at the border.
pub(super) fn convolved(plane: &[f64], columns: usize, along_x: &[f64], along_y: &[f64]) -> Vec<f64> {
    let rows = plane.len() / columns;
    let once = convolved_rows(plane, columns, along_x);
    transposed(&convolved_rows(&transposed(&once, columns), rows, along_y), rows)
}

fn convolved_rows(plane: &[f64], columns: usize, kernel: &[f64]) -> Vec<f64> {
    let radius = kernel.len() / 2;
    let mut padded = vec![0.0; columns + 2 * radius];
    let mut result = Vec::with_capacity(plane.len());
    for row in plane.chunks_exact(columns) {
        padded[..radius].fill(row[0]);
        padded[radius..radius + columns].copy_from_slice(row);
        padded[radius + columns..].fill(row[columns - 1]);
        result.extend(padded.windows(kernel.len()).map(|near| {
            // Convolution, not correlation: the kernel is reversed.
            near.iter().zip(kernel.iter().rev()).map(|(value, weight)| value * weight).sum::<f64>()
        }));
    }
    result
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn transfer_function_multiplies_gratings() {
        let (columns, rows) = (30, 7);
        let [x, y] = [4.0 / 60.0, 3.0 / 14.0];
        let wave = |row: usize, column: usize| {
            (2.0 * PI * x * (column as f64 + 0.5)).cos() * (2.0 * PI * y * (row as f64 + 0.5)).cos()
        };
        let plane: Vec<f64> = (0..rows * columns).map(|k| 0.5 + wave(k / columns, k % columns)).collect();
        let blurred = transferred(&plane, columns, |x, y| 1.0 - x - 2.0 * y);
        for (k, value) in blurred.iter().enumerate() {
            let expected = 0.5 + (1.0 - x - 2.0 * y) * wave(k / columns, k % columns);
            assert!((value - expected).abs() < 1e-12, "{k}: {value} {expected}");
        }
    }

    #[test]
    fn transfer_function_of_one_changes_nothing() {
        for (columns, rows) in [(1, 1), (1, 5), (40, 70), (33, 1)] {
            let plane: Vec<f64> = (0..columns * rows).map(|k| ((k * k) as f64).sin()).collect();
            let same = transferred(&plane, columns, |_, _| 1.0);
            assert!(plane.iter().zip(&same).all(|(one, other)| (one - other).abs() < 1e-12));
        }
    }

    #[test]
    fn kernels_act_along_their_axes_and_hold_borders() {
        let mut plane = vec![0.0; 25];
        plane[12] = 1.0;
        let spread = convolved(&plane, 5, &[1.0, 2.0, 4.0], &[1.0, 0.0, 3.0]);
        let expected = [
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 2.0, 4.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 3.0, 6.0, 12.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 0.0],
        ];
        assert_eq!(spread, expected.concat());
        assert_eq!(convolved(&[2.0; 6], 3, &[0.25, 0.5, 0.25], &[0.5, 0.0, 0.5]), [2.0; 6]);
    }
}

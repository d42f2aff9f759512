//! Filters of a picture's plane by small kernels.

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
    use super::*;

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

//! The value at a place from the nearest points: a polynomial of second degree through them.

use super::Point;
use super::near::Tree;

/// Number of terms of a polynomial of second degree in three variables.
const TERMS: usize = 10;
/// Weight of the squared coefficients of first and of second degree, in units of the sum of the weights: where the points do
/// not determine them, they are 0.
const RIDGE: [f64; 2] = [1e-4, 1e-2];
/// Distance below which two places are the same, in units of the farthest point's.
const SAME: f64 = 1e-7;
/// Fraction of the range of ln f of the points by which the value may lie beyond it.
const OVERSHOOT: f64 = 0.5;

/// Returns f at a place from points and their distances, ascending; 0 without points.
pub(super) fn predicted(tree: &Tree, points: &[Point], place: [f64; 3], near: &[(usize, f64)]) -> f64 {
    let Some((_, last)) = near.last() else { return 0.0 };
    let radius = last * (1.0 + 1e-4) + f64::MIN_POSITIVE;
    if near[0].1 <= SAME * radius {
        return points[near[0].0].value;
    }
    let weight = |distance: f64| ((radius - distance) / (radius * distance)).powi(2);
    let total: f64 = near.iter().map(|(_, distance)| weight(*distance)).sum();
    let weighted = || near.iter().map(|(k, distance)| (*k, weight(*distance) / total));
    if near.iter().any(|(k, _)| points[*k].value <= 0.0) {
        return weighted().map(|(k, weight)| weight * points[k].value).sum::<f64>().max(0.0);
    }
    let mut matrix = [[0.0; TERMS]; TERMS];
    let mut right = [0.0; TERMS];
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, weight) in weighted() {
        let at = tree.place(k);
        let terms = terms([0, 1, 2].map(|axis| (at[axis] - place[axis]) / radius));
        let log = points[k].value.ln();
        (least, most) = (least.min(log), most.max(log));
        for row in 0..TERMS {
            right[row] += weight * terms[row] * log;
            for column in 0..=row {
                matrix[row][column] += weight * terms[row] * terms[column];
            }
        }
    }
    for (row, line) in matrix.iter_mut().enumerate().skip(1) {
        line[row] += RIDGE[usize::from(row > 3)];
    }
    let beyond = OVERSHOOT * (most - least);
    constant(matrix, right).clamp(least - beyond, most + beyond).exp()
}

/// Terms of the polynomial.
fn terms([x, y, z]: [f64; 3]) -> [f64; TERMS] {
    [1.0, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z]
}

/// First unknown of a symmetric positive definite system, given by the lower triangle of its matrix (Cholesky).
fn constant(mut matrix: [[f64; TERMS]; TERMS], mut right: [f64; TERMS]) -> f64 {
    // In the reverse order, the first unknown is the last one of the forward substitution.
    for row in (0..TERMS).rev() {
        for column in (0..=row).rev() {
            let known: f64 = (row + 1..TERMS).map(|k| matrix[k][row] * matrix[k][column]).sum();
            let value = matrix[row][column] - known;
            matrix[row][column] =
                if column == row { value.max(1e-300).sqrt() } else { value / matrix[row][row] };
        }
        let known: f64 = (row + 1..TERMS).map(|k| matrix[k][row] * right[k]).sum();
        right[row] = (right[row] - known) / matrix[row][row];
    }
    right[0] / matrix[0][0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reverse Cholesky decomposition solves a system with a known solution.
    #[test]
    fn first_unknown_of_known_system() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        };
        let factor: Vec<[f64; TERMS]> = (0..TERMS).map(|_| std::array::from_fn(|_| next())).collect();
        let solution: [f64; TERMS] = std::array::from_fn(|k| 1.0 + k as f64);
        let mut matrix = [[0.0; TERMS]; TERMS];
        for row in 0..TERMS {
            for column in 0..TERMS {
                matrix[row][column] = (0..TERMS).map(|k| factor[k][row] * factor[k][column]).sum::<f64>();
            }
            matrix[row][row] += 0.5;
        }
        let right = std::array::from_fn(|row| (0..TERMS).map(|k| matrix[row][k] * solution[k]).sum());
        assert!((constant(matrix, right) - 1.0).abs() < 1e-10);
    }
}

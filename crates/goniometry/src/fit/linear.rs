//! Inverse of a small symmetric matrix, and Student's quantile.

/// Inverse of a positive definite matrix, row by row, from the Cholesky factor of its
/// correlation matrix; `None` if it is numerically singular.
pub(super) fn inverse(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let sizes: Vec<f64> = (0..n).map(|i| matrix[i * n + i].sqrt()).collect();
    if sizes.iter().any(|size| !(*size > 0.0 && size.is_finite())) {
        return None;
    }
    let mut lower = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..=i {
            let known: f64 = (0..k).map(|m| lower[i * n + m] * lower[k * n + m]).sum();
            let rest = matrix[i * n + k] / (sizes[i] * sizes[k]) - known;
            if i == k && rest < 1e-14 {
                return None;
            }
            lower[i * n + k] = if i == k { rest.sqrt() } else { rest / lower[k * n + k] };
        }
    }
    let mut inverse = vec![0.0; n * n];
    for column in 0..n {
        let mut x = vec![0.0; n];
        for i in 0..n {
            let unit = f64::from(u8::from(i == column));
            let known: f64 = (0..i).map(|m| lower[i * n + m] * x[m]).sum();
            x[i] = (unit - known) / lower[i * n + i];
        }
        for i in (0..n).rev() {
            let known: f64 = (i + 1..n).map(|m| lower[m * n + i] * x[m]).sum();
            x[i] = (x[i] - known) / lower[i * n + i];
        }
        for (row, x) in x.into_iter().enumerate() {
            inverse[row * n + column] = x / (sizes[row] * sizes[column]);
        }
    }
    Some(inverse)
}

/// The 0.975 quantile of Student's t for 3 or more degrees of freedom: expansion about the normal
/// quantile (Abramowitz & Stegun 26.7.5), with an error of 0.003 at 5 and of 0.03 at 3.
pub(super) fn student_975(freedom: f64) -> f64 {
    let z: f64 = 1.959_963_984_540_054;
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
    ];
    z + (terms[0] + (terms[1] + terms[2] / freedom) / freedom) / freedom
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_quantiles_equal_published_values() {
        for (freedom, quantile) in
            [(3.0, 3.1824), (5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423), (120.0, 1.9799)]
        {
            assert!(
                (student_975(freedom) - quantile).abs() < if freedom < 5.0 { 0.03 } else { 3e-3 },
                "{freedom}"
            );
        }
    }

    #[test]
    fn badly_scaled_matrix_is_inverted() {
        let matrix = [4e10, 1e5, 2.0, 1e5, 9e-1, 1e-6, 2.0, 1e-6, 5e-9];
        let inverse = inverse(&matrix, 3).unwrap();
        for i in 0..3 {
            for k in 0..3 {
                let entry: f64 = (0..3).map(|m| matrix[i * 3 + m] * inverse[m * 3 + k]).sum();
                let scale = (matrix[i * 4] / matrix[k * 4]).sqrt();
                assert!((entry - f64::from(u8::from(i == k))).abs() < 1e-12 * scale, "{i} {k}: {entry}");
            }
        }
        assert_eq!(super::inverse(&[1.0, 1.0, 1.0, 1.0], 2), None);
    }
}

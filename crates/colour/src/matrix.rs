//! Matrices of three rows and columns, as constants.

/// Matrix of three rows.
pub(crate) type Matrix = [[f64; 3]; 3];

/// Product of a matrix and a column.
pub(crate) const fn times(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    [
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    ]
}

/// Product of two matrices.
pub(crate) fn product(one: &Matrix, other: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| one[i][k] * other[k][j]).sum()))
}

/// Vector product; the transposed inverse of a matrix consists of those of its rows, over the determinant.
pub(crate) const fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Scalar product.
pub(crate) const fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Inverse of a matrix; its values are not finite if the matrix is singular.
pub(crate) const fn inverse(m: &Matrix) -> Matrix {
    let (p, q, r) = (cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
    let d = dot(m[0], p);
    [[p[0] / d, q[0] / d, r[0] / d], [p[1] / d, q[1] / d, r[1] / d], [p[2] / d, q[2] / d, r[2] / d]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_returns_what_was_multiplied() {
        let m = [[2.0, -1.0, 0.5], [0.25, 3.0, 1.0], [-0.5, 0.125, 4.0]];
        let back = times(&inverse(&m), times(&m, [1.0, -2.0, 3.0]));
        assert!(back.iter().zip([1.0, -2.0, 3.0]).all(|(b, e)| (b - e).abs() < 1e-14), "{back:?}");
    }
}

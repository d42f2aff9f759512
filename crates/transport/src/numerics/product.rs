//! Products of matrices in row-major order, by `faer` with the widest SIMD registers available, on one
//! thread.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use papilio_optics::clear_wide_registers;

/// `out += left right`; shapes `[row][inner]`, `[inner][column]`, `[row][column]`.
pub(crate) fn add_product(left: &[f64], right: &[f64], inner: usize, out: &mut [f64]) {
    if inner > 0 && !out.is_empty() {
        let rows = left.len() / inner;
        multiply(MatRef::from_row_major_slice(left, rows, inner), right, out);
    }
}

/// As [`add_product`] with `left` of shape `[inner][row]`.
pub(crate) fn add_transposed_product(left: &[f64], right: &[f64], inner: usize, out: &mut [f64]) {
    if inner > 0 && !out.is_empty() {
        let rows = left.len() / inner;
        multiply(MatRef::from_row_major_slice(left, inner, rows).transpose(), right, out);
    }
}

fn multiply(left: MatRef<'_, f64>, right: &[f64], out: &mut [f64]) {
    let (rows, inner) = (left.nrows(), left.ncols());
    let columns = right.len() / inner;
    let right = MatRef::from_row_major_slice(right, inner, columns);
    let out = MatMut::from_row_major_slice_mut(out, rows, columns);
    matmul(out, Accum::Add, left, right, 1.0, Par::Seq);
    clear_wide_registers();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_equal_values_by_hand() {
        let (left, right) = ([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [1.0, 0.5, -1.0, 2.0, 0.0, 3.0]);
        let mut out = [10.0; 4];
        add_product(&left, &right, 3, &mut out);
        assert_eq!(out, [9.0, 23.5, 9.0, 40.0]);
        let mut out = [0.0; 4];
        add_transposed_product(&[1.0, 4.0, 2.0, 5.0, 3.0, 6.0], &right, 3, &mut out);
        assert_eq!(out, [-1.0, 13.5, -1.0, 30.0]);
        let mut out = [-1.0, 13.5, -1.0, 30.0];
        add_product(&[], &[], 0, &mut out);
        assert_eq!(out, [-1.0, 13.5, -1.0, 30.0]);
    }
}

//! Sums of products of matrices, with the widest SIMD registers available, on one thread.
//!
//! A block of the sums, some registers high and some columns wide, stays in registers while products are added
//! ([`blocks`]); where the elements of both factors that are multiplied are side by side, each sum fills a
//! register ([`dots`]).

mod blocks;
mod dots;

use pulp::{Arch, Simd, WithSimd};

/// A matrix in a slice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View<'a> {
    pub(crate) values: &'a [f64],
    /// From the start of a column to that of the next; of a row, if by rows.
    pub(crate) stride: usize,
    /// Whether the elements of a row, not those of a column, are side by side.
    pub(crate) by_rows: bool,
}

/// `out += factor left right`. At most one of `left` and `right` is by rows.
#[derive(Debug)]
pub(crate) struct Product<'a> {
    pub(crate) left: View<'a>,
    pub(crate) right: View<'a>,
    pub(crate) factor: f64,
    /// The elements of a column side by side.
    pub(crate) out: &'a mut [f64],
    /// From the start of a column of `out` to that of the next.
    pub(crate) stride: usize,
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// Number of products in each sum.
    pub(crate) inner: usize,
}

/// `out += left right`, all in row-major order; shapes `[row][inner]`, `[inner][column]`, `[row][column]`.
pub(crate) fn add_product(left: &[f64], right: &[f64], inner: usize, out: &mut [f64]) {
    add(View { values: left, stride: inner, by_rows: false }, right, inner, out);
}

/// As [`add_product`] with `left` of shape `[inner][row]`.
pub(crate) fn add_transposed_product(left: &[f64], right: &[f64], inner: usize, out: &mut [f64]) {
    let rows = left.len().checked_div(inner).unwrap_or(0);
    add(View { values: left, stride: rows, by_rows: true }, right, inner, out);
}

/// Adds the transposed product, whose elements are in column-major order.
fn add(transposed_left: View<'_>, right: &[f64], inner: usize, out: &mut [f64]) {
    if inner > 0 && !out.is_empty() {
        let (rows, columns) = (right.len() / inner, transposed_left.values.len() / inner);
        let left = View { values: right, stride: rows, by_rows: false };
        Product { left, right: transposed_left, factor: 1.0, out, stride: rows, rows, columns, inner }.add();
    }
}

/// Number of elements of the widest registers.
const LANES: usize = 8;

impl Product<'_> {
    /// Adds the product to `out`.
    pub(crate) fn add(self) {
        if self.rows > 0 && self.columns > 0 && self.inner > 0 {
            Arch::new().dispatch(self);
        }
    }

    /// Returns `left` by columns of this many rows, zero after its own.
    fn left_by_columns(&self, rows: usize) -> Vec<f64> {
        let View { values, stride, by_rows } = self.left;
        let mut all = vec![0.0; rows * self.inner];
        for (j, column) in all.chunks_exact_mut(rows).enumerate() {
            let column = &mut column[..self.rows];
            if by_rows {
                column.iter_mut().enumerate().for_each(|(i, to)| *to = values[i * stride + j]);
            } else {
                column.copy_from_slice(&values[j * stride..][..self.rows]);
            }
        }
        all
    }
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        if self.left.by_rows && self.inner >= S::F64_LANES {
            self.add_dots(simd);
        } else if self.left.by_rows || self.rows < S::F64_LANES {
            let stride = self.rows.max(S::F64_LANES);
            let left = View { values: &self.left_by_columns(stride), stride, by_rows: false };
            Product { left, ..self }.add_blocks(simd);
        } else {
            self.add_blocks(simd);
        }
    }
}

/// Returns a register of zeros and, from a lane on, this value.
#[inline(always)]
fn from_lane<S: Simd>(lane: usize, value: f64) -> S::f64s {
    let each: [f64; LANES] = std::array::from_fn(|i| if i < lane { 0.0 } else { value });
    S::as_simd_f64s(&each).0[0]
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

    /// Elements with so few digits that all sums are exact.
    fn element(matrix: usize, i: usize, j: usize) -> f64 {
        ((matrix * 31 + i * 7 + j * 13 + i * j) % 17) as f64 - 8.0
    }

    fn stored(matrix: usize, rows: usize, columns: usize, by_rows: bool) -> (Vec<f64>, usize) {
        let (outer, across) = if by_rows { (rows, columns) } else { (columns, rows) };
        let stride = across + 2;
        let at = |o: usize, a: usize| if by_rows { element(matrix, o, a) } else { element(matrix, a, o) };
        let value = |o: usize, a: usize| if a < across { at(o, a) } else { f64::NAN };
        ((0..outer * stride).map(|k| value(k / stride, k % stride)).collect(), stride)
    }

    /// The instruction sets that this machine has.
    fn instruction_sets() -> Vec<Arch> {
        #[cfg(target_arch = "x86_64")]
        let others = [pulp::x86::V3::try_new().map(Arch::V3), pulp::x86::V4::try_new().map(Arch::V4)];
        #[cfg(not(target_arch = "x86_64"))]
        let others = [Some(Arch::new())];
        others.into_iter().flatten().chain([Arch::Scalar]).collect()
    }

    #[test]
    fn products_of_all_shapes_equal_their_sums_and_nothing_else_changes() {
        let sizes = [1, 2, 3, 5, 7, 8, 11, 16, 29, 53];
        let layouts = [(false, false), (true, false), (false, true)];
        let shapes =
            sizes.iter().flat_map(|m| sizes.iter().flat_map(move |n| [1, 4, 9, 131].map(|k| [*m, *n, k])));
        let sets = instruction_sets();
        for (number, ([rows, columns, inner], (by_rows, right_by_rows))) in
            shapes.flat_map(|shape| layouts.map(|layout| (shape, layout))).enumerate()
        {
            let (left, left_stride) = stored(1, rows, inner, by_rows);
            let (right, right_stride) = stored(2, inner, columns, right_by_rows);
            let (mut out, stride) = stored(3, rows, columns, false);
            let left = View { values: &left, stride: left_stride, by_rows };
            let right = View { values: &right, stride: right_stride, by_rows: right_by_rows };
            let product = Product { left, right, factor: -0.5, out: &mut out, stride, rows, columns, inner };
            sets[number % sets.len()].dispatch(product);
            for (k, found) in out.iter().enumerate() {
                let (i, j) = (k % stride, k / stride);
                let sum: f64 = (0..inner).map(|p| element(1, i, p) * element(2, p, j)).sum();
                let right = if i < rows { *found == element(3, i, j) - 0.5 * sum } else { found.is_nan() };
                assert!(
                    right,
                    "{rows} x {columns} x {inner}, {by_rows} {right_by_rows}: row {i}, column {j}"
                );
            }
        }
    }
}

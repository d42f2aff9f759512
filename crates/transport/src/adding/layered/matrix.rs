//! Dense matrices, column by column. Products and factorisations are computed by `faer`, on one thread.

use std::ops::{Index, IndexMut};

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Accum, MatMut, MatRef, Par};
use papilio_optics::clear_wide_registers;

/// A dense matrix.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Matrix {
    rows: usize,
    columns: usize,
    values: Vec<f64>,
}

/// A factorised square matrix.
pub(super) struct Factors(PartialPivLu<f64>);

impl Matrix {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, values: vec![0.0; rows * columns] }
    }

    /// Builds a matrix from its elements by row and column.
    pub(super) fn from_fn(rows: usize, columns: usize, element: impl Fn(usize, usize) -> f64) -> Self {
        let mut values = Vec::with_capacity(rows * columns);
        for j in 0..columns {
            values.extend((0..rows).map(|i| element(i, j)));
        }
        Self { rows, columns, values }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the first rows.
    pub(super) fn first_rows(&self, rows: usize) -> Self {
        Self::from_fn(rows, self.columns, |i, j| self[(i, j)])
    }

    /// Returns column number `j`.
    pub(super) fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..][..self.rows]
    }

    /// Returns column number `j`.
    pub(super) fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * self.rows..][..self.rows]
    }

    /// Returns the columns in turn, each with its number.
    pub(super) fn columns_mut(&mut self) -> impl Iterator<Item = (usize, &mut [f64])> {
        // Without rows there are no columns.
        self.values.chunks_exact_mut(self.rows.max(1)).enumerate()
    }

    /// Returns the rows from `first` on.
    pub(super) fn rows_from(&self, first: usize) -> Self {
        Self::from_fn(self.rows - first, self.columns, |i, j| self[(first + i, j)])
    }

    /// Returns these columns.
    pub(super) fn some_columns(&self, columns: &[usize]) -> Self {
        let values = columns.iter().flat_map(|&j| self.column(j)).copied().collect();
        Self { rows: self.rows, columns: columns.len(), values }
    }

    /// Returns some successive columns.
    pub(super) fn columns_in(&self, columns: std::ops::Range<usize>) -> Self {
        let values = self.values[columns.start * self.rows..columns.end * self.rows].to_vec();
        Self { rows: self.rows, columns: columns.len(), values }
    }

    /// Returns matrices with equal numbers of rows side by side.
    pub(super) fn beside(all: &[&Self]) -> Self {
        let rows = all.first().map_or(0, |one| one.rows);
        let mut values = Vec::with_capacity(all.iter().map(|one| one.values.len()).sum());
        all.iter().for_each(|one| values.extend_from_slice(&one.values));
        Self { rows, columns: all.iter().map(|one| one.columns).sum(), values }
    }

    /// Returns these rows as columns.
    pub(super) fn transposed_rows(&self, rows: &[usize]) -> Self {
        Self::from_fn(self.columns, rows.len(), |i, j| self[(rows[j], i)])
    }

    pub(super) fn transposed(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self[(j, i)])
    }

    /// Copies the elements above the diagonal to their places below it.
    pub(super) fn mirror_upper(&mut self) {
        for j in 0..self.columns {
            for i in 0..j {
                self[(j, i)] = self[(i, j)];
            }
        }
    }

    /// Returns `factor` times all elements.
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value *= factor);
        self
    }

    /// Returns `a * self + b * other`.
    pub(super) fn combine(&self, a: f64, other: &Self, b: f64) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(x, y)| a * x + b * y).collect();
        Self { values, ..*self }
    }

    /// Returns its elements times those of another of the same shape.
    pub(super) fn times_each(&self, other: &Self) -> Self {
        let values = self.values.iter().zip(&other.values).map(|(x, y)| x * y).collect();
        Self { values, ..*self }
    }

    /// Overwrites its columns with these columns of another.
    pub(super) fn copy_columns(&mut self, other: &Self, columns: &[usize]) {
        columns.iter().enumerate().for_each(|(k, c)| self.column_mut(k).copy_from_slice(other.column(*c)));
    }

    /// Adds `left right`: the first `inner` columns of `left`, and the first `inner` rows of `right`.
    pub(super) fn add_product(&mut self, left: &Self, right: &Self, inner: usize) {
        if inner > 0 && !self.values.is_empty() {
            let (left, right) = (left.view().subcols(0, inner), right.view().subrows(0, inner));
            add(self.view_mut(), left, right, 1.0);
        }
    }

    /// Adds `left right`: as many rows of `left` as this matrix has, from `first` on, and its first `inner`
    /// columns; the first `inner` rows of `right`.
    pub(super) fn add_product_of_rows(&mut self, left: &Self, first: usize, right: &Self, inner: usize) {
        if inner > 0 && !self.values.is_empty() {
            let left = left.view().submatrix(first, 0, self.rows, inner);
            add(self.view_mut(), left, right.view().subrows(0, inner), 1.0);
        }
    }

    /// Adds `factor left right`: as many rows of `left` as this matrix has, and as many of its columns as
    /// `right` has rows.
    pub(super) fn add_scaled_product(&mut self, left: &Self, right: &Self, factor: f64) {
        if right.rows > 0 && !self.values.is_empty() {
            let left = left.view().submatrix(0, 0, self.rows, right.rows);
            add(self.view_mut(), left, right.view(), factor);
        }
    }

    /// Adds `factor left' right`, with the transpose of `left`: as many of its columns as this matrix has
    /// rows, and as many of its rows as `right` has.
    pub(super) fn add_transposed_product(&mut self, left: &Self, right: &Self, factor: f64) {
        if right.rows > 0 && !self.values.is_empty() {
            let left = left.view().submatrix(0, 0, right.rows, self.rows).transpose();
            add(self.view_mut(), left, right.view(), factor);
        }
    }

    /// Adds `factor left' right`, with the transpose of some columns of `left`: as many as this matrix has
    /// rows, from `first` on, and as many of its rows as `right` has.
    pub(super) fn add_transposed_product_of_columns(
        &mut self,
        left: &Self,
        first: usize,
        right: &Self,
        factor: f64,
    ) {
        if right.rows > 0 && !self.values.is_empty() {
            let left = left.view().submatrix(0, first, right.rows, self.rows).transpose();
            add(self.view_mut(), left, right.view(), factor);
        }
    }

    /// Adds the product of a square matrix, or of its transpose, with the rows of `right` from `first` on, to
    /// the rows from there on.
    pub(super) fn add_block_product(&mut self, (block, first): (&Self, usize), right: &Self, reversed: bool) {
        if block.rows > 0 && !self.values.is_empty() {
            let left = if reversed { block.view().transpose() } else { block.view() };
            let right = right.view().subrows(first, block.rows);
            add(self.view_mut().subrows_mut(first, block.rows), left, right, 1.0);
        }
    }

    /// Returns the sum of the first columns, weighted.
    pub(super) fn times(&self, weights: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.rows];
        for (j, weight) in weights.iter().enumerate() {
            sum.iter_mut().zip(self.column(j)).for_each(|(sum, x)| *sum += weight * x);
        }
        sum
    }

    /// Returns the sum of the first rows, weighted.
    pub(super) fn transposed_times(&self, weights: &[f64]) -> Vec<f64> {
        let sum = |j: usize| weights.iter().zip(self.column(j)).map(|(w, x)| w * x).sum();
        (0..self.columns).map(sum).collect()
    }

    /// Subtracts from the rows after the first `first` the product of `left` and these first rows.
    pub(super) fn eliminate(&mut self, left: &Self, first: usize) {
        if first > 0 && first < self.rows {
            let left = left.view().submatrix(first, 0, self.rows - first, first);
            let (top, bottom) = self.view_mut().split_at_row_mut(first);
            add(bottom, left, top.as_ref(), -1.0);
        }
    }

    /// Factorises by Gaussian elimination with partial pivoting.
    pub(super) fn factors(&self) -> Factors {
        let factors = PartialPivLu::new(self.view());
        clear_wide_registers();
        Factors(factors)
    }

    fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.values, self.rows, self.columns)
    }

    fn view_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.values, self.rows, self.columns)
    }
}

/// Adds `factor left right`.
fn add(out: MatMut<'_, f64>, left: MatRef<'_, f64>, right: MatRef<'_, f64>, factor: f64) {
    matmul(out, Accum::Add, left, right, factor, Par::Seq);
    clear_wide_registers();
}

impl AsRef<Factors> for Factors {
    fn as_ref(&self) -> &Factors {
        self
    }
}

impl Factors {
    /// Solves for the first rows of `right`, as many as the matrix has.
    pub(super) fn solve(&self, right: &mut Matrix) {
        let rows = self.0.U().nrows();
        if rows > 0 && right.columns > 0 {
            self.0.solve_in_place(right.view_mut().subrows_mut(0, rows));
            clear_wide_registers();
        }
    }

    /// Solves the same, or for the transposed matrix.
    pub(super) fn solve_either(&self, right: &mut Matrix, transposed: bool) {
        if transposed { self.solve_transposed(right) } else { self.solve(right) }
    }

    fn solve_transposed(&self, right: &mut Matrix) {
        let rows = self.0.U().nrows();
        if rows > 0 && right.columns > 0 {
            self.0.solve_transpose_in_place(right.view_mut().subrows_mut(0, rows));
            clear_wide_registers();
        }
    }
}

impl Index<(usize, usize)> for Matrix {
    type Output = f64;

    #[inline]
    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.values[column * self.rows + row]
    }
}

impl IndexMut<(usize, usize)> for Matrix {
    #[inline]
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.values[column * self.rows + row]
    }
}

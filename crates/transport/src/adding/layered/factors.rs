//! Gaussian elimination with partial pivoting, in blocks of columns.

use std::ops::Range;

use papilio_optics::with_widest_simd;

use crate::numerics::product::{Product, View};

/// A factorised square matrix: with rows exchanged, the product of a lower triangular matrix with ones on its
/// diagonal and an upper one.
#[derive(Debug)]
pub(super) struct Factors {
    size: usize,
    /// Both triangles, column by column.
    values: Vec<f64>,
    /// For each row the one, itself or below, with which it was exchanged.
    exchanged: Vec<usize>,
    /// The inverses of the blocks of each triangle on the diagonal, column by column.
    lower: Vec<Vec<f64>>,
    upper: Vec<Vec<f64>>,
}

/// Number of rows and columns that are eliminated together.
const BLOCK: usize = 16;

impl Factors {
    /// Factorises a matrix, column by column.
    pub(super) fn new(size: usize, values: Vec<f64>) -> Self {
        let exchanged = Vec::with_capacity(size);
        let mut all = Self { size, values, exchanged, lower: Vec::new(), upper: Vec::new() };
        all.blocks().for_each(|rows| all.eliminate(rows));
        all
    }

    /// Rows and columns of the blocks on the diagonal.
    fn blocks(&self) -> impl DoubleEndedIterator<Item = Range<usize>> + use<> {
        let size = self.size;
        (0..size.div_ceil(BLOCK)).map(move |i| i * BLOCK..size.min((i + 1) * BLOCK))
    }

    /// The elements in columns from one on, and rows from one on.
    fn part(&self, column: usize, row: usize, by_rows: bool) -> View<'_> {
        View { values: &self.values[column * self.size + row..], stride: self.size, by_rows }
    }

    fn eliminate(&mut self, here: Range<usize>) {
        let size = self.size;
        let (before, rest) = self.values.split_at_mut(here.end * size);
        let (before, block) = before.split_at_mut(here.start * size);
        for row in here.clone() {
            let column = row - here.start;
            let pivot = pivot(&block[column * size..][..size], row);
            self.exchanged.push(pivot);
            Columns { values: block, stride: size }.exchange(std::iter::once((row, pivot)));
            eliminate_column(block, size, row, column);
        }
        let exchanged = here.clone().zip(self.exchanged[here.start..].iter().copied());
        Columns { values: before, stride: size }.exchange(exchanged.clone());
        let lower = inverse(&block[here.start..], size, here.len(), true);
        let upper = inverse(&block[here.start..], size, here.len(), false);
        let mut rest = Columns { values: rest, stride: size };
        rest.exchange(exchanged);
        rest.multiply(here.clone(), &lower, false);
        let rows = rest.rows(here.clone());
        let left = View { values: &block[here.end..], stride: size, by_rows: false };
        rest.subtract(here.end..size, left, &rows, here.len());
        self.lower.push(lower);
        self.upper.push(upper);
    }

    /// Solves for columns, each with at least as many rows as the matrix.
    pub(super) fn solve(&self, right: &mut [f64], stride: usize) {
        let mut right = Columns { values: right, stride };
        right.exchange(self.exchanged.iter().copied().enumerate());
        for (here, inverse) in self.blocks().zip(&self.lower) {
            right.multiply(here.clone(), inverse, false);
            let rows = right.rows(here.clone());
            right.subtract(here.end..self.size, self.part(here.start, here.end, false), &rows, here.len());
        }
        for (here, inverse) in self.blocks().rev().zip(self.upper.iter().rev()) {
            right.multiply(here.clone(), inverse, false);
            let rows = right.rows(here.clone());
            right.subtract(0..here.start, self.part(here.start, 0, false), &rows, here.len());
        }
    }

    /// Solves the same for the transposed matrix.
    pub(super) fn solve_transposed(&self, right: &mut [f64], stride: usize) {
        let mut right = Columns { values: right, stride };
        for (here, inverse) in self.blocks().zip(&self.upper) {
            let rows = right.rows(0..here.start);
            right.subtract(here.clone(), self.part(here.start, 0, true), &rows, here.start);
            right.multiply(here, inverse, true);
        }
        for (here, inverse) in self.blocks().rev().zip(self.lower.iter().rev()) {
            let rows = right.rows(here.end..self.size);
            right.subtract(here.clone(), self.part(here.start, here.end, true), &rows, self.size - here.end);
            right.multiply(here, inverse, true);
        }
        right.exchange(self.exchanged.iter().copied().enumerate().rev());
    }
}

/// Columns for which equations are solved, or that are eliminated.
struct Columns<'a> {
    values: &'a mut [f64],
    /// From the start of a column to that of the next.
    stride: usize,
}

impl Columns<'_> {
    fn count(&self) -> usize {
        self.values.len() / self.stride
    }

    fn exchange(&mut self, rows: impl DoubleEndedIterator<Item = (usize, usize)> + Clone) {
        for column in self.values.chunks_exact_mut(self.stride) {
            rows.clone().for_each(|(row, with)| column.swap(row, with));
        }
    }

    /// Returns some rows, column by column.
    fn rows(&self, rows: Range<usize>) -> Vec<f64> {
        self.values.chunks_exact(self.stride).flat_map(|column| &column[rows.clone()]).copied().collect()
    }

    /// Subtracts from some rows products with other rows.
    fn subtract(&mut self, from: Range<usize>, left: View<'_>, rows: &[f64], inner: usize) {
        self.add(from, left, rows, inner, -1.0);
    }

    /// Multiplies rows by a square matrix.
    fn multiply(&mut self, rows: Range<usize>, inverse: &[f64], by_rows: bool) {
        let before = self.rows(rows.clone());
        self.values.chunks_exact_mut(self.stride).for_each(|column| column[rows.clone()].fill(0.0));
        let wide = rows.len();
        self.add(rows, View { values: inverse, stride: wide, by_rows }, &before, wide, 1.0);
    }

    fn add(&mut self, to: Range<usize>, left: View<'_>, rows: &[f64], inner: usize, factor: f64) {
        let columns = self.count();
        if !to.is_empty() && columns > 0 {
            let right = View { values: rows, stride: inner, by_rows: false };
            let (out, stride, rows) = (&mut self.values[to.start..], self.stride, to.len());
            Product { left, right, factor, out, stride, rows, columns, inner }.add();
        }
    }
}

/// Returns the row, from that of the diagonal on, with the largest element of a column.
fn pivot(column: &[f64], row: usize) -> usize {
    let larger = |best: usize, i: usize| if column[i].abs() > column[best].abs() { i } else { best };
    (row + 1..column.len()).fold(row, larger)
}

/// Divides a column below the diagonal and eliminates it from those after it.
fn eliminate_column(block: &mut [f64], size: usize, row: usize, column: usize) {
    let (before, after) = block.split_at_mut((column + 1) * size);
    let (diagonal, below) = before[column * size..][row..].split_at_mut(1);
    with_widest_simd(
        #[inline(always)]
        || {
            let reciprocal = 1.0 / diagonal[0];
            below.iter_mut().for_each(|value| *value *= reciprocal);
            for other in after.chunks_exact_mut(size) {
                let factor = other[row];
                other[row + 1..]
                    .iter_mut()
                    .zip(&*below)
                    .for_each(|(value, left)| *value = (-factor).mul_add(*left, *value));
            }
        },
    );
}

/// Returns the inverse of a triangle of a block, the lower one with ones on its diagonal.
fn inverse(block: &[f64], stride: usize, size: usize, lower: bool) -> Vec<f64> {
    let mut all = vec![0.0; size * size];
    for (j, column) in all.chunks_exact_mut(size).enumerate() {
        column[j] = 1.0;
        if lower {
            for i in j..size {
                let (value, after) = (column[i], &mut column[i + 1..]);
                after
                    .iter_mut()
                    .zip(&block[i * stride + i + 1..])
                    .for_each(|(row, left)| *row -= value * left);
            }
        } else {
            for i in (0..=j).rev() {
                let from = &block[i * stride..];
                column[i] /= from[i];
                let value = column[i];
                column[..i].iter_mut().zip(from).for_each(|(row, left)| *row -= value * left);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elements between -1 and 1 of a matrix without order, its diagonal small: rows have to be exchanged.
    fn element(size: usize, i: usize, j: usize) -> f64 {
        let value = ((i * size + j) as f64 * 12.9898).sin() * 43758.5453;
        if i == j { 1e-12 } else { 2.0 * (value - value.floor()) - 1.0 }
    }

    #[test]
    fn solutions_times_the_matrix_are_the_right_sides() {
        for size in [1, 2, 5, 15, 16, 17, 40, 75] {
            let values = (0..size * size).map(|k| element(size, k % size, k / size) + f64::from(size == 1));
            let factors = Factors::new(size, values.collect());
            let at = |i: usize, j: usize| element(size, i, j) + f64::from(size == 1);
            for (columns, transposed) in
                [(1, false), (1, true), (4, false), (4, true), (21, false), (21, true)]
            {
                let stride = size + 3;
                let right: Vec<f64> = (0..columns * stride).map(|k| (k as f64).cos()).collect();
                let mut found = right.clone();
                if transposed {
                    factors.solve_transposed(&mut found, stride);
                } else {
                    factors.solve(&mut found, stride);
                }
                for (found, right) in found.chunks(stride).zip(right.chunks(stride)) {
                    let largest = found[..size].iter().fold(1.0_f64, |largest, x| largest.max(x.abs()));
                    for (i, right) in right[..size].iter().enumerate() {
                        let entry = |j: usize| if transposed { at(j, i) } else { at(i, j) };
                        let product: f64 = (0..size).map(|j| entry(j) * found[j]).sum();
                        assert!((product - right).abs() < 1e-13 * size as f64 * largest, "{size}, row {i}");
                    }
                    assert_eq!(found[size..], right[size..]);
                }
            }
        }
    }
}

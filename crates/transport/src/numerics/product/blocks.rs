//! Products in blocks, the left factor by columns.

use std::array::from_fn;

use pulp::Simd;

use super::{LANES, Product, View, from_lane};

/// Number of products that are added before sums leave the registers.
const DEPTH: usize = 128;
/// As many columns of a block as registers allow: fewer where there are only 16 registers.
const WIDEST: usize = 8;

impl Product<'_> {
    #[inline(always)]
    pub(super) fn add_blocks<S: Simd>(&mut self, simd: S) {
        if self.inner <= DEPTH / 8 {
            self.all_columns(simd, &mut [0.0; WIDEST * DEPTH / 8]);
        } else {
            self.all_columns(simd, &mut [0.0; WIDEST * DEPTH]);
        }
    }

    #[inline(always)]
    fn all_columns<S: Simd>(&mut self, simd: S, buffer: &mut [f64]) {
        let mut column = 0;
        while column < self.columns {
            column += match self.columns - column {
                WIDEST.. if S::F64_LANES == LANES => self.some_columns::<S, 3, WIDEST>(simd, column, buffer),
                4.. => self.some_columns::<S, 3, 4>(simd, column, buffer),
                3 => self.some_columns::<S, 3, 3>(simd, column, buffer),
                2 => self.some_columns::<S, 4, 2>(simd, column, buffer),
                _ => self.some_columns::<S, 4, 1>(simd, column, buffer),
            };
        }
    }

    /// Adds `WIDE` columns from `first` on, in blocks `HIGH` registers high; returns their number. `buffer`: for
    /// these columns of `right`, row by row.
    #[inline(always)]
    fn some_columns<S: Simd, const HIGH: usize, const WIDE: usize>(
        &mut self,
        simd: S,
        first: usize,
        buffer: &mut [f64],
    ) -> usize {
        let (buffer, _) = buffer.as_chunks_mut::<WIDE>();
        for at in (0..self.inner).step_by(DEPTH) {
            let right = &mut buffer[..DEPTH.min(self.inner - at)];
            self.right.copy(at, first, right);
            let left = &self.left.values[at * self.left.stride..];
            if self.rows < S::F64_LANES {
                self.low_block::<S, WIDE>(simd, left, right, first);
                continue;
            }
            let mut row = 0;
            while row < self.rows {
                // The last block ends with the last row; rows above that it repeats are not added again.
                let high = HIGH.min((self.rows - row).div_ceil(S::F64_LANES)).min(self.rows / S::F64_LANES);
                let start = row.min(self.rows - high * S::F64_LANES);
                let place = (start, row - start, first);
                match high {
                    1 => self.block::<S, 1, WIDE>(simd, left, right, place),
                    2 => self.block::<S, 2, WIDE>(simd, left, right, place),
                    3 => self.block::<S, 3, WIDE>(simd, left, right, place),
                    _ => self.block::<S, HIGH, WIDE>(simd, left, right, place),
                }
                row = start + high * S::F64_LANES;
            }
        }
        WIDE
    }

    /// Adds a block without its first rows; `place`: its first row, number of rows not added, first column.
    #[inline(always)]
    fn block<S: Simd, const HIGH: usize, const WIDE: usize>(
        &mut self,
        simd: S,
        left: &[f64],
        right: &[[f64; WIDE]],
        (row, done, column): (usize, usize, usize),
    ) {
        let sums = sums::<S, HIGH, WIDE>(simd, &left[row..], self.left.stride, right);
        let factor = simd.splat_f64s(self.factor);
        let first = if done == 0 { factor } else { from_lane::<S>(done, self.factor) };
        for (j, sums) in sums.iter().enumerate() {
            let out = &mut self.out[(column + j) * self.stride + row..][..HIGH * S::F64_LANES];
            let (out, _) = S::as_mut_simd_f64s(out);
            for (i, (out, sum)) in out.iter_mut().zip(sums).enumerate() {
                *out = simd.mul_add_f64s(if i == 0 { first } else { factor }, *sum, *out);
            }
        }
    }

    /// Adds columns of fewer rows than a register has; `left` has as many as a register.
    #[inline(always)]
    fn low_block<S: Simd, const WIDE: usize>(
        &mut self,
        simd: S,
        left: &[f64],
        right: &[[f64; WIDE]],
        column: usize,
    ) {
        let sums = sums::<S, 1, WIDE>(simd, left, self.left.stride, right);
        for (j, [sum]) in sums.iter().enumerate() {
            let mut each = [0.0; LANES];
            S::as_mut_simd_f64s(&mut each).0[0] = *sum;
            let out = &mut self.out[(column + j) * self.stride..][..self.rows];
            out.iter_mut().zip(&each).for_each(|(out, sum)| *out += self.factor * sum);
        }
    }
}

impl View<'_> {
    /// Copies rows from `row` on of columns from `column` on.
    #[inline(always)]
    fn copy<const WIDE: usize>(&self, row: usize, column: usize, to: &mut [[f64; WIDE]]) {
        if self.by_rows {
            for (to, row) in to.iter_mut().zip(self.values[row * self.stride..].chunks(self.stride)) {
                to.copy_from_slice(&row[column..][..WIDE]);
            }
        } else {
            let columns: [&[f64]; WIDE] =
                from_fn(|j| &self.values[(column + j) * self.stride + row..][..to.len()]);
            for (i, to) in to.iter_mut().enumerate() {
                *to = from_fn(|j| columns[j][i]);
            }
        }
    }
}

/// Returns sums of products of some registers of rows with some columns.
#[inline(always)]
fn sums<S: Simd, const HIGH: usize, const WIDE: usize>(
    simd: S,
    left: &[f64],
    stride: usize,
    right: &[[f64; WIDE]],
) -> [[S::f64s; HIGH]; WIDE] {
    let mut sums = [[simd.splat_f64s(0.0); HIGH]; WIDE];
    for (left, right) in left.chunks(stride).zip(right) {
        let (left, _) = S::as_simd_f64s(&left[..HIGH * S::F64_LANES]);
        let left: [S::f64s; HIGH] = from_fn(|i| left[i]);
        for (sums, right) in sums.iter_mut().zip(right) {
            let right = simd.splat_f64s(*right);
            for (sum, left) in sums.iter_mut().zip(&left) {
                *sum = simd.mul_add_f64s(*left, right, *sum);
            }
        }
    }
    sums
}

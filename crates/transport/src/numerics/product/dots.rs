//! Products as scalar products of rows of the left factor with columns of the right one.

use std::array::from_fn;

use pulp::Simd;

use super::{LANES, Product, from_lane};

/// Number of columns that are computed together.
const WIDE: usize = 4;

impl Product<'_> {
    /// Adds the product: `left` by rows, `right` by columns; sums of at least as many products as a register has
    /// elements.
    #[inline(always)]
    pub(super) fn add_dots<S: Simd>(&mut self, simd: S) {
        if S::F64_LANES == LANES { self.all_dots::<S, 4>(simd) } else { self.all_dots::<S, 2>(simd) }
    }

    #[inline(always)]
    fn all_dots<S: Simd, const HIGH: usize>(&mut self, simd: S) {
        let (rows, columns) = (self.rows - self.rows % HIGH, self.columns - self.columns % WIDE);
        for column in (0..columns).step_by(WIDE) {
            (0..rows).step_by(HIGH).for_each(|row| self.dots::<S, HIGH, WIDE>(simd, row, column));
            (rows..self.rows).for_each(|row| self.dots::<S, 1, WIDE>(simd, row, column));
        }
        for column in columns..self.columns {
            (0..rows).step_by(HIGH).for_each(|row| self.dots::<S, HIGH, 1>(simd, row, column));
            (rows..self.rows).for_each(|row| self.dots::<S, 1, 1>(simd, row, column));
        }
    }

    /// Adds a block of scalar products.
    #[inline(always)]
    fn dots<S: Simd, const HIGH: usize, const WIDE: usize>(&mut self, simd: S, row: usize, column: usize) {
        let inner = self.inner;
        let left: [&[f64]; HIGH] = from_fn(|i| &self.left.values[(row + i) * self.left.stride..][..inner]);
        let right: [&[f64]; WIDE] =
            from_fn(|j| &self.right.values[(column + j) * self.right.stride..][..inner]);
        let mut sums = [[simd.splat_f64s(0.0); WIDE]; HIGH];
        let whole = inner - inner % S::F64_LANES;
        for at in (0..whole).step_by(S::F64_LANES) {
            let right = from_fn(|j| load::<S>(right[j], at));
            add::<S, HIGH, WIDE>(simd, &mut sums, &left, right, at);
        }
        if whole < inner {
            // The last register ends with the last element; those that it repeats count nothing.
            let at = inner - S::F64_LANES;
            let mask = from_lane::<S>(whole - at, 1.0);
            let right = from_fn(|j| simd.mul_f64s(mask, load::<S>(right[j], at)));
            add::<S, HIGH, WIDE>(simd, &mut sums, &left, right, at);
        }
        for j in 0..WIDE {
            let out = &mut self.out[(column + j) * self.stride + row..][..HIGH];
            for (out, sums) in out.iter_mut().zip(&sums) {
                *out += self.factor * simd.reduce_sum_f64s(sums[j]);
            }
        }
    }
}

#[inline(always)]
fn add<S: Simd, const HIGH: usize, const WIDE: usize>(
    simd: S,
    sums: &mut [[S::f64s; WIDE]; HIGH],
    left: &[&[f64]; HIGH],
    right: [S::f64s; WIDE],
    at: usize,
) {
    for (sums, left) in sums.iter_mut().zip(left) {
        let left = load::<S>(left, at);
        for (sum, right) in sums.iter_mut().zip(&right) {
            *sum = simd.mul_add_f64s(left, *right, *sum);
        }
    }
}

#[inline(always)]
fn load<S: Simd>(all: &[f64], at: usize) -> S::f64s {
    S::as_simd_f64s(&all[at..][..S::F64_LANES]).0[0]
}

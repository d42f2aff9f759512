//! Small square complex matrices, and scattering matrices of them.

use std::ops::{Add, Mul, Sub};

use num_complex::Complex64;

/// Square matrix, by rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Matrix<const N: usize>(pub(super) [[Complex64; N]; N]);

impl<const N: usize> Matrix<N> {
    pub(super) const ZERO: Self = Self([[Complex64::ZERO; N]; N]);

    pub(super) fn identity() -> Self {
        Self::diagonal([Complex64::ONE; N])
    }

    pub(super) fn diagonal(values: [Complex64; N]) -> Self {
        let mut out = Self::ZERO;
        values.into_iter().enumerate().for_each(|(k, value)| out.0[k][k] = value);
        out
    }

    pub(super) fn times(self, factor: Complex64) -> Self {
        Self(self.0.map(|row| row.map(|value| value * factor)))
    }

    /// Returns the largest sum of absolute values of a row.
    pub(super) fn norm(&self) -> f64 {
        self.0.iter().map(|row| row.iter().map(|value| value.norm()).sum()).fold(0.0, f64::max)
    }

    /// Solves `self x = right` by Gaussian elimination with pivots; not finite if the matrix is singular.
    pub(super) fn solve(mut self, mut right: Self) -> Self {
        for column in 0..N {
            let size = |row: usize| self.0[row][column].norm_sqr();
            let pivot = (column..N).max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(column);
            self.0.swap(column, pivot);
            right.0.swap(column, pivot);
            let inverse = self.0[column][column].inv();
            let (pivot_left, pivot_right) = (self.0[column], right.0[column]);
            for row in column + 1..N {
                let factor = self.0[row][column] * inverse;
                if factor != Complex64::ZERO {
                    (column..N).for_each(|k| self.0[row][k] -= factor * pivot_left[k]);
                    (0..N).for_each(|k| right.0[row][k] -= factor * pivot_right[k]);
                }
            }
        }
        for row in (0..N).rev() {
            let inverse = self.0[row][row].inv();
            for k in 0..N {
                let below: Complex64 = (row + 1..N).map(|j| self.0[row][j] * right.0[j][k]).sum();
                right.0[row][k] = (right.0[row][k] - below) * inverse;
            }
        }
        right
    }

    pub(super) fn inverse(self) -> Self {
        self.solve(Self::identity())
    }
}

impl<const N: usize> Mul for Matrix<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let mut out = Self::ZERO;
        for (row, left) in out.0.iter_mut().zip(&self.0) {
            for (factor, right) in left.iter().zip(&other.0) {
                row.iter_mut().zip(right).for_each(|(sum, value)| *sum += factor * value);
            }
        }
        out
    }
}

impl<const N: usize> Add for Matrix<N> {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        let values = self.0.iter_mut().flatten().zip(other.0.iter().flatten());
        values.for_each(|(sum, value)| *sum += value);
        self
    }
}

impl<const N: usize> Sub for Matrix<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other.times(-Complex64::ONE)
    }
}

impl Matrix<4> {
    /// Returns the 2x2 block at these numbers of blocks.
    pub(super) fn block(&self, row: usize, column: usize) -> Matrix<2> {
        Matrix(std::array::from_fn(|i| std::array::from_fn(|k| self.0[2 * row + i][2 * column + k])))
    }

    /// Joins four columns.
    pub(super) fn of_columns(columns: [[Complex64; 4]; 4]) -> Self {
        Self(std::array::from_fn(|row| columns.map(|column| column[row])))
    }
}

impl Matrix<2> {
    /// Returns the action on the coherency matrix `<a_i a_k*>`, whose elements are 00, 01, 10, 11.
    pub(super) fn on_coherency(&self) -> Matrix<4> {
        let element =
            |row: usize, column: usize| self.0[row / 2][column / 2] * self.0[row % 2][column % 2].conj();
        Matrix(std::array::from_fn(|row| std::array::from_fn(|column| element(row, column))))
    }
}

/// Reflection and transmission of a part of a stack, from above and from below.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scattering<const N: usize> {
    /// Reflection of light from above.
    pub(super) r: Matrix<N>,
    /// Transmission downwards.
    pub(super) t: Matrix<N>,
    /// Reflection of light from below.
    pub(super) r_below: Matrix<N>,
    /// Transmission upwards.
    pub(super) t_up: Matrix<N>,
}

impl<const N: usize> Scattering<N> {
    /// Nothing: all light passes.
    pub(super) fn nothing() -> Self {
        let (none, all) = (Matrix::ZERO, Matrix::identity());
        Self { r: none, t: all, r_below: none, t_up: all }
    }

    /// Returns both parts together, `below` being below this one (Redheffer's star product).
    pub(super) fn over(&self, below: &Self) -> Self {
        // Light between the parts, summed over all orders: of the light that comes down, and up.
        let down = (Matrix::identity() - self.r_below * below.r).solve(self.t);
        let up = (Matrix::identity() - below.r * self.r_below).solve(below.t_up);
        Self {
            r: self.r + self.t_up * below.r * down,
            t: below.t * down,
            r_below: below.r_below + below.t * self.r_below * up,
            t_up: self.t_up * up,
        }
    }
}

impl Scattering<2> {
    /// Returns the part for intensities, without the phases of light that enters.
    pub(super) fn on_coherency(&self) -> Scattering<4> {
        Scattering {
            r: self.r.on_coherency(),
            t: self.t.on_coherency(),
            r_below: self.r_below.on_coherency(),
            t_up: self.t_up.on_coherency(),
        }
    }
}

//! Operators on the nodes of a grid: regular and scattered light.
//!
//! An operator of one azimuthal order maps radiance over the nodes to radiance over the nodes: a factor for
//! each node (light that keeps its direction) and a kernel (light that changes it). Because the two are
//! separate, a collimated beam through a stack is exact.
//!
//! Kernels are scaled by the square root of the quadrature weight on either side, so that products need no
//! weights and reciprocal operators are symmetric. The first `regular` nodes carry weight. The rest are
//! *extra* nodes, the directions of views and beams: they have rows and columns, but do not contribute to
//! sums over directions.

use std::sync::Arc;

use super::matrix::{Factors, Matrix};

/// Smallest significant factor: smaller ones are rounding errors of a difference that is zero, where no
/// light enters.
const CLOSED: f64 = 1e-14;

/// An operator of one azimuthal order.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    /// The number of nodes with weight.
    pub(super) regular: usize,
    /// Regular part: a factor for each node.
    pub(super) straight: Vec<f64>,
    /// Scattered part: `[out, in]`, scaled.
    pub(super) kernel: Option<Arc<Matrix>>,
}

impl Operator {
    /// Returns an operator that consists of factors only.
    pub(super) fn diagonal(regular: usize, straight: Vec<f64>) -> Self {
        Self { regular, straight, kernel: None }
    }

    /// Returns the number of nodes.
    pub(super) fn len(&self) -> usize {
        self.straight.len()
    }

    /// Returns an element of the kernel, scaled.
    pub(super) fn at(&self, out: usize, from: usize) -> f64 {
        self.kernel.as_ref().map_or(0.0, |kernel| kernel[(out, from)])
    }

    /// `a * self + b * other`.
    pub(super) fn combine(&self, a: f64, other: &Self, b: f64) -> Self {
        let straight = self.straight.iter().zip(&other.straight).map(|(x, y)| a * x + b * y).collect();
        let kernel = match (&self.kernel, &other.kernel) {
            (None, None) => None,
            (Some(x), None) => Some(Matrix::clone(x).scaled(a)),
            (None, Some(y)) => Some(Matrix::clone(y).scaled(b)),
            (Some(x), Some(y)) => Some(x.combine(a, y, b)),
        };
        Self { regular: self.regular, straight, kernel: kernel.map(Arc::new) }
    }

    /// Adds `factor * other`.
    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        self.straight.iter_mut().zip(&other.straight).for_each(|(x, y)| *x += factor * y);
        match (&mut self.kernel, &other.kernel) {
            (_, None) => {}
            (kernel @ None, Some(y)) => *kernel = Some(Arc::new(Matrix::clone(y).scaled(factor))),
            (Some(x), Some(y)) => {
                for (j, column) in Arc::make_mut(x).columns_mut() {
                    column.iter_mut().zip(y.column(j)).for_each(|(x, y)| *x += factor * y);
                }
            }
        }
    }

    /// Returns `factor * self`.
    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.straight.iter_mut().for_each(|x| *x *= factor);
        let kernel = self.kernel.map(|kernel| Arc::new(Arc::unwrap_or_clone(kernel).scaled(factor)));
        Self { kernel, ..self }
    }

    /// Returns `1 + factor * self`.
    pub(super) fn one_plus(&self, factor: f64) -> Self {
        let straight = self.straight.iter().map(|x| 1.0 + factor * x).collect();
        let kernel = self.kernel.as_ref().map(|kernel| Arc::new(Matrix::clone(kernel).scaled(factor)));
        Self { regular: self.regular, straight, kernel }
    }

    /// Returns the sum of two operators.
    pub(super) fn plus(&self, other: &Self) -> Self {
        self.combine(1.0, other, 1.0)
    }

    /// Returns the operator for light in the opposite direction (reciprocity).
    pub(super) fn transposed(&self) -> Self {
        let kernel = self.kernel.as_ref().map(|kernel| Arc::new(kernel.transposed()));
        Self { regular: self.regular, straight: self.straight.clone(), kernel }
    }

    /// Returns `self` after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        if self.is_dark() || first.is_dark() {
            return Self::diagonal(self.regular, vec![0.0; self.len()]);
        }
        let straight: Vec<f64> = self.straight.iter().zip(&first.straight).map(|(a, b)| a * b).collect();
        let mut kernel = match (&self.kernel, &first.kernel) {
            (None, None) => None,
            (Some(kernel), _) => {
                let mut kernel = Matrix::clone(kernel);
                for (j, column) in kernel.columns_mut() {
                    column.iter_mut().for_each(|x| *x *= first.straight[j]);
                }
                Some(kernel)
            }
            (None, Some(_)) => Some(Matrix::zeros(self.len(), self.len())),
        };
        if let (Some(kernel), Some(right)) = (&mut kernel, &first.kernel) {
            for (j, column) in kernel.columns_mut() {
                let terms = self.straight.iter().zip(right.column(j));
                column.iter_mut().zip(terms).for_each(|(x, (a, b))| *x += a * b);
            }
            if let Some(left) = &self.kernel {
                kernel.add_product(left, right, self.regular);
            }
        }
        Self { regular: self.regular, straight, kernel: kernel.map(Arc::new) }
    }

    /// Solves for the operator from which this one makes `right`: `self^-1 right`.
    pub(super) fn solve(&self, right: &Self) -> Self {
        self.solve_with(right, self.kernel.as_ref().map(|_| self.weighted_block().factors()), false)
    }

    /// Returns `self^-1 right` and `(self^-1)^T other`, self symmetric in its factors.
    pub(super) fn solve_both(&self, right: &Self, other: &Self) -> [Self; 2] {
        if self.kernel.is_none() {
            return [self.solve(right), self.solve(other)];
        }
        let factors = self.weighted_block().factors();
        let transposed = self.transposed().solve_with(other, Some(&factors), true);
        [self.solve_with(right, Some(&factors), false), transposed]
    }

    fn solve_with<F: AsRef<Factors>>(&self, right: &Self, factors: Option<F>, transposed: bool) -> Self {
        let inverse = self.inverse_straight();
        let straight: Vec<f64> = inverse.iter().zip(&right.straight).map(|(a, b)| a * b).collect();
        let n = self.regular;
        let zeros = || Matrix::zeros(self.len(), self.len());
        let kernel = match (&self.kernel, factors) {
            (Some(left), Some(factors)) => {
                let mut x = right.kernel.as_deref().cloned().unwrap_or_else(zeros);
                for (j, column) in x.columns_mut() {
                    column.iter_mut().zip(left.column(j)).for_each(|(x, a)| *x -= a * straight[j]);
                }
                factors.as_ref().solve_either(&mut x, transposed);
                x.eliminate(left, n);
                for (_, column) in x.columns_mut() {
                    column.iter_mut().zip(&inverse).skip(n).for_each(|(x, inverse)| *x *= inverse);
                }
                Some(x)
            }
            _ => right.kernel.as_deref().cloned().map(|mut x| {
                for (_, column) in x.columns_mut() {
                    column.iter_mut().zip(&inverse).for_each(|(x, inverse)| *x *= inverse);
                }
                x
            }),
        };
        Self { regular: n, straight, kernel: kernel.map(Arc::new) }
    }

    /// Returns one over the factors; 0 where no light enters.
    pub(super) fn inverse_straight(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.inverse_straight_at(i)).collect()
    }

    /// Returns the same for one node.
    pub(super) fn inverse_straight_at(&self, i: usize) -> f64 {
        let factor = self.straight[i];
        if factor.abs() < CLOSED { 0.0 } else { 1.0 / factor }
    }

    /// Returns whether it absorbs everything.
    fn is_dark(&self) -> bool {
        self.kernel.is_none() && self.straight.iter().all(|factor| *factor == 0.0)
    }

    /// Returns the part that acts among the nodes with weight, as one matrix. A direction that light can
    /// neither enter nor leave is defined to contain none.
    pub(super) fn weighted_block(&self) -> Matrix {
        let n = self.regular;
        let mut block = Matrix::from_fn(n, n, |i, j| self.at(i, j));
        for i in 0..n {
            block[(i, i)] += self.straight[i];
            if self.straight[i].abs() < CLOSED && (0..n).all(|j| block[(i, j)].abs() < CLOSED) {
                block[(i, i)] = 1.0;
            }
        }
        block
    }

    /// Returns a functional of the outgoing light as a functional of the incoming: `share` is its value for
    /// a unit of light at each node, `scale` the scaling of the kernel.
    pub(super) fn pull_back(&self, share: &[f64], scale: &[f64]) -> Vec<f64> {
        let weights: Vec<f64> = share.iter().zip(scale).take(self.regular).map(|(s, c)| s * c).collect();
        let mut pulled: Vec<f64> = share.iter().zip(&self.straight).map(|(s, d)| s * d).collect();
        if let Some(kernel) = &self.kernel {
            for (j, value) in pulled.iter_mut().enumerate() {
                let scattered: f64 = weights.iter().zip(kernel.column(j)).map(|(w, k)| w * k).sum();
                *value += scattered / scale[j];
            }
        }
        pulled
    }
}

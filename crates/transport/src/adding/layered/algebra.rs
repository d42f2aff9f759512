//! Operators on the nodes of a grid: what they pass unscattered, and what they scatter.
//!
//! An operator of one azimuthal order maps radiance over the nodes to radiance over the nodes:
//! a factor for each node (light that keeps its direction) and a kernel (light that changes it).
//! Keeping the two apart lets a collimated beam through a stack exactly.
//!
//! Kernels are scaled by the square root of the quadrature weight on either side, so that
//! products need no weights and reciprocal operators are symmetric. The first `regular` nodes
//! carry weight; the rest are *extra*, directions of views and beams: they have rows and columns
//! and no part in sums over directions.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Accum, Mat, Par};

/// A factor below this is rounding of a difference that is zero: light that nothing lets in.
const CLOSED: f64 = 1e-14;

/// An operator of one azimuthal order.
#[derive(Debug, Clone)]
pub(super) struct Operator {
    /// The number of nodes with weight.
    pub(super) regular: usize,
    /// Unscattered: a factor for each node.
    pub(super) straight: Vec<f64>,
    /// Scattered: `[out, in]`, scaled.
    pub(super) kernel: Option<Mat<f64>>,
}

impl Operator {
    /// Nothing but factors.
    pub(super) fn diagonal(regular: usize, straight: Vec<f64>) -> Self {
        Self { regular, straight, kernel: None }
    }

    /// The number of nodes.
    pub(super) fn len(&self) -> usize {
        self.straight.len()
    }

    /// The kernel's element, scaled.
    pub(super) fn at(&self, out: usize, from: usize) -> f64 {
        self.kernel.as_ref().map_or(0.0, |kernel| kernel[(out, from)])
    }

    /// `a * self + b * other`.
    pub(super) fn combine(&self, a: f64, other: &Self, b: f64) -> Self {
        let straight = self.straight.iter().zip(&other.straight).map(|(x, y)| a * x + b * y).collect();
        let kernel = match (&self.kernel, &other.kernel) {
            (None, None) => None,
            (Some(x), None) => Some(faer::Scale(a) * x),
            (None, Some(y)) => Some(faer::Scale(b) * y),
            (Some(x), Some(y)) => {
                Some(Mat::from_fn(x.nrows(), x.ncols(), |i, j| a * x[(i, j)] + b * y[(i, j)]))
            }
        };
        Self { regular: self.regular, straight, kernel }
    }

    /// `factor * self`.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let straight = self.straight.iter().map(|x| factor * x).collect();
        let kernel = self.kernel.as_ref().map(|kernel| faer::Scale(factor) * kernel);
        Self { regular: self.regular, straight, kernel }
    }

    /// `1 + factor * self`.
    pub(super) fn one_plus(&self, factor: f64) -> Self {
        let straight = self.straight.iter().map(|x| 1.0 + factor * x).collect();
        let kernel = self.kernel.as_ref().map(|kernel| faer::Scale(factor) * kernel);
        Self { regular: self.regular, straight, kernel }
    }

    /// The sum of two.
    pub(super) fn plus(&self, other: &Self) -> Self {
        self.combine(1.0, other, 1.0)
    }

    /// Light the other way (reciprocity).
    pub(super) fn transposed(&self) -> Self {
        let kernel = self.kernel.as_ref().map(|kernel| kernel.transpose().to_owned());
        Self { regular: self.regular, straight: self.straight.clone(), kernel }
    }

    /// `self` after `first`.
    pub(super) fn after(&self, first: &Self) -> Self {
        let straight: Vec<f64> = self.straight.iter().zip(&first.straight).map(|(a, b)| a * b).collect();
        let (n, len) = (self.regular, self.len());
        let kernel = match (&self.kernel, &first.kernel) {
            (None, None) => None,
            (Some(a), None) => Some(Mat::from_fn(len, len, |i, j| a[(i, j)] * first.straight[j])),
            (None, Some(b)) => Some(Mat::from_fn(len, len, |i, j| self.straight[i] * b[(i, j)])),
            (Some(a), Some(b)) => {
                let mut product = Mat::from_fn(len, len, |i, j| {
                    a[(i, j)] * first.straight[j] + self.straight[i] * b[(i, j)]
                });
                let (left, right) = (a.get(.., ..n), b.get(..n, ..));
                matmul(product.as_mut(), Accum::Add, left, right, 1.0, Par::Seq);
                Some(product)
            }
        };
        Self { regular: n, straight, kernel }
    }

    /// The operator that this one makes `right` of: `self^-1 right`.
    pub(super) fn solve(&self, right: &Self) -> Self {
        let inverse: Vec<f64> =
            self.straight.iter().map(|d| if d.abs() < CLOSED { 0.0 } else { 1.0 / d }).collect();
        let straight: Vec<f64> = inverse.iter().zip(&right.straight).map(|(a, b)| a * b).collect();
        let (n, len) = (self.regular, self.len());
        let kernel = match (&self.kernel, &right.kernel) {
            (None, None) => None,
            (None, Some(b)) => Some(Mat::from_fn(len, len, |i, j| inverse[i] * b[(i, j)])),
            (Some(a), b) => {
                let b_at = |i: usize, j: usize| b.as_ref().map_or(0.0, |b| b[(i, j)]);
                let mut x = Mat::from_fn(len, len, |i, j| b_at(i, j) - a[(i, j)] * straight[j]);
                let lu = PartialPivLu::new(self.weighted_block().as_ref());
                let (mut top, mut bottom) = x.as_mut().split_at_row_mut(n);
                lu.solve_in_place(top.as_mut());
                matmul(bottom.as_mut(), Accum::Add, a.get(n.., ..n), top.as_ref(), -1.0, Par::Seq);
                for j in 0..len {
                    for i in 0..len - n {
                        bottom[(i, j)] *= inverse[n + i];
                    }
                }
                Some(x)
            }
        };
        Self { regular: n, straight, kernel }
    }

    /// The part that acts among the nodes with weight, as one matrix. A direction that light
    /// can neither enter nor leave is made to hold none.
    pub(super) fn weighted_block(&self) -> Mat<f64> {
        let n = self.regular;
        let mut block = match &self.kernel {
            Some(kernel) => kernel.get(..n, ..n).to_owned(),
            None => Mat::zeros(n, n),
        };
        for i in 0..n {
            block[(i, i)] += self.straight[i];
            if self.straight[i].abs() < CLOSED && (0..n).all(|j| block[(i, j)].abs() < CLOSED) {
                block[(i, i)] = 1.0;
            }
        }
        block
    }

    /// What a functional of the outgoing light is, of the incoming: `share` is its value for
    /// a unit of light at each node, `scale` the kernel's scaling.
    pub(super) fn pull_back(&self, share: &[f64], scale: &[f64]) -> Vec<f64> {
        let n = self.regular;
        let mut pulled: Vec<f64> = share.iter().zip(&self.straight).map(|(s, d)| s * d).collect();
        if let Some(kernel) = &self.kernel {
            for (j, value) in pulled.iter_mut().enumerate() {
                let scattered: f64 = (0..n).map(|i| share[i] * scale[i] * kernel[(i, j)]).sum();
                *value += scattered / scale[j];
            }
        }
        pulled
    }
}

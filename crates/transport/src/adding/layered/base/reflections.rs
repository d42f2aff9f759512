//! Scattered light between the base and the layers above, after all orders of reflection.
//!
//! All columns are iterated at once, with one matrix product for each order. Where light is nearly trapped, a
//! direct solution is cheaper.

use super::super::algebra::Operator;
use super::super::matrix::Matrix;
use super::{Above, Back, round_trips};

/// Number of reflections up to which light is followed by iteration.
const ITERATIONS: usize = 40;

/// Light that is reflected back and forth between base and layers, by node with weight and column.
pub(super) struct Reflections<'a> {
    /// Layers of each column; they share kernels.
    layers: &'a [&'a Above],
    /// Reflectance of the base, `[node, column]`.
    base: &'a Matrix,
    /// Light that rises at a node, per unit that arrives, with its regular round trips.
    gain: Matrix,
    /// Whether the transposed problem is solved.
    reversed: bool,
}

impl<'a> Reflections<'a> {
    pub(super) fn new(layers: &'a [&'a Above], base: &'a Matrix, reversed: bool) -> Self {
        let nodes = layers.first().map_or(0, |above| above.carried);
        let mut gain = Matrix::zeros(nodes, base.columns());
        for ((c, column), above) in gain.columns_mut().zip(layers) {
            let straight = base.column(c).iter().zip(&above.below_straight);
            column.iter_mut().zip(straight).for_each(|(x, (b, g))| *x = round_trips(*b, *g));
        }
        Self { layers, base, gain, reversed }
    }

    /// Returns the scattered light that rises from the base for the first time.
    pub(super) fn once(&self, arrives: &Matrix) -> Matrix {
        arrives.times_each(&self.gain)
    }

    /// Returns the scattered light that rises from the base, to this error relative to the largest density;
    /// `floor` is, by column, the density to which errors are relative if it is larger than the largest one
    /// found, and is raised to that.
    pub(super) fn rising(&self, arrives: Matrix, tolerance: f64, floor: &mut [f64]) -> Matrix {
        let mut rising = Matrix::zeros(arrives.rows(), arrives.columns());
        if arrives.rows() == 0 {
            return rising;
        }
        for column in self.iterate(&arrives, tolerance, &mut rising, floor) {
            let mut right = arrives.columns_in(column..column + 1);
            self.solve(column, &self.layers[column].formed(self.reversed), &mut right);
            rising.column_mut(column).copy_from_slice(right.column(0));
        }
        rising
    }

    /// Iterates all light; returns the columns that have not converged after many orders.
    fn iterate(
        &self,
        arrives: &Matrix,
        tolerance: f64,
        rising: &mut Matrix,
        floor: &mut [f64],
    ) -> Vec<usize> {
        let mut open: Vec<usize> = (0..arrives.columns()).collect();
        let mut before = vec![f64::INFINITY; open.len()];
        // Those that are still followed, with their light.
        let mut active = open.clone();
        let mut layers = self.layers.to_vec();
        let mut now = Matrix::zeros(arrives.rows(), active.len());
        let mut next = arrives.clone();
        for _ in 0..ITERATIONS {
            open.clear();
            for ((k, old), &c) in now.columns_mut().zip(&active) {
                let (change, size) = reflect(old, next.column(k), self.gain.column(c));
                let size = size.max(floor[c]);
                // Changes decrease geometrically: the remainder is their sum.
                let ratio = (change / before[c]).min(1.0);
                if change > tolerance * size * (1.0 - ratio) {
                    open.push(c);
                }
                (before[c], floor[c]) = (change, size);
            }
            if open.is_empty() {
                break;
            }
            if 4 * open.len() <= 3 * active.len() {
                // The others have converged.
                let still: Vec<usize> =
                    (0..active.len()).filter(|k| open.binary_search(&active[*k]).is_ok()).collect();
                active
                    .iter()
                    .enumerate()
                    .for_each(|(k, c)| rising.column_mut(*c).copy_from_slice(now.column(k)));
                (now, next) = (now.some_columns(&still), Matrix::zeros(arrives.rows(), open.len()));
                active.clone_from(&open);
                layers = active.iter().map(|c| self.layers[*c]).collect();
            }
            next.copy_columns(arrives, &active);
            Back::add(&layers, &now, &mut next, self.reversed);
        }
        active.iter().enumerate().for_each(|(k, c)| rising.column_mut(*c).copy_from_slice(now.column(k)));
        open
    }

    /// Replaces light that arrives in a column by the light that rises, by direct solution, given the
    /// reflection of light from below as one kernel.
    fn solve(&self, column: usize, below: &Matrix, right: &mut Matrix) {
        let n = right.rows();
        // 1 - B G acts on the light that rises.
        let b = &self.base.column(column)[..n];
        let kernel = Matrix::from_fn(n, n, |i, j| -b[i] * below[(i, j)]);
        let straight = b.iter().zip(&self.layers[column].below_straight).map(|(b, g)| 1.0 - b * g).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel.into()) };
        right.columns_mut().for_each(|(_, light)| light.iter_mut().zip(b).for_each(|(x, b)| *x *= b));
        closed.weighted_block().factors().solve(right);
    }
}

/// Sets `rising` to `next` times `gain`; returns the largest change and the largest value.
fn reflect(rising: &mut [f64], next: &[f64], gain: &[f64]) -> (f64, f64) {
    // Chunks of fixed size, so that they are vectorised.
    let (rising, rising_rest) = rising.as_chunks_mut::<8>();
    let (next, next_rest) = next.as_chunks::<8>();
    let (gain, gain_rest) = gain.as_chunks::<8>();
    let (mut change, mut size) = ([0.0; 8], [0.0; 8]);
    for ((rising, next), gain) in rising.iter_mut().zip(next).zip(gain) {
        for k in 0..8 {
            let value = next[k] * gain[k];
            change[k] = larger((value - rising[k]).abs(), change[k]);
            size[k] = larger(value.abs(), size[k]);
            rising[k] = value;
        }
    }
    for ((rising, next), gain) in rising_rest.iter_mut().zip(next_rest).zip(gain_rest) {
        let value = next * gain;
        change[0] = larger((value - *rising).abs(), change[0]);
        size[0] = larger(value.abs(), size[0]);
        *rising = value;
    }
    [change, size].map(|lanes| lanes.into_iter().fold(0.0, larger)).into()
}

/// Returns the larger number, by a comparison that can be vectorised.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

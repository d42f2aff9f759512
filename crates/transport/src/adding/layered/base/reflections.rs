//! Scattered light between the base and the layers above, after all orders of reflection.
//!
//! All columns are iterated at once, with one matrix product for each order. Where light is nearly trapped, a direct
//! solution is cheaper.

use super::super::algebra::Operator;
use super::super::matrix::Matrix;
use super::{Above, round_trips};

/// Number of reflections up to which light is followed by iteration.
const ITERATIONS: usize = 40;

/// Light that arrives at the base and is reflected back and forth, by node with weight and column.
pub(super) struct Reflections<'a> {
    layers: &'a Above,
    /// Scattered light that arrives from above.
    arrives: Matrix,
    /// Light that rises at a node, per unit that arrives, with its regular round trips.
    gain: Matrix,
    /// Error relative to the largest density.
    tolerance: f64,
    /// Whether the transposed problem is solved.
    reversed: bool,
}

impl<'a> Reflections<'a> {
    /// Describes light that arrives at a base of this reflectance, `[node, column]`.
    pub(super) fn new(
        layers: &'a Above,
        arrives: Matrix,
        base: &Matrix,
        tolerance: f64,
        reversed: bool,
    ) -> Self {
        let mut gain = Matrix::zeros(layers.carried, base.columns());
        for (c, column) in gain.columns_mut() {
            let straight = base.column(c).iter().zip(&layers.below_straight);
            column.iter_mut().zip(straight).for_each(|(x, (b, g))| *x = round_trips(*b, *g));
        }
        Self { layers, arrives, gain, tolerance, reversed }
    }

    /// Returns the scattered light that rises from the base; `floor` is, by column, the density to which errors are
    /// relative if it is larger than the largest one found, and is raised to that.
    pub(super) fn rising(&self, base: &Matrix, floor: &mut [f64]) -> Matrix {
        let n = self.layers.carried;
        let mut rising = Matrix::zeros(n, self.arrives.columns());
        if n == 0 {
            return rising;
        }
        let open = self.iterate(&mut rising, floor);
        if !open.is_empty() {
            let below = self.layers.below.formed(n, self.reversed);
            for column in open {
                self.solve(&below, column, base, &mut rising);
            }
        }
        rising
    }

    /// Iterates all light; returns the columns that have not converged after many orders.
    fn iterate(&self, rising: &mut Matrix, floor: &mut [f64]) -> Vec<usize> {
        let mut open: Vec<usize> = (0..rising.columns()).collect();
        let mut before = vec![f64::INFINITY; rising.columns()];
        let mut next = self.arrives.clone();
        for _ in 0..ITERATIONS {
            open.clear();
            for (c, old) in rising.columns_mut() {
                let (change, size) = reflect(old, next.column(c), self.gain.column(c));
                let size = size.max(floor[c]);
                // Changes decrease geometrically: the remainder is their sum.
                let ratio = (change / before[c]).min(1.0);
                if change > self.tolerance * size * (1.0 - ratio) {
                    open.push(c);
                }
                (before[c], floor[c]) = (change, size);
            }
            if open.is_empty() {
                break;
            }
            next.copy_from(&self.arrives);
            self.layers.below.add(rising, &mut next, self.reversed);
        }
        open
    }

    /// Solves a column directly, given the reflection of light from below as one kernel.
    fn solve(&self, below: &Matrix, column: usize, base: &Matrix, rising: &mut Matrix) {
        let n = self.layers.carried;
        // 1 - B G acts on the light that rises.
        let b: Vec<f64> = (0..n).map(|i| base[(i, column)]).collect();
        let kernel = Matrix::from_fn(n, n, |i, j| -b[i] * below[(i, j)]);
        let straight = (0..n).map(|i| 1.0 - b[i] * self.layers.below_straight[i]).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel.into()) };
        let mut right = Matrix::from_fn(n, 1, |i, _| b[i] * self.arrives[(i, column)]);
        closed.weighted_block().factors().solve(&mut right);
        rising.column_mut(column).copy_from_slice(right.column(0));
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

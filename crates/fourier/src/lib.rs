//! Fourier and cosine transforms of planes: periodic cells, and pictures that continue as their mirror image.
//!
//! Nothing public here is generic, so that the transforms, which are large, are compiled in this crate alone.

mod mirrored;
mod states;
mod threads;

use std::sync::Arc;

pub use mirrored::{Separable, filtered};
use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};
pub use states::{KernelShapes, StatePicture, smooth};

/// Discrete Fourier transform of rows of cells: rows from the bottom, columns from the left.
pub struct Plane {
    count: [usize; 2],
    along: [[Arc<dyn Fft<f64>>; 2]; 2],
}

impl Plane {
    /// Prepares the transform of this number of columns and rows, both at least 1.
    pub fn new(count: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = count.map(|count| [planner.plan_fft_forward(count), planner.plan_fft_inverse(count)]);
        Self { count, along }
    }

    /// Returns `sum of value exp(-2 pi i f.x)` for each bin; columns vary slowest (transposed).
    pub fn forward(&self, mut cells: Vec<Complex64>) -> Vec<Complex64> {
        self.along[0][0].process(&mut cells);
        let mut spectrum = transposed(&cells, self.count[0]);
        self.along[1][0].process(&mut spectrum);
        spectrum
    }

    /// Returns `sum of bin exp(2 pi i f.x)` for each cell, for bins whose columns vary slowest. The sum is
    /// not divided by the number of cells.
    pub fn inverse(&self, mut spectrum: Vec<Complex64>) -> Vec<Complex64> {
        self.along[1][1].process(&mut spectrum);
        let mut cells = transposed(&spectrum, self.count[1]);
        self.along[0][1].process(&mut cells);
        cells
    }
}

/// Fourier series of a function of the azimuth: from its orders to its values at equal steps, and back.
pub struct Circle {
    to_orders: Arc<dyn Fft<f64>>,
    to_values: Arc<dyn Fft<f64>>,
    scratch: Vec<Complex64>,
}

impl Circle {
    /// Prepares the series with this number of steps.
    pub fn new(steps: usize) -> Self {
        let mut planner = FftPlanner::new();
        let (to_orders, to_values) = (planner.plan_fft_forward(steps), planner.plan_fft_inverse(steps));
        let length = to_orders.get_inplace_scratch_len().max(to_values.get_inplace_scratch_len());
        Self { to_orders, to_values, scratch: vec![Complex64::ZERO; length] }
    }

    /// Replaces orders, of which the negative ones are counted back from the end, by values.
    pub fn values(&mut self, orders: &mut [Complex64]) {
        self.to_values.process_with_scratch(orders, &mut self.scratch);
    }

    /// Replaces values by orders times the number of steps.
    pub fn orders(&mut self, values: &mut [Complex64]) {
        self.to_orders.process_with_scratch(values, &mut self.scratch);
    }
}

/// Exchanges rows and columns, in blocks that fit into the cache.
fn transposed<T: Copy + Default>(values: &[T], columns: usize) -> Vec<T> {
    const BLOCK: usize = 32;
    let rows = values.len() / columns;
    let mut result = vec![T::default(); values.len()];
    for top in (0..rows).step_by(BLOCK) {
        for left in (0..columns).step_by(BLOCK) {
            for row in top..rows.min(top + BLOCK) {
                for column in left..columns.min(left + BLOCK) {
                    result[column * rows + row] = values[row * columns + column];
                }
            }
        }
    }
    result
}

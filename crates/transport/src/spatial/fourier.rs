//! Discrete Fourier transforms of periodic cells.

use std::sync::Arc;

use rustfft::num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// Transform of rows of cells: rows from the bottom, columns from the left.
pub(super) struct Plane {
    count: [usize; 2],
    along: [[Arc<dyn Fft<f64>>; 2]; 2],
}

impl Plane {
    /// Prepares the transform of this number of columns and rows.
    pub(super) fn new(count: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = count.map(|count| [planner.plan_fft_forward(count), planner.plan_fft_inverse(count)]);
        Self { count, along }
    }

    /// Returns `sum of value exp(-2 pi i f.x)` for each bin; columns vary slowest (transposed).
    pub(super) fn forward(&self, mut cells: Vec<Complex64>) -> Vec<Complex64> {
        self.along[0][0].process(&mut cells);
        let mut spectrum = transposed(&cells, self.count[0]);
        self.along[1][0].process(&mut spectrum);
        spectrum
    }

    /// Returns `sum of bin exp(2 pi i f.x)` for each cell, for bins whose columns vary slowest. The sum is not divided by the
    /// number of cells.
    pub(super) fn inverse(&self, mut spectrum: Vec<Complex64>) -> Vec<Complex64> {
        self.along[1][1].process(&mut spectrum);
        let mut cells = transposed(&spectrum, self.count[1]);
        self.along[0][1].process(&mut cells);
        cells
    }
}

fn transposed(values: &[Complex64], columns: usize) -> Vec<Complex64> {
    let rows = values.len() / columns;
    (0..columns).flat_map(|column| (0..rows).map(move |row| values[row * columns + column])).collect()
}

//! Fourier and cosine transforms of planes: periodic cells, and pictures that continue as their mirror image.
//!
//! Nothing public here is generic, so that the transforms, which are large, are compiled in this crate alone.

mod states;

use std::sync::Arc;

use num_complex::Complex64;
use rustdct::{DctPlanner, TransformType2And3};
use rustfft::{Fft, FftPlanner};
pub use states::{KernelShapes, StatePicture};

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

    /// Returns `sum of bin exp(2 pi i f.x)` for each cell, for bins whose columns vary slowest. The sum is not divided by the
    /// number of cells.
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

/// Multiplies the spatial spectrum of a plane by a real transfer function of the frequencies along x and y, cycles per
/// pixel (0 to 0.5). Beyond its borders the plane continues as its mirror image.
///
/// The cosine transform of type II is the spectrum of such a plane, so that nothing wraps around.
pub fn transferred(plane: &[f64], columns: usize, transfer: &dyn Fn(f64, f64) -> f64) -> Vec<f64> {
    let rows = plane.len() / columns;
    let mut planner = DctPlanner::new();
    let (along_x, along_y) = (planner.plan_dct2(columns), planner.plan_dct2(rows));
    let mut spectrum = plane.to_vec();
    each_row(&mut spectrum, columns, &along_x, Direction::Forward);
    let mut spectrum = transposed(&spectrum, columns);
    each_row(&mut spectrum, rows, &along_y, Direction::Forward);
    // Each transform and its inverse together multiply by half of the length.
    let scale = 4.0 / (columns * rows) as f64;
    for (column, values) in spectrum.chunks_exact_mut(rows).enumerate() {
        let x = column as f64 / (2 * columns) as f64;
        for (row, value) in values.iter_mut().enumerate() {
            *value *= scale * transfer(x, row as f64 / (2 * rows) as f64);
        }
    }
    each_row(&mut spectrum, rows, &along_y, Direction::Back);
    let mut plane = transposed(&spectrum, rows);
    each_row(&mut plane, columns, &along_x, Direction::Back);
    plane
}

enum Direction {
    Forward,
    Back,
}

fn each_row(
    plane: &mut [f64],
    columns: usize,
    plan: &Arc<dyn TransformType2And3<f64>>,
    direction: Direction,
) {
    let mut scratch = vec![0.0; plan.get_scratch_len()];
    for row in plane.chunks_exact_mut(columns) {
        match direction {
            Direction::Forward => plan.process_dct2_with_scratch(row, &mut scratch),
            Direction::Back => plan.process_dct3_with_scratch(row, &mut scratch),
        }
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

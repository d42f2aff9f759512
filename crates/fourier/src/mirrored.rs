//! Filters of pictures that continue as their mirror image beyond their borders.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;
use rustfft::{Fft, FftPlanner};

/// One term of a transfer function: the product of a function of the frequency along x and one of that along
/// y.
pub struct Separable {
    /// Its values at the frequencies of the columns: cycles per pixel of column k are k / (2 columns).
    pub along_x: Vec<f64>,
    /// Its values at the frequencies of the rows.
    pub along_y: Vec<f64>,
}

/// Multiplies the spatial spectra of two planes with rows of `columns` each by a real transfer function, the
/// sum of its terms. Beyond its borders a plane continues as its mirror image.
///
/// The cosine transform of type II is the spectrum of such a plane, so that nothing wraps around. Both planes
/// are the real and the imaginary part of one complex transform. An empty second plane is not filtered.
pub fn filtered([one, other]: [&mut [f64]; 2], columns: usize, transfers: [&[Separable]; 2]) {
    let rows = one.len() / columns;
    let mut planner = FftPlanner::new();
    let mut along_x = Cosines::new(columns, &mut planner);
    let mut along_y = Cosines::new(rows, &mut planner);
    let mut plane: Vec<Complex64> = match other.len() {
        0 => one.iter().map(|value| Complex64::new(*value, 0.0)).collect(),
        _ => one.iter().zip(&*other).map(|(one, other)| Complex64::new(*one, *other)).collect(),
    };
    for row in plane.chunks_exact_mut(columns) {
        along_x.forward(row);
    }
    // Blocks of columns that fit into the cache.
    const BLOCK: usize = 8;
    let mut block = vec![Complex64::ZERO; BLOCK * rows];
    let mut factors = vec![[0.0; 2]; rows];
    for left in (0..columns).step_by(BLOCK) {
        let width = BLOCK.min(columns - left);
        for (row, values) in plane.chunks_exact(columns).enumerate() {
            for (column, value) in values[left..left + width].iter().enumerate() {
                block[column * rows + row] = *value;
            }
        }
        for (column, values) in block.chunks_exact_mut(rows).take(width).enumerate() {
            along_y.forward(values);
            for (k, transfer) in transfers.iter().enumerate() {
                factors.iter_mut().for_each(|factor| factor[k] = 0.0);
                for term in *transfer {
                    let x = term.along_x[left + column];
                    factors.iter_mut().zip(&term.along_y).for_each(|(factor, y)| factor[k] += x * y);
                }
            }
            for (value, [re, im]) in values.iter_mut().zip(&factors) {
                *value = Complex64::new(re * value.re, im * value.im);
            }
            along_y.back(values);
        }
        for (row, values) in plane.chunks_exact_mut(columns).enumerate() {
            for (column, value) in values[left..left + width].iter_mut().enumerate() {
                *value = block[column * rows + row];
            }
        }
    }
    for row in plane.chunks_exact_mut(columns) {
        along_x.back(row);
    }
    one.iter_mut().zip(&plane).for_each(|(one, value)| *one = value.re);
    other.iter_mut().zip(&plane).for_each(|(other, value)| *other = value.im);
}

/// Cosine transform of type II of complex values, and its inverse, by a Fourier transform of the same length:
/// Makhoul, *A fast cosine transform in one and two dimensions*, IEEE Trans. ASSP 28, 27 (1980).
struct Cosines {
    forward: Arc<dyn Fft<f64>>,
    back: Arc<dyn Fft<f64>>,
    /// `exp(-i pi k / (2 length))`.
    turns: Vec<Complex64>,
    /// The values in another order.
    ordered: Vec<Complex64>,
    scratch: Vec<Complex64>,
}

impl Cosines {
    fn new(length: usize, planner: &mut FftPlanner<f64>) -> Self {
        let (forward, back) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
        let scratch = forward.get_inplace_scratch_len().max(back.get_inplace_scratch_len());
        let turn = |k: usize| Complex64::cis(-PI * k as f64 / (2 * length) as f64);
        Self {
            forward,
            back,
            turns: (0..length).map(turn).collect(),
            ordered: vec![Complex64::ZERO; length],
            scratch: vec![Complex64::ZERO; scratch],
        }
    }

    /// Replaces values by their spectrum.
    fn forward(&mut self, values: &mut [Complex64]) {
        let length = values.len();
        // Even ones upwards, then odd ones downwards.
        let (even, odd) = self.ordered.split_at_mut(length.div_ceil(2));
        even.iter_mut().zip(values.iter().step_by(2)).for_each(|(to, value)| *to = *value);
        odd.iter_mut().rev().zip(values.iter().skip(1).step_by(2)).for_each(|(to, value)| *to = *value);
        self.forward.process_with_scratch(&mut self.ordered, &mut self.scratch);
        values[0] = self.ordered[0];
        let pairs = self.ordered[1..].iter().zip(self.ordered[1..].iter().rev());
        for ((value, turn), (one, other)) in values[1..].iter_mut().zip(&self.turns[1..]).zip(pairs) {
            *value = 0.5 * (turn * one + turn.conj() * other);
        }
    }

    /// Replaces a spectrum by its values.
    fn back(&mut self, spectrum: &mut [Complex64]) {
        let length = spectrum.len();
        let scale = 1.0 / length as f64;
        self.ordered[0] = scale * spectrum[0];
        let pairs = spectrum[1..].iter().zip(spectrum[1..].iter().rev());
        for ((value, turn), (one, other)) in self.ordered[1..].iter_mut().zip(&self.turns[1..]).zip(pairs) {
            // one - i other
            let sum = Complex64::new(one.re + other.im, one.im - other.re);
            *value = scale * turn.conj() * sum;
        }
        self.back.process_with_scratch(&mut self.ordered, &mut self.scratch);
        let (even, odd) = self.ordered.split_at(length.div_ceil(2));
        spectrum.iter_mut().step_by(2).zip(even).for_each(|(value, from)| *value = *from);
        spectrum.iter_mut().skip(1).step_by(2).zip(odd.iter().rev()).for_each(|(value, from)| *value = *from);
    }
}

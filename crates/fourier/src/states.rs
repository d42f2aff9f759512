//! Convolution of a picture of states with a kernel for each state.
//!
//! **What.** Each pixel of a picture is in one of a few states. What is seen of a pixel in a quantity q is a sum over the pixels about it,
//! `seen_q(x) = sum over offsets o of kernel_(q, s(x + o))(o)`. Kernels are given as mixtures of a few shapes, `kernel_(q, s)(o) =
//! sum_r mixture_(q, s, r) shape_r(o)`. Spectra of the coverages belong to the picture, spectra of the shapes to the geometry of light and
//! view, and the mixtures to the colours; each is kept while only the others change.
//!
//! **Borders.** The plane is periodic. A margin of pixels that are in no state, as wide as the reach of the kernels, keeps opposite borders
//! apart.

use std::sync::Arc;

use num_complex::{Complex32, Complex64};
use rustfft::{Fft, FftPlanner};

use super::transposed;

/// Spectra of real planes of one size, two in one complex spectrum, in single precision; columns vary slowest.
struct Transform {
    count: [usize; 2],
    along: [[Arc<dyn Fft<f32>>; 2]; 2],
}

impl Transform {
    fn new(count: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = count.map(|count| [planner.plan_fft_forward(count), planner.plan_fft_inverse(count)]);
        Self { count, along }
    }

    fn forward(&self, mut cells: Vec<Complex32>) -> Vec<Complex32> {
        self.along[0][0].process(&mut cells);
        let mut spectrum = transposed(&cells, self.count[0]);
        self.along[1][0].process(&mut spectrum);
        spectrum
    }

    fn inverse(&self, mut spectrum: Vec<Complex32>) -> Vec<Complex32> {
        self.along[1][1].process(&mut spectrum);
        let mut cells = transposed(&spectrum, self.count[1]);
        self.along[0][1].process(&mut cells);
        cells
    }
}

/// The coverages of a picture's states in the domain of spatial frequencies.
pub struct StatePicture {
    transform: Transform,
    /// Number of columns and rows of the picture.
    picture: [usize; 2],
    states: usize,
    /// Pairs of states.
    pairs: Vec<Vec<Complex32>>,
}

/// Shapes of kernels in the domain of spatial frequencies, for pictures of one size.
pub struct KernelShapes {
    count: usize,
    /// Pairs of shapes.
    pairs: Vec<Vec<Complex32>>,
}

impl StatePicture {
    /// Transforms a picture of `states` states with rows of `columns`, from the top; `margin` is the number of columns and rows without a
    /// state between its repetitions.
    pub fn new(picture: &[u8], columns: usize, states: usize, margin: [usize; 2]) -> Self {
        let size = [columns, picture.len() / columns];
        let count = [0, 1].map(|k| if margin[k] == 0 { size[k] } else { smooth(size[k] + margin[k]) });
        let transform = Transform::new(count);
        let pairs = (0..states).step_by(2).map(|first| {
            let mut plane = vec![Complex32::ZERO; count[0] * count[1]];
            for (line, row) in plane.chunks_exact_mut(count[0]).zip(picture.chunks_exact(columns)) {
                for (value, state) in line.iter_mut().zip(row) {
                    let state = usize::from(*state);
                    *value = match state.wrapping_sub(first) {
                        0 => Complex32::new(1.0, 0.0),
                        1 => Complex32::new(0.0, 1.0),
                        _ => Complex32::ZERO,
                    };
                }
            }
            transform.forward(plane)
        });
        let pairs = pairs.collect();
        Self { transform, picture: size, states, pairs }
    }

    /// Number of columns and rows of the plane, with its margin.
    pub fn plane(&self) -> [usize; 2] {
        self.transform.count
    }

    /// Transforms shapes of kernels. `add` is called for each shape with a function that adds light of the pixel at an offset (to the right,
    /// upwards) from the one that is seen.
    pub fn shapes(&self, count: usize, add: impl Fn(usize, &mut dyn FnMut([i64; 2], f64))) -> KernelShapes {
        let [columns, rows] = self.transform.count;
        // Kernels are correlated with the picture: they are stored reversed; rows are counted from the top.
        let at = |[x, y]: [i64; 2]| {
            let column = (-x).rem_euclid(columns as i64) as usize;
            y.rem_euclid(rows as i64) as usize * columns + column
        };
        let pairs = (0..count).step_by(2).map(|first| {
            let mut plane = vec![Complex64::ZERO; columns * rows];
            add(first, &mut |offset, light| plane[at(offset)].re += light);
            if first + 1 < count {
                add(first + 1, &mut |offset, light| plane[at(offset)].im += light);
            }
            let plane = plane.into_iter().map(|value| Complex32::new(value.re as f32, value.im as f32));
            self.transform.forward(plane.collect())
        });
        KernelShapes { count, pairs: pairs.collect() }
    }

    /// Computes quantities of each pixel of the picture, two planes at once; `mixture` has the weight of each shape in the kernel of
    /// each state, `[quantity][state][shape]`.
    pub fn seen(&self, shapes: &KernelShapes, mixture: &[f64]) -> Vec<Vec<f32>> {
        let (states, count) = (self.states, shapes.count);
        let [columns, rows] = self.transform.count;
        let scale = 1.0 / (columns * rows) as f64;
        let mut all = Vec::new();
        for pair in mixture.chunks(2 * states * count) {
            let quantities: Vec<&[f64]> = pair.chunks_exact(states * count).collect();
            let mixture: Vec<Vec<f32>> = quantities
                .iter()
                .map(|one| one.iter().map(|value| (value * scale) as f32).collect())
                .collect();
            let mut spectrum = vec![Complex32::ZERO; columns * rows];
            let (mut covered, mut shape) = (vec![Complex32::ZERO; states], vec![Complex32::ZERO; count]);
            for column in 0..=columns / 2 {
                for row in 0..rows {
                    let here = column * rows + row;
                    let there = (columns - column) % columns * rows + (rows - row) % rows;
                    unpacked(&self.pairs, [here, there], &mut covered);
                    unpacked(&shapes.pairs, [here, there], &mut shape);
                    let sum = |mixture: &Vec<f32>| {
                        let kernels = mixture.chunks_exact(count).map(|weights| {
                            let terms = weights.iter().zip(&shape).map(|(weight, shape)| shape * *weight);
                            terms.sum::<Complex32>()
                        });
                        kernels.zip(&covered).map(|(kernel, covered)| kernel * covered).sum::<Complex32>()
                    };
                    let first = sum(&mixture[0]);
                    let second = mixture.get(1).map_or(Complex32::ZERO, sum);
                    spectrum[here] = first + Complex32::I * second;
                    spectrum[there] = first.conj() + Complex32::I * second.conj();
                }
            }
            let plane = self.transform.inverse(spectrum);
            let part = |of: fn(&Complex32) -> f32| {
                let lines = plane.chunks_exact(columns).take(self.picture[1]);
                lines.flat_map(|line| line[..self.picture[0]].iter().map(of)).collect::<Vec<f32>>()
            };
            all.push(part(|value| value.re));
            if quantities.len() > 1 {
                all.push(part(|value| value.im));
            }
        }
        all
    }
}

/// Spectra at a frequency, from pairs of real planes there and at the opposite frequency.
fn unpacked(pairs: &[Vec<Complex32>], [here, there]: [usize; 2], values: &mut [Complex32]) {
    for (pair, values) in pairs.iter().zip(values.chunks_mut(2)) {
        let (one, other) = (pair[here], pair[there].conj());
        values[0] = (one + other) * 0.5;
        if let Some(second) = values.get_mut(1) {
            *second = (one - other) * Complex32::new(0.0, -0.5);
        }
    }
}

/// Smallest number from `least` on without other prime factors than 2, 3, 5 and 7.
fn smooth(least: usize) -> usize {
    let is_smooth = |mut number: usize| {
        for factor in [2, 3, 5, 7] {
            while number.is_multiple_of(factor) {
                number /= factor;
            }
        }
        number == 1
    };
    (least.max(1)..).find(|number| is_smooth(*number)).unwrap_or(least)
}

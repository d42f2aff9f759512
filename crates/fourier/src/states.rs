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

use num_complex::Complex32;
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
        let mut scratch = vec![Complex32::ZERO; self.along[0][0].get_inplace_scratch_len()];
        for row in cells.chunks_exact_mut(self.count[0]) {
            // Most rows of a shape, and all of a margin, are empty.
            if row.iter().any(|value| *value != Complex32::ZERO) {
                self.along[0][0].process_with_scratch(row, &mut scratch);
            }
        }
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
            let mut plane = vec![Complex32::ZERO; columns * rows];
            add(first, &mut |offset, light| plane[at(offset)].re += light as f32);
            if first + 1 < count {
                add(first + 1, &mut |offset, light| plane[at(offset)].im += light as f32);
            }
            self.transform.forward(plane)
        });
        KernelShapes { count, pairs: pairs.collect() }
    }

    /// Computes quantities of each pixel of the picture; `mixture` has the weight of each shape in the kernel of each state,
    /// `[quantity][state][shape]`.
    pub fn seen(&self, shapes: &KernelShapes, mixture: &[f64]) -> Vec<Vec<f32>> {
        let [columns, rows] = self.transform.count;
        let scale = 1.0 / (columns * rows) as f64;
        let mixture: Vec<f32> = mixture.iter().map(|value| (value * scale) as f32).collect();
        let quantities = mixture.len() / (self.states * shapes.count).max(1);
        // Two real planes are one complex one.
        let mut spectra = vec![vec![Complex32::ZERO; columns * rows]; quantities.div_ceil(2)];
        pulp::Arch::new().dispatch(Products {
            picture: self,
            shapes,
            mixture: &mixture,
            spectra: &mut spectra,
        });
        let mut all = Vec::with_capacity(quantities);
        for (number, spectrum) in spectra.into_iter().enumerate() {
            let plane = self.transform.inverse(spectrum);
            let part = |of: fn(&Complex32) -> f32| {
                let lines = plane.chunks_exact(columns).take(self.picture[1]);
                lines.flat_map(|line| line[..self.picture[0]].iter().map(of)).collect::<Vec<f32>>()
            };
            all.push(part(|value| value.re));
            if 2 * number + 1 < quantities {
                all.push(part(|value| value.im));
            }
        }
        all
    }
}

/// Spectra of what is seen: sums over the states of coverage times kernel. Compiled for the vectors of each processor.
struct Products<'a> {
    picture: &'a StatePicture,
    shapes: &'a KernelShapes,
    /// Weights of shapes, `[quantity][state][shape]`.
    mixture: &'a [f32],
    /// Pairs of quantities.
    spectra: &'a mut [Vec<Complex32>],
}

/// Frequencies that are computed at once.
const BLOCK: usize = 128;

/// Values at the frequencies of a block.
#[derive(Clone)]
struct Values {
    re: [f32; BLOCK],
    im: [f32; BLOCK],
}

impl Values {
    const ZERO: Self = Self { re: [0.0; BLOCK], im: [0.0; BLOCK] };

    /// Adds the same values with a weight.
    #[inline(always)]
    fn add(&mut self, weight: f32, other: &Self) {
        self.re.iter_mut().zip(&other.re).for_each(|(sum, value)| *sum += weight * value);
        self.im.iter_mut().zip(&other.im).for_each(|(sum, value)| *sum += weight * value);
    }

    /// Adds products.
    #[inline(always)]
    fn add_product(&mut self, one: &Self, other: &Self) {
        for k in 0..BLOCK {
            self.re[k] += one.re[k] * other.re[k] - one.im[k] * other.im[k];
            self.im[k] += one.re[k] * other.im[k] + one.im[k] * other.re[k];
        }
    }
}

impl pulp::NullaryFnOnce for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { picture, shapes, mixture, spectra } = self;
        let [columns, rows] = picture.transform.count;
        let mut covered = vec![Values::ZERO; picture.states];
        let mut shape = vec![Values::ZERO; shapes.count];
        let mut sums = [Values::ZERO, Values::ZERO];
        // Real planes have opposite values at opposite frequencies: half of the columns are enough.
        for column in 0..=columns / 2 {
            let other = (columns - column) % columns * rows;
            for first in (0..rows).step_by(BLOCK) {
                let place =
                    Place { here: column * rows, there: other, rows, block: first..rows.min(first + BLOCK) };
                place.unpack(&picture.pairs, &mut covered);
                place.unpack(&shapes.pairs, &mut shape);
                let pairs = spectra.iter_mut().zip(mixture.chunks(2 * picture.states * shapes.count));
                for (spectrum, mixture) in pairs {
                    sums[1] = Values::ZERO;
                    for (sum, mixture) in
                        sums.iter_mut().zip(mixture.chunks_exact(picture.states * shapes.count))
                    {
                        *sum = Values::ZERO;
                        for (weights, covered) in mixture.chunks_exact(shapes.count).zip(&covered) {
                            let mut kernel = Values::ZERO;
                            weights.iter().zip(&shape).for_each(|(weight, shape)| kernel.add(*weight, shape));
                            sum.add_product(&kernel, covered);
                        }
                    }
                    place.pack(&sums, spectrum);
                }
            }
        }
    }
}

/// A block of frequencies in a column, and the opposite ones.
struct Place {
    /// First frequency of the column, and of the opposite one.
    here: usize,
    there: usize,
    rows: usize,
    block: std::ops::Range<usize>,
}

impl Place {
    /// Numbers of the frequencies of the block, and of the opposite ones.
    #[inline(always)]
    fn each(&self) -> impl Iterator<Item = (usize, usize)> {
        let opposite = |row: usize| if row == 0 { 0 } else { self.rows - row };
        self.block.clone().map(move |row| (self.here + row, self.there + opposite(row)))
    }

    /// Spectra of real planes from those of pairs.
    #[inline(always)]
    fn unpack(&self, pairs: &[Vec<Complex32>], values: &mut [Values]) {
        for (pair, values) in pairs.iter().zip(values.chunks_mut(2)) {
            let (even, odd) = values.split_at_mut(1);
            for (k, (here, there)) in self.each().enumerate() {
                let (one, other) = (pair[here], pair[there].conj());
                (even[0].re[k], even[0].im[k]) = (0.5 * (one.re + other.re), 0.5 * (one.im + other.im));
                if let Some(odd) = odd.first_mut() {
                    (odd.re[k], odd.im[k]) = (0.5 * (one.im - other.im), 0.5 * (other.re - one.re));
                }
            }
        }
    }

    /// Writes the spectra of two real planes into that of their pair.
    #[inline(always)]
    fn pack(&self, [first, second]: &[Values; 2], spectrum: &mut [Complex32]) {
        for (k, (here, there)) in self.each().enumerate() {
            spectrum[here] = Complex32::new(first.re[k] - second.im[k], first.im[k] + second.re[k]);
            spectrum[there] = Complex32::new(first.re[k] + second.im[k], second.re[k] - first.im[k]);
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

//! Convolution of a picture of states with a kernel for each state.
//!
//! **What.** Each pixel of a picture is in one of a few states. What is seen of a pixel in a quantity q is a sum over the pixels about it,
//! `seen_q(x) = sum over offsets o of kernel_(q, s(x + o))(o)`. Kernels are given as mixtures of a few shapes, `kernel_(q, s)(o) =
//! sum_r mixture_(q, s, r) shape_r(o)`. Spectra of the coverages belong to the picture, spectra of the shapes to the geometry of light and
//! view, and the mixtures to the colours; each is kept while only the others change.
//!
//! **Borders.** The plane is periodic. A margin of pixels that are in no state, as wide as the reach of the kernels, keeps opposite borders
//! apart.
//!
//! **Memory.** Two real planes are the real and the imaginary part of one complex plane. Columns are transformed in blocks that fit into the
//! cache, so that a plane is read and written once for each direction.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

/// Fourier transforms of real planes of one size, in single precision.
struct Transform {
    count: [usize; 2],
    along: [[Arc<dyn Fft<f32>>; 2]; 2],
}

/// Spectrum of a real plane: the first half of the columns, each with all rows. The others are complex conjugates.
struct Spectrum {
    re: Vec<f32>,
    im: Vec<f32>,
}

/// Columns that are transformed together: as many complex numbers as a line of the cache has.
const COLUMNS: usize = 8;

/// Columns and the opposite ones, each with all rows.
struct Columns {
    here: Vec<Complex32>,
    there: Vec<Complex32>,
    scratch: Vec<Complex32>,
}

impl Transform {
    fn new(count: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = count.map(|count| [planner.plan_fft_forward(count), planner.plan_fft_inverse(count)]);
        Self { count, along }
    }

    /// First columns of the blocks of a half, and their numbers.
    fn blocks(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let half = self.count[0] / 2 + 1;
        (0..half).step_by(COLUMNS).map(move |first| (first, COLUMNS.min(half - first)))
    }

    fn columns(&self) -> Columns {
        let rows = self.count[1];
        let scratch = self.along[1].iter().map(|along| along.get_inplace_scratch_len()).max().unwrap_or(0);
        let [here, there] = [(); 2].map(|()| vec![Complex32::ZERO; COLUMNS * rows]);
        Columns { here, there, scratch: vec![Complex32::ZERO; scratch] }
    }

    fn opposite(&self, column: usize) -> usize {
        if column == 0 { 0 } else { self.count[0] - column }
    }

    /// Spectra of the real and of the imaginary part of a plane of which some rows are given, by their numbers; all others are 0.
    fn forward(&self, numbers: &[usize], mut rows: Vec<Complex32>) -> [Spectrum; 2] {
        let [width, height] = self.count;
        self.along[0][0].process(&mut rows);
        let mut both = [(); 2].map(|()| Spectrum::zero((width / 2 + 1) * height));
        let mut columns = self.columns();
        for (first, count) in self.blocks() {
            if numbers.len() < height {
                columns.here.fill(Complex32::ZERO);
                columns.there.fill(Complex32::ZERO);
            }
            for (number, row) in numbers.iter().zip(rows.chunks_exact(width)) {
                for k in 0..count {
                    columns.here[k * height + number] = row[first + k];
                    columns.there[k * height + number] = row[self.opposite(first + k)];
                }
            }
            columns.transform(&*self.along[1][0], count * height);
            let [one, other] = both.each_mut().map(|one| one.columns_mut(first, count, height));
            let pairs = columns.here.chunks_exact(height).zip(columns.there.chunks_exact(height));
            for (((here, there), (re, im)), (other_re, other_im)) in pairs.zip(one).zip(other) {
                for row in 0..height {
                    let (here, there) = (here[row], there[if row == 0 { 0 } else { height - row }]);
                    (re[row], im[row]) = (0.5 * (here.re + there.re), 0.5 * (here.im - there.im));
                    (other_re[row], other_im[row]) = (0.5 * (here.im + there.im), 0.5 * (there.re - here.re));
                }
            }
        }
        both
    }

    /// Computes planes, `[row][column]`, from the spectra of their real and imaginary parts, which `spectra` writes for some of the frequencies
    /// of a half, those of the real part of each plane before those of the imaginary part.
    fn inverse(&self, planes: &mut [Vec<Complex32>], mut spectra: impl FnMut(Range<usize>, &mut [Spectrum])) {
        let [width, height] = self.count;
        let mut columns = self.columns();
        let mut parts: Vec<Spectrum> =
            planes.iter().flat_map(|_| [(); 2]).map(|()| Spectrum::zero(COLUMNS * height)).collect();
        for (first, count) in self.blocks() {
            spectra(first * height..(first + count) * height, &mut parts);
            for (plane, parts) in planes.iter_mut().zip(parts.as_chunks().0) {
                columns.pack(parts, height);
                columns.transform(&*self.along[1][1], count * height);
                for (number, row) in plane.chunks_exact_mut(width).enumerate() {
                    for k in 0..count {
                        row[self.opposite(first + k)] = columns.there[k * height + number];
                        row[first + k] = columns.here[k * height + number];
                    }
                }
            }
        }
        planes.iter_mut().for_each(|plane| self.along[0][1].process(plane));
    }
}

impl Columns {
    /// Transforms the first `length` numbers of both.
    fn transform(&mut self, along: &dyn Fft<f32>, length: usize) {
        for columns in [&mut self.here, &mut self.there] {
            along.process_with_scratch(&mut columns[..length], &mut self.scratch);
        }
    }

    /// Columns of a complex plane from those of its real and its imaginary part.
    fn pack(&mut self, [real, imaginary]: &[Spectrum; 2], height: usize) {
        let parts = [&real.re, &real.im, &imaginary.re, &imaginary.im].map(|part| part.chunks_exact(height));
        let [a, b, c, d] = parts;
        let columns = self.here.chunks_exact_mut(height).zip(self.there.chunks_exact_mut(height));
        for ((here, there), (((a, b), c), d)) in columns.zip(a.zip(b).zip(c).zip(d)) {
            for row in 0..height {
                here[row] = Complex32::new(a[row] - d[row], b[row] + c[row]);
                there[if row == 0 { 0 } else { height - row }] =
                    Complex32::new(a[row] + d[row], c[row] - b[row]);
            }
        }
    }
}

impl Spectrum {
    fn zero(length: usize) -> Self {
        Self { re: vec![0.0; length], im: vec![0.0; length] }
    }

    /// Real and imaginary parts of some columns.
    fn columns_mut(
        &mut self,
        first: usize,
        count: usize,
        height: usize,
    ) -> impl Iterator<Item = (&mut [f32], &mut [f32])> {
        let range = first * height..(first + count) * height;
        self.re[range.clone()].chunks_exact_mut(height).zip(self.im[range].chunks_exact_mut(height))
    }
}

/// The coverages of a picture's states in the domain of spatial frequencies.
pub struct StatePicture {
    transform: Transform,
    /// State of each pixel.
    picture: Vec<u8>,
    columns: usize,
    margin: [usize; 2],
    spectra: Vec<Spectrum>,
}

/// Shapes of kernels in the domain of spatial frequencies, for pictures of one size.
pub struct KernelShapes {
    spectra: Vec<Spectrum>,
}

impl fmt::Debug for StatePicture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = (self.columns, self.spectra.len(), self.margin);
        f.debug_struct("StatePicture").field("columns_states_margin", &of).finish_non_exhaustive()
    }
}

impl StatePicture {
    /// Transforms a picture of `states` states with rows of `columns`, from the top; `margin` is the number of columns and rows without a
    /// state between its repetitions.
    pub fn new(picture: &[u8], columns: usize, states: usize, margin: [usize; 2]) -> Self {
        let size = [columns, picture.len() / columns];
        let count = [0, 1].map(|k| if margin[k] == 0 { size[k] } else { smooth(size[k] + margin[k]) });
        let transform = Transform::new(count);
        let numbers: Vec<usize> = (0..size[1]).collect();
        let of_pair = |first: usize| {
            let mut rows = vec![Complex32::ZERO; count[0] * size[1]];
            for (line, row) in rows.chunks_exact_mut(count[0]).zip(picture.chunks_exact(columns)) {
                for (value, state) in line.iter_mut().zip(row) {
                    *value = match usize::from(*state).wrapping_sub(first) {
                        0 => Complex32::ONE,
                        1 => Complex32::I,
                        _ => Complex32::ZERO,
                    };
                }
            }
            transform.forward(&numbers, rows)
        };
        let spectra = (0..states).step_by(2).flat_map(of_pair).take(states).collect();
        Self { transform, picture: picture.to_vec(), columns, margin, spectra }
    }

    /// Whether [`new`](Self::new) with these arguments would give the same.
    pub fn is_of(&self, picture: &[u8], columns: usize, states: usize, margin: [usize; 2]) -> bool {
        let known = (self.columns, self.spectra.len(), self.margin);
        known == (columns, states, margin) && self.picture == picture
    }

    /// Number of columns and rows of the plane, with its margin.
    pub fn plane(&self) -> [usize; 2] {
        self.transform.count
    }

    /// Transforms shapes of kernels. `add` is called for each shape with a function that adds light of the pixel at an offset (to the right,
    /// upwards) from the one that is seen.
    pub fn shapes(&self, count: usize, add: impl Fn(usize, &mut dyn FnMut([i64; 2], f64))) -> KernelShapes {
        let [columns, rows] = self.transform.count;
        let of_pair = |first: usize| {
            // Row by row, because most rows are empty.
            let mut lines: Vec<Vec<Complex32>> = vec![Vec::new(); rows];
            for (shape, part) in [(first, Complex32::ONE), (first + 1, Complex32::I)] {
                if shape < count {
                    // Kernels are correlated with the picture: they are stored reversed; rows are counted from the top.
                    add(shape, &mut |[x, y], light| {
                        let line = &mut lines[y.rem_euclid(rows as i64) as usize];
                        if line.is_empty() {
                            line.resize(columns, Complex32::ZERO);
                        }
                        line[(-x).rem_euclid(columns as i64) as usize] += part * light as f32;
                    });
                }
            }
            let numbers: Vec<usize> = (0..rows).filter(|row| !lines[*row].is_empty()).collect();
            self.transform.forward(&numbers, lines.concat())
        };
        KernelShapes { spectra: (0..count).step_by(2).flat_map(of_pair).take(count).collect() }
    }

    /// Computes pictures of three quantities each. `mixture` has the weight of each shape in the kernel of each state,
    /// `[picture][quantity][state][shape]`; `everywhere` is added to all pixels of a picture.
    pub fn seen(
        &self,
        shapes: &KernelShapes,
        mixture: &[f64],
        everywhere: &[[f32; 3]],
    ) -> Vec<Vec<[f32; 3]>> {
        let [width, height] = self.transform.count;
        let (states, shapes) = (&self.spectra[..], &shapes.spectra[..]);
        let of_quantity = states.len() * shapes.len();
        let scale = 1.0 / (width * height) as f64;
        let mixture: Vec<f32> = mixture.iter().map(|value| (value * scale) as f32).collect();
        let quantities: Vec<&[f32]> =
            if of_quantity == 0 { Vec::new() } else { mixture.chunks_exact(of_quantity).collect() };
        let mut pictures: Vec<Vec<[f32; 3]>> =
            everywhere.iter().map(|same| vec![*same; self.picture.len()]).collect();
        let mut planes = vec![vec![Complex32::ZERO; width * height]; quantities.len().div_ceil(2)];
        self.transform.inverse(&mut planes, |frequencies, spectra| {
            let mixtures = &quantities;
            pulp::Arch::new().dispatch(Products { states, shapes, mixtures, frequencies, spectra });
        });
        for quantity in 0..quantities.len() {
            let Some(picture) = pictures.get_mut(quantity / 3) else { break };
            let rows = planes[quantity / 2].chunks_exact(width);
            for (line, row) in picture.chunks_exact_mut(self.columns).zip(rows) {
                for (pixel, value) in line.iter_mut().zip(row) {
                    pixel[quantity % 3] += if quantity % 2 == 0 { value.re } else { value.im };
                }
            }
        }
        pictures
    }
}

/// Spectra of what is seen of some quantities, at some frequencies: for each state the mixture of the shapes, times the coverage. Compiled for
/// the vectors of each processor.
struct Products<'a> {
    states: &'a [Spectrum],
    shapes: &'a [Spectrum],
    /// Weights of shapes for each quantity, `[state][shape]`.
    mixtures: &'a [&'a [f32]],
    frequencies: Range<usize>,
    spectra: &'a mut [Spectrum],
}

/// Frequencies that are computed at once, in the registers of a processor: four vectors of the widest.
const BLOCK: usize = 64;

/// Real and imaginary parts at the frequencies of a block.
type Block = [[f32; BLOCK]; 2];

impl pulp::NullaryFnOnce for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { states, shapes, mixtures, frequencies, spectra } = self;
        // Spectra begin at the same places of pages of memory, so that they would displace each other in the cache: blocks are copied.
        let mut covered: Vec<Block> = vec![[[0.0; BLOCK]; 2]; states.len()];
        let mut shape = vec![[[0.0; BLOCK]; 2]; shapes.len()];
        for first in frequencies.clone().step_by(BLOCK) {
            let count = BLOCK.min(frequencies.end - first);
            let blocks = covered.iter_mut().chain(&mut shape);
            for ([re, im], from) in blocks.zip(states.iter().chain(shapes)) {
                re[..count].copy_from_slice(&from.re[first..][..count]);
                im[..count].copy_from_slice(&from.im[first..][..count]);
            }
            let into = first - frequencies.start;
            for (spectrum, mixture) in spectra.iter_mut().zip(mixtures) {
                let [re, im] = product(&covered, &shape, mixture);
                spectrum.re[into..][..count].copy_from_slice(&re[..count]);
                spectrum.im[into..][..count].copy_from_slice(&im[..count]);
            }
        }
    }
}

/// The sum over the states of coverage times mixture of shapes.
#[inline(always)]
fn product(covered: &[Block], shapes: &[Block], mixture: &[f32]) -> Block {
    let mut sum = [[0.0; BLOCK]; 2];
    for (covered, weights) in covered.iter().zip(mixture.chunks_exact(shapes.len())) {
        let mut kernel = [[0.0; BLOCK]; 2];
        for (shape, weight) in shapes.iter().zip(weights) {
            for k in 0..BLOCK {
                kernel[0][k] += weight * shape[0][k];
                kernel[1][k] += weight * shape[1][k];
            }
        }
        for k in 0..BLOCK {
            sum[0][k] += kernel[0][k] * covered[0][k] - kernel[1][k] * covered[1][k];
            sum[1][k] += kernel[0][k] * covered[1][k] + kernel[1][k] * covered[0][k];
        }
    }
    sum
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

//! Convolution of a picture of states with a kernel for each state.
//!
//! **What.** Each pixel of a picture is in one of a few states. What is seen of a pixel in a quantity q is a
//! sum over the pixels about it, `seen_q(x) = sum over offsets o of kernel_(q, s(x + o))(o)`. Kernels are
//! given as mixtures of a few shapes, `kernel_(q, s)(o) = sum_r mixture_(q, s, r) shape_r(o)`. Spectra of the
//! coverages belong to the picture, spectra of the shapes to the geometry of light and view, and the mixtures
//! to the colours; each is kept while only the others change.
//!
//! **Borders.** The plane is periodic. A margin of pixels that are in no state, as wide as the reach of the
//! kernels, keeps opposite borders apart.
//!
//! **Memory.** Two real planes are the real and the imaginary part of one complex plane. Columns are
//! transformed in blocks that fit into the cache, so that a plane is read and written once for each
//! direction.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use num_complex::Complex32;
use rustfft::{Fft, FftPlanner};

use crate::threads::{each, ranges};

/// Fourier transforms of real planes of one size, in single precision.
struct Transform {
    count: [usize; 2],
    along: [[Arc<dyn Fft<f32>>; 2]; 2],
}

/// Spectrum of a real plane: the first half of the columns, each with all rows. The others are complex
/// conjugates.
struct Spectrum {
    re: Vec<f32>,
    im: Vec<f32>,
}

/// Columns that are transformed together: as many complex numbers as a line of the cache has.
const COLUMNS: usize = 8;

/// Rows that are transformed together.
const ROWS: usize = 32;

impl Transform {
    fn new(count: [usize; 2]) -> Self {
        let mut planner = FftPlanner::new();
        let along = count.map(|count| [planner.plan_fft_forward(count), planner.plan_fft_inverse(count)]);
        Self { count, along }
    }

    /// First columns of the blocks among columns of a half, and their numbers.
    fn blocks(columns: &Range<usize>) -> impl Iterator<Item = (usize, usize)> + use<> {
        let end = columns.end;
        columns.clone().step_by(COLUMNS).map(move |first| (first, COLUMNS.min(end - first)))
    }

    /// Number of columns of a half.
    fn half(&self) -> usize {
        self.count[0] / 2 + 1
    }

    fn opposite(&self, column: usize) -> usize {
        if column == 0 { 0 } else { self.count[0] - column }
    }

    /// Spectra of the real and of the imaginary part of a plane of which some rows are given, by their
    /// numbers; all others are 0.
    fn forward(&self, numbers: &[usize], mut rows: Vec<Complex32>) -> [Spectrum; 2] {
        let [width, height] = self.count;
        self.along[0][0].process(&mut rows);
        let mut both = [(); 2].map(|()| Spectrum::zero((width / 2 + 1) * height));
        let mut scratch = vec![Complex32::ZERO; self.along[1][0].get_inplace_scratch_len()];
        let mut columns = [(); 2].map(|()| vec![Complex32::ZERO; COLUMNS * height]);
        for (first, count) in Self::blocks(&(0..self.half())) {
            if numbers.len() < height {
                columns.iter_mut().for_each(|columns| columns.fill(Complex32::ZERO));
            }
            for (number, row) in numbers.iter().zip(rows.chunks_exact(width)) {
                for k in 0..count {
                    columns[0][k * height + number] = row[first + k];
                    columns[1][k * height + number] = row[self.opposite(first + k)];
                }
            }
            for columns in &mut columns {
                self.along[1][0].process_with_scratch(&mut columns[..count * height], &mut scratch);
            }
            let [one, other] = both.each_mut().map(|one| one.columns_mut(first, count, height));
            let pairs = columns[0].chunks_exact(height).zip(columns[1].chunks_exact(height));
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

    /// Transforms the columns of planes, `[column][row]`, from the spectra of their real and imaginary parts,
    /// which `spectra` writes for some of the frequencies of a half, those of the real part of each plane
    /// before those of the imaginary part.
    fn columns_back(
        &self,
        planes: &mut [Vec<Complex32>],
        threads: usize,
        spectra: impl Fn(Range<usize>, &mut [Spectrum]) + Sync,
    ) {
        let [width, height] = self.count;
        let half = self.half();
        let ranges = ranges(half, COLUMNS, threads);
        // Each thread has columns of the half and those opposite to them, of each plane.
        let mut parts: Vec<Vec<ColumnsOfPlane<'_>>> = ranges.iter().map(|_| Vec::new()).collect();
        for plane in planes {
            let (mut low, mut high) = plane.split_at_mut(half * height);
            for (part, range) in parts.iter_mut().zip(&ranges) {
                let first_opposite = width.saturating_sub(range.end - 1).max(half) - half;
                let (here, rest) = std::mem::take(&mut low).split_at_mut(range.len() * height);
                low = rest;
                let there;
                (high, there) = std::mem::take(&mut high).split_at_mut(first_opposite * height);
                part.push(ColumnsOfPlane { here, there, first_opposite });
            }
        }
        let items = ranges.into_iter().zip(parts).collect();
        each(items, |(columns, mut planes)| self.columns_back_of(&columns, &mut planes, &spectra));
    }

    /// Transforms some columns of a half, and those opposite to them.
    fn columns_back_of(
        &self,
        columns: &Range<usize>,
        planes: &mut [ColumnsOfPlane<'_>],
        spectra: &impl Fn(Range<usize>, &mut [Spectrum]),
    ) {
        let height = self.count[1];
        let along = &self.along[1][1];
        let mut scratch = vec![Complex32::ZERO; along.get_inplace_scratch_len()];
        let mut parts: Vec<Spectrum> =
            planes.iter().flat_map(|_| [(); 2]).map(|()| Spectrum::zero(COLUMNS * height)).collect();
        for (first, count) in Self::blocks(columns) {
            spectra(first * height..(first + count) * height, &mut parts);
            for (plane, [real, imaginary]) in planes.iter_mut().zip(parts.as_chunks().0) {
                for k in 0..count {
                    let all = [&real.re, &real.im, &imaginary.re, &imaginary.im];
                    let [a, b, c, d] = all.map(|part| &part[k * height..][..height]);
                    let here = &mut plane.here[(first - columns.start + k) * height..][..height];
                    for row in 0..height {
                        here[row] = Complex32::new(a[row] - d[row], b[row] + c[row]);
                    }
                    along.process_with_scratch(here, &mut scratch);
                    // The first column, and the middle one of an even number, are opposite to themselves.
                    let Some(opposite) = self.opposite(first + k).checked_sub(self.half()) else {
                        continue;
                    };
                    let there = &mut plane.there[(opposite - plane.first_opposite) * height..][..height];
                    for row in 0..height {
                        there[if row == 0 { 0 } else { height - row }] =
                            Complex32::new(a[row] + d[row], c[row] - b[row]);
                    }
                    along.process_with_scratch(there, &mut scratch);
                }
            }
        }
    }

    /// Transforms some rows of planes whose columns are transformed, and calls `found` with each row: its
    /// number, and its values in all planes.
    fn rows_back(
        &self,
        planes: &[Vec<Complex32>],
        rows: Range<usize>,
        mut found: impl FnMut(usize, &[&[Complex32]]),
    ) {
        let [width, height] = self.count;
        let along = &self.along[0][1];
        let mut scratch = vec![Complex32::ZERO; along.get_inplace_scratch_len()];
        let mut lines = vec![vec![Complex32::ZERO; ROWS * width]; planes.len()];
        for first in rows.clone().step_by(ROWS) {
            let count = ROWS.min(rows.end - first);
            for (plane, lines) in planes.iter().zip(&mut lines) {
                for (number, column) in plane.chunks_exact(height).enumerate() {
                    for (k, value) in column[first..first + count].iter().enumerate() {
                        lines[k * width + number] = *value;
                    }
                }
                along.process_with_scratch(&mut lines[..count * width], &mut scratch);
            }
            for k in 0..count {
                let row: Vec<&[Complex32]> = lines.iter().map(|lines| &lines[k * width..][..width]).collect();
                found(first + k, &row);
            }
        }
    }
}

/// Columns of a half of a plane, and those opposite to them.
struct ColumnsOfPlane<'a> {
    here: &'a mut [Complex32],
    there: &'a mut [Complex32],
    /// Number of the first column of `there` in the other half.
    first_opposite: usize,
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
    /// Transforms a picture of `states` states with rows of `columns`, from the top; `margin` is the number
    /// of columns and rows without a state between its repetitions. `threads` is that of threads, here and
    /// below; the result does not depend on it.
    pub fn new(picture: &[u8], columns: usize, states: usize, margin: [usize; 2], threads: usize) -> Self {
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
        let spectra = in_pairs(states, threads, of_pair);
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

    /// Transforms shapes of kernels. `add` is called for each shape with a function that adds light of the
    /// pixel at an offset (to the right, upwards) from the one that is seen.
    pub fn shapes(
        &self,
        count: usize,
        threads: usize,
        add: impl Fn(usize, &mut dyn FnMut([i64; 2], f64)) + Sync,
    ) -> KernelShapes {
        let [columns, rows] = self.transform.count;
        let of_pair = |first: usize| {
            // Row by row, because most rows are empty.
            let mut lines: Vec<Vec<Complex32>> = vec![Vec::new(); rows];
            for (shape, part) in [(first, Complex32::ONE), (first + 1, Complex32::I)] {
                if shape < count {
                    // Kernels are correlated with the picture: they are stored reversed; rows are counted
                    // from the top.
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
        KernelShapes { spectra: in_pairs(count, threads, of_pair) }
    }

    /// Computes pictures of three quantities each, one after the other, and calls `found` with the number of
    /// each and its pixels. `mixtures` has the weight of each shape in the kernel of each state for each
    /// picture, `[quantity][state][shape]`; `everywhere` is added to all pixels of a picture.
    pub fn seen(
        &self,
        shapes: &KernelShapes,
        mixtures: &[Vec<f64>],
        everywhere: &[[f32; 3]],
        threads: usize,
        mut found: impl FnMut(usize, &mut Vec<[f32; 3]>),
    ) {
        let [width, height] = self.transform.count;
        let (states, shapes) = (&self.spectra[..], &shapes.spectra[..]);
        let scale = 1.0 / (width * height) as f64;
        let at_once = PICTURES.min(mixtures.len());
        let mut planes = vec![vec![Complex32::ZERO; width * height]; (3 * at_once).div_ceil(2)];
        let mut pictures = vec![Vec::new(); at_once];
        for (number, (mixtures, everywhere)) in
            mixtures.chunks(PICTURES).zip(everywhere.chunks(PICTURES)).enumerate()
        {
            let mixtures: Vec<f32> =
                mixtures.iter().flatten().map(|weight| (weight * scale) as f32).collect();
            let mixtures: Vec<&[f32]> = mixtures.chunks_exact((states.len() * shapes.len()).max(1)).collect();
            for (picture, same) in pictures.iter_mut().zip(everywhere) {
                picture.clear();
                picture.resize(self.picture.len(), *same);
            }
            let planes = &mut planes[..mixtures.len().div_ceil(2)];
            self.transform.columns_back(planes, threads, |frequencies, spectra| {
                let mixtures = &mixtures;
                pulp::Arch::new().dispatch(Products { states, shapes, mixtures, frequencies, spectra });
            });
            let mut rest: Vec<&mut [[f32; 3]]> = pictures.iter_mut().map(Vec::as_mut_slice).collect();
            let mut items = Vec::new();
            for rows in ranges(self.picture.len() / self.columns, ROWS, threads) {
                let mut of_rows = Vec::new();
                for rest in rest.iter_mut().take(everywhere.len()) {
                    let (mine, others) = std::mem::take(rest).split_at_mut(rows.len() * self.columns);
                    of_rows.push(mine);
                    *rest = others;
                }
                items.push((rows, of_rows));
            }
            each(items, |(rows, mut pictures)| {
                self.transform.rows_back(planes, rows.clone(), |row, values| {
                    for quantity in 0..mixtures.len() {
                        let first = (row - rows.start) * self.columns;
                        let pixels = &mut pictures[quantity / 3][first..][..self.columns];
                        let (values, k) = (values[quantity / 2], quantity % 3);
                        match quantity % 2 {
                            0 => {
                                pixels.iter_mut().zip(values).for_each(|(pixel, value)| pixel[k] += value.re)
                            }
                            _ => {
                                pixels.iter_mut().zip(values).for_each(|(pixel, value)| pixel[k] += value.im)
                            }
                        }
                    }
                });
            });
            for (more, picture) in pictures.iter_mut().enumerate().take(everywhere.len()) {
                found(PICTURES * number + more, picture);
            }
        }
    }
}

/// Spectra of which `of_pair` computes two at once, that of the even number and the next.
fn in_pairs(count: usize, threads: usize, of_pair: impl Fn(usize) -> [Spectrum; 2] + Sync) -> Vec<Spectrum> {
    let of_range = |range: Range<usize>| range.step_by(2).flat_map(&of_pair).collect::<Vec<Spectrum>>();
    each(ranges(count, 2, threads), of_range).into_iter().flatten().take(count).collect()
}

/// Pictures that are computed at once: two planes are transformed at once, and two pictures have three pairs.
const PICTURES: usize = 2;

/// Spectra of what is seen of some quantities, at some frequencies: for each state the mixture of the shapes,
/// times the coverage. Compiled for the vectors of each processor.
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
        // Spectra begin at the same places of pages of memory, so that they would displace each other in the
        // cache: blocks are copied.
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

/// Smallest number from `least` on without other prime factors than 2, 3, 5 and 7: transforms of so many cells are
/// quick.
pub fn smooth(least: usize) -> usize {
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

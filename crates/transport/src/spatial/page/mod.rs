//! Colours of a picture of Lambertian pixels under a face that returns light to them, through all orders.
//!
//! **What.** Pixel x is in a state s(x) with a reflectance at each wavelength. Its irradiance relative to
//! that of the light from outside is E = 1 + A * (rho E), as in [`Recycling`](super::Recycling), at every
//! wavelength; what is seen is a sum over wavelengths of light that is proportional to E.
//!
//! **How.** Three reductions, each with an error that [`Precision`] sets:
//! - E is smooth, because A(f) is small where f d is above 1: it is solved in cells of a fraction of the
//!   thickness, which hold the mean reflectance; the mean over a pixel is that of cubics through the cells.
//! - E depends on the wavelength only through the reflectances of the states. A few wavelengths represent
//!   all: those with which polynomials and fractions of the reflectances are interpolated best (pivoted
//!   Gram-Schmidt), at the light's weights.
//! - With `m` in the middle of the reflectances, `E = (1 - m A)^-1 * (1 + A * ((rho - m) E))` converges in
//!   few repetitions ([`Approach`]). Two wavelengths are real and imaginary part of one transform.
//!
//! Where light spreads inside the pixels ([`PixelSpread`]), the light inside on its way out,
//! `P * (sqrt(rho) E)`, takes the place of E in what is seen. It changes within a few of these lengths: the
//! cells are the pixels, or parts of them.
//!
//! **Limits.** The picture repeats at its borders. What returns light is the same at all wavelengths.
//!
//! **Source.** Clapper, Yule, J. Opt. Soc. Am. 43, 600 (1953), for both limits; Cheng, Gimbutas, Martinsson,
//! Rokhlin, SIAM J. Sci. Comput. 26, 1389 (2005), for rows that represent a matrix.

use num_complex::Complex64;
use papilio_fourier::Plane;

use super::{Cells, PixelSpread};

mod representatives;

use representatives::{Representatives, representatives};

/// A picture: the state of each pixel, rows from the bottom, columns from the left.
#[derive(Debug, Clone, Copy)]
pub struct Page<'a> {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// Width and height of a pixel, mm.
    pub pitch_mm: [f64; 2],
    /// State of each pixel.
    pub states: &'a [u8],
}

/// How exactly a picture is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Precision {
    /// Largest cell in thicknesses of the medium.
    pub cell: f64,
    /// Most cells across a pixel. Under a thinner medium light returns to its own place: cells then need not
    /// be smaller.
    pub most_per_pixel: usize,
    /// Largest error of the irradiance after the last repetition, relative to that of white.
    pub change: f64,
    /// Largest part of the light that the representative wavelengths miss.
    pub missed: f64,
}

impl Precision {
    /// For errors below about 1e-3 of a perfect white.
    pub const FAST: Self = Self { cell: 0.34, most_per_pixel: 4, change: 1e-3, missed: 3e-3 };
    /// For errors below about 1e-4.
    pub const FINE: Self = Self { cell: 0.1, most_per_pixel: 16, change: 1e-5, missed: 1e-6 };
}

/// Light of the wavelengths under one face.
#[derive(Debug, Clone, Copy)]
pub struct PageLight<'a> {
    /// Reflectance of each state, `[state][wavelength]`.
    pub reflectance: &'a [Vec<f64>],
    /// What is seen of each state for an irradiance of 1, in X, Y and Z: `[state][X, Y, Z][wavelength]`.
    pub seen: &'a [[Vec<f64>; 3]],
}

/// Irradiance of a picture at representative wavelengths.
#[derive(Debug, Clone)]
pub struct LitPage {
    cells: Cells,
    /// Whether pixels consist of whole cells, along x and y.
    whole: [bool; 2],
    /// Irradiance of each cell over that of the light from outside, one plane for each representative. Light
    /// inside the pixels instead, if it spreads there.
    irradiance: Vec<Vec<f32>>,
    found: Representatives,
    spreads: bool,
    left: f64,
}

impl LitPage {
    /// Solves the irradiance of a picture. `face` is the fraction that comes back of light that is modulated
    /// at a frequency (cycles per mm). States without reflectances are black.
    pub fn new(
        page: &Page<'_>,
        face: &dyn Fn(f64) -> f64,
        light: PageLight<'_>,
        precision: Precision,
        thickness_mm: f64,
    ) -> Self {
        Self::with_spread(None, page, (face, thickness_mm), light, precision)
    }

    /// Solves the irradiance of a picture of pixels inside which light spreads.
    pub fn with_spread(
        spread: Option<PixelSpread>,
        page: &Page<'_>,
        (face, thickness_mm): (&dyn Fn(f64) -> f64, f64),
        light: PageLight<'_>,
        precision: Precision,
    ) -> Self {
        let count = [0, 1].map(|k| {
            let wanted = (page.count[k] as f64 * page.pitch_mm[k] / (precision.cell * thickness_mm)).ceil();
            let most = page.count[k] * precision.most_per_pixel;
            if spread.is_some() {
                let largest = precision.cell * thickness_mm;
                let most = MOST_PARTS.min(precision.most_per_pixel as f64);
                return page.count[k] * (page.pitch_mm[k] / largest).ceil().clamp(1.0, most) as usize;
            }
            if wanted < most as f64 { smooth(wanted.max(1.0) as usize).min(most) } else { most }
        });
        let period_mm = [0, 1].map(|k| page.count[k] as f64 * page.pitch_mm[k]);
        let cells = Cells { count, period_mm };
        let coverage = coverage(page, count, light.reflectance.len());
        let found = representatives(light, face(0.0), precision.missed, spread.is_some());
        let kernel = Kernel::new(cells, face);
        let inside = spread.map(|spread| spread.between(cells.count, cells.period_mm));
        let mut irradiance = vec![Vec::new(); found.bins.len()];
        let mut left = 0.0_f64;
        let mut order: Vec<usize> = (0..found.bins.len()).collect();
        // Wavelengths of similar reflectance together: they share the middle.
        let mean = |k: &usize| -> f64 { light.reflectance.iter().map(|rho| rho[found.bins[*k]]).sum() };
        order.sort_by(|a, b| mean(a).total_cmp(&mean(b)));
        for pair in order.chunks(2) {
            let rho = |k: usize| mixed(&coverage, light.reflectance, found.bins[pair[k.min(pair.len() - 1)]]);
            let rho = [&rho(0)[..], &rho(1)[..]];
            let ([one, other], error) = match &inside {
                None => kernel.solved(rho, precision.change),
                Some(inside) => kernel.solved_inside(inside, rho, precision.change),
            };
            left = left.max(error);
            irradiance[pair[0]] = one;
            if let Some(last) = pair.get(1) {
                irradiance[*last] = other;
            }
        }
        let whole = [0, 1].map(|k| spread.is_some() || count[k] == page.count[k] * precision.most_per_pixel);
        Self { cells, whole, irradiance, found, spreads: spread.is_some(), left }
    }

    /// Number of wavelengths that were solved.
    pub fn wavelengths(&self) -> usize {
        self.found.bins.len()
    }

    /// Largest error of the irradiance because repetitions ended, relative to that of a page of the largest
    /// reflectance.
    pub fn left(&self) -> f64 {
        self.left
    }

    /// Number of columns and rows of cells.
    pub fn cells(&self) -> [usize; 2] {
        self.cells.count
    }

    /// X, Y and Z of each pixel in a light that is seen; the reflectances are those of the preparation.
    pub fn seen(&self, page: &Page<'_>, light: PageLight<'_>) -> Vec<[f32; 3]> {
        let weights = match self.spreads {
            false => self.found.weights(light.seen),
            true => self.found.weights(&per_root(light)),
        };
        let solved = self.irradiance.len();
        let [columns, rows] = page.count;
        let [width, height] = self.cells.count;
        let taps = |k: usize| if self.whole[k] { Taps::of_parts } else { Taps::new };
        let (x, y) = (taps(0)(columns, width), taps(1)(rows, height));
        let mut all = Vec::with_capacity(columns * rows);
        // Irradiance along a row, `[cell][wavelength]`.
        let mut row = vec![0.0_f32; width * solved];
        let mut here = vec![0.0_f32; solved];
        for (at, (first, shares)) in y.each().enumerate() {
            row.fill(0.0);
            for (k, plane) in self.irradiance.iter().enumerate() {
                for (tap, share) in shares.iter().enumerate() {
                    let line = &plane[(first + tap) % height * width..][..width];
                    let slots = row.iter_mut().skip(k).step_by(solved);
                    slots.zip(line).for_each(|(slot, value)| *slot += share * value);
                }
            }
            let states = &page.states[at * columns..][..columns];
            for ((first, shares), state) in x.each().zip(states) {
                here.fill(0.0);
                for (tap, share) in shares.iter().enumerate() {
                    let cell = &row[(first + tap) % width * solved..][..solved];
                    here.iter_mut().zip(cell).for_each(|(sum, value)| *sum += share * value);
                }
                let mut colour = [0.0_f32; 3];
                if let Some(of_state) = weights.get(usize::from(*state)) {
                    for (colour, weights) in colour.iter_mut().zip(of_state) {
                        *colour = weights.iter().zip(&here).map(|(w, e)| w * e).sum();
                    }
                }
                all.push(colour);
            }
        }
        all
    }
}

/// Most cells of a pixel along an axis.
const MOST_PARTS: f64 = 16.0;

/// What is seen of each state, divided by the root of its reflectance.
fn per_root(light: PageLight<'_>) -> Vec<[Vec<f64>; 3]> {
    let pairs = light.seen.iter().zip(light.reflectance);
    let over = |(seen, rho): (&[Vec<f64>; 3], &Vec<f64>)| {
        seen.each_ref().map(|seen| {
            let one = |(seen, rho): (&f64, &f64)| if *rho > 0.0 { seen / rho.sqrt() } else { 0.0 };
            seen.iter().zip(rho).map(one).collect()
        })
    };
    pairs.map(over).collect()
}

/// Fraction of the area of each cell in each state, `[state][cell]`.
fn coverage(page: &Page<'_>, count: [usize; 2], states: usize) -> Vec<Vec<f32>> {
    let [columns, _] = page.count;
    let x = overlaps(page.count[0], count[0]);
    let y = overlaps(page.count[1], count[1]);
    let mut coverage = vec![vec![0.0_f32; count[0] * count[1]]; states];
    let area = (count[0] * count[1]) as f64 / (page.count[0] * page.count[1]) as f64;
    for (row, pieces) in y.iter().enumerate() {
        for (cell_row, height) in pieces {
            for (state, pieces) in page.states[row * columns..][..columns].iter().zip(&x) {
                let Some(plane) = coverage.get_mut(usize::from(*state)) else { continue };
                for (column, width) in pieces {
                    plane[cell_row * count[0] + column] += (area * height * width) as f32;
                }
            }
        }
    }
    coverage
}

/// Cells that each of `from` equal parts of a length overlaps, among `to` cells, with the fraction of the
/// part.
fn overlaps(from: usize, to: usize) -> Vec<Vec<(usize, f64)>> {
    let ratio = to as f64 / from as f64;
    let of = |part: usize| {
        let ends = [part, part + 1].map(|end| end as f64 * ratio);
        let last = ((ends[1] - 1e-9).floor().max(0.0) as usize).min(to - 1);
        let pieces = (ends[0] + 1e-9).floor() as usize..=last;
        let piece = |cell: usize| (cell, (ends[1].min(cell as f64 + 1.0) - ends[0].max(cell as f64)) / ratio);
        pieces.map(piece).collect()
    };
    (0..from).map(of).collect()
}

/// Shares of cells in the means over parts of a length, both of which repeat.
struct Taps {
    /// First cell of each part.
    first: Vec<usize>,
    /// Number of cells of a part.
    width: usize,
    /// Shares of the cells of each part.
    shares: Vec<f32>,
}

/// Points and weights of the mean over a part, from its middle in parts (Gauss).
const POINTS: [[f64; 2]; 3] =
    [[-0.387_298_334_620_741_7, 5.0 / 18.0], [0.0, 8.0 / 18.0], [0.387_298_334_620_741_7, 5.0 / 18.0]];

impl Taps {
    /// Means over `parts` of the cubics through the middles of `cells`.
    fn new(parts: usize, cells: usize) -> Self {
        let ratio = cells as f64 / parts as f64;
        // Place of a point in cells, from the middle of the first one.
        let place = |part: usize, off: f64| (part as f64 + 0.5 + off) * ratio - 0.5;
        let reach = place(0, POINTS[2][0]) - place(0, POINTS[0][0]);
        let width = 5 + reach.floor() as usize;
        let mut taps = Self { first: Vec::with_capacity(parts), width, shares: vec![0.0; parts * width] };
        for (part, shares) in taps.shares.chunks_exact_mut(width).enumerate() {
            let first = place(part, POINTS[0][0]).floor() as i64 - 1;
            for [off, weight] in POINTS {
                let at = place(part, off);
                let (whole, t) = (at.floor(), at - at.floor());
                let cubics = [
                    -t * (t - 1.0) * (t - 2.0) / 6.0,
                    (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
                    -(t + 1.0) * t * (t - 2.0) / 2.0,
                    (t + 1.0) * t * (t - 1.0) / 6.0,
                ];
                let slots = &mut shares[(whole as i64 - 1 - first) as usize..];
                slots.iter_mut().zip(cubics).for_each(|(slot, cubic)| *slot += (weight * cubic) as f32);
            }
            taps.first.push(first.rem_euclid(cells as i64) as usize);
        }
        taps
    }

    /// Means over the cells of which each part consists: the light of large cells jumps at the border of a
    /// pixel.
    fn of_parts(parts: usize, cells: usize) -> Self {
        let width = (cells / parts).max(1);
        let first = (0..parts).map(|part| part * width).collect();
        Self { first, width, shares: vec![1.0 / width as f32; parts * width] }
    }

    /// First cell and shares of each part.
    fn each(&self) -> impl Iterator<Item = (usize, &[f32])> {
        self.first.iter().copied().zip(self.shares.chunks_exact(self.width))
    }
}

/// Reflectance of each cell at a wavelength.
fn mixed(coverage: &[Vec<f32>], reflectance: &[Vec<f64>], bin: usize) -> Vec<f32> {
    let mut sum = vec![0.0_f32; coverage.first().map_or(0, Vec::len)];
    for (plane, rho) in coverage.iter().zip(reflectance) {
        let rho = rho[bin] as f32;
        if rho != 0.0 {
            sum.iter_mut().zip(plane).for_each(|(sum, share)| *sum += rho * share);
        }
    }
    sum
}

/// The least number from `least` on without prime factors above 5: transforms of such lengths are fast.
fn smooth(least: usize) -> usize {
    let is_smooth = |mut number: usize| {
        for prime in [2, 3, 5] {
            while number.is_multiple_of(prime) {
                number /= prime;
            }
        }
        number == 1
    };
    (least..).find(|number| is_smooth(*number)).unwrap_or(least)
}

/// The face above cells that repeat.
struct Kernel {
    plane: Plane,
    /// Return at each bin of the transform, columns vary slowest.
    returned: Vec<f64>,
}

/// Most repetitions. Each divides the error of white of 0.95 under glass by two or more; a mirror that
/// returns 97 % of the light needs some 400.
const MOST_REPETITIONS: usize = 1000;

/// How repetitions approach the solution of a pattern.
///
/// `E = 1 + A K E`, K being the pattern, becomes `(1 - m A) E = 1 + A (K - m) E`. K lies between the least
/// and the largest reflectance; with m in the middle of them each repetition multiplies the error by at most
/// `A h / (1 - m A)`, h being half their difference. That is below 1 wherever the largest reflectance times A
/// is, which no other m achieves.
#[derive(Debug, Clone, Copy)]
struct Approach {
    /// m.
    middle: f64,
    /// Largest factor of the error in a repetition.
    rate: f64,
    /// The largest irradiance, that of a page of the largest reflectance.
    largest: f64,
}

impl Approach {
    fn new(range: [f64; 2], returned: &[f64]) -> Self {
        let most = returned.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        let [middle, half] = [0.5 * (range[0] + range[1]), 0.5 * (range[1] - range[0])];
        let rate = most * half / (1.0 - middle * most).max(f64::EPSILON);
        Self { middle, rate, largest: 1.0 / (1.0 - range[1] * most).max(f64::EPSILON) }
    }

    /// Error that is left after a repetition that changed the irradiance so much, at least that change, and
    /// with a margin of two; relative to the largest irradiance.
    fn left(&self, change: f64) -> f64 {
        2.0 * change * (self.rate / (1.0 - self.rate).max(f64::EPSILON)).max(1.0) / self.largest
    }
}

/// Least and largest value of two patterns.
fn range(rho: [&[f32]; 2]) -> [f64; 2] {
    let all = rho.into_iter().flatten().map(|rho| f64::from(*rho));
    all.fold([f64::INFINITY, 0.0], |[least, most], rho| [least.min(rho.max(0.0)), most.max(rho)])
}

/// Solution of two patterns, and the error that is left, relative to the largest irradiance.
type Solved = ([Vec<f32>; 2], f64);

impl Kernel {
    /// Light inside the pixels of two patterns of reflectances, on its way out. `inside`: factor of the
    /// spread at each bin.
    fn solved_inside(&self, inside: &[f64], rho: [&[f32]; 2], tolerance: f64) -> Solved {
        let cells = self.returned.len();
        let scale = 1.0 / cells as f64;
        let roots: Vec<Complex64> = rho[0]
            .iter()
            .zip(rho[1])
            .map(|(one, other)| {
                Complex64::new(f64::from(one.max(0.0)).sqrt(), f64::from(other.max(0.0)).sqrt())
            })
            .collect();
        // Modulations that the spread removes meet a reflectance of 0.
        let approach = Approach::new([0.0, range(rho)[1]], &self.returned);
        let middle = approach.middle;
        let first = 1.0 / (1.0 - middle * self.returned[0]);
        let factors: Vec<f64> = self.returned.iter().map(|a| a / (1.0 - middle * a)).collect();
        let times = |a: &Complex64, b: &Complex64| Complex64::new(a.re * b.re, a.im * b.im);
        let multiplied = |cells: Vec<Complex64>, factors: &[f64]| {
            let mut spectrum = self.plane.forward(cells);
            spectrum.iter_mut().zip(factors).for_each(|(value, factor)| *value *= scale * factor);
            self.plane.inverse(spectrum)
        };
        let within = |irradiance: &[Complex64]| {
            multiplied(irradiance.iter().zip(&roots).map(|(e, root)| times(e, root)).collect(), inside)
        };
        let mut irradiance = vec![Complex64::new(first, first); cells];
        let mut left = f64::INFINITY;
        for _ in 0..MOST_REPETITIONS {
            let light = within(&irradiance);
            let apart = light
                .iter()
                .zip(&roots)
                .zip(&irradiance)
                .map(|((light, root), e)| times(light, root) - middle * e);
            let returned = multiplied(apart.collect(), &factors);
            let mut change = 0.0_f64;
            for (e, returned) in irradiance.iter_mut().zip(returned) {
                let next = returned + Complex64::new(first, first);
                change = change.max((next.re - e.re).abs()).max((next.im - e.im).abs());
                *e = next;
            }
            left = approach.left(change);
            if left <= tolerance {
                break;
            }
        }
        let light = within(&irradiance);
        let parts = [
            light.iter().map(|light| light.re as f32).collect(),
            light.iter().map(|light| light.im as f32).collect(),
        ];
        (parts, left)
    }

    fn new(cells: Cells, face: &dyn Fn(f64) -> f64) -> Self {
        let [columns, rows] = cells.count;
        let mut returned = vec![0.0; columns * rows];
        for column in 0..=columns / 2 {
            for row in 0..=rows / 2 {
                let f = cells.frequency(0, column).hypot(cells.frequency(1, row));
                let value = face(f);
                for column in [column, (columns - column) % columns] {
                    for row in [row, (rows - row) % rows] {
                        returned[column * rows + row] = value;
                    }
                }
            }
        }
        Self { plane: Plane::new(cells.count), returned }
    }

    /// Irradiance of two patterns of reflectances.
    fn solved(&self, rho: [&[f32]; 2], tolerance: f64) -> Solved {
        let cells = self.returned.len();
        let approach = Approach::new(range(rho), &self.returned);
        let middle = approach.middle;
        let first = 1.0 / (1.0 - middle * self.returned[0]);
        let scale = 1.0 / cells as f64;
        let factors: Vec<f64> = self.returned.iter().map(|a| scale * a / (1.0 - middle * a)).collect();
        // A uniform pattern is solved.
        let mut found = rho.map(|rho| {
            let mean = rho.iter().map(|rho| f64::from(*rho)).sum::<f64>() / cells as f64;
            vec![(1.0 / (1.0 - mean * self.returned[0])) as f32; cells]
        });
        let mut left = f64::INFINITY;
        for _ in 0..MOST_REPETITIONS {
            let [one, other] = &found;
            let apart = rho[0].iter().zip(one).zip(rho[1].iter().zip(other)).map(|((r, e), (s, f))| {
                Complex64::new(
                    (f64::from(*r) - middle) * f64::from(*e),
                    (f64::from(*s) - middle) * f64::from(*f),
                )
            });
            let mut spectrum = self.plane.forward(apart.collect());
            spectrum.iter_mut().zip(&factors).for_each(|(value, factor)| *value *= factor);
            let returned = self.plane.inverse(spectrum);
            let mut change = 0.0_f64;
            let [one, other] = &mut found;
            for ((one, other), value) in one.iter_mut().zip(other).zip(&returned) {
                let next = [first + value.re, first + value.im];
                change =
                    change.max((next[0] - f64::from(*one)).abs()).max((next[1] - f64::from(*other)).abs());
                (*one, *other) = (next[0] as f32, next[1] as f32);
            }
            left = approach.left(change);
            if left <= tolerance {
                break;
            }
        }
        (found, left)
    }
}

#[cfg(test)]
mod tests;

//! Lambertian pixels under a flat face: sharp to first order, surrounded by light that the face returns to them.
//!
//! **What.** A small signal about a state of reflectance rho, of the same relative size at all wavelengths, has the transfer
//! `(1 - rho A(0))/(1 - rho A(f))` with the return A of the face ([`FaceReturn`]). The constant `1 - rho A(0)` is the sharp image;
//! the rest is spread over many thicknesses of the glass. Direction and kind of the light do not matter: it arrives
//! uniformly.
//!
//! Places come from frequencies by Fourier and Hankel series with a period of [`PERIOD`] thicknesses.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_imaging::text::Bitmap;
use papilio_transport::Panel;
use papilio_transport::spatial::{Cells, FaceReturn, Peak, Recycling};

use super::patterns::{Pattern, PatternKind};
use super::response::face_reflectance;
use super::{Level, Response};

/// Period of the series, in thicknesses: light beyond half of it is below 3e-5 of all.
const PERIOD: f64 = 400.0;

/// Highest frequency of the series times the thickness. |A| decreases to 1e-5 there.
const HIGHEST: f64 = 16.0;

/// Period of lines, in thicknesses.
const LINE_PERIOD: f64 = 64.0;

/// Tolerance of the irradiance of patterns.
const TOLERANCE: f64 = 1e-9;

/// Number of rings with which cells are filled.
const RINGS: usize = 300;

struct Paper {
    thickness_mm: f64,
    /// Faces by index, and the wavelengths of each.
    faces: Vec<(FaceReturn, Vec<usize>)>,
    /// Light of equal reflectances, `[state]`.
    shades: Vec<Vec<Shade>>,
    /// Reflectance of the paper, and light by wavelength, `[state][wavelength]`.
    reflectance: Vec<f64>,
    light: Vec<f64>,
    bins: usize,
    /// Sharp image of each state, and the rest at each frequency of the series.
    sharp: Vec<f64>,
    rest: Vec<Vec<f64>>,
    frequencies_per_mm: f64,
}

/// Light of the wavelengths at which a state has the same reflectance under the same face.
struct Shade {
    face: usize,
    reflectance: f64,
    light: f64,
}

pub(super) fn response(
    panel: &Panel,
    thickness_mm: f64,
    weights: &[f64],
    via_pixel: &[f64],
    level: Level,
) -> Box<dyn Response> {
    let (states, bins) = (panel.base.states(), weights.len());
    let mut reflectance = vec![0.0; states * bins];
    panel.base.reflectance(0.0, &panel.medium, &mut reflectance);
    let light = (0..states * bins).map(|at| weights[at % bins] * via_pixel[at]).collect();
    let most = level.most_per_mm.max(HIGHEST / thickness_mm);
    let index = panel.medium.index();
    let mut faces: Vec<(FaceReturn, Vec<usize>)> = Vec::new();
    for bin in 0..bins {
        match (0..bin).find(|other| index[*other] == index[bin]) {
            Some(other) => {
                let same = faces.iter_mut().find(|(_, of)| of.contains(&other));
                same.into_iter().for_each(|(_, of)| of.push(bin));
            }
            None => {
                let passes = |beta: f64| 1.0 - face_reflectance(panel, bin, beta);
                faces.push((FaceReturn::new(index[bin], thickness_mm, most, passes).tabulated(), vec![bin]));
            }
        }
    }
    let frequencies_per_mm = 1.0 / (PERIOD * thickness_mm);
    let mut paper = Paper {
        thickness_mm,
        faces,
        shades: Vec::new(),
        reflectance,
        light,
        bins,
        sharp: Vec::new(),
        rest: Vec::new(),
        frequencies_per_mm,
    };
    paper.shades = (0..states).map(|state| paper.shades_of(state)).collect();
    paper.sharp = paper.sum(0.0, |rho, zero, _| 1.0 - rho * zero);
    let count = (HIGHEST / thickness_mm / frequencies_per_mm) as usize;
    let series: Vec<Vec<f64>> = (0..count).map(|k| paper.at(k as f64 * frequencies_per_mm)).collect();
    let rest = |state: usize| series.iter().map(|one| one[state] - paper.sharp[state]).collect();
    paper.rest = (0..states).map(rest).collect();
    Box::new(paper)
}

impl Paper {
    fn shades_of(&self, state: usize) -> Vec<Shade> {
        let mut shades: Vec<Shade> = Vec::new();
        for (face, (_, bins)) in self.faces.iter().enumerate() {
            for at in bins.iter().map(|bin| state * self.bins + bin) {
                let (reflectance, light) = (self.reflectance[at], self.light[at]);
                let same = |shade: &&mut Shade| shade.face == face && shade.reflectance == reflectance;
                match shades.iter_mut().find(same) {
                    Some(shade) => shade.light += light,
                    None => shades.push(Shade { face, reflectance, light }),
                }
            }
        }
        shades
    }

    /// Sums over wavelengths the light of each state times a function of rho, A(0) and A(f).
    fn sum(&self, frequency_per_mm: f64, of: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
        let at = |(face, _): &(FaceReturn, Vec<usize>)| [face.at(0.0), face.at(frequency_per_mm)];
        let returned: Vec<[f64; 2]> = self.faces.iter().map(at).collect();
        let of_shade = |shade: &Shade| {
            let [zero, returned] = returned[shade.face];
            shade.light * of(shade.reflectance, zero, returned)
        };
        self.shades.iter().map(|shades| shades.iter().map(of_shade).sum()).collect()
    }

    /// Light of each state at a frequency.
    fn at(&self, frequency_per_mm: f64) -> Vec<f64> {
        self.sum(frequency_per_mm, |rho, zero, returned| (1.0 - rho * zero) / (1.0 - rho * returned))
    }

    fn states(&self) -> usize {
        self.sharp.len()
    }

    /// Light of each state on the lower side of a place.
    fn below(&self, at_mm: f64) -> Vec<f64> {
        let step = if at_mm == 0.0 { 0.5 } else { f64::from(at_mm > 0.0) };
        let (sin, cos) = (2.0 * PI * at_mm * self.frequencies_per_mm).sin_cos();
        // The mean of the period has been spread evenly over it.
        let even = 0.5 + at_mm * self.frequencies_per_mm;
        let states = self.sharp.iter().zip(&self.rest);
        let mut sums: Vec<f64> = states.map(|(sharp, rest)| sharp * step + rest[0] * even).collect();
        let (mut s, mut c) = (0.0_f64, 1.0_f64);
        for k in 1..self.count() {
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
            let factor = s / (PI * k as f64);
            sums.iter_mut().zip(&self.rest).for_each(|(sum, rest)| *sum += rest[k] * factor);
        }
        sums
    }

    /// Light of each state within a radius above 0.
    fn within(&self, radius_mm: f64) -> Vec<f64> {
        let step = self.frequencies_per_mm;
        let turn = 2.0 * PI * radius_mm * step;
        // The trapezoidal rule, with the slope of the integrand at 0.
        let slope = step * step / 12.0 * PI * radius_mm;
        let mut sums: Vec<f64> = self.rest.iter().map(|rest| slope * rest[0]).collect();
        for k in 1..self.count() {
            let factor = step * libm::j1(turn * k as f64);
            sums.iter_mut().zip(&self.rest).for_each(|(sum, rest)| *sum += rest[k] * factor);
        }
        let states = sums.iter().zip(&self.sharp);
        states.map(|(sum, sharp)| sharp + 2.0 * PI * radius_mm * sum).collect()
    }

    /// Number of frequencies of the series.
    fn count(&self) -> usize {
        self.rest.first().map_or(0, Vec::len)
    }

    /// Light between ascending borders, from what is below each, `[state][bin]`.
    fn bins(&self, below: impl Fn(f64) -> Vec<f64>, edges: &[f64]) -> Vec<Vec<f64>> {
        let mut bins: Vec<Vec<f64>> =
            (0..self.states()).map(|_| Vec::with_capacity(edges.len() + 1)).collect();
        let mut last = vec![0.0; self.states()];
        let total = (0..self.states()).map(|state| self.sharp[state] + self.rest[state][0]).collect();
        for now in edges.iter().map(|edge| below(*edge)).chain([total]) {
            for (state, bins) in bins.iter_mut().enumerate() {
                bins.push(now[state] - last[state]);
            }
            last = now;
        }
        bins
    }
}

impl Paper {
    /// Light of a pattern of two states through all orders, reduced to some numbers. `is_first`: cells in the first state.
    fn solved<N>(
        &self,
        cells: Cells,
        states: [usize; 2],
        is_first: &[bool],
        reduced: impl Fn(&[f64]) -> N,
    ) -> N
    where
        N: AsMut<[f64]>,
    {
        let mut sum: Option<N> = None;
        for (face, bins) in &self.faces {
            let recycling = Recycling::new(cells, face);
            let zero = face.at(0.0);
            // Wavelengths with the same reflectances are solved once.
            let mut known: Vec<([f64; 2], Vec<usize>)> = Vec::new();
            for bin in bins {
                let pair = states.map(|state| self.reflectance[state * self.bins + bin]);
                match known.iter_mut().find(|(other, _)| *other == pair) {
                    Some((_, bins)) => bins.push(*bin),
                    None => known.push((pair, vec![*bin])),
                }
            }
            for (pair, bins) in known {
                let rho: Vec<f64> = is_first.iter().map(|first| pair[usize::from(!first)]).collect();
                let irradiance = recycling.irradiance(&rho, TOLERANCE);
                // Light of each state per its irradiance: that of a page of it has 1/(1 - rho A(0)).
                let [first, second] = [0, 1].map(|k| {
                    let page: f64 = bins.iter().map(|bin| self.light[states[k] * self.bins + bin]).sum();
                    page * (1.0 - pair[k] * zero)
                });
                let lights = irradiance.iter().zip(is_first);
                let lights: Vec<f64> =
                    lights.map(|(e, is_first)| e * if *is_first { first } else { second }).collect();
                let mut found = reduced(&lights);
                match &mut sum {
                    None => sum = Some(found),
                    Some(sum) => {
                        let pairs = sum.as_mut().iter_mut().zip(found.as_mut());
                        pairs.for_each(|(sum, more)| *sum += *more);
                    }
                }
            }
        }
        sum.unwrap_or_else(|| reduced(&vec![0.0; is_first.len()]))
    }

    /// Mean of two states in a pattern that is much finer than the thickness: its mean reflectance returns light (Clapper, Yule).
    fn fine_mean(&self, states: [usize; 2]) -> f64 {
        let mut sum = 0.0;
        for (face, bins) in &self.faces {
            let zero = face.at(0.0);
            for bin in bins {
                let rho = states.map(|state| self.reflectance[state * self.bins + bin]);
                let mean = 0.5 * (rho[0] + rho[1]);
                for (state, rho) in states.into_iter().zip(rho) {
                    let light = self.light[state * self.bins + bin];
                    sum += 0.5 * light * (1.0 - rho * zero) / (1.0 - mean * zero);
                }
            }
        }
        sum
    }
}

impl Response for Paper {
    fn transfer(&self, _axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        self.at(frequency_per_mm).into_iter().map(Complex64::from).collect()
    }

    fn strips(&self, _axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.bins(|at| self.below(at), edges_mm)
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.bins(|at| self.within(at), radii_mm)
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let most = [x_mm, y_mm].map(|edges| edges.iter().fold(0.0_f64, |most, x| most.max(x.abs())));
        let step = most[0].hypot(most[1]) / RINGS as f64;
        let radii: Vec<f64> = (1..=RINGS).map(|k| k as f64 * step).collect();
        let rings = self.rings(&radii);
        let columns = x_mm.len() - 1;
        let of_state = |state: usize| {
            let mut cells = vec![0.0; columns * (y_mm.len() - 1)];
            for (row, y) in y_mm.windows(2).enumerate() {
                for (column, x) in x_mm.windows(2).enumerate() {
                    let cell = &mut cells[row * columns + column];
                    let [width, height] = [x, y].map(|ends| ends[1] - ends[0]);
                    for (i, j) in (0..9).map(|k| (k % 3, k / 3)) {
                        let at =
                            [x[0] + width * (i as f64 + 0.5) / 3.0, y[0] + height * (j as f64 + 0.5) / 3.0];
                        let ring = ((at[0].hypot(at[1]) / step) as usize).min(RINGS - 1);
                        let sharp = if ring == 0 { self.sharp[state] } else { 0.0 };
                        let area = PI * step * step * (2 * ring + 1) as f64;
                        *cell += (rings[state][ring] - sharp) / area * width * height / 9.0;
                    }
                    if (x[0]..x[1]).contains(&0.0) && (y[0]..y[1]).contains(&0.0) {
                        *cell += self.sharp[state];
                    }
                }
            }
            cells
        };
        (0..self.states()).map(of_state).collect()
    }

    fn line(&self, states: [usize; 2], width_mm: f64, level: Level) -> Option<f64> {
        let parts = if level.is_fine() { 5 } else { 3 };
        let cell = width_mm / parts as f64;
        let count = (LINE_PERIOD * self.thickness_mm / cell).max(16.0 * parts as f64) as usize;
        let count = count.next_power_of_two();
        let cells = Cells { count: [count, 1], period_mm: [count as f64 * cell, 1.0] };
        let mut is_line = vec![false; count];
        is_line[..parts].fill(true);
        let [middle] = self.solved(cells, states, &is_line, |light| [light[parts / 2]]);
        Some(middle)
    }

    fn pattern_mean(&self, pattern: Pattern, level: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states } = pattern;
        if period_mm == 0.0 {
            return Some(self.fine_mean(states));
        }
        let widest = match (kind, level.is_fine()) {
            (PatternKind::Stripes, true) => 0.05,
            (PatternKind::Stripes, false) => 0.1,
            (PatternKind::Checkerboard, true) => 0.15,
            (PatternKind::Checkerboard, false) => 0.3,
        };
        let half = (0.5 * period_mm / (widest * self.thickness_mm)).ceil().clamp(4.0, 4096.0) as usize;
        let rows = if kind == PatternKind::Stripes { 1 } else { 2 * half };
        let cells = Cells { count: [2 * half, rows], period_mm: [period_mm; 2] };
        let is_on = (0..cells.len()).map(|cell| (cell % (2 * half) < half) == (cell / (2 * half) < half));
        let is_on: Vec<bool> = is_on.collect();
        let mean = |light: &[f64]| [light.iter().sum::<f64>() / light.len() as f64];
        Some(self.solved(cells, states, &is_on, mean)[0])
    }

    fn text(
        &self,
        bitmap: &Bitmap,
        pitch_mm: [f64; 2],
        states: [usize; 2],
        level: Level,
    ) -> Option<Vec<f64>> {
        let widest = if level.is_fine() { 0.17 } else { 0.4 } * self.thickness_mm;
        // An odd number of cells: one is in the middle of each pixel.
        let parts = pitch_mm.map(|pitch| (pitch / widest).ceil() as usize | 1);
        let [columns, rows] = [0, 1].map(|axis| bitmap.count[axis] * parts[axis]);
        let period_mm = [0, 1].map(|axis| bitmap.count[axis] as f64 * pitch_mm[axis]);
        let pixel = |cell: usize| cell / columns / parts[1] * bitmap.count[0] + cell % columns / parts[0];
        let is_black: Vec<bool> = (0..columns * rows).map(|cell| bitmap.black[pixel(cell)]).collect();
        let cells = Cells { count: [columns, rows], period_mm };
        let middle = |pixel: usize| {
            let (column, row) = (pixel % bitmap.count[0], pixel / bitmap.count[0]);
            (row * parts[1] + parts[1] / 2) * columns + column * parts[0] + parts[0] / 2
        };
        let middles = |light: &[f64]| -> Vec<f64> {
            (0..bitmap.black.len()).map(|pixel| light[middle(pixel)]).collect()
        };
        Some(self.solved(cells, states, &is_black, middles))
    }

    fn images(&self) -> Vec<[f64; 2]> {
        vec![[0.0; 2]]
    }

    fn peaks(&self) -> Vec<Peak> {
        vec![Peak { at_mm: [0.0; 2], width_mm: 0.05 * self.thickness_mm }]
    }
}

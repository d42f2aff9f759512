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
use papilio_transport::Panel;
use papilio_transport::spatial::{Cells, FaceReturn, Peak, Recycling};

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
    /// Reflectance of the paper, and light by wavelength, `[state][wavelength]`.
    reflectance: Vec<f64>,
    light: Vec<f64>,
    bins: usize,
    /// Sharp image of each state, and the rest at each frequency of the series.
    sharp: Vec<f64>,
    rest: Vec<Vec<f64>>,
    frequencies_per_mm: f64,
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
                faces.push((FaceReturn::new(index[bin], thickness_mm, most, passes), vec![bin]));
            }
        }
    }
    let frequencies_per_mm = 1.0 / (PERIOD * thickness_mm);
    let mut paper = Paper {
        thickness_mm,
        faces,
        reflectance,
        light,
        bins,
        sharp: Vec::new(),
        rest: Vec::new(),
        frequencies_per_mm,
    };
    paper.sharp = paper.sum(0.0, |rho, zero, _| 1.0 - rho * zero);
    let count = (HIGHEST / thickness_mm / frequencies_per_mm) as usize;
    let series: Vec<Vec<f64>> = (0..count).map(|k| paper.at(k as f64 * frequencies_per_mm)).collect();
    let rest = |state: usize| series.iter().map(|one| one[state] - paper.sharp[state]).collect();
    paper.rest = (0..states).map(rest).collect();
    Box::new(paper)
}

impl Paper {
    /// Sums over wavelengths the light of each state times a function of rho, A(0) and A(f).
    fn sum(&self, frequency_per_mm: f64, of: impl Fn(f64, f64, f64) -> f64) -> Vec<f64> {
        let states = self.light.len() / self.bins;
        let mut sums = vec![0.0; states];
        for (face, bins) in &self.faces {
            let (zero, returned) = (face.at(0.0), face.at(frequency_per_mm));
            for (state, sum) in sums.iter_mut().enumerate() {
                for bin in bins {
                    let at = state * self.bins + bin;
                    *sum += self.light[at] * of(self.reflectance[at], zero, returned);
                }
            }
        }
        sums
    }

    /// Light of each state at a frequency.
    fn at(&self, frequency_per_mm: f64) -> Vec<f64> {
        self.sum(frequency_per_mm, |rho, zero, returned| (1.0 - rho * zero) / (1.0 - rho * returned))
    }

    fn states(&self) -> usize {
        self.sharp.len()
    }

    /// Light of a state on the lower side of a place.
    fn below(&self, state: usize, at_mm: f64) -> f64 {
        let step = if at_mm == 0.0 { 0.5 } else { f64::from(at_mm > 0.0) };
        let rest = &self.rest[state];
        let turn = 2.0 * PI * at_mm * self.frequencies_per_mm;
        // The mean of the period has been spread evenly over it.
        let mut sum = rest[0] * (0.5 + at_mm * self.frequencies_per_mm);
        let (sin, cos) = turn.sin_cos();
        let (mut s, mut c) = (0.0_f64, 1.0_f64);
        for (k, rest) in rest.iter().enumerate().skip(1) {
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
            sum += rest * s / (PI * k as f64);
        }
        self.sharp[state] * step + sum
    }

    /// Light of a state within a radius above 0.
    fn within(&self, state: usize, radius_mm: f64) -> f64 {
        let rest = &self.rest[state];
        let step = self.frequencies_per_mm;
        let turn = 2.0 * PI * radius_mm * step;
        let sum: f64 =
            rest.iter().enumerate().skip(1).map(|(k, rest)| rest * libm::j1(turn * k as f64)).sum();
        // The trapezoidal rule, with the slope of the integrand at 0.
        let slope = rest[0] * PI * radius_mm;
        self.sharp[state] + 2.0 * PI * radius_mm * (sum * step + step * step / 12.0 * slope)
    }

    fn bins(
        &self,
        total: impl Fn(usize) -> f64,
        below: impl Fn(usize, f64) -> f64,
        edges: &[f64],
    ) -> Vec<Vec<f64>> {
        let of_state = |state: usize| {
            let mut last = 0.0;
            let mut bins: Vec<f64> = Vec::with_capacity(edges.len() + 1);
            for edge in edges {
                let now = below(state, *edge);
                bins.push(now - last);
                last = now;
            }
            bins.push(total(state) - last);
            bins
        };
        (0..self.states()).map(of_state).collect()
    }

    fn total(&self, state: usize) -> f64 {
        self.sharp[state] + self.rest[state][0]
    }
}

impl Response for Paper {
    fn transfer(&self, [fx, fy]: [f64; 2]) -> Vec<Complex64> {
        self.at(fx.hypot(fy)).into_iter().map(Complex64::from).collect()
    }

    fn strips(&self, _axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.bins(|state| self.total(state), |state, at| self.below(state, at), edges_mm)
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.bins(|state| self.total(state), |state, at| self.within(state, at), radii_mm)
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

    fn line(&self, [line, surround]: [usize; 2], width_mm: f64, level: Level) -> Option<f64> {
        let parts = if level.digits > 10.0 { 5 } else { 3 };
        let cell = width_mm / parts as f64;
        let count = (LINE_PERIOD * self.thickness_mm / cell).max(16.0 * parts as f64) as usize;
        let count = count.next_power_of_two();
        let cells = Cells { count: [count, 1], period_mm: [count as f64 * cell, 1.0] };
        let mut sum = 0.0;
        for (face, bins) in &self.faces {
            let recycling = Recycling::new(cells, face);
            let zero = face.at(0.0);
            // Wavelengths with the same reflectances are solved once.
            let mut known: Vec<([f64; 2], f64)> = Vec::new();
            for bin in bins {
                let pair = [line, surround].map(|state| self.reflectance[state * self.bins + bin]);
                let lit = match known.iter().find(|(other, _)| *other == pair) {
                    Some((_, lit)) => *lit,
                    None => {
                        let mut rho = vec![pair[1]; count];
                        rho[..parts].fill(pair[0]);
                        let lit = recycling.irradiance(&rho, TOLERANCE)[parts / 2];
                        known.push((pair, lit));
                        lit
                    }
                };
                sum += self.light[line * self.bins + bin] * lit * (1.0 - pair[0] * zero);
            }
        }
        Some(sum)
    }

    fn images(&self) -> Vec<[f64; 2]> {
        vec![[0.0; 2]]
    }

    fn peaks(&self) -> Vec<Peak> {
        vec![Peak { at_mm: [0.0; 2], width_mm: 0.05 * self.thickness_mm }]
    }
}

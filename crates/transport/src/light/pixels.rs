//! Pixels of a sphere: radiances of a picture in equirectangular projection, in any orientation to the
//! display.
//!
//! # Model
//! The picture has a frame of its own: rows are uniformly spaced in inclination from its pole, columns in
//! azimuth about it. The radiance is uniform within a pixel. A direction of the display is rotated into that
//! frame and looked up there, so that no orientation smooths the picture.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use crate::numerics::quadrature::gauss;

/// Radiances by pixel of the whole sphere, and their orientation.
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    /// Number of columns.
    pub columns: usize,
    /// Radiances by rows from the pole; column k contains the azimuths from k to k + 1 of `columns` parts of
    /// the circle.
    pub radiance: Arc<[f32]>,
    /// Axes of the picture (azimuth 0, azimuth 90 deg, pole) as unit vectors of the display, whose normal is
    /// z.
    pub frame: [[f64; 3]; 3],
}

/// Parts of the azimuths of a pixel on the horizon of the display, over which its light is integrated.
const PARTS: usize = 4;
/// Number of points of each part.
const POINTS: usize = 8;

impl Pixels {
    pub(crate) fn rows(&self) -> usize {
        self.radiance.len() / self.columns
    }

    /// Returns the height and the width of a pixel: its inclinations and its azimuths, radians.
    pub(crate) fn steps(&self) -> [f64; 2] {
        [PI / self.rows() as f64, TAU / self.columns as f64]
    }

    /// Returns true if its pole is the normal of the display.
    pub(crate) fn is_level(&self) -> bool {
        self.frame[2] == [0.0, 0.0, 1.0]
    }

    /// Returns the azimuth of the display at which its first column begins, radians, if its pole is the normal.
    pub(crate) fn azimuth(&self) -> f64 {
        self.frame[0][1].atan2(self.frame[0][0])
    }

    /// Returns the direction of the display of this inclination and azimuth (sines and cosines).
    pub(crate) fn direction(&self, (sin, cos): (f64, f64), (sin_turn, cos_turn): (f64, f64)) -> [f64; 3] {
        let [x, y, pole] = &self.frame;
        std::array::from_fn(|k| sin * (cos_turn * x[k] + sin_turn * y[k]) + cos * pole[k])
    }

    /// Returns the radiance of light from a direction of the display.
    pub fn at(&self, direction: [f64; 3]) -> f64 {
        let [x, y, z] = rotated(&self.frame, direction);
        let (rows, columns) = (self.rows(), self.columns);
        let row = (x.hypot(y).atan2(z) / PI * rows as f64) as usize;
        let column = (y.atan2(x).rem_euclid(TAU) / TAU * columns as f64) as usize;
        f64::from(self.radiance[row.min(rows - 1) * columns + column.min(columns - 1)])
    }

    /// Returns the integrals over the hemisphere above the display: of the radiance by direction cosines (the
    /// irradiance of the display plane), and by solid angle. Pixels above the horizon have closed forms; of
    /// those that it divides, the part above it is integrated.
    pub fn light(&self) -> [f64; 2] {
        let normal = self.frame.map(|axis| axis[2]);
        let (rows, columns) = (self.rows(), self.columns);
        let (high, wide) = (PI / rows as f64, TAU / columns as f64);
        let turns: Vec<[f64; 2]> = (0..=columns)
            .map(|column| {
                let (sin, cos) = (wide * column as f64).sin_cos();
                [cos, sin]
            })
            .collect();
        let mut sums = [0.0; 2];
        for (row, pixels) in self.radiance.chunks_exact(columns).enumerate() {
            let [from, to] = [row, row + 1].map(|edge| high * edge as f64);
            let [up, across, area] = row_integrals(from, to);
            let (sin, cos) = (0.5 * (from + to)).sin_cos();
            // No point of a pixel is farther from its middle.
            let reach = 0.5 * high.hypot(wide);
            for (column, radiance) in pixels.iter().enumerate().filter(|(_, radiance)| **radiance > 0.0) {
                let radiance = f64::from(*radiance);
                let [[c0, s0], [c1, s1]] = [turns[column], turns[column + 1]];
                let middle = wide * (column as f64 + 0.5);
                let height = sin * (normal[0] * middle.cos() + normal[1] * middle.sin()) + cos * normal[2];
                let parts = if height > reach {
                    let flux =
                        across * (normal[0] * (s1 - s0) + normal[1] * (c0 - c1)) + up * normal[2] * wide;
                    [flux, area * wide]
                } else if height > -reach {
                    part_above(normal, [from, to], wide * column as f64, wide)
                } else {
                    continue;
                };
                sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += radiance * part);
            }
        }
        sums
    }

    /// Returns the inclinations between which the rows above its equator are lit; `None` if they are dark.
    pub(crate) fn lit_above(&self) -> Option<[f64; 2]> {
        let high = PI / self.rows() as f64;
        let above = self.radiance.chunks_exact(self.columns).take(self.rows() / 2).enumerate();
        let lit = above.filter(|(_, row)| row.iter().any(|value| *value > 0.0)).map(|(row, _)| row);
        let (first, last) = lit.fold((usize::MAX, 0), |(first, last), row| (first.min(row), last.max(row)));
        (first <= last).then(|| [high * first as f64, (high * (last + 1) as f64).min(FRAC_PI_2)])
    }

    /// Returns the rows at inclinations from one to another, radians: the inclinations between which each
    /// lies, and its radiances; from the opposite pole if `flipped`, with azimuths in the opposite sense.
    pub(crate) fn rows_within(
        &self,
        [from, to]: [f64; 2],
        flipped: bool,
    ) -> impl Iterator<Item = ([f64; 2], Vec<f64>)> {
        let rows = self.rows();
        let high = PI / rows as f64;
        let first = (from / high).floor().max(0.0) as usize;
        let last = ((to / high).ceil() as usize).min(rows);
        let row = move |row: usize| {
            let stored = if flipped { rows - 1 - row } else { row };
            let pixels =
                self.radiance[stored * self.columns..][..self.columns].iter().map(|value| f64::from(*value));
            let pixels = if flipped { pixels.rev().collect() } else { pixels.collect() };
            ([row, row + 1].map(|edge| high * edge as f64), pixels)
        };
        (first..last).map(row)
    }
}

/// Returns the components of a vector along these axes.
pub(crate) fn rotated(frame: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    frame.map(|axis| axis.iter().zip(vector).map(|(a, b)| a * b).sum())
}

/// Returns the integrals of `sin cos`, `sin^2` and `sin` from one inclination to another.
fn row_integrals(from: f64, to: f64) -> [f64; 3] {
    let up = 0.5 * (to.sin().powi(2) - from.sin().powi(2));
    let across = 0.5 * (to - from) - 0.25 * ((2.0 * to).sin() - (2.0 * from).sin());
    [up, across, from.cos() - to.cos()]
}

/// Returns the integrals of [`Pixels::light`] over the part of a pixel above the horizon.
fn part_above(normal: [f64; 3], [from, to]: [f64; 2], start: f64, wide: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let step = wide / PARTS as f64;
    for part in 0..PARTS {
        let start = start + part as f64 * step;
        for node in gauss(start, start + step, POINTS) {
            let along = normal[0] * node.x.cos() + normal[1] * node.x.sin();
            // Positive within 90 deg of this inclination.
            let highest = along.atan2(normal[2]);
            for turn in [0.0, TAU] {
                let (low, high) = (from.max(highest + turn - FRAC_PI_2), to.min(highest + turn + FRAC_PI_2));
                if low < high {
                    let [up, across, area] = row_integrals(low, high);
                    sums[0] += node.weight * (along * across + normal[2] * up);
                    sums[1] += node.weight * area;
                }
            }
        }
    }
    sums
}

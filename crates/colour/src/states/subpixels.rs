//! Coverages of three independent sub-pixels.
//!
//! **What.** A display with three sub-pixels, each of them on or off, has eight states, and the light of its
//! sub-pixels adds: `W = R + G + B - 2 K`, and so on. Its hull is a parallelepiped, and the coverages of the
//! three sub-pixels are unique: the fractions of red, green and blue sub-pixels that are on. They are three
//! independent binary pictures, however the sub-pixels are combined to states.
//!
//! **Parameters.** X, Y, Z of the eight states, in the order of [`Corners`].
//!
//! **Range.** Any colours; those outside the hull have coverages below 0 or above 1. `misfit` states how far
//! the states are from adding.

use crate::matrix::{Matrix, inverse, times};
use crate::{ColourError, Corners, Xyz};

/// Three independent sub-pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubPixels {
    black: Xyz,
    /// X, Y, Z that red, green and blue add to black, as columns.
    added: Matrix,
    coverages: Matrix,
    misfit: f64,
}

impl SubPixels {
    /// Computes the matrices from black and the three primaries.
    ///
    /// # Errors
    ///
    /// [`ColourError::Dependent`] if the primaries and black are in a plane.
    pub fn new(corners: &Corners) -> Result<Self, ColourError> {
        let [black, red, green, _, blue, ..] = corners.xyz;
        let [r, g, b] = [red, green, blue].map(|primary| (primary - black).to_array());
        let added = [0, 1, 2].map(|k| [r[k], g[k], b[k]]);
        let coverages = inverse(&added);
        if !coverages.iter().flatten().all(|value| value.is_finite()) {
            return Err(ColourError::Dependent);
        }
        let mut sub_pixels = Self { black, added, coverages, misfit: 0.0 };
        let deviation = |on: usize| {
            let sum = sub_pixels.xyz([0, 1, 2].map(|k| f64::from(u8::from(on >> k & 1 == 1))));
            (corners.xyz[on] - sum).to_array().into_iter().fold(0.0, |most: f64, part| most.max(part.abs()))
        };
        let misfit = (0..8).map(deviation).fold(0.0, f64::max) / corners.xyz[7].y;
        sub_pixels.misfit = misfit;
        Ok(sub_pixels)
    }

    /// Largest difference of X, Y or Z between a state and the sum of its sub-pixels, relative to Y of white.
    /// It is 0 if their light adds; coverages are exact then.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// Coverages of red, green and blue that have a colour; from 0 to 1 inside the hull.
    pub fn coverages(&self, colour: Xyz) -> [f64; 3] {
        times(&self.coverages, (colour - self.black).to_array())
    }

    /// The colour of coverages of red, green and blue.
    pub fn xyz(&self, coverages: [f64; 3]) -> Xyz {
        let [x, y, z] = times(&self.added, coverages);
        self.black + Xyz { x, y, z }
    }
}

//! Light that flat faces return to a mirror-like pixel: it keeps its direction, and comes back at twice the
//! shift of one crossing of the glass, `F(theta) exp(-2 pi i f.2D)`.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::Beta;

use super::super::displacement;
use super::Heights;
use crate::Panel;
use crate::specular::FlatTop;

/// Reflection of flat faces in one direction, above a mirror.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ghosts {
    /// Shift of a return trip through the glass, `[wavelength]`, and through the air above it, mm.
    glass_mm: Vec<[f64; 2]>,
    air_mm: [f64; 2],
    /// Reflectance of the face, its transmittance squared times the reflectance of the front above it, and
    /// the product of the reflectances between them, `[wavelength]`.
    face: Vec<[f64; 3]>,
}

impl Ghosts {
    /// Prepares the return of a face in this direction, and of a front above it.
    pub(super) fn new(panel: &Panel, heights: Heights, face: &FlatTop, beta: Beta) -> Option<Self> {
        if panel.single_pass {
            return None;
        }
        let of = |bin: usize| {
            let front = panel.front.reflectance_below[bin];
            [face.below[bin], face.t[bin].powi(2) * front, face.above[bin] * front]
        };
        let glass = |index: &f64| displacement(beta, 2.0 * heights.glass_mm, *index);
        Some(Self {
            glass_mm: panel.medium.index().iter().map(glass).collect(),
            air_mm: displacement(beta, 2.0 * heights.front_mm, 1.0),
            face: (0..panel.base.bins()).map(of).collect(),
        })
    }

    /// Returns the fraction that comes back of light that is modulated at this frequency, `[wavelength]`.
    pub(super) fn at(&self, f: [f64; 2]) -> Vec<Complex64> {
        let shifted = |way: &[f64; 2]| Complex64::cis(-2.0 * PI * (f[0] * way[0] + f[1] * way[1]));
        let air = shifted(&self.air_mm);
        let of = |(glass, [face, front, between]): (&[f64; 2], &[f64; 3])| {
            shifted(glass) * (face + front * air / (1.0 - between * air))
        };
        self.glass_mm.iter().zip(&self.face).map(of).collect()
    }
}

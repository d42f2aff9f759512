//! Coordinates of many colours and colours of many coordinates, in vectors of double precision.
//!
//! **What.** The same as [`GamutMapping::appearance`] and [`GamutMapping::xyz`] of each, within the rounding of a few operations: in
//! Oklab, all matrices between two non-linear steps are one. In CAM16-UCS, colours are converted one by one.

use pulp::NullaryFnOnce;

use super::GamutMapping;
use crate::matrix::{Matrix, product};
use crate::oklab::{FROM_CONES, FROM_LAB, TO_CONES, TO_LAB};
use crate::pictures::cube_root;
use crate::states::HalfSpace;
use crate::{D65_WHITE, Xyz};

/// Colours that are converted at once.
pub const SEVERAL: usize = 64;

/// Colours of coordinates, and their largest distance from a face of the hull towards the outside, relative to its brightest state.
#[derive(Debug, Clone)]
pub struct Placed {
    xyz: [[f64; SEVERAL]; 3],
    excess: [f64; SEVERAL],
}

impl Placed {
    /// The colour with this number.
    pub fn colour(&self, at: usize) -> Xyz {
        let [x, y, z] = [0, 1, 2].map(|k| self.xyz[k][at]);
        Xyz { x, y, z }
    }

    /// Its distance from the hull, relative to the brightest state, at most 0 inside; infinite if there is no such colour.
    pub fn excess(&self, at: usize) -> f64 {
        self.excess[at]
    }
}

/// Matrices between X, Y, Z and Oklab in units of the white's lightness.
#[derive(Debug, Clone)]
pub(super) struct Matrices {
    /// From a picture's X, Y, Z to cone responses, of which roots are taken, and on to coordinates.
    to_cones: Matrix,
    to_coordinates: Matrix,
    /// From coordinates to roots of cone responses, and on to X, Y, Z.
    to_roots: Matrix,
    to_xyz: Matrix,
    /// Cone responses of a grey for each Y, where lightness is that of the grey.
    of_grey: Option<[f64; 3]>,
}

impl GamutMapping {
    /// The matrices of Oklab; `None` in other spaces.
    pub(super) fn matrices(&self) -> Option<Matrices> {
        let [to_model, from_model] = self.space.oklab_matrices()?;
        let unit = self.unit();
        let scaled = |matrix: &Matrix, factor: f64| matrix.map(|row| row.map(|one| factor * one));
        let cones = product(&TO_CONES, &to_model);
        let grey = self.adaptation.apply(D65_WHITE).to_array();
        let of_grey = [0, 1, 2].map(|k| (0..3).map(|i| cones[k][i] * grey[i]).sum());
        Some(Matrices {
            to_cones: product(&cones, self.adaptation.matrix()),
            to_coordinates: scaled(&TO_LAB, 1.0 / unit),
            to_roots: scaled(&FROM_LAB, unit),
            to_xyz: product(&from_model, &FROM_CONES),
            of_grey: (self.hull.dimensions() <= 1).then_some(of_grey),
        })
    }

    /// [`appearance`](Self::appearance) of each colour, X, Y and Z relative to D65.
    pub fn appearances(&self, pixels: &[[f32; 3]], into: &mut [[f32; 3]]) {
        let Some(matrices) = &self.matrices else {
            for (to, [x, y, z]) in into.iter_mut().zip(pixels) {
                let colour = Xyz { x: f64::from(*x), y: f64::from(*y), z: f64::from(*z) };
                *to = self.appearance(colour).map(|one| one as f32);
            }
            return;
        };
        pulp::Arch::new().dispatch(Appearances { matrices, pixels, into });
    }

    /// Colours of up to [`SEVERAL`] coordinates, and how far from the hull they are.
    pub fn placed(&self, coordinates: &[[f32; 3]]) -> Placed {
        let mut placed = Placed { xyz: [[0.0; SEVERAL]; 3], excess: [f64::INFINITY; SEVERAL] };
        match &self.matrices {
            Some(matrices) => {
                let hull = self.hull.half_spaces();
                pulp::Arch::new().dispatch(Colours { matrices, hull, coordinates, into: &mut placed });
            }
            None => {
                for (at, one) in coordinates.iter().take(SEVERAL).enumerate() {
                    if let Some(colour) = self.xyz(one.map(f64::from)) {
                        (0..3).for_each(|k| placed.xyz[k][at] = colour.to_array()[k]);
                        placed.excess[at] = self.hull.excess(colour);
                    }
                }
            }
        }
        let size = 1.0 / self.hull.size();
        placed.excess.iter_mut().for_each(|one| *one *= size);
        placed
    }
}

struct Appearances<'a> {
    matrices: &'a Matrices,
    pixels: &'a [[f32; 3]],
    into: &'a mut [[f32; 3]],
}

impl NullaryFnOnce for Appearances<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { matrices, pixels, into } = self;
        for (pixels, into) in pixels.chunks(SEVERAL).zip(into.chunks_mut(SEVERAL)) {
            let mut planes = [[0.0; SEVERAL]; 3];
            for (at, pixel) in pixels.iter().enumerate() {
                (0..3).for_each(|k| planes[k][at] = f64::from(pixel[k]));
            }
            let luminances = planes[1];
            multiply(&matrices.to_cones, &mut planes);
            for plane in &mut planes {
                plane.iter_mut().for_each(|one| *one = root(*one));
            }
            multiply(&matrices.to_coordinates, &mut planes);
            if let Some(grey) = matrices.of_grey {
                let [lightness, ..] = matrices.to_coordinates;
                for (to, y) in planes[0].iter_mut().zip(luminances) {
                    *to = (0..3).map(|k| lightness[k] * root(grey[k] * y)).sum();
                }
            }
            for (at, to) in into.iter_mut().enumerate() {
                *to = [0, 1, 2].map(|k| planes[k][at] as f32);
            }
        }
    }
}

struct Colours<'a> {
    matrices: &'a Matrices,
    hull: &'a [HalfSpace],
    coordinates: &'a [[f32; 3]],
    into: &'a mut Placed,
}

impl NullaryFnOnce for Colours<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { matrices, hull, coordinates, into: Placed { xyz, excess } } = self;
        for (at, one) in coordinates.iter().take(SEVERAL).enumerate() {
            (0..3).for_each(|k| xyz[k][at] = f64::from(one[k]));
        }
        multiply(&matrices.to_roots, xyz);
        for plane in &mut *xyz {
            plane.iter_mut().for_each(|one| *one = *one * *one * *one);
        }
        multiply(&matrices.to_xyz, xyz);
        let [x, y, z] = &*xyz;
        let mut most = [f64::NEG_INFINITY; SEVERAL];
        for HalfSpace { normal, offset } in hull {
            for at in 0..SEVERAL {
                let out = normal[0] * x[at] + normal[1] * y[at] + normal[2] * z[at] - offset;
                most[at] = if out > most[at] { out } else { most[at] };
            }
        }
        for at in 0..SEVERAL {
            let is_finite = (x[at] + y[at] + z[at]).is_finite();
            excess[at] = if is_finite { most[at] } else { f64::INFINITY };
        }
    }
}

#[inline(always)]
fn multiply(matrix: &Matrix, planes: &mut [[f64; SEVERAL]; 3]) {
    let [one, two, three] = planes;
    for at in 0..SEVERAL {
        let values = [one[at], two[at], three[at]];
        let row = |k: usize| matrix[k][0] * values[0] + matrix[k][1] * values[1] + matrix[k][2] * values[2];
        (one[at], two[at], three[at]) = (row(0), row(1), row(2));
    }
}

/// Cube root, within a few units in the last place: one in single precision, and a step of Halley's method, which cubes its relative
/// error of 3e-7.
#[inline(always)]
fn root(value: f64) -> f64 {
    let size = value.abs();
    let first = f64::from(cube_root(size as f32));
    let cube = first * first * first;
    let root = first * (cube + 2.0 * size) / (2.0 * cube + size);
    if size > 0.0 { root.copysign(value) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::{DisplayColours, Intent, MapSpace, SourceSpace};
    use super::*;
    use crate::states::StateHull;

    #[test]
    fn roots_are_those_of_the_library() {
        for k in 0..4000 {
            let value = 10.0_f64.powf(7.0 * ((0.618_033_988_749 * k as f64).fract() - 0.7)) - 1e-4;
            assert!((root(value) / value.cbrt() - 1.0).abs() < 1e-15, "{value}");
        }
        assert_eq!(root(0.0), 0.0);
    }

    /// Many colours at once have the coordinates, the colours and the places of each alone; of inks, and of greys.
    #[test]
    fn several_colours_are_those_of_each() {
        let xyz = |[x, y, z]: [f64; 3]| Xyz { x, y, z };
        let inks =
            [[0.04, 0.04, 0.03], [0.6, 0.62, 0.2], [0.5, 0.5, 0.05], [0.2, 0.1, 0.02], [0.05, 0.06, 0.1]];
        for states in [&inks[..], &inks[..2]] {
            for space in [
                MapSpace::Oklab,
                MapSpace::Cam16Ucs(crate::Viewing {
                    adapting_luminance_cd_m2: 20.0,
                    background: 0.2,
                    surround: crate::Surround::Average,
                }),
            ] {
                let states: Vec<Xyz> = states.iter().copied().map(xyz).collect();
                let display = DisplayColours {
                    white: states[1],
                    black: states[0],
                    perfect_white: xyz([1.0, 1.0, 0.35]),
                };
                let hull = StateHull::new(&states).unwrap();
                let mapping =
                    GamutMapping::new(hull, display, SourceSpace::Srgb, Intent::Natural, space).unwrap();
                let part = |k: usize, step: f64| (step * k as f64).fract();
                let pixels: Vec<[f32; 3]> = (0..150)
                    .map(|k| {
                        [part(k, 0.618_034), part(k, 0.414_214), part(k, 0.732_051)].map(|one| one as f32)
                    })
                    .collect();
                let mut found = vec![[0.0; 3]; pixels.len()];
                mapping.appearances(&pixels, &mut found);
                for (pixel, found) in pixels.iter().zip(&found) {
                    let expected = mapping.appearance(xyz(pixel.map(f64::from)));
                    assert!(
                        expected.iter().zip(found).all(|(a, b)| (a - f64::from(*b)).abs() < 1e-6),
                        "{expected:?} {found:?}"
                    );
                }
                for chunk in found.chunks(SEVERAL) {
                    let placed = mapping.placed(chunk);
                    for (at, one) in chunk.iter().enumerate() {
                        let Some(expected) = mapping.xyz(one.map(f64::from)) else { continue };
                        let far = (placed.colour(at) - expected).to_array();
                        assert!(far.iter().all(|one| one.abs() < 1e-12), "{far:?}");
                        let excess = mapping.hull().excess(expected) / mapping.hull().size();
                        assert!((placed.excess(at) - excess).abs() < 1e-12);
                    }
                }
            }
        }
    }
}

//! CIELAB and CIEDE2000 of pictures: the same numbers as of single colours, without trigonometric functions
//! where colours are not blue.

use std::f64::consts::PI;

use super::Picture;
use crate::{ColourError, Lab, Xyz};

impl Picture {
    /// Replaces X, Y and Z by CIELAB.
    ///
    /// # Errors
    ///
    /// [`ColourError::NoWhite`] unless all values of the white are positive.
    pub fn into_lab(mut self, white: Xyz) -> Result<Self, ColourError> {
        white.lab(white).ok_or(ColourError::NoWhite)?;
        self.change_to_lab(white);
        Ok(self)
    }

    /// Replaces X, Y and Z by CIELAB, relative to a white whose values are positive.
    pub(super) fn change_to_lab(&mut self, white: Xyz) {
        let [nx, ny, nz] = white.to_array().map(|one| 1.0 / one);
        self.change(|[x, y, z]| {
            let (x, y, z) = (root(x * nx), root(y * ny), root(z * nz));
            [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
        });
    }

    /// CIEDE2000 of each pixel of two pictures in CIELAB.
    ///
    /// # Errors
    ///
    /// [`ColourError::PictureSizes`] if the sizes differ.
    pub fn delta_e_2000(&self, other: &Self) -> Result<Vec<f64>, ColourError> {
        self.require_same_size(other)?;
        let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
        Ok(self.pixels().zip(other.pixels()).map(|(one, other)| delta_e_2000(lab(one), lab(other))).collect())
    }
}

/// Ratio to the white below which the cube root is replaced by a straight line.
const TOE: f64 = 216.0 / 24_389.0;

/// Cube root of a ratio to the white, linear below [`TOE`].
fn root(ratio: f64) -> f64 {
    if ratio > TOE { cube_root(ratio) } else { 841.0 / 108.0 * ratio + 16.0 / 116.0 }
}

/// Cube root of a normal positive number, within 1e-13 of it: a third of its exponent, and two steps of
/// Halley's method, which each cube the relative error of 0.04.
fn cube_root(value: f64) -> f64 {
    let first = f64::from_bits(value.to_bits() / 3 + 0x2A9F_7893_0000_0000);
    (0..2).fold(first, |root, _| {
        let cube = root * root * root;
        root * (cube + 2.0 * value) / (2.0 * cube + value)
    })
}

pub(super) const COS_30: f64 = 0.866_025_403_784_438_6;
pub(super) const COS_6: f64 = 0.994_521_895_368_273_3;
pub(super) const SIN_6: f64 = 0.104_528_463_267_653_46;
pub(super) const COS_63: f64 = 0.453_990_499_739_546_8;
pub(super) const SIN_63: f64 = 0.891_006_524_188_367_9;
/// Of 275 degrees.
pub(super) const COS_BLUE: f64 = 0.087_155_742_747_658_17;
pub(super) const SIN_BLUE: f64 = -0.996_194_698_091_745_5;

/// [`Lab::delta_e_2000`] from the cosine and sine of the mean hue, which is the direction of the sum of both
/// hues' unit vectors.
fn delta_e_2000(one: Lab, other: Lab) -> f64 {
    const FAR: f64 = 6_103_515_625.0; // 25^7
    let weight = |chroma: f64| {
        let square = chroma * chroma;
        let seventh = square * square * square * chroma;
        (seventh / (seventh + FAR)).sqrt()
    };
    let length = |a: f64, b: f64| (a * a + b * b).sqrt();
    let stretch = 1.5 - 0.5 * weight(0.5 * (length(one.a, one.b) + length(other.a, other.b)));
    let (a1, a2) = (one.a * stretch, other.a * stretch);
    let (c1, c2) = (length(a1, one.b), length(a2, other.b));
    let (u, v) = (a1 * c2 + a2 * c1, one.b * c2 + other.b * c1);
    let sum = length(u, v);
    // Grey, or opposite hues, whose mean is a convention.
    let has_mean = sum > 1e-5 * c1 * c2;
    if !has_mean {
        return one.delta_e_2000(other);
    }
    let (cos, sin) = (u / sum, v / sum);
    let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * cos * sin);
    let (cos3, sin3) = (cos2 * cos - sin2 * sin, sin2 * cos + cos2 * sin);
    let (cos4, sin4) = (cos2 * cos2 - sin2 * sin2, 2.0 * cos2 * sin2);
    let t = 1.0 - 0.17 * (COS_30 * cos + 0.5 * sin) + 0.24 * cos2 + 0.32 * (COS_6 * cos3 - SIN_6 * sin3)
        - 0.2 * (COS_63 * cos4 + SIN_63 * sin4);
    let (l, c) = (0.5 * (one.l + other.l) - 50.0, 0.5 * (c1 + c2));
    let lightness = (other.l - one.l) / (1.0 + 0.015 * l * l / (20.0 + l * l).sqrt());
    let chroma = (c2 - c1) / (1.0 + 0.045 * c);
    // 2 sqrt(c1 c2) sin(turn / 2): the vector product is c1 c2 sin(turn), and the sum 2 c1 c2 cos(turn / 2).
    let turned = a1 * other.b - a2 * one.b;
    let hue = 2.0 * (c1 * c2).sqrt() * turned / (sum * (1.0 + 0.015 * c * t));
    let plain = lightness * lightness + chroma * chroma + hue * hue;
    // For blue colours, hue and chroma differences interact: by less than 1e-8 beyond 110 degrees.
    let (blue_cos, blue_sin) = (cos * COS_BLUE + sin * SIN_BLUE, sin * COS_BLUE - cos * SIN_BLUE);
    let cross = if blue_cos > BEYOND {
        let mut degrees = blue_sin.atan2(blue_cos) * (180.0 / PI);
        // Hues of 0 to 360 degrees: red is far from blue.
        if degrees >= 85.0 {
            degrees -= 360.0;
        }
        let rotation = 30.0_f64.to_radians() * (-(degrees / 25.0).powi(2)).exp();
        -2.0 * weight(c) * (2.0 * rotation).sin()
    } else {
        0.0
    };
    (plain + cross * chroma * hue).sqrt()
}

/// Cosine of 110 degrees.
const BEYOND: f64 = -0.342_020_143_325_668_7;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D65_WHITE;

    /// Values from -1 to 1 that repeat only after a long time.
    fn spread(k: usize, step: f64) -> f64 {
        2.0 * (step * k as f64).fract() - 1.0
    }

    #[test]
    fn cube_roots_are_those_of_the_library() {
        for k in 0..4000 {
            let value = 10.0_f64.powf(6.0 * spread(k, 0.618_033_988_749));
            let ratio = cube_root(value) / value.cbrt();
            assert!((ratio - 1.0).abs() < 1e-13, "{value}: {ratio}");
        }
    }

    #[test]
    fn lab_of_pictures_is_that_of_colours() {
        let values = |step: f64| (0..999).map(|k| 0.6 + 0.62 * spread(k, step)).collect::<Vec<_>>();
        let picture = Picture::new(3, [values(0.414_2), values(0.732_05), values(0.236_07)]).unwrap();
        let labs = picture.clone().into_lab(D65_WHITE).unwrap();
        for ([x, y, z], [l, a, b]) in picture.pixels().zip(labs.pixels()) {
            let expected = Xyz { x, y, z }.lab(D65_WHITE).unwrap();
            let far = (l - expected.l).abs().max((a - expected.a).abs()).max((b - expected.b).abs());
            assert!(far < 1e-11, "{x} {y} {z}: {far}");
        }
        assert!(matches!(picture.into_lab(D65_WHITE * 0.0), Err(ColourError::NoWhite)));
    }

    /// Colours of all hues and chromas near and far from each other, greys and equal colours.
    #[test]
    fn differences_of_pictures_are_those_of_colours() {
        let colour = |k: usize, steps: [f64; 3], chroma: f64| Lab {
            l: 50.0 + 50.0 * spread(k, steps[0]),
            a: chroma * spread(k, steps[1]),
            b: chroma * spread(k, steps[2]),
        };
        for k in 0..60_000 {
            let one = colour(k, [0.414_213_56, 0.732_050_8, 0.236_067_98], 128.0);
            let near =
                colour(k, [0.645_751_31, 0.316_624_79, 0.605_551_28], 10.0_f64.powi((k % 7) as i32 - 5));
            let near = Lab { l: one.l + near.l / 50.0 - 1.0, a: one.a + near.a, b: one.b + near.b };
            let far = colour(k, [0.645_751_31, 0.316_624_79, 0.605_551_28], 128.0);
            let opposite = Lab { a: -one.a, b: -one.b, ..one };
            for other in [near, far, opposite, one, Lab { a: 0.0, b: 0.0, ..one }] {
                let (found, expected) = (delta_e_2000(one, other), one.delta_e_2000(other));
                assert!(
                    (found - expected).abs() < 1e-8 * (1.0 + expected),
                    "{one:?} {other:?}: {found} {expected}"
                );
            }
        }
        let grey = Lab { l: 50.0, a: 0.0, b: 0.0 };
        assert!(
            (delta_e_2000(grey, Lab { l: 60.0, ..grey }) - grey.delta_e_2000(Lab { l: 60.0, ..grey })).abs()
                < 1e-12
        );
        assert!(delta_e_2000(grey, Lab { a: f64::NAN, ..grey }).is_nan());
    }

    #[test]
    fn pictures_of_other_sizes_are_refused() {
        let picture = |columns: usize| Picture::new(columns, [0; 3].map(|_| vec![0.0; 4])).unwrap();
        assert!(matches!(picture(2).delta_e_2000(&picture(4)), Err(ColourError::PictureSizes { .. })));
    }
}

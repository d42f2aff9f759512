//! sRGB colours for figures on a screen.
//!
//! **What.** The linear sRGB matrix and the sRGB transfer function (IEC
//! 61966-2-1 with its amendment 1), clipped to the sRGB gamut. If the scene's light is not D65, the colour of a surface is
//! first adapted to D65 by the Bradford transform (ICC.1:2022, annex E), so that
//! paper is shown as white.

use crate::{D65_WHITE, Xyz};

/// Matrix from relative X, Y, Z to linear sRGB.
const SRGB: [[f64; 3]; 3] = [
    [3.240_625_5, -1.537_208_0, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];
/// Matrix from X, Y, Z to the Bradford cone responses.
const BRADFORD: [[f64; 3]; 3] =
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
/// Inverse of [`BRADFORD`].
const BRADFORD_INVERSE: [[f64; 3]; 3] = [
    [0.986_992_905_466_7, -0.147_054_256_420_99, 0.159_962_651_663_73],
    [0.432_305_269_723_39, 0.518_360_271_536_78, 0.049_291_228_212_86],
    [-0.008_528_664_575_18, 0.040_042_821_654_09, 0.968_486_695_787_55],
];

impl Xyz {
    /// Converts relative values under D65 to linear sRGB; components outside 0 to 1 are out of gamut.
    pub fn linear_srgb(self) -> [f64; 3] {
        times(&SRGB, self)
    }

    /// Converts relative values under D65 to gamma-encoded sRGB bytes, clipped to the gamut.
    pub fn srgb_clipped(self) -> [u8; 3] {
        // `as` converts NaN to 0 and saturates, so that noise cannot wrap around.
        self.linear_srgb().map(|value| (255.0 * encoded(value)).round() as u8)
    }

    /// Computes the corresponding surface colour under D65 (Bradford chromatic adaptation).
    ///
    /// `self` and `white` must be on the same scale; the result is relative to [`D65_WHITE`].
    /// Returns `None` unless all cone responses of the white are positive.
    pub fn adapted_to_d65(self, white: Self) -> Option<Self> {
        let (from, to) = (times(&BRADFORD, white), times(&BRADFORD, D65_WHITE));
        let cones = times(&BRADFORD, self);
        from.iter().all(|cone| *cone > 0.0).then(|| {
            let [x, y, z] = [0, 1, 2].map(|i| cones[i] * to[i] / from[i]);
            let [x, y, z] = times(&BRADFORD_INVERSE, Self { x, y, z });
            Self { x, y, z }
        })
    }

    /// Computes the "RGB" rows of Feng 2012, table 5.1: 255 times the linear sRGB matrix
    /// applied to the chromaticity (x, y, z), clipped, without gamma. `None` without light.
    ///
    /// The values show hue without lightness; they are not meant for display.
    pub fn hue_rgb(self) -> Option<[f64; 3]> {
        let sum = self.x + self.y + self.z;
        (sum > 0.0).then(|| (self * (1.0 / sum)).linear_srgb().map(|v| (255.0 * v).clamp(0.0, 255.0)))
    }
}

/// Encodes a linear component by the sRGB transfer function.
fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

fn times(matrix: &[[f64; 3]; 3], xyz: Xyz) -> [f64; 3] {
    matrix.map(|[a, b, c]| a * xyz.x + b * xyz.y + c * xyz.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_black_grey_and_red_have_their_known_bytes() {
        assert_eq!(D65_WHITE.srgb_clipped(), [255; 3]);
        assert_eq!((D65_WHITE * 0.0).srgb_clipped(), [0; 3]);
        // Middle grey: 18.4 % of white is L* = 50, sRGB 119.
        assert_eq!((D65_WHITE * 0.184_187).srgb_clipped(), [119; 3]);
        // Red primary: Y = 0.2126 at x = 0.64, y = 0.33.
        assert_eq!(Xyz { x: 0.4124, y: 0.2126, z: 0.0193 }.srgb_clipped(), [255, 0, 0]);
    }

    #[test]
    fn out_of_gamut_colours_are_clipped() {
        assert_eq!(Xyz { x: -0.1, y: 2.0, z: f64::NAN }.srgb_clipped()[2], 0);
        assert_eq!(Xyz { x: -1e-9, y: -1e-9, z: -1e-9 }.srgb_clipped(), [0; 3]);
    }

    /// Lindbloom's example: the Bradford transform maps the white of illuminant A to D65, and D65 to itself.
    #[test]
    fn adapted_paper_is_white_in_any_light() {
        let a = Xyz { x: 1.0985, y: 1.0, z: 0.35585 };
        for white in [a, D65_WHITE, Xyz { x: 1.0, y: 1.0, z: 1.0 }] {
            let seen = (white * 0.3).adapted_to_d65(white).unwrap();
            for (got, expected) in seen.to_array().into_iter().zip((D65_WHITE * 0.3).to_array()) {
                assert!((got - expected).abs() < 1e-9, "{seen:?}");
            }
        }
        assert_eq!(a.adapted_to_d65(Xyz { x: 0.0, y: 0.0, z: 0.0 }), None);
    }
}

//! sRGB colours for figures on a screen.
//!
//! **What.** The linear sRGB matrix and the sRGB transfer function (IEC 61966-2-1 with its amendment 1), clipped to the sRGB gamut. If the
//! scene's light is not D65, the colour of a surface is first [adapted to D65](Xyz::adapted_to_d65), so that paper is shown as white.

use crate::Xyz;
use crate::matrix::{Matrix, times};

/// Matrix from relative X, Y, Z to linear sRGB.
const SRGB: Matrix = [
    [3.240_625_5, -1.537_208_0, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];

impl Xyz {
    /// Converts relative values under D65 to linear sRGB; components outside 0 to 1 are out of gamut.
    pub fn linear_srgb(self) -> [f64; 3] {
        times(&SRGB, self.to_array())
    }

    /// Converts relative values under D65 to gamma-encoded sRGB, 0 to 1, clipped to the gamut.
    pub fn srgb_encoded(self) -> [f64; 3] {
        // `max` replaces NaN by 0, which `clamp` does not.
        #[allow(clippy::manual_clamp, reason = "NaN")]
        self.linear_srgb().map(|value| encoded(value).max(0.0).min(1.0))
    }

    /// Converts relative values under D65 to gamma-encoded sRGB bytes, clipped to the gamut.
    pub fn srgb_clipped(self) -> [u8; 3] {
        self.srgb_encoded().map(|value| (255.0 * value).round() as u8)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D65_WHITE;

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
}

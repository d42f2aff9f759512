//! Oklab: a colour space of surfaces in which lines of constant hue are straight, blue included.
//!
//! **What.** Lightness L (1 for white), and a, b: from green to red and from blue to yellow. Hue is the
//! angle, chroma the distance from the grey axis. A step of 0.02 is about one just noticeable difference.
//!
//! **Parameters.** None: the colour must be relative to D65, with Y = 1 for white. A colour in another light
//! is first adapted ([`Xyz::adapted_to_d65`]).
//!
//! **Range.** Any real colours; negative cone responses, as of noise, have negative roots.
//! **Limits.** No viewing conditions: lightness and chroma do not depend on luminance or surround, as those
//! of CIECAM16 do. The rounded matrices leave a chroma of 4e-5 to [`D65_WHITE`](crate::D65_WHITE).
//!
//! **Source.** B. Ottosson, *A perceptual color space for image processing* (2020),
//! bottosson.github.io/posts/oklab, with its matrices of January 2021.

use crate::Xyz;
use crate::matrix::{Matrix, inverse, times};

/// Matrix from X, Y, Z to the cone responses.
pub(crate) const TO_CONES: Matrix = [
    [0.818_933_010_1, 0.361_866_742_4, -0.128_859_713_7],
    [0.032_984_543_6, 0.929_311_871_5, 0.036_145_638_7],
    [0.048_200_301_8, 0.264_366_269_1, 0.633_851_707_0],
];
/// Matrix from the cube roots of the cone responses to L, a, b.
pub(crate) const TO_LAB: Matrix = [
    [0.210_454_255_3, 0.793_617_785_0, -0.004_072_046_8],
    [1.977_998_495_1, -2.428_592_205_0, 0.450_593_709_9],
    [0.025_904_037_1, 0.782_771_766_2, -0.808_675_766_0],
];
pub(crate) const FROM_CONES: Matrix = inverse(&TO_CONES);
pub(crate) const FROM_LAB: Matrix = inverse(&TO_LAB);

/// A colour in Oklab.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oklab {
    /// Lightness L, 1 for white.
    pub l: f64,
    /// Green (negative) to red (positive).
    pub a: f64,
    /// Blue (negative) to yellow (positive).
    pub b: f64,
}

impl Xyz {
    /// Converts values relative to D65 (Y = 1 for white) to Oklab.
    pub fn oklab(self) -> Oklab {
        let [l, a, b] = times(&TO_LAB, times(&TO_CONES, self.to_array()).map(f64::cbrt));
        Oklab { l, a, b }
    }
}

impl Oklab {
    /// Converts to X, Y, Z relative to D65.
    pub fn xyz(self) -> Xyz {
        let roots = times(&FROM_LAB, [self.l, self.a, self.b]);
        let [x, y, z] = times(&FROM_CONES, roots.map(|root| root * root * root));
        Xyz { x, y, z }
    }

    /// Chroma: the distance from the grey axis.
    pub fn chroma(self) -> f64 {
        self.a.hypot(self.b)
    }

    /// Hue angle, degrees, 0 to 360. It has no meaning for greys.
    pub fn hue_deg(self) -> f64 {
        self.b.atan2(self.a).to_degrees().rem_euclid(360.0)
    }

    /// Colour difference: the Euclidean distance.
    pub fn distance(self, other: Self) -> f64 {
        (self.l - other.l).hypot(self.a - other.a).hypot(self.b - other.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D65_WHITE;

    /// The table of Ottosson's page ("Table of example XYZ and Oklab pairs").
    #[test]
    fn oklab_equals_the_published_table() {
        for (xyz, lab) in [
            ([0.950, 1.000, 1.089], [1.000, 0.000, 0.000]),
            ([1.000, 0.000, 0.000], [0.450, 1.236, -0.019]),
            ([0.000, 1.000, 0.000], [0.922, -0.671, 0.263]),
            ([0.000, 0.000, 1.000], [0.153, -1.415, -0.449]),
        ] {
            let [x, y, z] = xyz;
            let Oklab { l, a, b } = Xyz { x, y, z }.oklab();
            let ours = [l, a, b];
            assert!(ours.iter().zip(lab).all(|(o, t)| (o - t).abs() < 5.1e-4), "{xyz:?}: {ours:?}");
        }
    }

    #[test]
    fn xyz_of_oklab_is_the_colour_itself() {
        for xyz in [[0.2, 0.1, 0.7], [0.9, 1.0, 0.3], [1e-6, 2e-6, 1e-6], [-0.01, 0.02, 1.3], [0.0; 3]] {
            let [x, y, z] = xyz;
            let back = Xyz { x, y, z }.oklab().xyz().to_array();
            assert!(back.iter().zip(xyz).all(|(b, e)| (b - e).abs() < 1e-14), "{xyz:?}: {back:?}");
        }
    }

    #[test]
    fn white_has_no_chroma_and_yellow_a_hue_of_110_degrees() {
        let white = D65_WHITE.oklab();
        assert!((white.l - 1.0).abs() < 1e-4 && white.chroma() < 1e-4, "{white:?}");
        // sRGB's yellow has the hue 109.77 and the chroma 0.211.
        let yellow = Xyz { x: 0.7700, y: 0.9278, z: 0.1385 }.oklab();
        assert!(
            (yellow.hue_deg() - 109.77).abs() < 0.05 && (yellow.chroma() - 0.211).abs() < 1e-3,
            "{yellow:?}"
        );
        assert!((yellow.distance(white) - (yellow.chroma().powi(2) + 0.032_f64.powi(2)).sqrt()).abs() < 1e-3);
    }
}

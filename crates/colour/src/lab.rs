//! CIELAB, CIELUV and colour differences.
//!
//! **What.** CIE 15:2018, eq. 8.3 to 8.11 and 8.27 to 8.29, with the linear toe below
//! (24/116)^3 = 0.008856 of the white (small negative values are accepted, too), and
//! CIEDE2000 (ISO/CIE 11664-6).
//! **Range.** Surface colours in a light of moderate chroma. Black states of displays are
//! on the linear toe, where a* and b* amplify noise.

use std::f64::consts::{PI, TAU};

use crate::{UvPrime, Xyz};

/// Ratio to the white below which the cube root is replaced by a straight line: (24/116)^3.
const TOE: f64 = 0.008_856_451_679_035_631;

/// CIE 1976 L\*, a\*, b\* (CIELAB) of a colour relative to a white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lab {
    /// Lightness L\*, 0 to 100.
    pub l: f64,
    /// a\*: green (negative) to red (positive).
    pub a: f64,
    /// b\*: blue (negative) to yellow (positive).
    pub b: f64,
}

/// CIE 1976 L\*, u\*, v\* (CIELUV) of a colour relative to a white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Luv {
    /// Lightness L\*, 0 to 100: the same as that of CIELAB.
    pub l: f64,
    /// u* = 13 L* (u' - u'_n).
    pub u: f64,
    /// v* = 13 L* (v' - v'_n).
    pub v: f64,
}

impl Lab {
    /// Computes CIELUV from this lightness and the chromaticities of the colour (`uv`) and of the white.
    pub fn luv(self, uv: UvPrime, white: UvPrime) -> Luv {
        let scale = 13.0 * self.l;
        Luv { l: self.l, u: scale * (uv.u - white.u), v: scale * (uv.v - white.v) }
    }
}

impl Xyz {
    /// Computes CIELAB relative to `white`; both must be on the same scale.
    ///
    /// Returns `None` unless all three values of the white are positive: in pure red
    /// light, b* is not defined.
    pub fn lab(self, white: Self) -> Option<Lab> {
        let usable = white.to_array().into_iter().all(|value| value > 0.0 && value.is_finite());
        usable.then(|| {
            let (x, y, z) = (root(self.x / white.x), root(self.y / white.y), root(self.z / white.z));
            Lab { l: 116.0 * y - 16.0, a: 500.0 * (x - y), b: 200.0 * (y - z) }
        })
    }
}

impl Lab {
    /// Computes the tristimulus values of this colour relative to `white`, on the scale of `white` (CIE
    /// 15:2018, annex D).
    pub fn xyz(self, white: Xyz) -> Xyz {
        let y = (self.l + 16.0) / 116.0;
        let (x, z) = (y + self.a / 500.0, y - self.b / 200.0);
        Xyz { x: white.x * cube(x), y: white.y * cube(y), z: white.z * cube(z) }
    }
}

/// Inverse of [`root`].
fn cube(root: f64) -> f64 {
    if root > 24.0 / 116.0 { root.powi(3) } else { (root - 16.0 / 116.0) * 108.0 / 841.0 }
}

/// Cube root of a ratio to the white, linear below [`TOE`].
fn root(ratio: f64) -> f64 {
    if ratio > TOE { ratio.cbrt() } else { 841.0 / 108.0 * ratio + 16.0 / 116.0 }
}

impl Lab {
    /// CIE 1976 colour difference Delta E*ab: the Euclidean distance in CIELAB.
    pub fn delta_e_1976(self, other: Self) -> f64 {
        (self.l - other.l).hypot(self.a - other.a).hypot(self.b - other.b)
    }

    /// CIEDE2000 colour difference with kL = kC = kH = 1; NaN if a value is not finite.
    pub fn delta_e_2000(self, other: Self) -> f64 {
        let weight = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25_f64.powi(7))).sqrt();
        let mean = |one: f64, two: f64| (one + two) / 2.0;
        let length = |a: f64, b: f64| (a * a + b * b).sqrt();
        // a* is scaled up if both colours are nearly grey.
        let stretch = 0.5 * (1.0 - weight(mean(length(self.a, self.b), length(other.a, other.b))));
        let [(c1, h1), (c2, h2)] = [self, other].map(|colour| {
            let a = colour.a * (1.0 + stretch);
            (length(a, colour.b), colour.b.atan2(a).rem_euclid(TAU))
        });
        let (l, c) = (mean(self.l, other.l), mean(c1, c2));
        // The smaller of the two hue differences, and its mean hue.
        let (turn, h) = match h2 - h1 {
            turn if turn > PI => (turn - TAU, (mean(h1 + h2, TAU)).rem_euclid(TAU)),
            turn if turn < -PI => (turn + TAU, (mean(h1 + h2, TAU)).rem_euclid(TAU)),
            turn => (turn, mean(h1, h2)),
        };
        let degrees = f64::to_radians;
        let t = 1.0 - 0.17 * (h - degrees(30.0)).cos()
            + 0.24 * (2.0 * h).cos()
            + 0.32 * (3.0 * h + degrees(6.0)).cos()
            - 0.20 * (4.0 * h - degrees(63.0)).cos();
        let lightness =
            (other.l - self.l) / (1.0 + (0.015 * (l - 50.0).powi(2)) / (20.0 + (l - 50.0).powi(2)).sqrt());
        let chroma = (c2 - c1) / (1.0 + 0.045 * c);
        let hue = 2.0 * (c1 * c2).sqrt() * (turn / 2.0).sin() / (1.0 + 0.015 * c * t);
        // For blue colours, hue and chroma differences interact.
        let rotation = degrees(30.0) * (-((h.to_degrees() - 275.0) / 25.0).powi(2)).exp();
        let cross = -(2.0 * weight(c)) * (2.0 * rotation).sin();
        (lightness.powi(2) + chroma.powi(2) + hue.powi(2) + cross * chroma * hue).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D65_WHITE;

    #[test]
    fn white_has_lightness_100_and_black_0() {
        let white = Xyz { x: 0.9, y: 1.0, z: 0.3 };
        let lab = white.lab(white).unwrap();
        assert!((lab.l - 100.0).abs() < 1e-12 && lab.a.abs() < 1e-12 && lab.b.abs() < 1e-12);
        let black = (white * 0.0).lab(white).unwrap();
        assert!(black.l.abs() < 1e-12 && black.a.abs() < 1e-12);
    }

    #[test]
    fn colour_of_lab_is_the_colour() {
        for y in [-0.004, 0.0, 0.003, 0.2, 1.3] {
            let colour = Xyz { x: 0.7 * y, y, z: 0.4 * y };
            let again = colour.lab(D65_WHITE).unwrap().xyz(D65_WHITE);
            assert!(colour.distance(again) < 1e-14, "{again:?}");
        }
    }

    /// On the toe L* = 903.3 Y/Yn, which is linear through zero.
    #[test]
    fn lightness_of_negative_noise_is_linear() {
        for y in [-0.004, -1e-6, 0.0, 0.004] {
            let lab = (D65_WHITE * y).lab(D65_WHITE).unwrap();
            assert!((lab.l - 24_389.0 / 27.0 * y).abs() < 1e-9, "{lab:?}");
        }
    }

    /// colour-science's example for `XYZ_to_Luv`: XYZ = 0.20654, 0.12197, 0.05137 under its D65.
    #[test]
    fn luv_equals_the_published_example() {
        let white = Xyz { x: 0.9504559270516716, y: 1.0, z: 1.0890577507598784 };
        let seen = Xyz { x: 0.20654008, y: 0.12197225, z: 0.05136952 };
        let luv = seen.lab(white).unwrap().luv(seen.uv_prime().unwrap(), white.uv_prime().unwrap());
        for (ours, theirs) in [luv.l, luv.u, luv.v].into_iter().zip([41.52787529, 96.83626054, 17.75210149]) {
            assert!((ours - theirs).abs() < 1e-6, "{luv:?}");
        }
    }

    #[test]
    fn lab_relative_to_a_white_without_blue_is_undefined() {
        assert_eq!(D65_WHITE.lab(Xyz { x: 1.0, y: 1.0, z: 0.0 }), None);
        assert_eq!(D65_WHITE.lab(Xyz { x: 1.0, y: f64::NAN, z: 1.0 }), None);
    }

    /// Sharma, Wu, Dalal, Color Res. Appl. 30, 21 (2005), table 1, all 34 pairs: L*, a*, b* twice, and the
    /// difference.
    #[test]
    fn delta_e_2000_equals_the_published_table() {
        for [l1, a1, b1, l2, a2, b2, expected] in SHARMA {
            let (one, two) = (Lab { l: l1, a: a1, b: b1 }, Lab { l: l2, a: a2, b: b2 });
            for found in [one.delta_e_2000(two), two.delta_e_2000(one)] {
                assert!(
                    (found - expected).abs() < 5e-5 + 1e-9,
                    "{one:?} {two:?}: {found}, expected {expected}"
                );
            }
            assert_eq!(one.delta_e_2000(one), 0.0);
        }
        let dark = Lab { l: f64::NAN, a: 0.0, b: 0.0 };
        assert!(dark.delta_e_2000(Lab { l: 50.0, ..dark }).is_nan());
    }

    #[rustfmt::skip]
    const SHARMA: [[f64; 7]; 34] = [
        [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485, 2.0425],
        [50.0, 3.1571, -77.2803, 50.0, 0.0, -82.7485, 2.8615],
        [50.0, 2.8361, -74.0200, 50.0, 0.0, -82.7485, 3.4412],
        [50.0, -1.3802, -84.2814, 50.0, 0.0, -82.7485, 1.0],
        [50.0, -1.1848, -84.8006, 50.0, 0.0, -82.7485, 1.0],
        [50.0, -0.9009, -85.5211, 50.0, 0.0, -82.7485, 1.0],
        [50.0, 0.0, 0.0, 50.0, -1.0, 2.0, 2.3669],
        [50.0, -1.0, 2.0, 50.0, 0.0, 0.0, 2.3669],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0009, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0010, 7.1792],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0011, 7.2195],
        [50.0, 2.4900, -0.0010, 50.0, -2.4900, 0.0012, 7.2195],
        [50.0, -0.0010, 2.4900, 50.0, 0.0009, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0010, -2.4900, 4.8045],
        [50.0, -0.0010, 2.4900, 50.0, 0.0011, -2.4900, 4.7461],
        [50.0, 2.5, 0.0, 50.0, 0.0, -2.5, 4.3065],
        [50.0, 2.5, 0.0, 73.0, 25.0, -18.0, 27.1492],
        [50.0, 2.5, 0.0, 61.0, -5.0, 29.0, 22.8977],
        [50.0, 2.5, 0.0, 56.0, -27.0, -3.0, 31.9030],
        [50.0, 2.5, 0.0, 58.0, 24.0, 15.0, 19.4535],
        [50.0, 2.5, 0.0, 50.0, 3.1736, 0.5854, 1.0],
        [50.0, 2.5, 0.0, 50.0, 3.2972, 0.0, 1.0],
        [50.0, 2.5, 0.0, 50.0, 1.8634, 0.5757, 1.0],
        [50.0, 2.5, 0.0, 50.0, 3.2592, 0.3350, 1.0],
        [60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644],
        [63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630],
        [61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731],
        [35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645],
        [22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373],
        [36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146],
        [90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441],
        [90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381],
        [6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377],
        [2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082],
    ];
}

//! CIELAB, CIELUV and colour differences.
//!
//! **What.** CIE 15:2018, eq. 8.3 to 8.11 and 8.27 to 8.29, with the linear toe below
//! (24/116)^3 = .008856 of the white (it also takes small negative values), and
//! CIEDE2000 (ISO/CIE 11664-6). CIELAB and CIEDE2000 are those of the `colorimetry` crate.
//! **Range.** Surface colours in a light of moderate colour. Displays far below
//! their white (black states) sit on the toe, where a* and b* follow noise.

use colorimetry::lab::CieLab;
use colorimetry::observer::Observer::Cie1931;
use colorimetry::xyz::{RelXYZ, XYZ};

use crate::{D65_WHITE, UvPrime, Xyz};

/// L*, a*, b*.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lab {
    /// Lightness, 0 to 100.
    pub l: f64,
    /// Green (negative) to red.
    pub a: f64,
    /// Blue (negative) to yellow.
    pub b: f64,
}

/// u* and v* of CIELUV, whose lightness is that of CIELAB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Luv {
    /// Lightness, 0 to 100.
    pub l: f64,
    /// u* = 13 L* (u' - u'_n).
    pub u: f64,
    /// v* = 13 L* (v' - v'_n).
    pub v: f64,
}

impl Lab {
    /// CIELUV of a colour with this lightness at `uv`, in a light of chromaticity `white`.
    pub fn luv(self, uv: UvPrime, white: UvPrime) -> Luv {
        let scale = 13.0 * self.l;
        Luv { l: self.l, u: scale * (uv.u - white.u), v: scale * (uv.v - white.v) }
    }
}

impl Xyz {
    /// CIELAB against `white`, both on one scale.
    ///
    /// `None` unless all three values of the white are positive: in a pure red
    /// light, b* is not defined.
    pub fn lab(self, white: Self) -> Option<Lab> {
        let usable = white.to_array().into_iter().all(|value| value > 0.0 && value.is_finite());
        usable.then(|| {
            let white = XYZ::new(white.to_array(), Cie1931);
            let [l, a, b] = CieLab::from_rxyz(RelXYZ::new(self.to_array(), white)).to_array();
            Lab { l, a, b }
        })
    }
}

impl Lab {
    /// CIE 1976 difference: the straight distance.
    pub fn delta_e_1976(self, other: Self) -> f64 {
        (self.l - other.l).hypot(self.a - other.a).hypot(self.b - other.b)
    }

    /// CIEDE2000 difference, all weights 1; NaN where a value is not finite.
    pub fn delta_e_2000(self, other: Self) -> f64 {
        // The white only serves to check that the two have the same.
        let white = XYZ::new(D65_WHITE.to_array(), Cie1931);
        let lab = |c: Self| CieLab::new([c.l, c.a, c.b], white);
        lab(self).ciede2000(&lab(other)).unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_100_and_black_is_0() {
        let white = Xyz { x: 0.9, y: 1.0, z: 0.3 };
        let lab = white.lab(white).unwrap();
        assert!((lab.l - 100.0).abs() < 1e-12 && lab.a.abs() < 1e-12 && lab.b.abs() < 1e-12);
        let black = (white * 0.0).lab(white).unwrap();
        assert!(black.l.abs() < 1e-12 && black.a.abs() < 1e-12);
    }

    /// On the toe L* = 903.3 Y/Yn: it runs straight through zero.
    #[test]
    fn the_toe_takes_negative_noise() {
        for y in [-0.004, -1e-6, 0.0, 0.004] {
            let lab = (D65_WHITE * y).lab(D65_WHITE).unwrap();
            assert!((lab.l - 24_389.0 / 27.0 * y).abs() < 1e-9, "{lab:?}");
        }
    }

    /// colour-science's example for `XYZ_to_Luv`: XYZ .20654 .12197 .05137 under its D65.
    #[test]
    fn luv_of_a_known_surface() {
        let white = Xyz { x: 0.9504559270516716, y: 1.0, z: 1.0890577507598784 };
        let seen = Xyz { x: 0.20654008, y: 0.12197225, z: 0.05136952 };
        let luv = seen.lab(white).unwrap().luv(seen.uv_prime().unwrap(), white.uv_prime().unwrap());
        for (ours, theirs) in [luv.l, luv.u, luv.v].into_iter().zip([41.52787529, 96.83626054, 17.75210149]) {
            assert!((ours - theirs).abs() < 1e-6, "{luv:?}");
        }
    }

    #[test]
    fn a_white_without_blue_has_no_lab() {
        assert_eq!(D65_WHITE.lab(Xyz { x: 1.0, y: 1.0, z: 0.0 }), None);
        assert_eq!(D65_WHITE.lab(Xyz { x: 1.0, y: f64::NAN, z: 1.0 }), None);
    }

    /// Sharma, Wu, Dalal, Color Res. Appl. 30, 21 (2005), table 1: pairs 1, 7, 13, 16, 25.
    #[test]
    fn delta_e_2000_as_sharma_tabulates_it() {
        let pairs = [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, -0.0010, 2.4900], [50.0, 0.0011, -2.4900], 4.7461),
            ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ];
        let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
        for (one, two, expected) in pairs {
            assert!((lab(one).delta_e_2000(lab(two)) - expected).abs() < 1e-4, "{one:?}");
        }
    }
}

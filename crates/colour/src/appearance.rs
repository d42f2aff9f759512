//! Colour appearance: CIECAM16.
//!
//! **What.** The lightness J and chroma C of CIECAM16 (CIE 248:2022: CAM16 of Li et al., Color Res.
//! Appl. 42, 703 (2017), made linear near black) and the uniform coordinates J', a', b' of CAM16-UCS
//! (same paper), in which the straight distance is a colour difference. By the `colorimetry` crate.
//! The hue angle is that of (a', b').
//!
//! **Parameters.** The luminance that the eye is adapted to, cd/m2 (usually a fifth of that of white:
//! a grey room), the luminance of the background over that of white (usually .2), and the surround.
//! **Range.** Surface colours, 1 to 10 000 cd/m2; whites as bright as 1.5 times the perfect one.

use colorimetry::cam::{CamTransforms, CieCam16, ViewConditions};
use colorimetry::observer::Observer::Cie1931;
use colorimetry::xyz::{RelXYZ, XYZ};

use crate::Xyz;

/// What is around the display.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Surround {
    /// As bright as the display or nearly so: paper, reflective displays in their room's light.
    #[default]
    Average,
    /// Less than a fifth of it.
    Dim,
    /// Nothing.
    Dark,
}

/// Viewing conditions of CIECAM16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewing {
    /// Luminance that the eye is adapted to, cd/m2, above 0.
    pub adapting_luminance_cd_m2: f64,
    /// Luminance of the background over that of the white, above 0 to 1.
    pub background: f64,
    /// What is around the display.
    pub surround: Surround,
}

/// What a colour looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Lightness J, 100 for the white.
    pub lightness: f64,
    /// Chroma C.
    pub chroma: f64,
    /// J', a' and b' of CAM16-UCS.
    pub uniform: [f64; 3],
}

impl Xyz {
    /// What this colour looks like beside `white`, both on one scale.
    ///
    /// `None` unless the white is positive, and for colours that no eye sees (noise below black).
    pub fn appearance(self, white: Self, viewing: &Viewing) -> Option<Appearance> {
        let usable = white.to_array().into_iter().all(|value| value > 0.0 && value.is_finite());
        if !usable {
            return None;
        }
        let percent = 100.0 / white.y;
        let white = XYZ::new((white * percent).to_array(), Cie1931);
        let seen = RelXYZ::from_xyz(XYZ::new((self * percent).to_array(), Cie1931), white).ok()?;
        let cam = CieCam16::from_xyz(seen, viewing.conditions());
        let [lightness, chroma, _] = cam.jch();
        let uniform = cam.jab_prime();
        let all = [lightness, chroma].into_iter().chain(uniform);
        all.into_iter().all(f64::is_finite).then_some(Appearance { lightness, chroma, uniform })
    }
}

impl Appearance {
    /// The straight distance in CAM16-UCS.
    pub fn distance(self, other: Self) -> f64 {
        let square = |(a, b): (f64, f64)| (a - b).powi(2);
        self.uniform.into_iter().zip(other.uniform).map(square).sum::<f64>().sqrt()
    }
}

impl Viewing {
    fn conditions(&self) -> ViewConditions {
        let [c, nc, f] = match self.surround {
            Surround::Average => [0.69, 1.0, 1.0],
            Surround::Dim => [0.59, 0.9, 0.9],
            Surround::Dark => [0.525, 0.8, 0.8],
        };
        ViewConditions::new(self.adapting_luminance_cd_m2, 100.0 * self.background, c, nc, f, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::D65_WHITE;

    const ROOM: Viewing =
        Viewing { adapting_luminance_cd_m2: 40.0, background: 0.16, surround: Surround::Average };

    /// CIE 248:2022, the worked example of section 7.
    #[test]
    fn the_worked_example_of_the_standard() {
        let white = Xyz { x: 96.46, y: 100.0, z: 108.62 };
        let seen = Xyz { x: 60.70, y: 49.60, z: 10.29 }.appearance(white, &ROOM).unwrap();
        assert!((seen.lightness - 70.4406).abs() < 1e-4, "{seen:?}");
        assert!((seen.chroma - 58.6035).abs() < 1e-4, "{seen:?}");
        let hue = seen.uniform[2].atan2(seen.uniform[1]).to_degrees();
        assert!((hue - 57.9145).abs() < 1e-4, "{hue}");
    }

    #[test]
    fn white_is_white_on_any_scale_and_darkness_undefined() {
        for scale in [1.0, 100.0] {
            let white = (D65_WHITE * scale).appearance(D65_WHITE * scale, &ROOM).unwrap();
            assert!((white.lightness - 100.0).abs() < 1e-9 && white.distance(white) == 0.0);
        }
        assert_eq!(D65_WHITE.appearance(D65_WHITE * 0.0, &ROOM), None);
        let below = (D65_WHITE * -0.01).appearance(D65_WHITE, &ROOM);
        assert!(below.is_none_or(|seen| seen.lightness.is_finite()));
    }
}

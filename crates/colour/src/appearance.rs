//! Colour appearance model CIECAM16.
//!
//! **What.** The lightness J and chroma C of CIECAM16 (CIE 248:2022: CAM16 of Li et al., Color Res.
//! Appl. 42, 703 (2017), with linear extensions near black and above white) and the uniform coordinates J',
//! a', b' of CAM16-UCS (same paper), in which the Euclidean distance is a colour difference. The hue angle is
//! that of (a', b').
//!
//! **Parameters.** The adapting luminance, cd/m2 (usually a fifth of that of white: a grey
//! surrounding), the luminance of the background relative to white (usually 0.2), and the surround.
//! **Range.** Surface colours, 1 to 10 000 cd/m2.

use crate::Xyz;
use crate::adaptation::TO_CONES;
use crate::matrix::times;

/// Lower limit, on a scale of 100, below which the response compression is extended linearly. It is extended
/// linearly as well above the larger of `HIGHEST` and the response to white.
const LOWEST: f64 = 0.26;
const HIGHEST: f64 = 150.0;

/// Surround of the display, as defined by CIECAM16.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Surround {
    /// Average: about as bright as the display. Paper and reflective displays in ambient light.
    #[default]
    Average,
    /// Dim: less than a fifth of the display's luminance.
    Dim,
    /// Dark: no light around the display.
    Dark,
}

/// Viewing conditions of CIECAM16.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewing {
    /// Adapting luminance, cd/m2, greater than 0.
    pub adapting_luminance_cd_m2: f64,
    /// Luminance of the background relative to that of the white, greater than 0 and at most 1.
    pub background: f64,
    /// Surround of the display.
    pub surround: Surround,
}

/// Appearance correlates of a colour in CIECAM16.
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
    /// Computes the appearance of this colour relative to `white`; both must be on the same scale.
    ///
    /// Returns `None` unless the white is positive, and for values outside the model (noise below black).
    pub fn appearance(self, white: Self, viewing: &Viewing) -> Option<Appearance> {
        let usable = white.to_array().into_iter().all(|value| value > 0.0 && value.is_finite());
        let eye = usable.then(|| Eye::new(white * (100.0 / white.y), viewing))?;
        let seen = eye.appearance(self * (100.0 / white.y));
        let all = [seen.lightness, seen.chroma].into_iter().chain(seen.uniform);
        all.into_iter().all(f64::is_finite).then_some(seen)
    }
}

/// Parameters of an adapted observer, in the symbols of CIE 248.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Eye {
    pub(crate) c: f64,
    pub(crate) n_c: f64,
    /// Background luminance over white.
    pub(crate) n: f64,
    /// Luminance-level adaptation factor.
    pub(crate) f_l: f64,
    /// Gain of each cone type.
    pub(crate) d: [f64; 3],
    /// Response above which the compression is linear.
    q_u: f64,
    /// Achromatic response of the white.
    pub(crate) a_w: f64,
}

impl Eye {
    /// Computes the parameters for a white with Y = 100.
    pub(crate) fn new(white: Xyz, viewing: &Viewing) -> Self {
        let [c, n_c, f] = match viewing.surround {
            Surround::Average => [0.69, 1.0, 1.0],
            Surround::Dim => [0.59, 0.9, 0.9],
            Surround::Dark => [0.525, 0.8, 0.8],
        };
        let l_a = viewing.adapting_luminance_cd_m2;
        let k4 = (1.0 / (5.0 * l_a + 1.0)).powi(4);
        let f_l = k4 * l_a + 0.1 * (1.0 - k4).powi(2) * (5.0 * l_a).cbrt();
        let degree = (f * (1.0 - ((-l_a - 42.0) / 92.0).exp() / 3.6)).clamp(0.0, 1.0);
        let cones = cones(white);
        let d = cones.map(|cone| degree * 100.0 / cone + 1.0 - degree);
        let adapted = [0, 1, 2].map(|k| cones[k] * d[k]);
        let q_u = adapted.into_iter().fold(HIGHEST, f64::max);
        let mut eye = Self { c, n_c, n: viewing.background, f_l, d, q_u, a_w: 1.0 };
        eye.a_w = eye.achromatic(eye.responses(white));
        eye
    }

    pub(crate) fn appearance(&self, xyz: Xyz) -> Appearance {
        let [r, g, b] = self.responses(xyz);
        let (across, along) = (r - 12.0 / 11.0 * g + b / 11.0, (r + g - 2.0 * b) / 9.0);
        let hue = along.atan2(across);
        let z = 1.48 + self.n.sqrt();
        let lightness = 100.0 * (self.achromatic([r, g, b]) / self.a_w).powf(self.c * z);
        let eccentricity = 0.25 * ((hue + 2.0).cos() + 3.8);
        let t = 50_000.0 / 13.0 * self.n_c * self.induction() * eccentricity * across.hypot(along)
            / (r + g + 1.05 * b + 0.305);
        let chroma = t.powf(0.9) * (lightness / 100.0).sqrt() * (1.64 - 0.29_f64.powf(self.n)).powf(0.73);
        let m = (1.0 + 0.0228 * chroma * self.f_l.powf(0.25)).ln() / 0.0228;
        let uniform = [1.7 * lightness / (1.0 + 0.007 * lightness), m * hue.cos(), m * hue.sin()];
        Appearance { lightness, chroma, uniform }
    }

    /// Induction factors N_bb and N_cb, which are equal.
    pub(crate) fn induction(&self) -> f64 {
        0.725 * self.n.powf(-0.2)
    }

    fn achromatic(&self, [r, g, b]: [f64; 3]) -> f64 {
        (2.0 * r + g + b / 20.0) * self.induction()
    }

    /// Compressed cone responses.
    fn responses(&self, xyz: Xyz) -> [f64; 3] {
        let cones = cones(xyz);
        [0, 1, 2].map(|k| self.compressed(cones[k] * self.d[k]))
    }

    /// Compressed response of a response.
    fn compressed(&self, q: f64) -> f64 {
        if q < LOWEST {
            self.power(LOWEST) * q / LOWEST
        } else if q <= self.q_u {
            self.power(q)
        } else {
            self.power(self.q_u) + self.slope() * (q - self.q_u)
        }
    }

    /// Inverse of [`Self::compressed`].
    pub(crate) fn expanded(&self, response: f64) -> f64 {
        let (lowest, highest) = (self.power(LOWEST), self.power(self.q_u));
        if response < lowest {
            LOWEST * response / lowest
        } else if response <= highest {
            100.0 / self.f_l * (27.13 * response / (400.0 - response)).powf(1.0 / 0.42)
        } else {
            self.q_u + (response - highest) / self.slope()
        }
    }

    fn power(&self, q: f64) -> f64 {
        let x = (self.f_l * q / 100.0).powf(0.42);
        400.0 * x / (27.13 + x)
    }

    /// Slope of the extension above the response to white.
    fn slope(&self) -> f64 {
        let x = self.f_l * self.q_u / 100.0;
        1.68 * 27.13 * self.f_l * x.powf(-0.58) / (27.13 + x.powf(0.42)).powi(2)
    }
}

fn cones(xyz: Xyz) -> [f64; 3] {
    times(&TO_CONES, xyz.to_array())
}

impl Appearance {
    /// Colour difference: the Euclidean distance in CAM16-UCS.
    pub fn distance(self, other: Self) -> f64 {
        let square = |(a, b): (f64, f64)| (a - b).powi(2);
        self.uniform.into_iter().zip(other.uniform).map(square).sum::<f64>().sqrt()
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
    fn appearance_equals_the_worked_example_of_the_standard() {
        let white = Xyz { x: 96.46, y: 100.0, z: 108.62 };
        let seen = Xyz { x: 60.70, y: 49.60, z: 10.29 }.appearance(white, &ROOM).unwrap();
        assert!((seen.lightness - 70.4406).abs() < 1e-4, "{seen:?}");
        assert!((seen.chroma - 58.6035).abs() < 1e-4, "{seen:?}");
        let hue = seen.uniform[2].atan2(seen.uniform[1]).to_degrees();
        assert!((hue - 57.9145).abs() < 1e-4, "{hue}");
    }

    #[test]
    fn appearance_is_independent_of_scale_and_undefined_without_white() {
        for scale in [1.0, 100.0] {
            let white = (D65_WHITE * scale).appearance(D65_WHITE * scale, &ROOM).unwrap();
            assert!((white.lightness - 100.0).abs() < 1e-9 && white.distance(white) == 0.0);
        }
        assert_eq!(D65_WHITE.appearance(D65_WHITE * 0.0, &ROOM), None);
        // Above a perfect white, lightness continues to increase and hue is kept.
        let red = Xyz { x: 0.4, y: 0.25, z: 0.12 };
        let looks = [1.0, 2.0, 5.0, 8.0].map(|gain| (red * gain).appearance(D65_WHITE, &ROOM).unwrap());
        assert!(looks.windows(2).all(|pair| pair[0].lightness < pair[1].lightness), "{looks:?}");
        assert!(looks.iter().all(|one| one.uniform[1] > 20.0), "{looks:?}");
        let below = (D65_WHITE * -0.01).appearance(D65_WHITE, &ROOM);
        assert!(below.is_none_or(|seen| seen.lightness.is_finite()));
    }
}

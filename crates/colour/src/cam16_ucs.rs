//! CAM16-UCS: uniform coordinates J', a', b' of CIECAM16, and the colour that has them.
//!
//! **What.** `J' = 1.7 J/(1 + 0.007 J)`, `M' = ln(1 + 0.0228 M)/0.0228`, `a' = M' cos h`, `b' = M' sin h`,
//! from lightness J, colourfulness M and hue h of CIECAM16. The Euclidean distance is a colour difference.
//! The inverse solves the equations of the model backwards, in closed form.
//!
//! **Parameters.** The white, on the scale of the colours, and the [viewing conditions](Viewing).
//!
//! **Range.** Real colours. Some coordinates of large M' belong to no real colour; the inverse then returns a
//! colour with negative values, or none where the chroma of the model has no colour at all.
//!
//! **Source.** Luo, Cui, Li, *Uniform colour spaces based on CIECAM02 colour appearance model*, Color Res.
//! Appl. 31, 320 (2006); Li et al., Color Res. Appl. 42, 703 (2017), whose appendix has the inverse; with the
//! linear extensions of CIE 248:2022.

use crate::adaptation::FROM_CONES;
use crate::appearance::Eye;
use crate::matrix::times;
use crate::{Viewing, Xyz};

/// CAM16-UCS relative to one white in one set of viewing conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cam16Ucs {
    eye: Eye,
    /// Factor from the colours to Y = 100 of the white.
    scale: f64,
}

impl Cam16Ucs {
    /// Prepares the conversions; `None` unless the white is positive.
    pub fn new(white: Xyz, viewing: &Viewing) -> Option<Self> {
        let usable = white.to_array().into_iter().all(|value| value > 0.0 && value.is_finite());
        let scale = 100.0 / white.y;
        usable.then(|| Self { eye: Eye::new(white * scale, viewing), scale })
    }

    /// Computes J', a', b' of a colour; `None` outside the model (noise below black).
    pub fn coordinates(&self, colour: Xyz) -> Option<[f64; 3]> {
        let uniform = self.eye.appearance(colour * self.scale).uniform;
        uniform.iter().all(|value| value.is_finite()).then_some(uniform)
    }

    /// Computes the colour of J', a', b'; `None` if no colour has them.
    pub fn xyz(&self, [j, a, b]: [f64; 3]) -> Option<Xyz> {
        if j <= 0.0 {
            return (j == 0.0 && a == 0.0 && b == 0.0).then_some(Xyz { x: 0.0, y: 0.0, z: 0.0 });
        }
        let lightness = j / (1.7 - 0.007 * j);
        let uniform = a.hypot(b);
        let colourfulness = ((0.0228 * uniform).exp() - 1.0) / 0.0228;
        let (cos, sin) = if uniform > 0.0 { (a / uniform, b / uniform) } else { (1.0, 0.0) };
        let cones = self.eye.cones(lightness, colourfulness, [cos, sin])?;
        let [x, y, z] = times(&FROM_CONES, cones);
        let colour = Xyz { x, y, z } * (1.0 / self.scale);
        colour.to_array().iter().all(|value| value.is_finite()).then_some(colour)
    }
}

impl Eye {
    /// Cone responses, before adaptation, of a lightness J above 0, a colourfulness M and the cosine and sine
    /// of a hue.
    fn cones(&self, lightness: f64, colourfulness: f64, [cos, sin]: [f64; 2]) -> Option<[f64; 3]> {
        let chroma = colourfulness / self.f_l.powf(0.25);
        let root = (lightness / 100.0).sqrt() * (1.64 - 0.29_f64.powf(self.n)).powf(0.73);
        let t = (chroma / root).powf(1.0 / 0.9);
        let z = 1.48 + self.n.sqrt();
        let achromatic = self.a_w * (lightness / 100.0).powf(1.0 / (self.c * z)) / self.induction();
        // cos(h + 2), of the angle's cosine and sine.
        let eccentricity = 0.25 * (cos * 2.0_f64.cos() - sin * 2.0_f64.sin() + 3.8);
        let factor = 50_000.0 / 13.0 * self.n_c * self.induction() * eccentricity;
        let below = factor + t * (671.0 * cos + 6588.0 * sin) / 1403.0;
        if !(lightness.is_finite() && below > 0.0) {
            return None;
        }
        let distance = t * (achromatic + 0.305) / below;
        let (a, b) = (distance * cos, distance * sin);
        let responses = [
            (460.0 * achromatic + 451.0 * a + 288.0 * b) / 1403.0,
            (460.0 * achromatic - 891.0 * a - 261.0 * b) / 1403.0,
            (460.0 * achromatic - 220.0 * a - 6300.0 * b) / 1403.0,
        ];
        Some([0, 1, 2].map(|k| self.expanded(responses[k]) / self.d[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{D65_WHITE, Surround};

    /// colour-science 0.4.7: `XYZ_to_CIECAM16([19.01, 20, 21.78], [95.05, 100, 108.88], 318.31, 20)`, then
    /// `JMh_CAM16_to_CAM16UCS`; the colour of the documentation of both functions.
    const EXPECTED: [f64; 3] = [54.90445024274004, -0.08562124562629803, -0.06467960477996716];

    #[test]
    fn coordinates_agree_with_colour_science() {
        let white = Xyz { x: 0.9505, y: 1.0, z: 1.0888 };
        let viewing =
            Viewing { adapting_luminance_cd_m2: 318.31, background: 0.2, surround: Surround::Average };
        let seen = Cam16Ucs::new(white, &viewing).unwrap();
        let colour = Xyz { x: 0.1901, y: 0.2, z: 0.2178 };
        let ours = seen.coordinates(colour).unwrap();
        assert!(ours.iter().zip(EXPECTED).all(|(o, t)| (o - t).abs() < 1e-9), "{ours:?}");
        assert!(seen.xyz(EXPECTED).unwrap().distance(colour) < 1e-12);
    }

    #[test]
    fn colour_of_the_coordinates_is_the_colour_in_all_surrounds() {
        for surround in [Surround::Average, Surround::Dim, Surround::Dark] {
            let viewing = Viewing { adapting_luminance_cd_m2: 20.0, background: 0.3, surround };
            let seen = Cam16Ucs::new(D65_WHITE, &viewing).unwrap();
            // The darkest and the brightest are on the linear extensions.
            for xyz in
                [[1e-4, 2e-4, 1.5e-4], [0.4, 0.2, 0.05], [0.2, 0.1, 0.8], [0.9, 1.0, 1.1], [2.5, 2.0, 0.9]]
            {
                let [x, y, z] = xyz;
                let colour = Xyz { x, y, z };
                let back = seen.xyz(seen.coordinates(colour).unwrap()).unwrap();
                assert!(back.distance(colour) < 1e-12, "{colour:?} {back:?}");
            }
        }
        let eye = Viewing { adapting_luminance_cd_m2: 20.0, background: 0.3, surround: Surround::Dim };
        assert_eq!(Cam16Ucs::new(D65_WHITE * 0.0, &eye), None);
        assert_eq!(Cam16Ucs::new(D65_WHITE, &eye).unwrap().xyz([-1.0, 0.0, 0.0]), None);
    }
}

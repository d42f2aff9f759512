//! First-order spread through a diffuser: which directions in the glass, and so which places, a viewer sees.
//!
//! **What.** Light that reaches a viewer along `beta_v` has met the pixel with some direction beta in the
//! glass, at the place `D(beta)` from where it leaves the diffuser. Its density over beta is the product of
//! the lobe towards the viewer and of what arrives along beta:
//!
//! - diffuse light over a mirror: `K(beta_v - beta) S(beta)`, S the fraction of a lobe around beta that lies
//!   within the disc of the air;
//! - a beam over a mirror: `pi K(beta_v - beta) K(beta - beta_s)`: a double image, one half around each of
//!   the two directions;
//! - discs and fields over a mirror: the same, summed over their directions;
//! - a Lambertian pixel: `K(beta_v - beta)`, whatever the light.
//!
//! The part s of the light that the diffuser does not scatter adds sharp images. Seen through the table of
//! the pixel's reflectance over |beta|, every place has a colour of its own.
//!
//! **A field of view.** Each of its directions has places relative to its own ray: a lens that is in focus at
//! the pixels. A place r then shows the sum of what all directions see there. Directions are those of the
//! ray of the middle of the field: beta is where it would see r.
//!
//! `pair.rs` holds this density, `field.rs` that of light from everywhere, `rule.rs` the directions at which it is taken.

mod field;
mod pair;
mod rule;

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::Beta;

pub(super) use self::field::FieldLight;
pub(super) use self::pair::Pair;
pub(super) use self::rule::{Directions, SUMS};
use super::{Image, PointSpread};
use crate::Diffuser;
use crate::light::cone_points::Point;

/// Light from outside, for a spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// The same radiance from the whole hemisphere.
    Diffuse,
    /// A collimated beam whose light propagates with these direction cosines.
    Beam(Beta),
}

/// The glass between diffuser and pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// Refractive index, above 1.
    pub index: f64,
    /// Thickness, mm.
    pub thickness_mm: f64,
}

/// A direction in the glass, the place that is seen along it, and its part of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Direction cosines of light that leaves the pixel.
    pub beta: Beta,
    /// The place, relative to where the view's own ray meets the pixel: as much farther than this ray the light
    /// goes in the plane of the panel, mm.
    pub place_mm: [f64; 2],
    /// Part of the reflectance factor, for a pixel that reflects everything and a diffuser that absorbs
    /// nothing.
    pub weight: f64,
}

/// Accuracy of a spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Natural digits: errors of the weights are about `exp(-digits)`.
    pub digits: f64,
    /// Highest spatial frequency that will be asked, cycles per mm.
    pub most_per_mm: f64,
}

/// Directions of a view or of a source, in air, and where they are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bundle {
    pub(super) points: Vec<Point>,
    /// Middle of the directions, and the radius around it, direction cosines.
    pub(super) centre: Beta,
    pub(super) radius: f64,
}

impl Bundle {
    pub(super) fn point(beta: Beta) -> Self {
        Self { points: vec![Point { beta, weight: 1.0 }], centre: beta, radius: 0.0 }
    }
}

/// What arrives at the diffuser from below, or from the pixel.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Incoming {
    /// Diffuse light, over a mirror.
    Diffuse,
    /// A beam or a disc over a mirror: a peak of its own.
    Peak(Bundle),
    /// Light from everywhere, over a mirror.
    Field(Arc<FieldLight>),
    /// Light of a Lambertian pixel: 1 in all directions.
    Pixel,
}

impl Incoming {
    /// Directions of the light; none of light from the whole hemisphere.
    pub(super) fn bundle(&self) -> Option<&Bundle> {
        match self {
            Self::Peak(light) => Some(light),
            Self::Field(light) => Some(&light.bundle),
            Self::Diffuse | Self::Pixel => None,
        }
    }
}

/// First-order spread between a view and a light.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    pair: Pair,
    samples: Vec<Sample>,
    /// Number of samples of unscattered light, the first ones.
    sharp: usize,
}

impl Spread {
    /// Prepares the spread for light that leaves with direction cosines `view`, `|view| < 1`.
    pub fn new(diffuser: &Diffuser, gap: Gap, view: Beta, light: Light, accuracy: Accuracy) -> Self {
        let light = match light {
            Light::Diffuse => Incoming::Diffuse,
            Light::Beam(beam) => Incoming::Peak(Bundle::point(beam)),
        };
        Self::of(Pair::new(diffuser, gap, Bundle::point(view), light, accuracy))
    }

    /// Prepares the spread between a bundle of views and a light.
    pub(super) fn of(pair: Pair) -> Self {
        let mut samples = pair.sharp();
        let sharp = samples.len();
        pair.each_scattered(Directions::Whole, &mut |sample| samples.push(sample));
        Self { pair, samples, sharp }
    }

    /// The same light as a density over places.
    pub fn point_spread(&self) -> PointSpread<'_> {
        let images = self.samples[..self.sharp].iter().map(Image::from).collect();
        PointSpread { images, ..self.pair.point_spread() }
    }

    /// The directions that are seen; those of unscattered light first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Integral of the spread, weighted by the pixel's reflectance as a function of `|beta|^2`, times
    /// `exp(-2 pi i f.r)`; the place r is relative to the view's own ray. At f = 0 it is the reflectance
    /// factor.
    pub fn transfer(&self, frequency_per_mm: [f64; 2], reflectance: impl Fn(f64) -> f64) -> Complex64 {
        let of = |sample: &Sample| {
            let turns: f64 = (0..2).map(|k| frequency_per_mm[k] * sample.place_mm[k]).sum();
            Complex64::from_polar(sample.weight * reflectance(sample.beta.squared()), -2.0 * PI * turns)
        };
        self.samples.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::lobe::Lobe;

    use super::super::closed;
    use super::*;

    const WIDTH: f64 = 0.05667;
    const GAP: Gap = Gap { index: 1.5, thickness_mm: 0.5 };
    const ACCURACY: Accuracy = Accuracy { digits: 14.0, most_per_mm: 10.0 };

    fn diffuser(width: f64) -> Diffuser {
        Diffuser {
            lobe: Lobe::KCorrelation { width },
            transmittance: vec![1.0].into(),
            regular_fraction: 0.0,
        }
    }

    fn modulation(spread: &Spread, frequency: [f64; 2]) -> Complex64 {
        spread.transfer(frequency, |_| 1.0) / spread.transfer([0.0; 2], |_| 1.0)
    }

    const NORMAL: Beta = Beta { x: 0.0, y: 0.0 };

    /// H78 over 0.5 mm of glass, along the normal: the radial integral by 40-point panels (numpy), and values
    /// of a separate program for the beam.
    #[test]
    fn exact_modulation_is_known() {
        let diffuse = Spread::new(&diffuser(WIDTH), GAP, NORMAL, Light::Diffuse, ACCURACY);
        let beam = Spread::new(&diffuser(WIDTH), GAP, NORMAL, Light::Beam(NORMAL), ACCURACY);
        for (f, in_diffuse, in_beam) in [
            (1.0, 0.939_069_3, 0.996_48),
            (2.0, 0.834_398_8, 0.986_26),
            (5.0, 0.586_456_5, 0.922_89),
            (5.9055, 0.526_884_3, 0.896_46),
            (10.0, 0.324_349_2, 0.754_55),
        ] {
            for (spread, expected) in [(&diffuse, in_diffuse), (&beam, in_beam)] {
                for frequency in [[f, 0.0], [0.0, f]] {
                    let found = modulation(spread, frequency);
                    assert!((found.re - expected).abs() < 6e-6 && found.im.abs() < 1e-5, "{f}: {found}");
                }
            }
        }
    }

    /// For a narrow lobe the closed form of small angles holds: two images of a beam, whose distance and form
    /// are those of Feynman's integral.
    #[test]
    fn narrow_lobe_has_closed_forms() {
        let b = 5e-3;
        let c = b * GAP.thickness_mm / GAP.index;
        // x = 2 pi f c
        let f = |x: f64| x / (2.0 * PI * c);
        let accuracy = Accuracy { digits: 12.0, most_per_mm: f(1.0) };
        for (s, x, along, across) in [
            (1.0, 0.5, 0.926_424, 0.934_567),
            (1.0, 1.0, 0.758_817, 0.786_206),
            (2.0, 0.5, 0.872_328, 0.911_439),
            (2.0, 1.0, 0.601_667, 0.724_985),
            (5.0, 0.5, 0.494_753, 0.822_039),
            (5.0, 1.0, 0.151_762, 0.543_337),
            (10.0, 0.5, 0.371_325, 0.715_784),
            (10.0, 1.0, 0.000_684, 0.421_102),
        ] {
            let beam = Light::Beam(Beta { x: s * b, y: 0.0 });
            let spread = Spread::new(&diffuser(b), GAP, NORMAL, beam, accuracy);
            for (frequency, expected) in [([f(x), 0.0], along), ([0.0, f(x)], across)] {
                let found = modulation(&spread, frequency).norm();
                // The first term that small angles neglect, in the phase between the images.
                let neglected = x * s * (s * b / GAP.index).powi(2) / 2.0;
                assert!((found - expected).abs() < 1e-4 + neglected, "{s} {x}: {found} {expected}");
            }
        }
        let mirrored = Spread::new(&diffuser(b), GAP, NORMAL, Light::Beam(NORMAL), accuracy);
        let found = modulation(&mirrored, [f(1.0), 0.0]).re;
        assert!((found - closed::lobe_in_mirrored_beam(f(1.0), c)).abs() < 1e-4, "{found}");
    }

    /// A finer rule changes nothing, at oblique views and lights too.
    #[test]
    fn rule_is_converged() {
        let [view, beam] = [Beta { x: 0.6, y: 0.1 }, Beta { x: -0.2, y: 0.3 }];
        for width in [0.01, 0.05667, 0.3] {
            for light in [Light::Diffuse, Light::Beam(beam), Light::Beam(view)] {
                let [coarse, fine] = [12.0, 20.0].map(|digits| {
                    let accuracy = Accuracy { digits, most_per_mm: 6.0 };
                    Spread::new(&diffuser(width), GAP, view, light, accuracy)
                });
                let total = fine.transfer([0.0; 2], |_| 1.0).re;
                for frequency in [[0.0, 0.0], [6.0, 0.0], [2.0, -3.0]] {
                    let [one, other] =
                        [&coarse, &fine].map(|spread| spread.transfer(frequency, |_| 1.0) / total);
                    assert!((one - other).norm() < 1e-4, "{width} {light:?} {frequency:?}: {one} {other}");
                }
            }
        }
    }
}

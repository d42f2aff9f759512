//! First-order spread of a lobe over a mirror-like pixel: which directions in the glass, and so which places, a viewer sees.
//!
//! **What.** Light that reaches a viewer along `beta_v` has met the pixel with some direction beta in the glass, at the place
//! `D(beta)` from where it leaves the diffuser. Its density over beta is the product of the lobe towards the viewer and
//! of what the lobe receives from the light:
//!
//! - diffuse light: `K(beta_v - beta) S(beta)`, S the fraction of a lobe around beta that lies within the disc of the air;
//! - a beam: `pi K(beta_v - beta) K(beta - beta_s)`: a double image, one half around each of the two directions.
//!
//! The part s of the light that the diffuser does not scatter adds sharp images. Seen through the table of the
//! pixel's reflectance over |beta|, every place has a colour of its own.
//!
//! **Rule.** The plane is divided into the cells of points that are nearer to one peak than to the others; each is integrated
//! in polar coordinates about its peak, with panels that are graded towards the peaks and the rim of the disc of air.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use rustfft::num_complex::Complex64;

use super::places::{Image, Peak};
use super::{PointSpread, displacement};
use crate::Diffuser;
use crate::adding::quadrature::{MOST_POINTS, MULTIPLE_POLES, Node, Pole, gauss, panels, points_for};

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
    /// Way from the place on the pixel to the place where the light leaves the diffuser, in the plane of the panel, mm.
    pub shift_mm: [f64; 2],
    /// Part of the reflectance factor, for a pixel that reflects everything and a diffuser that absorbs nothing.
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

/// First-order spread between a view and a light.
#[derive(Debug, Clone)]
pub struct Spread {
    pair: Pair,
    samples: Vec<Sample>,
    /// Shift of the view's own ray, mm.
    own_mm: [f64; 2],
}

impl Spread {
    /// Prepares the spread for light that leaves with direction cosines `view`, `|view| < 1`.
    pub fn new(diffuser: &Diffuser, gap: Gap, view: Beta, light: Light, accuracy: Accuracy) -> Self {
        let lobe = diffuser.lobe;
        let pair = Pair { lobe, straight: diffuser.regular_fraction, gap, view, light, accuracy };
        Self {
            samples: pair.sharp().chain(pair.scattered()).collect(),
            own_mm: displacement(view, gap.thickness_mm, gap.index),
            pair,
        }
    }

    /// Shift of the view's own ray, mm.
    pub fn own_mm(&self) -> [f64; 2] {
        self.own_mm
    }

    /// The same light as a density over places.
    pub fn point_spread(&self) -> PointSpread<'_> {
        let pair = &self.pair;
        let own = self.own_mm;
        let relative = |shift: [f64; 2]| [0, 1].map(|k| shift[k] - own[k]);
        let peak = |beta: &Beta| {
            let index = pair.gap.index;
            // The smaller derivative of the displacement, across beta.
            let per_beta = pair.gap.thickness_mm / (index * index - beta.squared()).sqrt();
            let at = displacement(*beta, pair.gap.thickness_mm, index);
            Peak { at_mm: relative(at), width_mm: pair.width() * per_beta }
        };
        let image = |sample: Sample| Image {
            at_mm: relative(sample.shift_mm),
            beta_squared: sample.beta.squared(),
            weight: sample.weight,
        };
        PointSpread {
            density: Box::new(|beta| pair.density(beta)),
            gap: pair.gap,
            own_mm: own,
            peaks: pair.peaks().iter().map(peak).collect(),
            images: pair.sharp().map(image).collect(),
            rim: (pair.light == Light::Diffuse).then(|| pair.width()),
            digits: pair.accuracy.digits,
        }
    }

    /// The directions that are seen; those of unscattered light first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Integral of the spread, weighted by the pixel's reflectance as a function of `|beta|^2`, times `exp(-2 pi i f.r)`; the
    /// place r is relative to the view's own ray. At f = 0 it is the reflectance factor.
    pub fn transfer(&self, frequency_per_mm: [f64; 2], reflectance: impl Fn(f64) -> f64) -> Complex64 {
        let of = |sample: &Sample| {
            let turns: f64 =
                (0..2).map(|k| frequency_per_mm[k] * (sample.shift_mm[k] - self.own_mm[k])).sum();
            Complex64::from_polar(sample.weight * reflectance(sample.beta.squared()), -2.0 * PI * turns)
        };
        self.samples.iter().map(of).sum()
    }
}

/// What determines a spread.
#[derive(Debug, Clone)]
struct Pair {
    lobe: Lobe,
    /// Fraction of the transmitted light that is not scattered.
    straight: f64,
    gap: Gap,
    view: Beta,
    light: Light,
    accuracy: Accuracy,
}

/// Ray of a polar rule: its end, and the places near which the integrand changes quickly.
struct Ray {
    end: f64,
    breaks: Vec<f64>,
    poles: Vec<Pole>,
}

impl Pair {
    fn sample(&self, beta: Beta, weight: f64) -> Sample {
        Sample { beta, shift_mm: displacement(beta, self.gap.thickness_mm, self.gap.index), weight }
    }

    /// Fraction of the light around beta that the diffuser exchanges with the air.
    fn share_of_air(&self, beta: Beta) -> f64 {
        let radius = beta.length();
        let straight = if radius <= 1.0 { self.straight } else { 0.0 };
        straight + (1.0 - self.straight) * self.lobe.fraction_in_disc(radius, 1.0)
    }

    /// Images of light that passes the diffuser at least once without being scattered. (Light that is never scattered is an
    /// image of the source, not part of the spread.)
    fn sharp(&self) -> impl Iterator<Item = Sample> {
        let s = self.straight;
        let sharp: Vec<Sample> = match self.light {
            _ if s == 0.0 => Vec::new(),
            Light::Diffuse => vec![self.sample(self.view, s * self.share_of_air(self.view))],
            Light::Beam(beam) => {
                let once = PI * s * (1.0 - s) * self.lobe.density(self.view, beam);
                vec![self.sample(self.view, once), self.sample(beam, once)]
            }
        };
        sharp.into_iter()
    }

    /// Density of the scattered light over beta.
    fn density(&self, beta: Beta) -> f64 {
        let scattered = (1.0 - self.straight) * self.lobe.density(self.view, beta);
        match self.light {
            Light::Diffuse => scattered * self.share_of_air(beta),
            Light::Beam(beam) => PI * scattered * (1.0 - self.straight) * self.lobe.density(beta, beam),
        }
    }

    /// Centres of the lobes.
    fn peaks(&self) -> Vec<Beta> {
        match self.light {
            // A distance much smaller than the width of the lobe makes one peak.
            Light::Beam(beam) if (beam - self.view).length() > 1e-3 * self.width() => vec![self.view, beam],
            _ => vec![self.view],
        }
    }

    fn width(&self) -> f64 {
        match self.lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => 1.0,
        }
    }

    fn scattered(&self) -> impl Iterator<Item = Sample> {
        let peaks = self.peaks();
        let mut samples = Vec::new();
        for (k, peak) in peaks.iter().enumerate() {
            let others: Vec<Beta> =
                peaks.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| *other).collect();
            for turn in self.turns(*peak, &others) {
                let (sin, cos) = turn.x.sin_cos();
                let ray = self.ray(*peak, [cos, sin], &others);
                for node in self.along(*peak, [cos, sin], &ray) {
                    let beta = *peak + Beta { x: node.x * cos, y: node.x * sin };
                    let weight = turn.weight * node.weight * node.x * self.density(beta);
                    samples.push(self.sample(beta, weight));
                }
            }
        }
        samples.into_iter()
    }

    /// Phase of the highest frequency at a shift of one thickness, radians.
    fn phase(&self) -> f64 {
        2.0 * PI * self.accuracy.most_per_mm * self.gap.thickness_mm
    }

    /// Azimuths about a peak. Where the border of its cell has a corner, a panel ends.
    fn turns(&self, peak: Beta, others: &[Beta]) -> Vec<Node> {
        let digits = self.accuracy.digits;
        if others.is_empty() {
            // A periodic integrand: the trapezoidal rule converges exponentially.
            let count = (2.0 * digits + 2.0 * self.phase()).ceil() as usize;
            let step = 2.0 * PI / count as f64;
            return (0..count).map(|k| Node { x: (k as f64 + 0.5) * step, weight: step }).collect();
        }
        let mut ends: Vec<f64> = others.iter().flat_map(|other| self.corners(peak, *other)).collect();
        ends.sort_by(f64::total_cmp);
        let first = ends.first().copied().unwrap_or(0.0);
        ends.push(first + 2.0 * PI);
        let mut nodes = Vec::new();
        for pair in ends.windows(2) {
            let panels = ((pair[1] - pair[0]) * (8.0 + self.phase()) / PI).ceil().max(1.0) as usize;
            let step = (pair[1] - pair[0]) / panels as f64;
            for panel in 0..panels {
                let from = pair[0] + step * panel as f64;
                nodes.extend(gauss(from, from + step, points_for(digits, 1.5)));
            }
        }
        nodes
    }

    /// Azimuths at which the line between two peaks' cells meets the disc of the glass.
    fn corners(&self, peak: Beta, other: Beta) -> Vec<f64> {
        let (between, apart) = (0.5 * (peak + other), other - peak);
        let along = Beta { x: -apart.y / apart.length(), y: apart.x / apart.length() };
        let middle = between.x * along.x + between.y * along.y;
        let half = (middle * middle - between.squared() + self.gap.index.powi(2)).sqrt();
        [half, -half]
            .map(|half| {
                let corner = between + (half - middle) * along - peak;
                corner.y.atan2(corner.x).rem_euclid(2.0 * PI)
            })
            .to_vec()
    }

    fn ray(&self, peak: Beta, [cos, sin]: [f64; 2], others: &[Beta]) -> Ray {
        let along = |beta: Beta| beta.x * cos + beta.y * sin;
        // Where |peak + r u| is this radius.
        let reaches = |radius: f64| {
            let at = along(peak);
            -at + (at * at - peak.squared() + radius * radius).sqrt()
        };
        let width = self.width();
        let edge = reaches(self.gap.index);
        let mut ray = Ray { end: edge, breaks: Vec::new(), poles: vec![Pole { at: 0.0, off: width }] };
        // Shifts grow without limit towards grazing light.
        ray.poles.push(Pole { at: edge, off: 0.02 * edge });
        for other in others {
            let apart = *other - peak;
            let at = along(apart);
            ray.poles.push(Pole { at, off: (apart.squared() - at * at + width * width).sqrt() });
            if at > 0.0 {
                ray.end = ray.end.min(0.5 * apart.squared() / at);
            }
        }
        if self.light == Light::Diffuse {
            let rim = reaches(1.0);
            // Change of |beta| along the ray.
            let slope = rim + along(peak);
            ray.poles.push(Pole { at: rim, off: width / slope.max(1e-3) });
            ray.breaks.push(rim);
        }
        ray
    }

    /// Rule along a ray: panels are divided until the phase of the highest frequency is resolved, too.
    fn along(&self, peak: Beta, [cos, sin]: [f64; 2], ray: &Ray) -> Vec<Node> {
        let index = self.gap.index;
        let turns_at = |r: f64| {
            let beta = peak + Beta { x: r * cos, y: r * sin };
            // There is little light beyond 72 deg in the glass, where shifts grow without limit.
            let rest = (index * index - beta.squared()).max(0.1 * index * index);
            beta.length() / rest.sqrt()
        };
        let mut nodes = Vec::new();
        panels(0.0, ray.end, &ray.breaks, &ray.poles, &mut |from, to, ellipse: f64| {
            let points = points_for(self.accuracy.digits + MULTIPLE_POLES, 2.0 * ellipse.ln()) as f64;
            let phase = self.phase() * (turns_at(to) - turns_at(from)).abs();
            let wanted = points + 0.6 * phase;
            let parts = (wanted / MOST_POINTS as f64).ceil();
            let step = (to - from) / parts;
            for part in 0..parts as usize {
                let from = from + step * part as f64;
                nodes.extend(gauss(from, from + step, (wanted / parts).ceil() as usize));
            }
        });
        nodes
    }
}

#[cfg(test)]
mod tests {
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

    /// H78 over 0.5 mm of glass, along the normal: the radial integral by 40-point panels (numpy), and values of a separate
    /// program for the beam.
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

    /// For a narrow lobe the closed form of small angles holds: two images of a beam, whose distance and form are those of
    /// Feynman's integral.
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
                    // A wide lobe sends some of its light beyond 72 deg in the glass.
                    assert!((one - other).norm() < 1e-4, "{width} {light:?} {frequency:?}: {one} {other}");
                }
            }
        }
    }
}

//! First-order spread through a diffuser: which directions in the glass, and so which places, a viewer sees.
//!
//! **What.** Light that reaches a viewer along `beta_v` has met the pixel with some direction beta in the glass, at the place
//! `D(beta)` from where it leaves the diffuser. Its density over beta is the product of the lobe towards the viewer and
//! of what arrives along beta:
//!
//! - diffuse light over a mirror: `K(beta_v - beta) S(beta)`, S the fraction of a lobe around beta that lies within the disc of the air;
//! - a beam over a mirror: `pi K(beta_v - beta) K(beta - beta_s)`: a double image, one half around each of the two directions;
//! - discs and fields over a mirror: the same, summed over their directions;
//! - a Lambertian pixel: `K(beta_v - beta)`, whatever the light.
//!
//! The part s of the light that the diffuser does not scatter adds sharp images. Seen through the table of the
//! pixel's reflectance over |beta|, every place has a colour of its own.
//!
//! **Rule.** The plane is divided into the cells of points that are nearer to one peak than to the others; each is integrated
//! in polar coordinates about its peak, with panels that are graded towards the peaks and the rim of the disc of air.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::lobe::{KCorrelation, Lobe};
use papilio_optics::{Beta, Scatterer, with_widest_simd};

use super::{Image, PointSpread, displacement, places};
use crate::Diffuser;
use crate::adding::quadrature::{MOST_POINTS, MULTIPLE_POLES, Node, Point, Pole, gauss, panels, points_for};

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
    Field(Bundle),
    /// Light of a Lambertian pixel: 1 in all directions.
    Pixel,
}

/// First-order spread between a view and a light.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    pair: Pair,
    samples: Vec<Sample>,
    /// Number of samples of unscattered light, the first ones.
    sharp: usize,
    /// Shift of the view's own ray, mm.
    own_mm: [f64; 2],
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
        pair.add_scattered(&mut samples);
        let own_mm = displacement(pair.view.centre, pair.gap.thickness_mm, pair.gap.index);
        Self { pair, samples, sharp, own_mm }
    }

    /// Shift of the view's own ray, mm.
    pub fn own_mm(&self) -> [f64; 2] {
        self.own_mm
    }

    /// The same light as a density over places.
    pub fn point_spread(&self) -> PointSpread<'_> {
        let images = self.samples[..self.sharp].iter().map(|sample| Image::of(sample, self.own_mm)).collect();
        PointSpread { images, ..self.pair.point_spread(self.own_mm) }
    }

    /// The directions that are seen; those of unscattered light first.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// Returns the samples of scattered light, and what determines them.
    pub(super) fn into_scattered(mut self) -> (Vec<Sample>, Pair) {
        (self.samples.split_off(self.sharp), self.pair)
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
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    pub(super) lobe: Lobe,
    /// Fraction of the transmitted light that is not scattered.
    pub(super) straight: f64,
    pub(super) gap: Gap,
    pub(super) view: Bundle,
    pub(super) light: Incoming,
    pub(super) accuracy: Accuracy,
}

/// Ray of a polar rule: its end, and the places near which the integrand changes quickly.
struct Ray {
    end: f64,
    breaks: Vec<f64>,
    poles: Vec<Pole>,
}

/// A peak of the integrand: a disc of this radius with soft edges.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Peak {
    centre: Beta,
    radius: f64,
}

impl Pair {
    pub(super) fn new(
        diffuser: &Diffuser,
        gap: Gap,
        view: Bundle,
        light: Incoming,
        accuracy: Accuracy,
    ) -> Self {
        Self { lobe: diffuser.lobe, straight: diffuser.regular_fraction, gap, view, light, accuracy }
    }

    /// The scattered light as a density over places, relative to this one.
    pub(super) fn point_spread(&self, own_mm: [f64; 2]) -> PointSpread<'_> {
        let Gap { index, thickness_mm } = self.gap;
        let peak = |beta: Beta| {
            // The smaller derivative of the displacement, across beta.
            let per_beta = thickness_mm / (index * index - beta.squared()).sqrt();
            let at = displacement(beta, thickness_mm, index);
            places::Peak { at_mm: [0, 1].map(|k| at[k] - own_mm[k]), width_mm: self.width() * per_beta }
        };
        let rim = match self.lobe {
            Lobe::KCorrelation { width } => (self.light == Incoming::Diffuse).then_some(width),
            Lobe::Lambertian => Some(1e-3),
        };
        PointSpread {
            density: Box::new(|beta| self.density(beta)),
            gap: self.gap,
            own_mm,
            peaks: self.peaks().iter().flat_map(|peak| self.over(*peak)).map(peak).collect(),
            images: Vec::new(),
            rim,
            digits: self.accuracy.digits,
        }
    }

    /// Points of a wide peak, at most about a width from each other.
    fn over(&self, peak: Peak) -> Vec<Beta> {
        let steps = (peak.radius / self.width()).ceil().min(4.0) as i32;
        let grid = (-steps..=steps).flat_map(|x| (-steps..=steps).map(move |y| [x, y]));
        let inside = grid.filter(|[x, y]| x * x + y * y <= steps * steps);
        let step = peak.radius / f64::from(steps.max(1));
        inside.map(|[x, y]| peak.centre + Beta { x: f64::from(x) * step, y: f64::from(y) * step }).collect()
    }

    pub(super) fn sample(&self, beta: Beta, weight: f64) -> Sample {
        Sample { beta, shift_mm: displacement(beta, self.gap.thickness_mm, self.gap.index), weight }
    }

    /// Fraction of the light around beta that the diffuser exchanges with the air.
    fn share_of_air(&self, beta: Beta) -> f64 {
        let radius = beta.length();
        let straight = if radius <= 1.0 { self.straight } else { 0.0 };
        straight + (1.0 - self.straight) * self.lobe.fraction_in_disc(radius, 1.0)
    }

    /// Images of light that passes the diffuser at least once without being scattered. (Light of a beam, a disc or a field that
    /// is never scattered is an image of the source, not part of the spread.)
    pub(super) fn sharp(&self) -> Vec<Sample> {
        let s = self.straight;
        if s == 0.0 {
            return Vec::new();
        }
        let seen = |point: &Point, arriving: f64| self.sample(point.beta, point.weight * s * arriving);
        let views = self.view.points.iter();
        match &self.light {
            Incoming::Diffuse => views.map(|point| seen(point, self.share_of_air(point.beta))).collect(),
            Incoming::Pixel => views.map(|point| seen(point, 1.0)).collect(),
            Incoming::Peak(light) | Incoming::Field(light) => {
                let once = |point: &Point, other: &Bundle| {
                    seen(point, PI * (1.0 - s) * self.lobes_around(other, point.beta))
                };
                let exits = views.map(|point| once(point, light));
                exits.chain(light.points.iter().map(|point| once(point, &self.view))).collect()
            }
        }
    }

    /// Sum of the lobes around the directions of a bundle.
    fn lobes_around(&self, bundle: &Bundle, beta: Beta) -> f64 {
        if let [only] = &bundle.points[..] {
            return only.weight * self.lobe.density(only.beta, beta);
        }
        let Lobe::KCorrelation { width } = self.lobe else {
            return bundle
                .points
                .iter()
                .map(|point| point.weight * self.lobe.density(point.beta, beta))
                .sum();
        };
        let lobe = KCorrelation { width };
        with_widest_simd(
            #[inline(always)]
            || {
                // Several sums side by side.
                let mut sums = [0.0; 8];
                let (pieces, rest) = bundle.points.as_chunks::<8>();
                for piece in pieces {
                    for (sum, point) in sums.iter_mut().zip(piece) {
                        *sum += point.weight * lobe.at_squared_distance((point.beta - beta).squared());
                    }
                }
                let rest =
                    rest.iter().map(|p| p.weight * lobe.at_squared_distance((p.beta - beta).squared()));
                sums.iter().sum::<f64>() + rest.sum::<f64>()
            },
        )
    }

    /// Density of the scattered light over beta.
    fn density(&self, beta: Beta) -> f64 {
        let scattered = (1.0 - self.straight) * self.lobes_around(&self.view, beta);
        match &self.light {
            Incoming::Pixel => scattered,
            Incoming::Diffuse => scattered * self.share_of_air(beta),
            Incoming::Peak(light) | Incoming::Field(light) => {
                PI * scattered * (1.0 - self.straight) * self.lobes_around(light, beta)
            }
        }
    }

    /// Peaks of the integrand.
    fn peaks(&self) -> Vec<Peak> {
        let peak = |bundle: &Bundle| Peak { centre: bundle.centre, radius: bundle.radius };
        match (self.lobe, &self.light) {
            // The same in all directions of the air.
            (Lobe::Lambertian, _) => vec![Peak { centre: Beta { x: 0.0, y: 0.0 }, radius: 0.0 }],
            // A distance much smaller than the width of the lobe makes one peak.
            (_, Incoming::Peak(light))
                if (light.centre - self.view.centre).length() > 1e-3 * self.width() =>
            {
                vec![peak(&self.view), peak(light)]
            }
            (_, Incoming::Peak(light)) => {
                vec![Peak { centre: self.view.centre, radius: self.view.radius.max(light.radius) }]
            }
            _ => vec![peak(&self.view)],
        }
    }

    fn width(&self) -> f64 {
        match self.lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => 1.0,
        }
    }

    /// Radius of the disc in which there is scattered light.
    fn rim(&self) -> f64 {
        match self.lobe {
            Lobe::KCorrelation { .. } => self.gap.index,
            Lobe::Lambertian => 1.0,
        }
    }

    fn add_scattered(&self, samples: &mut Vec<Sample>) {
        let peaks = self.peaks();
        for (k, peak) in peaks.iter().enumerate() {
            let others: Vec<Peak> =
                peaks.iter().enumerate().filter(|(other, _)| *other != k).map(|(_, other)| *other).collect();
            for turn in self.turns(*peak, &others) {
                let (sin, cos) = turn.x.sin_cos();
                let ray = self.ray(*peak, [cos, sin], &others);
                for node in self.along(peak.centre, [cos, sin], &ray) {
                    let beta = peak.centre + Beta { x: node.x * cos, y: node.x * sin };
                    let weight = turn.weight * node.weight * node.x * self.density(beta);
                    samples.push(self.sample(beta, weight));
                }
            }
        }
    }

    /// Phase of the highest frequency at a shift of one thickness, radians.
    fn phase(&self) -> f64 {
        2.0 * PI * self.accuracy.most_per_mm * self.gap.thickness_mm
    }

    /// Number of azimuths that details of the light take besides the phase, over the number of digits.
    fn details(&self, peak: Peak) -> f64 {
        let width = self.width();
        let of_peak = peak.radius / width;
        match &self.light {
            // Where light is rough, far from the view, there is little of it.
            Incoming::Field(_) => of_peak + FIELD_DETAIL / width.sqrt(),
            // The rim of the disc of air is near the view.
            Incoming::Diffuse => {
                of_peak + peak.centre.squared() / (width.sqrt() + 1.0 - peak.centre.length()).max(0.05)
            }
            _ => of_peak,
        }
    }

    /// Azimuths about a peak. Where the border of its cell has a corner, a panel ends.
    fn turns(&self, peak: Peak, others: &[Peak]) -> Vec<Node> {
        let digits = self.accuracy.digits;
        let details = self.details(peak);
        if others.is_empty() {
            // A periodic integrand: the trapezoidal rule converges exponentially.
            let count = (digits * (2.0 + details) + 2.0 * self.phase()).ceil() as usize;
            let step = 2.0 * PI / count as f64;
            return (0..count).map(|k| Node { x: (k as f64 + 0.5) * step, weight: step }).collect();
        }
        let mut ends: Vec<f64> = others.iter().flat_map(|other| self.corners(peak, *other)).collect();
        ends.sort_by(f64::total_cmp);
        let first = ends.first().copied().unwrap_or(0.0);
        ends.push(first + 2.0 * PI);
        let mut nodes = Vec::new();
        for pair in ends.windows(2) {
            let panels =
                ((pair[1] - pair[0]) * (8.0 + 4.0 * details + self.phase()) / PI).ceil().max(1.0) as usize;
            let step = (pair[1] - pair[0]) / panels as f64;
            for panel in 0..panels {
                let from = pair[0] + step * panel as f64;
                nodes.extend(gauss(from, from + step, points_for(digits, 1.5)));
            }
        }
        nodes
    }

    /// Azimuths at which the line between two peaks' cells meets the disc of the glass.
    fn corners(&self, peak: Peak, other: Peak) -> Vec<f64> {
        let (peak, other) = (peak.centre, other.centre);
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

    fn ray(&self, peak: Peak, [cos, sin]: [f64; 2], others: &[Peak]) -> Ray {
        let along = |beta: Beta| beta.x * cos + beta.y * sin;
        let centre = peak.centre;
        // Where |peak + r u| is this radius.
        let reaches = |radius: f64| {
            let at = along(centre);
            -at + (at * at - centre.squared() + radius * radius).sqrt()
        };
        let width = self.width();
        let edge = reaches(self.rim());
        // Shifts grow without limit towards grazing light.
        let mut ray = Ray { end: edge, breaks: Vec::new(), poles: vec![Pole { at: edge, off: 0.02 * edge }] };
        if self.lobe == Lobe::Lambertian {
            return ray;
        }
        for other in others.iter().chain([&peak]) {
            let apart = other.centre - centre;
            let at = along(apart);
            let aside = (apart.squared() - at * at).max(0.0).sqrt();
            self.add_poles(at, aside, other.radius, &mut ray.poles);
            if at > 0.0 && other.centre != centre {
                ray.end = ray.end.min(0.5 * apart.squared() / at);
            }
        }
        match &self.light {
            Incoming::Diffuse => {
                let rim = reaches(1.0);
                // Change of |beta| along the ray.
                let slope = rim + along(centre);
                ray.poles.push(Pole { at: rim, off: width / slope.max(1e-3) });
                ray.breaks.push(rim);
            }
            Incoming::Field(_) => {
                let step = FIELD_STEP * width;
                let count = (reaches(1.0) / step).ceil().min(200.0);
                ray.poles.extend((1..=count as usize).map(|k| Pole { at: k as f64 * step, off: step }));
            }
            Incoming::Peak(_) | Incoming::Pixel => {}
        }
        ray
    }

    /// Adds the singularities of lobes around a disc of this radius whose centre is at `at` along a ray, and `aside` of it.
    fn add_poles(&self, at: f64, aside: f64, radius: f64, poles: &mut Vec<Pole>) {
        let width = self.width();
        let half = (radius * radius - aside * aside).max(0.0).sqrt();
        let off = (aside - radius).max(0.0).hypot(width);
        let steps = (2.0 * half / width).ceil().min(64.0);
        for k in 0..=steps as usize {
            let place = if steps > 0.0 { at + half * (2.0 * k as f64 / steps - 1.0) } else { at };
            poles.push(Pole { at: place, off });
        }
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

/// Distance of the panels of a field, in widths of the lobe, and the factor of its azimuths.
const FIELD_STEP: f64 = 2.0;
const FIELD_DETAIL: f64 = 0.7;

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
                    // A wide lobe sends some of its light beyond 72 deg in the glass, where phases are not resolved.
                    let within = if width > 0.1 { 3e-4 } else { 1e-4 };
                    assert!((one - other).norm() < within, "{width} {light:?} {frequency:?}: {one} {other}");
                }
            }
        }
    }
}

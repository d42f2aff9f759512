//! Density over direction of the light that a viewer sees of a source.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use super::super::{PointSpread, displacement, places};
use super::field::lobes_around;
use super::{Accuracy, Bundle, Gap, Incoming, Sample};
use crate::Diffuser;
use crate::light::cone_points::Point;

/// Largest radius of the directions of a view or a source in widths of the lobe: a narrower lobe is taken as
/// so wide, which blurs the edge of the directions by a thousandth of their radius. The number of samples is
/// proportional to this ratio.
const MOST_WIDTHS: f64 = 1000.0;

/// What determines a spread.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::spatial) struct Pair {
    pub(in crate::spatial) lobe: Lobe,
    /// Fraction of the transmitted light that is not scattered.
    pub(in crate::spatial) straight: f64,
    pub(in crate::spatial) gap: Gap,
    pub(in crate::spatial) view: Bundle,
    /// Ways of the own rays of the directions of view through a glass of thickness 1, and of their middle.
    rays: Vec<[f64; 2]>,
    ray: [f64; 2],
    pub(in crate::spatial) light: Incoming,
    pub(in crate::spatial) accuracy: Accuracy,
}

/// A peak of the integrand: a disc of this radius with soft edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    pub(super) centre: Beta,
    pub(super) radius: f64,
}

impl Pair {
    pub(in crate::spatial) fn new(
        diffuser: &Diffuser,
        gap: Gap,
        view: Bundle,
        light: Incoming,
        accuracy: Accuracy,
    ) -> Self {
        let radius = match &light {
            Incoming::Peak(light) => view.radius + light.radius,
            Incoming::Diffuse | Incoming::Field(_) | Incoming::Pixel => 0.0,
        };
        let least = radius / MOST_WIDTHS;
        let lobe = match diffuser.lobe {
            Lobe::KCorrelation { width } => Lobe::KCorrelation { width: width.max(least) },
            Lobe::Lambertian => Lobe::Lambertian,
        };
        let own = |beta: Beta| displacement(beta, 1.0, gap.index);
        let rays = view.points.iter().map(|point| own(point.beta)).collect();
        let ray = own(view.centre);
        Self { lobe, straight: diffuser.regular_fraction, gap, view, rays, ray, light, accuracy }
    }

    /// The scattered light as a density over places.
    pub(in crate::spatial) fn point_spread(&self) -> PointSpread<'_> {
        let Gap { index, thickness_mm } = self.gap;
        let own_mm = self.ray.map(|way| thickness_mm * way);
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
            varies_over_mm: match self.light {
                Incoming::Field(_) => Some(self.width() * thickness_mm / index),
                Incoming::Peak(_) | Incoming::Diffuse | Incoming::Pixel => None,
            },
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

    /// Light along beta, as the middle of the view or a direction with this own ray sees it.
    fn sample(&self, beta: Beta, own: [f64; 2], weight: f64) -> Sample {
        let way = displacement(beta, 1.0, self.gap.index);
        Sample { beta, place_mm: [0, 1].map(|k| self.gap.thickness_mm * (way[k] - own[k])), weight }
    }

    /// Light of this weight at the place that the middle of the view sees along beta.
    pub(super) fn seen_along(&self, beta: Beta, weight: f64) -> Sample {
        let [density, beta_squared] = self.density(beta);
        let sample = self.sample(beta, self.ray, weight * density);
        let scale = if self.rays.len() > 1 { (beta_squared / beta.squared()).sqrt() } else { 1.0 };
        Sample { beta: if scale.is_finite() { scale * beta } else { beta }, ..sample }
    }

    /// Fraction of the light around beta that the diffuser exchanges with the air.
    fn share_of_air(&self, beta: Beta) -> f64 {
        let radius = beta.length();
        let straight = if radius <= 1.0 { self.straight } else { 0.0 };
        straight + (1.0 - self.straight) * self.lobe.fraction_in_disc(radius, 1.0)
    }

    /// Images of light that passes the diffuser at least once without being scattered. (Light of a beam, a
    /// disc or a field that is never scattered is an image of the source, not part of the spread.)
    pub(in crate::spatial) fn sharp(&self) -> Vec<Sample> {
        let s = self.straight;
        if s == 0.0 {
            return Vec::new();
        }
        let arriving = |beta: Beta| match &self.light {
            Incoming::Diffuse => self.share_of_air(beta),
            Incoming::Pixel => 1.0,
            Incoming::Peak(_) | Incoming::Field(_) => PI * (1.0 - s) * self.lobes_around(beta),
        };
        let mut samples = Vec::new();
        for (view, own) in self.view.points.iter().zip(&self.rays) {
            samples.push(self.sample(view.beta, *own, view.weight * s * arriving(view.beta)));
            if let Some(light) = self.light.bundle() {
                let leaving = |light: &Point| PI * (1.0 - s) * s * self.lobe.density(view.beta, light.beta);
                let image = |light: &Point| {
                    self.sample(light.beta, *own, view.weight * light.weight * leaving(light))
                };
                samples.extend(light.points.iter().map(image));
            }
        }
        samples
    }

    /// Sum of the lobes around the directions of the light.
    fn lobes_around(&self, beta: Beta) -> f64 {
        match &self.light {
            Incoming::Peak(light) => lobes_around(self.lobe, &light.points, beta),
            Incoming::Field(light) => light.through(self.lobe, beta),
            Incoming::Diffuse | Incoming::Pixel => 0.0,
        }
    }

    /// Density over beta of the scattered light that is seen at the place of beta, and its `|beta|^2`: a mean
    /// over the directions of view.
    pub(super) fn density(&self, beta: Beta) -> [f64; 2] {
        if let [only] = &self.view.points[..] {
            return [only.weight * self.seen_from(only.beta, beta), beta.squared()];
        }
        let index = self.gap.index;
        let way = displacement(beta, 1.0, index);
        let slant = |[x, y]: [f64; 2]| 1.0 + x * x + y * y;
        let (mut sum, mut squares, own) = (0.0, 0.0, slant(way));
        for (view, ray) in self.view.points.iter().zip(&self.rays) {
            let way = [0, 1].map(|k| way[k] - self.ray[k] + ray[k]);
            let slant = slant(way);
            let scale = index / slant.sqrt();
            let beta = Beta { x: scale * way[0], y: scale * way[1] };
            let light = view.weight * (own / slant).powi(2) * self.seen_from(view.beta, beta);
            sum += light;
            squares += light * beta.squared();
        }
        [sum, if sum > 0.0 { squares / sum } else { beta.squared() }]
    }

    /// Density of the scattered light that is seen from a direction, over beta.
    fn seen_from(&self, view: Beta, beta: Beta) -> f64 {
        let scattered = (1.0 - self.straight) * self.lobe.density(view, beta);
        match &self.light {
            Incoming::Pixel => scattered,
            Incoming::Diffuse => scattered * self.share_of_air(beta),
            Incoming::Peak(_) | Incoming::Field(_) => {
                PI * scattered * (1.0 - self.straight) * self.lobes_around(beta)
            }
        }
    }

    /// Peaks of the integrand. All directions see their own ray at the same place, and a light at places as
    /// different as they are.
    pub(super) fn peaks(&self) -> Vec<Peak> {
        let view = Peak { centre: self.view.centre, radius: 0.0 };
        match (self.lobe, &self.light) {
            // The same in all directions of the air.
            (Lobe::Lambertian, _) => vec![Peak { centre: Beta { x: 0.0, y: 0.0 }, radius: 0.0 }],
            (_, Incoming::Peak(light)) => {
                let radius = light.radius + self.view.radius;
                // A distance much smaller than the width of the lobe makes one peak.
                if (light.centre - self.view.centre).length() > 1e-3 * self.width() {
                    vec![view, Peak { centre: light.centre, radius }]
                } else {
                    vec![Peak { radius, ..view }]
                }
            }
            _ => vec![view],
        }
    }

    pub(super) fn width(&self) -> f64 {
        match self.lobe {
            Lobe::KCorrelation { width } => width,
            Lobe::Lambertian => 1.0,
        }
    }

    /// Radius of the disc in which there is scattered light.
    pub(super) fn rim(&self) -> f64 {
        match self.lobe {
            Lobe::KCorrelation { .. } => self.gap.index,
            Lobe::Lambertian => 1.0,
        }
    }
}

//! Density over direction of the light that a viewer sees of a source.

use std::f64::consts::PI;

use papilio_optics::lobe::{KCorrelation, Lobe};
use papilio_optics::{Beta, Scatterer, with_widest_simd};

use super::super::{PointSpread, displacement, places};
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
        let of_light = match &light {
            Incoming::Peak(light) => light.radius,
            Incoming::Diffuse | Incoming::Field(_) | Incoming::Pixel => 0.0,
        };
        let least = view.radius.max(of_light) / MOST_WIDTHS;
        let lobe = match diffuser.lobe {
            Lobe::KCorrelation { width } => Lobe::KCorrelation { width: width.max(least) },
            Lobe::Lambertian => Lobe::Lambertian,
        };
        Self { lobe, straight: diffuser.regular_fraction, gap, view, light, accuracy }
    }

    /// The scattered light as a density over places, relative to this one.
    pub(in crate::spatial) fn point_spread(&self, own_mm: [f64; 2]) -> PointSpread<'_> {
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

    pub(in crate::spatial) fn sample(&self, beta: Beta, weight: f64) -> Sample {
        Sample { beta, shift_mm: displacement(beta, self.gap.thickness_mm, self.gap.index), weight }
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
    pub(super) fn density(&self, beta: Beta) -> f64 {
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
    pub(super) fn peaks(&self) -> Vec<Peak> {
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

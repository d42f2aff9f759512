//! Sampling of the direction between pixel and diffuser on the first pass, on which the estimate depends
//! most.
//!
//! On the first pass, the contribution of a direction below the diffuser is known: the value of the lobe
//! from the viewer, the reflectance of the pixel, and the light that each source sends there by a second
//! pass of the lobe. The guided strategy samples the direction from a [`Guide`] to their product. Later
//! passes carry a few percent of the light and are not part of it.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

use crate::light::GOLDEN_SECTION;
use crate::walk::Strategy;
use crate::walk::guide::{Guide, Peak};
use crate::walk::strategy::DirectionSampler;
use crate::{Cone, Diffuser, Panel, Reflector, Source};

/// How the direction is sampled.
#[derive(Debug)]
pub(super) enum First {
    /// Several directions, from the guide.
    Guided(Guided),
    /// From the lobe itself.
    Kernel(DirectionSampler),
    /// As all other directions.
    Plain,
}

/// Number of directions of a guided path's first pass, uniform over the guide: sampling several costs little
/// and gives much information on a pixel whose reflectance varies with angle.
pub(super) const SPLITS: usize = 8;

/// A guide, and the probability of passing the diffuser unscattered instead.
#[derive(Debug)]
pub(super) struct Guided {
    pub(super) guide: Guide,
    straight: f64,
}

impl Guided {
    /// Samples direction number `k` (modulo [`SPLITS`]); returns it and its weight.
    #[inline]
    pub(super) fn draw(&self, diffuser: &Diffuser, from: Beta, k: usize, u: [f64; 2]) -> (Beta, f64) {
        // The azimuths of the directions of a path are also spread.
        let k = (k % SPLITS) as f64;
        let (u, v) = ((u[0] + k) / SPLITS as f64, (u[1] + k * GOLDEN_SECTION).fract());
        if u < self.straight {
            return (from, diffuser.regular_fraction / self.straight);
        }
        let (to, density) = self.guide.draw([(u - self.straight) / (1.0 - self.straight), v]);
        let lobe = (1.0 - diffuser.regular_fraction) * diffuser.lobe.density(from, to);
        (to, lobe / ((1.0 - self.straight) * density))
    }
}

/// Fraction of the guide that ignores the light: it bounds the weights in the ledger.
const WITHOUT_LIGHT: f64 = 0.03;

/// Fraction of the guide that goes to each source equally, however little light it sends.
const TO_EACH_SOURCE: f64 = 0.1;

/// Largest half angle of the field of view, as a fraction of the lobe's width, for which one guide serves
/// all directions.
const WIDEST_FIELD: f64 = 0.25;

/// Number of points that represent a field.
const POINTS_OF_A_FIELD: usize = 64;

/// Radius of a disc, in widths of the lobe, above which the guide represents it by more than one point.
const POINT: f64 = 0.3;

impl First {
    pub(super) fn new(
        strategy: Strategy,
        (stack, diffuser): (&Panel, &Diffuser),
        view: Cone,
        (sources, shares): (&[Source], &[f64]),
    ) -> Self {
        match (strategy, diffuser.lobe) {
            (Strategy::Kernel, _) => Self::Kernel(DirectionSampler::kernel(diffuser.lobe)),
            (Strategy::Guided, Lobe::KCorrelation { width }) if view.half_angle() <= WIDEST_FIELD * width => {
                let light = Light::new(diffuser, width, view.axis_towards(), sources, shares);
                Contribution::new(stack, diffuser, view, light).guide().unwrap_or(Self::Plain)
            }
            _ => Self::Plain,
        }
    }
}

/// A source as points of equal weight; without points for diffuse light.
#[derive(Debug)]
struct SourcePoints {
    points: Vec<Beta>,
    /// Weight of the reflectance factor under it.
    share: f64,
}

/// Light that the sources send into a direction below the diffuser.
#[derive(Debug)]
struct Light {
    lobe: Lobe,
    straight: f64,
    lamps: Vec<SourcePoints>,
    /// Mean over the directions that the viewer sees.
    mean: f64,
    /// Fraction of the lobe that leaves into the air, at uniformly spaced `|beta|`.
    leaving: Vec<f64>,
}

/// Steps of this fraction per unit of `|beta|`.
const STEPS: f64 = 64.0;

impl Light {
    /// `view`: the direction cosines of the light that is seen.
    fn new(diffuser: &Diffuser, width: f64, view: Beta, sources: &[Source], shares: &[f64]) -> Self {
        let lobe = diffuser.lobe;
        let share = |i: usize| shares.get(i).copied().unwrap_or(1.0);
        let lamps: Vec<SourcePoints> = sources
            .iter()
            .enumerate()
            .map(|(i, source)| SourcePoints { points: points(source, width), share: share(i) })
            .collect();
        let leaving =
            (0..=(4.0 * STEPS) as usize).map(|k| lobe.fraction_in_disc(k as f64 / STEPS, 1.0)).collect();
        let mut light = Self { lobe, straight: diffuser.regular_fraction, lamps, mean: 0.0, leaving };
        // Two passes of the lobe are about one pass of a lobe of twice the width.
        let twice = Lobe::KCorrelation { width: 2.0 * width };
        let seen: Vec<f64> = light.lamps.iter().map(|lamp| lamp.seen(twice, view).max(1e-300)).collect();
        let mean: f64 = light.lamps.iter().zip(&seen).map(|(lamp, seen)| lamp.share * seen).sum();
        let each = TO_EACH_SOURCE * mean / sources.len() as f64;
        light.lamps.iter_mut().zip(&seen).for_each(|(lamp, seen)| lamp.share += each / seen);
        light.mean = mean;
        light
    }

    /// Returns the reflectance factor of a white pixel that receives light from direction `beta` alone.
    fn at(&self, beta: Beta) -> f64 {
        let of = |lamp: &SourcePoints| {
            let scattered =
                if lamp.points.is_empty() { self.leaves(beta) } else { lamp.seen(self.lobe, beta) };
            lamp.share * scattered
        };
        (1.0 - self.straight) * self.lamps.iter().map(of).sum::<f64>() + self.straight * self.mean
    }

    fn leaves(&self, beta: Beta) -> f64 {
        let at = beta.length() * STEPS;
        let k = (at as usize).min(self.leaving.len() - 2);
        self.leaving[k] + (at - k as f64) * (self.leaving[k + 1] - self.leaving[k])
    }
}

impl SourcePoints {
    /// Returns the light that a lobe scatters from it, as a reflectance factor.
    fn seen(&self, lobe: Lobe, beta: Beta) -> f64 {
        if self.points.is_empty() {
            return lobe.fraction_in_disc(beta.length(), 1.0);
        }
        let sum: f64 = self.points.iter().map(|point| lobe.density(beta, *point)).sum();
        PI * sum / self.points.len() as f64
    }
}

/// Returns points that represent a source.
fn points(source: &Source, width: f64) -> Vec<Beta> {
    match source {
        Source::Diffuse => Vec::new(),
        Source::Beam(beta) => vec![*beta],
        Source::Disc(cone) if cone.half_angle() < POINT * width => vec![-cone.axis_towards()],
        Source::Disc(cone) => {
            // Rings of equal area, as fine as the lobe resolves.
            let rings = (cone.half_angle() / width).clamp(1.0, 6.0).ceil() as usize;
            let on_ring =
                |ring: usize| (0..3 + 4 * ring).map(move |k| (ring, k as f64 / (3 + 4 * ring) as f64));
            let point = |(ring, turn): (usize, f64)| {
                let radius = ((ring as f64 + 0.5) / rings as f64) * cone.half_angle();
                -cone.around(radius, std::f64::consts::TAU * turn)
            };
            (0..rings).flat_map(on_ring).map(point).collect()
        }
        Source::Field(field) => {
            // A rough sample of the directions of its light.
            let side = 1.0 / POINTS_OF_A_FIELD as f64;
            let point = |k: usize| {
                field.sample([(k as f64 + 0.5) * side, ((k as f64 + 0.5) * GOLDEN_SECTION).fract()]).0
            };
            (0..POINTS_OF_A_FIELD).map(point).collect()
        }
    }
}

/// Contribution of a direction below the diffuser to the light that reaches the viewer.
struct Contribution<'a> {
    stack: &'a Panel,
    diffuser: &'a Diffuser,
    view: Beta,
    light: Light,
    /// Reflectance of the pixel at the nodes of its table: the mean over states, each relative to its own.
    pixel: Option<Vec<f64>>,
}

impl<'a> Contribution<'a> {
    fn new(stack: &'a Panel, diffuser: &'a Diffuser, view: Cone, light: Light) -> Self {
        let pixel = match &stack.base.reflector {
            Reflector::Specular(table) => Some(table.relative_reflectance()),
            _ => None,
        };
        Self { stack, diffuser, view: view.axis_towards(), light, pixel }
    }

    fn guide(&self) -> Option<First> {
        let Lobe::KCorrelation { width } = self.diffuser.lobe else { return None };
        let size = width;
        let lamps = self.light.lamps.iter().flat_map(|lamp| lamp.points.first());
        let mut peaks: Vec<Peak> = lamps.map(|at| Peak { at: *at, size }).collect();
        if self.pixel.is_some() {
            peaks.push(Peak { at: self.view, size });
        }
        let guide = Guide::new(self.stack.medium.largest_index(), &peaks, |beta| self.at(beta))?;
        // Unscattered and scattered light, as far as closed forms give them.
        let straight = self.diffuser.regular_fraction;
        let by_way = straight * self.light.at(self.view);
        let scattered = (1.0 - straight) * self.light.mean;
        let likely = if straight > 0.0 { (by_way / (by_way + scattered)).clamp(0.05, 0.95) } else { 0.0 };
        Some(First::Guided(Guided { guide, straight: likely }))
    }

    fn at(&self, beta: Beta) -> f64 {
        let light = self.light.at(beta) + WITHOUT_LIGHT * self.light.mean;
        let Some(pixel) = &self.pixel else { return light };
        self.diffuser.lobe.density(self.view, beta) * light * self.reflectance(pixel, beta)
    }

    /// Returns the factor of the pixel, at least a fifth of its value at the normal.
    fn reflectance(&self, pixel: &[f64], beta: Beta) -> f64 {
        let (Reflector::Specular(table), Some(index)) =
            (&self.stack.base.reflector, self.stack.medium.constant_index())
        else {
            return 1.0;
        };
        let stencil = table.nodes.stencil(beta.squared(), index);
        let nodes = pixel[stencil.first..].iter().zip(stencil.weights);
        nodes.map(|(value, weight)| value * weight).sum::<f64>().max(0.2)
    }
}

//! Mirror images of round sources and fields: light that is not scattered.
//!
//! An image is visible where the viewer's field and the mirrored source overlap. Either may be far smaller
//! than the other, so that points of the larger rarely fall on the smaller. Points are therefore sampled in
//! the smallest cone that contains the overlap (for a field: in the whole view). The reflectance of the
//! display is known in closed form ([`specular_image`](crate::specular_image)).
//!
//! Of a flat display that keeps s and p apart in polarised light, these are all rays that a view sees, with a weight each.

use papilio_sampling::{SampleStream, Sampler};

use super::{PathNumbers, Target};
use crate::specular::image_in;
use crate::{Cone, Estimate, Panel, Phases, ReflectanceFactor, Reflector, Source, Stack, Top, WholeView};

/// Points of the view at which fields are evaluated before the first path.
const POINTS: u64 = 1 << 13;

/// Mirror images of all sources in one field of view.
#[derive(Debug)]
pub(super) struct Images<'a> {
    stack: &'a Stack,
    view: Cone,
    seen: Vec<VisibleSource>,
    /// Whether the stack mirrors any light.
    mirrors: bool,
    /// What is polarised, and which polarisation these are of: s (0) or p (1).
    polarised: Option<(WholeView, usize)>,
    /// The phase between s and p, if it is known.
    phases: Option<&'a Phases>,
}

/// A source whose image may be visible.
#[derive(Debug)]
struct VisibleSource {
    source: usize,
    light: Source,
    /// Cone in which points are sampled, and its fraction of the view.
    cone: Cone,
    share: f64,
}

/// Sums over the paths of a replicate: an image for each source that may be visible.
#[derive(Debug, Clone)]
pub(super) struct Sums(Vec<ReflectanceFactor>);

impl<'a> Images<'a> {
    pub(super) fn new(
        stack: &'a Stack,
        view: Cone,
        sources: &[Source],
        polarised: Option<(WholeView, usize)>,
        phases: Option<&'a Phases>,
    ) -> Self {
        let seen = sources.iter().enumerate().filter_map(|(source, light)| {
            let cone = match light {
                Source::Diffuse if polarised.is_some() => view,
                Source::Diffuse | Source::Beam(_) => return None,
                Source::Disc(disc) => view.overlap(&disc.mirrored())?,
                Source::Field(_) => view,
            };
            // A view of zero width is a single direction.
            let share = if view.is_point() { 1.0 } else { cone.solid_angle() / view.solid_angle() };
            Some(VisibleSource { source, light: light.clone(), cone, share })
        });
        let seen = seen.collect();
        Self { stack, view, seen, mirrors: mirrors(stack), polarised, phases }
    }

    /// As [`Walk::rarest`](super::Walk::rarest): where a small part of the view sees an image with another
    /// radiance than the rest, about the fraction of that part.
    ///
    /// If a quantity has another value in a fraction p of all points, its fourth moment about the mean is
    /// 1/p times the square of the second.
    pub(super) fn rarest(&self) -> f64 {
        let fields = self.seen.iter().filter(|seen| matches!(seen.light, Source::Field(_)));
        fields
            .filter(|_| self.mirrors && !self.view.is_point())
            .map(|seen| self.rarest_of(seen))
            .fold(1.0, f64::min)
    }

    fn rarest_of(&self, seen: &VisibleSource) -> f64 {
        let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
        let strength = |path| {
            let [u, v, ..] = numbers.block(path, 0);
            Target::at(&seen.light, seen.cone.sample_towards([u, v])).map_or(0.0, |target| target.strength)
        };
        let strengths: Vec<f64> = (0..POINTS).map(strength).collect();
        let count = POINTS as f64;
        let mean = strengths.iter().sum::<f64>() / count;
        let moment = |power| strengths.iter().map(|one| (one - mean).abs().powi(power)).sum::<f64>() / count;
        let (second, fourth) = (moment(2), moment(4));
        // Differences due to rounding are ignored.
        if second <= (1e-9 * mean).powi(2) { 1.0 } else { (second * second / fourth).min(1.0) }
    }

    pub(super) fn sums(&self) -> Sums {
        let base = self.stack.base();
        Sums(self.seen.iter().map(|_| ReflectanceFactor::zeros(base.states(), base.bins())).collect())
    }

    /// Adds a point of each overlap for each path.
    pub(super) fn paths<'p>(&self, paths: impl Iterator<Item = PathNumbers<'p>>, sums: &mut Sums) {
        if self.mirrors && !self.seen.is_empty() {
            paths.for_each(|path| self.path(path.image(), sums));
        }
    }

    fn path(&self, u: [f64; 2], sums: &mut Sums) {
        for (seen, sum) in self.seen.iter().zip(&mut sums.0) {
            let beta = seen.cone.sample_towards(u);
            // Mirrors conserve direction cosines.
            let strength = match &seen.light {
                Source::Diffuse => Some(1.0),
                light => Target::at(light, beta).map(|target| target.strength),
            };
            let Some(strength) = strength.filter(|_| self.view.holds(beta)) else { continue };
            let of = (seen.source, seen.light.direction());
            let share = seen.share * strength;
            let weight = match (&self.polarised, self.phases) {
                (None, _) => 1.0,
                (Some((polarised, number)), None) => polarised.weights(Some(&self.view), of, beta)[*number],
                (Some((polarised, number)), Some(phases)) => {
                    let products = polarised.products(Some(&self.view), of, beta);
                    if *number == 0 {
                        sum.add(&phases.image(beta), products[2] * share);
                    }
                    products[*number]
                }
            };
            sum.add(&image_in(self.stack, &self.view, of, beta), weight * share);
        }
    }

    /// Adds the mean images to the estimate of each source.
    pub(super) fn add_to(&self, estimate: &mut Estimate, sums: &Sums, scale: f64) {
        for (seen, sum) in self.seen.iter().zip(&sums.0) {
            let rho = &mut estimate.rho[seen.source];
            if self.polarised.is_some() {
                *rho = ReflectanceFactor::zeros(rho.via_pixel.states(), rho.front.len());
            }
            rho.add(sum, scale);
        }
    }
}

/// Returns whether any light returns unscattered.
fn mirrors(stack: &Stack) -> bool {
    // General layers may at some angle, and evaluating a dark image is cheap.
    stack.panel().is_none_or(panel_mirrors)
}

fn panel_mirrors(stack: &Panel) -> bool {
    let reaches_base = match &stack.top {
        Top::Diffuser(diffuser) => diffuser.regular_fraction > 0.0,
        Top::IdealAr => true,
        Top::Fresnel(_) => return true,
    };
    let specular = matches!(stack.base.reflector, Reflector::Specular(_));
    stack.front.reflectance_above.max() > 0.0 || (reaches_base && specular)
}

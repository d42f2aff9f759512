//! Directed sources: connections to all of them, and chance hits of discs.
//!
//! The unscattered light of a source is known everywhere in closed form ([`Skeleton`]). Each scattering event
//! adds the light of a source that it scatters into the path: every way from the source whose first event,
//! counted from the source, is this one, exactly once.
//!
//! If that first event has a narrow lobe, the path rarely finds it. So each scattering interface also relays
//! the light of the source, once per path, in a direction sampled from its own kernel; events connect to the
//! relayed light in the same way. A direction that both the path and the interface may sample is weighted by
//! the balance heuristic ([`SourceLight::weight`]). Some directions are sampled from its kernel for other
//! light ([`aims`](super::aims)).

use papilio_optics::Beta;

use super::ledger::{Sums, Workspace};
use super::light::{Light, Share};
use super::orders::Orders;
use super::scatterers::Kind;
use super::{Layered, OutgoingRay};
use crate::Source;
use crate::layers::Scattered;
use crate::skeleton::{Field, Propagation, Ray, Skeleton};
use crate::walk::{PathNumbers, Target};

/// Light of all directed sources.
#[derive(Debug, Clone)]
pub(super) struct SourceLights {
    sources: Vec<SourceLight>,
    scattered: Vec<Relay>,
    /// Directions of beams and of the centres of discs.
    pub(super) about: Vec<Beta>,
    /// True if some of this light has [`Orders`].
    pub(super) ordered: bool,
}

/// Light of the sources for each path of a batch: one entry for all paths if nothing of it is sampled.
#[derive(Debug, Clone)]
pub(super) struct SourcesOfPaths {
    of_paths: Vec<SourceLights>,
    sampled: bool,
    /// The closed form of light that reaches a source.
    skeleton: Skeleton,
    /// True if there are sources with directions.
    pub(super) directed: bool,
    /// The current path, from 0 in the batch.
    pub(super) path: usize,
}

/// Light of one direction, at every plane of the stack.
#[derive(Debug, Clone)]
pub(super) struct SourceLight {
    source: usize,
    /// The point of the source.
    target: Target,
    /// The direction of this light.
    pub(super) beta: Beta,
    /// Densities with which an interface sampled this direction and would sample the way back; `None` for the
    /// light of the source itself.
    drawn: Option<[f64; 2]>,
    field: Field,
    /// Fraction of the light that was relayed as `field`; what met the base before is also in the
    /// field's `rising`.
    before: Light,
    dark: bool,
    /// Control variates, for each scattering medium; empty for relayed light.
    orders: Vec<Option<Orders>>,
}

/// Light that an interface relays.
#[derive(Debug, Clone)]
struct Relay {
    /// Numbers of the source and of the event.
    of: usize,
    event: usize,
    /// Light that arrives at the interface and is scattered.
    arrived: Light,
    lamp: SourceLight,
}

impl SourceLights {
    pub(super) fn new(walk: &Layered<'_>, skeleton: &mut Skeleton) -> Self {
        let about = walk.sources.iter().filter_map(Source::direction);
        let mut lamps =
            Self { sources: Vec::new(), scattered: Vec::new(), about: about.collect(), ordered: false };
        for (source, light) in walk.sources.iter().enumerate() {
            let Some(target) = Target::sample(light, [0.5; 2]) else { continue };
            let lamp = SourceLight::new(source, target, walk, skeleton);
            let of = lamps.sources.len();
            let events =
                walk.events.iter().enumerate().filter(|(_, event)| matches!(event.kind, Kind::Interface(..)));
            lamps.scattered.extend(events.map(|(event, _)| Relay {
                of,
                event,
                arrived: lamp.before.clone(),
                lamp: lamp.clone(),
            }));
            lamps.sources.push(lamp);
        }
        for of in 0..lamps.sources.len() {
            lamps.aim(of, lamps.sources[of].target, walk, skeleton);
        }
        lamps
    }

    /// Samples everything for a new path.
    pub(super) fn draw(&mut self, numbers: &PathNumbers<'_>, walk: &Layered<'_>, skeleton: &mut Skeleton) {
        if walk.discs {
            for of in 0..self.sources.len() {
                let source = &walk.sources[self.sources[of].source];
                if source.has_radiance()
                    && let Some(target) = Target::sample(source, numbers.on_discs())
                {
                    self.aim(of, target, walk, skeleton);
                }
            }
        }
        for (k, scattered) in self.scattered.iter_mut().enumerate() {
            let u = numbers.of_sources(k as u32);
            scattered.send(&self.sources[scattered.of], u, walk, skeleton);
        }
    }

    /// Moves to this point of a source.
    fn aim(&mut self, of: usize, target: Target, walk: &Layered<'_>, skeleton: &mut Skeleton) {
        let lamp = &mut self.sources[of];
        (lamp.target, lamp.beta) = (target, target.beta);
        skeleton.set(walk.stack, walk.base(), target.beta);
        skeleton.emit(Ray::ENTERING, &mut lamp.field);
        let media = walk.events.iter().filter(|event| event.going == Propagation::Down);
        let media =
            media.filter_map(|event| if let Kind::Bulk(bulk) = &event.kind { Some(bulk) } else { None });
        lamp.orders.clear();
        lamp.orders.extend(media.map(|bulk| Orders::new(bulk, target, walk.stack.base().is_specular())));
        self.ordered |= lamp.orders.iter().any(Option::is_some);
        let mut share = Share::zeros(lamp.before.fresh.len());
        for scattered in self.scattered.iter_mut().filter(|scattered| scattered.of == of) {
            walk.events[scattered.event].share(skeleton, &lamp.field, &mut share);
            scattered.arrived.start();
            scattered.arrived.carry(&share, &lamp.field.rising, 1.0);
        }
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &SourceLight> {
        self.sources.iter().chain(self.scattered.iter().map(|scattered| &scattered.lamp)).filter(|l| !l.dark)
    }
}

impl SourcesOfPaths {
    pub(super) fn new(walk: &Layered<'_>) -> Self {
        let mut skeleton = Skeleton::new(walk.stack, walk.base());
        let one = SourceLights::new(walk, &mut skeleton);
        Self {
            sampled: walk.discs || !one.scattered.is_empty(),
            directed: walk.directed,
            of_paths: vec![one],
            skeleton,
            path: 0,
        }
    }

    /// Samples everything for the paths of a batch.
    pub(super) fn draw<'n>(
        &mut self,
        paths: impl ExactSizeIterator<Item = PathNumbers<'n>>,
        walk: &Layered<'_>,
    ) {
        if self.sampled {
            self.of_paths.resize(paths.len(), self.of_paths[0].clone());
            let skeleton = &mut self.skeleton;
            paths.zip(&mut self.of_paths).for_each(|(numbers, lights)| lights.draw(&numbers, walk, skeleton));
        }
    }

    /// Frees memory.
    pub(super) fn shrink(&mut self) {
        self.of_paths.truncate(1);
        self.of_paths.shrink_to_fit();
    }

    /// Removes the control variates of light that is not sampled.
    #[cfg(test)]
    pub(super) fn without_orders(&mut self) {
        for lights in &mut self.of_paths {
            lights.ordered = false;
        }
    }

    /// The light of the sources for the current path.
    pub(super) fn now(&self) -> &SourceLights {
        &self.of_paths[if self.sampled { self.path } else { 0 }]
    }
}

impl SourceLight {
    fn new(source: usize, target: Target, walk: &Layered<'_>, skeleton: &Skeleton) -> Self {
        let base = walk.base();
        let mut before = Light::zeros(base.states(), base.bins());
        before.start();
        let field = skeleton.field();
        Self {
            source,
            target,
            beta: target.beta,
            drawn: None,
            field,
            before,
            dark: false,
            orders: Vec::new(),
        }
    }

    /// Weight of a connection, by the balance heuristic. `rival` is the density with which the path chose its
    /// direction before the event, where the event may also relay light of the source; otherwise infinite.
    /// `about_sources` is the density of directions that the path samples about sources, which meet relayed light
    /// at other scatterers; their chance hits of discs are not counted.
    #[inline]
    pub(super) fn weight(&self, scattered: Scattered, about_sources: f64, rival: f64) -> f64 {
        let Scattered { value, density, reverse } = scattered;
        match self.drawn {
            None => self.target.balanced(value, || density, reverse / rival),
            Some([drawn, back]) if density + about_sources > 0.0 => {
                let density = density + about_sources;
                value / density * self.target.balanced(drawn, || back, drawn / density)
            }
            Some(_) => 0.0,
        }
    }

    /// Control variates of its light in a scattering medium of this number.
    pub(super) fn orders(&self, medium: usize) -> Option<&Orders> {
        self.orders.get(medium)?.as_ref()
    }

    /// Fraction of light emitted as `ray` that reaches the source.
    #[inline]
    pub(super) fn reach(&self, ray: Ray, factor: impl Fn(usize) -> f64, share: &mut Share) {
        share.add(&self.field, ray.reversed(), factor);
    }

    /// Adds the path's light that reaches the source.
    pub(super) fn add(&self, light: &Light, share: &Share, sums: &mut Sums) {
        let sum = &mut sums.received.from_source[self.source];
        if self.drawn.is_none() {
            sum.add_share(light, share, &self.field.rising, 1.0);
        } else {
            sum.add_joined(light, &self.before, share, &self.field.rising);
        }
    }
}

impl Relay {
    fn send(&mut self, source: &SourceLight, u: [f64; 4], walk: &Layered<'_>, skeleton: &mut Skeleton) {
        let lamp = &mut self.lamp;
        lamp.dark = true;
        if self.arrived.is_dark() {
            return;
        }
        let event = &walk.events[self.event];
        let Some(sent) = event.relay(source.beta, u) else { return };
        lamp.before.clone_from(&self.arrived);
        let colours = event.colours(source.beta, sent.beta);
        lamp.before.multiply(|bin| event.carried(sent, bin) * colours.at(bin));
        lamp.before.scale(sent.weight);
        if lamp.before.is_dark() {
            return;
        }
        skeleton.set(walk.stack, walk.base(), sent.beta);
        skeleton.emit(sent.ray, &mut lamp.field);
        lamp.before.multiply_rows(&mut lamp.field.rising);
        (lamp.target, lamp.beta, lamp.drawn) = (source.target, sent.beta, Some([sent.density, sent.back]));
        lamp.dark = false;
    }
}

/// Connects the path's light to all sources at a scattering event.
///
/// `ways` are the rays on which light can leave the event; `scattered(way, beta)` are its densities,
/// `about_sources(beta)` is that of further directions, and `factor(beta, bin)` is what depends on wavelength.
pub(super) fn connect(
    ways: impl Iterator<Item = Ray> + Clone,
    rival: f64,
    (scattered, about_sources): (impl Fn(usize, Beta) -> Scattered, impl Fn(Beta) -> f64),
    factor: impl Fn(Beta, usize) -> f64,
    sums: &mut Sums,
    workspace: &mut Workspace,
) {
    let Workspace { light, share, lamps, .. } = workspace;
    for lamp in lamps.now().iter() {
        share.clear();
        let about_sources = if lamp.drawn.is_some() { about_sources(lamp.beta) } else { 0.0 };
        for (way, ray) in ways.clone().enumerate() {
            let weight = lamp.weight(scattered(way, lamp.beta), about_sources, rival);
            lamp.reach(ray, |bin| weight * factor(lamp.beta, bin), share);
        }
        lamp.add(light, share, sums);
    }
}

/// Adds discs that scattered light hits where it leaves the display.
pub(super) fn meet_discs(
    sources: &[Source],
    sent: OutgoingRay,
    (light, share, rising): (&Light, &Share, &[f64]),
    sums: &mut Sums,
) {
    for (source, sum) in sources.iter().zip(&mut sums.received.from_source) {
        if let Some(target) = Target::at(source, sent.beta) {
            let back = if sent.rival.is_finite() { sent.back } else { 0.0 };
            let weight = target.balanced(sent.density, || sent.own, back / sent.rival);
            sum.add_share(light, share, rising, weight);
        }
    }
}

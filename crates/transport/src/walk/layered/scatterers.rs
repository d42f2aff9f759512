//! Scattering events at interfaces and at a Lambertian base (media: [`bulk`](super::bulk), other bases:
//! [`pixel`](super::pixel)).

use std::cell::RefCell;

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::aims::{ABOUT_SOURCES, Aims, FAR, HALF_WAY};
use super::bulk::Bulk;
use super::ledger::{Sums, Workspace};
use super::light::Share;
use super::{BRIGHT_SIDE, OutgoingRay, sources};
use crate::layers::{Arrival, Channel, Colours, Departure, Scattered};
use crate::skeleton::{Field, Propagation, Ray, Skeleton};
use crate::walk::horizon::{Horizons, SampledInterface, emitted, emitted_density};
use crate::{Cone, Medium, Reflector, ScatterKernel, Source, Stack};

/// A scatterer, and the way in which light arrives at it.
#[derive(Debug, Clone)]
pub(super) struct ScatterEvent<'a> {
    pub(super) element: usize,
    pub(super) going: Propagation,
    pub(super) kind: Kind<'a>,
    /// Directions half way to sources: of light that it relays, and of light that the event of the way back
    /// relays.
    half_way: [Aims; 2],
    /// Directions about sources, of paths that it scatters.
    about_sources: Aims,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Kind<'a> {
    /// A channel of an interface between these media; air, if there is none above.
    Interface(SampledInterface<'a>, Channel, [Option<&'a Medium>; 2]),
    Bulk(Bulk<'a>),
    /// A Lambertian base, under this medium.
    Base(Option<&'a Medium>),
    /// A base with a kernel for each state, under this medium.
    Pixel(&'a [ScatterKernel], Option<&'a Medium>),
}

impl<'a> ScatterEvent<'a> {
    fn new(element: usize, going: Propagation, kind: Kind<'a>) -> Self {
        Self { element, going, kind, half_way: Default::default(), about_sources: Default::default() }
    }

    /// The event that light meets on the way back; `None` unless light leaves an interface to one side.
    fn way_back(&self) -> Option<Self> {
        let Kind::Interface(_, channel, _) = self.kind else { return None };
        let [leaves] = channel.leaves(self.going) else { return None };
        Some(Self::new(self.element, leaves.reversed(), self.kind))
    }

    /// Finds the directions that it also samples: half way between the view and the sources, and about the
    /// sources if light can meet other lobes before or after two of this one.
    pub(super) fn aim(&mut self, view: Cone, sources: &[Source], meets_many_lobes: bool) {
        let Some(back) = self.way_back() else { return };
        self.half_way = [&*self, &back].map(|event| Aims::half_way(event, view, sources));
        if meets_many_lobes {
            self.about_sources = Aims::about_sources(self, view, sources);
        }
    }

    /// True if light leaves it to one side, as it does from a lobe.
    pub(super) fn has_one_side(&self) -> bool {
        self.way_back().is_some()
    }

    /// Density of sampling a direction from the kernel of an interface; `None` unless light leaves an
    /// interface to one side.
    pub(super) fn density(&self, from: Beta, to: Beta) -> Option<f64> {
        let Kind::Interface(interface, channel, _) = self.kind else { return None };
        let [going] = *channel.leaves(self.going) else { return None };
        Some(interface.scatter(self.arrival(from, channel), Departure { beta: to, going }).density)
    }

    /// Samples the light of a source that an interface relays; `None` if it is absorbed.
    pub(super) fn relay(&self, beta: Beta, mut u: [f64; 4]) -> Option<OutgoingRay> {
        let [half_way, _] = &self.half_way;
        let mut middle = None;
        if !half_way.is_empty() {
            let is_half_way = u[0] < HALF_WAY;
            u[0] = if is_half_way { u[0] / HALF_WAY } else { (u[0] - HALF_WAY) / (1.0 - HALF_WAY) };
            middle = is_half_way.then(|| half_way.choose(&mut u[0])).flatten();
        }
        let (to, Scattered { value, density, reverse }) = self.sample(beta, middle, u)?;
        let density = of_relay(density, half_way.density(|middle| self.density(middle, to.beta)));
        Some(self.outgoing(to, Scattered { value, density, reverse }))
    }

    /// Samples light that an interface scatters, from its kernel for light of another direction if one is given;
    /// `None` if it is absorbed.
    fn sample(&self, beta: Beta, aim: Option<Beta>, u: [f64; 4]) -> Option<(Departure, Scattered)> {
        let Kind::Interface(interface, channel, _) = self.kind else { return None };
        let Some(aim) = aim else { return interface.sample(self.arrival(beta, channel), u) };
        let (to, _) = interface.sample(self.arrival(aim, channel), u)?;
        Some((to, interface.scatter(self.arrival(beta, channel), to)))
    }

    /// Sets `share` to the fraction of light that arrives and is scattered.
    pub(super) fn share(&self, skeleton: &Skeleton, field: &Field, share: &mut Share) {
        let ray = Ray::arriving_at(self.element, self.going);
        match self.kind {
            Kind::Base(..) | Kind::Pixel(..) => {
                return share.set(field, ray, |_| 1.0);
            }
            Kind::Interface(interface, channel, _) => {
                let fraction = interface.fraction(channel, self.going, skeleton.length(), self.disc());
                if let Some((total, factor)) = fraction {
                    return share.set(field, ray, |bin| total * factor[bin]);
                }
            }
            Kind::Bulk(_) => {}
        }
        let parts = skeleton.element(self.element);
        share.set(field, ray, |bin| parts[bin].scattered[self.going as usize]);
    }

    /// Light that leaves in a sampled direction.
    fn outgoing(&self, to: Departure, scattered: Scattered) -> OutgoingRay {
        let Scattered { value, density, reverse } = scattered;
        let ray = Ray::from_element(self.element, to.going);
        OutgoingRay { back: reverse, weight: value / density, ..OutgoingRay::exactly(to.beta, ray, density) }
    }

    /// Largest index of the medium that its light comes from.
    fn disc(&self) -> f64 {
        let Kind::Interface(_, _, media) = self.kind else { return 1.0 };
        media[self.going as usize].map_or(1.0, Medium::largest_index)
    }

    /// [Colours](ScatteringInterface::colours) of light that is scattered by an interface from one direction
    /// to another.
    pub(super) fn colours(&self, from: Beta, to: Beta) -> Colours {
        let Kind::Interface(interface, channel, _) = self.kind else { return Colours::default() };
        interface.colours(self.arrival(from, channel), to)
    }

    fn arrival(&self, beta: Beta, channel: Channel) -> Arrival {
        Arrival { beta, going: self.going, channel, disc: self.disc() }
    }

    /// The [spread](ScatteringInterface::spread) of light that leaves in this sense.
    fn spread_over(&self, going: Propagation, bin: usize) -> f64 {
        let Kind::Interface(interface, channel, media) = self.kind else { return 1.0 };
        let to = if going == Propagation::Up { media[0] } else { media[1] };
        let largest = to.map_or(1.0, Medium::largest_index);
        interface.spread(channel, self.going, [largest, index(to, bin)])
    }

    /// Factor on sampled light at a wavelength: 0 if the medium that the light is scattered into has no such
    /// direction.
    pub(super) fn carried(&self, sent: OutgoingRay, bin: usize) -> f64 {
        match self.kind {
            Kind::Interface(interface, _, media) if interface.scatters_beyond_media() => {
                let to = if sent.ray.going == Propagation::Up { media[0] } else { media[1] };
                let carried = sent.beta.squared() < index(to, bin).powi(2);
                if carried { self.spread_over(sent.ray.going, bin) } else { 0.0 }
            }
            _ => 1.0,
        }
    }

    /// Scattering at an interface: connections to sources, and new branches.
    ///
    /// A side to which little light leaves is followed by roulette.
    pub(super) fn pass_interface(
        &self,
        (number, sent): (usize, OutgoingRay),
        u: [f64; 4],
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let Kind::Interface(interface, channel, _) = self.kind else { return };
        let ways = channel.leaves(self.going);
        let rays = ways.iter().map(|going| Ray::from_element(self.element, *going));
        let from = self.arrival(sent.beta, channel);
        // The event of the way back relays light.
        let ([_, half_way], about) = (&self.half_way, &self.about_sources);
        let relayed = half_way.density(|middle| self.way_back()?.density(middle, sent.beta));
        let relayed =
            |scattered: Scattered| Scattered { reverse: of_relay(scattered.reverse, relayed), ..scattered };
        let scattered =
            |way: usize, beta| relayed(interface.scatter(from, Departure { beta, going: ways[way] }));
        let about_sources = |to| about.density(|aim| self.density(aim, to)).unwrap_or(0.0);
        let is_far = !about.is_empty() && about.closeness(about_sources(sent.beta)) < FAR;
        let further = |to| if is_far { ABOUT_SOURCES * about_sources(to) } else { 0.0 };
        // Light of a source that arrives has a direction that the medium there carries.
        let colours = ColoursAt::new(|to| interface.colours(from, to));
        let spread = |to, bin| self.spread_over(ways[0], bin) * colours.at(to, bin);
        sources::connect(rays, sent.density, (scattered, further), spread, sums, workspace);
        if let Some(sides) = interface.sample_sides(from, u) {
            let (brightest, directed) = (workspace.light.brightest(), workspace.lamps.directed);
            for (k, (side, probability)) in sides.into_iter().enumerate().filter(|(_, side)| side.1 > 0.0) {
                let survival = (probability * brightest / BRIGHT_SIDE).min(1.0);
                let survives = workspace.side_roulettes[2 * number + k].survives(survival);
                sums.unaccounted.add(&workspace.light, probability);
                if !survives {
                    continue;
                }
                let probability = probability / survival;
                sums.unaccounted.add(&workspace.light, -probability);
                let Some(to) = side else {
                    sums.absorbed.diffuser.add(&workspace.light, probability);
                    continue;
                };
                // Sampled in proportion to the kernel, whose value matters only if there are directed
                // sources.
                let scattered = if directed { interface.scatter(from, to) } else { Scattered::exactly(1.0) };
                let next =
                    OutgoingRay { rival: sent.density, weight: probability, ..self.outgoing(to, scattered) };
                workspace.branch_part(next, |_| probability);
            }
            return;
        }
        let next = |(to, scattered): (Departure, Scattered), is_aimed| {
            let scattered = relayed(scattered);
            let (own, rival) = (scattered.density, sent.density);
            let density = own + further(to.beta);
            let inherited = sent.prominence * about.closeness(about_sources(to.beta));
            let prominence = if own > 0.0 { inherited.max(density / own) } else { 1.0 };
            let outgoing = self.outgoing(to, Scattered { density, ..scattered });
            OutgoingRay { own, rival, is_aimed, prominence, ..outgoing }
        };
        let kept = |next: OutgoingRay, colours: &Colours, bin| {
            next.weight * self.carried(next, bin) * colours.at(bin)
        };
        if is_far && workspace.side_roulettes[2 * number].survives(ABOUT_SOURCES) {
            let mut u = u;
            let aim = about.choose(&mut u[0]);
            if let Some(aimed) = self.sample(sent.beta, aim, u) {
                let next = next(aimed, true);
                let colours = interface.colours(from, next.beta);
                let light = workspace.branch_part(next, |bin| kept(next, &colours, bin));
                sums.absorbed.diffuser.add(light, -1.0);
            }
        }
        let Some(own) = self.sample(sent.beta, None, u) else {
            workspace.light.keep(|_| 0.0, &mut sums.absorbed.diffuser);
            return;
        };
        let next = next(own, false);
        let colours = interface.colours(from, next.beta);
        workspace.light.keep(|bin| kept(next, &colours, bin), &mut sums.absorbed.diffuser);
        workspace.branch(next);
    }
}

/// Density of a direction that a relay samples from its kernel or from half way.
fn of_relay(own: f64, half_way: Option<f64>) -> f64 {
    half_way.map_or(own, |half_way| (1.0 - HALF_WAY) * own + HALF_WAY * half_way)
}

/// Colours of light by its direction: those of the last direction are kept.
struct ColoursAt<F> {
    of: F,
    last: RefCell<Option<(Beta, Colours)>>,
}

impl<F: Fn(Beta) -> Colours> ColoursAt<F> {
    fn new(of: F) -> Self {
        Self { of, last: RefCell::new(None) }
    }

    fn at(&self, to: Beta, bin: usize) -> f64 {
        let mut last = self.last.borrow_mut();
        let known = match &mut *last {
            Some(known) if known.0 == to => known,
            unknown => unknown.insert((to, (self.of)(to))),
        };
        known.1.at(bin)
    }
}

/// All scattering events that a stack has.
pub(super) fn events(stack: &Stack, horizons: Option<Horizons>) -> Vec<ScatterEvent<'_>> {
    const BOTH_WAYS: [Propagation; 2] = [Propagation::Down, Propagation::Up];
    let mut events = Vec::new();
    for (element, (layer, media)) in stack.elements().enumerate() {
        let Some(interface) = layer.scattering_interface() else { continue };
        for going in BOTH_WAYS {
            let channels = interface.channels(going).into_iter();
            let interface = SampledInterface::new(interface, horizons);
            let kind = |channel| Kind::Interface(interface, channel, media);
            events.extend(channels.map(|channel| ScatterEvent::new(element, going, kind(channel))));
        }
    }
    let mut media = 0;
    for (i, layer) in stack.layers.iter().enumerate() {
        if let Some(bulk) = Bulk::new((2 * i + 1, media), &layer.medium, horizons) {
            media += 1;
            let kind = Kind::Bulk(bulk);
            events.extend(BOTH_WAYS.map(|going| ScatterEvent::new(2 * i + 1, going, kind)));
        }
    }
    // From the top: numbers of random decisions depend on the order.
    events.sort_by_key(|event| event.element);
    let upper = stack.layers.last().map(|layer| &layer.medium);
    let base = match &stack.base().reflector {
        Reflector::Specular(_) => None,
        Reflector::Lambertian(_) => Some(Kind::Base(upper)),
        Reflector::Scattering(kernels) => Some(Kind::Pixel(kernels, upper)),
    };
    let element = 2 * stack.layers.len();
    events.extend(base.map(|kind| ScatterEvent::new(element, Propagation::Down, kind)));
    events
}

/// The index of a medium, or of air.
fn index(medium: Option<&Medium>, bin: usize) -> f64 {
    medium.map_or(1.0, |medium| medium.index()[bin])
}

/// Reflection by a Lambertian base, under this medium: the same basic radiance in every direction of the
/// medium.
///
/// Bright light is followed in two directions: one that a flat interface lets out into the air, and one
/// beyond.
pub(super) fn at_lambertian_base(
    (reflectance, medium): (&[f64], Option<&Medium>),
    (element, horizons): (usize, Option<&Horizons>),
    u: [f64; 4],
    sums: &mut Sums,
    workspace: &mut Workspace,
) {
    let light = &mut workspace.light;
    sums.arriving.add(light, 1.0);
    workspace.meetings = workspace.meetings.saturating_add(1);
    light.meet(reflectance);
    sums.reflected.add(light, 1.0);

    let ray = Ray { plane: element, going: Propagation::Up };
    let largest = medium.map_or(1.0, Medium::largest_index);
    // Over the disc of each wavelength, where the value is that of the largest.
    let density = warp::uniform_disc_density(largest);
    let spread = |beta: Beta, bin| {
        let n = index(medium, bin);
        if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 }
    };
    let drawn = |to: Beta| emitted_density(horizons, largest, to);
    let scattered = |_, to: Beta| Scattered { value: density, density: drawn(to), reverse: density };
    sources::connect([ray].into_iter(), f64::INFINITY, (scattered, |_| 0.0), spread, sums, workspace);

    let (within, brightest) = (largest.powi(-2), workspace.light.brightest());
    let in_two = brightest * within.min(1.0 - within) >= BRIGHT_SIDE;
    if let Some(controls) = &mut workspace.controls {
        controls.emission(brightest, u[0], in_two);
    }
    if in_two {
        sums.unaccounted.add(&workspace.light, 1.0);
        let near = emitted(horizons, 1.0, [u[0], u[1]]);
        let of_near = within * warp::uniform_disc_density(1.0) / emitted_density(horizons, 1.0, near);
        let (far_x, far_y) = warp::polar((1.0 + u[0] * (largest * largest - 1.0)).sqrt(), u[1]);
        for (beta, part) in [(Beta { x: far_x, y: far_y }, 1.0 - within), (near, of_near)] {
            let next = OutgoingRay::exactly(beta, ray, drawn(beta));
            let light = workspace.branch_part(next, |bin| part * spread(beta, bin));
            sums.unaccounted.add(light, -1.0);
        }
        return;
    }
    let out = emitted(horizons, largest, [u[0], u[1]]);
    let drawn = drawn(out);
    workspace.light.keep(|bin| spread(out, bin) * density / drawn, &mut sums.unaccounted);
    workspace.branch(OutgoingRay::exactly(out, ray, drawn));
}

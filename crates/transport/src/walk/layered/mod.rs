//! The general tracer: any layers in any order, over a mirror or a base that scatters.
//!
//! Between two scattering events light keeps its direction cosines. Its transport is then known in closed
//! form, with all inter-reflections of flat parts and of a specular base ([`Skeleton`](crate::skeleton)): the
//! light that leaves, the light that each layer absorbs, and the light that arrives at each scatterer from
//! either side. The first two are added to the sums directly. Random are only the directions of scattered
//! light, the flights in a scattering medium, and the choice of the next scatterer where the light is faint.
//!
//! A path is a tree of branches. A choice between bright alternatives is not drawn: light that a scatterer
//! reflects and light that it transmits, light that can leave and light that is trapped, are all followed
//! with their weights ([`BRIGHT`]). Results then depend smoothly on the random numbers. Faint branches are
//! chosen by Russian roulette, so that the expected number of branches is bounded.
//!
//! Many paths are followed side by side, so that their decisions complement each other ([`generation`]).
//!
//! Directions do not depend on state or wavelength; a branch carries a factor for each
//! ([`Light`](light::Light)). What the layers do is computed once where they are the same at every
//! wavelength. Light that has met the base and light that has not are separate.
//!
//! # A pixel that is the same everywhere
//! Two things rely on a pixel that is the same at all points of its plane: [`columns`], and the closed form
//! of inter-reflections, which does not know where light meets the pixel. Light over a pixel with a pattern
//! is followed by [`places`](super::places). The tracer without any closed form, which tests this one, is
//! [`Plain`](super::Plain).

mod aims;
mod bulk;
mod columns;
mod controls;
mod generation;
mod ledger;
mod light;
mod orders;
mod pixel;
mod scatterers;
mod sources;
#[cfg(test)]
mod tests;

use std::borrow::Cow;
use std::ops::Range;

use papilio_optics::Beta;
use papilio_sampling::SampleStream;

use super::PathNumbers;
use super::horizon::Horizons;
use crate::estimate::Account;
use crate::skeleton::Ray;
use crate::{Base, Cone, Medium, Reflector, Source};
use bulk::Outcome;
use columns::Columns;
use generation::{Arrived, Decision, GenerationNumbers, Roulette, Travelling, key, order};
pub(super) use ledger::Accumulator;
use ledger::{Sums, Workspace};
use light::Light;
use pixel::Pixel;
use scatterers::{Kind, ScatterEvent, at_lambertian_base, events};

/// Light of which at least this fraction takes part in an event, in any state and wavelength, is followed to
/// this event, and in addition to others. Fainter light continues by roulette, with at least this weight.
const BRIGHT: f64 = 0.1;

/// The same fraction for the two directions of one event. It is lower, since one of them often leaves the
/// display.
const BRIGHT_SIDE: f64 = 0.01;

/// After its first event a path continues with at least this probability, if it can continue at all:
/// otherwise light from sources at faint scatterers would make rare bright paths.
const LEAST_SURVIVAL: f64 = 0.05;

/// In the first events of a path this much of the probability is divided equally among the scatterers,
/// whatever light they receive: some light may be seen through a faint one only, and no replicate may miss
/// it.
const WITHOUT_REGARD: f64 = 0.1;
const FIRST_EVENTS: u32 = 4;

/// Branches with this many meetings with the pixel, or more, are ordered together.
const MOST_MEETINGS: u32 = 3;

/// From this event on, roulette applies even if nothing absorbs.
const FREE_EVENTS: u32 = 256;

#[derive(Debug)]
pub(super) struct Layered<'a> {
    stack: &'a crate::Stack,
    /// The spectra that paths carry instead of those of the base.
    columns: Option<Columns>,
    view: Cone,
    sources: Cow<'a, [Source]>,
    /// Where lobes of the stack have no bound.
    horizons: Option<Horizons>,
    /// All kinds of scattering events.
    events: Vec<ScatterEvent<'a>>,
    /// Account of the absorption of each element.
    accounts: Vec<Account>,
    discs: bool,
    /// True if there are sources with directions.
    directed: bool,
    /// Largest index of all media.
    largest_index: f64,
    /// The number of paths that are followed side by side.
    batch: u64,
}

/// Light that starts its way through the flat skeleton.
#[derive(Debug, Clone, Copy)]
struct OutgoingRay {
    beta: Beta,
    ray: Ray,
    /// Density over direction cosines with which `beta` was sampled; infinite if it was never scattered.
    density: f64,
    /// Density with which the same scatterer would sample the way back.
    back: f64,
    /// Value of the kernel over that density.
    weight: f64,
    /// Density with which the path chose its direction before, where the scatterer also relays light of
    /// the sources; otherwise infinite.
    rival: f64,
    /// The part of `density` of the scatterer's own kernel; directions about sources have the rest.
    own: f64,
    /// True if `beta` was sampled about a source.
    is_aimed: bool,
    /// How much fainter its light is than light that was not sampled about sources, at least 1: near a source
    /// other lobes show both as equally bright.
    prominence: f64,
}

impl OutgoingRay {
    /// Light that has not been scattered.
    const UNSCATTERED: Self = Self {
        beta: Beta { x: 0.0, y: 0.0 },
        ray: Ray::ENTERING,
        density: f64::INFINITY,
        back: f64::INFINITY,
        weight: 1.0,
        rival: f64::INFINITY,
        own: f64::INFINITY,
        is_aimed: false,
        prominence: 1.0,
    };

    /// Light sampled in proportion to a reciprocal kernel.
    fn exactly(beta: Beta, ray: Ray, density: f64) -> Self {
        Self { density, back: density, own: density, beta, ray, ..Self::UNSCATTERED }
    }
}

/// Light of each source that a branch has gathered in a scattering medium, upwards and downwards.
type Gathered = Vec<[f64; 2]>;

/// Largest number of paths that are followed side by side, and of the numbers that their sampled sources
/// occupy.
const LARGEST_BATCH: usize = 1 << 10;
const MOST_NUMBERS: usize = 1 << 20;

/// Largest probability with which a branch may continue.
///
/// The number of events in thick layers that absorb nothing has a long tail, n^(-1/2). Roulette that ends
/// paths like n^(-0.45) from there on bounds their mean cost and leaves the variance finite; any fixed
/// probability would not.
fn most_survival(generation: u32) -> f64 {
    if generation < FREE_EVENTS { 1.0 } else { 1.0 - 0.45 / f64::from(generation) }
}

impl<'a> Layered<'a> {
    /// Prepares a walk.
    pub(super) fn new(stack: &'a crate::Stack, view: Cone, sources: impl Into<Cow<'a, [Source]>>) -> Self {
        let sources = sources.into();
        let discs = sources.iter().any(Source::has_radiance);
        let accounts = stack.elements().map(|(kind, _)| kind.account()).collect();
        let largest_index = stack.layers.iter().map(|layer| layer.medium.largest_index()).fold(1.0, f64::max);
        let columns = Columns::new(stack);
        let horizons = Horizons::of(stack);
        let mut events = events(stack, horizons);
        let lobes = events.iter().filter(|event| event.has_one_side()).count();
        events.iter_mut().for_each(|event| event.aim(view, &sources, lobes > 2));
        let base = columns.as_ref().map_or(stack.base(), |columns| &columns.base);
        // Light of two branches, and light and fields of what each source sends on.
        let interfaces = events.iter().filter(|event| matches!(event.kind, Kind::Interface(..))).count();
        let directed = sources.iter().filter(|source| **source != Source::Diffuse).count();
        let lights = 2 + 4 * directed * (1 + 2 * interfaces);
        let size = MOST_NUMBERS / (lights * (base.states() + 1) * base.bins());
        let batch = 1 << size.clamp(16, LARGEST_BATCH).ilog2();
        Self {
            stack,
            columns,
            view,
            sources,
            horizons,
            events,
            accounts,
            discs,
            directed: directed > 0,
            largest_index,
            batch,
        }
    }

    /// Lets paths carry a factor for each state and wavelength, whatever the pixel.
    #[cfg(test)]
    fn with_full_spectra(mut self) -> Self {
        self.columns = None;
        self
    }

    /// As [`Walk::rarest`](super::Walk::rarest).
    pub(super) fn rarest(&self) -> f64 {
        if self.events.is_empty() {
            return 1.0;
        }
        // Light that a thin layer traps by total internal reflection is scattered again with a low
        // probability, and mostly into other trapped directions: it leaves after three improbable decisions.
        let is_thin = |medium: &Medium| {
            medium.scattering().is_some_and(|scattering| scattering.optical_thickness < bulk::THIN)
        };
        let decisions = if self.stack.layers.iter().any(|layer| is_thin(&layer.medium)) { 3 } else { 1 };
        (WITHOUT_REGARD / self.events.len() as f64).min(LEAST_SURVIVAL.powi(decisions))
    }

    /// The base, with the spectra that paths carry.
    fn base(&self) -> &Base {
        self.columns.as_ref().map_or(self.stack.base(), |columns| &columns.base)
    }

    /// True if there are events that [`controls`] describes. Directions towards horizons beyond a lobe have
    /// weights of any small size, for which no regression is stable.
    fn has_controls(&self) -> bool {
        let described = self.events.iter().any(|event| matches!(event.kind, Kind::Bulk(_) | Kind::Base(_)));
        described && self.horizons.is_none()
    }

    /// Traces paths, in batches.
    pub(super) fn paths(&self, numbers: &SampleStream, paths: Range<u64>, tally: &mut Accumulator) {
        let size = self.batch;
        let mut start = paths.start;
        while start < paths.end {
            let end = (start / size + 1).saturating_mul(size).min(paths.end);
            self.batch(numbers, start..end, tally);
            start = end;
        }
        tally.workspace.next.shrink();
        tally.workspace.lamps.shrink();
        if let Some(controls) = &mut tally.workspace.controls {
            controls.shrink();
        }
    }

    /// Returns the number of paths that are followed side by side.
    pub(super) fn batch_size(&self) -> u64 {
        self.batch
    }

    /// Traces the paths of a batch, all together.
    fn batch(&self, numbers: &SampleStream, paths: Range<u64>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace } = tally;
        let count = (paths.end - paths.start) as usize;
        let of = |k: usize| PathNumbers::new(numbers, paths.start + k as u64);
        workspace.lamps.draw((0..count).map(of), self);
        if let Some(controls) = &mut workspace.controls {
            controls.begin(count, &sums.received);
        }
        workspace.light.start();
        workspace.meetings = 0;
        for path in 0..count {
            workspace.lamps.path = path;
            let beta = self.view.sample_towards(of(path).field());
            workspace.branch(OutgoingRay { beta, ..OutgoingRay::UNSCATTERED });
        }
        let mut generation = 0;
        while !workspace.next.is_empty() {
            let numbers = GenerationNumbers::new(numbers, generation, paths.start);
            self.travel(generation, &numbers, sums, workspace);
            self.scatter(generation, &numbers, sums, workspace);
            generation = generation.saturating_add(1);
        }
        if let Some(controls) = &mut workspace.controls {
            controls.end(&mut sums.received);
        }
    }

    /// Follows all branches that travel to their next events.
    fn travel(
        &self,
        generation: u32,
        numbers: &GenerationNumbers,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let mut travelling = std::mem::take(&mut workspace.next.travelling);
        let mut roulettes = numbers.roulettes(Decision::Arrival, self.events.len());
        let order = order(&travelling, |branch| self.key_of_ray(branch));
        for k in order {
            let Travelling { path, meetings, sent, light } = &travelling[k];
            workspace.exchange(*path, sums);
            workspace.meetings = *meetings;
            self.leave(*sent, light, sums, workspace);
            self.arrive((*sent, light), generation, &mut roulettes, sums, workspace);
            workspace.exchange(*path, sums);
        }
        for branch in travelling.drain(..) {
            workspace.next.recycle(branch.light);
        }
    }

    /// Performs the events of all branches that have arrived.
    fn scatter(
        &self,
        generation: u32,
        numbers: &GenerationNumbers,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let mut arrived = std::mem::take(&mut workspace.next.arrived);
        let order = order(&arrived, |branch| self.key_of_event(branch));
        workspace.side_roulettes = numbers.roulettes(Decision::Sides, 2 * self.events.len());
        for (rank, k) in order.into_iter().enumerate() {
            let branch = &mut arrived[k];
            let path = branch.path;
            workspace.exchange(path, sums);
            workspace.meetings = branch.meetings;
            std::mem::swap(&mut workspace.light, &mut branch.light);
            std::mem::swap(&mut workspace.gathered, &mut branch.gathered);
            self.perform(branch, (generation, numbers.of(rank)), sums, workspace);
            workspace.exchange(path, sums);
        }
        for branch in arrived.drain(..) {
            workspace.next.recycle(branch.light);
        }
    }

    /// Position of a branch among others between two events.
    fn key_of_ray(&self, branch: &Travelling) -> u64 {
        let Travelling { meetings, sent, light, .. } = branch;
        let meetings = (*meetings).min(MOST_MEETINGS) as usize;
        let planes = 2 * self.stack.layers.len() + 1;
        let class = 2 * (planes * meetings + sent.ray.plane) + sent.ray.going as usize;
        key(class, [sent.beta.squared() / self.largest_index.powi(2), light.brightest()])
    }

    /// Position of a branch among others at an event: those at the same event are neighbours if they are at
    /// similar places.
    fn key_of_event(&self, branch: &Arrived) -> u64 {
        let Arrived { event, sent, stay, light, .. } = branch;
        let kind = &self.events[*event].kind;
        let class = 2 * event + usize::from(stay.is_some());
        let beta = |beta: f64| 0.5 + 0.5 * beta / self.largest_index;
        match (kind, stay) {
            (Kind::Base(_), _) => key(class, [light.brightest()]),
            (Kind::Bulk(bulk), Some(stay)) => {
                let [depth, z, x, y] = bulk.place(stay);
                if self.directed { key(class, [depth, z, x, y]) } else { key(class, [depth, z]) }
            }
            _ if self.directed => key(class, [beta(sent.beta.x), beta(sent.beta.y)]),
            _ => key(class, [sent.beta.squared() / self.largest_index.powi(2)]),
        }
    }

    /// Adds all that happens to a branch's light without scattering.
    fn leave(&self, sent: OutgoingRay, light: &Light, sums: &mut Sums, workspace: &mut Workspace) {
        workspace.skeleton.set(self.stack, self.base(), sent.beta);
        workspace.skeleton.emit(sent.ray, &mut workspace.field);
        self.record(light, sums, workspace);
        let Workspace { field, share, .. } = workspace;
        share.set(field, Ray::LEAVING, |_| 1.0);
        sums.received.leaving.add_share(light, share, &field.rising, 1.0);
        if sent.density.is_finite() && !sent.is_aimed {
            sources::meet_discs(&self.sources, sent, (light, share, &field.rising), sums);
        }
    }

    /// Lets a branch's light arrive at the events that it takes part in: at each of the bright ones, and at
    /// others by roulette.
    ///
    /// The probability of a faint event is proportional to the largest fraction of any state's and
    /// wavelength's light that takes part in it, times the light's prominence. In the first events it has a
    /// lower limit, so that weights grow by a tenth at most.
    fn arrive(
        &self,
        (sent, light): (OutgoingRay, &Light),
        generation: u32,
        roulettes: &mut [Roulette],
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let most = most_survival(generation);
        let (mut faint, mut count) = (0.0, 0.0);
        for (i, event) in self.events.iter().enumerate() {
            event.share(&workspace.skeleton, &workspace.field, &mut workspace.share);
            let chance = sent.prominence * light.largest(&workspace.share, &workspace.field.rising);
            workspace.chances[i] = chance;
            if chance > 0.0 && (chance < BRIGHT || most < 1.0) {
                sums.unaccounted.add_share(light, &workspace.share, &workspace.field.rising, 1.0);
                (faint, count) = (faint + chance, count + 1.0);
            }
        }
        let least = if generation > 0 { LEAST_SURVIVAL } else { 1.0 };
        let survival = (faint / BRIGHT).min(1.0).max(least).min(most);
        let each = if generation < FIRST_EVENTS { WITHOUT_REGARD * faint / count } else { 0.0 };
        let all = faint + count * each;
        for (i, event) in self.events.iter().enumerate() {
            let chance = workspace.chances[i];
            let is_faint = chance < BRIGHT || most < 1.0;
            let probability = if is_faint { survival * (chance + each) / all } else { 1.0 };
            if chance > 0.0 && (!is_faint || roulettes[i].survives(probability)) {
                workspace.carry(light, event, 1.0 / probability);
                if is_faint {
                    sums.unaccounted.add(&workspace.light, -1.0);
                }
                let of = (workspace.lamps.path, workspace.meetings);
                workspace.next.arrive(of, i, sent, &workspace.light);
            }
        }
    }

    /// Performs an event on the light of the workspace: connections to sources, and new branches.
    fn perform(
        &self,
        branch: &mut Arrived,
        (generation, u): (u32, [f64; 4]),
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let (event, sent) = (&self.events[branch.event], branch.sent);
        let next = match event.kind {
            Kind::Bulk(bulk) => {
                let outcome = match &mut branch.stay {
                    Some(stay) => bulk.deflect(stay, u, generation, sums, workspace),
                    entering => {
                        *entering = Some(bulk.enter((sent.beta, event.going), u[0], sums, workspace));
                        Outcome::Within
                    }
                };
                match outcome {
                    Outcome::Ended => return,
                    Outcome::Within => return workspace.stay(branch),
                    Outcome::Left(next) => Some(next),
                }
            }
            Kind::Base(medium) => {
                let Reflector::Lambertian(reflectance) = &self.base().reflector else { return };
                let of = (event.element, self.horizons.as_ref());
                return at_lambertian_base((reflectance, medium), of, u, sums, workspace);
            }
            Kind::Pixel(kernels, medium) => {
                let pixel =
                    Pixel { kernels, medium, element: event.element, horizons: self.horizons.as_ref() };
                pixel.reflect(sent.beta, [u[0], u[1], u[2]], sums, workspace)
            }
            Kind::Interface(..) => return event.pass_interface((branch.event, sent), u, sums, workspace),
        };
        if let Some(next) = next {
            workspace.branch(next);
        }
    }
}

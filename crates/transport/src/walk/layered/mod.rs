//! The general tracer: any layers in any order, over a mirror or a base that scatters.
//!
//! Between two scattering events light keeps its direction cosines. Its transport is then known in closed form, with all
//! inter-reflections of flat parts and of a specular base ([`Skeleton`](crate::skeleton)): the light that leaves, the
//! light that each layer absorbs, and the light that arrives at each scatterer from either side. The first two are
//! added to the sums directly. Random are only the directions of scattered light, the flights in a scattering medium, and
//! the choice of the next scatterer where the light is faint.
//!
//! A path is a tree of [`Branch`]es. A choice between bright alternatives is not drawn: light that a scatterer reflects
//! and light that it transmits, light that can leave and light that is trapped, are all followed with their weights
//! ([`BRIGHT`]). Results then depend smoothly on the random numbers, and low-discrepancy points integrate them well. Faint
//! branches are chosen by Russian roulette, so that the expected number of branches is bounded.
//!
//! Directions do not depend on state or wavelength; a branch carries a factor for each ([`Light`](light::Light)). What the
//! layers do is computed once where they are the same at every wavelength. Light that has met the base and light that has
//! not are separate.

mod bulk;
mod columns;
mod controls;
mod ledger;
mod light;
mod pixel;
mod scatterers;
mod sources;

use papilio_optics::Beta;
use papilio_sampling::PLANNED_BLOCKS;

use super::PathNumbers;
use crate::estimate::Account;
use crate::skeleton::Ray;
use crate::{Base, Cone, Medium, Reflector, Source};
use columns::Columns;
pub(super) use ledger::Accumulator;
use ledger::{Sums, Workspace};
use light::Light;
use pixel::Pixel;
use scatterers::{Kind, ScatterEvent, at_lambertian_base, events};

/// Light of which at least this fraction takes part in an event, in any state and wavelength, is followed to this event,
/// and in addition to others. Fainter light continues by roulette, with at least this weight.
const BRIGHT: f64 = 0.1;

/// The same fraction for the two directions of one event. It is lower, since one of them often leaves the display.
const BRIGHT_SIDE: f64 = 0.01;

/// After its first event a path continues with at least this probability, if it can continue at all: otherwise
/// light from sources at faint scatterers would make rare bright paths.
const LEAST_SURVIVAL: f64 = 0.05;

/// In the first events of a path this much of the probability is divided equally among the scatterers, whatever light
/// they receive: some light may be seen through a faint one only, and no replicate may miss it.
const WITHOUT_REGARD: f64 = 0.1;
const FIRST_EVENTS: u32 = 4;

/// From this event on, roulette applies even if nothing absorbs.
const FREE_EVENTS: u32 = 256;

#[derive(Debug)]
pub(super) struct Layered<'a> {
    stack: &'a crate::Layered,
    /// The spectra that paths carry instead of those of the base.
    columns: Option<Columns>,
    view: Cone,
    sources: &'a [Source],
    /// All kinds of scattering events.
    events: Vec<ScatterEvent<'a>>,
    /// Account of the absorption of each element.
    accounts: Vec<Account>,
    discs: bool,
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
    };

    /// Light sampled in proportion to a reciprocal kernel.
    fn exactly(beta: Beta, ray: Ray, density: f64) -> Self {
        Self { beta, ray, density, back: density, weight: 1.0, rival: f64::INFINITY }
    }
}

/// Light that waits to be followed: a branch of a path.
#[derive(Debug, Clone)]
struct Branch {
    sent: OutgoingRay,
    light: Light,
}

/// Random numbers of a path in counted blocks.
struct RandomNumbers<'a> {
    numbers: &'a PathNumbers<'a>,
    count: u32,
    /// True if one planned block belongs to the sources.
    reserved: bool,
}

impl RandomNumbers<'_> {
    fn next(&mut self) -> [f64; 4] {
        self.count = self.count.saturating_add(1);
        let free = if self.reserved { PLANNED_BLOCKS - 1 } else { PLANNED_BLOCKS };
        let skipped = u32::from(self.reserved && self.count >= free);
        self.numbers.block(self.count.saturating_add(skipped))
    }

    /// Largest probability with which the path may continue.
    ///
    /// The number of events in thick layers that absorb nothing has a long tail, n^(-1/2). Roulette
    /// that ends paths like n^(-0.45) from there on bounds their mean cost and leaves the
    /// variance finite; any fixed probability would not.
    fn most_survival(&self) -> f64 {
        if self.count < FREE_EVENTS { 1.0 } else { 1.0 - 0.45 / f64::from(self.count) }
    }
}

impl<'a> Layered<'a> {
    pub(super) fn new(stack: &'a crate::Layered, view: Cone, sources: &'a [Source]) -> Self {
        let discs = sources.iter().any(Source::has_radiance);
        let accounts = stack.elements().map(|(kind, _)| kind.account()).collect();
        Self { stack, columns: Columns::new(stack), view, sources, events: events(stack), accounts, discs }
    }

    /// As [`Walk::rarest`](super::Walk::rarest).
    pub(super) fn rarest(&self) -> f64 {
        if self.events.is_empty() {
            return 1.0;
        }
        // Light that a thin layer traps by total internal reflection is scattered again with a low probability, and mostly
        // into other trapped directions: it leaves after three improbable decisions.
        let is_thin = |medium: &Medium| {
            medium.scattering().is_some_and(|scattering| scattering.optical_thickness < bulk::THIN)
        };
        let decisions = if self.stack.layers.iter().any(|layer| is_thin(&layer.medium)) { 3 } else { 1 };
        (WITHOUT_REGARD / self.events.len() as f64).min(LEAST_SURVIVAL.powi(decisions))
    }

    /// The base, with the spectra that paths carry.
    fn base(&self) -> &Base {
        self.columns.as_ref().map_or(&self.stack.base, |columns| &columns.base)
    }

    /// True if the base scatters: the skeleton then ends in black.
    fn base_scatters(&self) -> bool {
        !self.stack.base.is_specular()
    }

    /// True if there are events that [`controls`] describes.
    fn has_controls(&self) -> bool {
        self.events.iter().any(|event| matches!(event.kind, Kind::Bulk(_) | Kind::Base(_)))
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace } = tally;
        if let Some(controls) = &mut workspace.controls {
            controls.begin(numbers.path, sums);
        }
        workspace.lamps.draw(numbers, self, &mut workspace.skeleton);
        let mut draws = RandomNumbers { numbers, count: 0, reserved: workspace.lamps.has_relays() };
        let beta = self.view.sample_towards(numbers.field());
        workspace.light.start();
        workspace.branch(OutgoingRay { beta, ray: Ray::ENTERING, ..OutgoingRay::UNSCATTERED });
        while let Some(Branch { sent, light }) = workspace.pending.pop() {
            self.travel(sent, &light, sums, workspace);
            self.continue_path(sent, &light, &mut draws, sums, workspace);
            workspace.spare.push(light);
        }
        if let Some(controls) = &mut workspace.controls {
            controls.end(numbers.path, sums);
        }
    }

    /// Adds all that happens to a branch's light without scattering.
    fn travel(&self, sent: OutgoingRay, light: &Light, sums: &mut Sums, workspace: &mut Workspace) {
        workspace.skeleton.set(self.stack, self.base(), sent.beta.squared());
        workspace.skeleton.emit(sent.ray, &mut workspace.field);
        self.record(light, sums, workspace);
        let Workspace { field, share, .. } = workspace;
        share.set(field, Ray::LEAVING, |_| 1.0);
        sums.leaving.add_share(light, share, &field.rising, 1.0);
        if sent.density.is_finite() {
            sources::meet_discs(self.sources, sent, (light, share, &field.rising), sums);
        }
    }

    /// Performs the events that a branch's light takes part in: each of the bright ones, and at most one of the others.
    fn continue_path(
        &self,
        sent: OutgoingRay,
        light: &Light,
        draws: &mut RandomNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let most = draws.most_survival();
        let mut faint = 0.0;
        for (i, event) in self.events.iter().enumerate() {
            event.share(&workspace.skeleton, &workspace.field, &mut workspace.share);
            let chance = light.largest(&workspace.share, &workspace.field.rising);
            workspace.chances[i] = chance;
            if chance < BRIGHT || most < 1.0 {
                sums.unaccounted.add_share(light, &workspace.share, &workspace.field.rising, 1.0);
                faint += chance;
            }
        }
        // The field belongs to this branch: others wait until all events are done.
        if most == 1.0 {
            for (i, event) in self.events.iter().enumerate() {
                if workspace.chances[i] >= BRIGHT {
                    workspace.chances[i] = 0.0;
                    workspace.carry(light, event, 1.0);
                    self.scatter(sent, event, draws, sums, workspace);
                }
            }
        }
        if faint > 0.0 {
            let least = if sent.density.is_finite() { LEAST_SURVIVAL } else { 1.0 };
            let survival = (faint / BRIGHT).min(1.0).max(least).min(most);
            if let Some((event, scale)) = self.choose(survival, draws, workspace) {
                workspace.carry(light, event, scale);
                sums.unaccounted.add(&workspace.light, -1.0);
                self.scatter(sent, event, draws, sums, workspace);
            }
        }
    }

    /// Chooses one of the faint events, and the factor of its light; `None` if the branch ends.
    ///
    /// The probability of an event is proportional to the largest fraction of any state's and wavelength's light that
    /// takes part in it. In the first events it has a lower limit, so that weights grow by a tenth at most.
    fn choose(
        &self,
        survival: f64,
        draws: &mut RandomNumbers<'_>,
        workspace: &mut Workspace,
    ) -> Option<(&ScatterEvent<'a>, f64)> {
        let [u, ..] = draws.next();
        if u >= survival {
            return None;
        }
        let faint = workspace.chances.iter().sum::<f64>();
        let first = draws.count <= FIRST_EVENTS;
        let each = if first { WITHOUT_REGARD * faint / self.events.len() as f64 } else { 0.0 };
        let mut chances = 0.0;
        for chance in workspace.chances.iter_mut().filter(|chance| **chance > 0.0) {
            *chance += each;
            chances += *chance;
        }
        let mut below = u / survival * chances;
        let chosen = workspace.chances.iter().position(|chance| {
            below -= chance;
            below < 0.0
        })?;
        Some((&self.events[chosen], chances / (survival * workspace.chances[chosen])))
    }

    /// Performs the event on the light of the workspace: connections to sources, and new branches.
    fn scatter(
        &self,
        sent: OutgoingRay,
        event: &ScatterEvent<'_>,
        draws: &mut RandomNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let u = draws.next();
        let next = match event.kind {
            Kind::Bulk(bulk) => {
                bulk.stay((sent.beta, event.going), [u[0], u[1], u[2]], draws, sums, workspace)
            }
            Kind::Base(medium) => {
                let Reflector::Lambertian(reflectance) = &self.base().reflector else { return };
                return at_lambertian_base((reflectance, medium), event.element, u, sums, workspace);
            }
            Kind::Pixel(kernels, medium) => {
                let pixel = Pixel { kernels, medium, element: event.element };
                pixel.reflect(sent.beta, [u[0], u[1], u[2]], sums, workspace)
            }
            Kind::Interface(..) => return event.pass_interface(sent, u, sums, workspace),
        };
        if let Some(next) = next {
            workspace.branch(next);
        }
    }
}

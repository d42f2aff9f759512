//! The general tracer: any layers in any order, over a mirror or a base that scatters.
//!
//! Between two scattering events light keeps its direction cosines. Its transport is then known in closed form, with all
//! inter-reflections of flat parts and of a specular base ([`Skeleton`](crate::skeleton)): the light that leaves, the
//! light that each layer absorbs, and the light that arrives at each scatterer from either side. The first two are
//! added to the sums directly. Random are only the choice of the next scatterer (or the end of the path) and the event
//! itself: scattering at an interface, flights through a scattering medium, reflection by a scattering base.
//!
//! Light that has met the base and light that has not share one path, with separate spectra.

mod bulk;
mod ledger;
mod light;
mod pixel;
mod scatterers;
mod sources;

use papilio_optics::Beta;
use papilio_sampling::PLANNED_BLOCKS;

use super::{PathNumbers, add_scaled};
use crate::estimate::Account;
use crate::skeleton::Ray;
use crate::{Cone, Medium, Source};
pub(super) use ledger::Accumulator;
use ledger::{Sums, Workspace};
use pixel::Pixel;
use scatterers::{Kind, ScatterEvent, at_lambertian_base, events};

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

/// Random numbers of a path in counted blocks.
struct RandomNumbers<'a> {
    numbers: &'a PathNumbers<'a>,
    count: u32,
}

impl RandomNumbers<'_> {
    fn next(&mut self) -> [f64; 4] {
        self.count = self.count.saturating_add(1);
        // One planned block belongs to the sources.
        let block = if self.count < PLANNED_BLOCKS - 1 { self.count } else { self.count.saturating_add(1) };
        self.numbers.block(block)
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
        Self { stack, view, sources, events: events(stack), accounts, discs }
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

    /// True if the base scatters: the skeleton then ends in black.
    fn base_scatters(&self) -> bool {
        !self.stack.base.is_specular()
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace } = tally;
        workspace.lamps.draw(numbers, self, &mut workspace.skeleton);
        workspace.light.start();
        let mut draws = RandomNumbers { numbers, count: 0 };
        let beta = self.view.sample_towards(numbers.field());
        let mut sent = OutgoingRay { beta, ray: Ray::ENTERING, ..OutgoingRay::UNSCATTERED };
        while !workspace.light.is_dark() {
            self.travel(sent, sums, workspace);
            let u = draws.next();
            let least = if sent.density.is_finite() { LEAST_SURVIVAL } else { 1.0 };
            let survival = (least, draws.most_survival());
            let first = draws.count <= FIRST_EVENTS;
            let Some(event) = self.choose(u[0], survival, first, sums, workspace) else { return };
            let Some(next) = self.scatter(sent, event, [u[1], u[2], u[3]], &mut draws, sums, workspace)
            else {
                return;
            };
            sent = next;
        }
    }

    /// Adds all that happens to the path's light without scattering.
    fn travel(&self, sent: OutgoingRay, sums: &mut Sums, workspace: &mut Workspace) {
        workspace.skeleton.set(self.stack, sent.beta.squared());
        workspace.skeleton.emit(sent.ray, &mut workspace.field);
        self.record(sums, workspace);
        let Workspace { light, field, share, .. } = workspace;
        share.set(field, Ray::LEAVING, |_| 1.0);
        sums.leaving.add_share(light, share, &field.rising, 1.0);
        if sent.density.is_finite() {
            sources::meet_discs(self.sources, sent, (light, share, &field.rising), sums);
        }
    }

    /// Chooses the next event and reduces the path's light to what takes part in it; `None` if the path ends.
    ///
    /// The probability of an event is the largest fraction of any state's and wavelength's light that takes part in it,
    /// so that no weight grows. In the first events it has a lower limit, so that weights grow by a tenth at most.
    fn choose(
        &self,
        u: f64,
        (least, most): (f64, f64),
        first: bool,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Option<&ScatterEvent<'a>> {
        let mut total = 0.0;
        for (i, event) in self.events.iter().enumerate() {
            let Workspace { light, skeleton, field, share, .. } = workspace;
            event.share(skeleton, field, share);
            sums.unaccounted.add_share(light, share, &field.rising, 1.0);
            workspace.chances[i] = light.largest(share, &field.rising);
            total += workspace.chances[i];
        }
        let survival = total.max(least).min(most);
        if total == 0.0 || u >= survival {
            return None;
        }
        let each = if first { WITHOUT_REGARD * total / self.events.len() as f64 } else { 0.0 };
        let mut chances = 0.0;
        for chance in workspace.chances.iter_mut().filter(|share| **share > 0.0) {
            *chance += each;
            chances += *chance;
        }
        let mut below = u / survival * chances;
        let chosen = workspace.chances.iter().position(|chance| {
            below -= chance;
            below < 0.0
        })?;
        let event = &self.events[chosen];
        event.share(&workspace.skeleton, &workspace.field, &mut workspace.share);
        let scale = chances / (survival * workspace.chances[chosen]);
        workspace.light.carry(&workspace.share, &workspace.field.rising, scale);
        sums.unaccounted.add(&workspace.light, -1.0);
        Some(event)
    }

    /// Performs the event: connections to sources, and a new direction.
    fn scatter(
        &self,
        sent: OutgoingRay,
        event: &ScatterEvent<'_>,
        u: [f64; 3],
        draws: &mut RandomNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Option<OutgoingRay> {
        match event.kind {
            Kind::Bulk(bulk) => bulk.stay((sent.beta, event.going), u, draws, sums, workspace),
            Kind::Base(reflectance, medium) => {
                Some(at_lambertian_base(reflectance, medium, event.element, [u[1], u[2]], sums, workspace))
            }
            Kind::Pixel(kernels, medium) => {
                let pixel = Pixel { kernels, medium, element: event.element };
                pixel.reflect(sent.beta, u, sums, workspace)
            }
            Kind::Interface(interface, ..) => {
                let u = interface.numbers(u, &mut || draws.next());
                event.pass_interface(sent, u, sums, workspace)
            }
        }
    }
}

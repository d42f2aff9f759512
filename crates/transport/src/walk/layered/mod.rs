//! The general tracer: any layers in any order, over a mirror or a Lambertian base.
//!
//! Between two scattering events light keeps its direction cosines, and where it gets to is
//! known in closed form, all inter-reflections of flat parts and of a specular base included
//! ([`Skeleton`](crate::skeleton)): what leaves, what each layer absorbs, and how much meets each
//! scatterer from either side. The first two are added to the sums as they are. Random are
//! only the choice of the next scatterer (or the end of the path) and what happens there: a
//! diffuser's lobe, a rough face, a flight through a scattering medium, a Lambertian base.
//!
//! Light that met the base and light that did not share one path, with spectra of their own.

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
use crate::{Cone, Source};
pub(super) use ledger::Accumulator;
use ledger::{Sums, Workspace};
use pixel::Pixel;
use scatterers::{Kind, ScatterEvent, at_lambertian_base, events};

/// After its first scattering, a path never meets a further scatterer with a lower probability,
/// if it can at all: light that lamps send to faint scatterers would make rare bright paths.
const LEAST_SURVIVAL: f64 = 0.05;

/// In the first events of a path scatterers are chosen with this probability in all that has no regard to how much
/// light meets them: a faint one may be all that some light is seen by, and no replicate is to miss it.
const WITHOUT_REGARD: f64 = 0.1;
const FIRST_EVENTS: u32 = 4;

/// From this event on even light that nothing absorbs is subject to roulette.
const FREE_EVENTS: u32 = 256;

#[derive(Debug)]
pub(super) struct Layered<'a> {
    stack: &'a crate::Layered,
    view: Cone,
    sources: &'a [Source],
    /// Every way to meet a scatterer.
    events: Vec<ScatterEvent<'a>>,
    /// Where each element's absorption is booked.
    accounts: Vec<Account>,
    discs: bool,
}

/// Light sent on its way in the flat skeleton.
#[derive(Debug, Clone, Copy)]
struct OutgoingRay {
    beta: Beta,
    ray: Ray,
    /// The density over direction cosines with which it was scattered into `beta`; infinite if it
    /// never was.
    density: f64,
    /// The density with which the same scatterer would send light from `beta` back where it came from.
    back: f64,
    /// The kernel's value over that density.
    weight: f64,
    /// That with which the path had chosen the direction before, where the scatterer sends
    /// light of the sources on as well; else infinite.
    rival: f64,
}

impl OutgoingRay {
    /// Light that no scatterer has sent.
    const UNSCATTERED: Self = Self {
        beta: Beta { x: 0.0, y: 0.0 },
        ray: Ray::ENTERING,
        density: f64::INFINITY,
        back: f64::INFINITY,
        weight: 1.0,
        rival: f64::INFINITY,
    };

    /// Light drawn from the very kernel that scatters it, which is the same for the way back.
    fn exactly(beta: Beta, ray: Ray, density: f64) -> Self {
        Self { beta, ray, density, back: density, weight: 1.0, rival: f64::INFINITY }
    }
}

/// The random numbers of a path, block by block; blocks are counted.
struct Draws<'a> {
    numbers: &'a PathNumbers<'a>,
    count: u32,
}

impl Draws<'_> {
    fn next(&mut self) -> [f64; 4] {
        self.count = self.count.saturating_add(1);
        // One planned block belongs to the sources.
        let block = if self.count < PLANNED_BLOCKS - 1 { self.count } else { self.count.saturating_add(1) };
        self.numbers.block(block)
    }

    /// The highest probability with which the path may go on.
    ///
    /// The number of events in thick layers that absorb nothing has a long tail, n^(-1/2). Roulette
    /// that takes paths out like n^(-.45) from there on bounds their mean cost, and leaves the
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
            1.0
        } else {
            (WITHOUT_REGARD / self.events.len() as f64).min(LEAST_SURVIVAL)
        }
    }

    /// True if the base scatters: the skeleton then ends in black.
    fn base_scatters(&self) -> bool {
        !self.stack.base.is_specular()
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Accumulator) {
        let Accumulator { sums, workspace } = tally;
        workspace.lamps.draw(numbers, self, &mut workspace.skeleton);
        workspace.light.start();
        let mut draws = Draws { numbers, count: 0 };
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

    /// All that happens to the path's light without scattering.
    fn travel(&self, sent: OutgoingRay, sums: &mut Sums, workspace: &mut Workspace) {
        workspace.skeleton.set(self.stack, sent.beta.squared());
        workspace.skeleton.emit(sent.ray, &mut workspace.field);
        self.book(sums, workspace);
        let Workspace { light, field, share, .. } = workspace;
        share.set(field, Ray::LEAVING, |_| 1.0);
        sums.leaving.add_share(light, share, &field.rising, 1.0);
        if sent.density.is_finite() {
            sources::meet_discs(self.sources, sent, (light, share, &field.rising), sums);
        }
    }

    /// The next scatterer, with the light that meets it as the path's; `None` if the path ends.
    ///
    /// Each way is chosen with the largest share of any state's and wavelength's light that goes
    /// it, so that no weight grows; in the first events with a least probability, so that weights grow by a tenth at most.
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

    /// What the scatterer does: connections to lamps, and a new direction.
    fn scatter(
        &self,
        sent: OutgoingRay,
        event: &ScatterEvent<'_>,
        u: [f64; 3],
        draws: &mut Draws<'_>,
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

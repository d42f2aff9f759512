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

mod books;
mod bulk;
mod light;
mod sources;

use papilio_optics::Beta;
use papilio_optics::rough::{Rough, Side};
use papilio_sampling::{PLANNED_BLOCKS, warp};

use super::{PathNumbers, add_scaled};
use crate::skeleton::{Field, Going, Ray, Skeleton};
use crate::{Cone, Diffuser, Interface, Medium, Reflector, Source};
pub(super) use books::Tally;
use books::{Account, Room, Sums};
use bulk::Bulk;
use light::Share;

/// After its first scattering, a path never meets a further scatterer with a lower probability,
/// if it can at all: light that lamps send to faint scatterers would make rare bright paths.
const LEAST_SURVIVAL: f64 = 0.05;

/// From this event on even light that nothing absorbs is subject to roulette.
const FREE_EVENTS: u32 = 256;

#[derive(Debug)]
pub(super) struct Layered<'a> {
    stack: &'a crate::Layered,
    view: Cone,
    sources: &'a [Source],
    /// Every way to meet a scatterer.
    meetings: Vec<Meeting<'a>>,
    /// Where each element's absorption is booked.
    accounts: Vec<Account>,
    discs: bool,
}

/// A scatterer, and light on its way to it.
#[derive(Debug, Clone, Copy)]
struct Meeting<'a> {
    element: usize,
    going: Going,
    kind: Kind<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Kind<'a> {
    /// Between these media.
    Diffuser(&'a Diffuser, Option<&'a Medium>, &'a Medium),
    Rough(&'a Rough),
    Bulk(Bulk<'a>),
    /// A Lambertian base of this reflectance, under this medium.
    Base(&'a [f64], Option<&'a Medium>),
}

/// Light sent on its way in the flat skeleton.
#[derive(Debug, Clone, Copy)]
struct Sent {
    beta: Beta,
    ray: Ray,
    /// The density over direction cosines with which it was scattered into `beta`; infinite if it
    /// never was.
    density: f64,
    /// That with which the path had chosen the direction before, where the scatterer sends
    /// light of the sources on as well; else infinite.
    rival: f64,
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
        self.numbers.numbers.block(self.numbers.path, block)
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
        let discs = sources.iter().any(|source| matches!(source, Source::Disc(_)));
        Self { stack, view, sources, meetings: meetings(stack), accounts: Account::of_elements(stack), discs }
    }

    fn lambertian(&self) -> bool {
        matches!(self.stack.base.reflector, Reflector::Lambertian(_))
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Tally) {
        let Tally { sums, room } = tally;
        room.lamps.draw(numbers, self, &mut room.skeleton);
        room.light.start();
        let mut draws = Draws { numbers, count: 0 };
        let beta = self.view.sample_towards(numbers.field());
        let mut sent = Sent { beta, ray: Ray::ENTERING, density: f64::INFINITY, rival: f64::INFINITY };
        while !room.light.is_dark() {
            self.travel(sent, sums, room);
            let u = draws.next();
            let least = if sent.density.is_finite() { LEAST_SURVIVAL } else { 1.0 };
            let survival = (least, draws.most_survival());
            let Some(meeting) = self.choose(u[0], survival, sums, room) else { return };
            let Some(next) = self.scatter(sent, meeting, [u[1], u[2], u[3]], &mut draws, sums, room) else {
                return;
            };
            sent = next;
        }
    }

    /// All that happens to the path's light without scattering.
    fn travel(&self, sent: Sent, sums: &mut Sums, room: &mut Room) {
        room.skeleton.set(self.stack, sent.beta.squared());
        room.skeleton.emit(sent.ray, &mut room.field);
        self.book(sums, room);
        let Room { light, field, share, .. } = room;
        share.set(field, Ray::LEAVING, |_| 1.0);
        sums.leaving.add_share(light, share, &field.rising, 1.0);
        if sent.density.is_finite() {
            sources::meet_discs(self.sources, sent, (light, share, &field.rising), sums);
        }
    }

    /// The next scatterer, with the light that meets it as the path's; `None` if the path ends.
    ///
    /// Each way is chosen with the largest share of any state's and wavelength's light that goes
    /// it, so that no weight grows.
    fn choose(
        &self,
        u: f64,
        (least, most): (f64, f64),
        sums: &mut Sums,
        room: &mut Room,
    ) -> Option<&Meeting<'a>> {
        let mut total = 0.0;
        for (i, meeting) in self.meetings.iter().enumerate() {
            let Room { light, skeleton, field, share, .. } = room;
            meeting.share(skeleton, field, share);
            sums.unaccounted.add_share(light, share, &field.rising, 1.0);
            room.meeting[i] = light.largest(share, &field.rising);
            total += room.meeting[i];
        }
        let survival = total.max(least).min(most);
        if total == 0.0 || u >= survival {
            return None;
        }
        let mut below = u / survival * total;
        let chosen = room.meeting.iter().position(|share| {
            below -= share;
            below < 0.0
        })?;
        let meeting = &self.meetings[chosen];
        meeting.share(&room.skeleton, &room.field, &mut room.share);
        let scale = total / (survival * room.meeting[chosen]);
        room.light.carry(&room.share, &room.field.rising, scale);
        sums.unaccounted.add(&room.light, -1.0);
        Some(meeting)
    }

    /// What the scatterer does: connections to lamps, and a new direction.
    fn scatter(
        &self,
        sent: Sent,
        meeting: &Meeting<'_>,
        u: [f64; 3],
        draws: &mut Draws<'_>,
        sums: &mut Sums,
        room: &mut Room,
    ) -> Option<Sent> {
        match meeting.kind {
            Kind::Bulk(bulk) => bulk.stay((sent.beta, meeting.going), u, draws, sums, room),
            Kind::Base(reflectance, medium) => {
                Some(at_lambertian_base(reflectance, medium, meeting.element, [u[1], u[2]], sums, room))
            }
            Kind::Diffuser(..) => meeting.pass_face(sent, [u[1], u[2], 0.5, 0.5], sums, room),
            Kind::Rough(_) => meeting.pass_face(sent, draws.next(), sums, room),
        }
    }
}

impl Kind<'_> {
    /// A diffuser or a rough face.
    fn is_face(&self) -> bool {
        matches!(self, Self::Diffuser(..) | Self::Rough(_))
    }
}

impl Meeting<'_> {
    /// Sets `share` to that of the light that meets the scatterer and is scattered.
    fn share(&self, skeleton: &Skeleton, field: &Field, share: &mut Share) {
        let ray = Ray::meeting(self.element, self.going);
        if let Kind::Base(..) = self.kind {
            return share.set(field, ray, |_| 1.0);
        }
        let parts = skeleton.element(self.element);
        share.set(field, ray, |bin| parts[bin].scattered);
    }

    /// The ways on which a face can send light on.
    fn ways(&self) -> &'static [Going] {
        match (self.kind, self.going) {
            (Kind::Rough(_), _) => &[Going::Up, Going::Down],
            (_, Going::Up) => &[Going::Up],
            (_, Going::Down) => &[Going::Down],
        }
    }

    /// The density with which a face sends light on.
    fn density(&self, from: Beta, going: Going, to: Beta) -> f64 {
        match self.kind {
            Kind::Diffuser(diffuser, ..) => diffuser.lobe.density(from, to),
            Kind::Rough(rough) => rough.density(side(self.going, true), from, side(going, false), to),
            Kind::Bulk(_) | Kind::Base(..) => 0.0,
        }
    }

    /// Light that a face sends on; `None` if it absorbs it.
    fn send(&self, from: Beta, u: [f64; 4]) -> Option<Sent> {
        let (beta, going) = match self.kind {
            Kind::Diffuser(diffuser, ..) => (diffuser.lobe.sample(from, [u[0], u[1]])?, self.going),
            Kind::Rough(rough) => {
                let (side, beta) = rough.sample(side(self.going, true), from, u);
                (beta, if side == Side::Above { Going::Up } else { Going::Down })
            }
            Kind::Bulk(_) | Kind::Base(..) => return None,
        };
        let density = self.density(from, going, beta);
        Some(Sent { beta, ray: Ray::from_element(self.element, going), density, rival: f64::INFINITY })
    }

    /// True if the medium into which a face sends the light has such a direction.
    fn carries(&self, sent: Sent, bin: usize) -> bool {
        match self.kind {
            Kind::Diffuser(_, above, below) => {
                let to = if sent.ray.going == Going::Up { above } else { Some(below) };
                sent.beta.squared() < index(to, bin).powi(2)
            }
            _ => true,
        }
    }

    /// Through a diffuser, or through or off a rough face.
    fn pass_face(&self, sent: Sent, u: [f64; 4], sums: &mut Sums, room: &mut Room) -> Option<Sent> {
        let (from, ways) = (sent.beta, self.ways());
        let rays = ways.iter().map(|going| Ray::from_element(self.element, *going));
        let density = |way: usize, lamp| self.density(from, ways[way], lamp);
        sources::connect(rays, sent.density, density, |_, _| 1.0, sums, room);
        let Some(next) = self.send(from, u) else {
            room.light.keep(|_| 0.0, &mut sums.absorbed.diffuser);
            return None;
        };
        let kept = |bin| f64::from(u8::from(self.carries(next, bin)));
        room.light.keep(kept, &mut sums.absorbed.diffuser);
        Some(Sent { rival: sent.density, ..next })
    }
}

/// The side on which light is that goes this way, before or after it meets a face.
fn side(going: Going, before: bool) -> Side {
    if (going == Going::Down) == before { Side::Above } else { Side::Below }
}

fn meetings(stack: &crate::Layered) -> Vec<Meeting<'_>> {
    let mut meetings = Vec::new();
    let mut upper = None;
    for (i, layer) in stack.layers.iter().enumerate() {
        let both_ways =
            |element, kind| [Going::Down, Going::Up].map(|going| Meeting { element, going, kind });
        match &layer.interface {
            Interface::Diffuser(diffuser) => {
                meetings.extend(both_ways(2 * i, Kind::Diffuser(diffuser, upper, &layer.medium)));
            }
            Interface::Rough(rough) => meetings.extend(both_ways(2 * i, Kind::Rough(rough))),
            _ => {}
        }
        if let Some(bulk) = Bulk::new(2 * i + 1, &layer.medium) {
            meetings.extend(both_ways(2 * i + 1, Kind::Bulk(bulk)));
        }
        upper = Some(&layer.medium);
    }
    if let Reflector::Lambertian(reflectance) = &stack.base.reflector {
        let kind = Kind::Base(reflectance, upper);
        meetings.push(Meeting { element: 2 * stack.layers.len(), going: Going::Down, kind });
    }
    meetings
}

/// The index of a medium, or of air.
fn index(medium: Option<&Medium>, bin: usize) -> f64 {
    medium.map_or(1.0, |medium| medium.index()[bin])
}

fn at_lambertian_base(
    reflectance: &[f64],
    medium: Option<&Medium>,
    element: usize,
    u: [f64; 2],
    sums: &mut Sums,
    room: &mut Room,
) -> Sent {
    let light = &mut room.light;
    sums.arriving.add(light, 1.0);
    let rows = light.met.chunks_exact_mut(light.fresh.len());
    for (row, reflectance) in rows.zip(reflectance.chunks_exact(light.fresh.len())) {
        for ((met, fresh), r) in row.iter_mut().zip(&light.fresh).zip(reflectance) {
            *met = (*met + fresh) * r;
        }
    }
    light.fresh.fill(0.0);
    sums.reflected.add(light, 1.0);

    let ray = Ray { plane: element, going: Going::Up };
    let largest = medium.map_or(1.0, Medium::largest_index);
    let density = warp::uniform_disc_density(largest);
    // Over the disc of each wavelength, where that is drawn is of the largest.
    let spread = |beta: Beta, bin| {
        let n = index(medium, bin);
        if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 }
    };
    sources::connect([ray].into_iter(), f64::INFINITY, |_, _| density, spread, sums, room);
    let (x, y) = warp::uniform_disc(largest, u);
    let out = Beta { x, y };
    room.light.keep(|bin| spread(out, bin), &mut sums.unaccounted);
    Sent { beta: out, ray, density, rival: f64::INFINITY }
}

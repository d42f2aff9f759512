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
use papilio_sampling::warp;

use super::{PathNumbers, add_scaled};
use crate::skeleton::{Going, Ray};
use crate::{Cone, Diffuser, Interface, Medium, Reflector, Source};
use books::{Account, Room, Sums};
pub(super) use books::Tally;
use bulk::Bulk;

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
    /// The density over direction cosines with which it was scattered into `beta`; 0 if it never was.
    density: f64,
}

/// The random numbers of a path, block by block; blocks are counted.
struct Draws<'a> {
    numbers: &'a PathNumbers<'a>,
    count: u32,
}

impl Draws<'_> {
    fn next(&mut self) -> [f64; 4] {
        self.count = self.count.saturating_add(1);
        self.numbers.numbers.block(self.numbers.path, self.count)
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
        if self.discs {
            sources::aim_at_discs(self.sources, self.stack, numbers.on_discs(), room);
        }
        room.light.start();
        let mut draws = Draws { numbers, count: 0 };
        let mut sent =
            Sent { beta: self.view.sample_towards(numbers.field()), ray: Ray::ENTERING, density: 0.0 };
        while !room.light.is_dark() {
            self.travel(sent, sums, room);
            let u = draws.next();
            let least = if sent.density == 0.0 { 1.0 } else { LEAST_SURVIVAL };
            let survival = (least, draws.most_survival());
            let Some(meeting) = self.choose(u[0], survival, sums, room) else { return };
            let Some(next) = self.scatter(sent.beta, meeting, [u[1], u[2], u[3]], &mut draws, sums, room)
            else {
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
        if sent.density > 0.0 {
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
            meeting.share(room);
            let Room { light, field, share, .. } = &room;
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
        meeting.share(room);
        let scale = total / (survival * room.meeting[chosen]);
        room.light.carry(&room.share, &room.field.rising, scale);
        sums.unaccounted.add(&room.light, -1.0);
        Some(meeting)
    }

    /// What the scatterer does: connections to lamps, and a new direction.
    fn scatter(
        &self,
        beta: Beta,
        meeting: &Meeting<'_>,
        u: [f64; 3],
        draws: &mut Draws<'_>,
        sums: &mut Sums,
        room: &mut Room,
    ) -> Option<Sent> {
        match meeting.kind {
            Kind::Diffuser(diffuser, above, below) => {
                let to = match meeting.going {
                    Going::Down => Some(below),
                    Going::Up => above,
                };
                let ray = Ray::from_element(meeting.element, meeting.going);
                through_diffuser(diffuser, beta, (ray, to), [u[1], u[2]], sums, room)
            }
            Kind::Rough(rough) => Some(at_rough_face(rough, beta, meeting, draws.next(), sums, room)),
            Kind::Bulk(bulk) => bulk.stay((beta, meeting.going), u, draws, sums, room),
            Kind::Base(reflectance, medium) => {
                Some(at_lambertian_base(reflectance, medium, meeting.element, [u[1], u[2]], sums, room))
            }
        }
    }
}

impl Meeting<'_> {
    /// Sets the room's share to that of the path's light that meets the scatterer and is scattered.
    fn share(&self, room: &mut Room) {
        let Room { skeleton, field, share, .. } = room;
        let ray = Ray::meeting(self.element, self.going);
        if let Kind::Base(..) = self.kind {
            return share.set(field, ray, |_| 1.0);
        }
        let parts = skeleton.element(self.element);
        share.set(field, ray, |bin| parts[bin].scattered);
    }
}

fn meetings(stack: &crate::Layered) -> Vec<Meeting<'_>> {
    let mut meetings = Vec::new();
    let mut upper = None;
    for (i, layer) in stack.layers.iter().enumerate() {
        let both_ways = |element, kind| [Going::Down, Going::Up].map(|going| Meeting { element, going, kind });
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

fn through_diffuser(
    diffuser: &Diffuser,
    beta: Beta,
    (ray, to): (Ray, Option<&Medium>),
    u: [f64; 2],
    sums: &mut Sums,
    room: &mut Room,
) -> Option<Sent> {
    let lobe = &diffuser.lobe;
    sources::connect(&[ray], |_, lamp| lobe.density(beta, lamp), |_, _| 1.0, sums, room);
    let Some(out) = lobe.sample(beta, u) else {
        room.light.keep(|_| 0.0, &mut sums.absorbed.diffuser);
        return None;
    };
    let carried = |bin| f64::from(u8::from(out.squared() < index(to, bin).powi(2)));
    room.light.keep(carried, &mut sums.absorbed.diffuser);
    Some(Sent { beta: out, ray, density: lobe.density(beta, out) })
}

fn at_rough_face(
    rough: &Rough,
    beta: Beta,
    meeting: &Meeting<'_>,
    u: [f64; 4],
    sums: &mut Sums,
    room: &mut Room,
) -> Sent {
    let from = match meeting.going {
        Going::Down => Side::Above,
        Going::Up => Side::Below,
    };
    let sides = [Side::Above, Side::Below];
    let way = |side| {
        let going = if side == Side::Above { Going::Up } else { Going::Down };
        Ray::from_element(meeting.element, going)
    };
    let density = |side: usize, lamp| rough.density(from, beta, sides[side], lamp);
    sources::connect(&sides.map(way), density, |_, _| 1.0, sums, room);
    let (side, out) = rough.sample(from, beta, u);
    Sent { beta: out, ray: way(side), density: rough.density(from, beta, side, out) }
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
    sources::connect(&[ray], |_, _| density, spread, sums, room);
    let (x, y) = warp::uniform_disc(largest, u);
    let out = Beta { x, y };
    room.light.keep(|bin| spread(out, bin), &mut sums.unaccounted);
    Sent { beta: out, ray, density }
}

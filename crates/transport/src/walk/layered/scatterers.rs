//! What scatters: diffusers, rough faces, a Lambertian base (scattering media: [`bulk`](super::bulk)).

use papilio_optics::rough::{Rough, Side};
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;

use super::books::{Room, Sums};
use super::bulk::Bulk;
use super::light::Share;
use super::sources::Turned;
use super::{Sent, sources};
use crate::skeleton::{Field, Going, Ray, Skeleton};
use crate::walk::{base_density, base_direction};
use crate::{Diffuser, Interface, Layered, Medium, Reflector, ScatterFace, ScatterKernel};

/// A scatterer, and light on its way to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Meeting<'a> {
    pub(super) element: usize,
    pub(super) going: Going,
    pub(super) kind: Kind<'a>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Kind<'a> {
    /// Between these media.
    Diffuser(&'a Diffuser, Option<&'a Medium>, &'a Medium),
    Rough(&'a Rough),
    /// A face's kernel, its reverse, and which way it sends light on.
    Scatter {
        kernel: &'a ScatterKernel,
        reversed: &'a ScatterKernel,
        sends: Going,
    },
    Bulk(Bulk<'a>),
    /// A Lambertian base of this reflectance, under this medium.
    Base(&'a [f64], Option<&'a Medium>),
    /// A base with a kernel for each state, under this medium.
    Pixel(&'a [ScatterKernel], Option<&'a Medium>),
}

impl Kind<'_> {
    /// A diffuser, a rough face or a face's kernel.
    pub(super) fn is_face(&self) -> bool {
        matches!(self, Self::Diffuser(..) | Self::Rough(_) | Self::Scatter { .. })
    }
}

impl Meeting<'_> {
    /// Sets `share` to that of the light that meets the scatterer and is scattered.
    pub(super) fn share(&self, skeleton: &Skeleton, field: &Field, share: &mut Share) {
        let ray = Ray::meeting(self.element, self.going);
        if let Kind::Base(..) | Kind::Pixel(..) = self.kind {
            return share.set(field, ray, |_| 1.0);
        }
        if let Kind::Scatter { kernel, .. } = self.kind {
            let total = kernel.total(skeleton.length());
            return share.set(field, ray, |bin| total * kernel.factor[bin]);
        }
        let parts = skeleton.element(self.element);
        share.set(field, ray, |bin| parts[bin].scattered[self.going as usize]);
    }

    /// The ways on which a face can send light on.
    fn ways(&self) -> &'static [Going] {
        match (self.kind, self.going) {
            (Kind::Scatter { sends: Going::Up, .. }, _) => &[Going::Up],
            (Kind::Scatter { sends: Going::Down, .. }, _) => &[Going::Down],
            (Kind::Rough(_), _) => &[Going::Up, Going::Down],
            (_, Going::Up) => &[Going::Up],
            (_, Going::Down) => &[Going::Down],
        }
    }

    /// How a face sends light on, in parts of its [`share`](Self::share).
    fn turned(&self, from: Beta, going: Going, to: Beta) -> Turned {
        match self.kind {
            Kind::Diffuser(diffuser, ..) => Turned::exactly(diffuser.lobe.density(from, to)),
            Kind::Rough(rough) => {
                Turned::exactly(rough.density(side(self.going, true), from, side(going, false), to))
            }
            Kind::Scatter { kernel, reversed, .. } => {
                let total = kernel.total(from.length()).max(f64::MIN_POSITIVE);
                Turned {
                    value: kernel.scatter.evaluate(from, to) / total,
                    pdf: kernel.scatter.density(from, to),
                    back: reversed.scatter.density(to, from),
                }
            }
            Kind::Bulk(_) | Kind::Base(..) | Kind::Pixel(..) => Turned::exactly(0.0),
        }
    }

    /// Light that a face sends on; `None` if it absorbs it.
    pub(super) fn send(&self, from: Beta, u: [f64; 4]) -> Option<Sent> {
        let (beta, going) = match self.kind {
            Kind::Diffuser(diffuser, ..) => (diffuser.lobe.sample_direction(from, [u[0], u[1]])?, self.going),
            Kind::Rough(rough) => {
                let (side, beta) = rough.sample(side(self.going, true), from, u);
                (beta, if side == Side::Above { Going::Up } else { Going::Down })
            }
            Kind::Scatter { kernel, sends, .. } => (kernel.scatter.sample(from, u)?.direction, sends),
            Kind::Bulk(_) | Kind::Base(..) | Kind::Pixel(..) => return None,
        };
        let ray = Ray::from_element(self.element, going);
        let Turned { value, pdf, back } = self.turned(from, going, beta);
        if let Kind::Scatter { .. } = self.kind {
            return (pdf > 0.0).then(|| Sent { back, weight: value / pdf, ..Sent::exactly(beta, ray, pdf) });
        }
        Some(Sent::exactly(beta, ray, pdf))
    }

    /// True if the medium into which a face sends the light has such a direction.
    pub(super) fn carries(&self, sent: Sent, bin: usize) -> bool {
        match self.kind {
            Kind::Diffuser(_, above, below) => {
                let to = if sent.ray.going == Going::Up { above } else { Some(below) };
                sent.beta.squared() < index(to, bin).powi(2)
            }
            _ => true,
        }
    }

    /// Through a diffuser, or through or off a rough face.
    pub(super) fn pass_face(
        &self,
        sent: Sent,
        u: [f64; 4],
        sums: &mut Sums,
        room: &mut Room,
    ) -> Option<Sent> {
        let (from, ways) = (sent.beta, self.ways());
        let rays = ways.iter().map(|going| Ray::from_element(self.element, *going));
        let turned = |way: usize, lamp| self.turned(from, ways[way], lamp);
        sources::connect(rays, sent.density, turned, |_, _| 1.0, sums, room);
        let Some(next) = self.send(from, u) else {
            room.light.keep(|_| 0.0, &mut sums.absorbed.diffuser);
            return None;
        };
        let kept = |bin| if self.carries(next, bin) { next.weight } else { 0.0 };
        room.light.keep(kept, &mut sums.absorbed.diffuser);
        Some(Sent { rival: sent.density, ..next })
    }
}

/// The side on which light is that goes this way, before or after it meets a face.
fn side(going: Going, before: bool) -> Side {
    if (going == Going::Down) == before { Side::Above } else { Side::Below }
}

/// Every way to meet a scatterer of the stack.
pub(super) fn meetings(stack: &Layered) -> Vec<Meeting<'_>> {
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
        if let Interface::Scatter(face) = &layer.interface {
            meetings.extend(ways_of(face, 2 * i));
        }
        if let Some(bulk) = Bulk::new(2 * i + 1, &layer.medium) {
            meetings.extend(both_ways(2 * i + 1, Kind::Bulk(bulk)));
        }
        upper = Some(&layer.medium);
    }
    let base = match &stack.base.reflector {
        Reflector::Specular(_) => None,
        Reflector::Lambertian(reflectance) => Some(Kind::Base(reflectance, upper)),
        Reflector::Scattering(kernels) => Some(Kind::Pixel(kernels, upper)),
    };
    let element = 2 * stack.layers.len();
    meetings.extend(base.map(|kind| Meeting { element, going: Going::Down, kind }));
    meetings
}

/// Every way to meet a face given by its BSDF.
fn ways_of(face: &ScatterFace, element: usize) -> impl Iterator<Item = Meeting<'_>> {
    [(Going::Down, Going::Up), (Going::Up, Going::Down)].into_iter().flat_map(move |(going, other)| {
        let through = face.through(going).zip(face.through(other)).map(|ways| (ways, going));
        // Reflections are reciprocal.
        let back = face.back(going).map(|kernel| ((kernel, kernel), other));
        through.into_iter().chain(back).map(move |((kernel, reversed), sends)| Meeting {
            element,
            going,
            kind: Kind::Scatter { kernel, reversed, sends },
        })
    })
}

/// The index of a medium, or of air.
fn index(medium: Option<&Medium>, bin: usize) -> f64 {
    medium.map_or(1.0, |medium| medium.index()[bin])
}

/// Off a Lambertian base: the same basic radiance in every direction of the medium.
pub(super) fn at_lambertian_base(
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
    // Over the disc of each wavelength, where the value is that of the largest.
    let density = warp::uniform_disc_density(largest);
    let spread = |beta: Beta, bin| {
        let n = index(medium, bin);
        if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 }
    };
    let turned = |_, to: Beta| Turned { value: density, pdf: base_density(largest, to), back: density };
    sources::connect([ray].into_iter(), f64::INFINITY, turned, spread, sums, room);
    let out = base_direction(largest, u);
    let drawn = base_density(largest, out);
    room.light.keep(|bin| spread(out, bin) * density / drawn, &mut sums.unaccounted);
    Sent::exactly(out, ray, drawn)
}

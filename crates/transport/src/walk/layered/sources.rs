//! Directed sources: met by connection, and discs by chance as well.
//!
//! The unscattered light of a source is known everywhere in closed form ([`Skeleton`]), so each
//! scattering event adds what it turns of that light into the path: every way from the source whose
//! first scattering (from the source's end) is this event, once.

use papilio_optics::Beta;

use super::Sent;
use super::books::{Room, Sums};
use super::light::{Light, Share};
use crate::skeleton::{Field, Ray, Skeleton};
use crate::walk::Target;
use crate::{Layered, Source};

/// A source, as its unscattered light.
#[derive(Debug, Clone)]
pub(super) struct Lamp {
    pub(super) target: Target,
    pub(super) field: Field,
    /// In a scattering medium: what its events have turned upwards and downwards, yet to be settled.
    pub(super) gathered: [f64; 2],
}

impl Lamp {
    /// `None` for diffuse light. A disc's point is to be drawn yet.
    pub(super) fn new(source: &Source, stack: &Layered, skeleton: &mut Skeleton) -> Option<Self> {
        let target = Target::sample(source, [0.5; 2])?;
        let mut lamp = Self { target, field: skeleton.field(), gathered: [0.0; 2] };
        lamp.aim(target, stack, skeleton);
        Some(lamp)
    }

    /// Turns to this point of the source.
    fn aim(&mut self, target: Target, stack: &Layered, skeleton: &mut Skeleton) {
        self.target = target;
        skeleton.set(stack, target.beta.squared());
        skeleton.emit(Ray::ENTERING, &mut self.field);
    }

    /// The share of light sent out as `ray` towards the source that reaches it.
    pub(super) fn reach(&self, ray: Ray, factor: impl Fn(usize) -> f64, share: &mut Share) {
        share.add(&self.field, ray.reversed(), factor);
    }
}

/// Draws a point of each disc for the path.
pub(super) fn aim_at_discs(sources: &[Source], stack: &Layered, u: [f64; 2], room: &mut Room) {
    for (source, lamp) in sources.iter().zip(&mut room.lamps) {
        if let (Source::Disc(_), Some(lamp), Some(target)) = (source, lamp, Target::sample(source, u)) {
            lamp.aim(target, stack, &mut room.skeleton);
        }
    }
}

/// Connects the path's light to all directed sources at a scattering event.
///
/// `ways` are those on which the event can send it on; `density(way, beta)` the density over
/// direction cosines with which it does, and `factor(beta, bin)` what differs between wavelengths.
pub(super) fn connect(
    ways: &[Ray],
    density: impl Fn(usize, Beta) -> f64,
    factor: impl Fn(Beta, usize) -> f64,
    sums: &mut Sums,
    room: &mut Room,
) {
    let Room { light, share, lamps, .. } = room;
    for (lamp, sum) in lamps.iter().zip(&mut sums.from_source) {
        let Some(lamp) = lamp else { continue };
        let beta = lamp.target.beta;
        share.clear();
        for (way, ray) in ways.iter().enumerate() {
            let weight = lamp.target.weight(density(way, beta), 0.0, 1.0);
            lamp.reach(*ray, |bin| weight * factor(beta, bin), share);
        }
        sum.add_share(light, share, &lamp.field.rising, 1.0);
    }
}

/// Discs that scattered light runs into where it leaves.
pub(super) fn meet_discs(
    sources: &[Source],
    sent: Sent,
    (light, share, rising): (&Light, &Share, &[f64]),
    sums: &mut Sums,
) {
    for (source, sum) in sources.iter().zip(&mut sums.from_source) {
        if let Source::Disc(cone) = source
            && cone.sends(sent.beta)
        {
            let weight = Target::on_disc(cone, sent.beta).weight(sent.density, 0.0, 1.0);
            sum.add_share(light, share, rising, weight);
        }
    }
}

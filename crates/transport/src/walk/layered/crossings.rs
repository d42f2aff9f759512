//! Flat interfaces and a mirror as events: light crosses one medium at a time.
//!
//! A [`Layered`](super::Layered) walk that goes crossing by crossing uses no closed form between its events: reflection and
//! transmission by each flat interface, and reflection by a specular pixel, are branches of their own. Only the last part of a
//! connection, from an event to a source, remains a sum over all routes.
//!
//! # A pixel with a pattern
//! What is needed to read a pattern at x, y wherever light meets the pixel:
//!
//! - [`Record`] is carried by each branch and handed on to all branches that follow from it. A position belongs there, beside the
//!   number of meetings. It starts at a random place of the pattern's period.
//! - Between two events of this walk light is in one medium and keeps its direction. In `Layered::travel`, where the branch
//!   arrives at its next event, the position moves by `d beta / sqrt(n^2 - |beta|^2)`, d being the thickness of the medium that was
//!   crossed; by nothing where the branch started next to the event. A flight inside a scattering medium (`Bulk::enter` and
//!   `Bulk::deflect`) moves it by the same expression, d being the depth flown in units of length.
//! - [`reflect_by_mirror`], `at_lambertian_base` and [`Pixel::reflect`](super::pixel::Pixel::reflect) are the only places where light
//!   meets the pixel. Each calls [`Record::meet`] and then multiplies by the reflectance of each state, which becomes that of the
//!   place. Paths carry all states and wavelengths ([`columns`](super::columns) are off), so that the factor may be any spectrum.
//! - Connections to a source over a scattering pixel need nothing more: their last part meets no pixel, and the light of
//!   sources does not depend on position. Over a mirror their last part meets the pixel in closed form: `rising` of the source's
//!   [`Field`](crate::skeleton::Field) is the series `r a (1 + r b + (r b)^2 ...)`, a arriving and b returning from above. A pattern
//!   makes each r the reflectance at the place where this round trip meets the pixel; the terms fall as (r b)^m, with b about 0.04
//!   under a bare surface.
//! - Mirror images ([`images`](crate::walk)) are closed forms of the uniform display; they need the same series.

use super::OutgoingRay;
use super::ledger::{Sums, Workspace};
use super::scatterers::ScatterEvent;
use super::{BRIGHT_SIDE, Layered};
use crate::skeleton::{Propagation, Ray};

/// What a branch has met on its way.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Record {
    /// Number of meetings with the pixel that were events.
    pub(super) meetings: u32,
}

impl Record {
    /// Adds a meeting with the pixel.
    pub(super) fn meet(&mut self) {
        self.meetings = self.meetings.saturating_add(1);
    }
}

/// Reflection and transmission by a flat interface, or by the flat part of one that scatters. A side to which little light
/// goes is followed by roulette.
pub(super) fn pass_flat(
    walk: &Layered<'_>,
    (number, event): (usize, &ScatterEvent<'_>),
    sent: OutgoingRay,
    sums: &mut Sums,
    workspace: &mut Workspace,
) {
    workspace.skeleton.set(walk.stack, walk.base(), sent.beta.squared());
    let faces = workspace.skeleton.face(event.element).to_vec();
    let part = |bin: usize| faces[bin.min(faces.len() - 1)];
    let whole = workspace.light.clone();

    // The light that arrives here does not include what is scattered.
    let rest = |bin: usize| 1.0 / (1.0 - part(bin).scattered[event.going as usize]);
    workspace.light.multiply(|bin| rest(bin) * part(bin).absorbed(event.going));
    let account = walk.accounts[event.element];
    for (_, sum) in sums.absorbed.accounts().into_iter().filter(|(of, _)| *of == account) {
        sum.add(&workspace.light, 1.0);
    }
    for (k, going) in [Propagation::Up, Propagation::Down].into_iter().enumerate() {
        let fraction = |bin: usize| match (going == event.going, event.going) {
            (true, _) => part(bin).flat.t,
            (false, Propagation::Down) => part(bin).flat.above,
            (false, Propagation::Up) => part(bin).flat.below,
        };
        workspace.light.clone_from(&whole);
        workspace.light.multiply(|bin| rest(bin) * fraction(bin));
        let brightest = workspace.light.brightest();
        if brightest == 0.0 {
            continue;
        }
        let survival = (brightest / BRIGHT_SIDE).min(1.0);
        sums.unaccounted.add(&workspace.light, 1.0);
        if workspace.side_roulettes[2 * number + k].survives(survival) {
            workspace.light.scale(1.0 / survival);
            sums.unaccounted.add(&workspace.light, -1.0);
            workspace.branch(OutgoingRay { ray: Ray::from_element(event.element, going), ..sent });
        }
    }
}

/// Reflection by a specular pixel.
pub(super) fn reflect_by_mirror(
    walk: &Layered<'_>,
    event: &ScatterEvent<'_>,
    sent: OutgoingRay,
    sums: &mut Sums,
    workspace: &mut Workspace,
) {
    workspace.skeleton.set(walk.stack, walk.base(), sent.beta.squared());
    let Workspace { light, skeleton, record, .. } = workspace;
    sums.arriving.add(light, 1.0);
    record.meet();
    light.meet(skeleton.base());
    sums.reflected.add(light, 1.0);
    workspace.branch(OutgoingRay { ray: Ray { plane: event.element, going: Propagation::Up }, ..sent });
}

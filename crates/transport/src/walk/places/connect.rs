//! Sampling of scattered directions, and connections to the sources.

use papilio_optics::Beta;

use super::dice::Dice;
use super::faces::Face;
use super::path::Path;
use super::tally::Record;
use super::tracer::{FlatWork, PixelWork, Tracer, Workspace};
use crate::layers::{Departure, Scattered};
use crate::skeleton::Propagation;

/// Fraction of the directions that are sampled around the directions of sources, where light passes a
/// scatterer above a mirror for the first time.
const TO_SOURCES: f64 = 0.5;

/// The last part of a connection to a source.
pub(super) struct Last<'w> {
    pub(super) path: &'w mut Path,
    pub(super) flat: &'w mut FlatWork,
    pub(super) pixel: &'w mut PixelWork,
}

impl Tracer<'_> {
    /// Samples a direction; returns it with its density, and the value of the kernel over that density.
    pub(super) fn sample(
        &self,
        face: &Face<'_>,
        guided: bool,
        from: Beta,
        u: [f64; 4],
    ) -> Option<(Departure, f64, f64)> {
        if !guided {
            let (to, Scattered { value, density, .. }) = face.sample(from, u)?;
            return Some((to, density, value / density));
        }
        let [choice, ..] = u;
        let (axis, rest) = if choice < TO_SOURCES {
            let place = choice / TO_SOURCES * self.about.len() as f64;
            (self.about[(place as usize).min(self.about.len() - 1)], place.fract())
        } else {
            (from, (choice - TO_SOURCES) / (1.0 - TO_SOURCES))
        };
        let (to, _) = face.sample(axis, [rest, u[1], u[2], u[3]])?;
        let (value, density) = self.guided(face, from, to);
        Some((to, density, value / density))
    }

    /// Value of a kernel, and the density of directions that are also sampled around those of sources.
    fn guided(&self, face: &Face<'_>, from: Beta, to: Departure) -> (f64, f64) {
        let Scattered { value, density, .. } = face.scatter(from, to);
        let of_sources: f64 = self.about.iter().map(|axis| face.scatter(*axis, to).density).sum();
        (value, (1.0 - TO_SOURCES) * density + TO_SOURCES * of_sources / self.about.len() as f64)
    }

    /// Connects light that an interface scatters on a channel to all sources.
    pub(super) fn connect_from_face(
        &self,
        (number, face, guided): (usize, &Face<'_>, bool),
        alternative: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) {
        let Workspace { path, last, targets, flat, of_last, pixel, .. } = work;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            for going in face.leaves() {
                let to = Departure { beta: target.beta, going: *going };
                let (value, density) = if guided {
                    self.guided(face, path.beta, to)
                } else {
                    let Scattered { value, density, .. } = face.scatter(path.beta, to);
                    (value, density)
                };
                let weight = target.balanced(value, || density, 0.0);
                if weight <= 0.0 {
                    continue;
                }
                last.copy(path);
                let colours = face.colours(path.beta, target.beta);
                for (band, factor) in of_last.factors.iter_mut().enumerate() {
                    let fraction = flat.fractions[alternative * self.bands + band];
                    *factor = weight * fraction * face.spread(*going, band) * colours.at(band);
                }
                last.light.multiply(&of_last.factors);
                last.depart_from(2 * number, *going);
                last.beta = target.beta;
                let mut work = Last { path: &mut *last, flat: &mut *of_last, pixel: &mut *pixel };
                self.reach(source, &mut work, dice, record);
            }
        }
    }

    /// Follows light towards a source through all flat layers, by one route; adds what arrives.
    pub(super) fn reach(
        &self,
        source: usize,
        work: &mut Last<'_>,
        dice: &mut Dice<'_>,
        record: &mut impl Record,
    ) {
        let Last { path, flat, pixel } = work;
        loop {
            match path.going {
                Propagation::Up if path.plane == 0 => return record.receives(source, path, 1.0),
                Propagation::Down if path.plane == 2 * self.stack.layers.len() => {
                    if !self.stack.base().is_specular() {
                        return;
                    }
                    self.reflect_at_once(path, pixel, record);
                    path.going = Propagation::Up;
                    if path.light.brightness() == 0.0 {
                        return;
                    }
                }
                going => {
                    let element = if going == Propagation::Down { path.plane } else { path.plane - 1 };
                    if element.is_multiple_of(2) {
                        self.prepare(element / 2, path, flat);
                        match self.choose(2, || dice.of_connection(), path, flat) {
                            None => return,
                            Some(0) => path.turn(),
                            Some(_) => path.advance(),
                        }
                    } else if !self.cross(element / 2, path, flat) {
                        return;
                    }
                }
            }
        }
    }
}

//! Flat parts: crossings of media, reflection and transmission by interfaces.

use super::branches::{self, Branches};
use super::dice::Dice;
use super::path::Path;
use super::tally::Record;
use super::tracer::{FlatWork, Tracer, Workspace, per_beta};
use crate::Layer;
use crate::front::Flat;
use crate::skeleton::Propagation;

/// Most alternatives at an interface.
const MOST: usize = 8;

impl Tracer<'_> {
    /// Crosses a medium without scattering, or what of it is not scattered.
    pub(super) fn cross(&self, layer: usize, path: &mut Path, flat: &mut FlatWork) -> bool {
        let medium = &self.stack.layers[layer].medium;
        let squared = path.beta.squared();
        if squared >= medium.largest_index().powi(2) {
            return false;
        }
        let depth = medium.scattering().map_or(0.0, |scattering| scattering.optical_thickness);
        if self.places > 1 || depth > 0.0 || medium.transmittance().is_some() {
            for (bin, factor) in flat.factors.iter_mut().enumerate() {
                let cosine = (1.0 - squared / medium.index()[bin].powi(2)).max(0.0).sqrt();
                let clear = medium.transmittance().map_or(1.0, |t| t[bin].powf(1.0 / cosine));
                *factor = if cosine > 0.0 { clear * (-depth / cosine).exp() } else { 0.0 };
            }
            path.light.multiply(&flat.factors);
        }
        match &self.filter {
            Some(filter) if layer + 1 == self.stack.layers.len() => self.move_through(filter, path, flat),
            _ => self.move_across(layer, path),
        }
        path.advance();
        true
    }

    /// Moves a path by what a medium moves it.
    fn move_across(&self, layer: usize, path: &mut Path) {
        let Layer { medium, thickness_mm, .. } = &self.stack.layers[layer];
        if *thickness_mm > 0.0 {
            let beta = path.beta;
            path.move_back(|place| per_beta(medium, place, beta, *thickness_mm));
        }
    }

    /// Reflection and transmission by an interface, and scattering.
    pub(super) fn pass_interface(
        &self,
        number: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        if let Some(changing) = &self.changing {
            self.divide_changing((changing, number), dice, work);
            return false;
        }
        let going = work.path.going;
        self.prepare(number, &work.path, &mut work.flat);
        let faces = &self.faces[number][going as usize];
        let length = work.path.beta.length();
        for (k, face) in faces.iter().enumerate() {
            let FlatWork { parts, fractions, .. } = &mut work.flat;
            let out = &mut fractions[(2 + k) * self.bands..][..self.bands];
            face.fraction(length, out, |band| parts[band].scattered[going as usize]);
        }
        let first = work.path.light.meetings() == 0 && going == Propagation::Down && !self.about.is_empty();
        for (k, face) in faces.iter().enumerate() {
            self.connect_from_face((number, face, first && face.passes()), 2 + k, dice, work, record);
        }
        let Workspace { path, flat, branches, .. } = work;
        if path.is_unscattered() {
            self.divide((number, first), dice, path, flat, branches);
            return false;
        }
        let Some(chosen) = self.choose(2 + faces.len(), || dice.next()[0], path, flat) else { return false };
        self.take((number, first), chosen, dice, path, &mut flat.factors)
    }

    /// Adds branches for all alternatives of an interface, by roulette where they are faint; see
    /// [`branches`].
    fn divide(
        &self,
        (number, first): (usize, bool),
        dice: &mut Dice<'_>,
        path: &Path,
        flat: &mut FlatWork,
        branches: &mut Branches,
    ) {
        let alternatives = 2 + self.faces[number][path.going as usize].len();
        let (weights, all) = self.weights(alternatives, path, flat);
        let brightness = path.light.brightness() / all;
        for (chosen, weight) in weights.into_iter().enumerate().take(alternatives) {
            let Some(scale) = branches::weight(brightness * weight, dice) else { continue };
            let FlatWork { fractions, factors, .. } = &mut *flat;
            let taken = &fractions[chosen * self.bands..][..self.bands];
            factors.iter_mut().zip(taken).for_each(|(factor, fraction)| *factor = scale * fraction);
            let (branch, counts) = branches.add(path, dice.branch());
            branch.light.multiply(factors);
            let before = std::mem::replace(&mut dice.counts, *counts);
            let goes_on = self.take((number, first), chosen, dice, branch, factors);
            *counts = std::mem::replace(&mut dice.counts, before);
            if !goes_on {
                branches.drop_last();
            }
        }
    }

    /// Takes an alternative of an interface: reflection, transmission, or scattering; false if the path ends.
    fn take(
        &self,
        (number, first): (usize, bool),
        chosen: usize,
        dice: &mut Dice<'_>,
        path: &mut Path,
        factors: &mut [f64],
    ) -> bool {
        match chosen {
            0 => path.turn(),
            1 => path.advance(),
            _ => {
                let face = &self.faces[number][path.going as usize][chosen - 2];
                let Some((to, density, weight)) =
                    self.sample(face, first && face.passes(), path.beta, dice.next())
                else {
                    return false;
                };
                let colours = face.colours(path.beta, to.beta);
                for (bin, factor) in factors.iter_mut().enumerate() {
                    *factor = weight * face.carried(to, bin) * colours.at(bin);
                }
                if factors.iter().all(|factor| *factor == 0.0) {
                    return false;
                }
                path.light.multiply(factors);
                path.depart_from(2 * number, to.going);
                (path.beta, path.density) = (to.beta, density);
            }
        }
        true
    }

    /// Fractions of light that an interface reflects (alternative 0) and transmits (1), by band.
    pub(super) fn prepare(&self, number: usize, path: &Path, flat: &mut FlatWork) {
        let upper = if number == 0 { &self.air } else { &self.stack.layers[number - 1].medium };
        let layer = &self.stack.layers[number];
        let FlatWork { parts, fractions, .. } = flat;
        let own = self.of_each.map_or(layer, |both| &both[path.polarisation][number]);
        own.interface.kind().parts([upper, &layer.medium], path.beta.squared(), parts);
        for (band, part) in parts.iter().enumerate() {
            let Flat { t, above, below } = part.flat;
            fractions[band] = if path.going == Propagation::Down { above } else { below };
            fractions[self.bands + band] = t;
        }
    }

    /// Chooses one of the first alternatives in proportion to its light; `None` if all is absorbed.
    pub(super) fn choose(
        &self,
        alternatives: usize,
        u: impl FnOnce() -> f64,
        path: &mut Path,
        flat: &mut FlatWork,
    ) -> Option<usize> {
        let (weights, _) = self.weights(alternatives, path, flat);
        let weights = weights.get(..alternatives)?;
        let FlatWork { fractions, factors, .. } = flat;
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 {
            return None;
        }
        let mut chosen = weights.iter().position(|weight| *weight > 0.0)?;
        if weights[chosen] < sum {
            let mut rest = u() * sum;
            for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                chosen = k;
                if rest < *weight {
                    break;
                }
                rest -= weight;
            }
        }
        let scale = sum / weights[chosen];
        let taken = &fractions[chosen * self.bands..][..self.bands];
        factors.iter_mut().zip(taken).for_each(|(factor, fraction)| *factor = scale * fraction);
        path.light.multiply(factors);
        Some(chosen)
    }

    /// Light that each of the first alternatives of an interface takes, and all light that arrives, in one
    /// unit.
    fn weights(&self, alternatives: usize, path: &Path, flat: &mut FlatWork) -> ([f64; MOST], f64) {
        let FlatWork { fractions, totals, .. } = flat;
        if self.bands > 1 {
            totals.fill(0.0);
            path.light.add_total(totals);
        }
        let weight = |fractions: &[f64]| match fractions {
            [fraction] => *fraction,
            _ => fractions.iter().zip(&*totals).map(|(fraction, total)| fraction * total).sum(),
        };
        let mut weights = [0.0; MOST];
        let rows = fractions.chunks_exact(self.bands).take(alternatives);
        weights.iter_mut().zip(rows).for_each(|(out, row)| *out = weight(row));
        (weights, if self.bands > 1 { totals.iter().sum() } else { 1.0 })
    }
}

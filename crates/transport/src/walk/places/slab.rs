//! Flights and deflections in a scattering medium.

use papilio_optics::Beta;
use papilio_optics::phase::HenyeyGreenstein;
use papilio_sampling::warp;

use super::branches;
use super::connect::Last;
use super::dice::Dice;
use super::path::Path;
use super::tally::Record;
use super::tracer::{FlatWork, Tracer, Workspace};
use crate::skeleton::Propagation;

impl Tracer<'_> {
    /// Flights and deflections in a scattering medium, until the light leaves it.
    pub(super) fn pass_slab(
        &self,
        layer: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        let medium = &self.stack.layers[layer].medium;
        let Some(scattering) = medium.scattering() else { return true };
        let (index, thickness) = (medium.largest_index(), scattering.optical_thickness);
        let phase = HenyeyGreenstein { anisotropy: scattering.anisotropy };
        let direction = |beta: Beta, going: Propagation| {
            let (x, y) = (beta.x / index, beta.y / index);
            let z = (1.0 - x * x - y * y).max(1e-18).sqrt();
            [x, y, if going == Propagation::Down { z } else { -z }]
        };
        let over_cosines = |density: f64, z: f64| density / (index * index * z.abs().max(f64::MIN_POSITIVE));
        let horizons = self.horizons.and_then(|horizons| horizons.within(index));
        let drawn = |before: [f64; 3], to: [f64; 3]| {
            let own = phase.at_cosine(dot(before, to));
            horizons.map_or(own, |horizons| horizons.medium_density(own, index, to))
        };
        if work.path.beta.squared() >= index * index {
            return false;
        }
        let mut now = direction(work.path.beta, work.path.going);
        let mut depth = if now[2] > 0.0 { 0.0 } else { thickness };
        loop {
            let u = dice.next();
            let path = &mut work.path;
            let rest = if now[2] > 0.0 { thickness - depth } else { depth };
            let edge = rest / now[2].abs().max(f64::MIN_POSITIVE);
            let out = |path: &mut Path| {
                path.going = if now[2] > 0.0 { Propagation::Down } else { Propagation::Up };
                path.plane = if now[2] > 0.0 { 2 * layer + 2 } else { 2 * layer + 1 };
            };
            let mut flown = (-u[3].ln()).min(edge);
            if path.is_unscattered() {
                // Light that is scattered here, and light that is not: see `branches`.
                let (brightness, within) = (path.light.brightness(), -(-edge).exp_m1());
                if let Some(weight) = branches::weight(brightness * (1.0 - within), dice) {
                    let (branch, _) = work.branches.add(path, dice.branch());
                    branch.light.multiply(&[weight * (1.0 - within)]);
                    self.fly(layer, branch, (now, edge / thickness), &mut work.flat);
                    out(branch);
                }
                let Some(weight) = branches::weight(brightness * within, dice) else { return false };
                path.light.multiply(&[weight * within]);
                flown = -(-u[3] * within).ln_1p();
            }
            self.fly(layer, path, (now, flown / thickness), &mut work.flat);
            if flown >= edge && !path.is_unscattered() {
                out(path);
                return true;
            }
            self.watch_edge(path);
            depth = (depth + flown * now[2]).clamp(0.0, thickness);
            path.light.multiply(if self.bands == 1 { &scattering.albedo[..1] } else { &scattering.albedo });
            let Workspace { path, last, targets, flat, of_last, pixel, .. } = work;
            for (source, target) in targets.iter().enumerate() {
                let Some(target) = target.filter(|target| target.beta.squared() < index * index) else {
                    continue;
                };
                for going in [Propagation::Up, Propagation::Down] {
                    let towards = direction(target.beta, going);
                    let density = over_cosines(phase.at_cosine(dot(now, towards)), towards[2]);
                    let rest = if going == Propagation::Down { thickness - depth } else { depth };
                    let edge = rest / towards[2].abs();
                    let sampled = || over_cosines(drawn(now, towards), towards[2]);
                    let weight = target.balanced(density, sampled, 0.0) * (-edge).exp();
                    last.copy(path);
                    last.beta = target.beta;
                    last.light.multiply(&[weight]);
                    self.fly(layer, last, (towards, edge / thickness), flat);
                    (last.going, last.plane) =
                        (going, if going == Propagation::Down { 2 * layer + 2 } else { 2 * layer + 1 });
                    self.reach(source, &mut Last { path: last, flat: of_last, pixel }, dice, record);
                }
            }
            if !self.survives(dice, path) {
                return false;
            }
            let before = now;
            let mut angle = u[0];
            now = match horizons.and_then(|horizons| horizons.of_medium(&mut angle, u[1])) {
                Some((beta, up)) => direction(beta, if up { Propagation::Up } else { Propagation::Down }),
                None => warp::deflected(before, 1.0 - phase.sample_cosine(angle), u[1]),
            };
            let density = drawn(before, now);
            if horizons.is_some() {
                path.light.multiply(&[phase.at_cosine(dot(before, now)) / density]);
            }
            path.density = over_cosines(density, now[2]);
            path.beta = Beta { x: index * now[0], y: index * now[1] };
        }
    }

    /// Moves a path by a flight in a scattering medium, of a length relative to the thickness of the medium.
    fn fly(&self, layer: usize, path: &mut Path, ([x, y, _], length): ([f64; 3], f64), flat: &mut FlatWork) {
        if let Some(transmittance) = self.stack.layers[layer].medium.transmittance() {
            let factors = flat.factors.iter_mut().zip(&**transmittance);
            factors.for_each(|(factor, t)| *factor = t.powf(length));
            path.light.multiply(&flat.factors);
        }
        let length = length * self.stack.layers[layer].thickness_mm;
        path.place_mm.iter_mut().for_each(|place| *place = [place[0] - length * x, place[1] - length * y]);
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

//! Meetings with the pixel.

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::connect::Last;
use super::dice::Dice;
use super::path::Path;
use super::pattern::Pattern;
use super::tally::Record;
use super::tracer::{PixelWork, Shows, Tracer, Workspace};
use crate::angular::Stencil;
use crate::skeleton::Propagation;
use crate::walk::add_scaled;
use crate::walk::horizon::{emitted, emitted_density};
use crate::{Medium, PixelSpread, Reflector};

impl Tracer<'_> {
    /// Reflection by a mirror or a Lambertian pixel at the place of the path.
    pub(super) fn reflect_at_once(&self, path: &mut Path, work: &mut PixelWork, record: &impl Record) {
        if let Some(changing) = &self.changing {
            return self.reflect_changing(changing, path, &mut work.changing, record);
        }
        let squared = path.beta.squared();
        if path.light.is_number() {
            let meeting = path.meeting(0);
            let shown = path.light.meet(squared, self.look_up(squared));
            if let Shows::Pattern(pattern) = self.shows {
                shown.set(pattern, &meeting, self.stack.base().states());
            }
            return record.meets(path);
        }
        if let Some(first) = path.light.looked_up() {
            self.stack.base().reflectance(first.beta_squared, self.lowest(), &mut work.reflectance);
            path.light.expand(&work.reflectance);
        }
        self.stack.base().reflectance_towards(path.beta, self.lowest(), &mut work.reflectance);
        self.reflect(path, work, record);
    }

    /// Reflection of light with spectra, with the reflectance of each state that is in the workspace.
    fn reflect(&self, path: &mut Path, work: &mut PixelWork, record: &impl Record) {
        match self.shows {
            Shows::EachState => path.light.reflect(&work.reflectance),
            Shows::Pattern(pattern) => {
                let PixelWork { reflectance, mixed, .. } = work;
                self.mix(pattern, path, reflectance, mixed);
                path.light.reflect(mixed);
            }
        }
        record.meets(path);
    }

    /// Sets the reflectance of each image of a pattern at the place of a path.
    fn mix(&self, pattern: &dyn Pattern, path: &Path, reflectance: &[f64], mixed: &mut [f64]) {
        let bins = self.bins();
        mixed.fill(0.0);
        for k in 0..path.place_mm.len() {
            let here = path.bins_at(k);
            pattern.shows_at(&path.meeting(k), &mut |image, state, coverage| {
                let row = &mut mixed[image * bins..][here.clone()];
                add_scaled(row, &reflectance[state * bins..][here.clone()], coverage);
            });
        }
    }

    /// Reflection by a Lambertian pixel inside which light spreads: it leaves at the place of the path and
    /// has entered at another one, each time through the root of the reflectance there. Its place is recorded
    /// as either of them, by chance: that of a small change of the state.
    fn reflect_spread(
        &self,
        spread: PixelSpread,
        u: [f64; 4],
        path: &mut Path,
        work: &mut PixelWork,
        record: &impl Record,
    ) {
        let [x, y] = spread.displacement([u[0], u[1], u[2]]);
        let moves = |path: &mut Path| {
            path.place_mm.iter_mut().for_each(|place| *place = [place[0] - x, place[1] - y]);
        };
        let leaves = u[3] < 0.5;
        let Shows::Pattern(pattern) = self.shows else {
            if !leaves {
                moves(path);
            }
            self.reflect_at_once(path, work, record);
            if leaves {
                moves(path);
            }
            return;
        };
        self.stack.base().reflectance(path.beta.squared(), self.lowest(), &mut work.reflectance);
        let PixelWork { reflectance, mixed, entered, .. } = work;
        self.mix(pattern, path, reflectance, mixed);
        if leaves {
            record.meets(path);
        }
        moves(path);
        self.mix(pattern, path, reflectance, entered);
        mixed.iter_mut().zip(entered).for_each(|(out, entered)| *out = (*out * *entered).sqrt());
        if !leaves {
            record.meets(path);
        }
        path.light.reflect(mixed);
    }

    /// Weights on the nodes of the pixel's angular table.
    fn look_up(&self, beta_squared: f64) -> Stencil {
        match (&self.stack.base().reflector, self.lowest().constant_index()) {
            (Reflector::Specular(table), Some(index)) => table.nodes.stencil(beta_squared, index),
            _ => Stencil::ONLY_NODE,
        }
    }

    /// The medium above the pixel.
    pub(super) fn lowest(&self) -> &Medium {
        self.stack.layers.last().map_or(&self.air, |layer| &layer.medium)
    }

    /// Reflection by the pixel; false if the path ends.
    pub(super) fn meet_base(
        &self,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        match &self.stack.base().reflector {
            Reflector::Specular(_) => {
                self.reflect_at_once(&mut work.path, &mut work.pixel, record);
                work.path.going = Propagation::Up;
                self.survives(dice, &mut work.path)
            }
            Reflector::Lambertian(_) => {
                match self.spread {
                    None => self.reflect_at_once(&mut work.path, &mut work.pixel, record),
                    Some(spread) => {
                        self.reflect_spread(spread, dice.next(), &mut work.path, &mut work.pixel, record);
                    }
                }
                self.survives(dice, &mut work.path) && {
                    self.leave_lambertian(dice, work, record);
                    true
                }
            }
            Reflector::Scattering(kernels) => self.leave_kernels(kernels, dice, work, record),
        }
    }

    /// Light leaves a Lambertian pixel: the same basic radiance in all directions of the medium.
    pub(super) fn leave_lambertian(
        &self,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) {
        let medium = self.lowest();
        let largest = medium.largest_index();
        let value = warp::uniform_disc_density(largest);
        // Over the disc of each wavelength, where the value is that of the largest.
        let spread = |beta: Beta, bin: usize| {
            let n = medium.index()[bin];
            if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 }
        };
        let horizons = self.horizons.as_ref();
        let Workspace { path, last, targets, flat, of_last, pixel, .. } = work;
        path.going = Propagation::Up;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            let weight = target.balanced(value, || emitted_density(horizons, largest, target.beta), 0.0);
            last.copy(path);
            last.beta = target.beta;
            last.polarisation = self.any_polarisation(dice);
            let factors = flat.factors.iter_mut().enumerate();
            factors.for_each(|(bin, factor)| *factor = weight * spread(target.beta, bin));
            last.light.multiply(&flat.factors);
            self.reach(source, &mut Last { path: last, flat: of_last, pixel }, dice, record);
        }
        path.polarisation = self.any_polarisation(dice);
        let [u, v, ..] = dice.next();
        path.beta = emitted(horizons, largest, [u, v]);
        path.density = emitted_density(horizons, largest, path.beta);
        for (bin, factor) in flat.factors.iter_mut().enumerate() {
            *factor = value / path.density * spread(path.beta, bin);
        }
        path.light.multiply(&flat.factors);
    }

    /// Light leaves a pixel with a kernel for each state: one direction serves all.
    fn leave_kernels(
        &self,
        kernels: &[crate::ScatterKernel],
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        use papilio_optics::Scatterer;
        let index = self.lowest().largest_index();
        let of_air = |beta: Beta| Beta { x: beta.x / index, y: beta.y / index };
        let from = work.path.beta;
        let density = |to: Beta| {
            let sum: f64 = kernels.iter().map(|one| one.scatter.density(of_air(from), of_air(to))).sum();
            let own = sum / (kernels.len() as f64 * index * index);
            self.horizons.map_or(own, |horizons| horizons.pixel_density(own, to))
        };
        let bins = self.bins();
        let set = |to: Beta, weight: f64, reflectance: &mut [f64]| {
            for (row, kernel) in reflectance.chunks_exact_mut(bins).zip(kernels) {
                let value = weight * kernel.scatter.evaluate(of_air(from), of_air(to)) / (index * index);
                row.iter_mut().zip(&*kernel.factor).for_each(|(out, factor)| *out = value * factor);
            }
        };
        let Workspace { path, last, targets, of_last, pixel, .. } = work;
        path.going = Propagation::Up;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            // The balance of a connection is a factor on any value.
            set(target.beta, target.balanced(1.0, || density(target.beta), 0.0), &mut pixel.reflectance);
            last.copy(path);
            self.reflect(last, pixel, record);
            last.beta = target.beta;
            self.reach(source, &mut Last { path: last, flat: of_last, pixel }, dice, record);
        }
        let [u, v, w, _] = dice.next();
        let mut u = [u, v, w];
        let by_kernel = |u: [f64; 3]| {
            let place = u[2] * kernels.len() as f64;
            let kernel = kernels.get(place as usize)?;
            let sent = kernel.scatter.sample(of_air(from), [u[0], u[1], place.fract(), 0.0])?.direction;
            Some(Beta { x: sent.x * index, y: sent.y * index })
        };
        let towards = self.horizons.and_then(|horizons| horizons.of_pixel(&mut u));
        let Some(to) = towards.or_else(|| by_kernel(u)) else { return false };
        let drawn = density(to);
        set(to, 1.0 / drawn, &mut pixel.reflectance);
        self.reflect(path, pixel, record);
        (path.beta, path.density) = (to, drawn);
        self.survives(dice, path)
    }
}

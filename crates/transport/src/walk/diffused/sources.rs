//! Directed sources: added by connection, by chance, and by directions sampled from their side.
//!
//! The balanced weight is the same for all techniques ([`Target::balanced`]). A direction that the path did
//! not choose (infinite density) has no competing technique.

use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;

use super::ledger::{Sums, Workspace};
use super::{Diffused, LightAbove, LightBelow, PassNumbers, Spread, multiply, reflected};
use crate::angular::Stencil;
use crate::walk::accumulator::{Channel, Reflected};
use crate::walk::{Target, base_density};
use crate::{Source, specular};

impl Diffused<'_> {
    /// Connects light that passes the diffuser unscattered and is reflected by a specular base, on its way
    /// down.
    pub(super) fn connect_before_base(
        &self,
        light: LightAbove,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        if self.straight() == 0.0 {
            return;
        }
        let LightAbove { beta, carries, .. } = light;
        for (i, source) in self.sources.iter().enumerate() {
            let Some(target) = Target::sample(source, numbers.on_source) else { continue };
            let scatter = (1.0 - self.straight()) * self.diffuser.lobe.density(beta, target.beta);
            let weight = light.weight * target.only_connection(scatter);
            if let Source::Beam(_) = source {
                // The way from there to the beam is the same for all paths: added at the end.
                sums.from_straight_beam[i].add(carries.then_some(&workspace.carried), weight);
            } else {
                let sum = &mut sums.from_source[i];
                self.add_via_specular_base(target.beta, carries, weight * self.straight(), sum, workspace);
                let carried = carries.then_some(&workspace.carried[..]);
                self.add_round_trips(target.beta, target.beta, carried, weight * self.straight(), sum);
            }
        }
    }

    /// Connects light that passes the diffuser unscattered onto a Lambertian base.
    pub(super) fn connect_straight_from_base(
        &self,
        (look_up, weight): (Option<Stencil>, f64),
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        if self.straight() == 0.0 {
            return;
        }
        let scatter = self.straight() * warp::uniform_disc_density(self.stack.medium.largest_index());
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Some(target) = Target::sample(source, numbers.on_source) {
                let weight = weight * target.only_connection(scatter);
                self.add_from_base(target.beta, look_up, weight, sum, workspace);
            }
        }
    }

    /// Connects directed sources to the underside of the diffuser: the last scattering towards the light.
    pub(super) fn connect(
        &self,
        up: LightBelow,
        light: Reflected<'_>,
        carried: Option<&[f64]>,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
    ) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Some(target) = Target::sample(source, numbers.on_source) {
                sum.add(light, up.weight * self.towards(target, up.beta, up.rival));
                if source.has_radiance() {
                    let weight = up.weight * self.towards_trips(target, up.beta, up.rival);
                    self.add_round_trips(up.beta, target.beta, carried, weight, sum);
                }
            }
        }
    }

    /// Adds light of a point of a source (`from`) that has first made any number of round trips between base
    /// and front without being scattered. From there on it behaves as light that reaches a specular base in
    /// direction `beta`, on a path that carries these spectra (`None`: all ones). For beams, whose round
    /// trips are the same for all paths, this is added at the end.
    fn add_round_trips(
        &self,
        beta: Beta,
        from: Beta,
        carried: Option<&[f64]>,
        weight: f64,
        sum: &mut Channel,
    ) {
        if !self.round_trips || weight == 0.0 {
            return;
        }
        let mut r = vec![0.0; self.stack.base.states() * self.stack.base.bins()];
        self.reflectance(from, &mut r);
        let trips = specular::round_trips(self.stack, self.diffuser, &r);
        let mut spectra = r;
        self.reflectance(beta, &mut spectra);
        for (value, trips) in spectra.iter_mut().zip(&trips) {
            *value *= trips - 1.0;
        }
        if let Some(carried) = carried {
            spectra.iter_mut().zip(carried).for_each(|(value, carried)| *value *= carried);
        }
        self.keep_within_disc(beta, Spread::No, &mut spectra);
        sum.add(Reflected::Spectra(&spectra), weight);
    }

    /// Adds round sources that the path has reached by its last scattering.
    pub(super) fn meet_discs(&self, up: LightBelow, out: Beta, light: Reflected<'_>, sums: &mut Sums) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Some(target) = Target::at(source, out) {
                sum.add(light, up.weight * self.towards(target, up.beta, up.rival));
            }
        }
    }

    /// Returns the balanced weight of light from `beta` below the diffuser to a source; `forward`: the
    /// density with which the path sampled `beta`, infinite if the source's side does not sample it.
    fn towards(&self, target: Target, beta: Beta, forward: f64) -> f64 {
        let lobe = self.diffuser.lobe.density(beta, target.beta);
        let pdf = || self.density_out(beta, target.beta);
        target.balanced((1.0 - self.straight()) * lobe, pdf, lobe / forward)
    }

    /// Returns the same for light that makes round trips before, which the path does not find by chance.
    fn towards_trips(&self, target: Target, beta: Beta, forward: f64) -> f64 {
        let lobe = self.diffuser.lobe.density(beta, target.beta);
        target.balanced((1.0 - self.straight()) * lobe, || 0.0, lobe / forward)
    }

    /// Adds directed sources by a direction below the diffuser that is sampled from the source's side;
    /// `chosen` is the density with which the path itself would sample it.
    pub(super) fn sample_backwards(
        &self,
        chosen: impl Fn(Beta) -> f64,
        light: LightAbove,
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            let Some((beta, weight)) = self.backwards(source, &chosen, numbers) else { continue };
            self.add_via_specular_base(beta, light.carries, light.weight * weight, sum, workspace);
            if let (true, Some(target)) = (source.has_radiance(), Target::sample(source, numbers.on_source)) {
                let weight = light.weight * self.towards_trips(target, beta, chosen(beta));
                let carried = light.carries.then_some(&workspace.carried[..]);
                self.add_round_trips(beta, target.beta, carried, weight, sum);
            }
        }
    }

    /// Adds light that reaches a specular base in direction `beta`.
    fn add_via_specular_base(
        &self,
        beta: Beta,
        carries: bool,
        weight: f64,
        sum: &mut Channel,
        workspace: &mut Workspace,
    ) {
        if !carries {
            return sum.add(Reflected::LookUp(self.look_up(beta)), weight);
        }
        let Workspace { carried, backwards, .. } = workspace;
        multiply(backwards, carried, |out| self.reflectance(beta, out));
        self.keep_within_disc(beta, Spread::No, backwards);
        sum.add(Reflected::Spectra(backwards), weight);
    }

    /// Adds light that a Lambertian base reflects in direction `beta`.
    fn add_from_base(
        &self,
        beta: Beta,
        look_up: Option<Stencil>,
        weight: f64,
        sum: &mut Channel,
        workspace: &mut Workspace,
    ) {
        let Workspace { reflected: met, backwards, .. } = workspace;
        if look_up.is_none() {
            backwards.copy_from_slice(met);
            self.keep_within_disc(beta, Spread::Lambertian, backwards);
        }
        sum.add(reflected(look_up, backwards), weight);
    }

    /// Adds directed sources in the same way for light that a Lambertian base has scattered.
    pub(super) fn sample_backwards_from_base(
        &self,
        (look_up, weight): (Option<Stencil>, f64),
        numbers: &PassNumbers<'_>,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) {
        let n = self.stack.medium.largest_index();
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            let chosen = |beta| base_density(n, beta);
            let Some((beta, balanced)) = self.backwards(source, chosen, numbers) else { continue };
            let balanced = balanced * warp::uniform_disc_density(n) / chosen(beta);
            self.add_from_base(beta, look_up, weight * balanced, sum, workspace);
        }
    }

    /// Samples a direction in the medium from the lobe around a source; returns it and its balanced weight.
    fn backwards(
        &self,
        source: &Source,
        chosen: impl Fn(Beta) -> f64,
        numbers: &PassNumbers<'_>,
    ) -> Option<(Beta, f64)> {
        let target = Target::sample(source, numbers.on_source)?;
        let beta = self.diffuser.lobe.sample_direction(target.beta, numbers.backwards)?;
        let forward = chosen(beta);
        if beta.length() >= self.stack.medium.largest_index() || forward == 0.0 {
            return None;
        }
        Some((beta, self.towards(target, beta, forward)))
    }
}

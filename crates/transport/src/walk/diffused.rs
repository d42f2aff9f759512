//! The tracer of a panel with a diffuser.
//!
//! One pass: down through the diffuser, off the base, up through the diffuser, out
//! through the front, which may send the path into a further pass. With T the
//! diffuser's and t the front's transmittance, every contribution of the k-th pass holds
//! `t^2 T^2` and, for each pass before, `T^2 r R`: r the front's reflectance from
//! below, R the base's. The factor `t^2 T^2` is applied at the end.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::tally::{Channel, Estimate, Incident, Ledger, Reflected, Rho};
use super::{PathNumbers, Target, scale_rows, specular};
use crate::angular::Stencil;
use crate::stack::{Diffuser, Reflector};
use crate::{Cone, Source, Stack};

/// A path never goes on with a higher probability than this.
const MOST_SURVIVAL: f64 = 0.999;

#[derive(Debug)]
pub(super) struct Diffused<'a> {
    stack: &'a Stack,
    diffuser: &'a Diffuser,
    view: Cone,
    sources: &'a [Source],
    /// Probability of a further pass: a bound of the light that is left.
    survival: f64,
    /// `T^2 r / survival`, per wavelength.
    between_passes: Vec<f64>,
    /// The base is a mirror.
    specular: bool,
    /// There are beams or discs.
    directed: bool,
    discs: bool,
}

/// The sums of a replicate, and room to work in.
#[derive(Debug, Clone)]
pub(super) struct Tally {
    sums: Sums,
    room: Room,
}

#[derive(Debug, Clone)]
struct Sums {
    /// Enters the diffuser from above.
    entering: Incident,
    /// Reaches the base.
    arriving: Incident,
    /// Reflected by the base.
    reflected: Channel,
    /// Leaves the diffuser upwards: what diffuse light sees.
    leaving: Channel,
    /// For each source: after the base, by connection or (a disc) by chance.
    from_source: Vec<Channel>,
    /// For each beam: connections before the base, to light that came straight through.
    from_straight_beam: Vec<Incident>,
    /// For each source: what the view sees of its image in a perfect front mirror.
    image: Vec<f64>,
}

/// Spectra of the path at hand; shape `[state][wavelength]`.
#[derive(Debug, Clone)]
struct Room {
    /// What the path carries; meaningful from its second pass on.
    carried: Vec<f64>,
    /// `carried` times the base's reflectance.
    reflected: Vec<f64>,
    /// The same for light sampled backwards from a source.
    backwards: Vec<f64>,
}

/// Light on its way up to the diffuser's underside.
#[derive(Debug, Clone, Copy)]
struct Upward {
    beta: Beta,
    /// Density with which the path chose `beta`; infinite if it had no choice.
    density: f64,
}

impl<'a> Diffused<'a> {
    pub(super) fn new(stack: &'a Stack, diffuser: &'a Diffuser, view: Cone, sources: &'a [Source]) -> Self {
        let sent_back = diffuser.transmittance.zip_map(&stack.front.reflectance_below, |t, r| t * t * r);
        let goes_on = !stack.single_pass && stack.front.transmittance.max() > 0.0;
        let left = if goes_on { sent_back.max() * stack.base.largest_reflectance() } else { 0.0 };
        let survival = left.min(MOST_SURVIVAL);
        let between_passes =
            sent_back.iter().map(|r| if survival > 0.0 { r / survival } else { 0.0 }).collect();
        let specular = matches!(stack.base.reflector, Reflector::Specular(_));
        let directed = sources.iter().any(|source| *source != Source::Diffuse);
        let discs = sources.iter().any(|source| matches!(source, Source::Disc(_)));
        Self { stack, diffuser, view, sources, survival, between_passes, specular, directed, discs }
    }

    pub(super) fn tally(&self) -> Tally {
        let base = &self.stack.base;
        let len = base.states() * base.bins();
        Tally {
            sums: Sums {
                entering: Incident::new(len),
                arriving: Incident::new(len),
                reflected: Channel::new(base),
                leaving: Channel::new(base),
                from_source: self.sources.iter().map(|_| Channel::new(base)).collect(),
                from_straight_beam: self.sources.iter().map(|_| Incident::new(len)).collect(),
                image: vec![0.0; self.sources.len()],
            },
            room: Room { carried: vec![0.0; len], reflected: vec![0.0; len], backwards: vec![0.0; len] },
        }
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Tally) {
        let Tally { sums, room } = tally;
        let mut beta = self.view.sample_towards(numbers.field());
        for (source, image) in self.sources.iter().zip(&mut sums.image) {
            *image += source.image_strength(beta);
        }
        // In a dispersive medium the disc of directions depends on wavelength: spectra from the start.
        let mut carries = self.stack.medium.constant_index().is_none();
        if carries {
            room.carried.fill(1.0);
        }
        for pass in 0.. {
            let numbers = PassNumbers::new(numbers, pass, self);
            let Some(out) = self.pass(beta, carries, &numbers, sums, room) else { return };
            if carries {
                room.carried.copy_from_slice(&room.reflected);
            } else {
                self.stack.base.reflectance(out.base.squared(), &self.stack.medium, &mut room.carried);
                carries = true;
            }
            scale_rows(&mut room.carried, &self.between_passes);
            beta = out.beta;
        }
    }

    /// One pass, from `beta` above the diffuser to above it again; `None` if the path ends.
    fn pass(
        &self,
        beta: Beta,
        carries: bool,
        numbers: &PassNumbers,
        sums: &mut Sums,
        room: &mut Room,
    ) -> Option<Out> {
        sums.entering.add(carries.then_some(&room.carried), 1.0);
        self.connect_before_base(beta, carries.then_some(&room.carried), sums);
        if self.specular {
            let chosen = |to: Beta| (1.0 - self.straight()) * self.diffuser.lobe.density(beta, to);
            self.sample_backwards(chosen, carries, numbers, sums, room);
        }
        let (down, density) = self.through(beta, numbers.down)?;
        if down.length() >= self.stack.medium.largest_index() {
            return None;
        }
        if carries {
            self.keep_within_disc(down, Spread::No, &mut room.carried);
        }
        sums.arriving.add(carries.then_some(&room.carried), 1.0);

        let look_up = self.meet_base(down, carries, room);
        sums.reflected.add(reflected(look_up, &room.reflected), 1.0);
        let mut up = Upward { beta: down, density };
        if !self.specular {
            self.connect_straight_from_base(reflected(look_up, &room.reflected), sums);
            self.sample_backwards_from_base(look_up, numbers, sums, room);
            up = self.leave_base(numbers);
            if carries {
                self.keep_within_disc(up.beta, Spread::Lambertian, &mut room.reflected);
            }
        }
        let light = reflected(look_up, &room.reflected);
        self.connect(up, light, numbers, sums);
        // All that leaves meets diffuse light: no direction need be drawn for that.
        sums.leaving.add(light, self.share_leaving(up.beta));
        let goes_on = numbers.survival < self.survival;
        if !goes_on && !self.discs {
            return None;
        }
        let (out, chosen) = self.through(up.beta, numbers.up)?;
        if out.squared() > 1.0 {
            return None;
        }
        self.meet_discs(up, out, chosen.is_infinite(), light, sums);
        goes_on.then_some(Out { beta: out, base: down })
    }

    /// The share of light at the diffuser's underside that leaves into the air.
    #[inline]
    fn share_leaving(&self, beta: Beta) -> f64 {
        let offset = beta.length();
        let scattered = self.diffuser.lobe.share_in_disc(offset, 1.0);
        let straight = if offset <= 1.0 { self.straight() } else { 0.0 };
        straight + (1.0 - self.straight()) * scattered
    }

    fn straight(&self) -> f64 {
        self.diffuser.straight_through
    }

    /// Straight through or by the lobe, and the density of the choice.
    #[inline]
    fn through(&self, beta: Beta, u: [f64; 2]) -> Option<(Beta, f64)> {
        let straight = self.straight();
        if u[0] < straight {
            return Some((beta, f64::INFINITY));
        }
        let rest = if straight > 0.0 { (u[0] - straight) / (1.0 - straight) } else { u[0] };
        let to = self.diffuser.lobe.sample(beta, [rest, u[1]])?;
        Some((to, (1.0 - straight) * self.diffuser.lobe.density(beta, to)))
    }

    /// Reflection at the base: a look-up on a first pass, else `carried` becomes `reflected`.
    #[inline]
    fn meet_base(&self, base: Beta, carries: bool, room: &mut Room) -> Option<Stencil> {
        if carries {
            multiply(&mut room.reflected, &room.carried, |out| self.reflectance(base, out));
            return None;
        }
        Some(self.look_up(base))
    }

    #[inline]
    fn look_up(&self, base: Beta) -> Stencil {
        match (&self.stack.base.reflector, self.stack.medium.constant_index()) {
            (Reflector::Specular(table), Some(index)) => table.nodes.stencil(base.squared(), index),
            _ => Stencil::ONLY_NODE,
        }
    }

    fn reflectance(&self, base: Beta, out: &mut [f64]) {
        self.stack.base.reflectance(base.squared(), &self.stack.medium, out);
    }

    /// A direction of the whole medium, as a Lambertian base sends it.
    fn leave_base(&self, numbers: &PassNumbers) -> Upward {
        let n = self.stack.medium.largest_index();
        let (x, y) = warp::uniform_disc(n, numbers.base);
        Upward { beta: Beta { x, y }, density: warp::uniform_disc_density(n) }
    }

    /// Takes away the wavelengths whose medium has no such direction.
    fn keep_within_disc(&self, beta: Beta, spread: Spread, spectra: &mut [f64]) {
        let medium = &self.stack.medium;
        if medium.constant_index().is_some() {
            return;
        }
        let kept: Vec<f64> =
            medium.index().iter().map(|&n| spread.kept(beta, n, medium.largest_index())).collect();
        scale_rows(spectra, &kept);
    }

    /// Beams that come straight through the diffuser and off a specular base, met on the way down.
    fn connect_before_base(&self, beta: Beta, carried: Option<&[f64]>, sums: &mut Sums) {
        if self.straight() == 0.0 || !self.specular {
            return;
        }
        for (source, sum) in self.sources.iter().zip(&mut sums.from_straight_beam) {
            if let Source::Beam(beam) = source {
                let scatter = (1.0 - self.straight()) * self.diffuser.lobe.density(beta, *beam);
                sum.add(carried, PI * scatter);
            }
        }
    }

    /// Beams that come straight through the diffuser onto a Lambertian base.
    fn connect_straight_from_base(&self, light: Reflected<'_>, sums: &mut Sums) {
        if self.straight() == 0.0 {
            return;
        }
        let n = self.stack.medium.largest_index();
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Source::Beam(_) = source {
                sum.add(light, PI * self.straight() * warp::uniform_disc_density(n));
            }
        }
    }

    /// Directed sources, from the diffuser's underside: the last scattering on the way to the light.
    fn connect(&self, up: Upward, light: Reflected<'_>, numbers: &PassNumbers, sums: &mut Sums) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Some(target) = Target::sample(source, numbers.on_source) {
                let lobe = self.diffuser.lobe.density(up.beta, target.beta);
                sum.add(light, target.weight((1.0 - self.straight()) * lobe, lobe, up.density));
            }
        }
    }

    /// Round sources that the path has run into.
    fn meet_discs(&self, up: Upward, out: Beta, straight: bool, light: Reflected<'_>, sums: &mut Sums) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            if let Source::Disc(cone) = source
                && cone.sends(out)
            {
                let target = Target::on_disc(cone, out);
                let weight = if straight {
                    target.strength
                } else {
                    let lobe = self.diffuser.lobe.density(up.beta, out);
                    target.weight((1.0 - self.straight()) * lobe, lobe, up.density)
                };
                sum.add(light, weight);
            }
        }
    }

    /// Directed sources, by a direction below the diffuser that is drawn from the source's
    /// side; `chosen` is the density with which the path itself would choose it.
    fn sample_backwards(
        &self,
        chosen: impl Fn(Beta) -> f64,
        carries: bool,
        numbers: &PassNumbers,
        sums: &mut Sums,
        room: &mut Room,
    ) {
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            let Some((beta, weight)) = self.backwards(source, &chosen, numbers) else { continue };
            if carries {
                let Room { carried, backwards, .. } = room;
                multiply(backwards, carried, |out| self.reflectance(beta, out));
                self.keep_within_disc(beta, Spread::No, backwards);
                sum.add(Reflected::Spectra(backwards), weight);
            } else {
                sum.add(Reflected::LookUp(self.look_up(beta)), weight);
            }
        }
    }

    /// The same for light that a Lambertian base has scattered.
    fn sample_backwards_from_base(
        &self,
        look_up: Option<Stencil>,
        numbers: &PassNumbers,
        sums: &mut Sums,
        room: &mut Room,
    ) {
        let density = warp::uniform_disc_density(self.stack.medium.largest_index());
        for (source, sum) in self.sources.iter().zip(&mut sums.from_source) {
            let Some((beta, weight)) = self.backwards(source, |_| density, numbers) else { continue };
            let Room { reflected: met, backwards, .. } = room;
            if look_up.is_none() {
                backwards.copy_from_slice(met);
                self.keep_within_disc(beta, Spread::Lambertian, backwards);
            }
            sum.add(reflected(look_up, backwards), weight);
        }
    }

    /// A direction in the medium drawn from the lobe around a source, and its balanced weight.
    fn backwards(
        &self,
        source: &Source,
        chosen: impl Fn(Beta) -> f64,
        numbers: &PassNumbers,
    ) -> Option<(Beta, f64)> {
        let target = Target::sample(source, numbers.on_source)?;
        let beta = self.diffuser.lobe.sample(target.beta, numbers.backwards)?;
        let forward = chosen(beta);
        if beta.length() >= self.stack.medium.largest_index() || forward == 0.0 {
            return None;
        }
        let lobe = self.diffuser.lobe.density(beta, target.beta);
        Some((beta, target.weight((1.0 - self.straight()) * lobe, lobe, forward)))
    }

    pub(super) fn estimate(&self, tally: &Tally, scale: f64) -> Estimate {
        let sums = &tally.sums;
        let base = &self.stack.base;
        let reflected = sums.reflected.sum(base, scale);
        let leaving = sums.leaving.sum(base, scale);
        let rho = (0..self.sources.len()).map(|i| self.rho(i, sums, &leaving, scale)).collect();
        let ledger = self.ledger(&sums.entering.sum(scale), &sums.arriving.sum(scale), &reflected, &leaving);
        Estimate { rho, ledger }
    }

    /// Reflectance factor under source `i` alone.
    fn rho(&self, i: usize, sums: &Sums, leaving: &[f64], scale: f64) -> Rho {
        let front = &self.stack.front;
        let through: Vec<f64> = front
            .transmittance
            .iter()
            .zip(self.diffuser.transmittance.iter())
            .map(|(t, diffuser)| (t * diffuser).powi(2))
            .collect();
        let mut base = match &self.sources[i] {
            Source::Diffuse => leaving.to_vec(),
            Source::Beam(beam) => self.beam_light(i, *beam, sums, scale),
            Source::Disc(_) => sums.from_source[i].sum(&self.stack.base, scale),
        };
        let front = front.reflectance_above.iter().map(|r| r * sums.image[i] * scale).collect();
        scale_rows(&mut base, &through);
        Rho { base, front }
    }

    /// A beam's light reaches the diffuser also by way of its own specular round trips.
    fn beam_light(&self, i: usize, beam: Beta, sums: &Sums, scale: f64) -> Vec<f64> {
        let mut base = sums.from_source[i].sum(&self.stack.base, scale);
        if self.straight() == 0.0 || !self.specular {
            return base;
        }
        let mut r = vec![0.0; base.len()];
        self.reflectance(beam, &mut r);
        let before = sums.from_straight_beam[i].sum(scale);
        let round_trips = specular::round_trips(self.stack, self.diffuser, &r);
        for (k, value) in base.iter_mut().enumerate() {
            *value = (*value + self.straight() * r[k] * before[k]) * round_trips[k];
        }
        base
    }

    fn ledger(&self, entering: &[f64], arriving: &[f64], reflected: &[f64], leaving: &[f64]) -> Ledger {
        let mut ledger = Ledger::zeros(entering.len());
        let (front, inactive) = (&self.stack.front, &self.stack.base.inactive_absorptance);
        for k in 0..entering.len() {
            let bin = k % inactive.len();
            let (flat, diffuser) = (front.at(bin), self.diffuser.transmittance[bin]);
            // Shares at the diffuser's upper and lower side.
            let (above, below) = (flat.t, flat.t * diffuser);
            let up = below * diffuser * leaving[k];
            ledger.inactive[k] = below * arriving[k] * inactive[bin];
            ledger.pixel[k] = below * (arriving[k] - reflected[k]) - ledger.inactive[k];
            ledger.diffuser[k] = above * entering[k] - below * arriving[k] + below * reflected[k] - up;
            ledger.returned[k] = flat.above + up * flat.t;
            ledger.front[k] = 1.0 - flat.t - flat.above + up * (1.0 - flat.t - flat.below);
            ledger.unaccounted[k] = up * flat.below - above * (entering[k] - 1.0);
        }
        ledger
    }
}

/// The uniform numbers of one pass, for each decision its own.
#[derive(Debug, Clone, Copy)]
struct PassNumbers {
    down: [f64; 2],
    up: [f64; 2],
    /// Where a Lambertian base sends the light.
    base: [f64; 2],
    /// Whether the path goes on.
    survival: f64,
    /// Which point of a source.
    on_source: [f64; 2],
    /// Which direction below the diffuser, from the source's side.
    backwards: [f64; 2],
}

impl PassNumbers {
    #[inline]
    fn new(numbers: &PathNumbers<'_>, pass: u32, walk: &Diffused<'_>) -> Self {
        let a = numbers.event(pass, 0);
        let b = if walk.specular && pass == 0 { [0.5; 4] } else { numbers.event(pass, 1) };
        let c = if walk.directed { numbers.event(pass, 2) } else { [0.5; 4] };
        Self {
            down: [a[0], a[1]],
            up: [a[2], a[3]],
            base: [b[0], b[1]],
            survival: if pass == 0 { numbers.first_survival() } else { b[2] },
            on_source: [c[0], c[1]],
            backwards: [c[2], c[3]],
        }
    }
}

/// Light above the diffuser again.
#[derive(Debug, Clone, Copy)]
struct Out {
    beta: Beta,
    /// The direction in which it met the base.
    base: Beta,
}

/// How a base spreads light, for wavelengths whose medium has a smaller disc than the largest.
#[derive(Debug, Clone, Copy)]
enum Spread {
    No,
    Lambertian,
}

impl Spread {
    /// The weight of `beta` at index `n`, where it was drawn for index `largest`.
    fn kept(self, beta: Beta, n: f64, largest: f64) -> f64 {
        match self {
            _ if beta.squared() >= n * n => 0.0,
            Self::No => 1.0,
            Self::Lambertian => (largest / n).powi(2),
        }
    }
}

#[inline]
fn reflected(look_up: Option<Stencil>, spectra: &[f64]) -> Reflected<'_> {
    look_up.map_or(Reflected::Spectra(spectra), Reflected::LookUp)
}

/// `out = values * f`, where `fill` writes f.
fn multiply(out: &mut [f64], values: &[f64], fill: impl FnOnce(&mut [f64])) {
    fill(out);
    out.iter_mut().zip(values).for_each(|(o, v)| *o *= v);
}

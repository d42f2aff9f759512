//! The tracer of a panel with a diffuser.
//!
//! One pass: down through the diffuser, off the base, up through the diffuser, out
//! through the front, which may send the path into a further pass. With T the
//! diffuser's and t the front's transmittance, every contribution of the k-th pass holds
//! `t^2 T^2` and, for each pass before, `T^2 r R`: r the front's reflectance from
//! below, R the base's. The factor `t^2 T^2` is applied at the end.

mod books;
mod sources;

use papilio_optics::Beta;
use papilio_sampling::warp;

use super::tally::Reflected;
use super::{PathNumbers, scale_rows};
use crate::angular::Stencil;
use crate::{Cone, Panel, Source};
use crate::{Diffuser, Reflector};
pub(super) use books::Tally;
use books::{Room, Sums};

/// A path never goes on with a higher probability than this.
const MOST_SURVIVAL: f64 = 0.999;

/// Nor, if there is a further pass at all, with a lower one: where lamps are seen but faintly,
/// a few bright later passes would carry much of their light, and the error with it.
const LEAST_SURVIVAL: f64 = 0.05;

#[derive(Debug)]
pub(super) struct Diffused<'a> {
    stack: &'a Panel,
    diffuser: &'a Diffuser,
    view: Cone,
    sources: &'a [Source],
    /// Probability of a further pass: a bound of the light that is left, but for the limits above.
    survival: f64,
    /// `T^2 r / survival`, per wavelength.
    between_passes: Vec<f64>,
    /// The base is a mirror.
    specular: bool,
    /// There are beams or discs.
    directed: bool,
    discs: bool,
}

/// Light on its way up to the diffuser's underside.
#[derive(Debug, Clone, Copy)]
struct Upward {
    beta: Beta,
    /// Density with which the path chose `beta`; infinite if it had no choice.
    density: f64,
}

impl<'a> Diffused<'a> {
    pub(super) fn new(stack: &'a Panel, diffuser: &'a Diffuser, view: Cone, sources: &'a [Source]) -> Self {
        let sent_back = diffuser.transmittance.zip_map(&stack.front.reflectance_below, |t, r| t * t * r);
        let goes_on = !stack.single_pass && stack.front.transmittance.max() > 0.0;
        let left = if goes_on { sent_back.max() * stack.base.largest_reflectance() } else { 0.0 };
        let directed = sources.iter().any(|source| *source != Source::Diffuse);
        let least = if directed && left > 0.0 { LEAST_SURVIVAL } else { left.min(MOST_SURVIVAL) };
        let survival = left.clamp(least, MOST_SURVIVAL);
        let between_passes =
            sent_back.iter().map(|r| if survival > 0.0 { r / survival } else { 0.0 }).collect();
        let specular = matches!(stack.base.reflector, Reflector::Specular(_));
        let discs = sources.iter().any(|source| matches!(source, Source::Disc(_)));
        Self { stack, diffuser, view, sources, survival, between_passes, specular, directed, discs }
    }

    pub(super) fn path(&self, numbers: &PathNumbers<'_>, tally: &mut Tally) {
        let Tally { sums, room } = tally;
        let mut beta = self.view.sample_towards(numbers.field());
        // In a dispersive medium the disc of directions depends on wavelength: spectra from the start.
        let mut carries = self.stack.medium.constant_index().is_none();
        if carries {
            room.carried.fill(1.0);
        }
        let mut scattered = false;
        for pass in 0.. {
            let numbers = PassNumbers::new(numbers, pass, self);
            let light = Downward { beta, carries, scattered };
            let Some(out) = self.pass(light, &numbers, sums, room) else { return };
            scattered = out.scattered;
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
    fn pass(&self, light: Downward, numbers: &PassNumbers, sums: &mut Sums, room: &mut Room) -> Option<Out> {
        let Downward { beta, carries, scattered } = light;
        sums.entering.add(carries.then_some(&room.carried), 1.0);
        if self.specular {
            self.connect_before_base(beta, carries, numbers, sums, room);
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
            self.connect_straight_from_base(look_up, numbers, sums, room);
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
        let (straight_down, straight_up) = (self.specular && density.is_infinite(), chosen.is_infinite());
        if !straight_up {
            self.meet_discs(up, out, light, sums);
        } else if straight_down && scattered {
            self.meet_discs_by_specular_light(out, light, sums);
        }
        let scattered = scattered || !(straight_down && straight_up);
        goes_on.then_some(Out { beta: out, base: down, scattered })
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

/// Light above the diffuser, on its way down.
#[derive(Debug, Clone, Copy)]
struct Downward {
    beta: Beta,
    /// It carries spectra; else all of them are one.
    carries: bool,
    /// It has been scattered since it entered.
    scattered: bool,
}

/// Light above the diffuser again.
#[derive(Debug, Clone, Copy)]
struct Out {
    beta: Beta,
    /// The direction in which it met the base.
    base: Beta,
    scattered: bool,
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

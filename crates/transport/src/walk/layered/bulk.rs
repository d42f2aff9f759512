//! A path inside a scattering medium: flights and deflections until it leaves.
//!
//! Depth is optical depth from the top and counts scattering and its losses alone. The internal transmittance
//! of the medium is a weight along the path. The length of a flight is exponential; that of the first flight
//! is conditioned on ending in the medium, since the regular part is known without it. In a thin medium later
//! flights end there with a probability of at least [`LEAST_AGAIN`] and weigh less accordingly: otherwise
//! light that is scattered twice would be so rare that all replicates could miss it. For the same reason a
//! fraction of the first deflections in a thin medium is directed to where the light of a source is bright:
//! around the direction of the source, by the phase function. (Without this, light from a source at 80 deg
//! that is seen along the normal after two deflections of a narrow phase function needed a path in 20 000,
//! and was a tenth of the light.) Survival of absorption is never so improbable that few paths see it.
//!
//! Where the albedo is the same at every wavelength and nothing else absorbs, nothing inside the medium
//! depends on wavelength: a few numbers change along the path, and the spectra once, when it leaves.

use papilio_optics::Beta;
use papilio_optics::phase::HenyeyGreenstein;
use papilio_sampling::warp;
use papilio_spectra::Spectrum;

use super::controls::{self, Brightness, Flight};
use super::ledger::{Sums, Workspace};
use super::{OutgoingRay, most_survival, orders};
use crate::Medium;
use crate::layers::Scattered;
use crate::skeleton::{Propagation, Ray};
use crate::walk::horizon::Horizons;

/// The least probability with which a flight in a thin medium ends there.
const LEAST_AGAIN: f64 = 0.05;
/// The least probability of surviving absorption in an early event.
const LEAST_SURVIVAL: f64 = 0.1;
/// Fraction of the first deflections that is directed to sources, and the number of events that count as
/// first.
const TO_LAMPS: f64 = 0.25;
const FIRST_EVENTS: u32 = 4;
/// Media below this optical thickness direct some light to sources, if their phase function is narrow:
/// thicker ones spread the light of sources by many events.
const CLEAR: f64 = 2.0;
const NARROW: f64 = 0.5;

/// Optical length below which the mean depth of a flight that stays has lost digits; it needs no control.
const LEAST_EDGE: f64 = 1e-3;

/// Optical thickness below which a medium is thin: most flights from within it end outside.
pub(super) const THIN: f64 = 0.1;

/// A scattering medium.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bulk<'a> {
    element: usize,
    /// Its number among the scattering media.
    number: usize,
    index: f64,
    optical_thickness: f64,
    phase: HenyeyGreenstein,
    albedo: &'a Spectrum,
    largest_albedo: f64,
    transmittance: Option<&'a Spectrum>,
    /// Nothing depends on wavelength.
    grey: bool,
    horizons: Option<Horizons>,
}

/// Position of a branch in the medium, and its weights since its spectra were last updated.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stay {
    pub(super) depth: f64,
    /// A unit vector; the third component is positive downwards.
    pub(super) direction: [f64; 3],
    /// The lights that multiply control variates.
    brightness: Brightness,
    /// Weight of the light.
    scale: f64,
    absorbed: f64,
    dropped: f64,
}

/// What follows a deflection.
#[derive(Debug)]
pub(super) enum Outcome {
    /// Nothing.
    Ended,
    /// Another deflection.
    Within,
    /// Light that leaves the medium.
    Left(OutgoingRay),
}

impl Stay {
    /// Roulette; false if the path ends.
    fn survives(&mut self, u: f64, probability: f64) -> bool {
        self.weigh(if u < probability { 1.0 / probability } else { 0.0 });
        self.scale > 0.0
    }

    /// Multiplies by the weight of a random decision, whose mean is 1.
    fn weigh(&mut self, weight: f64) {
        self.dropped += self.scale * (1.0 - weight);
        self.scale *= weight;
    }
}

impl<'a> Bulk<'a> {
    pub(super) fn new(
        (element, number): (usize, usize),
        medium: &'a Medium,
        horizons: Option<Horizons>,
    ) -> Option<Self> {
        let scattering = medium.scattering()?;
        let transmittance = medium.transmittance();
        Some(Self {
            element,
            number,
            index: medium.largest_index(),
            optical_thickness: scattering.optical_thickness,
            phase: HenyeyGreenstein { anisotropy: scattering.anisotropy },
            albedo: &scattering.albedo,
            largest_albedo: scattering.albedo.max(),
            transmittance,
            grey: transmittance.is_none() && scattering.albedo.is_constant(),
            horizons: horizons.and_then(|all| all.within(medium.largest_index())),
        })
    }

    /// Follows light that enters with these cosines to its first scattering event.
    pub(super) fn enter(
        &self,
        (beta, going): (Beta, Propagation),
        flight: f64,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Stay {
        let direction = self.direction(beta, going);
        let depth = self.first_depth(direction[2], flight);
        let flown = if going == Propagation::Down { depth } else { self.optical_thickness - depth };
        // Before the light depends on the flight.
        let brightness = workspace.light.brightness();
        self.absorb(flown / direction[2].abs(), sums, workspace);
        workspace.gathered.clear();
        let (slope, cosine) = (2.0 * direction[2] / self.optical_thickness, direction[2]);
        let from = if going == Propagation::Down { -1.0 } else { 1.0 };
        let edge = self.optical_thickness / cosine.abs();
        let reached = Some(from + slope * flown / cosine.abs());
        let trapped = self.is_trapped(cosine);
        let flight = Flight { cosine, trapped, from, slope, edge, reached, weight: 1.0, stays: true };
        if let Some(controls) = workspace.controls.as_mut().filter(|_| edge > LEAST_EDGE) {
            controls.flight(brightness, &flight);
        }
        self.balance(direction, &flight, 1.0, workspace);
        Stay { depth, direction, brightness, scale: 1.0, absorbed: 0.0, dropped: 0.0 }
    }

    /// A deflection, and the flight after it.
    pub(super) fn deflect(
        &self,
        stay: &mut Stay,
        [survive, angle, turn, flight]: [f64; 4],
        generation: u32,
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Outcome {
        if self.grey {
            stay.absorbed += stay.scale * (1.0 - self.largest_albedo);
            stay.scale *= self.largest_albedo;
        } else {
            workspace.light.keep(|bin| self.albedo[bin], &mut sums.absorbed.diffuser);
        }
        let early = generation <= FIRST_EVENTS;
        let part = if early { self.part_to_lamps(&workspace.lamps.now().about) } else { 0.0 };
        self.gather(stay, part, workspace);
        let least = if early && self.largest_albedo > 0.0 { LEAST_SURVIVAL } else { 0.0 };
        let survives = stay.survives(survive, (self.largest_albedo * most_survival(generation)).max(least));
        if !self.grey || !survives {
            self.settle(stay, sums, workspace);
        }
        if !survives {
            return Outcome::Ended;
        }
        let about = &workspace.lamps.now().about;
        let before = stay.direction;
        stay.direction = self.deflected(before, part, [angle, turn], about);
        let cos = cosine_between(before, stay.direction);
        let drawn = self.drawn(cos, stay.direction, part, about);
        let is_mixed = part > 0.0 || self.horizons.is_some();
        let ratio = if is_mixed { self.phase.at_cosine(cos) / drawn } else { 1.0 };
        let edge = self.way_out(stay);
        let (length, weight) = self.fly(edge, flight);
        let depth = 2.0 * stay.depth / self.optical_thickness - 1.0;
        let slope = 2.0 * stay.direction[2] / self.optical_thickness;
        let flight = Flight {
            cosine: stay.direction[2],
            trapped: self.is_trapped(stay.direction[2]),
            from: depth,
            slope,
            edge,
            reached: (length < edge).then_some(depth + slope * length),
            weight,
            stays: false,
        };
        if let Some(controls) = workspace.controls.as_mut().filter(|_| generation < controls::GENERATIONS) {
            let light = stay.brightness.map(|light| light * stay.scale);
            controls.deflection(light, [before[2], stay.direction[2]], (self.phase.anisotropy, ratio), depth);
            controls.flight(light.map(|light| light * ratio), &flight);
        }
        self.balance(stay.direction, &flight, stay.scale * ratio, workspace);
        let weight = weight * ratio;
        if weight != 1.0 {
            stay.weigh(weight);
            self.settle(stay, sums, workspace);
        }
        if length >= edge {
            self.settle(stay, sums, workspace);
            self.absorb(edge, sums, workspace);
            return Outcome::Left(self.leave(stay, drawn));
        }
        self.absorb(length, sums, workspace);
        stay.depth = (stay.depth + length * stay.direction[2]).clamp(0.0, self.optical_thickness);
        Outcome::Within
    }

    /// Place in the medium as numbers from 0 to 1, close to each other for close places: depth, and the
    /// components of the direction.
    pub(super) fn place(&self, stay: &Stay) -> [f64; 4] {
        let [x, y, z] = stay.direction.map(|component| 0.5 * (1.0 + component));
        [stay.depth / self.optical_thickness, z, x, y]
    }

    /// Fraction of directions that are sampled around sources in the first events of a path.
    fn part_to_lamps(&self, lamps: &[Beta]) -> f64 {
        let wanted = self.optical_thickness < CLEAR && self.phase.anisotropy.abs() > NARROW;
        if wanted && self.about_lamps(lamps).next().is_some() { TO_LAMPS } else { 0.0 }
    }

    /// Directions of sources. They do not depend on the sampled points of round sources, since the densities
    /// that contain them must be the same for every point.
    fn about_lamps(&self, lamps: &[Beta]) -> impl Iterator<Item = [f64; 3]> {
        let within = lamps.iter().filter(|beta| beta.squared() < self.index * self.index);
        within.flat_map(|beta| WAYS.map(|going| self.direction(*beta, going)))
    }

    /// A direction after a deflection.
    fn deflected(&self, from: [f64; 3], part: f64, [mut angle, turn]: [f64; 2], lamps: &[Beta]) -> [f64; 3] {
        let towards = self.horizons.and_then(|horizons| horizons.of_medium(&mut angle, turn));
        if let Some((beta, up)) = towards {
            return self.direction(beta, if up { Propagation::Up } else { Propagation::Down });
        }
        if angle >= part {
            let angle = if part > 0.0 { (angle - part) / (1.0 - part) } else { angle };
            return warp::deflected(from, 1.0 - self.phase.sample_cosine(angle), turn);
        }
        let count = self.about_lamps(lamps).count();
        let place = angle / part * count as f64;
        let axis = self.about_lamps(lamps).nth((place as usize).min(count - 1)).unwrap_or(from);
        warp::deflected(axis, 1.0 - self.phase.sample_cosine(place.fract()), turn)
    }

    /// Density per steradian with which [`Self::deflected`] samples a direction, at an angle of this
    /// cosine to the direction before.
    fn drawn(&self, cos: f64, to: [f64; 3], part: f64, lamps: &[Beta]) -> f64 {
        let by_phase = self.drawn_by_phase(cos, to, part, lamps);
        self.horizons.map_or(by_phase, |horizons| horizons.medium_density(by_phase, self.index, to))
    }

    /// The same without the directions towards the horizons.
    fn drawn_by_phase(&self, cos: f64, to: [f64; 3], part: f64, lamps: &[Beta]) -> f64 {
        let kernel = self.phase.at_cosine(cos);
        if part == 0.0 {
            return kernel;
        }
        let (mut sum, mut count) = (0.0, 0.0);
        for axis in self.about_lamps(lamps) {
            sum += self.phase.at_cosine(cosine_between(axis, to));
            count += 1.0;
        }
        (1.0 - part) * kernel + part * sum / count
    }

    pub(super) fn index(&self) -> f64 {
        self.index
    }

    pub(super) fn is_grey(&self) -> bool {
        self.grey
    }

    pub(super) fn anisotropy(&self) -> f64 {
        self.phase.anisotropy
    }

    pub(super) fn optical_thickness(&self) -> f64 {
        self.optical_thickness
    }

    pub(super) fn largest_albedo(&self) -> f64 {
        self.largest_albedo
    }

    /// Unit vector of light with these cosines, never exactly parallel to the layer.
    pub(super) fn direction(&self, beta: Beta, going: Propagation) -> [f64; 3] {
        let (x, y) = (beta.x / self.index, beta.y / self.index);
        let z = (1.0 - x * x - y * y).max(1e-18).sqrt();
        [x, y, if going == Propagation::Down { z } else { -z }]
    }

    /// Depth at which the first flight ends; it ends in the medium.
    fn first_depth(&self, cosine: f64, u: f64) -> f64 {
        let most = self.optical_thickness / cosine.abs();
        let reach = -(u * (-most).exp_m1()).ln_1p() * cosine.abs();
        let reach = reach.min(self.optical_thickness);
        if cosine > 0.0 { reach } else { self.optical_thickness - reach }
    }

    /// True if a flat interface would not let light of this cosine out into the air.
    fn is_trapped(&self, cosine: f64) -> bool {
        self.index * self.index * (1.0 - cosine * cosine) >= 1.0
    }

    /// Optical length to the boundary of the medium.
    fn way_out(&self, stay: &Stay) -> f64 {
        let z = stay.direction[2];
        let rest = if z > 0.0 { self.optical_thickness - stay.depth } else { stay.depth };
        rest / z.abs().max(f64::MIN_POSITIVE)
    }

    /// Length of a flight and its weight; `edge` or more if it leaves the medium.
    fn fly(&self, edge: f64, u: f64) -> (f64, f64) {
        if self.optical_thickness > THIN {
            return (-u.ln(), 1.0);
        }
        let within = -(-edge).exp_m1();
        let chosen = within.max(LEAST_AGAIN);
        if u < chosen {
            (-(-u / chosen * within).ln_1p(), within / chosen)
        } else {
            (f64::INFINITY, (1.0 - within) / (1.0 - chosen))
        }
    }

    /// A density per steradian per unit area of direction cosines, in a direction with this cosine to the
    /// normal.
    pub(super) fn over_cosines(&self, density: f64, cosine: f64) -> f64 {
        density / (self.index * self.index * cosine.abs().max(f64::MIN_POSITIVE))
    }

    /// Adds the light of each source that this event scatters into the branch; [`Self::settle`] adds it to
    /// the sums.
    fn gather(&self, stay: &Stay, part: f64, workspace: &mut Workspace) {
        let Workspace { lamps, gathered, .. } = workspace;
        let lamps = lamps.now();
        for (k, lamp) in lamps.iter().enumerate() {
            if lamp.beta.squared() >= self.index * self.index {
                continue;
            }
            if gathered.len() <= k {
                gathered.resize(k + 1, [0.0; 2]);
            }
            for (way, going) in WAYS.into_iter().enumerate() {
                let towards = self.direction(lamp.beta, going);
                let cos = cosine_between(towards, stay.direction);
                let rest = match going {
                    Propagation::Down => self.optical_thickness - stay.depth,
                    Propagation::Up => stay.depth,
                };
                let value = self.over_cosines(self.phase.at_cosine(cos), towards[2]);
                let density = self.over_cosines(self.drawn(cos, towards, part, &lamps.about), towards[2]);
                let weight = lamp.weight(Scattered { value, density, reverse: value }, 0.0, f64::INFINITY);
                gathered[k][way] += stay.scale * weight * (-rest / towards[2].abs()).exp();
            }
        }
    }

    /// Adds the control variates of light from sources ([`orders`]) for a flight with this scale, and for the
    /// deflection before it.
    fn balance(&self, direction: [f64; 3], flight: &Flight, scale: f64, workspace: &mut Workspace) {
        let Workspace { lamps, gathered, .. } = workspace;
        let lamps = lamps.now();
        if !lamps.ordered {
            return;
        }
        let Flight { from, slope, edge, reached, weight, stays, .. } = *flight;
        let mut moments = orders::moments(from, slope, edge);
        let mut leaves = (-edge).exp();
        if stays {
            let within = -(-edge).exp_m1();
            moments.iter_mut().for_each(|moment| *moment /= within);
            leaves = 0.0;
        }
        for (k, lamp) in lamps.iter().enumerate() {
            let Some(orders) = lamp.orders(self.number) else { continue };
            if gathered.len() <= k {
                gathered.resize(k + 1, [0.0; 2]);
            }
            let expected = orders.expected(direction, from, &moments, leaves);
            let after = expected.after(reached);
            for (way, sum) in gathered[k].iter_mut().enumerate() {
                // The first flight follows no deflection.
                let before = if stays { 0.0 } else { expected.before[way] };
                *sum += scale * (expected.flight[way] - before - weight * after[way]);
            }
        }
    }

    /// Brings the branch's spectra and the sums up to date.
    fn settle(&self, stay: &mut Stay, sums: &mut Sums, workspace: &mut Workspace) {
        let Workspace { light, lamps, share, gathered, .. } = workspace;
        for (lamp, weights) in lamps.now().iter().zip(gathered) {
            share.clear();
            for (weight, going) in std::mem::take(weights).into_iter().zip(WAYS) {
                let z = self.direction(lamp.beta, going)[2];
                let rest = if z > 0.0 { self.optical_thickness - stay.depth } else { stay.depth };
                let clear = |bin| self.clear(rest / z.abs(), bin);
                lamp.reach(Ray::from_element(self.element, going), |bin| weight * clear(bin), share);
            }
            lamp.add(light, share, sums);
        }
        sums.absorbed.diffuser.add(light, stay.absorbed);
        sums.unaccounted.add(light, stay.dropped);
        light.scale(stay.scale);
        stay.brightness =
            if self.grey { stay.brightness.map(|value| value * stay.scale) } else { light.brightness() };
        *stay = Stay { scale: 1.0, absorbed: 0.0, dropped: 0.0, ..*stay };
    }

    /// Applies absorption besides the scattering, over this optical length.
    fn absorb(&self, length: f64, sums: &mut Sums, workspace: &mut Workspace) {
        if self.transmittance.is_some() {
            workspace.light.keep(|bin| self.clear(length, bin), &mut sums.absorbed.glass);
        }
    }

    /// Internal transmittance over this optical length.
    fn clear(&self, length: f64, bin: usize) -> f64 {
        self.transmittance.map_or(1.0, |t| t[bin].powf(length / self.optical_thickness))
    }

    /// Light that leaves the medium in a direction that was sampled with this density per steradian.
    fn leave(&self, stay: &Stay, drawn: f64) -> OutgoingRay {
        let [x, y, z] = stay.direction;
        let going = if z > 0.0 { Propagation::Down } else { Propagation::Up };
        let beta = Beta { x: self.index * x, y: self.index * y };
        OutgoingRay::exactly(beta, Ray::from_element(self.element, going), self.over_cosines(drawn, z))
    }
}

fn cosine_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

const WAYS: [Propagation; 2] = [Propagation::Up, Propagation::Down];

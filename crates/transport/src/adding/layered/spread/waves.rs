//! Light of a frequency between scatterers, backwards from where it is seen.
//!
//! The value of light is what of it reaches the view (or the room, or the pixel). A scatterer gives light that arrives the value of
//! what it emits, order by order ([`Kernels`]); between scatterers values are multiplied by transmittances and phases at each azimuth. Both
//! alternate until nothing is left.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::rc::Rc;

use num_complex::Complex64;
use papilio_fourier::Circle;

use super::chain::Cavities;
use super::kernels::{Kernels, Light, Orders};
use super::rings::Ring;
use crate::skeleton::{Propagation, Ray};

/// Rounds of scattering after which the rest is neglected.
const MOST_ROUNDS: usize = 400;

/// Most numbers that are remembered of the flat elements at a wave.
const MOST_REMEMBERED: usize = 1 << 22;

/// Links between all scatterers, by ring: `[step][from][to]`.
type Known = Vec<Vec<Complex64>>;

/// A frequency.
pub(super) struct Wave {
    /// Radians per mm.
    pub(super) per_mm: f64,
    /// Azimuth.
    pub(super) turn: f64,
    pub(super) rings: Rc<Vec<Ring>>,
}

/// Ray of a view or a source.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beam {
    /// Extra node.
    pub(super) extra: usize,
    pub(super) turn: f64,
    pub(super) weight: f64,
    /// Whether it is a whole ring, the same at all azimuths.
    pub(super) is_ring: bool,
}

/// Where light has a value.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start<'a> {
    /// In these beams in the air; places are relative to those at which the beams themselves meet the pixel.
    Beams(&'a [Beam]),
    /// Everywhere in the air.
    Air,
    /// At the pixel, in all directions.
    Pixel,
    /// At the pixel, on the rings, `[ring][order]`, and in beams with these values.
    Onto(&'a [Complex64], &'a [(Beam, Complex64)]),
}

/// Value of light that arrives.
#[derive(Clone, Copy)]
enum Value<'a> {
    /// One in all directions.
    One,
    /// At the nodes.
    At(&'a Orders),
    /// On the rings, `[ring][order]`.
    OnRings(&'a [Complex64]),
}

/// Light between the scatterers of a stack.
pub(super) struct Between<'a> {
    pub(super) kernels: &'a Kernels,
    /// Number of elements of the stack.
    pub(super) elements: usize,
    /// Number of nodes with weight.
    pub(super) regular: usize,
    /// Values of the last round of scattering relative to all.
    pub(super) tolerance: f64,
}

/// Value of light that leaves the pixel, on the rings of a wave, by azimuthal order; and of the beams themselves.
pub(super) struct Leaving {
    /// `[ring][order]`.
    pub(super) rings: Vec<Complex64>,
    /// By beam of the start, its weight included.
    pub(super) beams: Vec<Complex64>,
}

impl Between<'_> {
    /// Returns the light that leaves a scatterer: upwards and downwards by turns.
    fn emitters(&self) -> Vec<Ray> {
        let both = |element: &usize| {
            [Propagation::Up, Propagation::Down].map(|going| Ray::from_element(*element, going))
        };
        self.kernels.elements.iter().flat_map(both).collect()
    }

    /// Returns the light that arrives at a scatterer, from above and from below by turns.
    fn receiver(&self, site: usize) -> Ray {
        let going = if site.is_multiple_of(2) { Propagation::Down } else { Propagation::Up };
        Ray::arriving_at(self.kernels.elements[site / 2], going)
    }

    pub(super) fn onto_pixel(&self) -> Ray {
        Ray { plane: self.elements, going: Propagation::Down }
    }

    fn leaving_pixel(&self) -> Ray {
        self.onto_pixel().reversed()
    }

    /// Returns the values of light that arrives at the scatterers, for each of some starts at a wave.
    pub(super) fn solve(&self, wave: &Wave, starts: &[Start<'_>]) -> Vec<Light> {
        let emitters = self.emitters();
        let uniform = |start: &Start<'_>| match self.everywhere(*start) {
            Some(value) => self.emitted(wave, &[value], &emitters, None),
            None => vec![None; emitters.len()],
        };
        let uniform: Vec<Light> = starts.iter().map(uniform).collect();
        let mut step = self.kernels.arriving(&uniform);
        for (start, light) in starts.iter().zip(&mut step) {
            match start {
                Start::Beams(beams) => {
                    for beam in *beams {
                        self.add_beam(wave, beam, &self.of_beam(wave, beam, &emitters), light);
                    }
                }
                Start::Onto(_, beams) => {
                    for (beam, value) in *beams {
                        let mut factors = self.links_of_beam(wave, beam, &emitters, self.onto_pixel());
                        factors.iter_mut().for_each(|factor| *factor *= value);
                        self.add_beam(wave, beam, &factors, light);
                    }
                }
                Start::Air | Start::Pixel => {}
            }
        }
        let mut total = step.clone();
        let mut known = vec![Vec::new(); wave.rings.len()];
        for _ in 0..MOST_ROUNDS {
            let next = |light| self.next(wave, light, &emitters, &mut known);
            let emitted: Vec<Light> = step.iter().map(next).collect();
            if emitted.iter().flatten().all(Option::is_none) {
                break;
            }
            step = self.kernels.arriving(&emitted);
            let mut sizes = [0.0_f64; 2];
            for (total, step) in total.iter_mut().flatten().zip(step.iter().flatten()) {
                let Some(step) = step else { continue };
                let total = total.get_or_insert_with(|| vec![Complex64::ZERO; step.len()]);
                for (total, step) in total.iter_mut().zip(step) {
                    *total += step;
                    sizes = [sizes[0].max(step.norm_sqr()), sizes[1].max(total.norm_sqr())];
                }
            }
            if sizes[0] <= self.tolerance * self.tolerance * sizes[1] {
                break;
            }
        }
        total
    }

    fn everywhere<'s>(&self, start: Start<'s>) -> Option<(Ray, Value<'s>)> {
        match start {
            Start::Beams(_) => None,
            Start::Air => Some((Ray::LEAVING, Value::One)),
            Start::Pixel => Some((self.onto_pixel(), Value::One)),
            Start::Onto(rings, _) => Some((self.onto_pixel(), Value::OnRings(rings))),
        }
    }

    /// Returns the value of light that scatterers emit, summed over the rings about each node.
    fn next(&self, wave: &Wave, light: &Light, emitters: &[Ray], known: &mut Known) -> Light {
        let receivers: Vec<(Ray, Value<'_>)> = light
            .iter()
            .enumerate()
            .filter_map(|(site, light)| Some((self.receiver(site), Value::At(light.as_ref()?))))
            .collect();
        // They are remembered for light between all scatterers.
        let known = (receivers.len() == emitters.len()).then_some(known);
        self.emitted(wave, &receivers, emitters, known)
    }

    fn emitted(
        &self,
        wave: &Wave,
        receivers: &[(Ray, Value<'_>)],
        emitters: &[Ray],
        known: Option<&mut Known>,
    ) -> Light {
        let count = self.kernels.count();
        let mut sums: Light = vec![None; emitters.len()];
        if receivers.is_empty() {
            return sums;
        }
        self.cross(wave, (receivers, emitters), (false, known), &mut |ring, emitter, orders| {
            let ring = &wave.rings[ring];
            if ring.weight == 0.0 {
                return;
            }
            let sum = sums[emitter].get_or_insert_with(|| vec![Complex64::ZERO; self.regular * count]);
            for (node, factor) in ring.nodes.clone().zip(ring.factors) {
                let weight = ring.weight * factor;
                sum[node * count..][..count].iter_mut().zip(orders).for_each(|(sum, x)| *sum += weight * x);
            }
        });
        sums
    }

    /// Adds the value of light that is scattered into a beam, given the parts of the beam that come from the scatterers.
    fn add_beam(&self, wave: &Wave, beam: &Beam, factors: &[Complex64], light: &mut Light) {
        for site in 0..self.kernels.elements.len() {
            let factors = [factors[2 * site], factors[2 * site + 1]];
            if factors == [Complex64::ZERO; 2] {
                continue;
            }
            let mut both = [0, 1].map(|side| light[2 * site + side].take());
            let turn = (!beam.is_ring).then_some(beam.turn - wave.turn);
            self.kernels.add_beam(site, (beam.extra, turn), factors, &mut both);
            let [above, below] = both;
            (light[2 * site], light[2 * site + 1]) = (above, below);
        }
    }

    /// Returns the part of a beam in the air that comes from each of some rays without scattering, its weight included.
    fn of_beam(&self, wave: &Wave, beam: &Beam, emitters: &[Ray]) -> Vec<Complex64> {
        let along = wave.per_mm * (beam.turn - wave.turn).cos();
        let own = Complex64::from_polar(beam.weight, along * self.ring(wave, beam).chain.moves_mm());
        let mut links = self.links_of_beam(wave, beam, emitters, Ray::LEAVING);
        links.iter_mut().for_each(|link| *link *= own);
        links
    }

    /// Returns the light of each of some rays along a beam that arrives as another without scattering.
    fn links_of_beam(&self, wave: &Wave, beam: &Beam, emitters: &[Ray], to: Ray) -> Vec<Complex64> {
        let along = wave.per_mm * (beam.turn - wave.turn).cos();
        let mut links = vec![Complex64::ZERO; emitters.len()];
        let chain = &self.ring(wave, beam).chain;
        chain.links([emitters, &[to]], along, &mut Cavities::default(), &mut links);
        links
    }

    /// Returns the ring of a beam: those of the extra nodes are the last ones.
    fn ring<'w>(&self, wave: &'w Wave, beam: &Beam) -> &'w Ring {
        &wave.rings[wave.rings.len() - self.kernels.extras() + beam.extra]
    }

    /// Returns the values of light that leaves the pixel, given those of light that arrives at the scatterers.
    pub(super) fn leaving(
        &self,
        (wave, start): (&Wave, Start<'_>),
        light: &Light,
        only_mean: bool,
    ) -> Leaving {
        let count = self.kernels.count();
        let mut receivers: Vec<(Ray, Value<'_>)> = light
            .iter()
            .enumerate()
            .filter_map(|(site, light)| Some((self.receiver(site), Value::At(light.as_ref()?))))
            .collect();
        receivers.extend(self.everywhere(start));
        let mut rings = vec![Complex64::ZERO; wave.rings.len() * count];
        self.cross(wave, (&receivers, &[self.leaving_pixel()]), (only_mean, None), &mut |ring, _, orders| {
            rings[ring * count..][..count].copy_from_slice(orders);
        });
        let beams = match start {
            Start::Beams(beams) => {
                beams.iter().map(|beam| self.of_beam(wave, beam, &[self.leaving_pixel()])[0]).collect()
            }
            Start::Onto(_, beams) => {
                let returned = |(beam, value): &(Beam, Complex64)| {
                    value * self.links_of_beam(wave, beam, &[self.leaving_pixel()], self.onto_pixel())[0]
                };
                beams.iter().map(returned).collect()
            }
            Start::Air | Start::Pixel => Vec::new(),
        };
        Leaving { rings, beams }
    }

    /// Computes the value of light that is emitted, on each ring, from that of light that arrives; `take` receives the number of
    /// the ring and of the emitter, and the orders: the mean over the azimuth alone if `only_mean`. Links are remembered in `known`.
    fn cross(
        &self,
        wave: &Wave,
        (receivers, emitters): (&[(Ray, Value<'_>)], &[Ray]),
        (only_mean, mut known): (bool, Option<&mut Known>),
        take: &mut dyn FnMut(usize, usize, &[Complex64]),
    ) {
        let (count, highest) = (self.kernels.count(), self.kernels.highest());
        let arrive: Vec<Ray> = receivers.iter().map(|(ray, _)| *ray).collect();
        let pairs = arrive.len() * emitters.len();
        if pairs == 0 {
            return;
        }
        let (mut circles, mut cavities) = (HashMap::new(), Cavities::default());
        let mut orders = vec![Complex64::ZERO; count];
        let mut values: Vec<Vec<Complex64>> = vec![Vec::new(); receivers.len()];
        let (mut links, mut sum, mut by_step) = (vec![Complex64::ZERO; pairs], Vec::new(), Vec::new());
        let mut remembered = 0;
        for (number, ring) in wave.rings.iter().enumerate() {
            let interpolate = |value: &Orders, out: &mut [Complex64]| {
                out.fill(Complex64::ZERO);
                for (node, factor) in ring.nodes.clone().zip(ring.factors) {
                    let at = &value[node * count..][..count];
                    out.iter_mut().zip(at).for_each(|(sum, x)| *sum += factor * x);
                }
            };
            // The air has no other directions.
            let is_one = |ray: &Ray| *ray != Ray::LEAVING || ring.beta < 1.0;
            ring.chain.links([emitters, &arrive], 0.0, &mut cavities, &mut links);
            if wave.per_mm == 0.0 {
                for (value, (ray, given)) in values.iter_mut().zip(receivers) {
                    value.clear();
                    value.resize(count, Complex64::ZERO);
                    match given {
                        Value::One => value[highest] = f64::from(u8::from(is_one(ray))).into(),
                        Value::At(given) => interpolate(given, value),
                        Value::OnRings(given) => value.copy_from_slice(&given[number * count..][..count]),
                    }
                }
                for (emitter, links) in links.chunks_exact(arrive.len()).enumerate() {
                    if links.iter().all(|link| *link == Complex64::ZERO) {
                        continue;
                    }
                    orders.fill(Complex64::ZERO);
                    for (link, value) in links.iter().zip(&values) {
                        orders.iter_mut().zip(value).for_each(|(sum, x)| *sum += link.re * x);
                    }
                    take(number, emitter, &orders);
                }
                continue;
            }
            let lit: Vec<bool> = links
                .chunks_exact(arrive.len())
                .map(|links| links.iter().any(|link| *link != Complex64::ZERO))
                .collect();
            if !lit.contains(&true) {
                continue;
            }
            let steps = steps(highest, wave.per_mm * ring.chain.moves_mm(), ring.chain.reflects());
            let circle = circles.entry(steps).or_insert_with(|| Circle::new(steps));
            for (value, (ray, given)) in values.iter_mut().zip(receivers) {
                value.clear();
                match given {
                    Value::One => value.resize(steps, f64::from(u8::from(is_one(ray))).into()),
                    Value::At(_) | Value::OnRings(_) => {
                        match given {
                            Value::At(given) => interpolate(given, &mut orders),
                            Value::OnRings(given) => {
                                orders.copy_from_slice(&given[number * count..][..count]);
                            }
                            Value::One => {}
                        }
                        value.extend_from_slice(&orders[highest..]);
                        value.resize(steps - highest, Complex64::ZERO);
                        value.extend_from_slice(&orders[..highest]);
                        circle.values(value);
                    }
                }
            }
            let half = steps / 2;
            let along = |k: usize| wave.per_mm * (TAU * k as f64 / steps as f64).cos();
            if let Some(known) = known.as_mut().filter(|known| !known[number].is_empty()) {
                std::mem::swap(&mut by_step, &mut known[number]);
            } else {
                by_step.clear();
                by_step.resize((half + 1) * pairs, Complex64::ZERO);
                let each_step = by_step.chunks_exact_mut(pairs).enumerate();
                if ring.chain.reflects() {
                    each_step.for_each(|(k, out)| {
                        ring.chain.links([emitters, &arrive], along(k), &mut cavities, out)
                    });
                } else {
                    let ways =
                        emitters.iter().flat_map(|from| arrive.iter().map(|to| ring.chain.link(*from, *to)));
                    let ways: Vec<(f64, f64)> = ways.collect();
                    for (k, out) in each_step {
                        let along = along(k);
                        for (out, (t, way)) in out.iter_mut().zip(&ways).filter(|(_, (t, _))| *t != 0.0) {
                            *out = Complex64::from_polar(*t, -way * along);
                        }
                    }
                }
            }
            for (emitter, _) in lit.iter().enumerate().filter(|(_, lit)| **lit) {
                sum.clear();
                sum.resize(steps, Complex64::ZERO);
                for (arrives, value) in values.iter().enumerate() {
                    let pair = emitter * arrive.len() + arrives;
                    for (k, (sum, value)) in sum.iter_mut().zip(value).enumerate() {
                        *sum += by_step[k.min(steps - k) * pairs + pair] * value;
                    }
                }
                let scale = 1.0 / steps as f64;
                if only_mean {
                    orders.fill(Complex64::ZERO);
                    orders[highest] = scale * sum.iter().sum::<Complex64>();
                } else {
                    circle.orders(&mut sum);
                    let wrapped = sum[steps - highest..].iter().chain(&sum[..=highest]);
                    orders.iter_mut().zip(wrapped).for_each(|(order, x)| *order = scale * x);
                }
                take(number, emitter, &orders);
            }
            if let Some(known) = known.as_mut().filter(|_| ring.chain.reflects()) {
                let room = remembered + by_step.len() <= MOST_REMEMBERED;
                if room {
                    remembered += by_step.len();
                    known[number] = std::mem::take(&mut by_step);
                }
            }
        }
    }
}

/// Returns the number of azimuths that resolve a phase of this amplitude between orders up to the highest.
fn steps(highest: usize, phase: f64, reflects: bool) -> usize {
    // Light that is reflected to and fro crosses several times.
    let phase = if reflects { 3.0 * phase } else { phase };
    let needed = (2 * highest + 13) as f64 + phase + 4.0 * phase.cbrt();
    let power = (needed as usize).next_power_of_two();
    if needed as usize <= power / 4 * 3 { power / 4 * 3 } else { power }
}

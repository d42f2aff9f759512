//! Light of a frequency between scatterers, backwards from where it is seen.
//!
//! The value of light is what of it reaches the view (or the room, or the pixel). A scatterer gives light
//! that arrives the value of what it emits, order by order ([`Kernels`]); between scatterers values are
//! multiplied by transmittances and phases at each azimuth. Both alternate until nothing is left.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, Ordering};

use num_complex::Complex64;

use super::NotCovered;
use super::chain::Cavities;
use super::crossing::{Circles, Crossing, Links, Needed, Value};
use super::kernels::{Kernels, Light};
use super::orders::{OnRings, Orders};
use super::rings::Ring;
use crate::skeleton::{Propagation, Ray};

/// Most rounds of scattering.
pub(super) const MOST_ROUNDS: usize = 400;

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
    /// At the pixel, on the rings, and in beams with these values.
    Onto(&'a OnRings, &'a [(Beam, Complex64)]),
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
    pub(super) stop: &'a AtomicBool,
    pub(super) circles: RefCell<Circles>,
    pub(super) links: RefCell<Links>,
}

/// Value of light that leaves the pixel, on the rings of a wave, by azimuthal order; and of the beams
/// themselves.
pub(super) struct Leaving {
    pub(super) rings: OnRings,
    /// By beam of the start, its weight included.
    pub(super) beams: Vec<Complex64>,
}

impl<'a> Between<'a> {
    pub(super) fn new(
        kernels: &'a Kernels,
        (elements, regular): (usize, usize),
        tolerance: f64,
        stop: &'a AtomicBool,
    ) -> Self {
        let mut new = Self {
            kernels,
            elements,
            regular,
            tolerance,
            stop,
            circles: RefCell::default(),
            links: RefCell::default(),
        };
        let mut from = new.emitters();
        from.push(new.leaving_pixel());
        let mut to: Vec<Ray> = (0..2 * kernels.elements.len()).map(|site| new.receiver(site)).collect();
        to.push(new.onto_pixel());
        new.links = RefCell::new(Links::between(from, to));
        new
    }

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
    ///
    /// # Errors
    /// If light is left after the most rounds, or the computation was stopped.
    pub(super) fn solve(&self, wave: &Wave, starts: &[Start<'_>]) -> Result<Vec<Light>, NotCovered> {
        let emitters = self.emitters();
        let uniform = |start: &Start<'_>| match self.everywhere(*start) {
            Some(value) => self.emitted(wave, &[value], &emitters),
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
            self.kernels.settle(light);
        }
        let mut total = step.clone();
        for _ in 0..MOST_ROUNDS {
            if self.stop.load(Ordering::Relaxed) {
                return Err(NotCovered::Stopped);
            }
            let next = |light| self.emitted(wave, &self.receivers(light), &emitters);
            let emitted: Vec<Light> = step.iter().map(next).collect();
            if emitted.iter().flatten().all(Option::is_none) {
                return Ok(total);
            }
            step = self.kernels.arriving(&emitted);
            let mut sizes = [0.0_f64; 2];
            for (total, step) in total.iter_mut().flatten().zip(step.iter().flatten()) {
                let Some(step) = step else { continue };
                match total {
                    Some(total) => total.add(step),
                    None => *total = Some(step.clone()),
                }
                let all = total.as_ref().map_or(0.0, Orders::largest);
                sizes = [sizes[0].max(step.largest()), sizes[1].max(all)];
            }
            if sizes[0] <= self.tolerance * self.tolerance * sizes[1] {
                return Ok(total);
            }
        }
        Err(NotCovered::Rounds)
    }

    /// Returns the value of light that has one in all directions, or on the rings.
    fn everywhere<'s>(&self, start: Start<'s>) -> Option<(Ray, Value<'s>)> {
        match start {
            Start::Beams(_) => None,
            Start::Air => Some((Ray::LEAVING, Value::One)),
            Start::Pixel => Some((self.onto_pixel(), Value::One)),
            Start::Onto(rings, _) => Some((self.onto_pixel(), Value::OnRings(rings))),
        }
    }

    /// Returns the values of light that arrives at the scatterers.
    fn receivers<'l>(&self, light: &'l Light) -> Vec<(Ray, Value<'l>)> {
        let lit = |(site, light): (usize, &'l Option<Orders>)| {
            Some((self.receiver(site), Value::At(light.as_ref()?)))
        };
        light.iter().enumerate().filter_map(lit).collect()
    }

    /// Returns the value of light that scatterers emit, summed over the rings about each node.
    fn emitted(&self, wave: &Wave, receivers: &[(Ray, Value<'_>)], emitters: &[Ray]) -> Light {
        let mut sums: Light = vec![None; emitters.len()];
        let of_nodes = self.kernels.of_nodes();
        let crossing = Crossing { wave, receivers, emitters, needed: Needed::Scattered, of_nodes };
        let orders = crossing.orders();
        let highest = orders.iter().map(|[_, after]| *after).max().unwrap_or(0);
        let known = (&mut *self.circles.borrow_mut(), &mut *self.links.borrow_mut());
        crossing.compute(&orders, known, &mut |ring, emitter, orders| {
            let ring = &wave.rings[ring];
            let sum = sums[emitter].get_or_insert_with(|| Orders::zeros(self.regular, highest));
            for (node, factor) in ring.nodes.clone().zip(ring.factors) {
                sum.add_row(node, ring.weight * factor, orders);
            }
        });
        self.kernels.settle(&mut sums);
        sums
    }

    /// Adds the value of light that is scattered into a beam, given the parts of the beam that come from the
    /// scatterers.
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

    /// Returns the part of a beam in the air that comes from each of some rays without scattering, its weight
    /// included.
    fn of_beam(&self, wave: &Wave, beam: &Beam, emitters: &[Ray]) -> Vec<Complex64> {
        let along = wave.per_mm * (beam.turn - wave.turn).cos();
        let own = Complex64::from_polar(beam.weight, along * self.ring(wave, beam).chain.moves_mm());
        let mut links = self.links_of_beam(wave, beam, emitters, Ray::LEAVING);
        links.iter_mut().for_each(|link| *link *= own);
        links
    }

    /// Returns the light of some beams that leaves the pixel without scattering.
    pub(super) fn straight(&self, wave: &Wave, beams: &[Beam]) -> Complex64 {
        let pixel = [self.leaving_pixel()];
        beams.iter().map(|beam| self.of_beam(wave, beam, &pixel)[0]).sum()
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

    /// Returns the values of light that leaves the pixel, given those of light that arrives at the
    /// scatterers.
    pub(super) fn leaving(
        &self,
        (wave, start): (&Wave, Start<'_>),
        light: &Light,
        needed: Needed,
    ) -> Leaving {
        let mut receivers = self.receivers(light);
        receivers.extend(self.everywhere(start));
        let (emitters, of_nodes) = (&[self.leaving_pixel()], self.kernels.of_nodes());
        let crossing = Crossing { wave, receivers: &receivers, emitters, needed, of_nodes };
        let orders = crossing.orders();
        let mut rings =
            OnRings::with_capacity(orders.len(), orders.iter().map(|[_, after]| 2 * after + 1).sum());
        let known = (&mut *self.circles.borrow_mut(), &mut *self.links.borrow_mut());
        crossing.compute(&orders, known, &mut |ring, _, orders| {
            rings.pad(ring);
            rings.push(orders);
        });
        rings.pad(wave.rings.len());
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
}

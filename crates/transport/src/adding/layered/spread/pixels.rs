//! Light of pixels at the waves, relative to that without regard to places.

use std::f64::consts::PI;
use std::rc::Rc;

use num_complex::Complex64;

use super::chain::{Cavities, Chain};
use super::waves::{Leaving, Start, Wave};
use super::{LayeredSpread, Room, Seen, Set};
use crate::skeleton;
use crate::specular::layered_image;

impl LayeredSpread<'_> {
    /// Light over that without regard to places, below scatterers; `[source][state * wavelength][frequency]`; those with light of
    /// `seen` and the wavelengths of `members` alone.
    pub(super) fn mirrored(
        &self,
        set: &Set,
        waves: &[Wave],
        seen: &[Seen<'_>],
        members: &[f64],
    ) -> Vec<Vec<Vec<Complex64>>> {
        let (states, bins) = (self.stack.base.states(), self.stack.base.bins());
        let between = set.between(self.stack);
        let view = Start::Beams(&self.view);
        let mut light = vec![vec![vec![Complex64::ZERO; waves.len()]; states * bins]; self.sources.len()];
        let lit: Vec<usize> = seen.iter().map(|seen| seen.source).collect();
        let turned = self.sources.iter().any(|room| matches!(room, Room::Beams(_)));
        let only_mean = !turned && set.returned.is_none();
        for (k, wave) in waves.iter().enumerate() {
            let solved = between.solve(wave, &[view]);
            let leaving = between.leaving((wave, view), &solved[0], only_mean);
            let still = Wave { per_mm: 0.0, turn: 0.0, rings: Rc::clone(&wave.rings) };
            let falling: Vec<Option<Leaving>> = (0..self.sources.len())
                .map(|source| {
                    let start = self.sources[source].start();
                    lit.contains(&source)
                        .then(|| between.leaving((&still, start), &set.lit[source], only_mean))
                })
                .collect();
            let reflectance = self.on_rings(wave);
            let once = self.met(set, wave, (&leaving, &falling), &reflectance);
            let twice = set.returned.as_ref().map(|returned| {
                self.twice((set, returned), wave, (&leaving, &falling), &still, &reflectance)
            });
            for (source, once) in once.iter().enumerate() {
                for (at, once) in once.iter().enumerate().filter(|(at, _)| members[at % bins] != 0.0) {
                    let ratios = twice.as_ref().filter(|_| once.norm_sqr() > 0.0).map(|[first, second]| {
                        // Light without regard to places has met the pixel at any of its meetings.
                        let first = if k == 0 { Complex64::ZERO } else { first[source][at] / once };
                        [first, second[source][at] / once]
                    });
                    light[source][at][k] = ratios.map_or(*once, |ratios| once * self.series(ratios));
                }
            }
        }
        for image in &self.images {
            for point in &image.points {
                let seen = layered_image(self.stack, point.beta);
                for (light, base) in light[image.source].iter_mut().zip(&seen.base) {
                    light.iter_mut().for_each(|light| *light += point.weight * base);
                }
            }
        }
        light.into_iter().map(|light| light.into_iter().map(relative_to_first).collect()).collect()
    }

    /// Light of each source that meets the pixel once, given the values of light that leaves it and of light that falls on it;
    /// `[source][state * wavelength]`.
    pub(super) fn met(
        &self,
        set: &Set,
        wave: &Wave,
        (leaving, falling): (&Leaving, &[Option<Leaving>]),
        reflectance: &[f64],
    ) -> Vec<Vec<Complex64>> {
        let numbers = reflectance.len() / wave.rings.len();
        let of_source = |(source, falling): (usize, &Option<Leaving>)| {
            let mut sums = vec![Complex64::ZERO; numbers];
            let Some(falling) = falling else { return sums };
            for (ring, reflectance) in reflectance.chunks_exact(numbers).enumerate() {
                let weight = self.overlap(set, wave, ring, (source, leaving, falling));
                if weight != Complex64::ZERO {
                    sums.iter_mut().zip(reflectance).for_each(|(sum, rho)| *sum += weight * rho);
                }
            }
            sums
        };
        falling.iter().enumerate().map(of_source).collect()
    }

    /// Reflectance of each state and wavelength on the rings; `[ring][state * wavelength]`.
    pub(super) fn on_rings(&self, wave: &Wave) -> Vec<f64> {
        let numbers = self.stack.base.states() * self.stack.base.bins();
        let mut all = vec![0.0; wave.rings.len() * numbers];
        for (ring, out) in wave.rings.iter().zip(all.chunks_exact_mut(numbers)) {
            self.reflectances(ring.beta * ring.beta, out);
        }
        all
    }

    pub(super) fn reflectances(&self, beta_squared: f64, out: &mut [f64]) {
        if let Some(layer) = self.stack.layers.last() {
            self.stack.base.reflectance(beta_squared, &layer.medium, out);
        }
    }

    /// Value of light of a source that a mirror of unit reflectance on a ring returns to the view.
    fn overlap(
        &self,
        set: &Set,
        wave: &Wave,
        ring: usize,
        (source, leaving, falling): (usize, &Leaving, &Leaving),
    ) -> Complex64 {
        let (count, highest) = (set.kernels.count(), set.kernels.highest());
        let rings = &wave.rings;
        let unit = self.sources[source].unit();
        let [from, onto] = [leaving, falling].map(|one| &one.rings[ring * count..][..count]);
        // Azimuths of the light that leaves are relative to that of the frequency.
        let value = |orders: &[Complex64], turn: f64| -> Complex64 {
            let term = |(k, x): (usize, &Complex64)| x * Complex64::cis((k as f64 - highest as f64) * turn);
            orders.iter().enumerate().map(term).sum()
        };
        if rings[ring].weight > 0.0 {
            let term = |k: usize| {
                let order = k as f64 - highest as f64;
                from[k] * onto[count - 1 - k] * Complex64::cis(-order * wave.turn)
            };
            let all: Complex64 = match &self.sources[source] {
                Room::Everywhere => from[highest] * onto[highest],
                Room::Beams(_) => (0..count).map(term).sum(),
            };
            return unit * rings[ring].weight * all;
        }
        let extra = ring + set.kernels.extras() - rings.len();
        let mut sum = Complex64::ZERO;
        for (beam, straight) in self.view.iter().zip(&leaving.beams).filter(|(beam, _)| beam.extra == extra) {
            sum += straight * value(onto, beam.turn);
        }
        if let Room::Beams(beams) = &self.sources[source] {
            for (beam, straight) in beams.iter().zip(&falling.beams).filter(|(beam, _)| beam.extra == extra) {
                sum +=
                    straight * if beam.is_ring { from[highest] } else { value(from, beam.turn - wave.turn) };
            }
        }
        unit * sum
    }

    /// The same below flat layers.
    pub(super) fn ghosts(&self, set: &Set, waves: &[Wave], members: &[f64]) -> Vec<Vec<Vec<Complex64>>> {
        let (states, bins) = (self.stack.base.states(), self.stack.base.bins());
        let mut reflectance = vec![0.0; states * bins];
        let [beta, turn] = self.axis;
        if let Some(layer) = self.stack.layers.last() {
            self.stack.base.reflectance(beta * beta, &layer.medium, &mut reflectance);
        }
        let chain = Chain::new(self.stack, self.lengths_mm, set.bin, beta);
        let onto_pixel = set.between(self.stack).onto_pixel();
        let links = |wave: &Wave| {
            let along = wave.per_mm * (turn - wave.turn).cos();
            let mut links = [Complex64::ZERO; 2];
            let to = [skeleton::Ray::LEAVING, onto_pixel];
            chain.links([&[onto_pixel.reversed()], &to], along, &mut Cavities::default(), &mut links);
            let [leaves, returns] = links;
            (leaves * Complex64::cis(along * chain.moves_mm()), returns)
        };
        let (leaves, returned): (Vec<_>, Vec<_>) = waves.iter().map(links).unzip();
        vec![all_orders(&relative_to_first(leaves), &returned, &reflectance, members)]
    }

    /// The same over a Lambertian pixel, for all sources.
    pub(super) fn lambertian(
        &self,
        set: &Set,
        waves: &[Wave],
        reflectance: &[f64],
        members: &[f64],
    ) -> Vec<Vec<Vec<Complex64>>> {
        let between = set.between(self.stack);
        let area = PI * set.index * set.index;
        let (mut totals, mut returned) = (Vec::new(), Vec::new());
        for (k, wave) in waves.iter().enumerate() {
            // Light that returns is the same at all azimuths of the frequency.
            let known = waves[..k].iter().position(|other| other.per_mm == wave.per_mm);
            let starts = [Start::Beams(&self.view), Start::Pixel];
            let starts = &starts[..if known.is_some() { 1 } else { 2 }];
            let solved = between.solve(wave, starts);
            let mut sums = starts.iter().zip(&solved).map(|(start, light)| {
                let leaving = between.leaving((wave, *start), light, true);
                set.mean(wave, &leaving) + leaving.beams.iter().sum::<Complex64>()
            });
            totals.extend(sums.next());
            let first = sums.next().map(|sum| sum / area);
            returned.push(first.or(known.map(|known| returned[known])).unwrap_or_default());
        }
        vec![all_orders(&relative_to_first(totals), &returned, reflectance, members)]
    }
}

/// Returns all values but the first, relative to it.
fn relative_to_first(values: Vec<Complex64>) -> Vec<Complex64> {
    let zero = values[0].re;
    let relative = |value: &Complex64| if zero > 0.0 { value / zero } else { Complex64::ZERO };
    values[1..].iter().map(relative).collect()
}

/// Returns `seen/(1 - rho A)` for the reflectances of the members, given A at the first, zero, frequency and at all others.
fn all_orders(
    seen: &[Complex64],
    returned: &[Complex64],
    reflectance: &[f64],
    members: &[f64],
) -> Vec<Vec<Complex64>> {
    let one = |(at, rho): (usize, &f64)| {
        if members[at % members.len()] == 0.0 {
            return Vec::new();
        }
        seen.iter().zip(&returned[1..]).map(|(seen, returned)| seen / (1.0 - rho * returned)).collect()
    };
    reflectance.iter().enumerate().map(one).collect()
}

//! Light of pixels at the waves, relative to that without regard to places.

use std::f64::consts::{PI, TAU};
use std::rc::Rc;

use num_complex::Complex64;

use super::chain::{Cavities, Chain};
use super::crossing::Needed;
use super::orders::up_to;
use super::rings::Ring;
use super::waves::{Between, Leaving, Start, Wave};
use super::{LayeredSpread, NotCovered, Room, Seen, Set};
use crate::skeleton;
use crate::specular::layered_image;

/// Light that falls on the pixel without regard to places, on the rings of some waves.
pub(super) struct Fallen {
    rings: Rc<Vec<Ring>>,
    /// By source, with light.
    pub(super) falling: Vec<Option<Leaving>>,
    /// Light that has met the pixel before; `[reflectance][source]`.
    pub(super) again: Vec<Vec<Option<Leaving>>>,
    /// Light that has met one of them more often; `[source][meeting]`.
    pub(super) further: Vec<Vec<Leaving>>,
    /// `[ring][state * wavelength]`.
    pub(super) reflectance: Vec<f64>,
}

impl LayeredSpread<'_> {
    /// Light over that without regard to places, below scatterers; `[source][state * wavelength][frequency]`;
    /// those with light of `seen` and the wavelengths of `members` alone.
    pub(super) fn mirrored(
        &self,
        set: &Set,
        waves: &[Wave],
        seen: &[Seen<'_>],
        members: &[f64],
    ) -> Result<Vec<Vec<Vec<Complex64>>>, NotCovered> {
        let (states, bins) = (self.stack.base().states(), self.stack.base().bins());
        let between = self.between(set);
        let view = Start::Beams(&self.view);
        let mut light = vec![vec![vec![Complex64::ZERO; waves.len()]; states * bins]; self.sources.len()];
        let turned = self.sources.iter().any(|room| matches!(room, Room::Beams(_)));
        let needed = match (turned, &set.returned) {
            (_, Some(_)) => Needed::All,
            (true, None) => Needed::Overlap,
            (false, None) => Needed::Mean,
        };
        let mut powers = vec![vec![0.0; states * bins]; self.sources.len()];
        let mut same: Option<Fallen> = None;
        for (k, wave) in waves.iter().enumerate() {
            let solved = between.solve(wave, &[view])?;
            let leaving = between.leaving((wave, view), &solved[0], needed);
            // Other azimuths of a frequency have the same rings.
            if !same.as_ref().is_some_and(|same| Rc::ptr_eq(&same.rings, &wave.rings)) {
                same = Some(self.fall(set, wave, (seen, needed)));
            }
            let Some(same) = &same else { continue };
            let once = self.met(set, wave, (&leaving, &same.falling), &same.reflectance);
            let meetings =
                set.returned.as_ref().map(|returned| self.meetings((set, returned), (wave, &leaving), same));
            let meetings = meetings.transpose()?;
            for (source, once) in once.iter().enumerate() {
                for (at, once) in once.iter().enumerate().filter(|(at, _)| members[at % bins] != 0.0) {
                    let lit = meetings.as_ref().filter(|_| once.norm_sqr() > 0.0);
                    light[source][at][k] = lit.map_or(*once, |meetings| {
                        if k == 0 {
                            let followed = meetings.followed_twice(source);
                            let own = meetings.twice[1][source][at].re / once.re;
                            powers[source][at] = if followed > 0.0 { own / followed } else { 0.0 };
                        }
                        // Light without regard to places has met the pixel at any of its meetings.
                        once * meetings.series((source, at), *once, powers[source][at], k == 0)
                    });
                }
            }
        }
        for image in &self.images {
            for point in &image.points {
                let seen = layered_image(self.stack, point.beta);
                for (light, base) in light[image.source].iter_mut().zip(&seen.via_pixel) {
                    light.iter_mut().for_each(|light| *light += point.weight * base);
                }
            }
        }
        Ok(light.into_iter().map(|light| light.into_iter().map(relative_to_first).collect()).collect())
    }

    /// Computes what does not depend on phases on the rings of a wave, for the sources with light.
    fn fall(&self, set: &Set, wave: &Wave, (seen, needed): (&[Seen<'_>], Needed)) -> Fallen {
        let between = self.between(set);
        let still = Wave { per_mm: 0.0, turn: 0.0, rings: Rc::clone(&wave.rings) };
        let falling = |source: usize| {
            let start = self.sources[source].start();
            let is_lit = seen.iter().any(|seen| seen.source == source);
            is_lit.then(|| between.leaving((&still, start), &set.lit[source], needed))
        };
        let falling: Vec<Option<Leaving>> = (0..self.sources.len()).map(falling).collect();
        let reflectance = self.on_rings(wave);
        let (mut again, mut further) = (Vec::new(), Vec::new());
        if let Some(returned) = &set.returned {
            again = self.fallen((set, returned), &still, &falling, &reflectance);
            further = self.fallen_further((set, returned), &still, &again, &reflectance);
        }
        Fallen { rings: Rc::clone(&wave.rings), falling, again, further, reflectance }
    }

    /// Light of each source that meets the pixel once, given the values of light that leaves it and of light
    /// that falls on it; `[source][state * wavelength]`.
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

    /// The same of one source, state and wavelength.
    pub(super) fn met_once(
        &self,
        (set, wave): (&Set, &Wave),
        (source, leaving, falling): (usize, &Leaving, &Leaving),
        reflectance: &[f64],
        at: usize,
    ) -> Complex64 {
        let numbers = reflectance.len() / wave.rings.len();
        let of_ring = |ring: usize| {
            reflectance[ring * numbers + at] * self.overlap(set, wave, ring, (source, leaving, falling))
        };
        (0..wave.rings.len()).map(of_ring).sum()
    }

    /// Reflectance of each state and wavelength on the rings; `[ring][state * wavelength]`.
    pub(super) fn on_rings(&self, wave: &Wave) -> Vec<f64> {
        let numbers = self.stack.base().states() * self.stack.base().bins();
        let mut all = vec![0.0; wave.rings.len() * numbers];
        for (ring, out) in wave.rings.iter().zip(all.chunks_exact_mut(numbers)) {
            self.reflectances(ring.beta * ring.beta, out);
        }
        all
    }

    pub(super) fn reflectances(&self, beta_squared: f64, out: &mut [f64]) {
        if let Some(layer) = self.stack.layers.last() {
            self.stack.base().reflectance(beta_squared, &layer.medium, out);
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
        let rings = &wave.rings;
        let unit = self.sources[source].unit();
        let [from, onto] = [leaving, falling].map(|one| one.rings.ring(ring));
        let highest = (from.len() / 2).min(onto.len() / 2);
        if rings[ring].weight > 0.0 {
            let all = match &self.sources[source] {
                _ if from.is_empty() || onto.is_empty() => Complex64::ZERO,
                Room::Everywhere => leaving.rings.mean(ring) * falling.rings.mean(ring),
                Room::Beams(_) => {
                    // Azimuths of the light that leaves are relative to that of the frequency.
                    let pairs = up_to(from, highest).iter().zip(up_to(onto, highest).iter().rev());
                    series(pairs.map(|(from, onto)| from * onto), highest, -wave.turn)
                }
            };
            return unit * rings[ring].weight * all;
        }
        let value = |orders: &[Complex64], turn: f64| series(orders.iter().copied(), orders.len() / 2, turn);
        let extra = ring + set.kernels.extras() - rings.len();
        let mut sum = Complex64::ZERO;
        for (beam, straight) in self.view.iter().zip(&leaving.beams).filter(|(beam, _)| beam.extra == extra) {
            sum += straight * value(onto, beam.turn);
        }
        if let Room::Beams(beams) = &self.sources[source] {
            for (beam, straight) in beams.iter().zip(&falling.beams).filter(|(beam, _)| beam.extra == extra) {
                let seen =
                    if beam.is_ring { leaving.rings.mean(ring) } else { value(from, beam.turn - wave.turn) };
                sum += straight * seen;
            }
        }
        unit * sum
    }

    /// The same below flat layers: each direction of the view has ghosts at places of its own.
    pub(super) fn ghosts(&self, set: &Set, waves: &[Wave], members: &[f64]) -> Vec<Vec<Vec<Complex64>>> {
        let mut sums: Vec<Vec<Complex64>> = Vec::new();
        for direction in &self.directions {
            let light = self.ghosts_along(*direction, set, waves, members);
            if sums.is_empty() {
                sums = light;
                continue;
            }
            let pairs = sums.iter_mut().flatten().zip(light.into_iter().flatten());
            pairs.for_each(|(sum, light)| *sum += light);
        }
        vec![sums]
    }

    /// The same along a direction of the view, times its weight.
    fn ghosts_along(
        &self,
        [beta, turn, weight]: [f64; 3],
        set: &Set,
        waves: &[Wave],
        members: &[f64],
    ) -> Vec<Vec<Complex64>> {
        let (states, bins) = (self.stack.base().states(), self.stack.base().bins());
        let mut reflectance = vec![0.0; states * bins];
        if let Some(layer) = self.stack.layers.last() {
            self.stack.base().reflectance(beta * beta, &layer.medium, &mut reflectance);
        }
        let chain = Chain::new(self.stack, set.bin, beta);
        let onto_pixel = self.between(set).onto_pixel();
        let links = |wave: &Wave| {
            let along = wave.per_mm * (turn - wave.turn).cos();
            let mut links = [Complex64::ZERO; 2];
            let to = [skeleton::Ray::LEAVING, onto_pixel];
            chain.links([&[onto_pixel.reversed()], &to], along, &mut Cavities::default(), &mut links);
            let [leaves, returns] = links;
            (leaves * Complex64::cis(along * chain.moves_mm()), returns)
        };
        let (leaves, returned): (Vec<_>, Vec<_>) = waves.iter().map(links).unzip();
        let seen: Vec<Complex64> = relative_to_first(leaves).iter().map(|seen| weight * seen).collect();
        all_orders(&seen, &returned, &reflectance, members)
    }

    /// The same over a Lambertian pixel, for all sources.
    pub(super) fn lambertian(
        &self,
        set: &Set,
        waves: &[Wave],
        reflectance: &[f64],
        members: &[f64],
    ) -> Result<Vec<Vec<Vec<Complex64>>>, NotCovered> {
        let (mut totals, mut returned) = (Vec::new(), Vec::new());
        let between = self.between(set);
        for (k, wave) in waves.iter().enumerate() {
            // Light that returns is the same at all azimuths of the frequency.
            let known = waves[..k].iter().position(|other| other.per_mm == wave.per_mm);
            let found = self.paper_at((set, &between), wave, known.is_none())?;
            totals.push(found.seen);
            returned.push(known.map_or(found.returned, |known| returned[known]));
        }
        if let Some(inside) = &self.inside {
            for ((total, returned), wave) in totals.iter_mut().zip(&mut returned).zip(waves) {
                let frequency_per_mm = wave.per_mm / TAU;
                *total *= inside.of_state(frequency_per_mm);
                *returned *= inside.at(frequency_per_mm);
            }
        }
        Ok(vec![all_orders(&relative_to_first(totals), &returned, reflectance, members)])
    }

    /// What a view sees of a Lambertian pixel at a wave, in any unit, and what returns to it, if that is
    /// wanted.
    fn paper_at(
        &self,
        (set, between): (&Set, &Between<'_>),
        wave: &Wave,
        with_return: bool,
    ) -> Result<PaperLight, NotCovered> {
        let starts = [Start::Beams(&self.view), Start::Pixel];
        let starts = &starts[..if with_return { 2 } else { 1 }];
        let solved = between.solve(wave, starts)?;
        let mut sums = starts.iter().zip(&solved).map(|(start, light)| {
            let leaving = between.leaving((wave, *start), light, Needed::Mean);
            let straight = leaving.beams.iter().sum::<Complex64>();
            [set.mean(wave, &leaving) + straight, straight]
        });
        let [seen, straight] = sums.next().unwrap_or_default();
        let area = PI * set.index * set.index;
        Ok(PaperLight {
            seen,
            straight,
            returned: sums.next().map_or(Complex64::ZERO, |[sum, _]| sum / area),
        })
    }

    /// Returns what the view sees of a Lambertian pixel of the wavelengths of a set at a frequency along some
    /// azimuths (radians), and what of its light returns to it there, if that is wanted; in any unit.
    ///
    /// # Errors
    /// Those of [`light`](Self::light).
    pub fn paper(
        &self,
        set: usize,
        frequency_per_mm: f64,
        azimuths: &[f64],
        with_return: bool,
    ) -> Result<Vec<PaperLight>, NotCovered> {
        let set = &self.sets[set];
        let between = self.between(set);
        let first = self.wave(set, [frequency_per_mm, 0.0]);
        let at = |(k, turn): (usize, &f64)| {
            let wave = Wave { per_mm: first.per_mm, turn: *turn, rings: Rc::clone(&first.rings) };
            self.paper_at((set, &between), &wave, with_return && k == 0)
        };
        azimuths.iter().enumerate().map(at).collect()
    }

    /// Returns the unscattered part of what the view sees of a Lambertian pixel of the wavelengths of a set,
    /// in the unit of [`paper`](Self::paper).
    pub fn straight(&self, set: usize, frequencies_per_mm: &[[f64; 2]]) -> Vec<Complex64> {
        let set = &self.sets[set];
        let still = self.wave(set, [0.0; 2]);
        let between = self.between(set);
        let at = |[x, y]: &[f64; 2]| {
            let wave = Wave { per_mm: TAU * x.hypot(*y), turn: y.atan2(*x), rings: Rc::clone(&still.rings) };
            between.straight(&wave, &self.view)
        };
        frequencies_per_mm.iter().map(at).collect()
    }

    /// Number of sets of wavelengths that are computed, and by wavelength those that represent it, with their
    /// factors.
    pub fn sets(&self) -> (usize, &[Vec<(usize, f64)>]) {
        (self.sets.len(), &self.of_bins)
    }
}

/// Light of a Lambertian pixel at a frequency, in any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PaperLight {
    /// What the view sees.
    pub seen: Complex64,
    /// The part of it that no layer scattered.
    pub straight: Complex64,
    /// Fraction that returns to the pixel; 0 but along the first azimuth.
    pub returned: Complex64,
}

/// Returns a Fourier series, from the most negative order on, at an azimuth.
fn series(orders: impl Iterator<Item = Complex64>, highest: usize, turn: f64) -> Complex64 {
    let step = Complex64::cis(turn);
    let begin = Complex64::cis(-(highest as f64) * turn);
    let terms = orders.scan(begin, |phase, x| {
        let term = x * *phase;
        *phase *= step;
        Some(term)
    });
    terms.sum()
}

/// Returns all values but the first, relative to it.
fn relative_to_first(values: Vec<Complex64>) -> Vec<Complex64> {
    let zero = values[0].re;
    let relative = |value: &Complex64| if zero > 0.0 { value / zero } else { Complex64::ZERO };
    values[1..].iter().map(relative).collect()
}

/// Returns `seen/(1 - rho A)` for the reflectances of the members, given A at the first, zero, frequency and
/// at all others.
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

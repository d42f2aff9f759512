//! Light that returns to a mirror-like pixel below scatterers.
//!
//! Of light that meets the pixel twice, `V(f) rho A(f) rho S` has the places of the first meeting and `V(f) rho A rho S` those of
//! the second one. The reflectances of all states and wavelengths are sums of a few of them, for which A is applied. Light that meets the
//! pixel more often follows by the ratio of two meetings to one, as of geometric series: exactly where light that returns has the
//! directions of light that arrives first. Levels sum these series in two ways by turns, so that their difference contains the error.

use num_complex::Complex64;

use super::crossing::Needed;
use super::kernels::Light;
use super::orders::OnRings;
use super::pixels::Fallen;
use super::waves::{Beam, Leaving, Start, Wave};
use super::{LayeredSpread, NotCovered, Room, Set};

/// Most reflectances of which all others are sums, and the rest of the others relative to the largest.
const MOST_REFLECTANCES: usize = 6;
const REST: f64 = 0.01;

/// Light that meets the pixel three times over that of a geometric series, at every other level. A series of another ratio departs from
/// the geometric one by a part of q^2; the levels state 0.3 q^2 as its error.
const THIRD: f64 = 0.7;

/// Directions at which reflectances are compared.
const DIRECTIONS: usize = 24;

/// What is prepared of light that returns.
#[derive(Debug)]
pub(super) struct Returned {
    /// State and wavelength of some reflectances, and the factors of each reflectance in them.
    some: Vec<usize>,
    factors: Vec<Vec<f64>>,
    /// Values of light that arrives at the scatterers after it has met each of them, for each source.
    lit: Vec<Vec<Light>>,
}

/// Light of a source by state and wavelength.
type Lit = Vec<Complex64>;

impl LayeredSpread<'_> {
    /// Prepares light that returns, without phases.
    pub(super) fn returned(&self, set: &Set, wave: &Wave) -> Result<Returned, NotCovered> {
        let (some, factors) = self.some_reflectances(set.index);
        let reflectance = self.on_rings(wave);
        let between = set.between(self.stack);
        let of_source = |(room, lit): (&Room, &Light)| {
            let start = room.start();
            let falling = between.leaving((wave, start), lit, Needed::All);
            let again = |at: &usize| {
                let (rings, beams) = set.onto_pixel(wave, (&falling, room.beams()), &reflectance, *at);
                Ok(between.solve(wave, &[Start::Onto(&rings, &beams)])?.remove(0))
            };
            some.iter().map(again).collect()
        };
        let lit = self.sources.iter().zip(&set.lit).map(of_source).collect::<Result<_, _>>()?;
        Ok(Returned { some, factors, lit })
    }

    /// Values of light that has met the pixel with each of the reflectances and falls on it again, without phases;
    /// `[reflectance][source]`.
    pub(super) fn fallen(
        &self,
        (set, returned): (&Set, &Returned),
        still: &Wave,
        falling: &[Option<Leaving>],
        reflectance: &[f64],
    ) -> Vec<Vec<Option<Leaving>>> {
        let between = set.between(self.stack);
        let of_source = |k: usize, source: usize| {
            let beams = self.sources[source].beams();
            let falling = falling[source].as_ref()?;
            let (rings, beams) = set.onto_pixel(still, (falling, beams), reflectance, returned.some[k]);
            let start = Start::Onto(&rings, &beams);
            Some(between.leaving((still, start), &returned.lit[source][k], Needed::All))
        };
        let of_reflectance = |k: usize| (0..falling.len()).map(|source| of_source(k, source)).collect();
        (0..returned.some.len()).map(of_reflectance).collect()
    }

    /// Light of each source that meets the pixel twice: with the places of the first and of the second meeting.
    pub(super) fn twice(
        &self,
        (set, returned): (&Set, &Returned),
        (wave, leaving): (&Wave, &Leaving),
        Fallen { falling, again: fallen, reflectance, .. }: &Fallen,
    ) -> Result<[Vec<Lit>; 2], NotCovered> {
        let between = set.between(self.stack);
        let numbers = returned.factors.len();
        let mut sums = [0, 1].map(|_| vec![vec![Complex64::ZERO; numbers]; self.sources.len()]);
        for (k, at) in returned.some.iter().enumerate() {
            let (rings, beams) = set.onto_pixel(wave, (leaving, &self.view), reflectance, *at);
            let start = Start::Onto(&rings, &beams);
            let solved = between.solve(wave, &[start])?;
            let again = between.leaving((wave, start), &solved[0], Needed::All);
            let first = self.met(set, wave, (&again, falling), reflectance);
            let second = self.met(set, wave, (leaving, &fallen[k]), reflectance);
            for (sums, found) in sums.iter_mut().zip([first, second]) {
                for (sums, found) in sums.iter_mut().zip(found) {
                    for ((sum, found), factors) in sums.iter_mut().zip(found).zip(&returned.factors) {
                        *sum += factors[k] * found;
                    }
                }
            }
        }
        Ok(sums)
    }

    /// Light of all orders over that of one meeting, given the ratios of two meetings to one.
    pub(super) fn series(&self, [first, second]: [Complex64; 2]) -> Complex64 {
        let one = |q: Complex64| match self.level.is_multiple_of(2) {
            true => 1.0 + q + THIRD * q * q,
            false => 1.0 / (1.0 - q),
        };
        one(first) * one(second)
    }

    /// Returns reflectances of which all others are sums, nearly, and their factors.
    fn some_reflectances(&self, index: f64) -> (Vec<usize>, Vec<Vec<f64>>) {
        let numbers = self.stack.base.states() * self.stack.base.bins();
        let mut rows = vec![vec![0.0; DIRECTIONS]; numbers];
        let mut all = vec![0.0; numbers];
        for k in 0..DIRECTIONS {
            let cosine = (k as f64 + 0.5) / DIRECTIONS as f64;
            self.reflectances(index * index * (1.0 - cosine * cosine), &mut all);
            rows.iter_mut().zip(&all).for_each(|(row, value)| row[k] = *value);
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let largest = rows.iter().map(|row| dot(row, row)).fold(0.0, f64::max);
        let mut some: Vec<usize> = Vec::new();
        // What is left of each, and what has been taken from it: factors in those chosen.
        let mut factors: Vec<Vec<f64>> = vec![Vec::new(); numbers];
        while some.len() < MOST_REFLECTANCES {
            let size = |at: &usize| dot(&rows[*at], &rows[*at]);
            let Some(next) = (0..numbers).max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
            if size(&next) <= REST * REST * largest || largest == 0.0 {
                break;
            }
            let (row, of_row) = (rows[next].clone(), factors[next].clone());
            let length = dot(&row, &row);
            for (other, of_other) in rows.iter_mut().zip(&mut factors) {
                let part = dot(other, &row) / length;
                other.iter_mut().zip(&row).for_each(|(other, x)| *other -= part * x);
                // The rest of the chosen one is itself less its factors in those before.
                of_other.iter_mut().zip(&of_row).for_each(|(other, x)| *other -= part * x);
                of_other.push(part);
            }
            some.push(next);
        }
        (some, factors)
    }
}

impl Set {
    /// Values of light that arrives at the pixel with one reflectance, given those of light that leaves it.
    fn onto_pixel(
        &self,
        wave: &Wave,
        (leaving, beams): (&Leaving, &[Beam]),
        reflectance: &[f64],
        at: usize,
    ) -> (OnRings, Vec<(Beam, Complex64)>) {
        let rings = wave.rings.len();
        let numbers = reflectance.len() / rings;
        let of_beam = |(beam, value): (&Beam, &Complex64)| {
            let ring = rings - self.kernels.extras() + beam.extra;
            (*beam, reflectance[ring * numbers + at] * value)
        };
        let beams = beams.iter().zip(&leaving.beams).map(of_beam).collect();
        (leaving.rings.clone().scaled(|ring| reflectance[ring * numbers + at]), beams)
    }
}

//! Light that returns to a mirror-like pixel below scatterers.
//!
//! Of light that meets the pixel twice, `V(f) rho A(f) rho S` has the places of the first meeting and
//! `V(f) rho A rho S` those of the second one. The reflectances of all states and wavelengths are sums of a
//! few of them, for which A is applied: two meetings are known for all.
//!
//! Light that meets the pixel more often does not follow from these: what a rough face reflects totally stays
//! in the glass. It is followed meeting by meeting for one of the reflectances (`V_i rho S_j` for all i and
//! j: the places are those of meeting i + 1 from the view). Others have it in proportion to the power of
//! their own light of two meetings. This is exact for reflectances that are multiples of one another; levels
//! take two different ones by turns, so that their difference contains the error.

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

/// Most meetings that are followed, and the light of the last one relative to that of the first.
const MOST_MEETINGS: usize = 100;
const LAST_MEETING: f64 = 1e-4;

/// Mean of another reflectance that is followed, relative to that of the largest.
const BRIGHT: f64 = 0.8;

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
    /// One of the reflectances, by its number, for which light is followed further.
    followed: usize,
    /// The same after it has met that one more often; `[source][meeting]`.
    further: Vec<Vec<Light>>,
}

/// Light of each source that meets the pixel more than once.
pub(super) struct Meetings {
    /// Twice, with the places of the first and of the second meeting.
    pub(super) twice: [Vec<Lit>; 2],
    /// For the reflectance that is followed, relative to light that meets the pixel once;
    /// `[source][view meetings][light meetings]`.
    pub(super) followed: Vec<Vec<Vec<Complex64>>>,
}

/// Light of a source by state and wavelength.
type Lit = Vec<Complex64>;

impl LayeredSpread<'_> {
    /// Prepares light that returns, without phases.
    pub(super) fn returned(&self, set: &Set, wave: &Wave) -> Result<Returned, NotCovered> {
        let (some, factors) = self.some_reflectances(set.index);
        let reflectance = self.on_rings(wave);
        let between = self.between(set);
        let of_source = |(room, lit): (&Room, &Light)| {
            let start = room.start();
            let falling = between.leaving((wave, start), lit, Needed::All);
            let again = |at: &usize| {
                let (rings, beams) = set.onto_pixel(wave, (&falling, room.beams()), &reflectance, *at);
                Ok(between.solve(wave, &[Start::Onto(&rings, &beams)])?.remove(0))
            };
            some.iter().map(again).collect()
        };
        let lit: Vec<Vec<Light>> =
            self.sources.iter().zip(&set.lit).map(of_source).collect::<Result<_, _>>()?;
        let followed = if self.level.is_multiple_of(2) { 0 } else { self.another_bright(&some, set.index) };
        let mut further = vec![Vec::new(); lit.len()];
        for (source, room) in self.sources.iter().enumerate().filter(|_| !some.is_empty()) {
            let onto = |falling: &Leaving| {
                set.onto_pixel(wave, (falling, room.beams()), &reflectance, some[followed])
            };
            let mut falling = between.leaving((wave, room.start()), &set.lit[source], Needed::All);
            let mut last = lit[source][followed].clone();
            let first = largest(&last);
            while largest(&last) > LAST_MEETING * LAST_MEETING * first {
                if further[source].len() == MOST_MEETINGS {
                    return Err(NotCovered::Meetings);
                }
                let (rings, beams) = onto(&falling);
                falling = between.leaving((wave, Start::Onto(&rings, &beams)), &last, Needed::All);
                let (rings, beams) = onto(&falling);
                last = between.solve(wave, &[Start::Onto(&rings, &beams)])?.remove(0);
                further[source].push(last.clone());
            }
        }
        Ok(Returned { some, factors, lit, followed, further })
    }

    /// Values of light that has met the pixel with each of the reflectances and falls on it again, without
    /// phases; `[reflectance][source]`.
    pub(super) fn fallen(
        &self,
        (set, returned): (&Set, &Returned),
        still: &Wave,
        falling: &[Option<Leaving>],
        reflectance: &[f64],
    ) -> Vec<Vec<Option<Leaving>>> {
        let between = self.between(set);
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

    /// The same after further meetings with one reflectance; `[source][meeting]`.
    pub(super) fn fallen_further(
        &self,
        (set, returned): (&Set, &Returned),
        still: &Wave,
        again: &[Vec<Option<Leaving>>],
        reflectance: &[f64],
    ) -> Vec<Vec<Leaving>> {
        let between = self.between(set);
        let of_source = |(source, room): (usize, &Room)| {
            let mut all: Vec<Leaving> = Vec::new();
            let Some(first) = again.get(returned.followed).and_then(|again| again[source].as_ref()) else {
                return all;
            };
            for light in &returned.further[source] {
                let (last, at) = (all.last().unwrap_or(first), returned.some[returned.followed]);
                let (rings, beams) = set.onto_pixel(still, (last, room.beams()), reflectance, at);
                all.push(between.leaving((still, Start::Onto(&rings, &beams)), light, Needed::All));
            }
            all
        };
        self.sources.iter().enumerate().map(of_source).collect()
    }

    /// Light of each source that meets the pixel more than once.
    pub(super) fn meetings(
        &self,
        (set, returned): (&Set, &Returned),
        (wave, leaving): (&Wave, &Leaving),
        fallen: &Fallen,
    ) -> Result<Meetings, NotCovered> {
        let Fallen { falling, again: fallen_again, further, reflectance, .. } = fallen;
        let between = self.between(set);
        let numbers = returned.factors.len();
        let next = |leaving: &Leaving, at: usize| {
            let (rings, beams) = set.onto_pixel(wave, (leaving, &self.view), reflectance, at);
            let start = Start::Onto(&rings, &beams);
            let solved = between.solve(wave, &[start])?;
            Ok(between.leaving((wave, start), &solved[0], Needed::All))
        };
        let mut twice = [0, 1].map(|_| vec![vec![Complex64::ZERO; numbers]; self.sources.len()]);
        let mut followed = vec![Vec::new(); self.sources.len()];
        for (k, at) in returned.some.iter().enumerate() {
            let again = next(leaving, *at)?;
            let first = self.met(set, wave, (&again, falling), reflectance);
            let second = self.met(set, wave, (leaving, &fallen_again[k]), reflectance);
            for (sums, found) in twice.iter_mut().zip([first, second]) {
                for (sums, found) in sums.iter_mut().zip(found) {
                    for ((sum, found), factors) in sums.iter_mut().zip(found).zip(&returned.factors) {
                        *sum += factors[k] * found;
                    }
                }
            }
            if k != returned.followed {
                continue;
            }
            let mut from = vec![again];
            let mut size = [0.0_f64; 2];
            for meeting in 0.. {
                if meeting > MOST_MEETINGS {
                    return Err(NotCovered::Meetings);
                }
                let last = if meeting == 0 { leaving } else { &from[meeting - 1] };
                size[1] = 0.0;
                for (source, followed) in followed.iter_mut().enumerate() {
                    let Some(once) = &falling[source] else { continue };
                    let onto = fallen_again[k][source].iter().chain(&further[source]);
                    let of_pair = |onto| self.met_once((set, wave), (source, last, onto), reflectance, *at);
                    let row: Vec<Complex64> = std::iter::once(once).chain(onto).map(of_pair).collect();
                    size[1] = size[1].max(row[0].norm());
                    followed.push(row);
                }
                size[0] = size[0].max(size[1]);
                if size[1] <= LAST_MEETING * size[0] {
                    break;
                }
                if meeting > 0 {
                    from.push(next(&from[meeting - 1], *at)?);
                }
            }
        }
        Ok(Meetings { twice, followed })
    }

    /// Returns the number of another reflectance that is nearly as large as the first one, or that of the
    /// first one, 0.
    fn another_bright(&self, some: &[usize], index: f64) -> usize {
        let mut means = vec![0.0; some.len()];
        let mut all = vec![0.0; self.stack.base().states() * self.stack.base().bins()];
        for k in 0..DIRECTIONS {
            let cosine = (k as f64 + 0.5) / DIRECTIONS as f64;
            self.reflectances(index * index * (1.0 - cosine * cosine), &mut all);
            means.iter_mut().zip(some).for_each(|(mean, at)| *mean += all[*at]);
        }
        (1..some.len()).find(|k| means[*k] > BRIGHT * means[0]).unwrap_or(0)
    }

    /// Returns reflectances of which all others are sums, nearly, and their factors.
    fn some_reflectances(&self, index: f64) -> (Vec<usize>, Vec<Vec<f64>>) {
        let numbers = self.stack.base().states() * self.stack.base().bins();
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

impl Meetings {
    /// Light of all orders of a source, state and wavelength over that of one meeting, which is `once`;
    /// `still` without regard to places. `power` is its light of two meetings over that of the reflectance
    /// that is followed, without regard to places.
    pub(super) fn series(
        &self,
        (source, at): (usize, usize),
        once: Complex64,
        power: f64,
        still: bool,
    ) -> Complex64 {
        let [first, second] = [0, 1].map(|k| self.twice[k][source][at] / once);
        let mut sum = 1.0 + second + if still { Complex64::ZERO } else { first };
        let rows = &self.followed[source];
        let scale = rows.first().map_or(Complex64::ZERO, |row| row[0]);
        if scale == Complex64::ZERO {
            return sum;
        }
        for (i, row) in rows.iter().enumerate().take(if still { 1 } else { usize::MAX }) {
            for (j, value) in row.iter().enumerate().filter(|(j, _)| i + j > 1) {
                sum += value / scale * power.powi((i + j) as i32);
            }
        }
        sum
    }

    /// Light of two meetings over that of one, for the reflectance that is followed.
    pub(super) fn followed_twice(&self, source: usize) -> f64 {
        let row = self.followed[source].first();
        row.and_then(|row| Some(row.get(1)?.re / row[0].re)).unwrap_or(0.0)
    }
}

/// Returns the square of the largest value of light.
fn largest(light: &Light) -> f64 {
    light.iter().flatten().map(super::orders::Orders::largest).fold(0.0, f64::max)
}

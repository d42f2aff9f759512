//! What a view sees of Lambertian pixels below general layers, and what these return to them, tabulated over
//! the frequency.
//!
//! **What.** [`LayeredSpread::paper`] has the transform V of what is seen and the return A of the layers at
//! one frequency. Both are smooth: Chebyshev polynomials on panels that widen with the frequency, up to where
//! both have decreased. A panel has five or nine frequencies; where these are not enough, it is halved. V has
//! three parts: a sharp image, which does not depend on the frequency; light that
//! layers scatter; and side images, which flat faces above each other add in an oblique view. Side images do
//! not decrease: they are resolved up to a frequency of [`SIDE`] over the height of the layers. Beyond the
//! tables scattered light decreases exponentially, as at their end.
//!
//! Along other azimuths V is a Fourier series through those of the table; A is the same along all.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;

use super::LambertianReturn;
use super::face::{POINTS_OF_TABLE, chebyshev_of, chebyshev_points};
use super::panel_spread::Tabulated;
use crate::adding::{LayeredSpread, NotCovered, PaperLight};

/// Ends of the first panels, times the height of the layers. Each further one ends so much farther.
const FIRST: [f64; 4] = [1.0, 2.5, 4.0, 6.0];
const FARTHER: f64 = 1.5;

/// Numbers of steps between the frequencies of a panel: it has one more.
const STEPS: [usize; 2] = [4, 8];

/// Last two coefficients of a panel as a fraction of the light that counts no more, with few and with many
/// frequencies, and the width below which it is not halved, times the height.
const REST: [f64; 2] = [0.01, 0.1];
const NARROWEST: f64 = 0.05;

/// Light that counts no more, as a fraction, at level 0, and how much less each further level neglects.
const FAINTEST: f64 = 5e-3;
const FAINTER: f64 = 0.2;

/// Scattered light that a table may leave, as a fraction, if it decreases exponentially.
const TAIL: f64 = 0.3;

/// Frequency at which all tables end at level 0, times the height, and how much farther those of each further
/// level reach: the time of a frequency increases with its square.
const HIGHEST: f64 = 20.0;

/// Highest frequency of scattered light at which a table may end, times the height.
const LEAST: f64 = 4.0;

/// Light that returns no more, as a fraction of the light that counts no more, and the frequency from which
/// on it is not computed any more, times the height.
const RETURNED: f64 = 0.1;
const LEAST_OF_RETURN: f64 = 1.0;

/// Highest frequency of side images, times the height, the width of the panels of their table, and the number
/// of frequencies over which they are averaged.
const SIDE: f64 = 32.0;
const WIDTH_OF_SIDE: f64 = 1.0;
const SAMPLES: usize = 1024;

/// Hardly any light, as a fraction.
const LEFT: f64 = 1e-3;

/// Logarithm of light that is none.
const NOTHING: f64 = -40.0;

/// Azimuths of an oblique view on half a circle; a view along the normal has one.
const AZIMUTHS: usize = 4;

/// Lambertian pixels below general layers, for one view.
#[derive(Debug, Clone)]
pub struct LayeredPaper {
    sets: Vec<Set>,
    groups: Vec<Group>,
    /// Directions of the tables, along half a circle.
    directions: Vec<[f64; 2]>,
    end_per_mm: f64,
}

/// Wavelengths that have the same light.
#[derive(Debug, Clone)]
struct Group {
    bins: Vec<usize>,
    /// The sets that represent them, with factors.
    sets: Vec<(usize, f64)>,
}

/// Wavelengths at which the layers are the same.
#[derive(Debug, Clone)]
struct Set {
    /// Sharp image: part of what is seen without regard to places.
    sharp: f64,
    /// Real and imaginary part of scattered light along each azimuth.
    scattered: Vec<[Tabulated; 2]>,
    /// The same of side images.
    side: Vec<[Tabulated; 2]>,
    /// How scattered light changes beyond the table along each azimuth: its logarithm in each cycle per mm.
    decays_mm: Vec<Complex64>,
    side_end_per_mm: f64,
    returned: Arc<[Tabulated]>,
}

impl LayeredPaper {
    /// Tabulates the light of a view. `is_round`: the view is along the normal. `height_mm`: all layers
    /// together.
    ///
    /// # Errors
    /// If scatterers return too much light to each other, or the computation was stopped.
    pub fn new(
        spread: &LayeredSpread<'_>,
        is_round: bool,
        height_mm: f64,
        level: u32,
    ) -> Result<Self, NotCovered> {
        let (count, of_bins) = spread.sets();
        let azimuths = if is_round { 1 } else { AZIMUTHS };
        let mut groups: Vec<Group> = Vec::new();
        for (bin, sets) in of_bins.iter().enumerate() {
            match groups.iter_mut().find(|group| group.sets == *sets) {
                Some(group) => group.bins.push(bin),
                None => groups.push(Group { bins: vec![bin], sets: sets.clone() }),
            }
        }
        let sets: Vec<Set> = (0..count)
            .map(|set| Set::new(spread, set, &turns(azimuths), (height_mm, level)))
            .collect::<Result<_, _>>()?;
        let end = |set: &Set| set.returned.iter().filter_map(Tabulated::end).fold(0.0, f64::max);
        let end_per_mm = sets.iter().map(end).fold(0.0, f64::max);
        let directions = turns(azimuths).into_iter().map(|turn| [turn.cos(), turn.sin()]).collect();
        Ok(Self { sets, groups, directions, end_per_mm })
    }

    /// What returns to the pixels, by group of wavelengths.
    pub fn returns(&self) -> Vec<LambertianReturn> {
        let of_group = |group: &Group| {
            let tables =
                group.sets.iter().map(|(set, factor)| (*factor, Arc::clone(&self.sets[*set].returned)));
            LambertianReturn::of_tables(group.bins.clone(), tables.collect())
        };
        self.groups.iter().map(of_group).collect()
    }

    /// Frequency above which nothing returns to the pixels, cycles per mm.
    pub fn end_per_mm(&self) -> f64 {
        self.end_per_mm
    }

    /// Number of groups of wavelengths.
    pub fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Numbers of the wavelengths of a group.
    pub fn bins(&self, group: usize) -> &[usize] {
        &self.groups[group].bins
    }

    /// Sharp image of a group of wavelengths, as a fraction of what is seen without regard to places.
    pub fn sharp(&self, group: usize) -> f64 {
        self.groups[group].sets.iter().map(|(set, factor)| factor * self.sets[*set].sharp).sum()
    }

    /// Frequency above which hardly any other light is left, cycles per mm.
    pub fn reach_per_mm(&self) -> f64 {
        self.sets.iter().map(Set::reach_per_mm).fold(0.0, f64::max)
    }

    /// All other light at a frequency along x and y, cycles per mm.
    pub fn others(&self, group: usize, [x, y]: [f64; 2]) -> Complex64 {
        let frequency_per_mm = x.hypot(y);
        let azimuths = self.directions.len();
        if azimuths == 1 || y == 0.0 && x >= 0.0 {
            return self.of_azimuth(group, frequency_per_mm, 0);
        }
        if x == 0.0 && y > 0.0 {
            return self.of_azimuth(group, frequency_per_mm, azimuths / 2);
        }
        let values: Vec<Complex64> =
            (0..azimuths).map(|k| self.of_azimuth(group, frequency_per_mm, k)).collect();
        if values.iter().all(|value| *value == Complex64::ZERO) {
            return Complex64::ZERO;
        }
        turned(&values, &self.directions, [x / frequency_per_mm, y / frequency_per_mm])
    }

    /// The same along one of the azimuths of the tables.
    fn of_azimuth(&self, group: usize, frequency_per_mm: f64, azimuth: usize) -> Complex64 {
        let of_set =
            |(set, factor): &(usize, f64)| factor * self.sets[*set].others(azimuth, frequency_per_mm);
        self.groups[group].sets.iter().map(of_set).sum()
    }

    /// Fraction of the light that the layers scatter, and the frequency at which half of it is left; `None`
    /// without such light.
    pub fn half_of_scattered_per_mm(&self) -> Option<f64> {
        let of_set = |set: &Set| {
            let [re, im] = set.scattered.first()?;
            let at = |f: f64| re.at(f).hypot(im.at(f));
            let zero = at(0.0);
            let end = re.end()?;
            let steps = 400;
            let place = |k: usize| end * (f64::from(k as u32) / f64::from(steps as u32)).powi(4);
            (zero > 1e-3).then(|| (0..=steps).map(place).find(|f| at(*f) < 0.5 * zero).unwrap_or(end))
        };
        self.sets.iter().filter_map(of_set).reduce(f64::max)
    }
}

/// Value along a direction from those at equal steps of the azimuth over half a circle: those of the other half
/// are conjugate. The Fourier series through all.
fn turned(values: &[Complex64], directions: &[[f64; 2]], [x, y]: [f64; 2]) -> Complex64 {
    let count = values.len();
    let weight = |cosine: f64| {
        // 1/2 + cos(angle) + cos(2 angle) ... + cos(count angle)/2, by its recurrence.
        let [mut last, mut here] = [1.0, cosine];
        let mut sum = 0.5;
        for _ in 1..count {
            sum += here;
            (last, here) = (here, 2.0 * cosine * here - last);
        }
        (sum + 0.5 * here) / count as f64
    };
    let one = |(value, [cos, sin]): (&Complex64, &[f64; 2])| {
        let cosine = x * cos + y * sin;
        weight(cosine) * value + weight(-cosine) * value.conj()
    };
    values.iter().zip(directions).map(one).sum()
}

fn turns(count: usize) -> Vec<f64> {
    (0..count).map(|k| PI * k as f64 / count as f64).collect()
}

impl Set {
    fn new(
        spread: &LayeredSpread<'_>,
        set: usize,
        turns: &[f64],
        (height_mm, level): (f64, u32),
    ) -> Result<Self, NotCovered> {
        let (faintest, highest) =
            (FAINTEST * FAINTER.powi(level as i32), HIGHEST * FARTHER.powi(level as i32));
        let mut samples = Samples::new((spread, set), turns)?;
        let scale = samples.scale;
        let side_end_per_mm = SIDE / height_mm;
        let straight = |turn: f64, frequencies: &[f64]| -> Vec<Complex64> {
            let at: Vec<[f64; 2]> = frequencies.iter().map(|f| [f * turn.cos(), f * turn.sin()]).collect();
            spread.straight(set, &at).iter().map(|value| scale * value).collect()
        };
        // The mean over frequencies is the light that has no phase.
        let parts: Vec<f64> = (0..SAMPLES).map(|k| (k as f64 + 0.5) / SAMPLES as f64).collect();
        let places: Vec<f64> = parts.iter().map(|part| part * side_end_per_mm).collect();
        let all: f64 = parts.iter().map(|part| window(*part)).sum();
        let mean = |turn: &f64| -> f64 {
            let light = straight(*turn, &places);
            light.iter().zip(&parts).map(|(light, part)| window(*part) * light.re / all).sum()
        };
        let sharp = turns.iter().map(mean).fold(f64::INFINITY, f64::min).max(0.0);
        let side = |turn: &f64| {
            let mut tables: [Tabulated; 2] = Default::default();
            for k in 0..(SIDE / WIDTH_OF_SIDE) as usize {
                let ends = [k, k + 1].map(|end| end as f64 * WIDTH_OF_SIDE / height_mm);
                let light = straight(*turn, &chebyshev_points(ends));
                for (number, table) in tables.iter_mut().enumerate() {
                    let part = |k: usize| if number == 0 { light[k].re - sharp } else { light[k].im };
                    table.panels.push((ends, chebyshev_of(&std::array::from_fn(part))));
                }
            }
            tables
        };
        let mut all = Self {
            sharp,
            scattered: vec![Default::default(); turns.len()],
            side: turns.iter().map(side).collect(),
            decays_mm: Vec::new(),
            side_end_per_mm,
            returned: Arc::new([]),
        };
        let mut returned = Tabulated::default();
        let (mut number, mut from) = (0, 0.0_f64);
        while from < highest {
            let to = FIRST.get(number).copied().unwrap_or(FARTHER * from);
            let ends = [from, to].map(|end| end / height_mm);
            let mut most = [0.0_f64; 2];
            for Panel { ends, coefficients, largest } in
                samples.panels(ends, NARROWEST / height_mm, faintest)?
            {
                let (parts, last) = coefficients.as_chunks::<2>();
                for ([re, im], [of_re, of_im]) in all.scattered.iter_mut().zip(parts) {
                    re.panels.push((ends, *of_re));
                    im.panels.push((ends, *of_im));
                }
                if samples.with_return {
                    returned.panels.extend(last.iter().map(|last| (ends, *last)));
                }
                most = [0, 1].map(|k| most[k].max(largest[k]));
            }
            (number, from) = (number + 1, to);
            let [most, most_returned] = most;
            // What returns no more is not computed any more.
            samples.with_return &= most_returned > RETURNED * faintest || from < LEAST_OF_RETURN;
            let tail: Vec<Tail> = all.scattered.iter().map(|table| Tail::new(table, ends)).collect();
            let missed = tail.iter().map(|tail| tail.missed).fold(0.0, f64::max);
            all.decays_mm = tail.into_iter().map(|tail| tail.decays_mm).collect();
            // Light that is left decreases as at the end of the table.
            let is_known = most < faintest || most < TAIL && missed < faintest;
            if is_known && most_returned < faintest && from >= LEAST {
                break;
            }
        }
        all.returned = Arc::new([returned]);
        Ok(all)
    }

    fn reach_per_mm(&self) -> f64 {
        let of_azimuth = |([re, im], decay_mm): (&[Tabulated; 2], &Complex64)| {
            let end = re.end().unwrap_or_default();
            let left = (re.at(end).hypot(im.at(end)) / LEFT).max(1.0).ln();
            if left > 0.0 { end + left / decay_mm.re.abs() } else { end }
        };
        let scattered = self.scattered.iter().zip(&self.decays_mm).map(of_azimuth);
        let has_side = self.side.iter().flatten().flat_map(|table| &table.panels);
        let has_side = has_side.flat_map(|(_, terms)| terms).any(|term| term.abs() > LEFT);
        scattered.fold(if has_side { self.side_end_per_mm } else { 0.0 }, f64::max)
    }

    fn others(&self, azimuth: usize, f: f64) -> Complex64 {
        let ([re, im], [side_re, side_im]) = (&self.scattered[azimuth], &self.side[azimuth]);
        let end = re.end().unwrap_or(f);
        let mut light = Complex64::ZERO;
        let exponent = self.decays_mm[azimuth] * (f - end).max(0.0);
        if exponent.re > NOTHING {
            light += exponent.exp() * Complex64::new(re.at(f.min(end)), im.at(f.min(end)));
        }
        let side = window(f / self.side_end_per_mm);
        if side > 0.0 {
            light += side * Complex64::new(side_re.at(f), side_im.at(f));
        }
        light
    }
}

/// Light at the frequencies of panels: real and imaginary part of scattered light along each azimuth, and
/// last what returns.
struct Samples<'s, 'a> {
    spread: &'s LayeredSpread<'a>,
    set: usize,
    turns: &'s [f64],
    /// 1 over what is seen without regard to places.
    scale: f64,
    with_return: bool,
    /// By the bits of the frequency: neighbouring panels share one.
    known: HashMap<u64, Vec<f64>>,
}

/// Chebyshev coefficients of all numbers of [`Samples`] between two frequencies, and the largest scattered
/// and returned light.
struct Panel {
    ends: [f64; 2],
    coefficients: Vec<[f64; POINTS_OF_TABLE]>,
    largest: [f64; 2],
}

impl<'s, 'a> Samples<'s, 'a> {
    fn new((spread, set): (&'s LayeredSpread<'a>, usize), turns: &'s [f64]) -> Result<Self, NotCovered> {
        let mut new = Self { spread, set, turns, scale: 1.0, with_return: true, known: HashMap::new() };
        let found = spread.paper(set, 0.0, turns, true)?;
        let total = found[0].seen.re;
        new.scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        new.known.insert(0.0_f64.to_bits(), new.numbers(&found));
        Ok(new)
    }

    fn numbers(&self, found: &[PaperLight]) -> Vec<f64> {
        let scattered = found.iter().map(|light| self.scale * (light.seen - light.straight));
        let returned = found.first().map(|light| light.returned.re);
        scattered.flat_map(|light| [light.re, light.im]).chain(returned).collect()
    }

    fn at(&mut self, f: f64) -> Result<Vec<f64>, NotCovered> {
        if let Some(known) = self.known.get(&f.to_bits()) {
            return Ok(known.clone());
        }
        let found = self.numbers(&self.spread.paper(self.set, f, self.turns, self.with_return)?);
        self.known.insert(f.to_bits(), found.clone());
        Ok(found)
    }

    /// Returns ascending panels between two frequencies, none narrower than half of `narrowest`.
    fn panels(&mut self, ends: [f64; 2], narrowest: f64, faintest: f64) -> Result<Vec<Panel>, NotCovered> {
        let (mut rest, mut found) = (vec![ends], Vec::new());
        while let Some([from, to]) = rest.pop() {
            let mut enough = None;
            for (steps, part) in STEPS.into_iter().zip(REST) {
                let panel = self.panel([from, to], steps)?;
                let left = |c: &[f64; POINTS_OF_TABLE]| c[steps - 1].abs() + c[steps].abs();
                let left = panel.coefficients.iter().map(left).fold(0.0, f64::max);
                if left <= part * faintest || (steps == STEPS[1] && to - from <= narrowest) {
                    enough = Some(panel);
                    break;
                }
            }
            let middle = 0.5 * (from + to);
            match enough {
                Some(panel) => found.push(panel),
                None => rest.extend([[middle, to], [from, middle]]),
            }
        }
        Ok(found)
    }

    /// The polynomials through these numbers at the extrema of the last one.
    fn panel(&mut self, ends: [f64; 2], steps: usize) -> Result<Panel, NotCovered> {
        let [from, to] = ends;
        let place = |k: usize| match k {
            0 => to,
            k if k == steps => from,
            k if 2 * k == steps => 0.5 * (from + to),
            k => 0.5 * (from + to) + 0.5 * (to - from) * (PI * k as f64 / steps as f64).cos(),
        };
        let samples = (0..=steps).map(|k| self.at(place(k))).collect::<Result<Vec<_>, _>>()?;
        let of_number = |number: usize| -> [f64; POINTS_OF_TABLE] {
            std::array::from_fn(|order| {
                let ends = |k: usize| if k == 0 || k == steps { 0.5 } else { 1.0 };
                let term = |(k, sample): (usize, &Vec<f64>)| {
                    ends(k) * sample[number] * (PI * (order * k) as f64 / steps as f64).cos()
                };
                let sum: f64 = samples.iter().enumerate().map(term).sum();
                if order > steps { 0.0 } else { 2.0 * ends(order) * sum / steps as f64 }
            })
        };
        let numbers = 2 * self.turns.len() + 1;
        let scattered = |sample: &Vec<f64>| {
            sample.as_chunks::<2>().0.iter().map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max)
        };
        let returned = |sample: &Vec<f64>| sample[numbers - 1].abs();
        let largest = [
            samples.iter().map(scattered).fold(0.0, f64::max),
            samples.iter().map(returned).fold(0.0, f64::max),
        ];
        Ok(Panel { ends, coefficients: (0..numbers).map(of_number).collect(), largest })
    }
}

/// How scattered light continues beyond a panel of its table.
struct Tail {
    decays_mm: Complex64,
    /// What would be wrong at the end of the panel, had the table ended in its middle.
    missed: f64,
}

impl Tail {
    fn new([re, im]: &[Tabulated; 2], [from, to]: [f64; 2]) -> Self {
        let half = 0.5 * (to - from);
        let [first, middle, last] = [from, from + half, to].map(|f| Complex64::new(re.at(f), im.at(f)));
        let rate = |near: Complex64, far: Complex64| {
            if near.norm() <= f64::MIN_POSITIVE || far.norm() <= f64::MIN_POSITIVE {
                return Complex64::new(f64::NEG_INFINITY, 0.0);
            }
            let rate = (far / near).ln() / half;
            Complex64::new(rate.re.min(0.0), rate.im)
        };
        let predicted = middle * (rate(first, middle) * half).exp();
        let decays_mm = rate(middle, last);
        if decays_mm.re == f64::NEG_INFINITY {
            return Self { decays_mm: Complex64::ZERO, missed: 0.0 };
        }
        Self { decays_mm, missed: (predicted - last).norm() }
    }
}

/// 1 up to 0.5, and smoothly 0 from 1 on.
fn window(part: f64) -> f64 {
    if part <= 0.5 {
        1.0
    } else if part < 1.0 {
        (PI * (part - 0.5)).cos().powi(2)
    } else {
        0.0
    }
}

//! What a view sees of Lambertian pixels below general layers, and what these return to them, tabulated over
//! the frequency.
//!
//! **What.** [`LayeredSpread::paper`] has the transform V of what is seen and the return A of the layers at
//! one frequency. Both are smooth: Chebyshev polynomials on panels that widen with the frequency, up to where
//! both have decreased. V has three parts: a sharp image, which does not depend on the frequency; light that
//! layers scatter; and side images, which flat faces above each other add in an oblique view. Side images do
//! not decrease: they are resolved up to a frequency of [`SIDE`] over the height of the layers. Beyond the
//! tables scattered light decreases exponentially, as at their end.
//!
//! Along other azimuths V is a Fourier series through those of the table; A is the same along all.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;

use super::LambertianReturn;
use super::face::{POINTS_OF_TABLE, chebyshev_of, chebyshev_points};
use super::panel_spread::Tabulated;
use crate::adding::{LayeredSpread, NotCovered};

/// Ends of the first panels, times the height of the layers. Each further one ends so much farther.
const FIRST: [f64; 7] = [0.05, 0.25, 1.0, 2.0, 3.0, 4.0, 6.0];
const FARTHER: f64 = 1.5;

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

/// Highest frequency of side images, times the height, the width of the panels of their table, and the number
/// of frequencies over which they are averaged.
const SIDE: f64 = 32.0;
const WIDTH_OF_SIDE: f64 = 1.0;
const SAMPLES: usize = 1024;

/// Azimuths of an oblique view on half a circle; a view along the normal has one.
const AZIMUTHS: usize = 4;

/// Lambertian pixels below general layers, for one view.
#[derive(Debug, Clone)]
pub struct LayeredPaper {
    sets: Vec<Set>,
    groups: Vec<Group>,
    azimuths: usize,
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
        Ok(Self { sets, groups, azimuths, end_per_mm })
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

    /// All other light at a frequency, cycles per mm, along the azimuths of the table: from 0 on, in equal
    /// steps over half a circle.
    pub fn others(&self, group: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.azimuths];
        for (set, factor) in &self.groups[group].sets {
            self.sets[*set].add_to(&mut sums, frequency_per_mm, *factor);
        }
        sums
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

/// Value at an azimuth (radians) from those at equal steps over half a circle: those of the other half are
/// conjugate.
pub fn turned(values: &[Complex64], azimuth: f64) -> Complex64 {
    if let [only] = values {
        return *only;
    }
    let count = 2 * values.len();
    let one = |k: usize| {
        let value = values[k % values.len()];
        let value = if k < values.len() { value } else { value.conj() };
        let angle = azimuth - 2.0 * PI * k as f64 / count as f64;
        let tangent = (0.5 * angle).tan();
        let weight = if tangent.abs() < 1e-9 {
            1.0
        } else {
            (0.5 * count as f64 * angle).sin() / (count as f64 * tangent)
        };
        weight * value
    };
    (0..count).map(one).sum()
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
        let total = spread.paper(set, 0.0, &turns[..1])?[0].seen.re;
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
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
            let points = chebyshev_points(ends);
            let mut values = vec![[[0.0; POINTS_OF_TABLE]; 3]; turns.len()];
            let (mut most, mut most_returned) = (0.0_f64, 0.0_f64);
            for (k, f) in points.iter().enumerate() {
                let found = spread.paper(set, *f, turns)?;
                for (azimuth, (values, light)) in values.iter_mut().zip(&found).enumerate() {
                    let scattered = scale * (light.seen - light.straight);
                    let parts = [scattered.re, scattered.im, light.returned.re];
                    values.iter_mut().zip(parts).for_each(|(values, part)| values[k] = part);
                    most = most.max(scattered.norm());
                    most_returned = most_returned.max(if azimuth == 0 { light.returned.norm() } else { 0.0 });
                }
            }
            for (azimuth, values) in values.iter().enumerate() {
                let table = |values: &[f64; POINTS_OF_TABLE]| (ends, chebyshev_of(values));
                let [re, im] = &mut all.scattered[azimuth];
                re.panels.push(table(&values[0]));
                im.panels.push(table(&values[1]));
            }
            returned.panels.push((ends, chebyshev_of(&values[0][2])));
            (number, from) = (number + 1, to);
            let tail = all.scattered.iter().map(|table| Tail::new(table, ends)).collect::<Vec<_>>();
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

    fn add_to(&self, sums: &mut [Complex64], f: f64, factor: f64) {
        let side = window(f / self.side_end_per_mm);
        let tables = self.scattered.iter().zip(&self.side).zip(&self.decays_mm);
        for (sum, (([re, im], [side_re, side_im]), decays_mm)) in sums.iter_mut().zip(tables) {
            let end = re.end().unwrap_or(f);
            let beyond = (decays_mm * (f - end).max(0.0)).exp();
            *sum += factor * beyond * Complex64::new(re.at(f.min(end)), im.at(f.min(end)));
            if side > 0.0 {
                *sum += factor * side * Complex64::new(side_re.at(f), side_im.at(f));
            }
        }
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

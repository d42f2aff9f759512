//! Where light meets mirror-like pixels below a diffuser that a front of screen returned to them before.
//!
//! **What.** Followed from the view, light meets the pixel along a direction of the lobe about the view, leaves through
//! the diffuser, is returned by the front, passes the diffuser again, meets the pixel, and so on: m meetings take 2 m
//! passes of the diffuser, the last one towards the source. A small change of the pixel at any of them changes what is
//! seen. These are the places of all meetings of light that has more than one, with their parts of the response.
//!
//! **How.** The integral over the directions of all passes is a sum over few Sobol points. Through lobes with wide tails
//! light from a lamp makes most of its way at a single pass: for each pass j, the directions before it follow the lobe
//! from the view, those behind it the lobe from the lamp. A point then counts as the harmonic mean of the lobes of all passes,
//! which is the balance heuristic of these samplers. Each time that light returns, one of its ways between the components of the
//! front is drawn, and one of those to the viewer.
//!
//! **Limits.** The pixel has the mean reflectance of all wavelengths at each direction, and the glass the index of the
//! brightest part of the light. How much light this is in all is not a part of it.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_optics::scatterer::Scatterer;
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::spatial::{FrontWay, FrontWays, displacement};
use papilio_transport::{Cone, Diffuser, Source};

use super::response::Lit;
use crate::DisplayError;

/// Most meetings that are followed, and the fraction of the light below which no further ones are.
const MOST: usize = 12;
const FAINTEST: f64 = 1e-5;

/// Fewest points of a number of meetings.
const FEWEST: usize = 512;

/// Points along an axis become one where they are closer than this part of their distance, or of the thickness.
const CLOSE: f64 = 0.01;
const CLOSE_OF_THICKNESS: f64 = 1e-3;

/// What light passes.
pub(super) struct Way<'a> {
    pub(super) view: &'a Cone,
    pub(super) source: &'a Source,
    pub(super) diffuser: &'a Diffuser,
    pub(super) index: f64,
    pub(super) glass_mm: f64,
    pub(super) air: &'a Air,
    /// Fraction that one more meeting leaves of the light, without the pixel's reflectance.
    pub(super) kept: f64,
}

/// Ways of light through the air of a front: one of each kind is drawn for a chain.
#[derive(Clone)]
pub(super) struct Air {
    leaving: Drawn,
    returned: Drawn,
}

/// Ways, each with its chance.
#[derive(Clone)]
struct Drawn {
    ways: Vec<FrontWay>,
    chances: Vec<f64>,
    /// Whether the fractions of the ways depend on the wavelength.
    is_coloured: bool,
}

impl Air {
    /// Those of a panel, in light with these weights over wavelength.
    pub(super) fn new(lit: Lit<'_>, weights: &[f64]) -> Result<Self, DisplayError> {
        let FrontWays { leaving, returned } = lit.front_ways(lit.level.digits)?;
        Ok(Self { leaving: Drawn::new(leaving, weights), returned: Drawn::new(returned, weights) })
    }
}

impl Drawn {
    fn new(ways: Vec<FrontWay>, weights: &[f64]) -> Self {
        let all: f64 = weights.iter().sum();
        let chance = |way: &FrontWay| match all > 0.0 {
            true => weights.iter().zip(&*way.fraction).map(|(weight, part)| weight * part).sum::<f64>() / all,
            false => way.fraction.first().copied().unwrap_or_default(),
        };
        let is_coloured = ways.iter().any(|way| way.fraction.iter().any(|part| *part != way.fraction[0]));
        Self { chances: ways.iter().map(chance).collect(), ways, is_coloured }
    }

    fn draw(&self, number: f64) -> usize {
        let mut rest = number;
        let drawn = self.chances.iter().position(|chance| {
            rest -= chance;
            rest < 0.0
        });
        drawn.unwrap_or(self.chances.len() - 1)
    }

    /// Multiplies light at each wavelength by its fraction over the chance.
    fn colour(&self, drawn: usize, light: &mut [f64]) {
        if self.is_coloured {
            let chance = self.chances[drawn];
            light
                .iter_mut()
                .zip(&*self.ways[drawn].fraction)
                .for_each(|(light, part)| *light *= part / chance);
        }
    }
}

/// Points: how many, of which replicate, and the fraction that comes back of the light of the brightest state.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points {
    pub(super) count: usize,
    pub(super) stream: u64,
    pub(super) returned: f64,
}

/// Places of meetings, each with its part of the response of each state.
pub(super) struct Meetings {
    places_mm: Vec<[f64; 2]>,
    /// `[place][state]`; the sum over the places is 1, or 0 without light.
    parts: Vec<f64>,
    states: usize,
    /// Number of meetings of this light, its mean, `[state]`.
    pub(super) number: Vec<f64>,
    /// Points that are close along an axis: places and parts.
    lines: [Vec<(f64, Vec<f64>)>; 2],
}

impl Meetings {
    /// `reflectance` writes that of each state at `|beta|^2`.
    pub(super) fn new(
        way: &Way<'_>,
        points: &Points,
        states: usize,
        reflectance: impl Fn(f64, &mut [f64]),
    ) -> Self {
        let (mut places_mm, mut parts) = (Vec::new(), Vec::new());
        let (mut light, mut all) = (vec![0.0; states], vec![0.0; states]);
        let mut chain = Chain::default();
        let (mut rho, mut seen) = (vec![0.0; states], vec![0.0; states]);
        for (meetings, count, numbers) in each_number(points) {
            for point in 0..count as u64 {
                let weight = chain.follow(way, meetings, &numbers, point);
                if weight <= 0.0 {
                    continue;
                }
                seen.fill(weight * way.kept.powi(meetings as i32 - 1) / count as f64);
                for beta in chain.at_pixel() {
                    reflectance(beta.squared(), &mut rho);
                    seen.iter_mut().zip(&rho).for_each(|(seen, rho)| *seen *= rho.max(0.0));
                }
                chain.each_place(way, |place_mm| {
                    places_mm.push(place_mm);
                    parts.extend(&seen);
                });
                for (state, seen) in seen.iter().enumerate() {
                    light[state] += seen;
                    all[state] += meetings as f64 * seen;
                }
            }
        }
        let scale: Vec<f64> = all.iter().map(|all| if *all > 0.0 { 1.0 / all } else { 0.0 }).collect();
        parts.chunks_exact_mut(states).for_each(|row| row.iter_mut().zip(&scale).for_each(|(p, s)| *p *= s));
        let number = light.iter().zip(&all).map(|(light, all)| if *light > 0.0 { all / light } else { 2.0 });
        let number = number.collect();
        let mut found = Self { places_mm, parts, states, number, lines: Default::default() };
        found.lines = [0, 1].map(|axis| found.line(axis, CLOSE_OF_THICKNESS * way.glass_mm));
        found
    }

    /// Joins points that are close along an axis, each group at its mean place.
    fn line(&self, axis: usize, least_mm: f64) -> Vec<(f64, Vec<f64>)> {
        let mut order: Vec<usize> = (0..self.places_mm.len()).collect();
        order.sort_by(|a, b| self.places_mm[*a][axis].total_cmp(&self.places_mm[*b][axis]));
        let mut line: Vec<(f64, Vec<f64>)> = Vec::new();
        let (mut first, mut moment, mut weight) = (f64::NEG_INFINITY, 0.0, 0.0);
        for point in order {
            let (at, parts) = (self.places_mm[point][axis], self.of(point));
            let own: f64 = parts.iter().sum();
            match line.last_mut() {
                Some((mean, sums)) if at - first <= least_mm.max(CLOSE * first.abs().min(at.abs())) => {
                    sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
                    (moment, weight) = (moment + own * at, weight + own);
                    if weight > 0.0 {
                        *mean = moment / weight;
                    }
                }
                _ => {
                    line.push((at, parts.to_vec()));
                    (first, moment, weight) = (at, own * at, own);
                }
            }
        }
        line
    }

    fn of(&self, point: usize) -> &[f64] {
        &self.parts[point * self.states..][..self.states]
    }

    /// Parts of all meetings in cells.
    pub(super) fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let columns = x_mm.len() - 1;
        let between = |edges: &[f64], at: f64| {
            edges.partition_point(|edge| *edge <= at).checked_sub(1).filter(|bin| *bin + 1 < edges.len())
        };
        self.in_bins(columns * (y_mm.len() - 1), |[x, y]| {
            between(x_mm, x).zip(between(y_mm, y)).map(|(column, row)| row * columns + column)
        })
    }

    /// Transform at a frequency along an axis, cycles per mm, `[state]`.
    pub(super) fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.states];
        for (at, parts) in &self.lines[axis] {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * at);
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += phase * part);
        }
        sums
    }

    /// Parts of all meetings in bins, `[state][bin]`.
    pub(super) fn bins(&self, count: usize, bin: impl Fn([f64; 2]) -> usize) -> Vec<Vec<f64>> {
        self.in_bins(count, |place| Some(bin(place)))
    }

    fn in_bins(&self, count: usize, bin: impl Fn([f64; 2]) -> Option<usize>) -> Vec<Vec<f64>> {
        let mut bins = vec![vec![0.0; count]; self.states];
        for (point, place_mm) in self.places_mm.iter().enumerate() {
            if let Some(bin) = bin(*place_mm) {
                bins.iter_mut().zip(self.of(point)).for_each(|(bins, part)| bins[bin] += part);
            }
        }
        bins
    }
}

/// Numbers of meetings that are followed, each with its number of points, and their random numbers.
pub(super) fn each_number(points: &Points) -> impl Iterator<Item = (usize, usize, SampleStream)> + use<> {
    let &Points { count, stream, returned } = points;
    (2..=MOST).map_while(move |meetings| {
        let fraction = returned.powi(meetings as i32 - 2);
        let points = ((count as f64 * fraction) as usize).max(FEWEST);
        let numbers = SampleStream::new(Sampler::Sobol, stream, meetings as u64);
        (meetings == 2 || fraction * returned >= FAINTEST).then_some((meetings, points, numbers))
    })
}

/// Directions of light from the view to the source, and which passes of the diffuser between them keep the direction.
#[derive(Default)]
pub(super) struct Chain {
    beta: Vec<Beta>,
    kept: Vec<bool>,
    /// Ways through the front: of light that leaves, and each time that it returns.
    leaving: usize,
    returned: Vec<usize>,
}

impl Chain {
    /// Follows light of a number of meetings; returns its weight, 0 if there is none.
    pub(super) fn follow(
        &mut self,
        way: &Way<'_>,
        meetings: usize,
        numbers: &SampleStream,
        point: u64,
    ) -> f64 {
        let passes = 2 * meetings;
        let [u, v, pass, first] = numbers.block(point, 2);
        let [lamp_u, lamp_v, leaving, second] = numbers.block(point, 3);
        let number = |k: usize| match k {
            0 => first,
            1 => second,
            _ => numbers.block(point, 200 + k as u32)[0],
        };
        self.leaving = way.air.leaving.draw(leaving);
        self.returned.clear();
        self.returned.extend((1..meetings).map(|k| way.air.returned.draw(number(k - 1))));
        self.beta.clear();
        self.beta.resize(passes + 1, way.view.sample_towards([u, v]));
        self.kept.clear();
        let regular = way.diffuser.regular_fraction;
        self.kept
            .extend((0..passes).map(|k| regular > 0.0 && numbers.block(point, 100 + k as u32)[0] < regular));
        let (lamp, radiance) = match way.source {
            Source::Diffuse => (None, 1.0),
            Source::Beam(beta) => (Some(*beta), 1.0),
            Source::Disc(cone) => (Some(-cone.sample_towards([lamp_u, lamp_v])), 1.0),
            Source::Field(field) => {
                let (beta, density) = field.sample([lamp_u, lamp_v]);
                (Some(beta), if density > 0.0 { field.radiance(beta) / density } else { 0.0 })
            }
        };
        let step = |from: Beta, k: usize| {
            // The passes of two meetings have numbers of the set, as the view and the lamp; further ones are random.
            let block = if k < 4 { k / 2 } else { 4 + k / 2 };
            let [a, b, c, d] = numbers.block(point, block as u32);
            way.diffuser.lobe.sample_direction(from, if k.is_multiple_of(2) { [a, b] } else { [c, d] })
        };
        let Some(lamp) = lamp else {
            for k in 0..passes - 1 {
                let next = if self.kept[k] { Some(self.beta[k]) } else { step(self.beta[k], k) };
                let Some(next) = next.filter(|next| next.squared() < limit(k + 1, way.index)) else {
                    return 0.0;
                };
                self.beta[k + 1] = next;
            }
            let last = self.beta[passes - 1].length();
            let straight = if last < 1.0 { regular } else { 0.0 };
            return straight + (1.0 - regular) * way.diffuser.lobe.fraction_in_disc(last, 1.0);
        };
        let scattering: Vec<usize> = (0..passes).filter(|k| !self.kept[*k]).collect();
        self.beta[passes] = lamp;
        if scattering.is_empty() {
            let directions = way.view.projected_solid_angle();
            self.beta.fill(lamp);
            return if directions > 0.0 && way.view.holds(lamp) { radiance / directions } else { 0.0 };
        }
        let free = scattering[((pass * scattering.len() as f64) as usize).min(scattering.len() - 1)];
        for k in 0..free {
            let next = if self.kept[k] { Some(self.beta[k]) } else { step(self.beta[k], k) };
            let Some(next) = next else { return 0.0 };
            self.beta[k + 1] = next;
        }
        for k in (free + 1..passes).rev() {
            let next = if self.kept[k] { Some(self.beta[k + 1]) } else { step(self.beta[k + 1], k) };
            let Some(next) = next else { return 0.0 };
            self.beta[k] = next;
        }
        if (1..passes).any(|k| self.beta[k].squared() >= limit(k, way.index)) {
            return 0.0;
        }
        let inverse =
            scattering.iter().map(|k| 1.0 / way.diffuser.lobe.evaluate(self.beta[*k], self.beta[k + 1]));
        radiance * scattering.len() as f64 / inverse.sum::<f64>()
    }

    /// Multiplies light at each wavelength by what the ways through the front have of it, relative to their chance.
    pub(super) fn colour(&self, way: &Way<'_>, light: &mut [f64]) {
        way.air.leaving.colour(self.leaving, light);
        self.returned.iter().for_each(|drawn| way.air.returned.colour(*drawn, light));
    }

    /// Directions along which light meets the pixel.
    pub(super) fn at_pixel(&self) -> impl Iterator<Item = &Beta> {
        self.beta[..self.beta.len() - 1].iter().skip(1).step_by(2)
    }

    /// Calls a function with the place of each meeting, relative to where the view's own ray meets the pixel.
    pub(super) fn each_place(&self, way: &Way<'_>, mut each: impl FnMut([f64; 2])) {
        let own = displacement(self.beta[0], way.glass_mm, way.index);
        let Air { leaving, returned } = way.air;
        let first = displacement(self.beta[0], leaving.ways[self.leaving].air_mm, 1.0);
        let mut place = [0, 1].map(|axis| first[axis] - own[axis]);
        for k in 1..self.beta.len() - 1 {
            let beta = self.beta[k];
            let (length, index) = match k % 2 {
                1 => (way.glass_mm, way.index),
                _ => (returned.ways[self.returned[k / 2 - 1]].air_mm, 1.0),
            };
            let by = displacement(beta, length, index);
            (0..2).for_each(|axis| place[axis] += by[axis]);
            if k % 2 == 1 {
                each(place);
                (0..2).for_each(|axis| place[axis] += by[axis]);
            }
        }
    }
}

/// Square of the limit of direction cosines: light meets the pixel in the glass at odd numbers, and the front in the air at
/// even ones.
fn limit(number: usize, index: f64) -> f64 {
    if number % 2 == 1 { index * index } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use papilio_optics::lobe::Lobe;

    use super::*;

    /// In the plane of the lamp, light crosses the glass by `tan` of its angle there, and the air twice by that in air.
    #[test]
    fn meetings_lie_where_the_light_crosses_glass_and_air() {
        let view = Cone::new(0.0, 0.0, 1.0, 1.0);
        let diffuser = Diffuser {
            lobe: Lobe::KCorrelation { width: 0.1 },
            transmittance: vec![1.0].into(),
            regular_fraction: 0.0,
        };
        let (index, glass_mm, air_mm) = (1.5, 0.7, 0.3);
        let drawn = |air_mm: f64| Drawn::new(vec![FrontWay { air_mm, fraction: vec![1.0].into() }], &[1.0]);
        let air = Air { leaving: drawn(0.0), returned: drawn(2.0 * air_mm) };
        let way = Way {
            view: &view,
            source: &Source::Diffuse,
            diffuser: &diffuser,
            index,
            glass_mm,
            air: &air,
            kept: 1.0,
        };
        let sines = [0.1, -0.3, 0.5, 0.2, 0.4_f64];
        let beta = sines.iter().map(|x| Beta { x: *x, y: 0.0 }).collect();
        let chain = Chain { beta, kept: vec![false; 4], leaving: 0, returned: vec![0] };
        let mut found = Vec::new();
        chain.each_place(&way, |place| found.push(place));
        let in_glass = |sine: f64| glass_mm * (sine / index).asin().tan();
        let first = in_glass(sines[1]) - in_glass(sines[0]);
        let second = first + in_glass(sines[1]) + 2.0 * air_mm * sines[2].asin().tan() + in_glass(sines[3]);
        assert_eq!(found.len(), 2);
        for ([x, y], expected) in found.into_iter().zip([first, second]) {
            assert!((x - expected).abs() < 1e-12 && y == 0.0, "{x} {y} {expected}");
        }
    }
}

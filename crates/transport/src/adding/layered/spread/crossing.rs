//! Light of a frequency that crosses flat elements, on one ring after the other.
//!
//! Orders become values at equal steps of the azimuth, these are multiplied by transmittances and phases, and
//! become orders again. A ring has as many steps as its own orders and phases need.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::rc::Rc;

use num_complex::Complex64;
use papilio_fourier::Circle;

use super::chain::Cavities;
use super::orders::{OnRings, Orders, up_to};
use super::rings::Ring;
use super::waves::Wave;
use crate::skeleton::Ray;

/// Most numbers that are remembered of the flat elements at a wave.
const MOST_REMEMBERED: usize = 1 << 23;

/// Steps of the azimuth, by their number: Fourier series, and cosines to half of the circle.
pub(super) type Circles = HashMap<usize, Steps>;

pub(super) struct Steps {
    circle: Circle,
    cosines: Vec<f64>,
}

impl Steps {
    fn new(steps: usize) -> Self {
        let cosine = |k: usize| (TAU * k as f64 / steps as f64).cos();
        Self { circle: Circle::new(steps), cosines: (0..=steps / 2).map(cosine).collect() }
    }
}

/// Value of light that arrives.
#[derive(Clone, Copy)]
pub(super) enum Value<'a> {
    /// One in all directions.
    One,
    /// At the nodes.
    At(&'a Orders),
    OnRings(&'a OnRings),
}

impl Value<'_> {
    fn highest(&self, number: usize, ring: &Ring) -> usize {
        match self {
            Self::One => 0,
            Self::At(given) => given.reach(ring.nodes.clone()),
            Self::OnRings(given) => given.ring(number).len() / 2,
        }
    }

    /// Writes its orders on a ring.
    fn orders(&self, number: usize, ring: &Ring, out: &mut Vec<Complex64>) {
        match self {
            Self::One => {
                out.clear();
                out.push(Complex64::ONE);
            }
            Self::At(given) => given.interpolate(ring.nodes.clone(), &ring.factors, out),
            Self::OnRings(given) => {
                out.clear();
                out.extend_from_slice(given.ring(number));
            }
        }
    }
}

/// Orders that are needed of light after the crossing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Needed {
    /// The mean over the azimuth.
    Mean,
    /// Those that scatterers have, on rings with weight.
    Scattered,
    /// Those that scatterers have on rings with weight; all of them at extra nodes.
    Overlap,
    All,
}

/// Links between all scatterers and the pixel at the last frequency: they are the same at all its azimuths.
#[derive(Debug, Default)]
pub(super) struct Links {
    from: Vec<Ray>,
    to: Vec<Ray>,
    /// Radians per mm and the rings of the frequency.
    wave: Option<(f64, Rc<Vec<Ring>>)>,
    /// By ring: the number of steps and `[step][from][to]`.
    rings: HashMap<usize, (usize, Vec<Complex64>)>,
    numbers: usize,
}

/// What crosses: values of light that arrives along some rays, of which light that leaves along others is
/// made.
pub(super) struct Crossing<'c> {
    pub(super) wave: &'c Wave,
    pub(super) receivers: &'c [(Ray, Value<'c>)],
    pub(super) emitters: &'c [Ray],
    pub(super) needed: Needed,
    /// Highest order of the scatterers by node.
    pub(super) of_nodes: &'c [usize],
}

impl Crossing<'_> {
    /// Returns the highest order before and after the crossing on each ring.
    pub(super) fn orders(&self) -> Vec<[usize; 2]> {
        let of_ring = |(number, ring): (usize, &Ring)| {
            let values = self.receivers.iter().map(|(_, value)| value.highest(number, ring));
            let before = values.max().unwrap_or(0);
            let all = before + of_phase(self.wave.per_mm * ring.chain.moves_mm(), ring.chain.reflects());
            let of_scatterers = || self.of_nodes[ring.nodes.clone()].iter().copied().max().unwrap_or(0);
            let after = match self.needed {
                Needed::Mean => 0,
                Needed::All => all,
                Needed::Overlap if ring.weight == 0.0 => all,
                Needed::Overlap | Needed::Scattered => all.min(of_scatterers()),
            };
            [before, after]
        };
        self.wave.rings.iter().enumerate().map(of_ring).collect()
    }

    /// Computes the light of each emitter on each ring with these orders; `take` receives the number of the
    /// ring and of the emitter, and the orders.
    pub(super) fn compute(
        &self,
        orders: &[[usize; 2]],
        (circles, known): (&mut Circles, &mut Links),
        take: &mut dyn FnMut(usize, usize, &[Complex64]),
    ) {
        let (wave, emitters) = (self.wave, self.emitters);
        let arrive: Vec<Ray> = self.receivers.iter().map(|(ray, _)| *ray).collect();
        let pairs = arrive.len() * emitters.len();
        if pairs == 0 {
            return;
        }
        let mut work = Work { links: vec![Complex64::ZERO; pairs], ..Work::default() };
        work.values.resize(arrive.len(), Vec::new());
        known.begin(wave);
        // Links of all rays are computed, and remembered, unless some ray is not one of them.
        let places = known.places([emitters, &arrive]);
        let is_among = places.is_some();
        let all = if is_among {
            [known.from.clone(), known.to.clone()]
        } else {
            [emitters.to_vec(), arrive.clone()]
        };
        work.places = places.unwrap_or_else(|| (0..pairs).collect());
        for ((number, ring), [before, after]) in wave.rings.iter().enumerate().zip(orders) {
            if self.needed == Needed::Scattered && ring.weight == 0.0 {
                continue;
            }
            ring.chain.links([emitters, &arrive], 0.0, &mut work.cavities, &mut work.links);
            // The air has no other directions.
            for (k, ray) in arrive.iter().enumerate().filter(|_| ring.beta >= 1.0) {
                if *ray == Ray::LEAVING {
                    work.links[k..].iter_mut().step_by(arrive.len()).for_each(|link| *link = Complex64::ZERO);
                }
            }
            if work.links.iter().all(|link| *link == Complex64::ZERO) {
                continue;
            }
            for (k, (_, given)) in self.receivers.iter().enumerate() {
                work.values[k].clear();
                if work.links[k..].iter().step_by(arrive.len()).any(|link| *link != Complex64::ZERO) {
                    given.orders(number, ring, &mut work.values[k]);
                }
            }
            if wave.per_mm == 0.0 {
                self.still(*after, number, &mut work, take);
                continue;
            }
            let phase = of_phase(wave.per_mm * ring.chain.moves_mm(), ring.chain.reflects());
            let needed = (before + after + phase).max(2 * before).max(2 * after) + 1;
            let mut steps = steps(needed);
            let remembered = if is_among { known.take(number, steps) } else { None };
            if let Some((more, links)) = remembered {
                (work.steps, work.by_step) = (more, links);
                steps = more;
                // Every second one of the known steps may do.
                while steps.is_multiple_of(4) && steps / 2 >= needed {
                    steps /= 2;
                }
            } else {
                work.steps = steps;
                let Steps { cosines, .. } = circles.entry(steps).or_insert_with(|| Steps::new(steps));
                self.by_step(ring, cosines, [&all[0], &all[1]], &mut work);
            }
            let Steps { circle, .. } = circles.entry(steps).or_insert_with(|| Steps::new(steps));
            self.turn(number, (*after, steps), circle, &mut work, take);
            if is_among {
                known.keep(number, work.steps, &mut work.by_step);
            }
        }
    }

    /// Light of a ring without phases.
    fn still(
        &self,
        after: usize,
        number: usize,
        work: &mut Work,
        take: &mut dyn FnMut(usize, usize, &[Complex64]),
    ) {
        for (emitter, links) in work.links.chunks_exact(self.receivers.len()).enumerate() {
            let lit = || links.iter().zip(&work.values).filter(|(link, _)| **link != Complex64::ZERO);
            let Some(longest) = lit().map(|(_, value)| up_to(value, after).len()).max() else { continue };
            work.orders.clear();
            work.orders.resize(longest, Complex64::ZERO);
            for (link, value) in lit() {
                let value = up_to(value, after);
                let begin = (longest - value.len()) / 2;
                work.orders[begin..].iter_mut().zip(value).for_each(|(sum, x)| *sum += link.re * x);
            }
            take(number, emitter, &work.orders);
        }
    }

    /// Links at each step of the azimuth, to half of the circle: the other half is the same.
    fn by_step(&self, ring: &Ring, cosines: &[f64], [from, to]: [&[Ray]; 2], work: &mut Work) {
        let Work { by_step, cavities, .. } = work;
        let (half, pairs) = (cosines.len() - 1, from.len() * to.len());
        by_step.clear();
        by_step.resize((half + 1) * pairs, Complex64::ZERO);
        let along = |k: usize| self.wave.per_mm * cosines[k];
        if ring.chain.reflects() {
            // Phases change their sign in the middle.
            for k in 0..=half / 2 {
                let (first, rest) = by_step.split_at_mut((k + 1) * pairs);
                let own = &mut first[k * pairs..];
                ring.chain.links([from, to], along(k), cavities, own);
                if half > 2 * k {
                    let begin = (half - 2 * k - 1) * pairs;
                    let mirror = &mut rest[begin..][..pairs];
                    mirror.iter_mut().zip(own).for_each(|(mirror, link)| *mirror = link.conj());
                }
            }
            return;
        }
        let ways = from.iter().flat_map(|from| to.iter().map(|to| ring.chain.link(*from, *to)));
        let ways: Vec<(f64, f64)> = ways.collect();
        // The phase changes its sign in the middle.
        for k in 0..=half / 2 {
            let along = along(k);
            for (pair, (t, way)) in ways.iter().enumerate().filter(|(_, (t, _))| *t != 0.0) {
                let value = Complex64::from_polar(*t, -way * along);
                by_step[k * pairs + pair] = value;
                by_step[(half - k) * pairs + pair] = value.conj();
            }
        }
    }

    /// Light of a ring with phases.
    fn turn(
        &self,
        number: usize,
        (after, steps): (usize, usize),
        circle: &mut Circle,
        work: &mut Work,
        take: &mut dyn FnMut(usize, usize, &[Complex64]),
    ) {
        let arrive = self.receivers.len();
        let Work { links, values, by_step, places, orders, sum, around, .. } = work;
        // Of the known steps, every second one and so on, each with the links of all pairs.
        let stride = by_step.len() / (work.steps / 2 + 1) * (work.steps / steps);
        around.resize(values.len(), Vec::new());
        for (value, around) in values.iter().zip(around.iter_mut()) {
            around.clear();
            match value[..] {
                [] => {}
                [mean] => around.resize(steps, mean),
                _ => {
                    let highest = value.len() / 2;
                    around.extend_from_slice(&value[highest..]);
                    around.resize(steps - highest, Complex64::ZERO);
                    around.extend_from_slice(&value[..highest]);
                    circle.values(around);
                }
            }
        }
        let scale = 1.0 / steps as f64;
        for (emitter, links) in links.chunks_exact(arrive).enumerate() {
            if links.iter().all(|link| *link == Complex64::ZERO) {
                continue;
            }
            sum.clear();
            sum.resize(steps, Complex64::ZERO);
            for (arrives, value) in around.iter().enumerate() {
                if value.is_empty() || links[arrives] == Complex64::ZERO {
                    continue;
                }
                let place = places[emitter * arrive + arrives];
                for (k, (sum, value)) in sum.iter_mut().zip(value).enumerate() {
                    *sum += by_step[k.min(steps - k) * stride + place] * value;
                }
            }
            orders.clear();
            if after == 0 {
                orders.push(scale * sum.iter().sum::<Complex64>());
            } else {
                circle.orders(sum);
                let wrapped = sum[steps - after..].iter().chain(&sum[..=after]);
                orders.extend(wrapped.map(|x| scale * x));
            }
            take(number, emitter, orders);
        }
    }
}

/// Memory of a crossing.
#[derive(Default)]
struct Work {
    cavities: Cavities,
    /// Without phases, `[from][to]`.
    links: Vec<Complex64>,
    /// Orders of what arrives, and their values around the circle.
    values: Vec<Vec<Complex64>>,
    around: Vec<Vec<Complex64>>,
    /// Number of steps and links of all pairs at each, and where those of emitters and receivers are.
    steps: usize,
    by_step: Vec<Complex64>,
    places: Vec<usize>,
    sum: Vec<Complex64>,
    orders: Vec<Complex64>,
}

impl Links {
    /// Remembers links of rays that are emitted and arrive.
    pub(super) fn between(from: Vec<Ray>, to: Vec<Ray>) -> Self {
        Self { from, to, ..Self::default() }
    }

    /// Forgets those of another frequency.
    fn begin(&mut self, wave: &Wave) {
        let is_same = self
            .wave
            .as_ref()
            .is_some_and(|(per_mm, rings)| *per_mm == wave.per_mm && Rc::ptr_eq(rings, &wave.rings));
        if !is_same {
            self.wave = Some((wave.per_mm, Rc::clone(&wave.rings)));
            self.rings.clear();
            self.numbers = 0;
        }
    }

    /// Where the links between some of the rays are, `[from][to]`; `None` if one of the rays is not known.
    fn places(&self, [from, to]: [&[Ray]; 2]) -> Option<Vec<usize>> {
        let number = |all: &[Ray], one: &Ray| all.iter().position(|ray| ray == one);
        let pair =
            |from: &Ray, to: &Ray| Some(number(&self.from, from)? * self.to.len() + number(&self.to, to)?);
        from.iter().flat_map(|from| to.iter().map(move |to| pair(from, to))).collect()
    }

    /// Takes the links of a ring out if they have enough steps.
    fn take(&mut self, ring: usize, steps: usize) -> Option<(usize, Vec<Complex64>)> {
        let known = self.rings.get(&ring).is_some_and(|(many, _)| *many >= steps);
        let found = known.then(|| self.rings.remove(&ring)).flatten();
        self.numbers -= found.as_ref().map_or(0, |(_, links)| links.len());
        found
    }

    /// Remembers the links of a ring if there is room.
    fn keep(&mut self, ring: usize, steps: usize, links: &mut Vec<Complex64>) {
        let before = self.rings.remove(&ring).map_or(0, |(_, links)| links.len());
        self.numbers -= before;
        if self.numbers + links.len() <= MOST_REMEMBERED {
            self.numbers += links.len();
            self.rings.insert(ring, (steps, std::mem::take(links)));
        }
    }
}

/// Returns the highest order of a phase of this amplitude, `exp(-i phase cos(azimuth))`.
fn of_phase(phase: f64, reflects: bool) -> usize {
    // Light that is reflected to and fro crosses several times.
    let phase = if reflects { 3.0 * phase } else { phase };
    if phase > 0.0 { (phase + 5.0 * phase.cbrt()) as usize + 2 } else { 0 }
}

/// Returns a number of steps that is quickly transformed.
fn steps(needed: usize) -> usize {
    let power = needed.next_power_of_two().max(8);
    if needed <= power / 4 * 3 { power / 4 * 3 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The orders of a phase are Bessel functions: beyond the highest one they are small.
    #[test]
    fn orders_of_a_phase_end_with_small_ones() {
        for phase in [0.01, 0.3, 1.0, 4.0, 30.0, 200.0_f64] {
            let highest = of_phase(phase, false);
            let steps = 2 * steps(2 * highest + 1);
            let mut values: Vec<Complex64> =
                (0..steps).map(|k| Complex64::cis(-phase * (TAU * k as f64 / steps as f64).cos())).collect();
            Circle::new(steps).orders(&mut values);
            let beyond = values[highest + 1].norm() / steps as f64;
            let at_edge = values[(phase as usize).min(highest)].norm() / steps as f64;
            assert!(beyond < 1e-5 && at_edge > 1e-2, "{phase}: {beyond} {at_edge}");
        }
    }
}

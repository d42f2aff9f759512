//! Phase screens at any angle: powers by the distance from the regular direction.
//!
//! The light behind a screen is known for each phase per um of height, q: its Fourier transform, whose order
//! of the frequency f goes to the regular direction plus λ f. Light comes from all azimuths, so that only |f|
//! matters. A family of inclinations, wavelengths and ways has as many q: all are computed if the screen is
//! small, else a number of them, and cubics in ln q lie between. The regular part is exact for all.
//!
//! **Orders** of a surface that repeats have exact directions. Those of a random one stand for the light of a
//! face without a period: each for that of its cell of frequencies, 1/period wide, and a part of the cell is
//! haze ([`Orders`]).

use num_complex::Complex64;
use papilio_fourier::Plane;

use crate::HeightMap;
use crate::goniometer::haze_beta;
use crate::wave_way::{Way, inside};

/// Heights that are transformed for a realisation, all phases together.
const MOST_HEIGHTS: usize = 1 << 25;

/// Fewest phases of large screens.
const FEWEST: usize = 12;

/// Circles of frequencies in the distance between two orders.
const FINENESS: f64 = 4.0;

/// Classes of heights for the regular part of large screens.
const CLASSES: usize = 1 << 16;

/// What a screen does with the light of a way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ScreenShares {
    /// Fraction in the regular direction, of all light before renormalisation.
    pub(crate) regular: f64,
    /// Of the light that is seen, the fraction beyond sin 2.5 deg from the regular direction.
    pub(crate) haze: f64,
    /// Fraction of orders in directions that do not exist.
    pub(crate) evanescent: f64,
}

/// Powers of a screen.
pub(crate) struct ScreenRings {
    /// Phases per um of height for which powers are known, ascending, above 0.
    phases: Vec<f64>,
    /// Frequency of each circle, per um.
    frequencies: Vec<f64>,
    /// By phase: power of each circle but the regular direction.
    powers: Vec<Vec<f64>>,
    /// Heights with their fractions of the face.
    heights: Vec<[f64; 2]>,
    lattice: Lattice,
    /// Number of each circle.
    number: Vec<u32>,
    orders: Orders,
}

/// What an order of a screen stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Orders {
    /// Light in exactly its direction.
    Exact,
    /// Light of all directions of its cell.
    Cells,
}

impl Orders {
    /// Fraction of the light of an order, at a frequency, that is beyond a radius from the regular direction.
    /// Cells have these sides.
    pub(crate) fn beyond(self, frequency: [f64; 2], sides: [f64; 2], radius: f64) -> f64 {
        let length = frequency[0].hypot(frequency[1]);
        if self == Self::Exact || (length - radius).abs() >= 0.5 * sides[0].hypot(sides[1]) {
            return f64::from(u8::from(length > radius));
        }
        let edges = [0, 1].map(|k| [frequency[k] - 0.5 * sides[k], frequency[k] + 0.5 * sides[k]]);
        let corner = |x: usize, y: usize| area_to_corner([edges[0][x], edges[1][y]], radius);
        let within = corner(1, 1) - corner(0, 1) - corner(1, 0) + corner(0, 0);
        1.0 - (within / (sides[0] * sides[1])).clamp(0.0, 1.0)
    }
}

/// Area of the part of a disc about the origin that lies in the rectangle from the origin to a corner; with the
/// sign of the product of its coordinates.
fn area_to_corner([x, y]: [f64; 2], radius: f64) -> f64 {
    let sign = x.signum() * y.signum();
    let [x, y] = [x, y].map(|one| one.abs().min(radius));
    // Up to here the side of the rectangle bounds the area, beyond it the circle.
    let flat = (radius * radius - y * y).max(0.0).sqrt().min(x);
    let below_circle = |u: f64| {
        let up = (radius * radius - u * u).max(0.0).sqrt();
        0.5 * (u * up + radius * radius * (u / radius).asin())
    };
    sign * (y * flat + below_circle(x) - below_circle(flat))
}

/// The orders of a map: frequencies on a lattice, per um.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    counts: [usize; 2],
    /// Distance of the frequencies along x and y.
    pub(crate) per_order: [f64; 2],
}

impl Lattice {
    pub(crate) fn new(map: &HeightMap) -> Self {
        let counts = [map.columns(), map.rows()];
        let pitch = map.pitch_um();
        Self { counts, per_order: [0, 1].map(|k| 1.0 / (counts[k] as f64 * pitch[k])) }
    }

    /// Frequency of an order of the transform, along x and y.
    pub(crate) fn frequency(&self, at: usize) -> [f64; 2] {
        let order = |k: usize, count: usize| if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
        let orders = [order(at / self.counts[1], self.counts[0]), order(at % self.counts[1], self.counts[1])];
        [0, 1].map(|k| self.per_order[k] * orders[k])
    }

    /// Calls `visit` with the frequency of each order, but the regular one, in a square of this half side.
    fn within(&self, half: f64, visit: &mut dyn FnMut([f64; 2])) {
        let range = |k: usize| {
            let most = (half / self.per_order[k]).floor() as i64;
            let count = self.counts[k] as i64;
            -most.min((count - 1) / 2)..=most.min(count / 2)
        };
        for x in range(0) {
            for y in range(1).filter(|y| (x, *y) != (0, 0)) {
                visit([x as f64 * self.per_order[0], y as f64 * self.per_order[1]]);
            }
        }
    }

    /// Circle of a frequency, with [`FINENESS`].
    fn circle(&self, frequency: [f64; 2]) -> usize {
        let step = self.per_order[0].min(self.per_order[1]) / FINENESS;
        (frequency[0].hypot(frequency[1]) / step).round() as usize
    }
}

impl ScreenRings {
    /// Powers of a map for these phases per um. `stop` as in
    /// [`Goniometer::replicate`](crate::Goniometer::replicate): `None` if it stopped.
    pub(crate) fn new(
        map: &HeightMap,
        (plane, orders): (&Plane, Orders),
        phases: &[f64],
        stop: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let circles = Circles::new(map);
        let phases = nodes(phases, MOST_HEIGHTS / map.heights_um().len());
        let mut powers = Vec::with_capacity(phases.len());
        for per_um in &phases {
            if stop() {
                return None;
            }
            powers.push(circles.powers(map, plane, *per_um));
        }
        let Circles { frequencies, lattice, number, .. } = circles;
        Some(Self { phases, frequencies, powers, heights: classes(map), lattice, number, orders })
    }

    /// What the screen does with the light of a way.
    pub(crate) fn of(&self, way: &Way, wavelength_um: f64) -> ScreenShares {
        let per_um = way.regular_per_um(wavelength_um);
        let regular = self.regular(per_um);
        let mut seen = [if way.beta <= way.seen() { regular } else { 0.0 }, 0.0];
        let (mut all, mut propagates) = (regular, regular);
        let weights = self.weights(per_um);
        let beyond = self.beyond(haze_beta() / wavelength_um);
        for (circle, frequency) in self.frequencies.iter().enumerate() {
            let power: f64 = weights.iter().map(|(node, weight)| weight * self.powers[*node][circle]).sum();
            let distance = wavelength_um * frequency;
            all += power;
            propagates += power * inside(distance, way.beta, way.disc());
            let visible = power * inside(distance, way.beta, way.seen());
            seen[0] += visible * (1.0 - beyond[circle]);
            seen[1] += visible * beyond[circle];
        }
        ScreenShares {
            regular: regular / all,
            haze: seen[1] / (seen[0] + seen[1]),
            evanescent: 1.0 - propagates / all,
        }
    }

    /// Fraction of the light of each circle that is beyond a frequency: the mean over its orders.
    fn beyond(&self, radius: f64) -> Vec<f64> {
        let mut beyond: Vec<f64> =
            self.frequencies.iter().map(|frequency| f64::from(u8::from(*frequency > radius))).collect();
        if self.orders == Orders::Cells {
            let sides = self.lattice.per_order;
            let reach = 0.5 * sides[0].hypot(sides[1]);
            let mut sums = vec![[0.0; 2]; beyond.len()];
            self.lattice.within(radius + reach, &mut |frequency| {
                let sum = &mut sums[self.number[self.lattice.circle(frequency)] as usize];
                *sum = [sum[0] + self.orders.beyond(frequency, sides, radius), sum[1] + 1.0];
            });
            // A circle at the end of the square may have other orders, which are all beyond.
            let near = |circle: &usize| self.frequencies[*circle] < radius + reach;
            for circle in (0..beyond.len()).filter(near).filter(|circle| sums[*circle][1] > 0.0) {
                beyond[circle] = sums[circle][0] / sums[circle][1];
            }
        }
        beyond
    }

    /// Fraction of the light in the regular direction.
    fn regular(&self, per_um: f64) -> f64 {
        let mean: Complex64 =
            self.heights.iter().map(|[height, share]| share * Complex64::cis(per_um * height)).sum();
        mean.norm_sqr()
    }

    /// Nodes with the weights with which they give the powers of a phase.
    fn weights(&self, per_um: f64) -> Vec<(usize, f64)> {
        let after = self.phases.partition_point(|known| *known < per_um * (1.0 - 1e-12));
        match self.phases.get(after) {
            Some(known) if *known <= per_um * (1.0 + 1e-12) => return vec![(after, 1.0)],
            // Without phase, nothing is scattered.
            _ if per_um == 0.0 || self.phases.is_empty() => return Vec::new(),
            _ => {}
        }
        let first = after.saturating_sub(2).min(self.phases.len().saturating_sub(4));
        let four = first..(first + 4).min(self.phases.len());
        let of = |i: usize| {
            let others = four.clone().filter(|j| *j != i);
            let term = |j: usize| (per_um / self.phases[j]).ln() / (self.phases[i] / self.phases[j]).ln();
            (i, others.map(term).product())
        };
        four.clone().map(of).collect()
    }
}

/// The phases to compute: all different ones if there are at most this many, else some in equal ratios.
fn nodes(phases: &[f64], most: usize) -> Vec<f64> {
    let mut all: Vec<f64> = phases.iter().copied().filter(|phase| *phase > 0.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|one, other| *one <= *other * (1.0 + 1e-12));
    let most = most.max(FEWEST);
    match (all.first(), all.last()) {
        (Some(first), Some(last)) if all.len() > most => {
            let step = (last / first).ln() / (most - 1) as f64;
            (0..most).map(|k| first * (step * k as f64).exp()).collect()
        }
        _ => all,
    }
}

/// Heights with their fractions of a face: all of a small map, classes of a large one.
fn classes(map: &HeightMap) -> Vec<[f64; 2]> {
    let heights = map.heights_um();
    let share = 1.0 / heights.len() as f64;
    if heights.len() <= CLASSES {
        return heights.iter().map(|height| [*height, share]).collect();
    }
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let step = ((high - low) / (CLASSES - 2) as f64).max(f64::MIN_POSITIVE);
    let mut shares = vec![0.0; CLASSES];
    for height in heights {
        // Shared by the two nearest classes, which keeps the mean height.
        let place = (height - low) / step;
        let below = (place as usize).min(CLASSES - 2);
        let part = place - below as f64;
        shares[below] += share * (1.0 - part);
        shares[below + 1] += share * part;
    }
    let all = shares.into_iter().enumerate().filter(|(_, share)| *share != 0.0);
    all.map(|(class, share)| [low + step * class as f64, share]).collect()
}

/// Orders of a map by the length of their frequency.
struct Circles {
    lattice: Lattice,
    /// Mean frequency of each circle with orders, per um.
    frequencies: Vec<f64>,
    /// Their number by the circle.
    number: Vec<u32>,
    /// Circle of each order; that of the regular direction is none.
    of_order: Vec<u32>,
}

impl Circles {
    fn new(map: &HeightMap) -> Self {
        let lattice = Lattice::new(map);
        let all = map.heights_um().len();
        let circle = |at: usize| lattice.circle(lattice.frequency(at));
        let largest = (0..all).map(circle).max().unwrap_or(0);
        let mut sums = vec![[0.0; 2]; largest + 1];
        for at in 1..all {
            let [x, y] = lattice.frequency(at);
            let sum = &mut sums[circle(at)];
            *sum = [sum[0] + x.hypot(y), sum[1] + 1.0];
        }
        // Circles without orders are left out.
        let mut number = vec![0; sums.len()];
        let mut frequencies = Vec::new();
        for (at, [sum, count]) in sums.iter().enumerate().filter(|(_, [_, count])| *count > 0.0) {
            number[at] = frequencies.len() as u32;
            frequencies.push(sum / count);
        }
        let of_order = (1..all).map(|at| number[circle(at)]).collect();
        Self { lattice, frequencies, number, of_order }
    }

    /// Power of each circle behind a screen.
    fn powers(&self, map: &HeightMap, plane: &Plane, per_um: f64) -> Vec<f64> {
        let field = map.heights_um().iter().map(|height| Complex64::cis(per_um * height)).collect();
        let orders = plane.forward(field);
        let all: f64 = orders.iter().map(Complex64::norm_sqr).sum();
        let mut powers = vec![0.0; self.frequencies.len()];
        for (amplitude, circle) in orders[1..].iter().zip(&self.of_order) {
            powers[*circle as usize] += amplitude.norm_sqr() / all;
        }
        powers
    }
}

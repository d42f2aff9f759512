//! Phase screens at any angle: powers by the distance from the regular direction.
//!
//! The light behind a screen is known for each phase per um of height, q: its Fourier transform, whose order
//! of the frequency f goes to the regular direction plus λ f. Light comes from all azimuths, so that only |f|
//! matters. A family of inclinations, wavelengths and ways has as many q: all are computed if the screen is
//! small, else a number of them, and cubics in ln q lie between. The regular part is exact for all.

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
}

impl ScreenRings {
    /// Powers of a map for these phases per um. `stop` as in
    /// [`Goniometer::replicate`](crate::Goniometer::replicate): `None` if it stopped.
    pub(crate) fn new(
        map: &HeightMap,
        plane: &Plane,
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
        Some(Self { phases, frequencies: circles.frequencies, powers, heights: classes(map) })
    }

    /// What the screen does with the light of a way.
    pub(crate) fn of(&self, way: &Way, wavelength_um: f64) -> ScreenShares {
        let per_um = way.regular_per_um(wavelength_um);
        let regular = self.regular(per_um);
        let mut seen = [if way.beta <= way.seen() { regular } else { 0.0 }, 0.0];
        let (mut all, mut propagates) = (regular, regular);
        let weights = self.weights(per_um);
        for (circle, frequency) in self.frequencies.iter().enumerate() {
            let power: f64 = weights.iter().map(|(node, weight)| weight * self.powers[*node][circle]).sum();
            let distance = wavelength_um * frequency;
            all += power;
            propagates += power * inside(distance, way.beta, way.disc());
            seen[usize::from(distance > haze_beta())] += power * inside(distance, way.beta, way.seen());
        }
        ScreenShares {
            regular: regular / all,
            haze: seen[1] / (seen[0] + seen[1]),
            evanescent: 1.0 - propagates / all,
        }
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
    /// Mean frequency of each circle, per um.
    frequencies: Vec<f64>,
    /// Circle of each order; that of the regular direction is none.
    of_order: Vec<u32>,
}

impl Circles {
    fn new(map: &HeightMap) -> Self {
        let counts = [map.columns(), map.rows()];
        let pitch = map.pitch_um();
        let per_order = [0, 1].map(|k| 1.0 / (counts[k] as f64 * pitch[k]));
        let step = per_order[0].min(per_order[1]) / FINENESS;
        let order = |k: usize, count: usize| if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
        let frequency = |at: usize| {
            let [x, y] = [order(at / counts[1], counts[0]), order(at % counts[1], counts[1])];
            (per_order[0] * x).hypot(per_order[1] * y)
        };
        let circle = |frequency: f64| (frequency / step).round() as usize;
        let all = counts[0] * counts[1];
        let largest = (0..all).map(frequency).fold(0.0, f64::max);
        let mut sums = vec![[0.0; 2]; circle(largest) + 1];
        for at in 1..all {
            let sum = &mut sums[circle(frequency(at))];
            *sum = [sum[0] + frequency(at), sum[1] + 1.0];
        }
        // Circles without orders are left out.
        let mut number = vec![0; sums.len()];
        let mut frequencies = Vec::new();
        for (at, [sum, count]) in sums.iter().enumerate().filter(|(_, [_, count])| *count > 0.0) {
            number[at] = frequencies.len() as u32;
            frequencies.push(sum / count);
        }
        let of_order = (1..all).map(|at| number[circle(frequency(at))]).collect();
        Self { frequencies, of_order }
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

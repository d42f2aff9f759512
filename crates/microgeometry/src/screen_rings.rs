//! Phase screens at any angle: powers by the distance from the regular direction.
//!
//! The light behind a screen is known for each phase per um of height, q: its Fourier transform, whose order
//! of the frequency f goes to the regular direction plus λ f. Light comes from all azimuths, so that only |f|
//! matters. A family of inclinations, wavelengths and ways has as many q: a number of them is computed, and the
//! powers of the others lie between ([`PhaseNodes`]). The regular part is exact for all.
//!
//! **Orders** of a surface that repeats have exact directions. Those of a random one stand for the light of a
//! face without a period: each for that of its cell of frequencies, 1/period wide, and a part of the cell is
//! haze ([`Orders`]).

use num_complex::Complex64;
use papilio_fourier::Plane;

use crate::HeightMap;
use crate::goniometer::haze_beta;
use crate::phase_nodes::{PhaseNodes, ScreenHeights};
use crate::wave_way::{Way, inside};

/// Circles of frequencies in the distance between two orders of a random surface.
const FINENESS: f64 = 4.0;

/// Largest number of circles of a surface that repeats, apart from the edges between them.
const MOST_CIRCLES: usize = 1 << 14;

/// Frequencies that differ by less, relative to them, are equal.
const ROUNDING: f64 = 1e-10;

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

/// The light of a screen.
#[derive(Debug, Clone)]
pub(crate) struct ScreenLight {
    /// Phases per um of height.
    phases: Vec<f64>,
    /// Frequencies, per um, ascending, at which circles of orders become haze, or begin or cease to be inside a
    /// disc of directions. No order of the last one or beyond it exists.
    edges: Vec<f64>,
}

impl ScreenLight {
    /// Light of these ways and wavelengths, um.
    pub(crate) fn new(ways: impl IntoIterator<Item = (Way, f64)>) -> Self {
        let (mut phases, mut edges) = (Vec::new(), Vec::new());
        for (way, um) in ways {
            phases.push(way.regular_per_um(um));
            let rims = [way.disc(), way.seen()].map(|disc| [(disc - way.beta).abs(), disc + way.beta]);
            edges.extend(rims.as_flattened().iter().chain([&haze_beta()]).map(|beta| beta / um));
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        Self { phases, edges }
    }

    /// Light of a random face with these phases.
    #[cfg(test)]
    pub(crate) fn of_phases(phases: Vec<f64>) -> Self {
        Self { phases, edges: Vec::new() }
    }
}

/// Powers of a screen.
pub(crate) struct ScreenRings {
    /// Phases for which powers are known.
    nodes: PhaseNodes,
    /// Frequency of each circle, per um.
    frequencies: Vec<f64>,
    /// By phase: power of each circle but the regular direction.
    powers: Vec<Vec<f64>>,
    /// Heights with their fractions of the face.
    heights: Vec<[f64; 2]>,
    lattice: Lattice,
    /// Number of each circle of a random surface.
    number: Vec<u32>,
    orders: Orders,
}

/// What an order of a screen stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Orders {
    /// Light in exactly its direction.
    Exact,
    /// Light of all directions of its cell, on a face with Gaussian heights.
    Cells,
    /// The same on a face with shapes at random places.
    CellsOfShapes,
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
    /// Powers of a map for this light. `stop` as in [`Goniometer::replicate`](crate::Goniometer::replicate):
    /// `None` if it stopped.
    pub(crate) fn new(
        map: &HeightMap,
        (plane, orders): (&Plane, Orders),
        light: &ScreenLight,
        stop: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let circles = match orders {
            Orders::Exact => Circles::exact(map, &light.edges),
            Orders::Cells | Orders::CellsOfShapes => Circles::of_cells(map),
        };
        let [low, high] = extremes(map);
        let heights = ScreenHeights {
            count: map.heights_um().len(),
            range_um: high - low,
            is_gaussian: orders == Orders::Cells,
        };
        let nodes = PhaseNodes::new(&light.phases, heights);
        let mut powers = Vec::with_capacity(nodes.all().len());
        for per_um in nodes.all() {
            if stop() {
                return None;
            }
            powers.push(circles.powers(map, plane, *per_um));
        }
        let Circles { frequencies, lattice, number, .. } = circles;
        Some(Self { nodes, frequencies, powers, heights: classes(map), lattice, number, orders })
    }

    /// What the screen does with the light of a way.
    pub(crate) fn of(&self, way: &Way, wavelength_um: f64) -> ScreenShares {
        let per_um = way.regular_per_um(wavelength_um);
        let regular = self.regular(per_um);
        let mut seen = [if way.beta <= way.seen() { regular } else { 0.0 }, 0.0];
        let (mut all, mut propagates) = (regular, regular);
        let weights = self.nodes.weights(per_um);
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
        if self.orders != Orders::Exact {
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
}

/// Heights with their fractions of a face: all of a small map, classes of a large one.
fn classes(map: &HeightMap) -> Vec<[f64; 2]> {
    let heights = map.heights_um();
    let share = 1.0 / heights.len() as f64;
    if heights.len() <= CLASSES {
        return heights.iter().map(|height| [*height, share]).collect();
    }
    let [low, high] = extremes(map);
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

/// The lowest and the highest height of a map.
fn extremes(map: &HeightMap) -> [f64; 2] {
    map.heights_um()
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], height| [low.min(*height), high.max(*height)])
}

/// Orders of a map by the length of their frequency.
struct Circles {
    lattice: Lattice,
    /// Mean frequency of each circle with orders, per um.
    frequencies: Vec<f64>,
    /// Their number by the circle, of a random surface.
    number: Vec<u32>,
    /// Circle of each order; that of the regular direction is none.
    of_order: Vec<u32>,
}

impl Circles {
    /// Circles that are equally far apart.
    fn of_cells(map: &HeightMap) -> Self {
        let lattice = Lattice::new(map);
        let circle = |at: usize| lattice.circle(lattice.frequency(at));
        Self::of(map, lattice, circle)
    }

    /// A circle for each length; of large maps, which have more of them than can be told apart, narrow ones. None
    /// has orders on both sides of one of these edges.
    fn exact(map: &HeightMap, edges: &[f64]) -> Self {
        let lattice = Lattice::new(map);
        let length = |at: usize| {
            let [x, y] = lattice.frequency(at);
            x.hypot(y)
        };
        let last = edges.last().copied().unwrap_or(0.0);
        let mut ends: Vec<f64> =
            (1..map.heights_um().len()).map(length).filter(|one| *one <= last * (1.0 + ROUNDING)).collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|one, before| *one <= *before * (1.0 + ROUNDING));
        if ends.len() > MOST_CIRCLES {
            let even = (1..=MOST_CIRCLES).map(|k| last * k as f64 / MOST_CIRCLES as f64);
            ends = even.chain(edges.iter().copied()).collect();
            ends.sort_by(f64::total_cmp);
        }
        // What is beyond the last end does not exist, and is one circle.
        Self::of(map, lattice, |at| ends.partition_point(|end| *end < length(at) * (1.0 - 2.0 * ROUNDING)))
    }

    /// Circles by their number for each order.
    fn of(map: &HeightMap, lattice: Lattice, circle: impl Fn(usize) -> usize) -> Self {
        let of_order: Vec<usize> = (1..map.heights_um().len()).map(circle).collect();
        let mut sums = vec![[0.0; 2]; of_order.iter().max().map_or(0, |most| most + 1)];
        for (before, circle) in of_order.iter().enumerate() {
            let [x, y] = lattice.frequency(before + 1);
            let sum = &mut sums[*circle];
            *sum = [sum[0] + x.hypot(y), sum[1] + 1.0];
        }
        // Circles without orders are left out.
        let mut number = vec![0; sums.len()];
        let mut frequencies = Vec::new();
        for (at, [sum, count]) in sums.iter().enumerate().filter(|(_, [_, count])| *count > 0.0) {
            number[at] = frequencies.len() as u32;
            frequencies.push(sum / count);
        }
        let of_order = of_order.into_iter().map(|circle| number[circle]).collect();
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

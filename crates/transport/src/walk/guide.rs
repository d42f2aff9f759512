//! Guide: a sampling density over direction cosines that follows a given function.
//!
//! The density is the function times `|beta|` at the nodes of a polar grid, bilinear between them. Rings and
//! spokes are close together where the function is narrow. The length of `beta` is sampled first, from the
//! mean over each ring, then its azimuth. Uniform numbers are thus mapped to directions without a jump, so
//! that low-discrepancy numbers keep their uniformity, above all in length, on which the reflectance of a
//! pixel depends.
//!
//! The density is known exactly, so estimates are unbiased however coarse the guide is. The function must be
//! positive wherever there is light.

use std::f64::consts::TAU;

use papilio_optics::Beta;
use papilio_sampling::warp;

/// Steps of the grid, as a fraction of the distance to the next peak (or of its size).
const STEP: f64 = 0.15;

/// Widest steps, as fractions of the disc's radius and of a turn.
const WIDEST: [f64; 2] = [1.0 / 32.0, 1.0 / 24.0];

/// Largest numbers of rings and of spokes; if there are many peaks, the steps grow.
const MOST: usize = 160;

/// A direction about which the function is narrow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    pub(super) at: Beta,
    pub(super) size: f64,
}

/// Guide on a polar grid. Its density is over length and azimuth, the latter in turns.
#[derive(Debug)]
pub(super) struct Guide {
    lengths: Vec<f64>,
    turns: Vec<f64>,
    /// Values at the nodes, shape `[length][turn]`; not normalised.
    values: Vec<f64>,
    /// Integrals over the turns up to each node, same shape.
    within: Vec<f64>,
    /// Integral over lengths up to each.
    up_to: Vec<f64>,
}

impl Guide {
    /// Builds a guide to a positive `function` on the disc of this radius; `None` if the function is zero at
    /// all nodes.
    pub(super) fn new(radius: f64, peaks: &[Peak], function: impl Fn(Beta) -> f64) -> Option<Self> {
        let lengths: Vec<(f64, f64)> = peaks.iter().map(|peak| (peak.at.length(), peak.size)).collect();
        let turns: Vec<(f64, f64)> = peaks.iter().flat_map(Peak::in_turns).collect();
        let lengths = nodes(radius, &lengths, radius * WIDEST[0]);
        let turns = nodes(1.0, &turns, WIDEST[1]);
        let mut values = Vec::with_capacity(lengths.len() * turns.len());
        for &length in &lengths {
            let ring = values.len();
            let at = |turn: &f64| {
                let (x, y) = warp::polar(length, *turn);
                length * function(Beta { x, y })
            };
            values.extend(turns[..turns.len() - 1].iter().map(at));
            values.push(values[ring]);
        }
        let within: Vec<f64> =
            values.chunks_exact(turns.len()).flat_map(|ring| integrals(&turns, ring)).collect();
        let rings: Vec<f64> = within.chunks_exact(turns.len()).map(|ring| ring[ring.len() - 1]).collect();
        let up_to = integrals(&lengths, &rings);
        let total = up_to[up_to.len() - 1];
        (total > 0.0 && total.is_finite()).then_some(Self { lengths, turns, values, within, up_to })
    }

    /// Samples a direction; returns it with its density over direction cosines.
    #[inline]
    pub(super) fn draw(&self, [u, v]: [f64; 2]) -> (Beta, f64) {
        let (spokes, last) = (self.turns.len(), self.up_to.len() - 1);
        let wanted = u * self.up_to[last];
        let i = self.up_to.partition_point(|up_to| *up_to <= wanted).clamp(1, last) - 1;
        let (inner, outer) = (i * spokes, (i + 1) * spokes);
        let ring = |ring: usize| self.within[ring + spokes - 1];
        let part = (wanted - self.up_to[i]) / (self.up_to[i + 1] - self.up_to[i]);
        let t = linear(ring(inner), ring(outer), part);
        let length = self.lengths[i] + t * (self.lengths[i + 1] - self.lengths[i]);

        let mixed =
            |values: &[f64], j: usize| values[inner + j] + t * (values[outer + j] - values[inner + j]);
        let wanted = v * mixed(&self.within, spokes - 1);
        let (mut j, mut end) = (0, spokes - 1);
        while end - j > 1 {
            let middle = (j + end) / 2;
            if mixed(&self.within, middle) <= wanted { j = middle } else { end = middle }
        }
        let (from, to) = (mixed(&self.within, j), mixed(&self.within, j + 1));
        let (a, b) = (mixed(&self.values, j), mixed(&self.values, j + 1));
        let s = linear(a, b, (wanted - from) / (to - from));
        let turn = self.turns[j] + s * (self.turns[j + 1] - self.turns[j]);
        let (x, y) = warp::polar(length, turn);
        let density = (a + s * (b - a)) / (self.up_to[last] * TAU * length);
        (Beta { x, y }, density)
    }
}

impl Peak {
    /// Returns its azimuth and size in turns, repeated one turn before and one after.
    fn in_turns(&self) -> [(f64, f64); 3] {
        let at = self.at.y.atan2(self.at.x).rem_euclid(TAU) / TAU;
        // Around the normal all azimuths are equally important.
        let size = (self.size / (TAU * self.at.length()).max(self.size)).min(1.0);
        [(at - 1.0, size), (at, size), (at + 1.0, size)]
    }
}

/// Returns nodes from 0 to `end`, in steps that follow the distance to the nearest of the peaks (position,
/// size).
fn nodes(end: f64, peaks: &[(f64, f64)], widest: f64) -> Vec<f64> {
    let mut scale = STEP;
    loop {
        let step = |x: f64| {
            let near = |(at, size): &(f64, f64)| scale * (x - at).hypot(*size);
            peaks.iter().map(near).fold(widest, f64::min)
        };
        let mut nodes = vec![0.0];
        let mut x = 0.0;
        while nodes.len() <= MOST {
            // The step is that at its own middle.
            x += step(x + 0.5 * step(x));
            if x >= end * (1.0 - 1e-9) {
                nodes.push(end);
                return nodes;
            }
            nodes.push(x);
        }
        scale *= 1.4;
    }
}

/// Returns the integral of a piecewise linear function from the first node up to each.
fn integrals(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = nodes.iter().zip(&nodes[1..]).zip(values.iter().zip(&values[1..]));
    let up_to = steps.map(|((from, to), (a, b))| {
        sum += 0.5 * (a + b) * (to - from);
        sum
    });
    std::iter::once(0.0).chain(up_to).collect()
}

/// Samples a number from 0 to 1 with a density that changes linearly from `a` to `b`.
#[inline]
fn linear(a: f64, b: f64, u: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    let sum = a + root;
    if sum > 0.0 { (u * (a + b) / sum).clamp(0.0, 1.0) } else { u }
}

#[cfg(test)]
mod tests {
    use papilio_optics::Scatterer;

    use super::*;
    use papilio_optics::lobe::Lobe;
    use papilio_sampling::{SampleStream, Sampler};

    /// Two narrow lobes and a floor, on a disc of radius 1.5.
    fn guide() -> Guide {
        let lobe = Lobe::KCorrelation { width: 0.02 };
        let (a, b) = (Beta { x: 0.3, y: 0.1 }, Beta { x: -0.4, y: 0.5 });
        let peaks = [a, b].map(|at| Peak { at, size: 0.02 });
        Guide::new(1.5, &peaks, |to| lobe.density(a, to) * lobe.density(b, to) + 0.1).unwrap()
    }

    /// Chi-square, as a standard normal variable. On each of 20 x 20 cells the mean of 1/density over
    /// samples is the area of the cell; only cells within the disc count.
    fn statistic(distort: f64) -> f64 {
        const SIDE: usize = 20;
        const DRAWS: u64 = 200_000;
        let (guide, numbers) = (guide(), SampleStream::new(Sampler::Random, 3, 0));
        let mut sums = vec![(0.0_f64, 0.0_f64); SIDE * SIDE];
        for path in 0..DRAWS {
            let u = numbers.block(path, 0);
            let (beta, density) = guide.draw([u[0], u[1]]);
            let cell = |v: f64| (((v / 1.5 + 1.0) * 0.5 * SIDE as f64) as usize).min(SIDE - 1);
            let sum = &mut sums[cell(beta.y) * SIDE + cell(beta.x)];
            let weight = 1.0 / (density * distort.mul_add(beta.x, 1.0) * DRAWS as f64);
            *sum = (sum.0 + weight, sum.1 + weight * weight);
        }
        let area = (3.0 / SIDE as f64).powi(2);
        let whole = |k: usize| {
            let far = |k: usize| ((k as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0).abs() * 1.5 + 0.075;
            far(k % SIDE).hypot(far(k / SIDE)) < 1.5
        };
        let cells = sums.iter().enumerate().filter(|(k, _)| whole(*k));
        let z = cells.map(|(_, (sum, squares))| (sum - area).powi(2) / (squares - sum * sum / DRAWS as f64));
        let (mut statistic, mut freedom) = (0.0, 0.0);
        z.for_each(|z| (statistic, freedom) = (statistic + z, freedom + 1.0));
        papilio_testing::ChiSquare { statistic, freedom }.z()
    }

    #[test]
    fn samples_follow_density() {
        assert!(statistic(0.0).abs() < 4.5, "{}", statistic(0.0));
        assert!(statistic(0.1) > 4.5, "a wrong density must be caught: {}", statistic(0.1));
    }

    #[test]
    fn steps_are_small_at_peaks_and_never_too_many() {
        let few = nodes(1.5, &[(0.3, 0.02)], 0.05);
        let at = few.partition_point(|x| *x < 0.3);
        assert!(few[at] - few[at - 1] < 0.005 && few.len() < 80);
        assert_eq!((few[0], few[few.len() - 1]), (0.0, 1.5));
        assert!(few.windows(2).all(|pair| pair[0] < pair[1]));
        let peaks: Vec<(f64, f64)> = (0..100).map(|k| (0.015 * f64::from(k), 1e-3)).collect();
        assert!(nodes(1.5, &peaks, 0.05).len() <= MOST + 1);
    }
}

//! A scattering kernel between rings of directions, as a virtual goniometer measures it.
//!
//! **Model.** Each side has rings of directions with a middle in `|beta|²`. Light of a direction belongs to
//! the two nearest rings, in proportion to its distances from their middles in `|beta|²` (hat functions h,
//! which sum to 1), and likewise for the ring and the difference of azimuths to which it is scattered. With
//! the light L_ij that goes from ring i to ring j, and the étendue w_i of a ring,
//! `f(a, b) = sum of h_i(a) h_j(b) L_ij / (w_i w_j)`: continuous, reciprocal if L is symmetric, and of
//! exactly the total that L has. Where a kernel may jump, at the limits of total reflection, hats end: rings
//! do not reach across the ends of their segment.
//!
//! **Along the normal** there is no azimuth: from the middle of the innermost ring inwards, the dependence on
//! azimuth decreases to none, in proportion to `|beta|`.
//!
//! **Resolution.** Features narrower than a ring are widened to it.

use std::f64::consts::PI;

use crate::Beta;

/// Rings of directions on one side: middles and segments in `|beta|²`.
#[derive(Debug, Clone, PartialEq)]
pub struct Rings {
    /// Edges of the rings, `|beta|`, ascending from 0.
    edges: Vec<f64>,
    /// Middles, `|beta|²`.
    middles: Vec<f64>,
    /// First ring of the segment of each ring, and the ring behind its last one.
    segments: Vec<[usize; 2]>,
    /// Étendue of each hat.
    weights: Vec<f64>,
}

impl Rings {
    /// Rings between these `|beta|`, ascending from 0, in segments that end at these `limits`.
    pub fn new(edges: &[f64], limits: &[f64]) -> Self {
        let square = |edge: f64| edge * edge;
        let middles: Vec<f64> =
            edges.windows(2).map(|pair| 0.5 * (square(pair[0]) + square(pair[1]))).collect();
        let is_limit = |edge: f64| limits.iter().any(|limit| (limit - edge).abs() < 1e-9 * limit);
        let count = middles.len();
        let mut starts: Vec<usize> = (0..count).filter(|&ring| ring == 0 || is_limit(edges[ring])).collect();
        starts.push(count);
        let segments: Vec<[usize; 2]> = starts
            .windows(2)
            .flat_map(|pair| std::iter::repeat_n([pair[0], pair[1]], pair[1] - pair[0]))
            .collect();
        let weight = |ring: usize| {
            let [first, end] = segments[ring];
            let below = match ring == first {
                true => middles[ring] - square(edges[ring]),
                false => 0.5 * (middles[ring] - middles[ring - 1]),
            };
            let above = match ring + 1 == end {
                true => square(edges[ring + 1]) - middles[ring],
                false => 0.5 * (middles[ring + 1] - middles[ring]),
            };
            PI * (below + above)
        };
        let weights = (0..count).map(weight).collect();
        Self { edges: edges.to_vec(), middles, segments, weights }
    }

    /// Number of rings.
    pub fn count(&self) -> usize {
        self.middles.len()
    }

    /// Étendue of the hat of each ring.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// `|beta|` of the middle of each ring.
    pub fn middles(&self) -> impl Iterator<Item = f64> {
        self.middles.iter().map(|square| square.sqrt())
    }

    /// `|beta|` of the edge of all rings.
    pub fn radius(&self) -> f64 {
        self.edges.last().copied().unwrap_or(0.0)
    }

    /// The two rings of a `|beta|`, and the share of the second one.
    #[inline]
    pub fn of(&self, length: f64) -> ([usize; 2], f64) {
        let square = length * length;
        let ring = self.edges.partition_point(|edge| *edge <= length).clamp(1, self.count()) - 1;
        let [first, end] = self.segments[ring];
        let low = if square < self.middles[ring] { ring.saturating_sub(1).max(first) } else { ring };
        let high = (low + 1).min(end - 1);
        if square <= self.middles[low] || high == low {
            return ([low, low], 0.0);
        }
        let share = (square - self.middles[low]) / (self.middles[high] - self.middles[low]);
        ([low, high], share.clamp(0.0, 1.0))
    }

    /// How much of the dependence on azimuth light of this ring has at a `|beta|`.
    #[inline]
    fn turned(&self, ring: usize, length: f64) -> f64 {
        if ring == 0 { (length / self.middles[0].sqrt()).min(1.0) } else { 1.0 }
    }

    /// A value by ring at a `|beta|`.
    #[inline]
    pub fn at(&self, values: &[f64], length: f64) -> f64 {
        let ([low, high], share) = self.of(length);
        (1.0 - share) * values[low] + share * values[high]
    }

    /// A `|beta|` whose density per étendue is the hat of a ring, from a uniform number.
    fn sample(&self, ring: usize, u: f64) -> f64 {
        let [first, end] = self.segments[ring];
        let middle = self.middles[ring];
        let at = u * self.weights[ring] / PI;
        let (start, low) = match ring == first {
            true => {
                let start = self.edges[ring] * self.edges[ring];
                (start, middle - start)
            }
            false => (self.middles[ring - 1], 0.5 * (middle - self.middles[ring - 1])),
        };
        let square = if at < low {
            if ring == first { start + at } else { start + (2.0 * at * (middle - start)).sqrt() }
        } else if ring + 1 == end {
            middle + (at - low)
        } else {
            let next = self.middles[ring + 1];
            let left = (0.5 * (next - middle) - (at - low)).max(0.0);
            next - (2.0 * left * (next - middle)).sqrt()
        };
        square.max(0.0).sqrt().min(self.radius())
    }
}

/// A kernel between rings.
#[derive(Debug, Clone, PartialEq)]
pub struct RingKernel {
    from: Rings,
    to: Rings,
    /// Number of equal cells of the difference of azimuths from 0 to π.
    azimuths: usize,
    /// Light of each ring that goes to another ring and cell, `[from][to][azimuth]`, as shares of the light
    /// of the ring.
    shares: Vec<f64>,
    /// Running sums of the shares of each ring.
    sums: Vec<f64>,
    /// Fourier coefficients of the density between rings, `[from][to][order]`.
    series: Vec<f64>,
    /// Whether light has the same density in both directions.
    symmetric: bool,
}

/// Azimuthal orders for each cell: the coefficients of later ones are below 0.05 of those of the first.
const ORDERS_OF_CELL: usize = 2;

impl RingKernel {
    /// A kernel of these shares of the light of each ring, `[from][to][azimuth]`, in cells of equal size from
    /// 0 to π.
    pub fn new(from: Rings, to: Rings, azimuths: usize, shares: Vec<f64>) -> Self {
        let cells = to.count() * azimuths;
        let mut sums = shares.clone();
        for row in sums.chunks_exact_mut(cells) {
            let mut sum = 0.0;
            row.iter_mut().for_each(|share| {
                sum += *share;
                *share = sum;
            });
        }
        let orders = ORDERS_OF_CELL * azimuths;
        let step = PI / azimuths as f64;
        // The transform of linear interpolation between the middles of cells.
        let cosines: Vec<f64> = (0..orders)
            .flat_map(|order| {
                let half = 0.5 * order as f64 * step;
                let hat = if order == 0 { 1.0 } else { (half.sin() / half).powi(2) };
                (0..azimuths).map(move |k| hat * (order as f64 * (k as f64 + 0.5) * step).cos())
            })
            .collect();
        let mut series = vec![0.0; from.count() * to.count() * orders];
        for (pair, (series, shares)) in
            series.chunks_exact_mut(orders).zip(shares.chunks_exact(azimuths)).enumerate()
        {
            let weight = to.weights[pair % to.count()];
            for (value, cosines) in series.iter_mut().zip(cosines.chunks_exact(azimuths)) {
                *value =
                    shares.iter().zip(cosines).map(|(share, cosine)| share * cosine).sum::<f64>() / weight;
            }
        }
        let mut all = Self { from, to, azimuths, shares, sums, series, symmetric: false };
        all.symmetric = all.is_symmetric();
        all
    }

    fn is_symmetric(&self) -> bool {
        let count = self.from.count();
        let cells = |i: usize, j: usize| &self.shares[(i * count + j) * self.azimuths..][..self.azimuths];
        let weights = &self.from.weights;
        let same = |i: usize, j: usize| {
            cells(i, j).iter().zip(cells(j, i)).all(|(there, back)| {
                let (there, back) = (there * weights[i], back * weights[j]);
                (there - back).abs() <= 1e-9 * (there + back)
            })
        };
        self.from == self.to && (0..count).all(|i| (0..i).all(|j| same(i, j)))
    }

    /// Rings of incident and of scattered light.
    pub fn rings(&self) -> [&Rings; 2] {
        [&self.from, &self.to]
    }

    /// The kernel of light in the opposite direction.
    #[must_use]
    pub fn reversed(&self) -> Self {
        if self.symmetric {
            return self.clone();
        }
        let [from, to] = [self.to.count(), self.from.count()];
        let mut shares = vec![0.0; self.shares.len()];
        for (i, row) in shares.chunks_exact_mut(to * self.azimuths).enumerate() {
            for (j, cells) in row.chunks_exact_mut(self.azimuths).enumerate() {
                let there = &self.shares[(j * from + i) * self.azimuths..][..self.azimuths];
                let scale = self.from.weights[j] / self.to.weights[i];
                cells.iter_mut().zip(there).for_each(|(share, there)| *share = scale * there);
            }
        }
        Self::new(self.to.clone(), self.from.clone(), self.azimuths, shares)
    }

    /// Whether light has the same density in both directions.
    pub(super) fn is_reciprocal(&self) -> bool {
        self.symmetric
    }

    /// Fraction of the light of a `|beta|` that is scattered.
    #[inline]
    pub(super) fn albedo(&self, length: f64) -> f64 {
        let cells = self.to.count() * self.azimuths;
        let of = |ring: usize| self.sums[(ring + 1) * cells - 1];
        let ([low, high], share) = self.from.of(length);
        (1.0 - share) * of(low) + share * of(high)
    }

    /// Number of azimuthal orders that differ from 0.
    pub fn orders(&self) -> usize {
        ORDERS_OF_CELL * self.azimuths
    }

    /// The first azimuthal orders of the density between two `|beta|`: the means of the density times
    /// `cos(m phi)`.
    pub fn fourier(&self, [a, b]: [f64; 2], out: &mut [f64]) {
        out.fill(0.0);
        if a > self.from.radius() || b > self.to.radius() {
            return;
        }
        let ((i, s), (j, t)) = (self.from.of(a), self.to.of(b));
        for (i, s) in [(i[0], 1.0 - s), (i[1], s)] {
            for (j, t) in [(j[0], 1.0 - t), (j[1], t)] {
                if s * t > 0.0 {
                    let series = &self.series[(i * self.to.count() + j) * self.orders()..][..self.orders()];
                    let turned = self.from.turned(i, a) * self.to.turned(j, b);
                    for (order, (out, value)) in out.iter_mut().zip(series).enumerate() {
                        *out += s * t * value * if order == 0 { 1.0 } else { turned };
                    }
                }
            }
        }
    }

    /// Density of light scattered from one direction to another.
    #[inline]
    pub(super) fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        let across = (from.x * to.y - from.y * to.x).abs();
        let phi = across.atan2(from.x * to.x + from.y * to.y);
        // Azimuths continue as their mirror images beyond 0 and π.
        let place = phi / PI * self.azimuths as f64 - 0.5;
        let low = place.floor();
        let share = place - low;
        let cell = |k: f64| k.clamp(0.0, self.azimuths as f64 - 1.0) as usize;
        let (low, high) = (cell(low), cell(low + 1.0));
        let [a, b] = [from.length(), to.length()];
        let ((i, s), (j, t)) = (self.from.of(a), self.to.of(b));
        let mut sum = 0.0;
        for (i, s) in [(i[0], 1.0 - s), (i[1], s)] {
            for (j, t) in [(j[0], 1.0 - t), (j[1], t)] {
                if s * t > 0.0 {
                    let pair = i * self.to.count() + j;
                    let cells = &self.shares[pair * self.azimuths..][..self.azimuths];
                    let value = (1.0 - share) * cells[low] + share * cells[high];
                    let value = value * self.azimuths as f64 / self.to.weights[j];
                    let mean = self.series[pair * self.orders()];
                    let turned = self.from.turned(i, a) * self.to.turned(j, b);
                    sum += s * t * (mean + turned * (value - mean));
                }
            }
        }
        sum
    }

    /// A direction in proportion to the scattered light; `None` if there is none.
    #[inline]
    pub(super) fn sample(&self, from: Beta, u: [f64; 4]) -> Option<Beta> {
        let length = from.length();
        let albedo = self.albedo(length);
        if albedo <= 0.0 {
            return None;
        }
        let cells = self.to.count() * self.azimuths;
        let sums = |ring: usize| &self.sums[ring * cells..][..cells];
        let ([low, high], share) = self.from.of(length);
        let of_low = (1.0 - share) * sums(low)[cells - 1];
        // The ring of the light, then the ring and azimuth to which it goes.
        let at = u[0] * albedo;
        let (came, at) = if at < of_low || share == 0.0 {
            (low, at / (1.0 - share))
        } else {
            (high, (at - of_low) / share)
        };
        let row = sums(came);
        let cell =
            row.partition_point(|sum| *sum <= at).min(row.partition_point(|sum| *sum < row[cells - 1]));
        let (ring, azimuth) = (cell / self.azimuths, cell % self.azimuths);
        let turned = self.from.turned(came, length);
        let length = self.to.sample(ring, u[1]);
        let turned = turned * self.to.turned(ring, length);
        // A triangle about the middle of the cell.
        let away = if u[2] < 0.5 { (2.0 * u[2]).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u[2]).sqrt() };
        let turn = PI * (azimuth as f64 + 0.5 + away) / self.azimuths as f64;
        // One number decides both the sign and whether there is an azimuth.
        let sign = if u[3] < 0.5 { 1.0 } else { -1.0 };
        let again = (2.0 * u[3]).fract();
        let turn = sign * if again < turned { turn } else { PI * u[2] };
        let along = if from.length() > 0.0 { from.y.atan2(from.x) } else { 0.0 };
        let (sin, cos) = (along + turn).sin_cos();
        Some(Beta { x: length * cos, y: length * sin })
    }

    /// Probability density of [`Self::sample`].
    #[inline]
    pub(super) fn density(&self, from: Beta, to: Beta) -> f64 {
        let albedo = self.albedo(from.length());
        if albedo > 0.0 { self.evaluate(from, to) / albedo } else { 0.0 }
    }

    /// Width of its finest features, direction cosines: about that of the first ring.
    pub(super) fn width(&self) -> f64 {
        [&self.from, &self.to]
            .map(|rings| rings.edges[1] - rings.edges[0])
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scatter::Scatter;
    use crate::scatterer::Scatterer;

    fn kernel() -> RingKernel {
        let rings = Rings::new(&[0.0, 0.3, 0.6, 0.8, 1.0], &[1.0]);
        let wide = Rings::new(&[0.0, 0.3, 0.6, 0.8, 1.0, 1.2, 1.5], &[1.0]);
        let shares = (0..4 * 6 * 5).map(|k| 0.02 + 0.01 * f64::from(k * 7 % 11)).collect();
        RingKernel::new(rings, wide, 5, shares)
    }

    /// Hats sum to 1 and their weights to the area of the disc; samples of a hat have its mean.
    #[test]
    fn rings_share_directions() {
        let kernel = kernel();
        let [_, rings] = kernel.rings();
        let area: f64 = rings.weights().iter().sum();
        assert!((area - PI * 2.25).abs() < 1e-12);
        for ring in 0..rings.count() {
            let is_ring: Vec<f64> = (0..rings.count()).map(|k| f64::from(u8::from(k == ring))).collect();
            let steps = 20_000;
            let mean_of = |f: &dyn Fn(f64) -> f64| {
                (0..steps).map(|k| f((f64::from(k) + 0.5) / f64::from(steps))).sum::<f64>() / f64::from(steps)
            };
            // Over |beta|², in which étendue is uniform.
            let hat = |square: f64| rings.at(&is_ring, square.sqrt());
            let weight = 2.25 * PI * mean_of(&|u| hat(2.25 * u));
            assert!((weight - rings.weights()[ring]).abs() < 1e-3, "{ring}: {weight}");
            let mean = 2.25 * PI * mean_of(&|u| hat(2.25 * u) * 2.25 * u) / weight;
            let sampled = mean_of(&|u| rings.sample(ring, u).powi(2));
            assert!((mean - sampled).abs() < 2e-3, "{ring}: {mean} {sampled}");
        }
    }

    /// The light scattered to all directions is that of the table; orders are those of the density; the
    /// reverse is the reverse.
    #[test]
    fn densities_have_the_light_of_the_table() {
        let kernel = kernel();
        let [_, to] = kernel.rings();
        let (lengths, angles) = (3000, 200);
        // The second one lies within the middle of the innermost ring.
        for from in [Beta { x: 0.55, y: 0.2 }, Beta { x: 0.1, y: -0.05 }] {
            let mut sum = 0.0;
            for k in 0..lengths {
                let length = (2.25 * (f64::from(k) + 0.5) / f64::from(lengths)).sqrt();
                let mut orders = [0.0; 4];
                let mut known = [0.0; 4];
                kernel.fourier([from.length(), length], &mut known);
                for step in 0..angles {
                    let phi = 2.0 * PI * (f64::from(step) + 0.5) / f64::from(angles);
                    let along = from.y.atan2(from.x) + phi;
                    let to = Beta { x: length * along.cos(), y: length * along.sin() };
                    let value = kernel.evaluate(from, to) / f64::from(angles);
                    let cosine = |m: usize| (m as f64 * phi).cos();
                    orders.iter_mut().enumerate().for_each(|(m, order)| *order += value * cosine(m));
                }
                let close = |(a, b): (&f64, &f64)| (a - b).abs() < 2e-4;
                assert!(orders.iter().zip(&known).all(close), "{orders:?} {known:?}");
                sum += orders[0] * PI * to.radius().powi(2) / f64::from(lengths);
            }
            assert!((sum - kernel.albedo(from.length())).abs() < 1e-3, "{sum}");
        }
        let from = Beta { x: 0.55, y: 0.2 };
        let (kernel, there) = (Scatter::from(kernel), Beta { x: -0.3, y: 1.1 });
        let back = kernel.reversed().evaluate(there, from);
        assert!((kernel.evaluate(from, there) - back).abs() < 1e-12 && back > 0.0);
    }
}

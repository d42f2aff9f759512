//! Side on which light leaves that meets several microfacets.
//!
//! Heitz's random walk over microfacets (E. Heitz et al., "Multiple-Scattering Microfacet BSDFs with the
//! Smith Model", ACM Trans. Graph. 35 (4), 58 (2016)) takes place in the height within the layer of
//! microfacets and in the cosine of the direction. Instead of following random walkers, this module solves
//! for the probability of leaving above, a function of height C, cosine and sense of a ray that has just
//! left a microfacet,
//!
//! `E = (leaves above) + integral of rate(C -> C') mean over facets at C' of E(next ray)`,
//!
//! iterated on a grid until it converges. Microfacets are integrated by a product rule, rays in between by
//! closed forms over cells of height in which the mean is linear. No random numbers are used: equal
//! interfaces have equal tables.
//!
//! In exact arithmetic, the light that crosses is the same from both sides (the random walk is reciprocal);
//! on this grid the two differ by about 1e-3. [`Split::balanced`] corrects this.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Side;
use super::deficit::Rule;
use super::microfacets::{Microfacets, beyond, transmittance};
use super::multiple_scattering::Fineness;

/// Largest number of microfacets that are followed: far more than any significant light meets.
const MOST_FACETS: usize = 1000;

/// Senses on each side: incident light, and light that leaves.
const COMES: usize = 0;
const LEAVES: usize = 1;

/// Fraction of the light lost by one microfacet that returns to the side of incidence, at the [`cosine`]s of
/// the grid.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Split {
    back: [Vec<f64>; 2],
}

impl Split {
    pub(super) fn new(facets: &Microfacets, fineness: &Fineness) -> Self {
        match fineness.walk {
            WalkGrid::Fine => Self::on_heights::<25>(facets, fineness, Angles(48)),
            WalkGrid::Coarse => Self::on_heights::<13>(facets, fineness, Angles(24)),
            WalkGrid::Coarsest => Self::on_heights::<9>(facets, fineness, Angles(16)),
        }
    }

    fn on_heights<const HEIGHTS: usize>(facets: &Microfacets, fineness: &Fineness, angles: Angles) -> Self {
        let senses = rays(facets, angles);
        let scattering: Vec<Vec<f64>> =
            senses.iter().map(|ray| after_a_facet(facets, ray, fineness, angles)).collect();
        let flights: Vec<Flight<HEIGHTS>> = senses.iter().map(Flight::new).collect();
        let leaves_above = chance_above(&scattering, &flights, fineness.chance);
        let back = |side: usize| {
            let one = |angle: usize| {
                let ray = angles.number(side, COMES, angle);
                let above = flights[ray].share_above(&scattering[ray], &leaves_above, &flights, side);
                if side == 0 { above } else { 1.0 - above }.clamp(1e-6, 1.0 - 1e-6)
            };
            (0..angles.0).map(one).collect()
        };
        Self { back: [back(0), back(1)] }
    }

    /// Returns the fraction at this cosine: a cubic through the four nearest nodes.
    fn back(&self, side: Side, cosine: f64) -> f64 {
        let values = &self.back[side as usize];
        let place = Angles(values.len()).place(cosine);
        let first = (place.floor() as usize).saturating_sub(1).min(values.len() - 4);
        let x = place - first as f64;
        let term = |i: usize| {
            let others = (0..4).filter(|&j| j != i).map(|j| (x - j as f64) / (i as f64 - j as f64));
            values[first + i] * others.product::<f64>()
        };
        (0..4).map(term).sum::<f64>().clamp(1e-6, 1.0 - 1e-6)
    }

    /// Returns the parts `[BACK, ACROSS]` of the light lost by one microfacet at this cosine.
    pub(super) fn of(&self, side: Side, cosine: f64, lost: f64) -> [f64; 2] {
        let back = self.back(side, cosine);
        [back * lost, (1.0 - back) * lost]
    }

    /// Returns the same with the odds of crossing multiplied by `exp(-shift)` from above, `exp(shift)` from
    /// below.
    pub(super) fn balanced(&self, shift: f64) -> Self {
        let mut split = self.clone();
        for (back, factor) in split.back.iter_mut().zip([shift.exp(), (-shift).exp()]) {
            for share in back {
                *share = *share * factor / (*share * factor + (1.0 - *share));
            }
        }
        split
    }
}

/// Grid of the random walk: heights, and cosines of each sense on each side.
#[derive(Debug, Clone, Copy)]
pub(super) enum WalkGrid {
    /// 25 heights, 48 cosines.
    Fine,
    /// 13 heights, 24 cosines.
    Coarse,
    /// 9 heights, 16 cosines.
    Coarsest,
}

/// Number of cosines of each sense on each side.
#[derive(Debug, Clone, Copy)]
struct Angles(usize);

impl Angles {
    /// Returns the index of a ray among all: by side, sense and angle.
    fn number(self, side: usize, sense: usize, angle: usize) -> usize {
        (2 * side + sense) * self.0 + angle
    }

    /// Returns cosines to the normal of the interface, denser towards grazing directions.
    fn cosines(self) -> impl Iterator<Item = f64> {
        (0..self.0).map(move |k| {
            let v = k as f64 / (self.0 - 1) as f64;
            (FRAC_PI_2 * v.powf(1.5)).sin().clamp(1e-4, 1.0)
        })
    }

    /// Returns the position of a cosine among them.
    fn place(self, cosine: f64) -> f64 {
        (cosine.clamp(0.0, 1.0).asin() / FRAC_PI_2).cbrt().powi(2) * (self.0 - 1) as f64
    }
}

/// Returns a height of this many, 0 to 1, dense at the top and at the bottom.
fn height<const HEIGHTS: usize>(j: usize) -> f64 {
    0.5 * (1.0 - (PI * j as f64 / (HEIGHTS - 1) as f64).cos())
}

/// A ray between microfacets, on one side.
struct Ray {
    side: usize,
    sense: usize,
    /// Wave vector along the interface and away from it.
    beta: f64,
    z: f64,
    /// Smith's Lambda.
    hidden: f64,
}

fn rays(facets: &Microfacets, angles: Angles) -> Vec<Ray> {
    let mut all = Vec::with_capacity(4 * angles.0);
    for (side, of) in [Side::Above, Side::Below].into_iter().enumerate() {
        let n = facets.index(of);
        for sense in [COMES, LEAVES] {
            all.extend(angles.cosines().map(|cosine| {
                let (q, beta) = (n * cosine, n * ((1.0 - cosine) * (1.0 + cosine)).sqrt());
                let hidden = facets.hidden(q, beta * beta) / q;
                Ray { side, sense, beta, z: if sense == COMES { -q } else { q }, hidden }
            }));
        }
    }
    all
}

/// Returns the distribution of rays after a microfacet: the probability of each, by [`Angles::number`].
fn after_a_facet(facets: &Microfacets, ray: &Ray, fineness: &Fineness, angles: Angles) -> Vec<f64> {
    let rule = Rule::new(fineness.tilts);
    let mut next = vec![0.0; 4 * angles.0];
    let [n1, n2] = if ray.side == 0 { [facets.above, facets.below] } else { [facets.below, facets.above] };
    let w_of = |tilt: f64| (tilt.tan() / facets.alpha).atan();
    let cuts = [w_of(facets.alpha.sqrt().atan()), w_of(0.25 * PI)];
    for (w, weight) in rule.points(0.0, FRAC_PI_2, cuts) {
        let (sin, cos) = w.sin_cos();
        let length = cos.hypot(facets.alpha * sin);
        let (h_z, h_t) = (cos / length, facets.alpha * sin / length);
        let weight = weight * facets.distribution.slopes(w) / h_z;
        for azimuth in 0..fineness.azimuths {
            let phi = PI * (azimuth as f64 + 0.5) / fineness.azimuths as f64;
            let c1 = -(ray.beta * h_t * phi.cos() + ray.z * h_z);
            if c1 <= 0.0 {
                continue;
            }
            let c2 = beyond(c1, n1, n2);
            let passes = transmittance(c1, n1, c2, n2);
            angles.add(&mut next, ray.side, (ray.z + 2.0 * c1 * h_z) / n1, weight * c1 * (1.0 - passes));
            angles.add(&mut next, 1 - ray.side, -(ray.z + (c1 - c2) * h_z) / n2, weight * c1 * passes);
        }
    }
    let all: f64 = next.iter().sum();
    if all > 0.0 {
        next.iter_mut().for_each(|share| *share /= all);
    }
    next
}

impl Angles {
    /// Distributes a weight among the two cosines next to this one (below 0: incident light).
    fn add(self, next: &mut [f64], side: usize, cosine: f64, weight: f64) {
        let sense = if cosine > 0.0 { LEAVES } else { COMES };
        let place = self.place(cosine.abs());
        let first = (place as usize).min(self.0 - 2);
        let right = place - first as f64;
        let at = self.number(side, sense, first);
        next[at] += weight * (1.0 - right);
        next[at + 1] += weight * right;
    }
}

/// Free flight over heights, each counted towards the side of the ray.
struct Flight<const HEIGHTS: usize> {
    sense: usize,
    /// Probability of meeting no other microfacet, from each height.
    leaves: [f64; HEIGHTS],
    /// Between each height and the next: the light that passes, and the light that meets a microfacet, by the
    /// value at the lower and at the upper end.
    cells: Vec<[f64; 3]>,
}

impl<const HEIGHTS: usize> Flight<HEIGHTS> {
    fn new(ray: &Ray) -> Self {
        let rate = if ray.sense == COMES { 1.0 + ray.hidden } else { ray.hidden };
        let height = height::<HEIGHTS>;
        let cell = |j: usize| {
            let ratio = height(j) / height(j + 1);
            let passes = ratio.powf(rate);
            if ray.sense == COMES {
                let mean = rate / (rate + 1.0) * (1.0 - ratio * passes);
                let upper = (mean - ratio * (1.0 - passes)) / (1.0 - ratio);
                return [passes, 1.0 - passes - upper, upper];
            }
            if ratio == 0.0 {
                return [0.0, 1.0, 0.0];
            }
            // (1 - ratio^(rate - 1))/(rate - 1)
            let (less, log) = (rate - 1.0, ratio.ln());
            let mean = if (less * log).abs() < 1e-8 { -log } else { -(less * log).exp_m1() / less };
            let upper = (rate * mean - (1.0 - passes)) / (1.0 / ratio - 1.0);
            [passes, 1.0 - passes - upper, upper]
        };
        let leaves = |j: usize| match (ray.sense, j) {
            (COMES, _) => 0.0,
            // So that the lowest cell, which is linear, has the right integral: at the bottom itself light
            // never leaves, but very close to it nearly all light does if Lambda is small.
            (_, 0) => height(1).powf(rate) * ((1.0 - rate) / (1.0 + rate)).max(0.0),
            _ => height(j).powf(rate),
        };
        Self {
            sense: ray.sense,
            leaves: std::array::from_fn(leaves),
            cells: (0..HEIGHTS - 1).map(cell).collect(),
        }
    }

    /// Sets the expected value of light at each height, given that `after` a microfacet met at each.
    fn set(&self, ahead: &mut [f64; HEIGHTS], at_top: f64, after: &[f64; HEIGHTS]) {
        if self.sense == COMES {
            ahead[0] = after[0];
            for (j, [passes, lower, upper]) in self.cells.iter().enumerate() {
                ahead[j + 1] = passes * ahead[j] + lower * after[j] + upper * after[j + 1];
            }
        } else {
            ahead[HEIGHTS - 1] = at_top;
            for (j, [passes, lower, upper]) in self.cells.iter().enumerate().rev() {
                ahead[j] = passes * ahead[j + 1] + lower * after[j] + upper * after[j + 1];
            }
            // At the bottom, light that does not leave meets the same as from the next height.
            let [bottom, next] = [self.leaves[0], self.leaves[1]];
            let meets = if next < 1.0 { (ahead[1] - next * at_top) / (1.0 - next) } else { 0.0 };
            ahead[0] = bottom * at_top + (1.0 - bottom) * meets;
        }
    }

    /// Returns the fraction, of incident light that meets more than one microfacet, that leaves above.
    fn share_above(&self, next: &[f64], above: &[[f64; HEIGHTS]], flights: &[Self], side: usize) -> f64 {
        let [mut to_above, mut all] = [[0.0; HEIGHTS]; 2];
        for (ray, chance) in next.iter().enumerate().filter(|(_, chance)| **chance > 0.0) {
            let to = 2 * ray / next.len();
            for j in 0..HEIGHTS {
                let own = if to == side { j } else { HEIGHTS - 1 - j };
                let leaves = flights[ray].leaves[own];
                all[j] += chance * (1.0 - leaves);
                to_above[j] += chance * (above[ray][own] - if to == 0 { leaves } else { 0.0 });
            }
        }
        let [to_above, all] = [to_above, all].map(|after| {
            let mut ahead = [0.0; HEIGHTS];
            self.set(&mut ahead, 0.0, &after);
            ahead[HEIGHTS - 1]
        });
        if all > 0.0 { to_above / all } else { 0.5 }
    }
}

/// Returns the probability of leaving above, of each ray that has just left a microfacet at each height (of
/// its own side), to this error.
fn chance_above<const HEIGHTS: usize>(
    scattering: &[Vec<f64>],
    flights: &[Flight<HEIGHTS>],
    error: f64,
) -> Vec<[f64; HEIGHTS]> {
    let mut above = vec![[0.5; HEIGHTS]; flights.len()];
    for _ in 0..MOST_FACETS {
        let mut change = 0.0_f64;
        // All values are computed from the previous ones: the order must not matter.
        let before = above.clone();
        for (ray, (flight, next)) in flights.iter().zip(scattering).enumerate() {
            let side = 2 * ray / flights.len();
            let mut after = [0.0; HEIGHTS];
            for (to, (values, chance)) in before.iter().zip(next).enumerate() {
                if 2 * to / flights.len() == side {
                    after.iter_mut().zip(values).for_each(|(sum, value)| *sum += chance * value);
                } else {
                    after.iter_mut().zip(values.iter().rev()).for_each(|(sum, value)| *sum += chance * value);
                }
            }
            let at_top = if side == 0 { 1.0 } else { 0.0 };
            flight.set(&mut above[ray], at_top, &after);
        }
        for (new, old) in above.iter().flatten().zip(before.iter().flatten()) {
            change = change.max((new - old).abs());
        }
        if change < error {
            break;
        }
    }
    above
}

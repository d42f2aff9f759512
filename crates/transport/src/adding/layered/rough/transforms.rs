//! Fourier coefficients over the azimuth of the kernel of one microfacet.
//!
//! The trapezoid rule converges exponentially: n intervals over a half turn leave `exp(-2 n y)` if the kernel
//! is analytic within y of the real azimuths. At a given pair of `|beta|` = a, b only the slope
//! `|beta_o - beta_i|/z` of the microfacet depends on the azimuth, z the change of the wave vector along the
//! normal of the interface. GGX slopes have a double pole at the slope `i alpha`: `cosh y = 1 + ((a - b)^2 +
//! (alpha z)^2)/(2 a b)`. A pair of nodes off the diagonal a = b thus needs few azimuths, the fewer as its
//! values are smaller by the fourth power of the same distance. Gaussian slopes have no pole: their order m
//! is `exp(-(m alpha z)^2/(4 a b))`, and their values decrease as `exp(-((a - b)/(alpha z))^2)`. Student's
//! slopes have a branch point of the power gamma at `i alpha sqrt(gamma - 1)`, before which the rule may stop.

use std::f64::consts::PI;

use papilio_optics::rough::{Distribution, Rough, Side};

use super::super::azimuth::{graded, rounded_up};
use super::super::grid::Grid;
use super::super::matrix::Matrix;
use super::Edge;
use crate::layers::rough_width;

/// Largest number of azimuthal orders.
const MOST_ORDERS: usize = 400;
/// Number of rules: up to 512 intervals.
const RULES: usize = 13;
/// Natural digits of azimuths beyond those of the nodes: poles are double, so that digits are lost.
const MORE_DIGITS: f64 = 5.0;
/// The same of orders, which contribute with equal or alternating signs in the mirror directions of a beam.
const MORE_DIGITS_OF_ORDERS: f64 = 10.0;
/// Smallest number of natural digits of a pair, however small its values are.
const LEAST_DIGITS: f64 = 4.0;

/// Fractions of the square of the distance of a branch point at which the number of intervals is tried.
const BRANCH: [f64; 5] = [0.95, 0.8, 0.6, 0.35, 0.15];

/// Smallest number of intervals, per natural digit.
const LEAST_INTERVALS: f64 = 3.0;

/// Returns the number of intervals of a rule from 0 to pi, 8, 12, 16, 24, 32, ...: few rules, so that pairs
/// of directions share them, and their sums are matrix products.
fn intervals(rule: usize) -> usize {
    (if rule.is_multiple_of(2) { 8 } else { 12 }) << (rule / 2)
}

/// Returns the number of orders that contain this many natural digits of the light scattered on circles of
/// this `|beta|`.
pub(super) fn orders(face: &Rough, radius: f64, digits: f64) -> usize {
    rounded_up(((digits + MORE_DIGITS_OF_ORDERS) * radius / rough_width(face)).ceil() as usize)
        .min(MOST_ORDERS)
}

/// First Fourier coefficients of one microfacet's kernel.
pub(super) struct Transforms {
    orders: usize,
    digits: f64,
    /// By rule: `[order, azimuth]`.
    cosines: Vec<Option<Matrix>>,
}

impl Transforms {
    pub(super) fn new(orders: usize, digits: f64) -> Self {
        Self { orders, digits, cosines: vec![None; RULES] }
    }

    /// Returns the natural digits of the coefficients.
    pub(super) fn digits(&self) -> f64 {
        self.digits
    }

    /// Computes coefficients of the kernel from one direction to the nodes `rows` on the side `to`: for each
    /// of them as many as are not negligible.
    pub(super) fn column(
        &mut self,
        face: &Rough,
        (from, j): (Side, usize),
        to: Side,
        rows: impl Iterator<Item = usize>,
        (grid, edge): (&Grid, &Edge),
    ) -> Vec<(usize, Vec<f64>)> {
        let a = grid.beta[j];
        let rows = rows.filter(|i| from == to || edge.lit(j, *i) != 0.0);
        let within = |i: usize| if from == to { grid.beta[i] } else { edge.within(a, grid.beta[i]) };
        let rows: Vec<_> = rows.map(|i| (i, within(i))).collect();
        self.between(face, (from, a), to, rows)
    }

    /// Computes coefficients from light of one `|beta|` to others on the side `to`, each with a number that
    /// it keeps; in any order.
    pub(super) fn between(
        &mut self,
        face: &Rough,
        (from, a): (Side, f64),
        to: Side,
        rows: Vec<(usize, f64)>,
    ) -> Vec<(usize, Vec<f64>)> {
        let mut of_rule = vec![Vec::new(); RULES];
        let mut all = Vec::new();
        for (i, b) in rows {
            let ends = [(from, a), (to, b)];
            match rule(face, ends, self.digits) {
                Some(rule) => of_rule[rule].push((i, b)),
                None => {
                    let mut values = vec![0.0; self.orders];
                    let kernel = face.single_by_azimuth(ends[0], ends[1]);
                    graded(azimuth_width(face, ends), &mut values, |turn| kernel(turn.cos()));
                    all.push((i, values));
                }
            }
        }
        for (rule, rows) in of_rule.into_iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
            let half = intervals(rule);
            let turns: Vec<f64> = (0..=half).map(|k| (PI * k as f64 / half as f64).cos()).collect();
            let pairs: Vec<_> =
                rows.iter().map(|&(_, b)| face.single_by_azimuth((from, a), (to, b))).collect();
            let values = Matrix::from_fn(half + 1, rows.len(), |k, row| pairs[row](turns[k]));
            let mut sums = Matrix::zeros(self.orders.min(half + 1), rows.len());
            sums.add_product(self.cosines(rule), &values, half + 1);
            all.extend(rows.iter().enumerate().map(|(row, &(i, _))| (i, sums.column(row).to_vec())));
        }
        all
    }

    /// Returns weights times cosines of a rule, up to the last order that it does not alias with a lower one.
    fn cosines(&mut self, rule: usize) -> &Matrix {
        let (half, orders) = (intervals(rule), self.orders);
        self.cosines[rule].get_or_insert_with(|| {
            let weight = |k: usize| if k == 0 || k == half { 0.5 } else { 1.0 } / half as f64;
            let turn: Vec<f64> = (0..2 * half).map(|k| (PI * k as f64 / half as f64).cos()).collect();
            Matrix::from_fn(orders.min(half + 1), half + 1, |m, k| weight(k) * turn[m * k % (2 * half)])
        })
    }
}

/// Returns the change of the wave vector's component along the normal of the interface.
fn normal_change(face: &Rough, [(from, a), (to, b)]: [(Side, f64); 2]) -> f64 {
    let normal = |side: Side, beta: f64| (face.index(side).powi(2) - beta * beta).max(0.0).sqrt();
    let (q_a, q_b) = (normal(from, a), normal(to, b));
    if from == to { q_a + q_b } else { (q_a - q_b).abs() }
}

/// Returns the kernel's width in azimuth: alpha times the change of the wave vector's component along the
/// normal, over the radius.
pub(in super::super) fn azimuth_width(face: &Rough, ends @ [(_, a), (_, b)]: [(Side, f64); 2]) -> f64 {
    (face.alpha() * normal_change(face, ends) / (a * b).sqrt().max(1e-9)).max(1e-9)
}

/// Returns the rule for a pair of directions; `None` if there would be too many intervals.
fn rule(face: &Rough, ends @ [(from, a), (to, b)]: [(Side, f64); 2], digits: f64) -> Option<usize> {
    let least = LEAST_INTERVALS * digits;
    let digits = digits + MORE_DIGITS;
    let own = face.alpha() * normal_change(face, ends);
    // The largest values near these directions, a = b.
    let peak = |beta: f64| face.alpha() * normal_change(face, [(from, beta), (to, beta)]);
    let peak = peak(a).max(peak(b));
    let (apart, radius) = ((a - b).abs(), (a * b).sqrt().max(1e-9));
    let half = match face.distribution() {
        Distribution::Ggx => {
            let distance = own.hypot(apart);
            let digits = digits - 4.0 * (distance / peak).max(1.0).ln();
            digits.max(LEAST_DIGITS) / (2.0 * (0.5 * distance / radius).asinh())
        }
        Distribution::Beckmann => {
            let digits = digits - (apart / own.max(1e-9)).powi(2);
            2.0 * digits.max(LEAST_DIGITS).sqrt() * radius / own.max(1e-9)
        }
        Distribution::StudentT { tail } => {
            let core = (tail - 1.0).sqrt();
            let distance = (core * own).hypot(apart);
            let digits = digits - 2.0 * tail * (distance / (core * peak)).max(1.0).ln();
            // At the fraction x of the square of the distance, the kernel is larger by (1 - x)^-gamma.
            let at = |x: f64| {
                let digits = digits.max(LEAST_DIGITS) - tail * (1.0 - x).ln();
                digits / (2.0 * (0.5 * x.sqrt() * distance / radius).asinh())
            };
            BRANCH.map(at).into_iter().fold(f64::INFINITY, f64::min)
        }
    };
    // Where light is refracted along the interface, and at the critical angle, the kernel is not analytic.
    (0..RULES).find(|rule| intervals(*rule) as f64 >= half.max(least))
}

#[cfg(test)]
mod tests {
    use super::super::super::azimuth::trapezoid;
    use super::super::super::grid::Density;
    use super::super::super::splits::Splits;
    use super::*;

    /// Compared with a rule of many intervals, relative to the largest value of order 0. Reflection from the
    /// denser medium has a square root at the critical angle: there, errors decrease slowly, and have either
    /// sign.
    #[test]
    fn few_azimuths_give_the_coefficients_of_many() {
        let digits = 7.0;
        use Distribution::{Beckmann, Ggx};
        let [heavy, light] = [2.5, 12.0].map(|tail| Distribution::StudentT { tail });
        let faces = [
            (Ggx, 0.1),
            (heavy, 0.2),
            (Beckmann, 0.4),
            (light, 0.1),
            (Ggx, 0.4),
            (Beckmann, 0.1),
            (light, 0.4),
        ];
        for (distribution, alpha) in papilio_testing::everyday(4, faces) {
            let face = Rough::with(distribution, alpha, 1.0, 1.5);
            let density = Density { least: 6, spacing: 0.3, angle: None };
            let grid = Grid::new(&Splits::at(&[1.0, 1.5]), density, &[0.3]);
            let (mut transforms, edge) = (Transforms::new(24, digits), Edge::new(&face, &grid));
            for (from, to) in
                [(Side::Above, Side::Above), (Side::Above, Side::Below), (Side::Below, Side::Below)]
            {
                let (mut most, mut worst) = (0.0_f64, 0.0_f64);
                for j in (0..grid.len()).filter(|&j| grid.beta[j] < face.index(from)) {
                    let rows = (0..grid.len()).filter(|&i| grid.beta[i] < face.index(to));
                    for (i, values) in transforms.column(&face, (from, j), to, rows, (&grid, &edge)) {
                        let b =
                            if from == to { grid.beta[i] } else { edge.within(grid.beta[j], grid.beta[i]) };
                        let kernel = face.single_by_azimuth((from, grid.beta[j]), (to, b));
                        let mut fine = [0.0; 24];
                        trapezoid(4096, &mut fine, |turn| kernel(turn.cos()));
                        most = most.max(fine[0]);
                        let errors = fine
                            .iter()
                            .enumerate()
                            .map(|(m, fine)| (fine - values.get(m).unwrap_or(&0.0)).abs());
                        worst = errors.fold(worst, f64::max);
                    }
                }
                let tolerance = if from == Side::Below { 2e-2 } else { 1e-4 };
                assert!(
                    worst < tolerance * most,
                    "{distribution:?} {alpha} {from:?} {to:?}: {worst:e} {most:e}"
                );
            }
        }
    }
}

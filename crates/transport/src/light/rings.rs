//! A field of light as weighted directions.
//!
//! The response of a view to the direction of light is smooth, except for a peak of known width in the
//! view's mirror direction. A field is rough, down to its cells. Therefore the response of the view is
//! interpolated (product integration): over inclination by polynomials on panels graded around the peaks,
//! over azimuth by trigonometric polynomials. The weights of their nodes are integrals of the field: exact
//! ones for cells and for pixels in rows of inclination; for other pixels, sums over directions
//! ([`super::gathered`]); for a formula, by rules that take into account where it is not smooth
//! ([`Formula`]). The number of directions is that of the smooth response, however many cells
//! there are; weights may be negative.

use std::f64::consts::{FRAC_PI_2, TAU};

use num_complex::Complex64;
use papilio_fourier::Circle;
use papilio_optics::Beta;

use super::field::Light;
use super::formula::Formula;
use super::gathered::{self, Split, Spot, lagrange};
use crate::light::cone_points::Point;
use crate::numerics::quadrature::{Node, Pole, gauss, legendre, panels, points_for};
use crate::{Cone, Field};

/// Directions about which the response changes fast.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peaks<'a> {
    /// Mirror directions of these views ...
    pub(crate) views: &'a [Cone],
    /// ... and the size of the peaks, direction cosines.
    pub(crate) width: f64,
}

/// Light of a field that is represented at one inclination; the weights of all rings sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ring {
    /// `|beta|`.
    pub(crate) radius: f64,
    /// Integrals of the light times `exp(-i m phi)`, real and imaginary parts, for m = 0 and on; phi is the
    /// azimuth from which light comes. Light of more azimuthal orders is not needed, or there is none.
    harmonics: Vec<[f64; 2]>,
    /// Largest azimuthal order of functions of which the ring gives the integral.
    orders: usize,
}

impl Ring {
    /// Returns light that propagates from directions uniformly spaced in azimuth from 0.
    pub(crate) fn points(&self) -> impl Iterator<Item = Point> {
        let weights = around(&self.harmonics, self.orders);
        let step = TAU / weights.len() as f64;
        weights.into_iter().enumerate().map(move |(k, weight)| {
            let (sin, cos) = (k as f64 * step).sin_cos();
            Point { beta: Beta { x: -self.radius * cos, y: -self.radius * sin }, weight }
        })
    }

    /// Returns its total weight.
    pub(crate) fn weight(&self) -> f64 {
        self.harmonics[0][0]
    }

    /// Returns the integrals of the light times `cos m psi` (or `sin m psi` if `odd`), with psi the azimuth
    /// in which it propagates: of the part that is the same (or opposite) at azimuths of opposite sign.
    pub(crate) fn part(&self, odd: bool) -> Vec<f64> {
        let order = |(m, [re, im]): (usize, &[f64; 2])| {
            let sign = if m % 2 == 0 { 1.0 } else { -1.0 };
            sign * if odd { -im } else { *re }
        };
        self.harmonics.iter().enumerate().map(order).collect()
    }
}

/// Returns the rings of the field; without views, for functions without peaks.
pub(crate) fn rings(field: &Field, peaks: Peaks<'_>, digits: f64) -> Vec<Ring> {
    let light = field.light();
    let span = match &light {
        Light::Cells(lit) => {
            lit.rows.first().zip(lit.rows.last()).map(|(first, last)| [first.0[0], last.0[1]])
        }
        Light::Formula(formula, _) => Some(formula.span()),
        Light::Pixels(pixels, _, None) => pixels.lit_above(),
        Light::Pixels(.., Some(gathered)) => gathered.span(),
    };
    let Some([from, to]) = span else { return Vec::new() };
    let split = match &light {
        Light::Pixels(pixels, scale, Some(gathered)) => Some(gathered.split(pixels, *scale, peaks, digits)),
        _ => None,
    };
    let mut transforms = Transforms::default();
    let centres: Vec<f64> = peaks.views.iter().flat_map(|view| radii(view, peaks.width)).collect();
    let mut poles: Vec<Pole> = Vec::new();
    for pole in centres.iter().map(|at| Pole { at: *at, off: peaks.width }.in_arc(1.0)) {
        if !poles.iter().any(|known| (known.at - pole.at).abs() < 0.25 * pole.off) {
            poles.push(pole);
        }
    }
    let mut rings = Vec::new();
    panels(from, to, &[], &poles, &mut |from, to, ellipse: f64| {
        let panel = Panel::new(from, to, points_for(digits, ellipse.ln()) + MORE_NODES);
        let radii = || panel.nodes.iter().map(|angle| angle.sin());
        let orders: Vec<usize> =
            radii().map(|radius| orders(radius, &centres, peaks.width, digits)).collect();
        let harmonics = match (&light, &split) {
            (Light::Cells(lit), _) => {
                let columns = lit.rows.first().map_or(0, |row| row.1.len());
                let sums = panel.columns(columns, 1.0, lit.rows.iter().map(|(edges, row)| (*edges, *row)));
                transforms.of_columns(&sums, lit.turn, &orders)
            }
            (Light::Pixels(pixels, scale, _), None) => {
                let sums = panel.columns(pixels.columns, *scale, pixels.rows_within([from, to], false));
                transforms.of_columns(&sums, pixels.azimuth(), &orders)
            }
            (Light::Pixels(..), Some(split)) => panel.of_points(split, &orders, &mut transforms),
            (Light::Formula(formula, scale), _) => panel.harmonics(formula, *scale, &orders, digits),
        };
        for ((radius, mut harmonics), orders) in radii().zip(harmonics).zip(orders) {
            harmonics.truncate(orders + 1);
            rings.push(Ring { radius, harmonics, orders });
        }
    });
    rings
}

/// Nodes in addition to those that the digits require: the error of a rule that does not grow from level to
/// level is unknown.
const MORE_NODES: usize = 2;

/// Returns values of `|beta|` in a field of view, from its inner to its outer rim, as dense as peaks are
/// wide.
pub(crate) fn radii(view: &Cone, width: f64) -> impl Iterator<Item = f64> {
    let (axis, half) = (view.axis_towards().length().min(1.0).asin(), view.half_angle());
    let steps = (2.0 * half / width).ceil().min(64.0);
    (0..=steps as usize).map(move |k| {
        let along = if steps > 0.0 { 2.0 * k as f64 / steps - 1.0 } else { 0.0 };
        (axis + along * half).abs().min(FRAC_PI_2).sin()
    })
}

/// Returns the number of azimuthal orders of peaks at these radii, seen at another.
fn orders(radius: f64, centres: &[f64], width: f64, digits: f64) -> usize {
    // A pole at this distance from the real line has orders that decrease as `exp(-off m)`.
    let off = |centre: &f64| {
        let excess = ((radius - centre).powi(2) + width * width) / (2.0 * radius * centre).max(1e-300);
        2.0 * (0.5 * excess).sqrt().asinh()
    };
    let least = centres.iter().map(off).fold(f64::INFINITY, f64::min);
    (digits / least).ceil().clamp(LEAST_ORDERS, MOST_ORDERS) as usize
}

/// Smallest and largest number of orders.
const LEAST_ORDERS: f64 = 2.0;
const MOST_ORDERS: f64 = 4000.0;

/// A panel of inclinations with the nodes of a polynomial.
struct Panel {
    from: f64,
    to: f64,
    nodes: Vec<f64>,
    /// Scales of the barycentric formula (Berrut & Trefethen 2004).
    scales: Vec<f64>,
}

impl Panel {
    fn new(from: f64, to: f64, count: usize) -> Self {
        let rule = legendre(count);
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let scale = |(k, node): (usize, &Node)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            sign * ((1.0 - node.x * node.x) * node.weight).sqrt()
        };
        Self {
            from,
            to,
            nodes: rule.iter().map(|node| middle + half * node.x).collect(),
            scales: rule.iter().enumerate().map(scale).collect(),
        }
    }

    /// Returns for each node the light, times a factor, of rows that are uniform between two inclinations, by
    /// column.
    fn columns<R: AsRef<[f64]>>(
        &self,
        columns: usize,
        scale: f64,
        rows: impl Iterator<Item = ([f64; 2], R)>,
    ) -> Vec<Vec<f64>> {
        let width = TAU / columns.max(1) as f64;
        let mut sums = vec![vec![0.0; columns]; self.nodes.len()];
        for ([start, end], row) in rows {
            let (from, to) = (start.max(self.from), end.min(self.to));
            if from < to {
                for (sum, moment) in sums.iter_mut().zip(self.moments(from, to)) {
                    add(sum, row.as_ref(), scale * moment * width);
                }
            }
        }
        sums
    }

    /// Returns for each node the harmonics, up to its azimuthal orders, of light from single directions.
    fn of_points(
        &self,
        split: &Split<'_>,
        orders: &[usize],
        transforms: &mut Transforms,
    ) -> Vec<Vec<[f64; 2]>> {
        let mut sums = vec![vec![0.0; gathered::COLUMNS]; self.nodes.len()];
        for (angle, row) in split.rows(self.from, self.to) {
            for (sum, value) in sums.iter_mut().zip(self.values(angle)) {
                add(sum, row, value);
            }
        }
        // Points in the middles of columns; finer waves than their distance are those of points of their own.
        let mut harmonics = transforms.of_points(&sums, 0.5, orders);
        let points = split.points(self.from, self.to);
        if !points.is_empty() {
            let near = transforms.of_points(&self.around(points, orders), 0.0, orders);
            for (all, near) in harmonics.iter_mut().flatten().zip(near.iter().flatten()) {
                all[0] += near[0];
                all[1] += near[1];
            }
        }
        harmonics
    }

    /// Returns for each node the light of these points, distributed among azimuths so close together that
    /// waves of these orders keep their integrals.
    fn around(&self, points: &[Spot], orders: &[usize]) -> Vec<Vec<f64>> {
        let most = orders.iter().copied().max().unwrap_or(0);
        let count = (AZIMUTHS_PER_WAVE * (most + 1)).next_power_of_two().max(64);
        let mut sums = vec![vec![0.0; count]; self.nodes.len()];
        for spot in points {
            let along = spot.phi.rem_euclid(TAU) / TAU * count as f64;
            let first = along.floor() + (count - 2) as f64;
            let weights: [f64; 6] = lagrange(along - along.floor() + 2.0);
            for (sum, value) in sums.iter_mut().zip(self.values(spot.theta)) {
                for (k, weight) in weights.iter().enumerate() {
                    sum[(first as usize + k) % count] += spot.light * value * weight;
                }
            }
        }
        sums
    }

    /// Returns for each node the harmonics, up to its azimuthal orders, of its light.
    fn harmonics(&self, formula: &Formula, scale: f64, orders: &[usize], digits: f64) -> Vec<Vec<[f64; 2]>> {
        let most = orders.iter().copied().max().unwrap_or(0);
        let mut sums = vec![vec![[0.0; 2]; most + 1]; self.nodes.len()];
        for node in formula.over_angle(self.from, self.to, digits, self.nodes.len() as f64) {
            let light = formula.harmonics(node.x, digits, most);
            let area = scale * node.weight * node.x.sin() * node.x.cos();
            for (sum, value) in sums.iter_mut().zip(self.values(node.x)) {
                for (sum, light) in sum.iter_mut().zip(&light) {
                    sum[0] += value * area * light[0];
                    sum[1] += value * area * light[1];
                }
            }
        }
        sums
    }

    /// Returns the polynomial of each node at this angle.
    fn values(&self, angle: f64) -> Vec<f64> {
        let mut terms: Vec<f64> =
            self.nodes.iter().zip(&self.scales).map(|(at, scale)| scale / (angle - at)).collect();
        if let Some(hit) = terms.iter().position(|term| !term.is_finite()) {
            terms.fill(0.0);
            terms[hit] = 1.0;
            return terms;
        }
        let all: f64 = terms.iter().sum();
        terms.iter_mut().for_each(|term| *term /= all);
        terms
    }

    /// Returns the integrals of each node's polynomial over a part of the panel, by area of direction
    /// cosines.
    fn moments(&self, from: f64, to: f64) -> Vec<f64> {
        let share = (to - from) / (self.to - self.from);
        let count = 3 + (share * 0.5 * self.nodes.len() as f64).ceil() as usize;
        let mut sums = vec![0.0; self.nodes.len()];
        for node in gauss(from, to, count) {
            let area = node.weight * node.x.sin() * node.x.cos();
            sums.iter_mut().zip(self.values(node.x)).for_each(|(sum, value)| *sum += area * value);
        }
        sums
    }
}

/// Azimuths among which the light of a point is distributed, per wave of the highest order.
const AZIMUTHS_PER_WAVE: usize = 8;

/// Adds a multiple of a row.
fn add(sum: &mut [f64], row: &[f64], factor: f64) {
    sum.iter_mut().zip(row).for_each(|(sum, value)| *sum += factor * value);
}

/// Fourier series over azimuth: integrals of `exp(-i m phi)`, real and imaginary parts, by node, up to the
/// orders of each.
#[derive(Default)]
struct Transforms {
    /// By their number of steps.
    circles: Vec<(usize, Circle)>,
}

impl Transforms {
    /// Returns those of light that is uniform within columns, of which the first begins at this azimuth.
    fn of_columns(&mut self, sums: &[Vec<f64>], turn: f64, orders: &[usize]) -> Vec<Vec<[f64; 2]>> {
        let of = |(columns, orders): (&Vec<f64>, &usize)| {
            let parts = columns.len();
            let whole = [columns.iter().sum(), 0.0];
            if parts == 1 {
                return vec![whole];
            }
            let step = TAU / parts as f64;
            let waves = self.waves(columns);
            let of = |m: usize| {
                // Mean over a column.
                let half = 0.5 * step * m as f64;
                turned(waves[m % parts] * (half.sin() / half), m, turn + 0.5 * step)
            };
            std::iter::once(whole).chain((1..=*orders).map(of)).collect()
        };
        sums.iter().zip(orders).map(of).collect()
    }

    /// Returns those of light from single azimuths, of which the first is at this fraction of their distance.
    /// They have no waves shorter than two distances.
    fn of_points(&mut self, sums: &[Vec<f64>], first: f64, orders: &[usize]) -> Vec<Vec<[f64; 2]>> {
        let of = |(points, orders): (&Vec<f64>, &usize)| {
            let (count, waves) = (points.len(), self.waves(points));
            let of = |m: usize| {
                let wave = if 2 * m < count { waves[m] } else { Complex64::ZERO };
                turned(wave, m, first * TAU / count as f64)
            };
            (0..=*orders).map(of).collect()
        };
        sums.iter().zip(orders).map(of).collect()
    }

    /// Returns the sums of `value exp(-2 pi i m k / count)` over all k, for each m.
    fn waves(&mut self, values: &[f64]) -> Vec<Complex64> {
        let count = values.len();
        let known = self.circles.iter().position(|(steps, _)| *steps == count).unwrap_or_else(|| {
            self.circles.push((count, Circle::new(count)));
            self.circles.len() - 1
        });
        let mut waves: Vec<Complex64> = values.iter().map(|value| Complex64::from(*value)).collect();
        self.circles[known].1.orders(&mut waves);
        waves
    }
}

/// Returns a wave of this order times `exp(-i m azimuth)`.
fn turned(wave: Complex64, order: usize, azimuth: f64) -> [f64; 2] {
    let turned = wave * Complex64::cis(-(order as f64) * azimuth);
    [turned.re, turned.im]
}

/// Returns weights of `2 orders + 1` azimuths that represent light of these harmonics, exact for functions
/// of at most these orders.
fn around(harmonics: &[[f64; 2]], orders: usize) -> Vec<f64> {
    let count = 2 * orders + 1;
    let mut weights = vec![harmonics[0][0] / count as f64; count];
    let steps = circle(count);
    for (m, [re, im]) in harmonics.iter().enumerate().take(orders + 1).skip(1) {
        for (k, weight) in weights.iter_mut().enumerate() {
            let [c, s] = steps[m * k % count];
            *weight += 2.0 / count as f64 * (re * c - im * s);
        }
    }
    weights
}

/// Returns cosine and sine of equal parts of a turn.
fn circle(parts: usize) -> Vec<[f64; 2]> {
    let of = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / parts as f64).sin_cos();
        [cos, sin]
    };
    (0..parts).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rough field is compared with the sum over its cells, each by a fine rule, for a lobe whose peak
    /// lies among them.
    #[test]
    fn directions_represent_rough_field() {
        let (rows, columns) = (18, 24);
        let edges: Vec<f64> = (0..=rows).map(|k| 90.0 * k as f64 / rows as f64).collect();
        let radiance: Vec<f64> = (0..rows * columns).map(|k| ((k * k * 7919 + k) % 101) as f64).collect();
        let (field, _) = Field::new(&edges, columns, radiance).unwrap();
        let view = Cone::new(23.0, 40.0, 0.1, 1.0);
        let centre = -view.mirrored().axis_towards();
        let width = 0.1;
        let lobe = |beta: Beta| width / (width * width + (beta + centre).squared()).powf(1.5);
        let mut truth = 0.0;
        let Light::Cells(lit) = field.light() else { unreachable!("these are cells") };
        for ([from, to], row) in lit.rows {
            for (column, value) in row.iter().enumerate() {
                let step = TAU / columns as f64;
                for theta in gauss(from, to, 8) {
                    for phi in gauss(column as f64 * step, (column + 1) as f64 * step, 8) {
                        let (sin, cos) = theta.x.sin_cos();
                        let beta = Beta { x: -sin * phi.x.cos(), y: -sin * phi.x.sin() };
                        truth += value * sin * cos * theta.weight * phi.weight * lobe(beta);
                    }
                }
            }
        }
        let seen = |digits: f64| {
            let rings = rings(&field, Peaks { views: &[view], width }, digits);
            let sum: f64 = rings.iter().map(Ring::weight).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{sum}");
            rings.iter().flat_map(Ring::points).map(|point| point.weight * lobe(point.beta)).sum::<f64>()
        };
        for digits in [6.0_f64, 9.0, 12.0] {
            let error = (seen(digits) / truth - 1.0).abs();
            assert!(error < 3.0 * (-digits).exp(), "{digits}: {error}");
        }
    }

    #[test]
    fn parts_of_a_ring_are_the_orders_of_its_points() {
        let ring = Ring { radius: 0.5, harmonics: vec![[5.0, 0.0], [1.0, -2.0], [0.3, 0.7]], orders: 2 };
        for (m, (even, odd)) in ring.part(false).into_iter().zip(ring.part(true)).enumerate() {
            let sum = |f: fn(f64) -> f64| -> f64 {
                ring.points().map(|p| p.weight * f(m as f64 * p.beta.y.atan2(p.beta.x))).sum()
            };
            assert!((sum(f64::cos) - even).abs() < 1e-14, "{m}: {even}");
            assert!((sum(f64::sin) - odd).abs() < 1e-14, "{m}: {odd}");
        }
    }
}

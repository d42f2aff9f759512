//! Products of two sums of lobes, integrated over the azimuth of a circle.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::with_widest_simd;

use super::first_pass::SAME_RADIUS;
use super::lobes::{LANES, radii_of, side_by_side};
use super::pairs::Pairs;
use crate::light::cone_points::Point;
use crate::numerics::quadrature::{MULTIPLE_POLES, Node, Pole, graded};

/// Number of orders (or a quarter of the number of points) above which panels around the lobes are faster.
const MOST_ORDERS: usize = 300;

/// Largest number of pairs of points for which the closed form of each is considered.
const MOST_PAIRS: usize = 400;
/// Cost of a closed form in steps of the recurrence of orders.
const STEPS_OF_A_PAIR: usize = 16;
/// The same of the panels around the lobe of a point.
const STEPS_OF_PANELS: usize = 800;
/// Number of steps for which it does not matter which method is the cheapest.
const FEW_STEPS: usize = 100;

/// Integral over azimuth of the product of two sums of lobes, at any radius.
///
/// The product of two lobes has a closed form ([`Pairs`]). Sums of many points have many pairs. By Parseval's
/// theorem their product is a sum over Fourier orders, which needs only half as many as either of its factors
/// has. If these are too many, too, the integral is computed by panels around the lobes.
pub(super) struct RingOfProducts<'a> {
    lobe: Lobe,
    digits: f64,
    points: [&'a [Point]; 2],
    /// `None` if they are too many.
    pairs: Option<Pairs>,
    rings: [Rings; 2],
    /// Workspace.
    ratios: Vec<[f64; LANES]>,
}

/// How the integral is computed.
#[derive(Debug, Clone, Copy)]
enum Method {
    Pairs,
    /// The number of orders of the product, and the orders from which the recurrences of the two factors
    /// start.
    Orders(usize, [usize; 2]),
    Panels,
}

impl<'a> RingOfProducts<'a> {
    pub(super) fn new(lobe: Lobe, one: &'a [Point], other: &'a [Point], digits: f64) -> Self {
        let points = [one, other];
        let pairs = Pairs::new(points, MOST_PAIRS);
        Self { lobe, digits, points, pairs, rings: points.map(Rings::new), ratios: Vec::new() }
    }

    /// Returns the integral at each of the nodes.
    pub(super) fn at(&mut self, nodes: &[Node]) -> Vec<f64> {
        let Lobe::KCorrelation { width } = self.lobe else {
            let [one, other] = self.points.map(|points| points.iter().map(|p| p.weight).sum::<f64>());
            let ring = |node: &Node| if node.x <= 1.0 { 2.0 / PI * one * other } else { 0.0 };
            return nodes.iter().map(ring).collect();
        };
        let mut sums = [Vec::new(), Vec::new()];
        let mut all = Vec::with_capacity(nodes.len());
        for nodes in nodes.chunks(LANES) {
            let radii = radii_of(nodes);
            let found = self.by(self.method(width, &radii), width, &radii, &mut sums);
            all.extend_from_slice(&found[..nodes.len()]);
        }
        all
    }

    /// Returns the cheapest method.
    fn method(&self, width: f64, radii: &[f64; LANES]) -> Method {
        let of_pairs = self.pairs.as_ref().map_or(usize::MAX, |pairs| STEPS_OF_A_PAIR * pairs.len());
        if of_pairs <= FEW_STEPS {
            return Method::Pairs;
        }
        let (steps, other) = match self.orders(width, radii) {
            Some((count, from)) => {
                let steps = |(rings, from): (&Rings, usize)| rings.radii.len() * from;
                (self.rings.iter().zip(from).map(steps).sum(), Method::Orders(count, from))
            }
            None => (STEPS_OF_PANELS * (self.points[0].len() + self.points[1].len()), Method::Panels),
        };
        if of_pairs <= steps { Method::Pairs } else { other }
    }

    /// Computes the integrals by this method; `sums` is a workspace.
    fn by(
        &mut self,
        method: Method,
        width: f64,
        radii: &[f64; LANES],
        sums: &mut [Vec<Turning>; 2],
    ) -> [f64; LANES] {
        match (method, &self.pairs) {
            (Method::Pairs, Some(pairs)) => with_widest_simd(
                #[inline(always)]
                || pairs.at(width, radii),
            ),
            (Method::Orders(count, from), _) => with_widest_simd(
                #[inline(always)]
                || self.by_orders(width, radii, (count, from), sums),
            ),
            (Method::Pairs | Method::Panels, _) => {
                radii.map(|radius| by_panels(width, radius, self.points, self.digits))
            }
        }
    }

    /// Returns the number of orders that the product needs, and the orders from which the recurrences of the
    /// two factors start; `None` if they are too many.
    fn orders(&self, width: f64, radii: &[f64; LANES]) -> Option<(usize, [usize; 2])> {
        let least = self.rings.each_ref().map(|rings| rings.least_excess(width, radii));
        // A lobe's poles in azimuth lie at its own azimuth, at this distance from the real line: its orders
        // decrease as `exp(-off m)`.
        let off = least.map(|excess| 2.0 * (0.5 * excess).sqrt().asinh());
        // For lobes that do not overlap, the product is smaller than its orders by this factor.
        let cancelled = 1.5 * (2.0 / least[0].max(least[1])).ln_1p();
        let digits = self.digits + MULTIPLE_POLES + cancelled;
        let count = (digits / (off[0] + off[1])).ceil() + 2.0;
        // The error at the start of a recurrence decreases at twice that rate.
        let from = off.map(|off| (0.5 * digits / off).ceil().max(count + 8.0));
        let most = MOST_ORDERS.max(self.points[0].len().max(self.points[1].len()) / 4);
        let fits = from[0].max(from[1]) <= most as f64;
        fits.then(|| (count as usize, from.map(|from| from as usize)))
    }

    #[inline(always)]
    fn by_orders(
        &mut self,
        width: f64,
        radii: &[f64; LANES],
        (count, from): (usize, [usize; 2]),
        sums: &mut [Vec<Turning>; 2],
    ) -> [f64; LANES] {
        for ((rings, sums), from) in self.rings.iter_mut().zip(&mut *sums).zip(from) {
            rings.sum(width, radii, (count, from), &mut self.ratios, sums);
        }
        let mut product = [0.0; LANES];
        for (m, (one, other)) in sums[0].iter().zip(&sums[1]).enumerate() {
            let both_signs = if m == 0 { 1.0 } else { 2.0 };
            for (k, product) in product.iter_mut().enumerate() {
                *product += both_signs * (one.cos[k] * other.cos[k] + one.sin[k] * other.sin[k]);
            }
        }
        product.map(|product| 2.0 * PI * product)
    }
}

/// One Fourier order at several radii.
#[derive(Clone, Copy)]
struct Turning {
    cos: [f64; LANES],
    sin: [f64; LANES],
}

/// Points grouped by distinct radius.
struct Rings {
    radii: Vec<f64>,
    points: Vec<OnRing>,
    /// For each order and radius the sum of weights times `exp(i m phi)`, as far as computed.
    turns: Vec<[f64; 2]>,
}

/// A point on the ring of this number: `exp(i phi)`, and weight times `exp(i m phi)` of the next order.
struct OnRing {
    ring: usize,
    turn: [f64; 2],
    next: [f64; 2],
}

impl Rings {
    fn new(points: &[Point]) -> Self {
        let mut radii: Vec<f64> = Vec::new();
        let points = points.iter().map(|point| {
            let radius = point.beta.length();
            let ring = radii.iter().position(|r| (r - radius).abs() <= SAME_RADIUS).unwrap_or_else(|| {
                radii.push(radius);
                radii.len() - 1
            });
            let turn = if radius > 0.0 { [point.beta.x / radius, point.beta.y / radius] } else { [1.0, 0.0] };
            OnRing { ring, turn, next: [point.weight, 0.0] }
        });
        let points = points.collect();
        Self { radii, points, turns: Vec::new() }
    }

    /// Returns how far the cosine of the nearest pole in azimuth is above 1.
    fn least_excess(&self, width: f64, radii: &[f64; LANES]) -> f64 {
        let mut least = f64::INFINITY;
        for r in &self.radii {
            for radius in radii {
                let excess = ((radius - r).powi(2) + width * width) / (2.0 * radius * r).max(1e-300);
                least = if excess < least { excess } else { least };
            }
        }
        least
    }

    fn turns_to(&mut self, count: usize) {
        for m in self.turns.len() / self.radii.len().max(1)..count {
            let start = m * self.radii.len();
            self.turns.resize(start + self.radii.len(), [0.0; 2]);
            for OnRing { ring, turn, next } in &mut self.points {
                let [cos, sin] = *turn;
                let sum = &mut self.turns[start + *ring];
                *sum = [sum[0] + next[0], sum[1] + next[1]];
                *next = [next[0] * cos - next[1] * sin, next[0] * sin + next[1] * cos];
            }
        }
    }

    /// Computes the first `count` orders of the sum of lobes.
    #[inline(always)]
    fn sum(
        &mut self,
        width: f64,
        radii: &[f64; LANES],
        (count, from): (usize, usize),
        ratios: &mut Vec<[f64; LANES]>,
        sums: &mut Vec<Turning>,
    ) {
        self.turns_to(count);
        sums.clear();
        sums.resize(count, Turning { cos: [0.0; LANES], sin: [0.0; LANES] });
        for (ring, r) in self.radii.iter().enumerate() {
            side_by_side(width, *r, *radii, (count, Some(from)), ratios, |m, order| {
                let [cos, sin] = self.turns[m * self.radii.len() + ring];
                let sum = &mut sums[m];
                for (k, order) in order.into_iter().enumerate() {
                    sum.cos[k] += cos * order;
                    sum.sin[k] += sin * order;
                }
            });
        }
    }
}

/// Returns the integral at one radius by panels around the lobes.
fn by_panels(width: f64, radius: f64, points: [&[Point]; 2], digits: f64) -> f64 {
    let excess = |point: &Point| {
        let r = point.beta.length();
        ((radius - r).powi(2) + width * width) / (2.0 * radius * r).max(1e-300)
    };
    let off = |excess: f64| 2.0 * (0.5 * excess).sqrt().asinh();
    let azimuth = |point: &Point| point.beta.y.atan2(point.beta.x);
    let mut poles: Vec<Pole> = Vec::new();
    for point in points.into_iter().flatten() {
        for turn in [-2.0 * PI, 0.0, 2.0 * PI] {
            let pole = Pole { at: azimuth(point) + turn, off: off(excess(point)) };
            let sharper = |p: &Pole| p.off <= pole.off && (p.at - pole.at).abs() < 0.25 * p.off;
            if !poles.iter().any(sharper) {
                poles.push(pole);
            }
        }
    }
    let value = |node: &Node| {
        let (sin, cos) = node.x.sin_cos();
        let (x, y) = (radius * cos, radius * sin);
        node.weight * lobes(width, x, y, points[0]) * lobes(width, x, y, points[1])
    };
    (width / (2.0 * PI)).powi(2) * graded(-PI, PI, &[], &poles, digits).iter().map(value).sum::<f64>()
}

/// Returns the weighted sum of lobes at a point, without the factor `b / (2 pi)`.
#[inline]
fn lobes(width: f64, x: f64, y: f64, points: &[Point]) -> f64 {
    let mut sum = 0.0;
    for point in points {
        let s = width * width + (x - point.beta.x).powi(2) + (y - point.beta.y).powi(2);
        sum += point.weight / (s * s.sqrt());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::{Beta, Scatterer};

    /// All methods of integrating over azimuth agree, for lobes down to a width of 1e-4: one pair of points,
    /// also on one axis, and sums of points.
    #[test]
    fn products_of_narrow_lobes_agree_by_all_methods() {
        let point = |x, y| Point { beta: Beta { x, y }, weight: 0.7 };
        let cases = [
            (vec![point(0.3, 0.02)], vec![point(-0.1, 0.29)]),
            (vec![point(0.24, 0.18)], vec![point(-0.28, -0.21)]),
            (vec![point(0.3, 0.0)], vec![point(0.3, 0.0)]),
            (
                vec![point(0.3, 0.01), point(0.3, -0.01), point(0.29, 0.01)],
                vec![point(0.0, 0.0), point(-0.31, 0.0)],
            ),
        ];
        for ((one, other), width) in
            cases.iter().flat_map(|case| [1e-4, 3e-3, 0.05].map(|width| (case, width)))
        {
            let lobe = Lobe::KCorrelation { width };
            let steps = 400_000;
            let sum = |points: &[Point], at: Beta| -> f64 {
                points.iter().map(|point| point.weight * lobe.density(point.beta, at)).sum()
            };
            let term = |k: i32| {
                let phi = 2.0 * PI * f64::from(k) / f64::from(steps);
                let at = Beta { x: 0.3 * phi.cos(), y: 0.3 * phi.sin() };
                sum(one, at) * sum(other, at)
            };
            let truth = (0..steps).map(term).sum::<f64>() * 2.0 * PI / f64::from(steps);
            let mut ring = RingOfProducts::new(lobe, one, other, 23.0);
            let (radii, mut sums) = ([0.3; LANES], [Vec::new(), Vec::new()]);
            let by_orders = ring.orders(width, &radii).map(|(count, from)| Method::Orders(count, from));
            assert!(by_orders.is_some() || width < 0.01, "{width}");
            for method in [Method::Pairs, Method::Panels].into_iter().chain(by_orders) {
                let found = ring.by(method, width, &radii, &mut sums)[0];
                assert!((found / truth - 1.0).abs() < 1e-8, "{width} {method:?}: {found} {truth}");
            }
        }
    }
}

//! Light of a field, projected once onto the Fourier orders of the diffuser's lobe.
//!
//! A pass between a view and a field is the integral over the disc of the glass of the lobe around the view,
//! the reflectance, and the field convolved with the lobe. The last factor does not depend on the view, and
//! it is as smooth as the lobe: [`Projected`] holds its Fourier orders at the nodes of one rule over the
//! radius, which is graded for all views together. By Parseval's theorem the integral over azimuth is the sum
//! of products of orders. A view's own orders depend on its azimuth only by the factors `cos m phi` and
//! `sin m phi`: the weights of each order ([`Pass::by_order`]) serve all views at one inclination, and each
//! of them is a short sum.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::with_widest_simd;

use super::first_pass::{Pass, SAME_RADIUS, Weights};
use super::lobes::{self, LANES, radii_of, side_by_side};
use crate::light::cone_points::Point;
use crate::light::rings::Ring;
use crate::numerics::quadrature::{MULTIPLE_POLES, Node};

/// Light at one `|beta|`, by its azimuthal orders 0, 1, ...: integrals of the light times `cos m phi`, or
/// `sin m phi` of the odd part of a field.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Circle {
    pub(super) radius: f64,
    pub(super) orders: Vec<f64>,
}

impl Circle {
    /// Returns the even or the odd part of a field's ring.
    pub(super) fn part(ring: &Ring, odd: bool) -> Self {
        Self { radius: ring.radius, orders: ring.part(odd) }
    }

    /// Returns the circles of points that are symmetric about this azimuth.
    pub(super) fn of_points(points: &[Point], azimuth: f64, count: usize) -> Vec<Self> {
        let mut circles: Vec<Self> = Vec::new();
        for point in points {
            let radius = point.beta.length();
            let known = circles.iter().position(|circle| (circle.radius - radius).abs() <= SAME_RADIUS);
            let circle = known.unwrap_or_else(|| {
                circles.push(Self { radius, orders: vec![0.0; count] });
                circles.len() - 1
            });
            let off = point.beta.y.atan2(point.beta.x) - azimuth;
            for (m, order) in circles[circle].orders.iter_mut().enumerate() {
                *order += point.weight * (m as f64 * off).cos();
            }
        }
        circles
    }
}

/// The field convolved with the lobe, below the diffuser.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Projected {
    rule: Vec<Node>,
    /// For each chunk of the rule, its orders.
    chunks: Vec<Vec<[f64; LANES]>>,
    /// Light above the diffuser.
    circles: Vec<Circle>,
}

impl Projected {
    /// Returns the number of azimuthal orders.
    pub(super) fn orders(&self) -> usize {
        let above = self.circles.iter().map(|circle| circle.orders.len());
        above.chain(self.chunks.iter().map(Vec::len)).max().unwrap_or(0)
    }

    pub(super) fn nodes(&self) -> usize {
        self.rule.len()
    }

    /// Returns how many numbers it has.
    pub(super) fn numbers(&self) -> usize {
        let above = self.circles.iter().map(|circle| circle.orders.len());
        LANES * self.chunks.iter().map(Vec::len).sum::<usize>() + above.sum::<usize>()
    }
}

impl Pass<'_> {
    /// Projects light at these radii for views at those; `circles` returns its circles, by at least this
    /// number of orders if there are as many.
    pub(super) fn project(
        &self,
        lit: &[f64],
        views: &[f64],
        circles: impl FnOnce(usize) -> Vec<Circle>,
    ) -> Projected {
        let rule = self.rule(lit.iter().chain(views).copied(), false, self.digits);
        let orders: Vec<usize> =
            rule.chunks(LANES).map(|nodes| self.orders([views, lit], &radii_of(nodes))).collect();
        let circles = circles(orders.iter().copied().max().unwrap_or(1));
        let mut sums = self.lobe_sums();
        let chunk = |(nodes, orders): (&[Node], usize)| {
            let mut out = vec![[0.0; LANES]; orders];
            sums.add(&circles, &radii_of(nodes), &mut out);
            out
        };
        Projected { chunks: rule.chunks(LANES).zip(orders).map(chunk).collect(), rule, circles }
    }

    /// Returns `pi` times the kernel between a view and a field, without the light that is never scattered,
    /// as weights on the nodes of the table for each azimuthal order that matters: `[order][node]`.
    pub(super) fn by_order(&self, view: &[Point], azimuth: f64, light: &Projected) -> Vec<f64> {
        let (count, s) = (light.orders(), self.straight());
        let circles = Circle::of_points(view, azimuth, count);
        let [views, lit] = [&circles, &light.circles]
            .map(|all| all.iter().map(|circle| circle.radius).collect::<Vec<f64>>());
        let mut weights = vec![Weights::new(self.table); count];
        let mut sums = self.lobe_sums();
        let (mut of_view, mut used) = (Vec::new(), 1);
        for (nodes, orders) in light.rule.chunks(LANES).zip(&light.chunks) {
            let radii = radii_of(nodes);
            // Other views may need more orders there than this one.
            let orders = &orders[..orders.len().min(self.orders([&views, &lit], &radii))];
            of_view.clear();
            of_view.resize(orders.len(), [0.0; LANES]);
            sums.add(&circles, &radii, &mut of_view);
            used = used.max(orders.len());
            for (k, node) in nodes.iter().enumerate() {
                let (stencil, scale) = (self.look_up(node.x), PI * (1.0 - s).powi(2) * node.weight);
                for ((weights, view), light) in weights.iter_mut().zip(&of_view).zip(orders) {
                    weights.add(&stencil, scale * view[k] * light[k]);
                }
            }
        }
        if s > 0.0 {
            self.add_once(&circles, &light.circles, &mut weights);
            used = count;
        }
        weights.truncate(used);
        weights.into_iter().flat_map(|weights| weights.finish(self.table).0).collect()
    }

    /// Adds light that is scattered in one of its two passes through the diffuser.
    fn add_once(&self, views: &[Circle], light: &[Circle], weights: &mut [Weights]) {
        let scale = PI * self.straight() * (1.0 - self.straight());
        let nodes: Vec<Node> = light.iter().map(|circle| Node { x: circle.radius, weight: 1.0 }).collect();
        for view in views {
            let count = view.orders.len();
            lobes::orders_of_nodes(self.diffuser.lobe, view.radius, &nodes, count, |m, first, values| {
                for (circle, value) in light[first..].iter().zip(values) {
                    let Some(order) = circle.orders.get(m) else { continue };
                    for radius in [view.radius, circle.radius].into_iter().filter(|r| *r < self.index) {
                        weights[m].add(&self.look_up(radius), scale * view.orders[m] * order * value);
                    }
                }
            });
        }
    }

    /// Returns the number of orders that the product of lobes around views and light at these radii needs.
    fn orders(&self, centres: [&[f64]; 2], radii: &[f64; LANES]) -> usize {
        let Lobe::KCorrelation { width } = self.diffuser.lobe else { return 1 };
        let least = centres.map(|centres| least_excess(width, centres, radii));
        // For lobes that do not overlap, the product is smaller than its orders by this factor.
        let cancelled = 1.5 * (2.0 / least[0].max(least[1])).ln_1p();
        let digits = self.digits + MULTIPLE_POLES + cancelled;
        ((digits / (off(least[0]) + off(least[1]))).ceil() + 2.0).min(MOST_ORDERS) as usize
    }

    fn lobe_sums(&self) -> LobeSums {
        LobeSums { lobe: self.diffuser.lobe, digits: self.digits + MULTIPLE_POLES, ratios: Vec::new() }
    }
}

/// Largest number of azimuthal orders.
const MOST_ORDERS: f64 = 16_000.0;

/// Returns how far the cosine of the nearest pole in azimuth of lobes around `centres` is above 1.
fn least_excess(width: f64, centres: &[f64], radii: &[f64; LANES]) -> f64 {
    let mut least = f64::INFINITY;
    for centre in centres {
        for radius in radii {
            let excess = ((radius - centre).powi(2) + width * width) / (2.0 * radius * centre).max(1e-300);
            least = least.min(excess);
        }
    }
    least.min(1e300)
}

/// Returns the distance of that pole from the real line: orders decrease as `exp(-off m)`.
fn off(excess: f64) -> f64 {
    2.0 * (0.5 * excess).sqrt().asinh()
}

/// Sums of lobes around circles, by azimuthal order.
struct LobeSums {
    lobe: Lobe,
    digits: f64,
    /// Workspace.
    ratios: Vec<[f64; LANES]>,
}

impl LobeSums {
    /// Adds the first orders at these radii to `out`.
    fn add(&mut self, circles: &[Circle], radii: &[f64; LANES], out: &mut [[f64; LANES]]) {
        let Lobe::KCorrelation { width } = self.lobe else {
            for circle in circles {
                let density = |radius| if circle.radius <= 1.0 && radius <= 1.0 { 1.0 / PI } else { 0.0 };
                add(&mut out[0], &radii.map(density), circle.orders[0]);
            }
            return;
        };
        with_widest_simd(
            #[inline(always)]
            || {
                for circle in circles {
                    let (count, from) = self.orders_of(width, circle, radii, out.len());
                    let ratios = &mut self.ratios;
                    side_by_side(width, circle.radius, *radii, (count, Some(from)), ratios, |m, lobe| {
                        add(&mut out[m], &lobe, circle.orders[m]);
                    });
                }
            },
        );
    }

    /// Returns the number of orders of the lobe around a circle that matter out of the first `most`, and the
    /// order from which their recurrence starts: its error decreases at twice the rate of the orders.
    fn orders_of(&self, width: f64, circle: &Circle, radii: &[f64; LANES], most: usize) -> (usize, usize) {
        let own = self.digits / off(least_excess(width, &[circle.radius], radii));
        let count = circle.orders.len().min(most).min(own as usize + 3);
        (count, (0.5 * own.min(2.0 * MOST_ORDERS)).ceil().max(count as f64 + 8.0) as usize)
    }
}

#[inline(always)]
fn add(sum: &mut [f64; LANES], lobe: &[f64; LANES], scale: f64) {
    sum.iter_mut().zip(lobe).for_each(|(sum, lobe)| *sum += scale * lobe);
}

#[cfg(test)]
mod tests {
    use super::super::recycling::azimuth_factor;
    use super::*;
    use crate::{Diffuser, Nodes};
    use papilio_optics::Beta;

    /// Two roads: weights by azimuthal order, and the integral for each pair of points by its own rule; for
    /// lobes down to a width of 0.01, with and without unscattered light, and for every azimuth of the view.
    #[test]
    fn weights_by_order_equal_those_between_points() {
        let lobes = [0.2, 0.05, 0.01].map(|width| Lobe::KCorrelation { width });
        for lobe in lobes.into_iter().chain([Lobe::Lambertian]) {
            for regular_fraction in [0.0, 0.3] {
                let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
                let pass = Pass { diffuser: &diffuser, table: &Nodes::Cosines(9), index: 1.5, digits: 20.0 };
                // Light that is not the same on both sides of azimuth 0.
                let at = |radius: f64, turn: f64| Beta { x: radius * turn.cos(), y: radius * turn.sin() };
                let light: Vec<Point> = (0..5_i32)
                    .map(f64::from)
                    .map(|k| Point { beta: at(0.2 + 0.05 * k, 0.8 - 0.7 * k), weight: 0.1 + 0.05 * k })
                    .collect();
                let part = |odd: bool, count: usize| -> Vec<Circle> {
                    let order = |point: &Point, m: usize| {
                        let (sin, cos) = (m as f64 * point.beta.y.atan2(point.beta.x)).sin_cos();
                        point.weight * if odd { sin } else { cos }
                    };
                    let circle = |point: &Point| {
                        let orders = (0..count).map(|m| order(point, m)).collect();
                        Circle { radius: point.beta.length(), orders }
                    };
                    light.iter().map(circle).collect()
                };
                let lit: Vec<f64> = light.iter().map(|point| point.beta.length()).collect();
                for azimuth in [0.0, 0.9, -2.5] {
                    let one = |off: f64| Point { beta: at(0.3, azimuth + off), weight: 0.5 };
                    let view = [one(0.02), one(-0.02)];
                    let mut found = vec![0.0; pass.table.count()];
                    for odd in [false, true] {
                        // Light of one lobe needs more orders than a product.
                        let projected = pass.project(&lit, &[0.3], |count| part(odd, 4 * count));
                        let by_order = pass.by_order(&view, azimuth, &projected);
                        for (m, order) in by_order.chunks_exact(found.len()).enumerate() {
                            let factor = azimuth_factor(m, -azimuth, odd);
                            found.iter_mut().zip(order).for_each(|(sum, value)| *sum += factor * value);
                        }
                    }
                    let truth = pass.between(&view, &light).0.0;
                    let most = truth.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
                    for (found, truth) in found.iter().zip(&truth) {
                        assert!((found - truth).abs() < 1e-7 * most, "{lobe:?} {azimuth}: {found} {truth}");
                    }
                }
            }
        }
    }
}

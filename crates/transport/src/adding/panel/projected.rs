//! Light of a field, projected once onto the Fourier orders of the diffuser's lobe.
//!
//! A pass between a view and a field is the integral over the disc of the glass of the lobe around the view,
//! the reflectance, and the field convolved with the lobe. The last factor does not depend on the view, and
//! it is as smooth as the lobe: [`Projected`] holds its Fourier orders at the nodes of one rule over the
//! radius, which is graded for all views together. By Parseval's theorem the integral over azimuth is the sum
//! of products of orders. A view's own orders depend on its azimuth only by the factors `cos m phi` and
//! `sin m phi`: the weights of each order ([`Pass::by_order`]) serve all views at one inclination, and each of
//! them is a short sum.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::with_widest_simd;

use super::super::field::Ring;
use super::super::quadrature::{MULTIPLE_POLES, Node, Point};
use super::first_pass::{Pass, SAME_RADIUS, Weights};
use super::lobes::{self, LANES, radii_of, side_by_side};

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
}

impl Pass<'_> {
    /// Projects the light of these circles for views at these radii.
    pub(super) fn project(&self, circles: Vec<Circle>, views: &[f64]) -> Projected {
        let lit: Vec<f64> = circles.iter().map(|circle| circle.radius).collect();
        let rule = self.rule(lit.iter().chain(views).copied(), false, self.digits);
        let mut sums = self.lobe_sums();
        let chunk = |nodes: &[Node]| {
            let radii = radii_of(nodes);
            let mut out = vec![[0.0; LANES]; self.orders([views, &lit], &radii)];
            sums.add(&circles, &radii, &mut out);
            out
        };
        Projected { chunks: rule.chunks(LANES).map(chunk).collect(), rule, circles }
    }

    /// Returns `pi` times the kernel between a view and a field, without the light that is never scattered, as
    /// weights on the nodes of the table for each azimuthal order: `[order][node]`.
    pub(super) fn by_order(&self, view: &[Point], azimuth: f64, light: &Projected) -> Vec<f64> {
        let (count, s) = (light.orders(), self.straight());
        let circles = Circle::of_points(view, azimuth, count);
        let mut weights = vec![Weights::new(self.table); count];
        let mut sums = self.lobe_sums();
        let mut of_view = Vec::new();
        for (nodes, orders) in light.rule.chunks(LANES).zip(&light.chunks) {
            let radii = radii_of(nodes);
            of_view.clear();
            of_view.resize(orders.len(), [0.0; LANES]);
            sums.add(&circles, &radii, &mut of_view);
            for (k, node) in nodes.iter().enumerate() {
                let (stencil, scale) = (self.look_up(node.x), PI * (1.0 - s).powi(2) * node.weight);
                for ((weights, view), light) in weights.iter_mut().zip(&of_view).zip(orders) {
                    weights.add(&stencil, scale * view[k] * light[k]);
                }
            }
        }
        if s > 0.0 {
            self.add_once(&circles, &light.circles, &mut weights);
        }
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

//! Light that the layers below a rough surface reflect once, between two refractions by the surface
//! ([`rough`](super::rough)).
//!
//! `K(v, l) = integral of T(v, b) B(|b|) T(b, l) db` over the disc of the medium, T the kernel of refraction
//! and B the reflectance below. Both kernels may be narrow, around v and around l; B is smooth. B is
//! therefore interpolated between the nodes, and the integral is a factor for each of them, whatever the
//! states and wavelengths.
//!
//! The integral is divided in two by a smooth partition of unity, `S_l/(S_v + S_l)` and the reverse, with
//! `S_v = (|b - v|^2 + w_v^2)^2` and w_v the width of the lobe around v: the first part has no peak at l, and
//! is integrated in polar coordinates around v. In `s = asinh(r/w_v)` the lobe is analytic within i pi/2 of
//! the radius, and so is all that changes over any other distance. Panels end where B has square roots, at
//! |b| = 1.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_optics::Beta;
use papilio_optics::rough::{Rough, Side};

use super::azimuth;
use super::directions::{Directions, Ray};
use super::grid::{Grid, Interpolation};
use super::matrix::Matrix;
use super::rough::refraction_width;
use crate::numerics::quadrature::{Pole, graded, radial};

/// Factors of the reflectance at the nodes, for pairs of directions of views and lights.
#[derive(Debug, Clone)]
pub(super) struct FirstBounce {
    /// Ascending.
    pairs: Vec<Pair>,
    /// `[node, pair]`.
    factors: Matrix,
}

/// Extra nodes of a view and a light, and the azimuth between them in units of [`TURN`]; the largest for its
/// mean.
type Pair = (usize, usize, i64);

/// Azimuths that differ by less are the same.
const TURN: f64 = 1e-11;

/// Pole of a lobe in s.
const OWN: Pole = Pole { at: 0.0, off: FRAC_PI_2 };
/// Poles of the partition, where `|b - l|^2 = i |b - v|^2`: at this fraction of the distance of both
/// directions, and at this distance from the real axis in s on rays that deviate by less than 60 deg from the
/// other direction, and on others.
const BETWEEN: f64 = 0.6;
const TOWARDS: f64 = 0.39;
const ASIDE: f64 = 0.785;
/// Natural digits for each azimuth: the same poles are this far from real azimuths.
const DIGITS_OF_AN_AZIMUTH: f64 = 0.5;

impl FirstBounce {
    /// Computes the factors for all pairs of directions, to this number of natural digits; incomplete if
    /// `stop` is set.
    pub(super) fn new(
        face: &Rough,
        directions: &Directions,
        grid: &Grid,
        digits: f64,
        stop: &AtomicBool,
    ) -> Self {
        let mut pairs: Vec<Pair> = Vec::new();
        let (views, lights) = (directions.views.iter().flatten(), || directions.sources.iter().flatten());
        for view in views {
            pairs.extend(lights().map(|light| pair(view, light)));
        }
        pairs.sort_unstable();
        pairs.dedup();
        let lobes = Lobes::new(face, digits, grid);
        let mut factors = Matrix::zeros(grid.regular, pairs.len());
        for ((_, column), &(view, light, turn)) in factors.columns_mut().zip(&pairs) {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let [view, light] = [view, light].map(|extra| directions.beta[extra]);
            if turn == i64::MAX {
                lobes.mean([view, light], column);
            } else {
                let (sin, cos) = (turn as f64 * TURN).sin_cos();
                lobes.between([Beta { x: view, y: 0.0 }, Beta { x: light * cos, y: light * sin }], column);
            }
        }
        Self { pairs, factors }
    }

    /// Returns the factors at each node, `[node, pair]`.
    pub(super) fn factors(&self) -> &Matrix {
        &self.factors
    }

    /// Returns the number of a pair.
    pub(super) fn number(&self, view: &Ray, light: &Ray) -> usize {
        self.pairs.binary_search(&pair(view, light)).unwrap_or_default()
    }
}

fn pair(view: &Ray, light: &Ray) -> Pair {
    let turn = (view.turn - light.turn).rem_euclid(TAU);
    // The mirror image has the same value.
    let turn = turn.min(TAU - turn);
    (view.extra, light.extra, if light.is_ring { i64::MAX } else { (turn / TURN).round() as i64 })
}

/// Integrals of products of two lobes.
struct Lobes<'a> {
    face: &'a Rough,
    digits: f64,
    interpolation: Interpolation,
    /// `|beta|` of each node with weight, and the fraction of its light from below that crosses after several
    /// microfacets.
    nodes: Vec<(f64, f64)>,
}

/// Light that the surface refracts between a direction above and any below.
struct Refracted<'a> {
    face: &'a Rough,
    above: Beta,
    /// Light of several microfacets, over its fraction of light from below.
    several: f64,
}

impl<'a> Refracted<'a> {
    fn new(face: &'a Rough, above: Beta) -> Self {
        let total = face.several_total(Side::Above, Side::Below);
        let several = if total > 0.0 { face.several(Side::Above, above.length())[1] / total } else { 0.0 };
        Self { face, above, several }
    }

    /// Returns the kernel towards a direction below; `several` is the fraction of its light that crosses
    /// after several microfacets.
    fn towards(&self, below: Beta, several: f64) -> f64 {
        self.face.single(Side::Above, self.above, Side::Below, below) + self.several * several
    }
}

impl<'a> Lobes<'a> {
    fn new(face: &'a Rough, digits: f64, grid: &Grid) -> Self {
        let node = |beta: &f64| (*beta, face.several(Side::Below, *beta)[1]);
        let nodes = grid.beta[..grid.regular].iter().map(node).collect();
        Self { face, digits, interpolation: grid.interpolation(), nodes }
    }

    /// Adds the integral for two directions above to the factors of the nodes. What depends on |b| alone,
    /// shadowing and the light of several microfacets, is taken at the nodes, as the reflectance is: of each
    /// lobe `k g + c t`, only the light k of one microfacet is evaluated in all directions.
    fn between(&self, ends: [Beta; 2], factors: &mut [f64]) {
        let inside = self.face.index(Side::Below);
        // Beyond this, microfacets would have to be steeper than vertical.
        let edge = |end: Beta| (end.squared() + inside * inside - 1.0).sqrt();
        let radius = edge(ends[0]).min(edge(ends[1])).min(inside);
        let widths = ends.map(|end| refraction_width(self.face, end.length()));
        // Of the products of the light of one microfacet in both lobes, of the second, of the first, of ones.
        let mut sums: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; self.nodes.len()]);
        let spokes = (self.digits / DIGITS_OF_AN_AZIMUTH).ceil() as usize;
        let apart = (ends[1] - ends[0]).length();
        for (near, far) in [(0, 1), (1, 0)] {
            let (centre, width) = (ends[near], widths[near]);
            let across = ends[far] - centre;
            let between = (BETWEEN * apart / width).asinh();
            for spoke in 0..spokes {
                let (sin, cos) = (TAU * (spoke as f64 + 0.5) / spokes as f64).sin_cos();
                let along = Beta { x: cos, y: sin };
                // The ray leaves the disc of air, then that of the medium.
                let leaves = |radius: f64| {
                    let inward = centre.x * cos + centre.y * sin;
                    let reaches = inward * inward + radius * radius - centre.squared();
                    (reaches.max(0.0).sqrt() - inward).max(0.0)
                };
                let ends_of = [0.0, leaves(radius.min(1.0)), leaves(radius)].map(|r| (r / width).asinh());
                let towards = across.x * along.x + across.y * along.y > 0.5 * apart;
                let partition = Pole { at: between, off: if towards { TOWARDS } else { ASIDE } };
                for node in graded(0.0, ends_of[2], &ends_of[1..2], &[OWN, partition], self.digits) {
                    let r = width * node.x.sinh();
                    let b = Beta { x: centre.x + r * along.x, y: centre.y + r * along.y };
                    let size = |k: usize| ((b - ends[k]).squared() + widths[k] * widths[k]).powi(2);
                    let part = size(far) / (size(near) + size(far));
                    let area = r * width * node.x.cosh() * node.weight * TAU / spokes as f64;
                    let [one, other] = ends.map(|end| self.face.refracted(end, b));
                    let (some, weights) = self.interpolation.factors(b.length());
                    for (sum, value) in sums.iter_mut().zip([one * other, other, one, 1.0]) {
                        let value = area * part * value;
                        sum[some.clone()].iter_mut().zip(weights).for_each(|(sum, w)| *sum += value * w);
                    }
                }
            }
        }
        let several = ends.map(|end| Refracted::new(self.face, end).several);
        if several.iter().any(|several| *several > 0.0) {
            self.beyond(radius, ends.map(|end| (end.length(), edge(end))), &mut sums);
        }
        for (i, (factor, (beta, t))) in factors.iter_mut().zip(&self.nodes).enumerate() {
            let [g, h] = ends.map(|end| self.face.visible_across(end.length(), *beta));
            let [c, d] = several.map(|several| several * t);
            let [both, second, first, ones] = sums.each_ref().map(|sum| sum[i]);
            *factor += g * h * both + c * h * second + d * g * first + c * d * ones;
        }
    }

    /// Adds the light beyond the radius that one microfacet reaches from both ends: that of several
    /// microfacets is there, and that of one from the end with the larger edge. Neither has a peak there: its
    /// azimuths are averaged.
    fn beyond(&self, radius: f64, ends: [(f64, f64); 2], sums: &mut [Vec<f64>; 4]) {
        let inside = self.face.index(Side::Below);
        let poles = ends.map(|(end, _)| Pole { at: end, off: refraction_width(self.face, end) });
        let breaks = [1.0, ends[0].1, ends[1].1];
        for node in radial(inside, &breaks, &poles, self.digits).into_iter().filter(|node| node.x > radius) {
            let mean =
                |(end, edge): (f64, f64)| if node.x < edge { self.mean_refracted(end, node.x) } else { 0.0 };
            let [one, other] = ends.map(mean);
            let (some, weights) = self.interpolation.factors(node.x);
            for (sum, value) in sums.iter_mut().zip([0.0, other, one, 1.0]) {
                let value = node.weight * value;
                sum[some.clone()].iter_mut().zip(weights).for_each(|(sum, w)| *sum += value * w);
            }
        }
    }

    /// Returns the mean over azimuth of the light of one microfacet, between these |beta| above and below.
    fn mean_refracted(&self, above: f64, below: f64) -> f64 {
        let mut mean = [0.0];
        azimuth::graded(self.width_over_azimuth(above, below), &mut mean, |turn| {
            let (sin, cos) = turn.sin_cos();
            self.face.refracted(Beta { x: above, y: 0.0 }, Beta { x: below * cos, y: below * sin })
        });
        mean[0]
    }

    /// Returns the width over azimuth of the lobe around a direction above, on a circle below, radians.
    fn width_over_azimuth(&self, above: f64, below: f64) -> f64 {
        (refraction_width(self.face, above) / (above * below).sqrt().max(1e-9)).clamp(1e-9, 0.4)
    }

    /// Adds the mean of the integral over all azimuths between them: the integral of the product of both
    /// means.
    fn mean(&self, ends: [f64; 2], factors: &mut [f64]) {
        let inside = self.face.index(Side::Below);
        let edges = ends.map(|end| (end * end + inside * inside - 1.0).sqrt());
        let poles = ends.map(|end| Pole { at: end, off: refraction_width(self.face, end) });
        for node in radial(inside, &[1.0, edges[0], edges[1]], &poles, self.digits) {
            let several = self.face.several(Side::Below, node.x)[1];
            let mean = |end: f64| {
                let mut mean = [0.0];
                let lobe = Refracted::new(self.face, Beta { x: end, y: 0.0 });
                azimuth::graded(self.width_over_azimuth(end, node.x), &mut mean, |turn| {
                    let (sin, cos) = turn.sin_cos();
                    lobe.towards(Beta { x: node.x * cos, y: node.x * sin }, several)
                });
                mean[0]
            };
            self.interpolation.add(node.x, node.weight * mean(ends[0]) * mean(ends[1]), factors);
        }
    }
}

//! Light between a view and a source that meets the base twice, under a narrow lobe.
//!
//! With P_w the lobe of width w, one pass in which light is scattered is, between directions v and l in air,
//!
//! `S(v, l) = (1-s)^2 P_2b(v - l) rho(v, l) + s (1-s) P_b(v - l) (R_v + R_l)`,
//!
//! where rho is the mean of the base's reflectance over the directions in the glass on the way from v to l.
//! It differs from the mean of R_v and R_l only by the order of b and, unlike the lobe, changes over the disc
//! as slowly as R does. A few |v|, |l| and azimuths between them therefore represent the difference, however
//! narrow the lobe. Two passes are the integral of `S(v, a) S(a, l)` over the disc of air.
//!
//! Both integrals have the same form: the product of two lobes, around v and around l, times a smooth
//! function ([`Between`]). The reflectance is a sum of polynomials, so that two passes are a quadratic form in
//! its terms, as on the grid ([`super::super::forms`]).

use std::f64::consts::PI;

use papilio_optics::{Beta, with_widest_simd};

use super::super::forms::Places;
use super::super::profile::chebyshev;
use super::between::{Between, density};
use crate::adding::panel::first_pass::Pass;
use crate::adding::quadrature::{Point, gauss};

/// Two passes through the panel, in terms of the reflectance.
#[derive(Debug, Clone)]
pub(super) struct TwoPasses {
    width: f64,
    straight: f64,
    index: f64,
    digits: f64,
    /// Polynomials in the cosine in the glass.
    terms: Polynomials,
    /// The smallest of these cosines; beyond, the reflectance is that at it.
    least: f64,
    /// |beta| and cosines of the azimuth between v and l, between which rho is interpolated.
    radii: Polynomials,
    turns: Polynomials,
    /// Differences of rho from the mean of R_v and R_l, `[|v|][|l|][azimuth][term]`.
    differences: Vec<f64>,
    /// Products of two terms.
    places: Places,
}

/// One end of the path: everything that does not depend on the other.
struct End {
    at: Beta,
    /// Terms at this direction.
    terms: Vec<f64>,
    /// Differences `[|a|][azimuth][term]`.
    differences: Vec<f64>,
}

/// Directions close together, which see each other's surroundings alike.
#[derive(Debug, Clone)]
pub(super) struct Cluster {
    centre: Beta,
    /// Numbers of the group and the point.
    members: Vec<(usize, usize)>,
}

/// Range of the polynomials beyond the disc of air, in widths of the lobe: light in the glass that passes between two
/// directions in air hardly leaves that disc, and over all of the glass a film needs many more terms.
const WIDTHS_BEYOND_RIM: f64 = 3.0;

/// Cosine in the glass.
#[inline(always)]
fn cosine(squared: f64, index: f64) -> f64 {
    (1.0 - squared / (index * index)).max(0.0).sqrt()
}

impl TwoPasses {
    /// Prepares errors of `exp(-digits)`.
    pub(super) fn new(pass: &Pass<'_>, width: f64, digits: f64, terms: usize) -> Self {
        let count = (digits / DIGITS_A_RADIUS).ceil() as usize + 3;
        let least = cosine((1.0 + WIDTHS_BEYOND_RIM * width).powi(2), pass.index);
        let cosines = chebyshev(terms).iter().map(|node| least + (1.0 - least) * node.x).collect();
        let mut all = Self {
            width,
            straight: pass.straight(),
            index: pass.index,
            digits,
            terms: Polynomials::new(cosines),
            least,
            radii: Polynomials::new(gauss(0.0, 1.0, count).map(|node| node.x).collect()),
            turns: Polynomials::new(chebyshev(count - 1).iter().map(|node| 2.0 * node.x - 1.0).collect()),
            differences: Vec::new(),
            places: Places::new(terms, 2),
        };
        all.differences = all.all_differences();
        all
    }

    /// Returns |beta|² of the directions at which the terms are the reflectance.
    pub(super) fn squares(&self) -> Vec<f64> {
        self.terms.nodes.iter().map(|cosine| self.index * self.index * (1.0 - cosine * cosine)).collect()
    }

    /// Computes the terms at a direction.
    #[inline(always)]
    fn terms_at(&self, at: Beta, out: &mut [f64]) {
        self.terms.at(cosine(at.squared(), self.index).max(self.least), out);
    }

    fn all_differences(&self) -> Vec<f64> {
        let (radii, turns, terms) = (self.radii.len(), self.turns.len(), self.terms.len());
        let mut all = vec![0.0; radii * radii * turns * terms];
        for (i, one) in self.radii.nodes.iter().enumerate() {
            for (k, other) in self.radii.nodes.iter().enumerate().skip(i) {
                for (t, cos) in self.turns.nodes.iter().enumerate() {
                    let sin = (1.0 - cos * cos).max(0.0).sqrt();
                    let ends = [Beta { x: *one, y: 0.0 }, Beta { x: other * cos, y: other * sin }];
                    let difference = self.difference(ends);
                    for (i, k) in [(i, k), (k, i)] {
                        let start = ((i * radii + k) * turns + t) * terms;
                        all[start..][..terms].copy_from_slice(&difference);
                    }
                }
            }
        }
        all
    }

    /// Returns the difference of rho from the mean of R_v and R_l.
    fn difference(&self, ends: [Beta; 2]) -> Vec<f64> {
        let mut sum = vec![0.0; self.terms.len()];
        let mut terms = sum.clone();
        let scale = 1.0 / density(2.0 * self.width, ends[1] - ends[0]);
        let rule = Between::new(ends, self.width, self.index, self.digits);
        with_widest_simd(
            #[inline(always)]
            || {
                let mut add = |at: Beta, weight: f64| {
                    self.terms_at(at, &mut terms);
                    sum.iter_mut().zip(&terms).for_each(|(sum, term)| *sum += weight * term);
                };
                for (at, area) in rule.inside() {
                    let product = density(self.width, *at - ends[0]) * density(self.width, *at - ends[1]);
                    add(*at, scale * area * product);
                }
                for (end, weight) in ends.into_iter().zip(rule.weights_at_ends([self.width; 2])) {
                    add(end, scale * weight - 0.5);
                }
            },
        );
        sum
    }

    fn end(&self, at: Beta) -> End {
        let (mut weights, mut terms) = (vec![0.0; self.radii.len()], vec![0.0; self.terms.len()]);
        self.radii.at(at.length(), &mut weights);
        self.terms_at(at, &mut terms);
        let row = self.differences.len() / self.radii.len();
        let mut differences = vec![0.0; row];
        for (weight, row) in weights.iter().zip(self.differences.chunks_exact(row)) {
            differences.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
        }
        End { at, terms, differences }
    }

    /// Computes the smooth factors of one pass between an end and a direction with these terms: of light that
    /// is scattered twice (rho), to `out`.
    #[inline(always)]
    fn mean(
        &self,
        end: &End,
        at: Beta,
        terms: &[f64],
        (radial, turns): (&[f64], &mut [f64]),
        out: &mut [f64],
    ) {
        let size = at.length() * end.at.length();
        let cos = if size > 0.0 { (at.x * end.at.x + at.y * end.at.y) / size } else { 0.0 };
        for ((out, there), here) in out.iter_mut().zip(terms).zip(&end.terms) {
            *out = 0.5 * (there + here);
        }
        self.turns.at(cos.clamp(-1.0, 1.0), turns);
        let mut rows = end.differences.chunks_exact(out.len());
        for radial in radial {
            for (azimuthal, row) in turns.iter().zip(&mut rows) {
                let weight = radial * azimuthal;
                out.iter_mut().zip(row).for_each(|(out, value)| *out += weight * value);
            }
        }
    }

    /// Returns two passes between two directions, a coefficient for each product of terms.
    fn form(&self, one: &End, other: &End) -> Vec<f64> {
        let (terms, s, b) = (self.terms.len(), self.straight, self.width);
        let width = if s > 0.0 { b } else { 2.0 * b };
        let rule = Between::new([one.at, other.at], width, 1.0, self.digits);
        let mut of = Workspace::new(self);
        let mut form = vec![0.0; terms * terms];
        // Scattered twice in a pass, or once.
        let ways = [((1.0 - s) * (1.0 - s), 2.0 * b), (s * (1.0 - s), b)];
        let ways = if s > 0.0 { &ways[..] } else { &ways[..1] };
        with_widest_simd(
            #[inline(always)]
            || {
                for (at, area) in rule.inside() {
                    of.compute(self, [one, other], *at);
                    let [first, second] = [one, other].map(|end| {
                        let mut densities = [0.0; 2];
                        for (density_of, (share, width)) in densities.iter_mut().zip(ways) {
                            *density_of = share * density(*width, *at - end.at);
                        }
                        densities
                    });
                    of.add_product(*area, first, second, &mut form);
                }
                for (k, first) in ways.iter().enumerate() {
                    for (i, second) in ways.iter().enumerate() {
                        let weights = rule.weights_at_ends([first.1, second.1]);
                        for (end, weight) in [one, other].into_iter().zip(weights) {
                            of.compute(self, [one, other], end.at);
                            let [mut of_first, mut of_second] = [[0.0; 2]; 2];
                            (of_first[k], of_second[i]) = (first.0, second.0);
                            of.add_product(weight, of_first, of_second, &mut form);
                        }
                    }
                }
            },
        );
        self.places.folded(&form)
    }

    /// Returns `pi` times two passes between groups of a view and of a source: for each group of the view and
    /// of the source a coefficient for each product of terms. `lobe` is the kernel over a uniform base
    /// without rims, at a distance; directions close together differ only by it.
    pub(super) fn between(
        &self,
        views: &[&[Point]],
        sources: &[&[Point]],
        lobe: impl Fn(Beta) -> f64,
    ) -> Vec<Vec<Vec<f64>>> {
        let [of_view, of_source] = [views, sources].map(|groups| clusters(groups, self.digits));
        let ends: Vec<End> = of_source.iter().map(|cluster| self.end(cluster.centre)).collect();
        let mut all = vec![vec![vec![0.0; self.places.count()]; sources.len()]; views.len()];
        for near in &of_view {
            let end = self.end(near.centre);
            for (far, other) in of_source.iter().zip(&ends) {
                let form = self.form(&end, other);
                let scale = PI / lobe(far.centre - near.centre);
                for (view, v) in &near.members {
                    for (source, l) in &far.members {
                        let (v, l) = (&views[*view][*v], &sources[*source][*l]);
                        let weight = scale * v.weight * l.weight * lobe(l.beta - v.beta);
                        let sum = &mut all[*view][*source];
                        sum.iter_mut().zip(&form).for_each(|(sum, value)| *sum += weight * value);
                    }
                }
            }
        }
        all
    }
}

/// Smooth factors at one direction.
struct Workspace {
    here: Vec<f64>,
    radial: Vec<f64>,
    turns: Vec<f64>,
    /// For each end rho, the sum of both reflectances, and all of its light.
    means: [Vec<f64>; 2],
    sums: [Vec<f64>; 2],
    light: [Vec<f64>; 2],
}

impl Workspace {
    fn new(of: &TwoPasses) -> Self {
        let terms = || [vec![0.0; of.terms.len()], vec![0.0; of.terms.len()]];
        Self {
            here: vec![0.0; of.terms.len()],
            radial: vec![0.0; of.radii.len()],
            turns: vec![0.0; of.turns.len()],
            means: terms(),
            sums: terms(),
            light: terms(),
        }
    }

    #[inline(always)]
    fn compute(&mut self, of: &TwoPasses, ends: [&End; 2], at: Beta) {
        of.terms_at(at, &mut self.here);
        of.radii.at(at.length(), &mut self.radial);
        for ((end, mean), sum) in ends.into_iter().zip(&mut self.means).zip(&mut self.sums) {
            of.mean(end, at, &self.here, (&self.radial, &mut self.turns), mean);
            if of.straight > 0.0 {
                sum.iter_mut().zip(&self.here).zip(&end.terms).for_each(|((sum, a), b)| *sum = a + b);
            }
        }
    }

    /// Adds the product of the light of both ends, given the densities of light scattered twice and once.
    #[inline(always)]
    fn add_product(&mut self, weight: f64, first: [f64; 2], second: [f64; 2], form: &mut [f64]) {
        for (end, [twice, once]) in [first, second].into_iter().enumerate() {
            let both = self.means[end].iter().zip(&self.sums[end]);
            self.light[end]
                .iter_mut()
                .zip(both)
                .for_each(|(out, (mean, sum))| *out = twice * mean + once * sum);
        }
        let [one, other] = &self.light;
        for (one, row) in one.iter().zip(form.chunks_exact_mut(one.len())) {
            let one = weight * one;
            row.iter_mut().zip(other).for_each(|(sum, other)| *sum += one * other);
        }
    }
}

/// Digits of the interpolation of rho for each further node.
const DIGITS_A_RADIUS: f64 = 3.5;

/// Collects points close together.
fn clusters(groups: &[&[Point]], digits: f64) -> Vec<Cluster> {
    let size = LARGEST_CLUSTER * (-0.2 * digits).exp();
    let mut all: Vec<(Beta, Cluster)> = Vec::new();
    for (group, points) in groups.iter().enumerate() {
        for (number, point) in points.iter().enumerate() {
            let near = all.iter().position(|(first, _)| (*first - point.beta).length() < size);
            let place = near.unwrap_or_else(|| {
                all.push((point.beta, Cluster { centre: Beta::default(), members: Vec::new() }));
                all.len() - 1
            });
            all[place].1.members.push((group, number));
        }
    }
    let with_centre = |(_, mut cluster): (Beta, Cluster)| {
        let scale = 1.0 / cluster.members.len() as f64;
        for (group, number) in &cluster.members {
            let beta = groups[*group][*number].beta;
            cluster.centre =
                Beta { x: cluster.centre.x + scale * beta.x, y: cluster.centre.y + scale * beta.y };
        }
        cluster
    };
    all.into_iter().map(with_centre).collect()
}

/// Size of a cluster at no digits.
const LARGEST_CLUSTER: f64 = 0.5;

/// Polynomials that are one at one of the nodes and zero at the others, by the barycentric formula.
#[derive(Debug, Clone)]
struct Polynomials {
    nodes: Vec<f64>,
    scales: Vec<f64>,
}

impl Polynomials {
    fn new(nodes: Vec<f64>) -> Self {
        let scale = |(p, node): (usize, &f64)| {
            let others = nodes.iter().enumerate().filter(|(i, _)| *i != p);
            1.0 / others.map(|(_, other)| node - other).product::<f64>()
        };
        Self { scales: nodes.iter().enumerate().map(scale).collect(), nodes }
    }

    fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Computes all of them.
    #[inline(always)]
    fn at(&self, x: f64, out: &mut [f64]) {
        let mut all = 0.0;
        for ((out, node), scale) in out.iter_mut().zip(&self.nodes).zip(&self.scales) {
            let away = x - node;
            // At a node, its own term exceeds all others by far more than the rounding error.
            *out = scale / if away == 0.0 { f64::MIN_POSITIVE.sqrt() } else { away };
            all += *out;
        }
        let scale = 1.0 / all;
        out.iter_mut().for_each(|out| *out *= scale);
    }
}

//! One pass through diffuser, specular base and diffuser, as weights on the nodes of the base's table.
//!
//! With `D = s delta + (1 - s) lobe`, a pass between v and l is the integral of
//! `D(v, beta) R(beta) D(beta, l)` over the disc of the glass. `R` is linear in the values of the table, so
//! that the pass is a set of weights on its nodes. Over azimuth, products of lobes are summed by a rule that
//! converges exponentially (one lobe: in closed form). Over the radius, panels are graded around the centres
//! of the lobes and the rim of the disc of air; none is wider than the panels of the table (a film's
//! resonance may be narrower than any lobe).

use papilio_optics::Scatterer;
use papilio_optics::lobe::Lobe;
use papilio_optics::with_widest_simd;

use super::lobes::{self, LANES, radii_of};
use super::rings::RingOfProducts;
use crate::angular::Stencil;
use crate::light::cone_points::Point;
use crate::numerics::quadrature::{Node, Pole, radial};
use crate::{Diffuser, Nodes};

/// Diffuser, table nodes and index: the data that determine a pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pass<'a> {
    pub(super) diffuser: &'a Diffuser,
    pub(super) table: &'a Nodes,
    pub(super) index: f64,
    pub(super) digits: f64,
}

/// Weights on table nodes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weights(pub(crate) Vec<f64>);

impl Weights {
    pub(crate) fn new(nodes: &Nodes) -> Self {
        // A look-up always covers `Stencil::LEN` consecutive nodes.
        Self(vec![0.0; nodes.count() + Stencil::LEN])
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, stencil: &Stencil, weight: f64) {
        let slots = &mut self.0[stencil.first..][..Stencil::LEN];
        slots.iter_mut().zip(stencil.weights).for_each(|(slot, w)| *slot += w * weight);
    }

    pub(crate) fn finish(mut self, nodes: &Nodes) -> Self {
        self.0.truncate(nodes.count());
        self
    }
}

/// Light that a view sees independently of directed sources, and the distribution of its own light over the
/// base.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SourceFreeView {
    pub(super) reflected: Weights,
    pub(super) leaving: Weights,
    pub(super) nodes: usize,
}

impl Pass<'_> {
    pub(super) fn straight(&self) -> f64 {
        self.diffuser.regular_fraction
    }

    /// Returns the fraction of light at the underside of the diffuser that leaves into the air.
    fn share_leaving<const N: usize>(&self, radii: [f64; N]) -> [f64; N] {
        let scattered = self.diffuser.lobe.fractions_in_disc(radii, 1.0);
        let straight = radii.map(|radius| if radius <= 1.0 { self.straight() } else { 0.0 });
        std::array::from_fn(|k| straight[k] + (1.0 - self.straight()) * scattered[k])
    }

    /// Returns the same fraction at these nodes.
    pub(super) fn shares_leaving(&self, nodes: &[Node]) -> Vec<f64> {
        let of = |nodes: &[Node]| self.share_leaving(radii_of(nodes)).into_iter().take(nodes.len());
        nodes.chunks(LANES).flat_map(of).collect()
    }

    /// Returns a rule over the disc of the glass for lobes around these points.
    pub(super) fn rule(&self, points: impl Iterator<Item = f64>, rim: bool, digits: f64) -> Vec<Node> {
        let mut sharp: Vec<Pole> = Vec::new();
        points.for_each(|radius| lobes::poles(self.diffuser.lobe, radius, &mut sharp));
        if rim {
            lobes::poles(self.diffuser.lobe, 1.0, &mut sharp);
        }
        let mut breaks = self.table.breaks(self.index);
        if self.diffuser.lobe == Lobe::Lambertian || (rim && self.straight() > 0.0) {
            breaks.push(1.0);
        }
        if matches!(self.table, Nodes::AnglesInAir(_)) {
            // The angle in air has a square root on the rim.
            sharp.push(Pole { at: 1.0, off: 0.0 });
            breaks.push(1.0);
        }
        radial(self.index, &breaks, &sharp, digits)
    }

    #[inline(always)]
    pub(super) fn look_up(&self, radius: f64) -> Stencil {
        self.table.stencil(radius * radius, self.index)
    }

    pub(super) fn alone(&self, view: &[Point]) -> SourceFreeView {
        let (mut reflected, mut leaving) = (Weights::new(self.table), Weights::new(self.table));
        for point in view {
            let radius = point.beta.length();
            if radius < self.index && self.straight() > 0.0 {
                let stencil = self.look_up(radius);
                reflected.add(&stencil, point.weight * self.straight());
                leaving.add(&stencil, point.weight * self.straight() * self.share_leaving([radius])[0]);
            }
        }
        let radii = merged_radii(view);
        let rule = self.rule(radii.iter().map(|r| r.0), true, self.digits);
        let means = lobes::means(self.diffuser.lobe, &radii, &rule);
        let shares = self.shares_leaving(&rule);
        with_widest_simd(
            #[inline(always)]
            || {
                for ((node, mean), share) in rule.iter().zip(&means).zip(&shares) {
                    let weight = (1.0 - self.straight()) * node.weight * mean;
                    let stencil = self.look_up(node.x);
                    reflected.add(&stencil, weight);
                    leaving.add(&stencil, weight * share);
                }
            },
        );
        SourceFreeView {
            reflected: reflected.finish(self.table),
            leaving: leaving.finish(self.table),
            nodes: rule.len(),
        }
    }

    /// Returns `pi` times the kernel between two sets of points, without the light that is never scattered.
    pub(super) fn between(&self, view: &[Point], source: &[Point]) -> (Weights, usize) {
        let mut sum = Weights::new(self.table);
        let (s, lobe) = (self.straight(), self.diffuser.lobe);
        let pi = std::f64::consts::PI;
        if s > 0.0 {
            for v in view {
                for l in source {
                    let once = pi * s * (1.0 - s) * v.weight * l.weight * lobe.density(v.beta, l.beta);
                    for radius in [v.beta.length(), l.beta.length()].into_iter().filter(|r| *r < self.index) {
                        sum.add(&self.look_up(radius), once);
                    }
                }
            }
        }
        let radii = [merged_radii(view), merged_radii(source)].concat();
        let rule = self.rule(radii.iter().map(|r| r.0), false, self.digits);
        let rings = RingOfProducts::new(lobe, view, source, self.digits).at(&rule);
        with_widest_simd(
            #[inline(always)]
            || {
                for (node, ring) in rule.iter().zip(&rings) {
                    // The weights of the rule include the 2 pi that the ring already contains.
                    let weight = (1.0 - s).powi(2) * 0.5 * node.weight * ring;
                    sum.add(&self.look_up(node.x), weight);
                }
            },
        );
        (sum.finish(self.table), rule.len())
    }
}

/// Difference below which two radii are equal.
pub(super) const SAME_RADIUS: f64 = 1e-14;

/// Returns the distinct radii of a set of points and their weights.
pub(super) fn merged_radii(points: &[Point]) -> Vec<(f64, f64)> {
    let mut radii: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for point in points {
        let radius = point.beta.length();
        match radii.iter_mut().find(|r| (r.0 - radius).abs() <= SAME_RADIUS) {
            Some(same) => same.1 += point.weight,
            None => radii.push((radius, point.weight)),
        }
    }
    radii
}

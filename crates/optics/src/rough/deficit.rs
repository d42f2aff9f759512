//! Fraction of the light that one microfacet alone would lose, since it goes on to others; and the fraction
//! that it returns to the side of incidence.
//!
//! The deficit is an integral over the normal h of the microfacet. In polar coordinates about the normal of
//! the interface everything depends on h_z and on c1, the component along h of the incident wave vector,
//! `c1 = q h_z - |beta| h_t cos(phi)`. So do the places where the integrand is not analytic: microfacets seen
//! edge-on, the critical angle, light that leaves along the interface. They divide the two integrals into
//! parts. A Gauss rule integrates each part after a substitution that removes square roots at its ends.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Side;
use super::microfacets::{Microfacets, beyond, transmittance};
use super::shadowing::beta_function;
use crate::quadrature::legendre;

/// Gauss rule after `x = sin^2(pi t/2)`: nodes and weights on [0, 1].
pub(super) struct Rule(Vec<(f64, f64)>);

impl Rule {
    pub(super) fn new(order: usize) -> Self {
        let node = |(x, weight): (f64, f64)| {
            let angle = 0.5 * FRAC_PI_2 * (1.0 + x);
            (angle.sin().powi(2), 0.5 * FRAC_PI_2 * weight * (2.0 * angle).sin())
        };
        Self(legendre(order, 0.0).into_iter().rev().map(node).collect())
    }

    /// Returns the integral over [from, to], divided where `cuts` lie within.
    fn integrate(
        &self,
        from: f64,
        to: f64,
        cuts: impl IntoIterator<Item = f64>,
        mut function: impl FnMut(f64) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        self.parts(from, to, cuts, |begin, width| {
            let part = self.0.iter().map(|(x, weight)| weight * function(begin + width * x));
            sum += width * part.sum::<f64>();
        });
        sum
    }

    /// Returns the nodes and weights of [`Self::integrate`].
    pub(super) fn points(&self, from: f64, to: f64, cuts: impl IntoIterator<Item = f64>) -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        self.parts(from, to, cuts, |begin, width| {
            points.extend(self.0.iter().map(|(x, weight)| (begin + width * x, width * weight)));
        });
        points
    }

    fn parts(&self, from: f64, to: f64, cuts: impl IntoIterator<Item = f64>, mut part: impl FnMut(f64, f64)) {
        let mut ends = [to; 16];
        for (end, cut) in ends.iter_mut().zip(cuts) {
            *end = if cut.is_nan() { from } else { cut.clamp(from, to) };
        }
        ends.sort_unstable_by(f64::total_cmp);
        let mut begin = from;
        for end in ends {
            let width = end - begin;
            if width > 1e-12 {
                part(begin, width);
                begin = end;
            }
        }
    }
}

impl Microfacets {
    /// Returns the fraction of light from this side, at this cosine to the normal of the interface, that one
    /// microfacet sends to others.
    pub(super) fn deficit(&self, rule: &Rule, side: Side, cosine: f64) -> f64 {
        self.over_normals(rule, side, cosine, |arriving, h_z, h_t| arriving.over_azimuth(rule, h_z, h_t))
    }

    /// Returns the fraction of that light that returns to its side after one microfacet.
    pub(super) fn returned(&self, rule: &Rule, side: Side, cosine: f64) -> f64 {
        self.over_normals(rule, side, cosine, |arriving, h_z, h_t| arriving.returned(rule, h_z, h_t))
    }

    /// Returns the mean of `over_azimuth`, a function of the tilt, over the microfacets visible to light
    /// from this side.
    fn over_normals(
        &self,
        rule: &Rule,
        side: Side,
        cosine: f64,
        over_azimuth: impl Fn(&Arriving<'_>, f64, f64) -> f64,
    ) -> f64 {
        let n1 = self.index(side);
        // Along the interface itself Lambda is infinite.
        let cosine = cosine.max(1e-9);
        let (q, beta) = (n1 * cosine, n1 * ((1.0 - cosine) * (1.0 + cosine)).sqrt());
        let hidden = self.hidden(q, beta * beta) / q;
        let across = Across::new(hidden);
        let arriving = Arriving { facets: self, n1, n2: self.index(side.other()), q, beta, hidden, across };
        // tan(tilt) = alpha tan(w) spreads the normals uniformly, whatever the roughness.
        let w_of = |tilt: f64| (tilt.clamp(0.0, FRAC_PI_2).tan() / self.alpha).atan();
        let sum = rule.integrate(0.0, FRAC_PI_2, arriving.tilts().map(w_of), |w| {
            let (sin, cos) = w.sin_cos();
            let length = cos.hypot(self.alpha * sin);
            let (h_z, h_t) = (cos / length, self.alpha * sin / length);
            self.distribution.slopes(w) / h_z * over_azimuth(&arriving, h_z, h_t)
        });
        sum / (q * (1.0 + hidden) * PI)
    }
}

/// Light that arrives at the interface.
struct Arriving<'a> {
    facets: &'a Microfacets,
    /// Index of the incident medium.
    n1: f64,
    /// Index of the medium behind the interface.
    n2: f64,
    q: f64,
    beta: f64,
    /// Lambda of the light.
    hidden: f64,
    across: Across,
}

impl Arriving<'_> {
    /// Returns c1 at the critical angle, 0 if there is none.
    fn critical(&self) -> f64 {
        ((self.n1 - self.n2) * (self.n1 + self.n2)).max(0.0).sqrt()
    }

    /// Returns tilts of the microfacets at which a special case enters or leaves the plane of incidence.
    fn tilts(&self) -> [f64; 10] {
        let theta = self.beta.atan2(self.q);
        let critical_angle = (self.critical() / self.n1).acos();
        [
            // Seen edge-on; at the critical angle.
            FRAC_PI_2 - theta,
            critical_angle - theta,
            theta - critical_angle,
            critical_angle + theta,
            // Light that leaves along the interface, by reflection and by refraction.
            0.5 * (FRAC_PI_2 - theta),
            0.5 * (FRAC_PI_2 + theta),
            (self.n2 - self.beta).abs().atan2(self.q),
            (self.n2 + self.beta).atan2(self.q),
            // Not special: between the scale of the interface and vertical microfacets.
            0.25 * PI,
            self.facets.alpha.sqrt().atan(),
        ]
    }

    /// Returns the loss of microfacets of one tilt, weighted by c1, over half a turn.
    fn over_azimuth(&self, rule: &Rule, h_z: f64, h_t: f64) -> f64 {
        let Self { facets, n1, n2, q, hidden, .. } = *self;
        self.half_a_turn(rule, h_z, h_t, |c1| {
            let c2 = beyond(c1, n1, n2);
            let passes = transmittance(c1, n1, c2, n2);
            // By Lambda after it; 0 if it does not leave.
            let leaves = |q: f64, n: f64, unshadowed: &dyn Fn(f64) -> f64| {
                if q > 0.0 { unshadowed(facets.hidden(q, (n - q) * (n + q)) / q) } else { 0.0 }
            };
            let reflected = leaves(2.0 * c1 * h_z - q, n1, &|after| (1.0 + hidden) / (1.0 + hidden + after));
            if passes == 0.0 {
                return c1 * (1.0 - reflected);
            }
            let refracted = leaves(q - (c1 - c2) * h_z, n2, &|after| self.across.at(after));
            c1 * ((1.0 - passes) * (1.0 - reflected) + passes * (1.0 - refracted))
        })
    }

    /// Returns the unshadowed light that microfacets of one tilt return, weighted by c1, over half a turn.
    fn returned(&self, rule: &Rule, h_z: f64, h_t: f64) -> f64 {
        let Self { facets, n1, n2, q, hidden, .. } = *self;
        self.half_a_turn(rule, h_z, h_t, |c1| {
            let leaves = 2.0 * c1 * h_z - q;
            if leaves <= 0.0 {
                return 0.0;
            }
            let after = facets.hidden(leaves, (n1 - leaves) * (n1 + leaves)) / leaves;
            let reflectance = 1.0 - transmittance(c1, n1, beyond(c1, n1, n2), n2);
            c1 * reflectance * (1.0 + hidden) / (1.0 + hidden + after)
        })
    }

    /// Returns the integral over half a turn of a function of c1, for microfacets visible to the light.
    fn half_a_turn(&self, rule: &Rule, h_z: f64, h_t: f64, by_c1: impl Fn(f64) -> f64) -> f64 {
        let Self { q, beta, .. } = *self;
        let (critical, along) = (self.critical(), q / h_z);
        // c1 edge-on, at the critical angle, where the reflected and the refracted light leave along the
        // interface.
        let edges = [0.0, critical, 0.5 * along, 0.5 * (along + critical * critical / along)];
        let azimuths = edges.map(|c1| ((q * h_z - c1) / (beta * h_t)).clamp(-1.0, 1.0).acos());
        rule.integrate(0.0, PI, azimuths, |phi| {
            let c1 = q * h_z - beta * h_t * phi.cos();
            if c1 <= 0.0 { 0.0 } else { by_c1(c1) }
        })
    }
}

/// Probability that refracted light meets no other microfacet, by `1/(1 + Lambda)` of its direction: cubics
/// between nodes.
struct Across([f64; Across::NODES + 3]);

impl Across {
    const NODES: usize = 128;

    /// For incident light with this Lambda.
    fn new(hidden: f64) -> Self {
        let chance = |x: f64| (1.0 + hidden) * beta_function(hidden, 1.0 / x - 1.0);
        let mut nodes = [0.0; Self::NODES + 3];
        for (k, node) in nodes.iter_mut().enumerate().skip(2) {
            *node = chance((k as f64 - 1.0) / Self::NODES as f64);
        }
        // One more node on either side; at 0 nothing leaves, and odd functions vanish there.
        nodes[0] = -nodes[2];
        Self(nodes)
    }

    fn at(&self, after: f64) -> f64 {
        let place = Self::NODES as f64 / (1.0 + after);
        let first = (place as usize).min(Self::NODES - 1);
        let t = place - first as f64;
        let [a, b, c, d] = std::array::from_fn(|k| self.0[first + k]);
        // Lagrange cubic through the four neighbouring nodes.
        let (up, down, over) = (1.0 + t, 1.0 - t, 2.0 - t);
        0.5 * up * over * (b * down + c * t) - t * down * (a * over + d * up) / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rough::Distribution;

    #[test]
    fn table_of_transmission_is_fine_enough() {
        for hidden in [0.0, 0.1, 3.0, 1e3] {
            let across = Across::new(hidden);
            for step in 0..1000 {
                let after = 1000.0 / (f64::from(step) + 0.5) - 1.0;
                let exact = (1.0 + hidden) * beta_function(hidden, after.max(0.0));
                // Light so close to the interface is negligible.
                let tolerance = if after < 12.0 { 1e-7 } else { 2e-4 };
                assert!((across.at(after.max(0.0)) - exact).abs() < tolerance, "{hidden} {after}");
            }
        }
    }

    /// Compared with a rule of four times the order; [`super::super::multiple_scattering`] relies on 1e-5.
    /// (For light along the interface itself, which carries nothing, the combined effect of heights and
    /// slopes varies on the scale of the cosine: there 9e-6.)
    #[test]
    fn twelve_nodes_are_accurate() {
        let (rule, fine) = (Rule::new(12), Rule::new(48));
        for (alpha, below) in [(0.01, 1.5), (0.1, 1.05), (0.4, 2.4), (1.0, 1.5)] {
            let facets = Microfacets::new(Distribution::Ggx, alpha, 1.0, below);
            for side in [Side::Above, Side::Below] {
                for step in 0..=20 {
                    let cosine = (f64::from(step) / 20.0).powi(2);
                    let error = facets.deficit(&rule, side, cosine) - facets.deficit(&fine, side, cosine);
                    assert!(error.abs() < 1e-5, "{alpha} {below} {side:?} {cosine}: {error:e}");
                    let error = facets.returned(&rule, side, cosine) - facets.returned(&fine, side, cosine);
                    assert!(error.abs() < 1e-5, "returned, {alpha} {below} {side:?} {cosine}: {error:e}");
                }
            }
        }
    }
}

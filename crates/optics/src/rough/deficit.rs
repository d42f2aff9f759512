//! The share of light that one microfacet alone would lose: what it sends against the others.
//!
//! The deficit is an integral over the microfacet's normal h. In polar coordinates about the
//! face's normal everything depends on h_z and on c1, the component along h of the wave vector
//! that arrives, `c1 = q h_z - |beta| h_t cos(phi)`; so do the places where the integrand is not
//! analytic: facets seen edge-on, the critical angle, light that leaves along the face. They cut
//! the two integrals into parts which Gauss's rule integrates after a substitution that takes
//! square roots at their ends.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Side;
use super::microfacets::{Microfacets, beyond, transmittance};

/// Gauss's rule after `x = sin^2(pi t/2)`: nodes and weights on [0, 1].
pub(super) struct Rule(Vec<(f64, f64)>);

impl Rule {
    pub(super) fn new(order: usize) -> Self {
        let node = |k| {
            let (x, weight) = legendre_node(order, k);
            let angle = 0.5 * FRAC_PI_2 * (1.0 + x);
            (angle.sin().powi(2), 0.5 * FRAC_PI_2 * weight * (2.0 * angle).sin())
        };
        Self((0..order).map(node).collect())
    }

    /// The integral over [from, to], cut where `cuts` fall within.
    fn integrate(
        &self,
        from: f64,
        to: f64,
        cuts: impl IntoIterator<Item = f64>,
        mut function: impl FnMut(f64) -> f64,
    ) -> f64 {
        let mut ends = [to; 16];
        for (end, cut) in ends.iter_mut().zip(cuts) {
            *end = if cut.is_nan() { from } else { cut.clamp(from, to) };
        }
        ends.sort_unstable_by(f64::total_cmp);
        let (mut sum, mut begin) = (0.0, from);
        for end in ends {
            let width = end - begin;
            if width > 1e-12 {
                let part = self.0.iter().map(|(x, weight)| weight * function(begin + width * x));
                sum += width * part.sum::<f64>();
                begin = end;
            }
        }
        sum
    }
}

impl Microfacets {
    /// The share of light from this side, at this cosine to the face's normal, that one
    /// microfacet sends against others.
    pub(super) fn deficit(&self, rule: &Rule, side: Side, cosine: f64) -> f64 {
        let (n1, n2) = (self.index(side), self.index(side.other()));
        let (q, beta) = (n1 * cosine, n1 * ((1.0 - cosine) * (1.0 + cosine)).sqrt());
        // c1 at the critical angle.
        let critical = ((n1 - n2) * (n1 + n2)).max(0.0).sqrt();
        let theta = beta.atan2(q);
        let steep = (critical / n1).acos();
        let tilts = [
            FRAC_PI_2 - theta,
            steep - theta,
            theta - steep,
            steep + theta,
            0.5 * (FRAC_PI_2 - theta),
            0.5 * (FRAC_PI_2 + theta),
            (n2 - beta).abs().atan2(q),
            (n2 + beta).atan2(q),
            0.25 * PI,
            self.alpha.sqrt().atan(),
        ];
        // tan(tilt) = alpha tan(w) spreads the normals evenly, whatever the roughness.
        let cuts =
            tilts.map(
                |tilt| if (0.0..FRAC_PI_2).contains(&tilt) { (tilt.tan() / self.alpha).atan() } else { 0.0 },
            );
        let lost = rule.integrate(0.0, FRAC_PI_2, cuts, |w| {
            let (sin, cos) = w.sin_cos();
            let h_z = cos / cos.hypot(self.alpha * sin);
            let h_t = self.alpha * sin / cos.hypot(self.alpha * sin);
            // c1 where the reflected, and the refracted, light leaves along the face.
            let along = q / h_z;
            let edges = [0.0, critical, 0.5 * along, 0.5 * (along + critical * critical / along)];
            let azimuths = edges.map(|c1| ((q * h_z - c1) / (beta * h_t)).clamp(-1.0, 1.0).acos());
            let over_azimuth = rule.integrate(0.0, PI, azimuths, |phi| {
                let c1 = q * h_z - beta * h_t * phi.cos();
                if c1 <= 0.0 {
                    return 0.0;
                }
                let c2 = beyond(c1, n1, n2);
                let passes = transmittance(c1, n1, c2, n2);
                let reflected = self.unshadowed(2.0 * c1 * h_z - q, n1);
                let refracted = self.unshadowed(q - (c1 - c2) * h_z, n2);
                c1 * ((1.0 - passes) * (1.0 - reflected) + passes * (1.0 - refracted))
            });
            over_azimuth / h_z * 2.0 * sin * cos
        });
        self.smith(q, beta * beta) * lost / PI
    }
}

/// Node and weight of Gauss and Legendre's rule of this order on [-1, 1].
fn legendre_node(order: usize, k: usize) -> (f64, f64) {
    let n = order as f64;
    let mut x = (PI * (k as f64 + 0.75) / (n + 0.5)).cos();
    let mut slope = 0.0;
    // Newton from an estimate this good converges in four steps.
    for _ in 0..6 {
        let (mut previous, mut value) = (1.0, x);
        for l in 2..=order {
            let l = l as f64;
            (previous, value) = (value, ((2.0 * l - 1.0) * x * value - (l - 1.0) * previous) / l);
        }
        slope = n * (x * value - previous) / (x * x - 1.0);
        x -= value / slope;
    }
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

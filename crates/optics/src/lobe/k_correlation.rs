//! The k-correlation lobe.
//!
//! `b / (2 pi (b^2 + |beta_o - beta_i|^2)^(3/2))`, the generalised Harvey-Shack lobe with exponent 3/2
//! (Harvey 1976; Stover, *Optical Scattering*, the ABC or k-correlation model).
//!
//! **Parameter.** `width` b, in direction cosines, above 0; diffusers have 0.01 to 0.2. Half of the light
//! lies within `sqrt(3) b` of the regular direction.
//!
//! **Domain.** The whole plane: the lobe does not depend on the disc of a medium. Light that it scatters
//! beyond the disc of a medium does not leave. Two successive lobes are one of twice the width, which tests
//! the whole transport chain.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_sampling::warp;

use crate::scatterer::{Sample, Scatterer};
use crate::{Beta, with_widest_simd};

/// The k-correlation lobe of exponent 3/2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KCorrelation {
    /// b, in direction cosines, above 0.
    pub width: f64,
}

impl KCorrelation {
    /// Returns the density at the square of a distance `|beta_o - beta_i|`, per unit area of direction
    /// cosines.
    #[inline(always)]
    pub fn at_squared_distance(&self, squared: f64) -> f64 {
        let Self { width } = *self;
        let s = width * width + squared;
        width / (2.0 * PI * s * s.sqrt())
    }

    /// Returns the direction of [`sample`](Scatterer::sample).
    #[inline(always)]
    pub(super) fn sample_direction(&self, from: Beta, u: [f64; 2]) -> Beta {
        let radius = self.width * (1.0 / (u[0] * u[0]) - 1.0).sqrt();
        let (x, y) = warp::polar(radius, u[1]);
        from + Beta { x, y }
    }

    /// Returns the mean of the density between directions of these `|beta|` over the difference of their
    /// azimuths: a complete elliptic integral of the second kind.
    pub fn mean_over_azimuth(&self, a: f64, b: f64) -> f64 {
        let Self { width } = *self;
        let (near, far) = (width * width + (a - b) * (a - b), width * width + (a + b) * (a + b));
        let k_prime = (near / far).sqrt();
        let [second_kind] = complete_elliptic([k_prime], [[1.0, k_prime * k_prime, 1.0]]);
        width * second_kind / (PI * PI * near * far.sqrt())
    }

    /// Returns the fraction of the lobe within a distance of the regular direction.
    pub fn fraction_within(&self, radius: f64) -> f64 {
        let Self { width } = *self;
        let hypotenuse = width.hypot(radius);
        // 1 - b/sqrt(b^2 + r^2) without cancellation for wide lobes.
        radius * radius / (hypotenuse * (hypotenuse + width))
    }

    /// Returns fractions of lobes about points at these `|beta_i|` within the disc `|beta_o| <= radius`.
    ///
    /// Each is the solid angle, over 2 pi, of the disc seen from a height `width` above the point, in
    /// complete elliptic integrals (Paxton, Rev. Sci. Instrum. 30, 254 (1959)); error below 1e-12. Several
    /// are computed at once, so that divisions overlap.
    #[inline(always)]
    pub fn fractions_in_disc<const N: usize>(&self, offsets: [f64; N], radius: f64) -> [f64; N] {
        let Self { width } = *self;
        with_widest_simd(
            #[inline(always)]
            || fractions_of_lobes(width, offsets, radius),
        )
    }
}

impl Scatterer for KCorrelation {
    type Direction = Beta;

    #[inline(always)]
    fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        self.at_squared_distance((to - from).squared())
    }

    #[inline(always)]
    fn sample(&self, from: Beta, u: [f64; 4]) -> Option<Sample<Beta>> {
        let to = self.sample_direction(from, [u[0], u[1]]);
        Some(Sample::exact(to, self.density(from, to)))
    }

    #[inline(always)]
    fn density(&self, from: Beta, to: Beta) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, _: Beta) -> f64 {
        1.0
    }
}

/// Returns fractions within a disc of lobes about points at these offsets.
#[inline(always)]
fn fractions_of_lobes<const N: usize>(width: f64, offsets: [f64; N], radius: f64) -> [f64; N] {
    let distance = |across: f64| (width * width + across * across).sqrt();
    let farthest = offsets.map(|offset| distance(offset + radius));
    let k_prime = std::array::from_fn(|k| distance(offsets[k] - radius) / farthest[k]);
    let slopes = offsets.map(|offset| (radius - offset) / (radius + offset));
    // K + slope Pi(1 - slope^2), and K alone on the rim itself.
    let integrals = complete_elliptic(k_prime, slopes.map(numerator_and_pole));
    let within = |slope: f64| if slope == 0.0 { 0.5 } else { f64::from(u8::from(slope > 0.0)) };
    std::array::from_fn(|k| within(slopes[k]) - width / (PI * farthest[k]) * integrals[k])
}

/// Returns a, b and p of the [integral](complete_elliptic) that is K + slope Pi(1 - slope^2).
#[inline(always)]
fn numerator_and_pole(slope: f64) -> [f64; 3] {
    if slope == 0.0 { [1.0; 3] } else { [1.0 + slope, slope * (1.0 + slope), slope * slope] }
}

/// `integral from 0 to pi/2 of (a cos^2 + b sin^2)/((cos^2 + p sin^2) sqrt(cos^2 + k'^2 sin^2)) d phi`,
/// k' and p above 0 (Bulirsch's cel, Numer. Math. 13, 305 (1969)).
#[inline(always)]
fn complete_elliptic<const N: usize>(k_prime: [f64; N], integrals: [[f64; 3]; N]) -> [f64; N] {
    let mut p = integrals.map(|[_, _, p]| p.sqrt());
    let mut a = integrals.map(|[a, _, _]| a);
    let mut b: [f64; N] = std::array::from_fn(|k| integrals[k][1] / p[k]);
    let (mut e, mut m, mut kc) = (k_prime, [1.0; N], k_prime);
    loop {
        let mut converged = true;
        for k in 0..N {
            let f = a[k];
            a[k] += b[k] / p[k];
            let g = e[k] / p[k];
            b[k] = 2.0 * (b[k] + f * g);
            p[k] += g;
            // Convergence is quadratic: the next step's error is the square of this one.
            converged &= (m[k] - kc[k]).abs() <= 1e-8 * m[k];
            m[k] += kc[k];
            kc[k] = 2.0 * e[k].sqrt();
            e[k] = kc[k] * m[k];
        }
        if converged {
            return std::array::from_fn(|k| FRAC_PI_2 * (b[k] + a[k] * m[k]) / (m[k] * (m[k] + p[k])));
        }
    }
}

//! Phase functions and matrices: angular distribution of the light that a medium scatters.
//!
//! # Henyey-Greenstein
//! `p(cos) = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2))` per steradian, with `cos` that of the angle
//! between the directions of propagation before and after: 1 is the forward direction.
//!
//! **Parameter.** The anisotropy g, the mean cosine: -1 < g < 1. 0 is isotropic, above 0
//! forward; particles larger than the wavelength have 0.7 to 0.95.
//!
//! **Intuition.** Half of the light of g = 0.9 stays within 10 deg, yet a tenth goes beyond 41 deg. Its
//! Legendre moments are the powers of g, so that two successive deflections equal one with g^2.
//!
//! **Validity.** A fit with one parameter: no glory, no rainbow, no diffraction rings. The particles of a
//! dense medium do not scatter independently; g is then an effective parameter.
//!
//! Source: L. G. Henyey, J. L. Greenstein, Astrophys. J. 93, 70 (1941), eq. 2.
//!
//! Light that it scatters counts as unpolarised. Molecules and spheres have a [`PhaseMatrix`].

pub mod matrix;
pub mod mie;

use std::f64::consts::PI;

use papilio_sampling::warp;

use crate::scatterer::{Sample, Scatterer};
pub use matrix::{Elements, Particles, PhaseMatrix};

/// The phase function of Henyey and Greenstein.
///
/// ```
/// use papilio_optics::phase::HenyeyGreenstein;
/// let forward = HenyeyGreenstein { anisotropy: 0.75 };
/// // (1 + g)/(1 - g)^2 over 4 pi straight on.
/// assert!((forward.at_cosine(1.0) * 4.0 * std::f64::consts::PI - 28.0).abs() < 1e-12);
/// assert_eq!(forward.moment(1), 0.75);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreenstein {
    /// Mean cosine of the scattering angle, -1 to 1 (both excluded).
    pub anisotropy: f64,
}

impl HenyeyGreenstein {
    /// Returns the density per steradian at this cosine of the scattering angle; its integral over the
    /// sphere is one.
    #[inline]
    pub fn at_cosine(&self, cos: f64) -> f64 {
        let g = self.anisotropy;
        // 1 + g^2 - 2 g cos, as a sum of non-negative terms.
        let s = (1.0 - g.abs()).powi(2) + 2.0 * (g.abs() - g * cos);
        (1.0 - g * g) / (4.0 * PI * s * s.sqrt())
    }

    /// Samples the cosine of a scattering angle with [`Self::at_cosine`], from a uniform number; it
    /// increases with `u`. The azimuth is uniform.
    #[inline]
    pub fn sample_cosine(&self, u: f64) -> f64 {
        let g = self.anisotropy;
        // The usual inversion, rearranged: 1 - cos is a product, exact for every g, 0 included.
        let narrowing = (1.0 - g) / (1.0 - g + 2.0 * g * u);
        1.0 - 2.0 * (1.0 - u) * (1.0 + g * u) * narrowing * narrowing
    }

    /// Returns the Legendre moment of order `l`: the mean of P_l(cos), which is g^l.
    pub fn moment(&self, l: u32) -> f64 {
        (0..l).fold(1.0, |power, _| power * self.anisotropy)
    }
}

impl Scatterer for HenyeyGreenstein {
    /// A unit vector.
    type Direction = [f64; 3];

    #[inline]
    fn evaluate(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        self.at_cosine(from[0] * to[0] + from[1] * to[1] + from[2] * to[2])
    }

    #[inline]
    fn sample(&self, from: [f64; 3], u: [f64; 4]) -> Option<Sample<[f64; 3]>> {
        let cos = self.sample_cosine(u[0]);
        Some(Sample::exact(warp::deflected(from, 1.0 - cos, u[1]), self.at_cosine(cos)))
    }

    #[inline]
    fn density(&self, from: [f64; 3], to: [f64; 3]) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, _: [f64; 3]) -> f64 {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use papilio_sampling::{SampleStream, Sampler};
    use papilio_testing::ChiSquare;

    use super::*;

    const ANISOTROPIES: [f64; 8] = [-0.9, -0.3, -1e-9, 0.0, 1e-12, 0.4, 0.75, 0.98];

    /// Integral over the sphere of the density times `weight(cos)`: composite Gauss-Legendre rule of two
    /// points, in a variable that spreads the peak (cos = 1 - 2 v^4 towards it).
    fn integral(phase: HenyeyGreenstein, from: f64, to: f64, weight: impl Fn(f64) -> f64) -> f64 {
        let sign = 1.0_f64.copysign(phase.anisotropy);
        let v_of = |cos: f64| ((1.0 - sign * cos) / 2.0).powf(0.25);
        let (a, b) = (v_of(from), v_of(to));
        let steps = 4000;
        let width = (b - a) / f64::from(steps);
        let mut sum = 0.0;
        for step in 0..steps {
            for offset in [-1.0, 1.0] {
                let v = a + width * (f64::from(step) + 0.5 + offset * 0.5 / 3.0_f64.sqrt());
                let cos = sign * (1.0 - 2.0 * v.powi(4));
                sum += phase.at_cosine(cos) * weight(cos) * 8.0 * v.powi(3);
            }
        }
        2.0 * PI * sum * width.abs() / 2.0
    }

    fn legendre(l: u32, x: f64) -> f64 {
        let (mut previous, mut value) = (1.0, x);
        for k in 1..l {
            let (k, next) = (f64::from(k), value);
            value = ((2.0 * k + 1.0) * x * value - k * previous) / (k + 1.0);
            previous = next;
        }
        if l == 0 { 1.0 } else { value }
    }

    #[test]
    fn moments_equal_integrals_of_density() {
        for anisotropy in ANISOTROPIES {
            let phase = HenyeyGreenstein { anisotropy };
            for l in [0, 1, 2, 5, 12] {
                let found = integral(phase, -1.0, 1.0, |cos| legendre(l, cos));
                assert!((found - phase.moment(l)).abs() < 1e-9, "g {anisotropy}, l {l}: {found}");
            }
        }
    }

    /// The inversion as usually published, away from its 0/0.
    #[test]
    fn samples_equal_textbook_inversion() {
        for g in [-0.9, -0.3, 0.4, 0.98_f64] {
            for step in 0..=100 {
                let u = f64::from(step) / 100.0;
                let fraction = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
                let textbook = (1.0 + g * g - fraction * fraction) / (2.0 * g);
                let found = HenyeyGreenstein { anisotropy: g }.sample_cosine(u);
                assert!((found - textbook).abs() < 1e-12, "g {g}, u {u}: {found} {textbook}");
            }
        }
    }

    /// The integral of the density below the cosine that is sampled from u is u.
    #[test]
    fn samples_invert_cumulative_density() {
        for anisotropy in ANISOTROPIES {
            let phase = HenyeyGreenstein { anisotropy };
            for u in [0.0, 1e-3, 0.2, 0.5, 0.9, 0.999, 1.0] {
                let cos = phase.sample_cosine(u);
                assert!((-1.0..=1.0).contains(&cos), "g {anisotropy}, u {u}: {cos}");
                let found = integral(phase, -1.0, cos, |_| 1.0);
                assert!((found - u).abs() < 1e-9, "g {anisotropy}: {found} {u}");
            }
        }
    }

    /// Chi-square over 32 bins of equal width in the angle, and the mean cosine.
    fn chi_square(drawn: HenyeyGreenstein, claimed: HenyeyGreenstein) -> (ChiSquare, f64) {
        let numbers = SampleStream::new(Sampler::Random, 23, 0);
        let (samples, mut counts, mut sum) = (40_000, [0.0; 32], 0.0);
        for path in 0..samples {
            let cos = drawn.sample_cosine(numbers.block(path, 0)[0]);
            sum += cos;
            counts[((cos.acos() / PI * 32.0) as usize).min(31)] += 1.0;
        }
        let edge = |bin: usize| (PI * bin as f64 / 32.0).cos();
        let expected = |bin| samples as f64 * integral(claimed, edge(bin + 1), edge(bin), |_| 1.0);
        let cells = counts.iter().enumerate().map(|(bin, count)| (*count, expected(bin)));
        (ChiSquare::of(cells, 5.0), sum / samples as f64)
    }

    #[test]
    fn samples_follow_density() {
        for anisotropy in ANISOTROPIES {
            let phase = HenyeyGreenstein { anisotropy };
            let (found, mean) = chi_square(phase, phase);
            assert!(found.is_likely(), "g {anisotropy}: {found:?}");
            // Four sigma of a mean of 40 000 cosines, whose variance is (1 - g^2)/3.
            let sigma = ((1.0 - anisotropy * anisotropy) / 3.0 / 40_000.0).sqrt();
            assert!((mean - anisotropy).abs() < 4.0 * sigma, "g {anisotropy}: {mean}");
        }
    }

    #[test]
    fn slightly_wrong_anisotropy_is_refused() {
        let phase = |anisotropy| HenyeyGreenstein { anisotropy };
        assert!(!chi_square(phase(0.75), phase(0.73)).0.is_likely());
        assert!(!chi_square(phase(0.0), phase(0.03)).0.is_likely());
    }
}

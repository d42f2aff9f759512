//! Scattering of a plane wave by a sphere (Mie's theory).
//!
//! **Parameters.** The size parameter x, the circumference over the wavelength in the medium; the index of the sphere
//! over that of the medium, n + ik with k positive for absorption (fields exp(-i omega t)).
//!
//! **Validity.** Exact for one homogeneous sphere in a medium that does not absorb. The series has
//! `x + 4 x^(1/3) + 22` terms: 20 more than usual, without which the narrow resonances of clear spheres are missed (3e-6 of
//! the extinction at x = 100).
//!
//! Source: C. F. Bohren, D. R. Huffman, *Absorption and Scattering of Light by Small Particles* (1983), eq. 4.61, 4.74,
//! 4.88, section 4.8; mean cosine: p. 120.

use num_complex::Complex64;

/// Coefficients of the series of a sphere.
#[derive(Debug, Clone)]
pub struct Sphere {
    size_parameter: f64,
    /// a and b of each order, from 1.
    coefficients: Vec<[Complex64; 2]>,
}

impl Sphere {
    /// Returns a sphere of this size parameter, above 0, and relative index.
    pub fn new(size_parameter: f64, index: Complex64) -> Self {
        let x = size_parameter;
        let terms = (x + 4.0 * x.cbrt() + 22.0).ceil() as usize;
        let inside = logarithmic_derivatives(index * x, terms);
        let outside = logarithmic_derivatives(x.into(), terms);
        let (mut before, mut now) = ([x.cos(), -x.sin()], [x.sin(), x.cos()]);
        let mut coefficients = Vec::with_capacity(terms);
        for n in 1..=terms {
            let order = n as f64;
            // psi and chi of order n; xi = psi - i chi. Beyond x, psi falls, which upwards is not stable.
            let mut next: [f64; 2] = std::array::from_fn(|k| (2.0 * order - 1.0) / x * now[k] - before[k]);
            if order > x {
                next[0] = now[0] / (order / x + outside[n].re);
            }
            let xi = |[psi, chi]: [f64; 2]| Complex64::new(psi, -chi);
            let of = |derivative: Complex64| {
                let factor = derivative + order / x;
                (factor * next[0] - now[0]) / (factor * xi(next) - xi(now))
            };
            coefficients.push([of(inside[n] / index), of(inside[n] * index)]);
            (before, now) = (now, next);
        }
        Self { size_parameter, coefficients }
    }

    fn orders(&self) -> impl Iterator<Item = (f64, [Complex64; 2])> {
        self.coefficients.iter().enumerate().map(|(k, both)| ((k + 1) as f64, *both))
    }

    /// Returns the extinction efficiency: the cross section over that of the sphere.
    pub fn extinction(&self) -> f64 {
        let sum: f64 = self.orders().map(|(n, [a, b])| (2.0 * n + 1.0) * (a + b).re).sum();
        2.0 * sum / self.size_parameter.powi(2)
    }

    /// Returns the scattering efficiency.
    pub fn scattering(&self) -> f64 {
        let sum: f64 = self.orders().map(|(n, [a, b])| (2.0 * n + 1.0) * (a.norm_sqr() + b.norm_sqr())).sum();
        2.0 * sum / self.size_parameter.powi(2)
    }

    /// Returns the mean cosine of the scattering angle.
    pub fn mean_cosine(&self) -> f64 {
        let next = self.coefficients.iter().skip(1).chain(std::iter::once(&[Complex64::ZERO; 2]));
        let of = |((n, [a, b]), next): ((f64, [Complex64; 2]), &[Complex64; 2])| {
            let neighbours = (a * next[0].conj() + b * next[1].conj()).re;
            n * (n + 2.0) / (n + 1.0) * neighbours + (2.0 * n + 1.0) / (n * (n + 1.0)) * (a * b.conj()).re
        };
        let sum: f64 = self.orders().zip(next).map(of).sum();
        4.0 * sum / (self.size_parameter.powi(2) * self.scattering())
    }

    /// Returns the amplitudes across the scattering plane (S1) and in it (S2) at this cosine of the scattering angle.
    pub fn amplitudes(&self, cos: f64) -> [Complex64; 2] {
        let (mut before, mut now) = (0.0, 1.0);
        let mut sums = [Complex64::ZERO; 2];
        for (n, [a, b]) in self.orders() {
            let tau = n * cos * now - (n + 1.0) * before;
            let factor = (2.0 * n + 1.0) / (n * (n + 1.0));
            sums[0] += (a * now + b * tau) * factor;
            sums[1] += (a * tau + b * now) * factor;
            (before, now) = (now, ((2.0 * n + 1.0) * cos * now - (n + 1.0) * before) / n);
        }
        sums
    }
}

/// Returns the logarithmic derivatives of psi at z, by order from 0: downwards, which converges from any start.
fn logarithmic_derivatives(z: Complex64, terms: usize) -> Vec<Complex64> {
    let start = terms.max(z.norm().ceil() as usize) + 16;
    let mut derivatives = vec![Complex64::ZERO; start + 1];
    for n in (1..=start).rev() {
        let ratio = n as f64 / z;
        derivatives[n - 1] = ratio - (derivatives[n] + ratio).inv();
    }
    derivatives
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(what: &str, found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{what}: {found} instead of {expected}");
    }

    /// Bohren and Huffman, appendix A: x = 5.213 (radius 0.525 um at 0.6328 um), m = 1.55. S11 over that of 0 deg,
    /// -S12/S11, S33/S11, S34/S11.
    #[test]
    #[allow(clippy::approx_constant, reason = "0.785390 is no pi/4")]
    fn sphere_has_the_numbers_of_bohren_and_huffman() {
        const TABLE: [(f64, [f64; 4]); 9] = [
            (0.0, [1.0, 0.0, 1.0, 0.0]),
            (9.0, [0.785_390, -0.004_598_11, 0.999_400, 0.034_326_1]),
            (18.0, [0.356_897, -0.045_854_1, 0.986_022, 0.160_184]),
            (27.0, [0.076_611_9, -0.364_744, 0.843_603, 0.394_076]),
            (36.0, [0.035_535_5, -0.534_997, 0.686_967, -0.491_787]),
            (45.0, [0.070_184_5, 0.009_599_53, 0.959_825, -0.280_434]),
            (63.0, [0.021_966_0, -0.440_604, 0.648_043, 0.621_216]),
            (72.0, [0.012_595_9, -0.831_996, 0.203_255, -0.516_208]),
            (90.0, [0.012_460_1, 0.230_462, 0.937_497, 0.260_742]),
        ];
        let sphere = Sphere::new(2.0 * std::f64::consts::PI * 0.525 / 0.6328, 1.55.into());
        close("extinction", sphere.extinction(), 3.105_43, 1e-5);
        close("scattering", sphere.scattering(), 3.105_43, 1e-5);
        let ahead = sphere.amplitudes(1.0)[0].norm_sqr();
        for (theta_deg, expected) in TABLE {
            let [s1, s2] = sphere.amplitudes(f64::to_radians(theta_deg).cos());
            let sum = 0.5 * (s1.norm_sqr() + s2.norm_sqr());
            let polarised = 0.5 * (s1.norm_sqr() - s2.norm_sqr()) / sum;
            let crossed = s2 * s1.conj() / sum;
            for (found, expected) in
                [sum / ahead, polarised, crossed.re, crossed.im].into_iter().zip(expected)
            {
                close(&format!("{theta_deg} deg"), found, expected, 2e-6);
            }
        }
    }

    /// W. J. Wiscombe, NCAR/TN-140+STR (1979): extinction, scattering, mean cosine.
    #[test]
    fn spheres_have_the_numbers_of_wiscombe() {
        for (x, (n, k), [extinction, scattering, mean_cosine]) in [
            (10.0, (1.5, 0.0), [2.881_999, 2.881_999, 0.742_913]),
            (100.0, (1.5, 0.0), [2.094_388, 2.094_388, 0.818_246]),
            (1.0, (1.33, 1e-5), [0.093_952, 0.093_924, 0.184_517]),
            (100.0, (1.33, 1e-5), [2.101_321, 2.096_594, 0.868_959]),
            (1.0, (1.5, 1.0), [2.336_321, 0.663_454, 0.192_136]),
            (100.0, (1.5, 1.0), [2.097_502, 1.283_697, 0.850_252]),
        ] {
            let sphere = Sphere::new(x, Complex64::new(n, k));
            let what = format!("x {x}, m {n} + {k} i");
            close(&what, sphere.extinction(), extinction, 1.1e-6);
            close(&what, sphere.scattering(), scattering, 1.1e-6);
            close(&what, sphere.mean_cosine(), mean_cosine, 1.1e-6);
        }
    }
}

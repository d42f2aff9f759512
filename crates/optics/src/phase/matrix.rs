//! Phase matrices: what scattering by particles does to polarised light.
//!
//! # Convention
//! Stokes parameters refer to the scattering plane: p lies in it, s across it, (p, s, direction of travel) is
//! right-handed before and after, `Q = |p|^2 - |s|^2`, `U = 2 Re(p s*)`, `V = 2 Im(p s*)`, fields are exp(-i omega t).
//! Particles without a preferred orientation, as many as their mirror images, have six elements:
//!
//! ```text
//! I' = a1 I + b1 Q      U' =  a3 U + b2 V
//! Q' = b1 I + a2 Q      V' = -b2 U + a4 V
//! ```
//!
//! a1 is the phase function: its integral over the sphere is 1.
//!
//! # Molecules
//! Rayleigh scattering by particles much smaller than the wavelength, which may be anisotropic: the depolarisation
//! factor is the ratio of p to s in unpolarised light that is scattered by 90 deg, 0 to 0.5 (air: 0.028).
//! With `D = (1 - d)/(1 + d/2)`, `a1 = (3 D (1 + cos^2)/4 + 1 - D)/(4 pi)`.
//!
//! # Spheres
//! By Mie's theory, see [`mie`](super::mie): equal spheres, or a log-normal distribution of their radii.
//!
//! Source: J. E. Hansen, L. D. Travis, Space Sci. Rev. 16, 527 (1974), eq. 2.15, 2.16, 2.47, 2.53, 2.60.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;

use super::mie::Sphere;

/// Elements of a phase matrix at one scattering angle, per steradian.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Elements {
    /// Of I to I.
    pub a1: f64,
    /// Of Q to Q.
    pub a2: f64,
    /// Of U to U.
    pub a3: f64,
    /// Of V to V.
    pub a4: f64,
    /// Of I to Q, and of Q to I.
    pub b1: f64,
    /// Of V to U, and of U to -V.
    pub b2: f64,
}

impl Elements {
    /// Returns those of light that leaves unpolarised.
    pub fn depolarised(a1: f64) -> Self {
        Self { a1, ..Self::default() }
    }

    /// Returns those of the amplitudes across the scattering plane (S1) and in it (S2).
    fn of_amplitudes([s1, s2]: [Complex64; 2]) -> Self {
        let a1 = 0.5 * (s1.norm_sqr() + s2.norm_sqr());
        let crossed = s2 * s1.conj();
        let b1 = 0.5 * (s2.norm_sqr() - s1.norm_sqr());
        Self { a1, a2: a1, a3: crossed.re, a4: crossed.re, b1, b2: -crossed.im }
    }

    fn add(self, other: Self, weight: f64) -> Self {
        let Self { a1, a2, a3, a4, b1, b2 } = other;
        Self {
            a1: self.a1 + weight * a1,
            a2: self.a2 + weight * a2,
            a3: self.a3 + weight * a3,
            a4: self.a4 + weight * a4,
            b1: self.b1 + weight * b1,
            b2: self.b2 + weight * b2,
        }
    }

    /// Returns them times a factor.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self::default().add(self, factor)
    }
}

/// Particles, of which [`matrix`](Self::matrix) is the phase matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Particles {
    /// Molecules, or other particles much smaller than the wavelength.
    Molecules {
        /// Depolarisation factor, 0 to 0.5.
        depolarisation: f64,
    },
    /// Spheres.
    Spheres {
        /// Effective size parameter: circumference over wavelength in the medium, above 0 to [`Self::LARGEST_SIZE`].
        size_parameter: f64,
        /// Index over that of the medium.
        index: Complex64,
        /// Effective variance of a log-normal distribution of the radii, 0 (all equal) to 0.3.
        variance: f64,
    },
}

impl Particles {
    /// Largest size parameter of spheres, whose series and angles take a second.
    pub const LARGEST_SIZE: f64 = 100.0;

    /// Computes the phase matrix: for large spheres of different radii in up to a second.
    pub fn matrix(self) -> PhaseMatrix {
        match self {
            Self::Molecules { depolarisation } => PhaseMatrix::molecules(depolarisation),
            Self::Spheres { size_parameter, index, variance } => {
                PhaseMatrix::spheres(size_parameter, index, variance)
            }
        }
    }
}

/// Phase matrix of a medium.
///
/// ```
/// use papilio_optics::phase::PhaseMatrix;
/// // Light that small isotropic particles scatter by 90 deg is completely polarised across the scattering plane.
/// let at = PhaseMatrix::molecules(0.0).at_cosine(0.0);
/// assert_eq!(at.b1, -at.a1);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PhaseMatrix(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    Molecules { depolarisation: f64 },
    Spheres(Arc<Table>),
}

impl PhaseMatrix {
    /// Returns that of molecules of this depolarisation factor, 0 to 0.5.
    pub fn molecules(depolarisation: f64) -> Self {
        Self(Kind::Molecules { depolarisation })
    }

    /// Returns that of [`Particles::Spheres`].
    pub fn spheres(size_parameter: f64, index: Complex64, variance: f64) -> Self {
        Self(Kind::Spheres(Arc::new(Table::new(size_parameter, index, variance))))
    }

    /// Returns the elements at this cosine of the scattering angle.
    pub fn at_cosine(&self, cos: f64) -> Elements {
        match &self.0 {
            Kind::Molecules { depolarisation } => {
                let (d, square) = (*depolarisation, cos * cos);
                let anisotropic = (1.0 - d) / (1.0 + 0.5 * d);
                let a2 = 0.75 * anisotropic * (1.0 + square);
                let whole = Elements {
                    a1: a2 + 1.0 - anisotropic,
                    a2,
                    a3: 1.5 * anisotropic * cos,
                    a4: 1.5 * anisotropic * (1.0 - 2.0 * d) / (1.0 - d) * cos,
                    b1: -0.75 * anisotropic * (1.0 - square),
                    b2: 0.0,
                };
                whole.times(1.0 / (4.0 * PI))
            }
            Kind::Spheres(table) => table.at_cosine(cos),
        }
    }

    /// Samples the cosine of a scattering angle with the density a1, from a uniform number; the azimuth is uniform.
    pub fn sample_cosine(&self, u: f64) -> f64 {
        match &self.0 {
            Kind::Molecules { depolarisation } => {
                let anisotropic = (1.0 - depolarisation) / (1.0 + 0.5 * depolarisation);
                // cos^3 + 3 slope cos = 2 half, by Cardano's formula.
                let half = (4.0 * u - 2.0) / anisotropic;
                let slope = 1.0 + 4.0 * (1.0 - anisotropic) / (3.0 * anisotropic);
                let root = (half + (half * half + slope.powi(3)).sqrt()).cbrt();
                (root - slope / root).clamp(-1.0, 1.0)
            }
            Kind::Spheres(table) => table.sample_cosine(u),
        }
    }

    /// Returns the mean cosine of the scattering angle.
    pub fn mean_cosine(&self) -> f64 {
        match &self.0 {
            Kind::Molecules { .. } => 0.0,
            Kind::Spheres(table) => table.mean_cosine,
        }
    }
}

/// Elements that are linear in the cosine between nodes.
#[derive(Debug, PartialEq)]
struct Table {
    /// Ascending from -1 to 1.
    cosines: Vec<f64>,
    elements: Vec<Elements>,
    /// Integral of a1 over the sphere up to each node.
    below: Vec<f64>,
    mean_cosine: f64,
}

impl Table {
    fn new(size_parameter: f64, index: Complex64, variance: f64) -> Self {
        // The lobes of a sphere are about pi/x wide.
        let nodes = 400 + 20 * size_parameter.ceil() as usize;
        let cosines: Vec<f64> = (0..=nodes).map(|k| -(PI * k as f64 / nodes as f64).cos()).collect();
        let mut elements = vec![Elements::default(); nodes + 1];
        let (mut scattered, mut forward) = (0.0, 0.0);
        for (size, weight) in radii(size_parameter, variance) {
            let sphere = Sphere::new(size, index);
            let cross_section = weight * PI * size * size * sphere.scattering();
            scattered += cross_section;
            forward += cross_section * sphere.mean_cosine();
            for (sum, cos) in elements.iter_mut().zip(&cosines) {
                *sum = sum.add(Elements::of_amplitudes(sphere.amplitudes(*cos)), weight);
            }
        }
        let mean_cosine = forward / scattered;
        let mut below = vec![0.0];
        let mut sum = 0.0;
        for (cosines, elements) in cosines.windows(2).zip(elements.windows(2)) {
            sum += PI * (cosines[1] - cosines[0]) * (elements[0].a1 + elements[1].a1);
            below.push(sum);
        }
        // Linear interpolation loses some of the integral.
        elements.iter_mut().for_each(|one| *one = one.times(1.0 / sum));
        below.iter_mut().for_each(|one| *one /= sum);
        Self { cosines, elements, below, mean_cosine }
    }

    fn at_cosine(&self, cos: f64) -> Elements {
        let next = self.cosines.partition_point(|node| *node < cos).clamp(1, self.cosines.len() - 1);
        let [before, after] = [self.cosines[next - 1], self.cosines[next]];
        let share = ((cos - before) / (after - before)).clamp(0.0, 1.0);
        self.elements[next - 1].times(1.0 - share).add(self.elements[next], share)
    }

    fn sample_cosine(&self, u: f64) -> f64 {
        let next = self.below.partition_point(|below| *below < u).clamp(1, self.below.len() - 1);
        let [from, to] = [self.elements[next - 1].a1, self.elements[next].a1];
        let width = self.cosines[next] - self.cosines[next - 1];
        // The root of from t + (to - from) t^2/2 = rest, t from 0 to 1.
        let rest = (u - self.below[next - 1]).max(0.0) / (2.0 * PI * width);
        let t = 2.0 * rest / (from + (from * from + 2.0 * (to - from) * rest).max(0.0).sqrt());
        self.cosines[next - 1] + width * t.clamp(0.0, 1.0)
    }
}

/// Returns size parameters and their weights for a log-normal distribution: with `s^2 = ln(1 + variance)`, the effective
/// radius (the mean, weighted by the areas) is exp(5 s^2/2) times the median.
fn radii(effective: f64, variance: f64) -> Vec<(f64, f64)> {
    /// Number of radii.
    const COUNT: usize = 160;
    /// How far they reach, in standard deviations of ln r: below the mean weighted by the areas, as which large spheres
    /// scatter, and above that weighted by the sixth power of the radius, as which small ones do.
    const REACH: f64 = 4.0;
    if variance == 0.0 {
        return vec![(effective, 1.0)];
    }
    let square = variance.ln_1p();
    let (deviation, median) = (square.sqrt(), effective * (-2.5 * square).exp());
    let [least, most] = [2.0 * deviation - REACH, 6.0 * deviation + REACH];
    let at = |k: usize| {
        let z = least + (most - least) * (k as f64 + 0.5) / COUNT as f64;
        (median * (deviation * z).exp(), (-0.5 * z * z).exp())
    };
    (0..COUNT).map(at).collect()
}

#[cfg(test)]
mod tests {
    use papilio_sampling::{SampleStream, Sampler};

    use super::*;

    fn matrices() -> Vec<(&'static str, PhaseMatrix)> {
        let index = |re, im| Complex64::new(re, im);
        vec![
            ("isotropic molecules", PhaseMatrix::molecules(0.0)),
            ("air", PhaseMatrix::molecules(0.028)),
            ("completely anisotropic molecules", PhaseMatrix::molecules(0.5)),
            ("small spheres", PhaseMatrix::spheres(0.3, index(1.5, 0.0), 0.0)),
            ("spheres", PhaseMatrix::spheres(6.0, index(1.33, 0.0), 0.1)),
            ("absorbing spheres", PhaseMatrix::spheres(12.0, index(1.5, 0.1), 0.0)),
        ]
    }

    /// The mean over equal steps of the angle of a function on the sphere.
    fn integral(of: impl Fn(f64) -> f64) -> f64 {
        let steps = 20_000;
        let at = |k: i32| {
            let theta = PI * (f64::from(k) + 0.5) / f64::from(steps);
            2.0 * PI * theta.sin() * of(theta.cos())
        };
        (0..steps).map(at).sum::<f64>() * PI / f64::from(steps)
    }

    #[test]
    fn phase_functions_are_normalised_and_have_their_mean_cosine() {
        for (name, matrix) in matrices() {
            let [whole, mean] = [|_| 1.0, |cos: f64| cos]
                .map(|weight| integral(|cos| matrix.at_cosine(cos).a1 * weight(cos)));
            assert!((whole - 1.0).abs() < 1e-5, "{name}: {whole}");
            // By the coefficients of Mie's series, and by its angles.
            assert!((mean - matrix.mean_cosine()).abs() < 1e-4, "{name}: {mean} {}", matrix.mean_cosine());
        }
    }

    /// No light becomes more than completely polarised (J. W. Hovenier, H. C. van de Hulst, C. V. M. van der Mee, Astron.
    /// Astrophys. 157, 301 (1986)); what one sphere scatters of polarised light is completely polarised.
    #[test]
    fn matrices_are_those_of_light() {
        for (name, matrix) in matrices() {
            for step in 0..=180 {
                let cos = f64::from(step).to_radians().cos();
                let Elements { a1, a2, a3, a4, b1, b2 } = matrix.at_cosine(cos);
                let tiny = 1e-9 * a1 * a1;
                assert!(
                    (a3 + a4).powi(2) + 4.0 * b2 * b2 <= (a1 + a2).powi(2) - 4.0 * b1 * b1 + tiny,
                    "{name}"
                );
                assert!((a3 - a4).abs() <= a1 - a2 + tiny, "{name}");
                if name.starts_with("small") {
                    let rest = a1 * a1 - (b1 * b1 + b2 * b2 + a3 * a3);
                    assert!(rest.abs() < 1e-3 * a1 * a1, "{step}: {rest}");
                }
            }
        }
    }

    #[test]
    fn small_spheres_scatter_as_molecules() {
        let small = PhaseMatrix::spheres(1e-3, Complex64::new(1.5, 0.0), 0.0);
        let molecules = PhaseMatrix::molecules(0.0);
        for step in 0..=36 {
            let cos = f64::from(5 * step).to_radians().cos();
            let [found, expected] = [&small, &molecules].map(|matrix| matrix.at_cosine(cos));
            let Elements { a1, a2, a3, a4, b1, b2 } = found.add(expected, -1.0);
            let largest = [a1, a2, a3, a4, b1, b2].into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!(largest < 2e-6, "{step}: {largest}");
        }
    }

    /// The ratio of p to s of unpolarised light that is scattered by 90 deg.
    #[test]
    fn depolarisation_factor_is_that_of_light_scattered_by_a_right_angle() {
        let Elements { a1, b1, .. } = PhaseMatrix::molecules(0.028).at_cosine(0.0);
        assert!(((a1 + b1) / (a1 - b1) - 0.028).abs() < 1e-12);
    }

    /// The integral of the density below the cosine that is sampled from u is u.
    #[test]
    fn samples_invert_cumulative_densities() {
        let numbers = SampleStream::new(Sampler::Random, 5, 0);
        for (name, matrix) in matrices() {
            for path in 0..4 {
                let u = numbers.block(path, 0)[0];
                let cos = matrix.sample_cosine(u);
                let found = integral(|at| if at < cos { matrix.at_cosine(at).a1 } else { 0.0 });
                assert!((found - u).abs() < 2e-3, "{name}: {found} {u}");
            }
            assert!(
                matrix.sample_cosine(0.0) < -0.999 && matrix.sample_cosine(1.0 - 1e-12) > 0.999,
                "{name}"
            );
        }
    }

    /// Weighted by areas, the mean radius is the effective one, and the variance relative to its square the effective
    /// variance.
    #[test]
    fn radii_have_their_effective_mean_and_variance() {
        let radii = radii(3.0, 0.1);
        let moment = |power: i32| radii.iter().map(|(x, w)| w * x.powi(power)).sum::<f64>();
        let mean = moment(3) / moment(2);
        let variance = moment(4) / moment(2) / (mean * mean) - 1.0;
        assert!((mean - 3.0).abs() < 1e-3 && (variance - 0.1).abs() < 1e-3, "{mean} {variance}");
    }
}

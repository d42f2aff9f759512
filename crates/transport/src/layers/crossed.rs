//! What flat parts do to the product `p s*` of the amplitudes of light: complex factors, as a [`Flat`] has real ones for `|p|^2` and `|s|^2`.
//!
//! Frames as in [`mueller`](crate::Mueller): along the normal the amplitudes of reflected p and s have opposite signs. Fields are
//! `exp(-i omega t)`, so that the cosine of evanescent light is positive imaginary.

use num_complex::Complex64;

use super::{Incidence, Interface};
use crate::front::Flat;

/// Factors of `p s*`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossed {
    /// Transmitted, the same in both directions.
    pub(crate) t: Complex64,
    /// Reflected from above, and from below.
    pub(crate) above: Complex64,
    pub(crate) below: Complex64,
}

impl Crossed {
    /// Everything passes.
    pub(crate) const CLEAR: Self = Self { t: Complex64::ONE, above: Complex64::ZERO, below: Complex64::ZERO };

    /// That of a part with the same properties for s and p, of which amplitudes of p are reflected with this sign.
    pub(crate) fn of_both(flat: Flat, sign: f64) -> Self {
        let real = |x: f64| Complex64::new(x, 0.0);
        Self { t: real(flat.t), above: real(sign * flat.above), below: real(sign * flat.below) }
    }

    /// That of an interface, which reflects and transmits s and p in these ways; a coating is that of s, with its products. Sheets reflect as metal does
    /// along the normal; so do coatings without products.
    pub(crate) fn of(interface: &Interface, [s, p]: [Flat; 2], at: &Incidence) -> Self {
        let mean = |a: f64, b: f64| (a * b).max(0.0).sqrt();
        let both = Flat { t: mean(s.t, p.t), above: mean(s.above, p.above), below: mean(s.below, p.below) };
        match interface {
            Interface::Coating(coating) if let Some(found) = coating.products(at.beta_squared, at.bin) => {
                Self { t: found.transmitted, above: found.above, below: found.below }
            }
            Interface::Fresnel | Interface::FresnelOf(_) => {
                let [above, below] = at.indices;
                let t = Complex64::new(both.t, 0.0);
                let of = |indices| face(indices, at.beta_squared);
                Self { t, above: of([above, below]), below: of([below, above]) }
            }
            Interface::Component(_) | Interface::Coating(_) => Self::of_both(both, -1.0),
            _ => Self::of_both(both, 1.0),
        }
    }

    /// Combines this part with `lower` below it, all inter-reflections included.
    pub(crate) fn over(self, lower: Self) -> Self {
        let open = Complex64::ONE - self.below * lower.above;
        // Between two perfect mirrors nothing passes.
        let series = if open.norm() > 0.0 { open.inv() } else { Complex64::ZERO };
        Self {
            t: self.t * lower.t * series,
            above: self.above + self.t * self.t * lower.above * series,
            below: lower.below + lower.t * lower.t * self.below * series,
        }
    }
}

/// Product of the amplitudes with which a bare face reflects p, and the conjugate of that for s, of light from the first medium.
fn face(indices: [f64; 2], beta_squared: f64) -> Complex64 {
    let [n, m] = indices;
    let cosine = |index: f64| Complex64::new(1.0 - beta_squared / (index * index), 0.0).sqrt();
    let (c, d) = (cosine(n), cosine(m));
    if c.re <= 0.0 {
        // No light of the first medium, or grazing.
        return Complex64::ONE;
    }
    let s = (n * c - m * d) / (n * c + m * d);
    let p = (m * c - n * d) / (m * c + n * d);
    p * s.conj()
}

#[cfg(test)]
mod tests {
    use papilio_optics::interface::{fresnel_reflectance_p, fresnel_reflectance_s};

    use super::*;

    /// The size is that of the reflectances, the sign changes at Brewster's angle; total reflection shifts p against s by the angle of Born and Wolf
    /// (1.5.4): tan(delta/2) = cos(theta) sqrt(sin^2(theta) - n^2)/sin^2(theta).
    #[test]
    fn faces_reflect_with_the_phase_of_fresnel() {
        for (theta_deg, sign) in [(10.0_f64, -1.0), (50.0, -1.0), (60.0, 1.0), (80.0, 1.0)] {
            let beta = theta_deg.to_radians().sin();
            let size = (fresnel_reflectance_s(1.0, 1.5, beta) * fresnel_reflectance_p(1.0, 1.5, beta)).sqrt();
            let found = face([1.0, 1.5], beta * beta);
            assert!((found - Complex64::new(sign * size, 0.0)).norm() < 1e-12, "{theta_deg}: {found}");
        }
        let theta = 55.0_f64.to_radians();
        let found = face([1.5, 1.0], (1.5 * theta.sin()).powi(2));
        let ratio: f64 = 1.0 / 1.5;
        let shift =
            2.0 * (theta.cos() * (theta.sin().powi(2) - ratio.powi(2)).sqrt() / theta.sin().powi(2)).atan();
        assert!((found.norm() - 1.0).abs() < 1e-12);
        assert!((found.arg().abs() - shift).abs() < 1e-9, "{found} {shift}");
    }
}

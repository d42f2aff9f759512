//! A diffuse reflector below a flat face: what an instrument measures through the face, and the reflector's
//! own reflectance.
//!
//! **What.** A Lambertian reflector of reflectance `rho` in a medium of index n, optical contact, diffuse
//! unpolarised light on a flat face towards air, seen at an angle theta. The face reflects `F(theta)` of the
//! light of the view's own direction, `r_e` of diffuse light from outside and `r_i` of diffuse light from
//! inside, `1 - r_i = (1 - r_e)/n^2`. All orders between face and reflector:
//!
//! `R = F(theta) + (1 - F(theta)) (1 - r_i) rho/(1 - r_i rho)`.
//!
//! An instrument that excludes the specular component traps the first term. The inverse is
//! `rho = q/(1 - r_i + r_i q)`, `q = (R - F(theta))/(1 - F(theta))`.
//!
//! **Validity.** 1 < n; the same face and medium everywhere; no scattering by the face. By reciprocity the
//! same holds for light at theta and diffuse collection (8/d).
//!
//! **Intuition.** The face makes a reflector darker, mid-tones most: 0.6213 below glass of 1.5 is seen as
//! 0.40 and the image of the room.
//!
//! **Source.** J. L. Saunderson, J. Opt. Soc. Am. 32, 727 (1942); the closed form of `r_e` by S. Q. Duntley,
//! J. Opt. Soc. Am. 32, 61 (1942).

use crate::interface::fresnel_reflectance;

/// A flat face towards air, as an instrument with diffuse light sees through it.
///
/// ```
/// use papilio_optics::saunderson::DiffuseFace;
/// let face = DiffuseFace::new(1.5, 8.0);
/// assert!((face.external() - 0.09178).abs() < 1e-5 && (face.internal() - 0.59635).abs() < 1e-5);
/// assert!((face.own(face.through(0.6)) - 0.6).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiffuseFace {
    view: f64,
    external: f64,
    internal: f64,
    is_excluded: bool,
}

impl DiffuseFace {
    /// Returns the face of a medium of this index, above 1, seen at an angle in air, degrees; the specular
    /// component is included.
    pub fn new(index: f64, theta_deg: f64) -> Self {
        let external = diffuse_reflectance(index);
        let internal = 1.0 - (1.0 - external) / (index * index);
        let view = fresnel_reflectance(1.0, index, theta_deg.to_radians().sin());
        Self { view, external, internal, is_excluded: false }
    }

    /// Returns the same face, seen without the light that it reflects itself.
    #[must_use]
    pub fn without_specular(self) -> Self {
        Self { is_excluded: true, ..self }
    }

    /// Its reflectance in the direction of the view.
    pub fn view(&self) -> f64 {
        self.view
    }

    /// Its reflectance for diffuse light from the air.
    pub fn external(&self) -> f64 {
        self.external
    }

    /// Its reflectance for diffuse light from the medium.
    pub fn internal(&self) -> f64 {
        self.internal
    }

    /// What is seen above a black reflector.
    pub fn least(&self) -> f64 {
        if self.is_excluded { 0.0 } else { self.view }
    }

    /// What is seen above a perfect white one.
    pub fn most(&self) -> f64 {
        self.least() + 1.0 - self.view
    }

    /// Returns the reflectance factor that is seen above a reflector.
    pub fn through(&self, reflectance: f64) -> f64 {
        let seen = (1.0 - self.internal) * reflectance / (1.0 - self.internal * reflectance);
        self.least() + (1.0 - self.view) * seen
    }

    /// Returns the reflectance of the reflector above which this reflectance factor is seen: between 0 and 1
    /// if that is between [`least`](Self::least) and [`most`](Self::most).
    pub fn own(&self, seen: f64) -> f64 {
        let seen = (seen - self.least()) / (1.0 - self.view);
        seen / (1.0 - self.internal + self.internal * seen)
    }
}

/// Reflectance of a flat face for diffuse unpolarised light from the rarer side, for a ratio of the indices
/// above 1.
fn diffuse_reflectance(n: f64) -> f64 {
    let (n2, n4) = (n * n, n.powi(4));
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form against Fresnel's reflectance, integrated by the midpoint rule in sin^2(theta).
    #[test]
    fn diffuse_reflectances_equal_integrals_of_fresnel_reflectance() {
        for n in [1.05, 1.33, 1.5, 1.8, 2.5] {
            let face = DiffuseFace::new(n, 8.0);
            let count = 200_000;
            let mean = |inside: f64| {
                let at = |k: u32| inside * ((f64::from(k) + 0.5) / f64::from(count)).sqrt();
                let sum: f64 = (0..count).map(|k| fresnel_reflectance(1.0, n, at(k))).sum();
                sum / f64::from(count)
            };
            assert!((face.external() - mean(1.0)).abs() < 2e-5, "{n}: {} {}", face.external(), mean(1.0));
            assert!((face.internal() - mean(n)).abs() < 2e-5, "{n}: {} {}", face.internal(), mean(n));
        }
    }

    /// Values of the textbooks for n = 1.5: 0.092 and 0.596; a paper of 0.6213 is seen as 0.40 without the
    /// specular component.
    #[test]
    fn glass_has_known_values() {
        let face = DiffuseFace::new(1.5, 8.0);
        assert!((face.external() - 0.091_778).abs() < 1e-6 && (face.internal() - 0.596_346).abs() < 1e-6);
        assert!((face.view() - 0.040_003).abs() < 2e-5);
        assert_eq!(face.through(0.0), face.view());
        assert!((face.through(1.0) - 1.0).abs() < 1e-15 && (face.most() - 1.0).abs() < 1e-15);
        let trap = face.without_specular();
        assert!((trap.through(0.0)).abs() < 1e-15 && (trap.through(1.0) - trap.most()).abs() < 1e-15);
        for rho in [0.0, 0.03, 0.45, 1.0] {
            assert!((face.own(face.through(rho)) - rho).abs() < 1e-14);
            assert!((trap.own(trap.through(rho)) - rho).abs() < 1e-14);
        }
    }
}

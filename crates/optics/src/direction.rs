//! Direction cosines: the coordinate that every flat layer conserves.

use std::ops::{Add, Mul, Neg, Sub};

/// `beta = n sin(theta) (cos phi, sin phi)`: the tangential part of a light ray's *propagation*, times the
/// index of the medium in which it propagates.
///
/// Flat interfaces conserve it (Snell's law), and so do mirrors: light that the display mirrors from a
/// source to the reader has the same `beta` everywhere. For a source in direction (theta, phi), seen from
/// the display, it is therefore *minus* `n sin(theta) (cos phi, sin phi)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beta {
    /// Along phi = 0.
    pub x: f64,
    /// Along phi = 90 deg.
    pub y: f64,
}

impl Beta {
    /// Returns beta of light that leaves the display towards (theta, phi), angles in degrees in a medium of
    /// this index.
    pub fn towards(theta_deg: f64, phi_deg: f64, index: f64) -> Self {
        let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
        let radius = index * sine_of_inclination(theta_deg);
        Self { x: radius * cos_phi, y: radius * sin_phi }
    }

    /// Returns beta of light that reaches the display from a source in direction (theta, phi).
    pub fn from_source(theta_deg: f64, phi_deg: f64, index: f64) -> Self {
        -Self::towards(theta_deg, phi_deg, index)
    }

    /// Returns `|beta|^2`.
    pub fn squared(self) -> f64 {
        self.x * self.x + self.y * self.y
    }

    /// Returns `|beta|`.
    pub fn length(self) -> f64 {
        self.squared().sqrt()
    }
}

/// Returns the sine of an inclination of at most 90 deg, degrees, below 1 by more than rounding errors.
///
/// From 89.9999994 deg on the nearest number is 1, and `|beta|^2`, a sum of two rounded squares, may be
/// above it: such light would not exist in its medium. It is treated as light at 89.9999983 deg.
pub fn sine_of_inclination(theta_deg: f64) -> f64 {
    const LARGEST: f64 = 1.0 - 2.0 * f64::EPSILON;
    theta_deg.to_radians().sin().clamp(-LARGEST, LARGEST)
}

impl Add for Beta {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl Sub for Beta {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }
}

impl Mul<Beta> for f64 {
    type Output = Beta;
    fn mul(self, beta: Beta) -> Beta {
        Beta { x: self * beta.x, y: self * beta.y }
    }
}

impl Neg for Beta {
    type Output = Self;
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light just above the horizon exists in its medium, from every azimuth and in every index.
    #[test]
    fn beta_of_grazing_light_is_below_index() {
        for index in [1.0, 1.000_29, 1.33, 1.5, 2.461_9, 10.0] {
            for theta in [89.999_999, 89.999_999_9, 89.999_999_999_999, 90.0] {
                for phi in (0..3600).map(|tenth| f64::from(tenth) * 0.1) {
                    for beta in [Beta::towards(theta, phi, index), Beta::from_source(theta, phi, index)] {
                        assert!(beta.squared() < index * index, "{index} {theta} {phi}");
                        assert!(beta.length() > index * (1.0 - 1e-14));
                    }
                }
            }
        }
        // Smaller inclinations are unchanged.
        assert_eq!(Beta::towards(89.999_99, 0.0, 1.0).x, 89.999_99_f64.to_radians().sin());
    }
}

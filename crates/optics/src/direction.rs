//! Direction cosines: the coordinate that every flat layer conserves.

use std::ops::{Add, Neg, Sub};

/// `beta = n sin(theta) (cos phi, sin phi)`: the tangential part of a light ray's
/// *propagation*, times the index of the medium that it travels in.
///
/// A flat interface conserves it (Snell), a mirror too: light that the display
/// mirrors from a source to the reader has one `beta` all the way. Of a source in
/// direction (theta, phi), seen from the display, it is therefore *minus*
/// `n sin(theta) (cos phi, sin phi)`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Beta {
    /// Along phi = 0.
    pub x: f64,
    /// Along phi = 90 deg.
    pub y: f64,
}

impl Beta {
    /// Light that leaves the display towards (theta, phi), angles in degrees in a medium of this index.
    pub fn towards(theta_deg: f64, phi_deg: f64, index: f64) -> Self {
        let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
        let radius = index * theta_deg.to_radians().sin();
        Self { x: radius * cos_phi, y: radius * sin_phi }
    }

    /// Light that reaches the display from a source in direction (theta, phi).
    pub fn from_source(theta_deg: f64, phi_deg: f64, index: f64) -> Self {
        -Self::towards(theta_deg, phi_deg, index)
    }

    /// `|beta|^2`.
    pub fn squared(self) -> f64 {
        self.x * self.x + self.y * self.y
    }

    /// `|beta|`.
    pub fn length(self) -> f64 {
        self.squared().sqrt()
    }
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

impl Neg for Beta {
    type Output = Self;
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

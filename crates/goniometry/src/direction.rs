//! Directions as goniometers give them.

use papilio_optics::Beta;

/// A direction that points away from the sample, on the side where the light is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Direction {
    /// From the normal of that side, degrees, 0 to 90.
    pub theta_deg: f64,
    /// Azimuth, degrees, alike on both sides.
    pub phi_deg: f64,
}

impl Direction {
    /// From its angles, degrees.
    pub fn new(theta_deg: f64, phi_deg: f64) -> Self {
        Self { theta_deg, phi_deg }
    }

    /// Of a vector whose z is along the normal of its side; it need not have unit length.
    pub fn of_vector([x, y, z]: [f64; 3]) -> Self {
        Self { theta_deg: x.hypot(y).atan2(z).to_degrees(), phi_deg: y.atan2(x).to_degrees() }
    }

    /// Unit vector, z along the normal of its side.
    pub fn vector(self) -> [f64; 3] {
        let (sin, cos) = self.theta_deg.to_radians().sin_cos();
        let (sin_phi, cos_phi) = self.phi_deg.to_radians().sin_cos();
        [sin * cos_phi, sin * sin_phi, cos]
    }

    /// Where light from here goes when it keeps its direction, or is mirrored.
    pub fn specular(self) -> Self {
        Self { theta_deg: self.theta_deg, phi_deg: self.phi_deg + 180.0 }
    }

    /// Direction cosines of light that leaves this way, in air.
    pub fn leaving(self) -> Beta {
        Beta::towards(self.theta_deg, self.phi_deg, 1.0)
    }

    /// Direction cosines of light that comes from here, in air.
    pub fn arriving(self) -> Beta {
        Beta::from_source(self.theta_deg, self.phi_deg, 1.0)
    }
}

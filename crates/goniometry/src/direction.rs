//! Directions of goniometric measurements.

use papilio_optics::Beta;

/// Direction that points away from the sample, on the side of the light.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Direction {
    /// Inclination from the normal of that side, degrees, 0 to 90.
    pub theta_deg: f64,
    /// Azimuth, degrees, in the same coordinates on both sides.
    pub phi_deg: f64,
}

impl Direction {
    /// Direction from its angles, degrees.
    pub fn new(theta_deg: f64, phi_deg: f64) -> Self {
        Self { theta_deg, phi_deg }
    }

    /// Direction of a vector whose z is along the normal of its side; it need not have unit length.
    pub fn of_vector([x, y, z]: [f64; 3]) -> Self {
        Self { theta_deg: x.hypot(y).atan2(z).to_degrees(), phi_deg: y.atan2(x).to_degrees() }
    }

    /// Returns the unit vector, with z along the normal of its side.
    pub fn vector(self) -> [f64; 3] {
        let (sin, cos) = self.theta_deg.to_radians().sin_cos();
        let (sin_phi, cos_phi) = self.phi_deg.to_radians().sin_cos();
        [sin * cos_phi, sin * sin_phi, cos]
    }

    /// Specular direction: the continuation (transmission) or mirror direction (reflection) of light from
    /// here.
    pub fn specular(self) -> Self {
        Self { theta_deg: self.theta_deg, phi_deg: self.phi_deg + 180.0 }
    }

    /// Direction cosines of light that leaves in this direction, in air.
    pub fn leaving(self) -> Beta {
        Beta::towards(self.theta_deg, self.phi_deg, 1.0)
    }

    /// Direction cosines of light that arrives from this direction, in air.
    pub fn arriving(self) -> Beta {
        Beta::from_source(self.theta_deg, self.phi_deg, 1.0)
    }
}

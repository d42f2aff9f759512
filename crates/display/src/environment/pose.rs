//! Orientation of the display in its environment.
//!
//! The z axis of the world points to the zenith. Azimuths of the world are measured from the display's x
//! axis, counterclockwise seen from above. A display of tilt 0 is horizontal and faces the zenith. Tilt
//! rotates it about its x axis, so that its upper edge (phi = 90 deg) rises: at 90 deg it is upright and
//! faces azimuth -90 deg.

/// Tilt of the display from the horizontal.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Tilt, degrees, 0 to 180. The display faces the zenith at 0, the horizon at 90, and the ground at 180.
    pub tilt_deg: f64,
}

impl Pose {
    /// Converts a unit vector from the display's frame (z along the normal) to that of the world (z up).
    pub fn to_world(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.tilt_deg.to_radians().sin_cos();
        [x, cos * y - sin * z, sin * y + cos * z]
    }

    /// Returns the inclination and azimuth in the display's frame, degrees, of a direction given by its
    /// elevation and azimuth in the world.
    pub fn sees(self, direction_deg: [f64; 2]) -> (f64, f64) {
        let [x, y, z] = self.towards(direction_deg);
        (x.hypot(y).atan2(z).to_degrees(), y.atan2(x).to_degrees())
    }

    /// Returns the unit vector in the display's frame of a direction given by its elevation and azimuth in the world.
    pub fn towards(self, [elevation_deg, azimuth_deg]: [f64; 2]) -> [f64; 3] {
        self.to_display(by_elevation(elevation_deg, azimuth_deg))
    }

    /// Converts a unit vector from the frame of the world to that of the display.
    pub fn to_display(self, world: [f64; 3]) -> [f64; 3] {
        Self { tilt_deg: -self.tilt_deg }.to_world(world)
    }
}

/// Returns the unit vector of an elevation above the horizon and azimuth, degrees.
pub(crate) fn by_elevation(elevation_deg: f64, azimuth_deg: f64) -> [f64; 3] {
    let ((sin, cos), (sin_azimuth, cos_azimuth)) =
        (elevation_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    [cos * cos_azimuth, cos * sin_azimuth, sin]
}

/// Returns the unit vector of an inclination from the z axis and an azimuth, radians.
pub(crate) fn by_inclination(theta: f64, phi: f64) -> [f64; 3] {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    [sin * cos_phi, sin * sin_phi, cos]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn upright_display_faces_the_horizon_with_its_upper_edge_up() {
        let upright = Pose { tilt_deg: 90.0 };
        near(upright.to_world([0.0, 0.0, 1.0]), by_elevation(0.0, -90.0));
        near(upright.to_world([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        near(Pose::default().to_world([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        let some = Pose { tilt_deg: 33.0 };
        near(some.to_display(some.to_world([0.6, 0.0, 0.8])), [0.6, 0.0, 0.8]);
    }
}

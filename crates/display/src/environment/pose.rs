//! How the display stands in the world around it.
//!
//! The world's zenith is up; its azimuths are counted from the display's x axis, counterclockwise seen from
//! above. A display of tilt 0 lies flat and faces the zenith. Tilt turns it about its x axis, so that its upper
//! edge (phi = 90 deg) rises: at 90 deg it stands upright and faces azimuth -90 deg.

/// The display's tilt out of the horizontal, degrees, 0 to 180.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// 0: it faces the zenith; 90: the horizon; 180: the ground.
    pub tilt_deg: f64,
}

impl Pose {
    /// The direction in the world, a unit vector (z up), of one in the display's frame (z its normal).
    pub fn to_world(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.tilt_deg.to_radians().sin_cos();
        [x, cos * y - sin * z, sin * y + cos * z]
    }

    /// Inclination from the display's normal and azimuth there, degrees, of what stands at this elevation and
    /// azimuth of the world.
    pub fn sees(self, [elevation_deg, azimuth_deg]: [f64; 2]) -> (f64, f64) {
        let [x, y, z] = self.to_display(by_elevation(elevation_deg, azimuth_deg));
        (x.hypot(y).atan2(z).to_degrees(), y.atan2(x).to_degrees())
    }

    /// The way back.
    pub fn to_display(self, world: [f64; 3]) -> [f64; 3] {
        Self { tilt_deg: -self.tilt_deg }.to_world(world)
    }
}

/// A unit vector by elevation above the horizon and azimuth, degrees.
pub(crate) fn by_elevation(elevation_deg: f64, azimuth_deg: f64) -> [f64; 3] {
    let ((sin, cos), (sin_azimuth, cos_azimuth)) =
        (elevation_deg.to_radians().sin_cos(), azimuth_deg.to_radians().sin_cos());
    [cos * cos_azimuth, cos * sin_azimuth, sin]
}

/// A unit vector by inclination from the z axis and azimuth, radians.
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
    fn an_upright_display_faces_the_horizon_and_its_top_is_up() {
        let upright = Pose { tilt_deg: 90.0 };
        near(upright.to_world([0.0, 0.0, 1.0]), by_elevation(0.0, -90.0));
        near(upright.to_world([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        near(Pose::default().to_world([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
        let some = Pose { tilt_deg: 33.0 };
        near(some.to_display(some.to_world([0.6, 0.0, 0.8])), [0.6, 0.0, 0.8]);
    }
}

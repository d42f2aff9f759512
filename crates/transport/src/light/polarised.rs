//! Which part of the light from a direction vibrates across the plane of incidence (s), and which in it (p).
//!
//! Flat layers keep s apart from p, and return of each what they return of it alone. What else polarised light has, the
//! phase between s and p, is lost where it is not seen: without a polariser between s and p before the eye. Pixels that turn polarisation, and views
//! along the normal, need all of it ([`light_of`]), in a frame ([`Frame`]).

use std::f64::consts::SQRT_2;

use papilio_optics::Beta;

/// Light by its coherency matrix in the frame of p and s: `|p|^2`, `|s|^2`, `sqrt 2 Re(p s*)`, `sqrt 2 Im(p s*)`; or what a meter makes of each.
pub(crate) type Quartet = [f64; 4];

/// Frame of light in air: (p, s, direction of travel) is right-handed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    p: [f64; 3],
    s: [f64; 3],
    travel: [f64; 3],
}

impl Frame {
    /// Returns the frame of light that propagates with these direction cosines, up (`sign` 1) or down (-1); along the normal it is that of azimuth 0.
    pub(crate) fn new(beta: Beta, sign: f64) -> Self {
        let travel = [beta.x, beta.y, sign * (1.0 - beta.squared()).max(0.0).sqrt()];
        let length = beta.length();
        let (x, y) = if length > 0.0 { (beta.x / length, beta.y / length) } else { (1.0, 0.0) };
        let s = [y, -x, 0.0];
        Self { p: cross(s, travel), s, travel }
    }

    /// Returns the frames of light that is scattered from the travel of one frame to that of another: p of both lies in
    /// the scattering plane.
    pub(crate) fn of_scattering(arriving: Self, leaving: Self) -> [Self; 2] {
        let normal = cross(arriving.travel, leaving.travel);
        let length = dot(normal, normal).sqrt();
        // Straight on and back, any plane is one.
        let s = if length > 0.0 { normal.map(|x| x / length) } else { leaving.s };
        [arriving, leaving].map(|Self { travel, .. }| Self { p: cross(s, travel), s, travel })
    }

    /// Returns the cosine and sine of twice the angle by which this frame is turned to become another of the same travel: as
    /// such, `Q' = Q cos + U sin` and `U' = U cos - Q sin`.
    pub(crate) fn turn(&self, other: Self) -> [f64; 2] {
        let [cos, sin] = self.components(other.p);
        [cos * cos - sin * sin, 2.0 * cos * sin]
    }

    pub(crate) fn travel(&self) -> [f64; 3] {
        self.travel
    }

    /// The direction of p.
    pub(crate) fn along_p(&self) -> Across {
        Across { field: self.p, travel: self.travel }
    }

    /// Returns the components of a field along p and s.
    pub(crate) fn components(&self, field: [f64; 3]) -> [f64; 2] {
        [dot(self.p, field), dot(self.s, field)]
    }
}

/// A direction of vibration, across a direction of travel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Across {
    pub(crate) field: [f64; 3],
    pub(crate) travel: [f64; 3],
}

impl Across {
    /// Returns the field turned with the travel, on the shortest way, to another direction.
    pub(crate) fn towards(&self, travel: [f64; 3]) -> [f64; 3] {
        let scale = dot(self.field, travel) / (1.0 + dot(self.travel, travel));
        std::array::from_fn(|k| self.field[k] - scale * (self.travel[k] + travel[k]))
    }
}

/// Returns light of unit intensity that propagates down with these direction cosines. That of a lamp vibrates in its centre, from where light has the
/// direction cosines `centre`, at its angle, and elsewhere as there.
pub(crate) fn light_of(vibration: &Vibration, centre: Option<Beta>, beta: Beta) -> Quartet {
    let frame = Frame::new(beta, -1.0);
    let (degree, [p, s]) = match *vibration {
        Vibration::Fixed { degree, angle } => {
            let own = Frame::new(centre.unwrap_or(beta), -1.0);
            // Counter-clockwise as seen from the lamp, who sees s reversed.
            let (sin, cos) = angle.sin_cos();
            let field = std::array::from_fn(|k| cos * own.p[k] - sin * own.s[k]);
            (degree, frame.components(Across { field, travel: own.travel }.towards(frame.travel)))
        }
        Vibration::Rayleigh { most, sun, zenith } => {
            let direction = frame.travel.map(|x| -x);
            let field = cross(direction, sun);
            if dot(direction, zenith) <= 0.0 || dot(field, field) == 0.0 {
                (0.0, [1.0, 0.0])
            } else {
                let (square, cosine) = (dot(field, field), dot(direction, sun));
                let length = square.sqrt();
                (most * square / (1.0 + cosine * cosine), frame.components(field.map(|x| x / length)))
            }
        }
    };
    let rest = 0.5 * (1.0 - degree);
    [rest + degree * p * p, rest + degree * s * s, SQRT_2 * degree * p * s, 0.0]
}

/// The vibration of partly polarised light, by direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Vibration {
    /// The same in all directions of a lamp.
    Fixed {
        /// Degree of linear polarisation, 0 to 1.
        degree: f64,
        /// Angle of the field from the plane of incidence of the centre, radians, counter-clockwise as seen from the lamp: 0 is p.
        angle: f64,
    },
    /// Of a clear sky: across the plane of sun and direction, with the degree `most sin^2/(1 + cos^2)` of the angle
    /// between them (J. W. Strutt (Lord Rayleigh), 1871, for single scattering by molecules, scaled to what other
    /// scattering leaves of it). Light from below the horizon is unpolarised.
    Rayleigh {
        /// Degree at 90 deg from the sun.
        most: f64,
        /// Unit vector to the sun, in the frame of the display.
        sun: [f64; 3],
        /// Unit vector to the zenith.
        zenith: [f64; 3],
    },
}

impl Vibration {
    /// Returns the vibration of light of which this fraction is as polarised, and the rest unpolarised.
    #[must_use]
    pub fn times(self, fraction: f64) -> Self {
        match self {
            Self::Fixed { degree, angle } => Self::Fixed { degree: fraction * degree, angle },
            Self::Rayleigh { most, sun, zenith } => Self::Rayleigh { most: fraction * most, sun, zenith },
        }
    }

    /// Returns the shares of s and of p in light that comes from this direction: a unit vector away from the display.
    pub fn shares(&self, direction: [f64; 3]) -> [f64; 2] {
        let more = self.more_s(direction);
        [0.5 * (1.0 + more), 0.5 * (1.0 - more)]
    }

    /// Returns the share of s less that of p.
    fn more_s(&self, direction: [f64; 3]) -> f64 {
        match self {
            Self::Fixed { degree, angle } => -degree * (2.0 * angle).cos(),
            Self::Rayleigh { most, sun, zenith } => {
                // Across the plane of incidence.
                let across = [-direction[1], direction[0], 0.0];
                let square = dot(across, across);
                if square == 0.0 || dot(direction, *zenith) <= 0.0 {
                    return 0.0;
                }
                let field = cross(direction, *sun);
                let cosine = dot(direction, *sun);
                // Of the degree, cos 2 chi with the angle chi between field and s.
                let aligned = 2.0 * dot(field, across).powi(2) / square - dot(field, field);
                most * aligned / (1.0 + cosine * cosine)
            }
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn towards(theta_deg: f64, phi_deg: f64) -> [f64; 3] {
        let ((sin, cos), (sin_phi, cos_phi)) =
            (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
        [sin * cos_phi, sin * sin_phi, cos]
    }

    /// In the plane of the sun all light vibrates across it (s); 90 deg from it, with the largest degree. From the sun
    /// itself, and from the ground, it is unpolarised.
    #[test]
    fn sky_vibrates_across_the_plane_of_the_sun() {
        let zenith = [0.0, 0.0, 1.0];
        let sky = |theta, phi| Vibration::Rayleigh { most: 0.75, sun: towards(theta, phi), zenith };
        let close = |found: [f64; 2], s: f64| {
            assert!((found[0] - s).abs() < 1e-12 && (found[1] - (1.0 - s)).abs() < 1e-12, "{found:?} {s}");
        };
        close(sky(50.0, 30.0).shares(towards(40.0, 210.0)), 0.875);
        // 60 deg from the sun: 0.75 x 0.75/1.25.
        close(sky(50.0, 30.0).shares(towards(10.0, 210.0)), 0.5 * (1.0 + 0.45));
        close(sky(50.0, 30.0).shares(towards(50.0, 30.0)), 0.5);
        // A sun on the horizon at a right angle to the view: the sky there vibrates in the vertical plane (p).
        close(sky(90.0, 0.0).shares(towards(60.0, 90.0)), 0.125);
        // Half-way between: a spherical triangle by hand. The zenith is 90 deg from this sun and direction (90, 45).
        close(sky(90.0, 0.0).shares(towards(90.0, 45.0)), 0.5 * (1.0 - 0.75 * 0.5 / 1.5));
        let from_below = Vibration::Rayleigh { most: 0.75, sun: towards(20.0, 0.0), zenith: [0.0, 1.0, 0.0] };
        close(from_below.shares(towards(60.0, -90.0)), 0.5);
    }

    #[test]
    fn lamp_has_the_square_of_the_cosine_in_the_plane_of_incidence() {
        let lamp = |degree, angle_deg: f64| Vibration::Fixed { degree, angle: angle_deg.to_radians() };
        for (degree, angle_deg, s) in
            [(1.0, 0.0, 0.0), (1.0, 90.0, 1.0), (0.5, 90.0, 0.75), (1.0, 30.0, 0.25)]
        {
            assert!((lamp(degree, angle_deg).shares(towards(60.0, 20.0))[0] - s).abs() < 1e-12);
        }
    }
}

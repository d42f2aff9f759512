//! Directions of light sources and of the viewer. Transport does not use a source's spectrum or illuminance.

pub(crate) mod cone_points;
pub(crate) mod field;
pub(crate) mod formula;
pub(crate) mod gathered;
pub(crate) mod images;
pub(crate) mod pixels;
pub(crate) mod polarised;
pub(crate) mod rings;

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::{Beta, sine_of_inclination};
use papilio_sampling::warp;

pub use field::Field;
pub use formula::{Edge, Radiance};
pub use pixels::Pixels;
use polarised::Across;
pub use polarised::Vibration;

/// The golden section: multiples of it, modulo 1, are spread uniformly.
pub(crate) const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;

/// A distant light source, in air.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// The same radiance from the whole hemisphere.
    Diffuse,
    /// A collimated beam whose light propagates with these direction cosines.
    Beam(Beta),
    /// A round source of uniform radiance.
    Disc(Cone),
    /// Light from the whole hemisphere, with a radiance for each direction.
    Field(Arc<Field>),
}

impl Source {
    /// Returns true if it has directions, each with a finite radiance.
    pub(crate) fn has_radiance(&self) -> bool {
        matches!(self, Self::Disc(_) | Self::Field(_))
    }

    /// The direction cosines of light from a beam or from the centre of a disc.
    pub fn direction(&self) -> Option<Beta> {
        match self {
            Self::Beam(beta) => Some(*beta),
            Self::Disc(cone) => Some(-cone.axis_towards()),
            Self::Diffuse | Self::Field(_) => None,
        }
    }
}

/// A round patch of directions, seen from the display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    axis: [f64; 3],
    half_angle: f64,
    index: f64,
    /// Azimuth with which it was made, radians: that of its plane of incidence along the normal.
    phi: f64,
    /// Whether its directions are uniform over the pupil of an objective, not in solid angle.
    of_pupil: bool,
}

impl Cone {
    /// Returns the cone around (theta, phi), degrees in a medium of this index, with this half-angle in
    /// degrees.
    pub fn new(theta_deg: f64, phi_deg: f64, half_angle_deg: f64, index: f64) -> Self {
        let (sin, cos) = (sine_of_inclination(theta_deg), theta_deg.to_radians().cos());
        let (sin_phi, cos_phi) = phi_deg.to_radians().sin_cos();
        Self {
            axis: [sin * cos_phi, sin * sin_phi, cos],
            half_angle: half_angle_deg.to_radians(),
            index,
            phi: phi_deg.to_radians(),
            of_pupil: false,
        }
    }

    /// Returns the directions of an objective whose pupil is this cone: uniform in direction cosines relative to
    /// the axis (the sine condition), not in solid angle.
    pub fn of_pupil(self) -> Self {
        Self { of_pupil: true, ..self }
    }

    /// Angle from the axis within which a fraction of the directions is, radians.
    pub(crate) fn angle_of(&self, fraction: f64) -> f64 {
        match self.of_pupil {
            true => (fraction.sqrt() * self.half_angle.sin()).min(1.0).asin(),
            false => 2.0 * (fraction.sqrt() * (0.5 * self.half_angle).sin()).asin(),
        }
    }

    /// Samples a direction of the cone, uniform in solid angle (or over its pupil); returns the direction cosines of light that
    /// leaves towards it.
    #[inline(always)]
    pub fn sample_towards(&self, u: [f64; 2]) -> Beta {
        self.sampler()(u)
    }

    /// Returns a sampler of many directions, with the common terms precomputed.
    #[inline(always)]
    pub(crate) fn sampler(&self) -> impl Fn([f64; 2]) -> Beta {
        let Self { axis, index, .. } = *self;
        let one_minus_cos = warp::one_minus_cos(self.half_angle);
        let pupil = self.of_pupil.then(|| self.half_angle.sin().powi(2));
        #[inline(always)]
        move |[u, v]| {
            let one_minus_cos = match pupil {
                // 1 - cos, from the square of the sine, which is uniform.
                Some(squared) => u * squared / (1.0 + (1.0 - u * squared).max(0.0).sqrt()),
                None => one_minus_cos * u,
            };
            // On the axis itself if the cone has zero width.
            let [x, y, _] = warp::deflected(axis, one_minus_cos, v);
            Beta { x: index * x, y: index * y }
        }
    }

    /// Returns directions of light that leaves into the cone, uniform in solid angle, and their weights, which
    /// sum to one: for functions whose phase changes by up to so many radians from the axis to the edge, with
    /// errors of about `exp(-digits)`. A narrow cone is its axis.
    pub fn directions(&self, phase: f64, digits: f64) -> Vec<(Beta, f64)> {
        // Angle over which parts of flat panels change, radians.
        const SMOOTH: f64 = 0.3;
        let smooth = cone_points::smooth_at(self, SMOOTH);
        let scale = if phase > 0.0 { smooth.min(2.0 * self.half_angle / phase) } else { smooth };
        // The mean of a smooth function over a narrow cone is off by an eighth of this square.
        if (self.half_angle / scale).powi(2) <= 16.0 * (-digits).exp() {
            return vec![(self.axis_towards(), 1.0)];
        }
        let points = cone_points::cone_points(self, scale, digits);
        points.into_iter().map(|point| (point.beta, point.weight)).collect()
    }

    /// Returns the mirror image of the cone.
    pub(crate) fn mirrored(&self) -> Self {
        let [x, y, z] = self.axis;
        Self { axis: [-x, -y, z], ..*self }
    }

    /// Returns its half-angle, radians.
    pub fn half_angle(&self) -> f64 {
        self.half_angle
    }

    /// Returns two directions perpendicular to its axis: outwards in its plane of incidence, and
    /// perpendicular to that.
    fn across(&self) -> [[f64; 3]; 2] {
        let [x, y, z] = self.axis;
        let sin = x.hypot(y);
        let (cos_phi, sin_phi) = if sin > 0.0 { (x / sin, y / sin) } else { (1.0, 0.0) };
        [[z * cos_phi, z * sin_phi, -sin], [-sin_phi, cos_phi, 0.0]]
    }

    /// Returns the frame of [`Self::around`]: azimuths 0 and 90 deg, and the axis.
    pub(crate) fn frame(&self) -> [[f64; 3]; 3] {
        let [out, side] = self.across();
        [out, side, self.axis]
    }

    /// Returns true if its angles are those in the air.
    pub(crate) fn is_in_air(&self) -> bool {
        self.index == 1.0
    }

    /// Returns the direction cosines of light that leaves at this angle from the axis, rotated by `turn`
    /// around it from its plane of incidence (radians).
    pub(crate) fn around(&self, angle: f64, turn: f64) -> Beta {
        let [out, side] = self.across();
        let ((sin, cos), (sin_turn, cos_turn)) = (angle.sin_cos(), turn.sin_cos());
        let along = |i: usize| cos * self.axis[i] + sin * (cos_turn * out[i] + sin_turn * side[i]);
        Beta { x: self.index * along(0), y: self.index * along(1) }
    }

    /// Returns the angle to another cone's axis, and the rotation (as in [`Self::around`]) towards it.
    pub(crate) fn bearing(&self, other: &Self) -> (f64, f64) {
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let [out, side] = self.across().map(|axis| dot(axis, other.axis));
        (out.hypot(side).atan2(dot(self.axis, other.axis)), side.atan2(out))
    }

    /// Returns the angle from its axis, and the rotation (as in [`Self::around`]), of light that leaves with
    /// these direction cosines.
    pub(crate) fn bearing_of(&self, towards: Beta) -> (f64, f64) {
        let (x, y) = (towards.x / self.index, towards.y / self.index);
        let axis = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
        self.bearing(&Self { axis, ..*self })
    }

    /// Returns the index of the medium of its angles.
    pub(crate) fn index(&self) -> f64 {
        self.index
    }

    /// Returns true if the other is this one rotated about the normal.
    pub(crate) fn is_turned(&self, other: &Self) -> bool {
        (self.axis[2], self.half_angle, self.index) == (other.axis[2], other.half_angle, other.index)
    }

    /// Returns true if it has zero width.
    pub(crate) fn is_point(&self) -> bool {
        self.half_angle == 0.0
    }

    /// Returns true if none of it is beyond the horizon.
    pub(crate) fn is_above(&self) -> bool {
        self.axis[2] >= self.half_angle.sin()
    }

    /// Returns its solid angle.
    pub(crate) fn solid_angle(&self) -> f64 {
        1.0 / warp::uniform_cone_density(self.half_angle)
    }

    /// Returns the smallest cone that contains the intersection of two cones; `None` if they are disjoint.
    pub(crate) fn overlap(&self, other: &Self) -> Option<Self> {
        let (small, large) = if self.half_angle <= other.half_angle { (self, other) } else { (other, self) };
        let (a, b) = (small.half_angle, large.half_angle);
        let [ax, ay, az] = small.axis;
        let [bx, by, bz] = large.axis;
        let cross = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
        let sin = cross.iter().map(|c| c * c).sum::<f64>().sqrt();
        let cos = ax * bx + ay * by + az * bz;
        let distance = sin.atan2(cos);
        if distance >= a + b {
            return None;
        }
        // From the small axis towards the large one to the plane of the common chord: a right spherical
        // triangle, cos a = cos t cos(half chord).
        let t = (b.cos() - a.cos() * cos).atan2(a.cos() * sin);
        if distance <= b - a || t <= 0.0 {
            return Some(*small);
        }
        let half_angle = (a.cos() / t.cos()).clamp(-1.0, 1.0).acos();
        let axis = std::array::from_fn(|i| {
            let towards = (large.axis[i] - cos * small.axis[i]) / sin;
            t.cos() * small.axis[i] + t.sin() * towards
        });
        Some(Self { axis, half_angle, of_pupil: false, ..*small })
    }

    /// Returns the light that a polariser before a viewer of this axis passes, at this angle from its plane of incidence, radians, counter-clockwise as
    /// seen by the viewer.
    pub(crate) fn polariser(&self, angle: f64) -> Across {
        let Beta { x, y } = self.axis_towards();
        let (sin, cos) = if x == 0.0 && y == 0.0 { self.phi.sin_cos() } else { (y, x) };
        let (length, z) = (sin.hypot(cos), (1.0 - x * x - y * y).max(0.0).sqrt());
        let (sin, cos) = (sin / length, cos / length);
        let (across, along) = angle.sin_cos();
        let field = [along * z * cos - across * sin, along * z * sin + across * cos, -along * x.hypot(y)];
        Across { field, travel: [x, y, z] }
    }

    /// Returns the direction cosines of light that leaves towards its axis.
    pub fn axis_towards(&self) -> Beta {
        Beta { x: self.index * self.axis[0], y: self.index * self.axis[1] }
    }

    /// Returns true if light that leaves with `beta` goes to a point within the cone (a cone of zero width
    /// contains its axis).
    #[inline]
    pub fn holds(&self, beta: Beta) -> bool {
        let z = (1.0 - beta.squared() / (self.index * self.index)).max(0.0).sqrt();
        let [dx, dy, dz] =
            [beta.x / self.index - self.axis[0], beta.y / self.index - self.axis[1], z - self.axis[2]];
        // Half the chord is the sine of half the angle: exact for the smallest fields.
        let half_chord = 0.5 * (dx * dx + dy * dy + dz * dz).sqrt();
        half_chord <= (0.5 * self.half_angle).sin() + 1e-12
    }

    /// Returns true if light that propagates with `beta` comes from within the cone.
    #[inline]
    pub(crate) fn sends(&self, beta: Beta) -> bool {
        self.holds(-beta)
    }

    /// Returns the density of [`Self::sample_towards`] over direction cosines at `beta`.
    #[inline]
    pub(crate) fn density(&self, beta: Beta) -> f64 {
        let n_squared = self.index * self.index;
        let cosine = (1.0 - beta.squared() / n_squared).max(1e-300).sqrt();
        let per_solid_angle = match self.of_pupil {
            true => self.bearing_of(beta).0.cos() / (PI * self.half_angle.sin().powi(2)),
            false => warp::uniform_cone_density(self.half_angle),
        };
        per_solid_angle / (n_squared * cosine)
    }

    /// Returns its area in direction cosines (in air: the projected solid angle), for a cone above the
    /// horizon.
    pub fn projected_solid_angle(&self) -> f64 {
        PI * self.half_angle.sin().powi(2) * self.axis[2] * self.index * self.index
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::{SampleStream, Sampler};

    /// The projected solid angle, computed in two ways: the closed form, and the mean of 1/density over
    /// samples.
    #[test]
    fn projected_solid_angle_equals_sampled_area() {
        for (theta_deg, radius_deg) in [(0.0, 0.27), (40.0, 5.0), (-70.0, 12.0)] {
            let cone = Cone::new(theta_deg, 30.0, radius_deg, 1.0);
            let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
            let samples = 4096;
            let mean: f64 = (0..samples)
                .map(|path| {
                    let u = numbers.block(path, 0);
                    let beta = -cone.sample_towards([u[0], u[1]]);
                    assert!(cone.sends(beta));
                    1.0 / cone.density(beta)
                })
                .sum::<f64>()
                / samples as f64;
            let relative = mean / cone.projected_solid_angle() - 1.0;
            assert!(relative.abs() < 1e-3, "{theta_deg} {radius_deg}: {relative}");
        }
    }

    /// Every common point of both cones lies in their overlap, and a good part of the overlap lies in both.
    #[test]
    fn overlap_contains_common_directions() {
        let cone = |theta, half| Cone::new(theta, 20.0, half, 1.0);
        let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
        for (distance, a, b) in
            [(0.5, 0.3, 5.0), (5.1, 0.3, 5.0), (5.29, 0.3, 5.0), (6.0, 4.0, 4.0), (0.0, 1.0, 1.0)]
        {
            let (small, large) = (cone(30.0, a), cone(30.0 + distance, b));
            let overlap = small.overlap(&large).unwrap();
            let mut common = [0; 2];
            for path in 0..4096 {
                let u = numbers.block(path, 0);
                let of_small = small.sample_towards([u[0], u[1]]);
                if large.holds(of_small) {
                    common[0] += 1;
                    assert!(overlap.holds(of_small), "{distance}");
                }
                let of_overlap = overlap.sample_towards([u[2], u[3]]);
                common[1] += i32::from(small.holds(of_overlap) && large.holds(of_overlap));
            }
            // The common solid angle, computed in two ways.
            let [from_small, from_overlap] =
                [(&small, common[0]), (&overlap, common[1])].map(|(c, n)| c.solid_angle() * f64::from(n));
            assert!(common[1] > 200, "{distance}: {common:?}");
            let noise = 4.0 / f64::from(common[0]).sqrt();
            assert!((from_small / from_overlap - 1.0).abs() < noise, "{distance}: {common:?}");
        }
        assert!(cone(30.0, 0.3).overlap(&cone(35.4, 5.0)).is_none());
    }

    #[test]
    fn cone_sends_only_its_own_light() {
        let cone = Cone::new(-20.0, 0.0, 2.0, 1.0);
        assert!(cone.sends(Beta::from_source(-21.9, 0.0, 1.0)));
        assert!(!cone.sends(Beta::from_source(-22.1, 0.0, 1.0)));
        assert!(!cone.sends(Beta::from_source(20.0, 0.0, 1.0)));
    }
}

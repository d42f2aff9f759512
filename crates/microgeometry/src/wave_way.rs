//! Ways of light at a mean face: to its own side or to the other one, from an inclination.
//!
//! **Directions** are those of propagation, as direction cosines beta = n sin(theta) along the face: a thin
//! screen adds λ f to them, whatever the index (the grating law). gamma = (n² - beta²)^(1/2) is what is left
//! along the normal. A height h delays light from gamma₁ to gamma₂ by 2π h/λ times gamma₁ + gamma₂ in
//! reflection, and times gamma₂ - gamma₁ in transmission: [`Way::path`].
//!
//! **Azimuths.** Light comes from all azimuths, as in the measurement by rays. What is scattered by |f| then
//! lies on a circle about the regular direction, uniformly: [`inside`] tells how much of the circle is in a
//! disc of directions.

use std::f64::consts::PI;

use papilio_optics::interface::fresnel_reflectance;

use crate::Side;

/// Light of an inclination that a face reflects, or that it transmits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Index of the medium of the incident light, and of that of the scattered light.
    index: [f64; 2],
    is_reflected: bool,
    /// |beta| of the incident light, and of the regular direction.
    pub(crate) beta: f64,
    /// Fraction of the light that a flat face sends on this way.
    pub(crate) fresnel: f64,
}

impl Way {
    /// The reflected and the transmitted light of an inclination, between media of these indices above and
    /// below. None is transmitted beyond the critical angle.
    pub(crate) fn both(index: [f64; 2], from: Side, theta_deg: f64) -> (Self, Option<Self>) {
        let [own, other] = match from {
            Side::Above => index,
            Side::Below => [index[1], index[0]],
        };
        let beta = own * theta_deg.to_radians().sin().abs();
        let fresnel = fresnel_reflectance(own, other, beta);
        let reflected = Self { index: [own; 2], is_reflected: true, beta, fresnel };
        let transmitted = Self { index: [own, other], is_reflected: false, beta, fresnel: 1.0 - fresnel };
        (reflected, (beta < other).then_some(transmitted))
    }

    /// The difference of optical paths for each unit of height, for light that is scattered to a |beta|.
    pub(crate) fn path(&self, beta: f64) -> f64 {
        let gamma = |index: f64, beta: f64| (index * index - beta * beta).max(0.0).sqrt();
        let [here, there] = [gamma(self.index[0], self.beta), gamma(self.index[1], beta)];
        if self.is_reflected { here + there } else { (there - here).abs() }
    }

    /// Phase of light in the regular direction, per um of height.
    pub(crate) fn regular_per_um(&self, wavelength_um: f64) -> f64 {
        2.0 * PI * self.path(self.beta) / wavelength_um
    }

    /// Largest tangent of the angles to the normal before and behind the mean face.
    pub(crate) fn tangent(&self) -> f64 {
        let tangent = |index: f64| self.beta / (index * index - self.beta * self.beta).max(0.0).sqrt();
        tangent(self.index[0]).max(tangent(self.index[1]))
    }

    /// Largest |beta| of scattered light that propagates.
    pub(crate) fn disc(&self) -> f64 {
        self.index[1]
    }

    /// Largest |beta| of the light whose haze is measured: in air of transmitted light, in its medium of
    /// reflected light.
    pub(crate) fn seen(&self) -> f64 {
        if self.is_reflected { self.index[1] } else { self.index[1].min(1.0) }
    }
}

/// Angle of the first point inside a disc, on a circle about a point: 0, where the circle is farthest from
/// the middle of the disc, to π. `radius` is that of the circle, `beta` the distance of its middle from that
/// of the disc.
pub(crate) fn first_inside(radius: f64, beta: f64, disc: f64) -> f64 {
    if beta + radius <= disc {
        return 0.0;
    }
    let cosine = (disc * disc - beta * beta - radius * radius) / (2.0 * beta * radius);
    if cosine.is_nan() { PI } else { cosine.clamp(-1.0, 1.0).acos() }
}

/// Fraction of a circle about a point that lies in a disc.
pub(crate) fn inside(radius: f64, beta: f64, disc: f64) -> f64 {
    1.0 - first_inside(radius, beta, disc) / PI
}

//! One reflection or refraction at a GGX microfacet, for light from either side.
//!
//! Everything is said in wave vectors over k0: `(beta, q)` with `q = sqrt(n^2 - |beta|^2)`, in a
//! frame whose z points to the side that the light comes from. A microfacet of normal h keeps
//! what lies in its own plane, so the wave vector moves along h alone: by `2 c1` in a
//! reflection, by `c1 - c2` in a refraction, c1 and c2 its components along h on either side.

use papilio_sampling::warp;

use super::Side;
use crate::Beta;

/// The statistics of a face, and its media.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Microfacets {
    pub(super) alpha: f64,
    pub(super) above: f64,
    pub(super) below: f64,
}

/// Light after one microfacet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Leaving {
    /// Which way the face sends it.
    pub(super) side: Side,
    /// Its direction.
    pub(super) beta: Beta,
    /// The share of it that no other microfacet stands in the way of.
    pub(super) unshadowed: f64,
}

/// Light at a microfacet that it sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    from: Side,
    /// Wave vector before, z towards the side that it comes from.
    arriving: [f64; 3],
    normal: [f64; 3],
    /// Components along the normal, of the light before and of the refracted light.
    c1: f64,
    c2: f64,
    /// Share reflected.
    pub(super) reflectance: f64,
}

impl Microfacets {
    pub(super) fn index(&self, side: Side) -> f64 {
        match side {
            Side::Above => self.above,
            Side::Below => self.below,
        }
    }

    /// Light that meets one microfacet, by the density of directions after it. Symmetric.
    pub(super) fn single(&self, from: Side, beta_i: Beta, to: Side, beta_o: Beta) -> f64 {
        let (n1, n2) = (self.index(from), self.index(to));
        let (squared_i, squared_o) = (beta_i.squared(), beta_o.squared());
        if squared_i >= n1 * n1 || squared_o >= n2 * n2 {
            return 0.0;
        }
        let (q_i, q_o) = ((n1 * n1 - squared_i).sqrt(), (n2 * n2 - squared_o).sqrt());
        let tangential = (beta_o - beta_i).squared();
        let z = if from == to { q_i + q_o } else { q_i - q_o };
        let length_squared = tangential + z * z;
        if length_squared == 0.0 {
            return 0.0;
        }
        // G/(q_i q_o) has no singularity at grazing directions.
        let smith = self.smith(q_i, squared_i) * self.smith(q_o, squared_o);
        let masked = 0.25 * smith * self.normals(tangential, z);
        if from == to {
            let c1 = 0.5 * length_squared.sqrt();
            let other = self.index(from.other());
            return (1.0 - transmittance(c1, n1, beyond(c1, n1, other), other)) * masked;
        }
        // Twice the components along (the microfacet's normal times the length).
        let step = (n1 - n2) * (n1 + n2);
        let [c1, c2] = [length_squared + step, step - length_squared].map(|c| c * z.signum());
        if c1 <= 0.0 || c2 <= 0.0 {
            return 0.0;
        }
        let half = 0.5 / length_squared.sqrt();
        c1 * c2 / (length_squared * length_squared) * transmittance(c1 * half, n1, c2 * half, n2) * masked
    }

    /// G1/q of Smith's shadowing for GGX.
    pub(super) fn smith(&self, q: f64, beta_squared: f64) -> f64 {
        2.0 / (q + (q * q + self.alpha * self.alpha * beta_squared).sqrt())
    }

    /// G1 for light that leaves with this component of its wave vector along the face's normal;
    /// 0 if it does not leave.
    pub(super) fn unshadowed(&self, q: f64, n: f64) -> f64 {
        if q <= 0.0 {
            return 0.0;
        }
        q * self.smith(q, (n - q) * (n + q))
    }

    /// Density of GGX normals per steradian along the vector of this squared tangential part
    /// and this z.
    fn normals(&self, tangential: f64, z: f64) -> f64 {
        let alpha_squared = self.alpha * self.alpha;
        let ratio = (tangential + z * z) / (alpha_squared * z * z + tangential);
        alpha_squared * ratio * ratio / std::f64::consts::PI
    }

    /// A microfacet drawn among those that the light sees, weighted by their projected areas
    /// (J. Dupuy, A. Benyoub, Comput. Graph. Forum 42 (8), 2023: spherical caps).
    pub(super) fn meet(&self, from: Side, beta: Beta, u: [f64; 2]) -> Meeting {
        let n1 = self.index(from);
        let q = (n1 * n1 - beta.squared()).max(0.0).sqrt();
        // In units where the roughness is 1, towards where the light comes from.
        let stretched = unit([-self.alpha * beta.x, -self.alpha * beta.y, q]);
        let z = 1.0 - u[1] * (1.0 + stretched[2]);
        let (x, y) = warp::polar(((1.0 - z) * (1.0 + z)).max(0.0).sqrt(), u[0]);
        let (x, y, z) = (x + stretched[0], y + stretched[1], z + stretched[2]);
        let normal = unit([self.alpha * x, self.alpha * y, z]);
        let arriving = [beta.x, beta.y, -q];
        let c1 = -(arriving[0] * normal[0] + arriving[1] * normal[1] + arriving[2] * normal[2]);
        let n2 = self.index(from.other());
        let c2 = beyond(c1, n1, n2);
        Meeting { from, arriving, normal, c1, c2, reflectance: 1.0 - transmittance(c1, n1, c2, n2) }
    }

    /// Where the face sends light that this microfacet reflects, or refracts; `None` if that is
    /// against other microfacets.
    pub(super) fn leave(&self, meeting: &Meeting, reflected: bool) -> Option<Leaving> {
        let Meeting { from, arriving, normal, c1, c2, .. } = *meeting;
        let along = if reflected { 2.0 * c1 } else { c1 - c2 };
        let [x, y, z] = std::array::from_fn(|k| arriving[k] + along * normal[k]);
        let (side, q) = if reflected { (from, z) } else { (from.other(), -z) };
        let (beta, n) = (Beta { x, y }, self.index(side));
        let squared = beta.squared();
        (q > 0.0 && squared < n * n).then(|| Leaving { side, beta, unshadowed: q * self.smith(q, squared) })
    }
}

/// The component along a face's normal behind it, 0 if the light cannot pass.
pub(super) fn beyond(c1: f64, n1: f64, n2: f64) -> f64 {
    ((n2 - n1) * (n2 + n1) + c1 * c1).max(0.0).sqrt()
}

/// Fresnel's transmittance, mean of s and p, from the components along the normal; 0 beyond the
/// critical angle.
pub(super) fn transmittance(c1: f64, n1: f64, c2: f64, n2: f64) -> f64 {
    if c2 <= 0.0 || c1 <= 0.0 {
        return 0.0;
    }
    let (p1, p2) = (n2 / n1 * c1, n1 / n2 * c2);
    2.0 * c1 * c2 * (1.0 / ((c1 + c2) * (c1 + c2)) + 1.0 / ((p1 + p2) * (p1 + p2)))
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|component| component / length)
}

//! One reflection or refraction at a microfacet, for light from either side.
//!
//! All quantities are wave vectors over k0: `(beta, q)` with `q = sqrt(n^2 - |beta|^2)`, in a frame whose z
//! points to the side of the incident light. A microfacet of normal h conserves the component in its own
//! plane, so the wave vector changes only along h: by `2 c1` in a reflection, by `c1 - c2` in a refraction,
//! c1 and c2 its components along h on either side.

use std::sync::Arc;

use super::Side;
use super::shadowing::{Distribution, beta_function};
use super::student::StudentSlopes;
use crate::Beta;

/// Statistics of the microfacets of an interface, and its media.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Microfacets {
    pub(super) distribution: Distribution,
    pub(super) alpha: f64,
    pub(super) above: f64,
    pub(super) below: f64,
    /// Tables of slopes that have no fast closed forms.
    tables: Option<Arc<StudentSlopes>>,
}

/// Light after one microfacet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ScatteredLight {
    /// Side to which the microfacet scatters it.
    pub(super) side: Side,
    /// Its direction.
    pub(super) beta: Beta,
    /// Probability that no other microfacet is in its path.
    pub(super) unshadowed: f64,
}

/// Light at a microfacet that is visible to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MicrofacetEvent {
    from: Side,
    /// Wave vector before, z towards the side of incidence.
    arriving: [f64; 3],
    /// Lambda of that light.
    hidden: f64,
    normal: [f64; 3],
    /// Components along the normal, of the light before and of the refracted light.
    c1: f64,
    c2: f64,
    /// Reflected fraction.
    pub(super) reflectance: f64,
}

/// Two directions, without the angle between their planes of incidence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    distribution: Distribution,
    alpha: f64,
    back: bool,
    n1: f64,
    n2: f64,
    /// z component of the vector along the normal of the microfacet, towards the side of incidence.
    z: f64,
    /// `G/(4 q_i q_o)`.
    shadowing: f64,
}

impl Pair {
    /// Returns [`Microfacets::single`], where this is the square of the difference of beta.
    pub(super) fn single(&self, tangential: f64) -> f64 {
        let Self { n1, n2, z, .. } = *self;
        let length_squared = tangential + z * z;
        if length_squared == 0.0 {
            return 0.0;
        }
        let normals = || self.distribution.normals(self.alpha, tangential, z * z);
        if self.back {
            let c1 = 0.5 * length_squared.sqrt();
            return (1.0 - transmittance(c1, n1, beyond(c1, n1, n2), n2)) * normals() * self.shadowing;
        }
        // Twice the components along (the normal of the microfacet times the length).
        let step = (n1 - n2) * (n1 + n2);
        let [c1, c2] = [length_squared + step, step - length_squared].map(|c| c * z.signum());
        if c1 <= 0.0 || c2 <= 0.0 {
            return 0.0;
        }
        let half = 0.5 / length_squared.sqrt();
        let refracted = transmittance(c1 * half, n1, c2 * half, n2) * normals() * self.shadowing;
        c1 * c2 / (length_squared * length_squared) * refracted
    }
}

impl Microfacets {
    pub(super) fn new(distribution: Distribution, alpha: f64, above: f64, below: f64) -> Self {
        let tables = match distribution {
            Distribution::StudentT { tail } => Some(Arc::new(StudentSlopes::new(tail))),
            Distribution::Ggx | Distribution::Beckmann => None,
        };
        Self { distribution, alpha, above, below, tables }
    }

    pub(super) fn index(&self, side: Side) -> f64 {
        match side {
            Side::Above => self.above,
            Side::Below => self.below,
        }
    }

    /// Returns the density of directions of light after one microfacet. Symmetric.
    pub(super) fn single(&self, from: Side, beta_i: Beta, to: Side, beta_o: Beta) -> f64 {
        let pair = self.pair((from, beta_i.squared()), (to, beta_o.squared()));
        pair.map_or(0.0, |pair| pair.single((beta_o - beta_i).squared()))
    }

    /// Returns the density of light that one microfacet refracts, including what other microfacets take:
    /// [`Self::single`] is its product with [`Self::visible_across`].
    pub(super) fn refracted(&self, above: Beta, below: Beta) -> f64 {
        let wave = |side, beta: Beta| normal_component(self.index(side), beta.squared());
        let Some((q_i, q_o)) = wave(Side::Above, above).zip(wave(Side::Below, below)) else { return 0.0 };
        let shadowing = 0.25 / (q_i * q_o);
        let (n1, n2) = (self.above, self.below);
        let pair = Pair { n1, n2, z: q_i - q_o, shadowing, back: false, ..self.blank() };
        pair.single((below - above).squared())
    }

    /// Returns the fraction of light between directions whose |beta| have these squares, across the
    /// interface, that no other microfacet takes.
    pub(super) fn visible_across(&self, above: f64, below: f64) -> f64 {
        let hidden = |side, squared: f64| {
            normal_component(self.index(side), squared).map(|q| self.hidden(q, squared) / q)
        };
        let both = hidden(Side::Above, above).zip(hidden(Side::Below, below));
        both.map_or(0.0, |(above, below)| beta_function(above, below))
    }

    /// Returns two directions whose |beta| have these squares; `None` if one of them does not exist.
    pub(super) fn pair(&self, (from, before): (Side, f64), (to, after): (Side, f64)) -> Option<Pair> {
        let (n1, n2) = (self.index(from), self.index(to));
        if before >= n1 * n1 || after >= n2 * n2 {
            return None;
        }
        let (q_i, q_o) = ((n1 * n1 - before).sqrt(), (n2 * n2 - after).sqrt());
        let hidden = [self.hidden(q_i, before), self.hidden(q_o, after)];
        let back = from == to;
        let shadowing = if back {
            // q_i q_o (1 + Lambda_i + Lambda_o)
            1.0 / (q_i * q_o + q_o * hidden[0] + q_i * hidden[1])
        } else {
            beta_function(hidden[0] / q_i, hidden[1] / q_o) / (q_i * q_o)
        };
        let z = if back { q_i + q_o } else { q_i - q_o };
        Some(Pair { back, n1, n2: self.index(from.other()), z, shadowing: 0.25 * shadowing, ..self.blank() })
    }

    /// Returns a pair of directions that are not known yet.
    fn blank(&self) -> Pair {
        let Self { distribution, alpha, .. } = *self;
        Pair { distribution, alpha, back: false, n1: 1.0, n2: 1.0, z: 0.0, shadowing: 0.0 }
    }

    /// Returns `q Lambda` of light in this direction.
    pub(super) fn hidden(&self, q: f64, beta_squared: f64) -> f64 {
        match &self.tables {
            Some(tables) => tables.hidden(self.alpha, q, beta_squared),
            None => self.distribution.hidden(self.alpha, q, beta_squared),
        }
    }

    /// Returns the probability that light which left its first microfacet with this component q along the
    /// normal of the interface, in a medium of index n, meets no other. `hidden` is Lambda of the incident
    /// light.
    fn unshadowed(&self, hidden: f64, q: f64, n: f64, reflected: bool) -> f64 {
        let after = self.hidden(q, (n - q) * (n + q)) / q;
        (1.0 + hidden) * if reflected { 1.0 / (1.0 + hidden + after) } else { beta_function(hidden, after) }
    }

    /// Samples a microfacet among those visible to the light, weighted by their projected areas.
    pub(super) fn meet(&self, from: Side, beta: Beta, u: [f64; 2]) -> MicrofacetEvent {
        let n1 = self.index(from);
        let q = (n1 * n1 - beta.squared()).max(0.0).sqrt();
        // In units where the roughness is 1, towards the incident light.
        let stretched = unit([-self.alpha * beta.x, -self.alpha * beta.y, q]);
        let [x, y, z] = match &self.tables {
            Some(tables) => tables.visible(stretched, u),
            None => self.distribution.visible(stretched, u),
        };
        let normal = unit([self.alpha * x, self.alpha * y, z]);
        let arriving = [beta.x, beta.y, -q];
        let c1 = -(arriving[0] * normal[0] + arriving[1] * normal[1] + arriving[2] * normal[2]);
        let n2 = self.index(from.other());
        let c2 = beyond(c1, n1, n2);
        let hidden = self.hidden(q, beta.squared()) / q;
        MicrofacetEvent {
            from,
            arriving,
            hidden,
            normal,
            c1,
            c2,
            reflectance: 1.0 - transmittance(c1, n1, c2, n2),
        }
    }

    /// Returns the light that this microfacet reflects, or refracts; `None` if it meets other microfacets.
    pub(super) fn leave(&self, event: &MicrofacetEvent, reflected: bool) -> Option<ScatteredLight> {
        let MicrofacetEvent { from, arriving, hidden, normal, c1, c2, .. } = *event;
        let along = if reflected { 2.0 * c1 } else { c1 - c2 };
        let [x, y, z] = std::array::from_fn(|k| arriving[k] + along * normal[k]);
        let (side, q) = if reflected { (from, z) } else { (from.other(), -z) };
        let (beta, n) = (Beta { x, y }, self.index(side));
        (q > 0.0 && beta.squared() < n * n).then(|| {
            let unshadowed = self.unshadowed(hidden, q, n, reflected);
            ScatteredLight { side, beta, unshadowed }
        })
    }
}

/// Returns the component along the normal of a wave vector in a medium of index n, given the square of its
/// |beta|.
fn normal_component(n: f64, beta_squared: f64) -> Option<f64> {
    (beta_squared < n * n).then(|| (n * n - beta_squared).sqrt())
}

/// Returns the component along the normal of an interface behind it, 0 if the light cannot pass.
pub(super) fn beyond(c1: f64, n1: f64, n2: f64) -> f64 {
    ((n2 - n1) * (n2 + n1) + c1 * c1).max(0.0).sqrt()
}

/// Returns the Fresnel transmittance, mean of s and p, from the components along the normal; 0 beyond the
/// critical angle.
pub(super) fn transmittance(c1: f64, n1: f64, c2: f64, n2: f64) -> f64 {
    if c2 <= 0.0 || c1 <= 0.0 {
        return 0.0;
    }
    let (p1, p2) = (n2 / n1 * c1, n1 / n2 * c2);
    2.0 * c1 * c2 * (1.0 / ((c1 + c2) * (c1 + c2)) + 1.0 / ((p1 + p2) * (p1 + p2)))
}

pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|component| component / length)
}

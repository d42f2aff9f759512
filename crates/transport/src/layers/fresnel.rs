//! Bare interface: Fresnel reflectance of unpolarised light, or of one polarisation.

use papilio_optics::film::Polarisation;
use papilio_optics::interface::{fresnel_reflectance, fresnel_reflectance_p, fresnel_reflectance_s};

use super::{Incidence, LayerKind};
use crate::front::Flat;

/// `None`: unpolarised light.
#[derive(Debug)]
pub(super) struct Fresnel(pub(super) Option<Polarisation>);

/// Returns the reflectance between two indices of light with this direction cosine.
#[inline]
pub(crate) fn reflectance(polarisation: Option<Polarisation>, [n1, n2]: [f64; 2], beta: f64) -> f64 {
    match polarisation {
        None => fresnel_reflectance(n1, n2, beta),
        Some(Polarisation::S) => fresnel_reflectance_s(n1, n2, beta),
        Some(Polarisation::P) => fresnel_reflectance_p(n1, n2, beta),
    }
}

impl LayerKind for Fresnel {
    fn regular(&self, at: &Incidence) -> Flat {
        let r = reflectance(self.0, at.indices, at.beta);
        Flat { t: 1.0 - r, above: r, below: r }
    }

    fn is_colourless(&self) -> bool {
        true
    }
}

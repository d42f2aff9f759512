//! Bare interface: Fresnel reflectance for unpolarised light.

use papilio_optics::interface::fresnel_reflectance;

use super::{Incidence, LayerKind};
use crate::front::Flat;

#[derive(Debug)]
pub(super) struct Fresnel;

impl LayerKind for Fresnel {
    fn regular(&self, at: &Incidence) -> Flat {
        let [above, below] = at.indices;
        let r = fresnel_reflectance(above, below, at.beta);
        Flat { t: 1.0 - r, above: r, below: r }
    }

    fn is_colourless(&self) -> bool {
        true
    }
}

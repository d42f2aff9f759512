//! A perfect antireflection face: what both media can carry passes whole, the rest is reflected whole.

use super::{Incidence, LayerKind};
use crate::front::Flat;

#[derive(Debug)]
pub(super) struct Coated;

impl LayerKind for Coated {
    fn regular(&self, at: &Incidence) -> Flat {
        if at.both_carry() { Flat::CLEAR } else { Flat::MIRROR }
    }

    fn is_colourless(&self) -> bool {
        true
    }
}

//! Ideal antireflection interface: light that both media can carry is transmitted completely, the rest is
//! reflected completely.

use super::{Incidence, LayerKind};
use crate::front::Flat;

#[derive(Debug)]
pub(super) struct IdealAr;

impl LayerKind for IdealAr {
    fn regular(&self, at: &Incidence) -> Flat {
        if at.both_carry() { Flat::CLEAR } else { Flat::MIRROR }
    }

    fn is_colourless(&self) -> bool {
        true
    }
}

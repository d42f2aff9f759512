//! No interface: the media have the same index.

use super::{Action, Preparation};
use super::{Incidence, LayerKind};
use crate::front::Flat;

#[derive(Debug)]
pub(super) struct Open;

impl LayerKind for Open {
    fn regular(&self, _: &Incidence) -> Flat {
        Flat::CLEAR
    }

    fn is_colourless(&self) -> bool {
        true
    }

    fn lies_in_one_medium(&self) -> bool {
        true
    }

    fn action<'a>(&'a self, _: &mut dyn Preparation<'a>) -> Option<Action> {
        None
    }
}

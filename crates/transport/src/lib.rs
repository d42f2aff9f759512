//! Light through the layered display: the stack and the Monte Carlo walk.

mod angular;
mod front;
mod light;
mod stack;
pub mod walk;

pub use angular::{AngularTable, Nodes};
pub use front::Front;
pub use light::{Cone, Source};
pub use stack::{Base, Diffuser, Medium, Reflector, Stack, Top};

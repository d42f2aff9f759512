//! Interfaces, coherent thin films and scattering lobes, in direction cosines.

mod direction;
pub mod lobe;

pub use direction::Beta;

//! Interfaces, coherent thin films and scattering lobes, in direction cosines.

mod direction;
mod error;
pub mod film;
pub mod interface;
pub mod lobe;

pub use direction::Beta;
pub use error::OpticsError;

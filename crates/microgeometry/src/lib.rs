//! From the geometry of a surface to its scattering: a virtual goniometer.
//!
//! A surface between two media is computed by rays or by waves. Lengths are in micrometres; x is along the columns of a height map,
//! y along its rows, and z points up, into the medium above.

mod error;
mod height_map;

pub use error::MicrogeometryError;
pub use height_map::HeightMap;

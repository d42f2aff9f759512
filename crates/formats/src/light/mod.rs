//! Input files of light sources: profiles over inclination, maps of the whole sphere, luminaires.

mod ies;
mod map;
mod openexr;
mod primaries;
mod problem;
mod profile;
mod radiance;

pub use ies::{Luminaire, read_ies};
pub use map::{LightMap, MapChannel, MapColour, read_light_map};
pub use problem::MapProblem;
pub use profile::read_profile;

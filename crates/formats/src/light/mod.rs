//! Input files of light sources: profiles over inclination, maps of the whole sphere, luminaires.

mod cube;
mod eulumdat;
mod exr_channels;
mod exr_window;
mod ies;
mod luminaire;
mod map;
mod numbers;
mod openexr;
mod opening;
mod primaries;
mod profile;
mod radiance;

pub use luminaire::{IntensityEdge, Luminaire, is_luminaire, read_luminaire};
pub use map::{LightMap, MapChannel, MapColour, read_light_map};
pub(crate) use map::{LinearLight, Shape, read_linear};
pub use opening::{Opening, OpeningShape};
pub(crate) use primaries::XYZ;
pub use profile::read_profile;

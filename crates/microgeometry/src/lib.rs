//! From the geometry of a surface to its scattering: a virtual goniometer.
//!
//! A [`Surface`] between two media, or a slab with particles, is measured by rays ([`Goniometer`]), a face
//! also by waves ([`ByWaves`]). Lengths are in micrometres; x is along the columns of a height map, y along
//! its rows, and z points up, into the medium above. [`Coating`] is what lies on the facets.

mod azimuth_kernel;
#[cfg(test)]
mod azimuth_tests;
mod balance;
mod bands;
mod by_azimuth;
mod caps;
mod coating;
#[cfg(test)]
mod coating_tests;
mod error;
mod face;
mod goniometer;
mod grid;
mod harvey_shack;
mod height_map;
mod heights;
mod kernel;
#[cfg(test)]
mod laws_tests;
mod measurement;
mod mesh;
#[cfg(test)]
mod mesh_tests;
mod patches;
mod path;
mod phase_nodes;
mod random;
mod ray;
mod screen_rings;
mod starts;
mod statistics;
mod surface;
#[cfg(test)]
mod tests;
mod volume;
#[cfg(test)]
mod volume_tests;
mod wave_lobes;
mod wave_way;
mod waves;
#[cfg(test)]
mod waves_tests;

pub use azimuth_kernel::AzimuthKernel;
pub use bands::Bands;
pub use caps::{Caps, Lattice};
pub use coating::{Coating, Films};
pub use error::MicrogeometryError;
pub use face::{FaceKernels, FaceTable};
pub use goniometer::{Goniometer, Measured, REPLICATES, Replicate, Total};
pub use harvey_shack::HarveyShack;
pub use height_map::{HeightMap, HeightStatistics};
pub use kernel::{Audit, Kernel};
pub use measurement::{ByAzimuth, ByRays, Collected, Findings, Measurement, Part};
pub use mesh::Mesh;
pub use patches::Patches;
pub use random::{RandomHeights, Spectrum};
pub use ray::Side;
pub use statistics::Statistics;
pub use surface::Surface;
pub use volume::Volume;
pub use wave_lobes::{Correlation, WaveLobe, wave_lobes};
pub use waves::{ByWaves, LEAST_G, MOST_PHASE, MOST_SHADOW, MOST_SLOPE, WaveShares, WayShares};

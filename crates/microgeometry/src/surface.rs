//! Surfaces that can be measured.

use crate::caps::{Balls, Caps, Lattice};
use crate::heights::Triangles;
use crate::mesh::MeshFace;
use crate::random::RandomHeights;
use crate::ray::Face;
use crate::volume::Particles;
use crate::{HeightMap, Mesh, MicrogeometryError, Statistics, Volume};

/// A surface between two media.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// A flat face.
    Flat,
    /// Spherical caps on a flat face.
    Caps(Caps),
    /// A map of heights, which repeats.
    Heights(HeightMap),
    /// A random face: another realisation for each replicate, whose differences are a part of the error.
    Random(RandomHeights),
    /// Triangles, which may overhang.
    Mesh(Mesh),
    /// Particles in a slab; the media above and below are its matrix. Other places for each replicate.
    Volume(Volume),
}

impl Surface {
    /// Calls a function with the surface of a replicate.
    pub(crate) fn with_face<T>(
        &self,
        replicate: u64,
        of: impl FnOnce(&dyn Face) -> T,
    ) -> Result<T, MicrogeometryError> {
        match self {
            Self::Flat => Ok(of(&Triangles::new(&HeightMap::flat()))),
            Self::Caps(caps) => Ok(of(&Balls::new(caps, replicate)?)),
            Self::Heights(map) => Ok(of(&Triangles::new(map))),
            Self::Random(random) => Ok(of(&Triangles::new(&random.realisation(replicate)?))),
            Self::Mesh(mesh) => Ok(of(&MeshFace::new(mesh))),
            Self::Volume(volume) => Ok(of(&Particles::new(volume, replicate)?)),
        }
    }

    /// Fails for a surface that cannot be made.
    ///
    /// # Errors
    /// Lengths that are not positive or contradict each other.
    pub fn check(&self) -> Result<(), MicrogeometryError> {
        match self {
            Self::Caps(caps) => Balls::new(caps, 0).map(drop),
            Self::Volume(volume) => Particles::new(volume, 0).map(drop),
            Self::Flat | Self::Heights(_) | Self::Random(_) | Self::Mesh(_) => Ok(()),
        }
    }

    /// Returns true if each replicate is another realisation.
    pub fn is_random(&self) -> bool {
        matches!(
            self,
            Self::Random(_) | Self::Volume(_) | Self::Caps(Caps { lattice: Lattice::Random { .. }, .. })
        )
    }

    /// Statistics of the heights of the first replicate; `None` for a flat face, a mesh, and a volume.
    ///
    /// # Errors
    /// Surfaces that cannot be made.
    pub fn statistics(&self) -> Result<Option<Statistics>, MicrogeometryError> {
        if matches!(self, Self::Flat | Self::Mesh(_) | Self::Volume(_)) {
            return Ok(None);
        }
        let map = self.heights(0)?;
        Ok(Some(Statistics::of(&map)))
    }

    /// Heights of a period of a replicate, for waves, statistics and sparkle: as fine as the waves of the
    /// surface need, which is coarser than rays do.
    ///
    /// # Errors
    /// Surfaces without heights: meshes and volumes; those that cannot be made.
    pub fn heights(&self, replicate: u64) -> Result<HeightMap, MicrogeometryError> {
        self.heights_over(replicate, 0.0)
    }

    /// As [`heights`](Self::heights), of a random surface over a square whose side is at least this long, um,
    /// as far as the largest number of heights allows.
    ///
    /// # Errors
    /// As [`heights`](Self::heights).
    pub fn heights_over(&self, replicate: u64, least_um: f64) -> Result<HeightMap, MicrogeometryError> {
        match self {
            Self::Flat => Ok(HeightMap::flat()),
            Self::Caps(caps) => Balls::over(caps, replicate, least_um)?.sampled(),
            Self::Heights(map) => Ok(map.clone()),
            Self::Random(random) => random.for_waves()?.over(least_um).realisation(replicate),
            Self::Mesh(_) => Err(MicrogeometryError::NoHeights { surface: "a mesh" }),
            Self::Volume(_) => Err(MicrogeometryError::NoHeights { surface: "a volume" }),
        }
    }
}

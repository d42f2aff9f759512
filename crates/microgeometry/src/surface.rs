//! Surfaces that can be measured.

use crate::caps::{Balls, Caps, Lattice};
use crate::heights::Triangles;
use crate::random::RandomHeights;
use crate::ray::Face;
use crate::{HeightMap, MicrogeometryError, Statistics};

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
}

impl Surface {
    /// Calls a function with the surface of a replicate.
    pub(crate) fn with_face<T>(
        &self,
        replicate: u64,
        of: impl FnOnce(&dyn Face) -> T,
    ) -> Result<T, MicrogeometryError> {
        match self {
            Self::Flat => {
                let flat = HeightMap::new(1, [1.0; 2], vec![0.0])?;
                Ok(of(&Triangles::new(&flat)))
            }
            Self::Caps(caps) => Ok(of(&Balls::new(caps, replicate)?)),
            Self::Heights(map) => Ok(of(&Triangles::new(map))),
            Self::Random(random) => Ok(of(&Triangles::new(&random.realisation(replicate)?))),
        }
    }

    /// Fails for a surface that cannot be made.
    ///
    /// # Errors
    /// Lengths that are not positive or contradict each other.
    pub fn check(&self) -> Result<(), MicrogeometryError> {
        match self {
            Self::Caps(caps) => Balls::new(caps, 0).map(drop),
            Self::Flat | Self::Heights(_) | Self::Random(_) => Ok(()),
        }
    }

    /// Whether each replicate is another realisation.
    pub(crate) fn is_random(&self) -> bool {
        matches!(self, Self::Random(_) | Self::Caps(Caps { lattice: Lattice::Random { .. }, .. }))
    }

    /// Statistics of the heights of the first replicate; `None` for a flat face.
    ///
    /// # Errors
    /// Surfaces that cannot be made.
    pub fn statistics(&self) -> Result<Option<Statistics>, MicrogeometryError> {
        if *self == Self::Flat {
            return Ok(None);
        }
        let map = self.heights(0)?;
        Ok(Some(Statistics::of(&map)))
    }

    /// Heights of a period of a replicate, for waves and statistics.
    pub(crate) fn heights(&self, replicate: u64) -> Result<HeightMap, MicrogeometryError> {
        match self {
            Self::Flat => HeightMap::new(1, [1.0; 2], vec![0.0]),
            Self::Caps(caps) => Balls::new(caps, replicate)?.sampled(),
            Self::Heights(map) => Ok(map.clone()),
            Self::Random(random) => random.for_waves()?.realisation(replicate),
        }
    }
}

//! Where values are taken: the coordinates of each kind of file.

mod specular;
mod spherical;

pub use specular::{SpecularGrid, Symmetry};
pub use spherical::SphericalGrid;

use crate::Direction;

/// The cells of a part.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A grid about the specular direction (imaging spheres; Radiant, Zemax).
    Specular(SpecularGrid),
    /// A grid of inclinations and azimuths.
    Spherical(SphericalGrid),
    /// Pairs of directions (light, viewer) in any order.
    Pairs(Vec<[Direction; 2]>),
    /// Patches of the hemisphere in rings from the normal (Klems); cells `[in][out]`. The incident patches
    /// are turned by 180 deg, so that light that keeps its direction goes from a patch to the one of the
    /// same number.
    Patches {
        /// Rings of the patches from which light comes, from the normal outwards.
        incoming: Vec<Ring>,
        /// Rings of the patches to which it goes.
        outgoing: Vec<Ring>,
    },
}

/// A ring of patches; it ends where the next begins, the last at 90 deg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Where it begins, degrees from the normal.
    pub from_deg: f64,
    /// How many patches it is parted into; the first is centred on azimuth 0.
    pub patches: usize,
}

impl Geometry {
    /// How many cells there are.
    pub fn cells(&self) -> usize {
        match self {
            Self::Specular(grid) => grid.cells(),
            Self::Spherical(grid) => grid.cells(),
            Self::Pairs(pairs) => pairs.len(),
            Self::Patches { incoming, outgoing } => patches(incoming) * patches(outgoing),
        }
    }
}

fn patches(rings: &[Ring]) -> usize {
    rings.iter().map(|ring| ring.patches).sum()
}

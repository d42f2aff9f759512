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

    /// Where the middle of a cell lies: the directions of light and viewer; `None` if it is outside the
    /// hemisphere.
    pub fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        match self {
            Self::Specular(grid) => grid.directions(cell),
            Self::Spherical(grid) => grid.directions(cell),
            Self::Pairs(pairs) => pairs.get(cell).copied(),
            Self::Patches { incoming, outgoing } => {
                let count = patches(outgoing);
                let light = patch_centre(incoming, cell.checked_div(count)?)?.specular();
                Some([light, patch_centre(outgoing, cell % count)?])
            }
        }
    }
}

/// The middle of a patch; the patch about the normal has the normal.
fn patch_centre(rings: &[Ring], mut patch: usize) -> Option<Direction> {
    for (k, ring) in rings.iter().enumerate() {
        if patch < ring.patches {
            let to_deg = rings.get(k + 1).map_or(90.0, |next| next.from_deg);
            let theta_deg = if ring.patches == 1 { ring.from_deg } else { (ring.from_deg + to_deg) / 2.0 };
            return Some(Direction::new(theta_deg, 360.0 * patch as f64 / ring.patches as f64));
        }
        patch -= ring.patches;
    }
    None
}

fn patches(rings: &[Ring]) -> usize {
    rings.iter().map(|ring| ring.patches).sum()
}

//! Geometries of measurements: the coordinates of each file format.

mod axis;
mod half_angle;
mod one_side;
mod patches;
mod specular;
mod spherical;
mod tensor_tree;
mod warp;
mod warped;

pub use half_angle::HalfAngleGrid;
pub(crate) use one_side::turn_weights;
pub use one_side::{Overlap, PartOfCircle};
pub use patches::{
    KLEMS_FULL, KLEMS_HALF, KLEMS_QUARTER, Ring, patch_count, patch_of, projected_solid_angle,
};
pub use specular::{SpecularGrid, Symmetry};
pub use spherical::SphericalGrid;
pub(crate) use tensor_tree::{LitSquare, direction_of_square};
pub use tensor_tree::{TensorTree, TreeNode};
pub use warped::{WarpFields, WarpedGrid};

use crate::{Direction, MeasuredPart};
pub(crate) use patches::patch_centre;

/// Directions of the cells of a part.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A grid about the specular direction (imaging spheres; Radiant, Zemax).
    Specular(SpecularGrid),
    /// A grid of inclinations and azimuths.
    Spherical(SphericalGrid),
    /// Pairs of directions (light, viewer) in any order.
    Pairs(Vec<[Direction; 2]>),
    /// Patches of the hemisphere in rings about the normal (Klems); cells `[in][out]`. The incident patches
    /// are rotated by 180 deg, so that regularly transmitted light goes from a patch to the one of the
    /// same number.
    Patches {
        /// Rings of the incident patches, from the normal outwards.
        incoming: Vec<Ring>,
        /// Rings of the outgoing patches.
        outgoing: Vec<Ring>,
    },
    /// Half and difference angles (MERL).
    HalfAngle(HalfAngleGrid),
    /// Cells of variable size in squares mapped to the disc of direction cosines (tensor trees).
    Tree(TensorTree),
    /// A grid warped according to the surface's facets (RGL). Its values are not f; [`Geometry::evaluate`]
    /// converts them to f.
    Warped(Box<WarpedGrid>),
}

impl Geometry {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        match self {
            Self::Specular(grid) => grid.cells(),
            Self::Spherical(grid) => grid.cells(),
            Self::Pairs(pairs) => pairs.len(),
            Self::Patches { incoming, outgoing } => patch_count(incoming) * patch_count(outgoing),
            Self::HalfAngle(grid) => grid.cells(),
            Self::Tree(tree) => tree.cells(),
            Self::Warped(grid) => grid.cells(),
        }
    }

    /// Returns true if the sample is isotropic: rotating light and viewer together changes nothing.
    pub fn is_isotropic(&self) -> bool {
        match self {
            Self::Specular(grid) => grid.rotations_deg.len() == 1,
            Self::Spherical(grid) => grid.phi_i_deg.len() == 1,
            Self::HalfAngle(_) => true,
            Self::Tree(tree) => tree.rank() == 3,
            Self::Warped(grid) => grid.is_isotropic(),
            Self::Pairs(_) | Self::Patches { .. } => false,
        }
    }

    /// Directions of light and viewer at the centre of a cell; `None` outside the
    /// hemisphere, and for warped grids.
    pub fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        match self {
            Self::Specular(grid) => grid.directions(cell),
            Self::Spherical(grid) => grid.directions(cell),
            Self::Pairs(pairs) => pairs.get(cell).copied(),
            Self::Patches { incoming, outgoing } => {
                let count = patch_count(outgoing);
                let light = patch_centre(incoming, cell.checked_div(count)?)?.specular();
                Some([light, patch_centre(outgoing, cell % count)?])
            }
            Self::HalfAngle(grid) => grid.directions(cell),
            Self::Tree(tree) => tree.directions(cell),
            Self::Warped(_) => None,
        }
    }

    /// Returns f, 1/sr, for light from `i` towards `o`, from one channel's values in the geometry's order;
    /// `None` where nothing was measured.
    ///
    /// This is the simplest interpolation, not a smooth one: linear between the angles of a grid (about the
    /// specular direction for specular-centred grids) and between the cells of half angles, constant in patches and in
    /// cells of trees, the nearest of listed pairs (in time proportional to their number), and the authors' definition
    /// on a warped grid. Nothing is extrapolated. A grid with one azimuth of the light is treated as an
    /// isotropic sample.
    pub fn evaluate(&self, values: &[f64], i: Direction, o: Direction) -> Option<f64> {
        let on_its_side = |d: Direction| (0.0..=90.0).contains(&d.theta_deg) && d.phi_deg.is_finite();
        if !on_its_side(i) || !on_its_side(o) {
            return None;
        }
        let at = |cell: usize| values.get(cell).copied();
        let f = match self {
            Self::Specular(grid) => grid.evaluate(values, i, o),
            Self::Spherical(grid) => grid.evaluate(values, i, o),
            Self::Pairs(pairs) => at(nearest(pairs, i, o)?),
            Self::Patches { incoming, outgoing } => {
                at(patch_of(incoming, i.specular())? * patch_count(outgoing) + patch_of(outgoing, o)?)
            }
            Self::HalfAngle(grid) => grid.evaluate(values, [i, o], [1; 3]),
            Self::Tree(tree) => at(tree.cell(i, o)?),
            Self::Warped(grid) => grid.evaluate(values, i, o),
        };
        f.filter(|f| f.is_finite())
    }
}

impl MeasuredPart {
    /// Returns f, 1/sr, of a channel (given by its index) for light from `i` towards `o`:
    /// [`Geometry::evaluate`].
    pub fn evaluate(&self, channel: usize, i: Direction, o: Direction) -> Option<f64> {
        self.geometry.evaluate(self.channel(channel), i, o)
    }
}

/// Index of the pair with the nearest directions.
fn nearest(pairs: &[[Direction; 2]], i: Direction, o: Direction) -> Option<usize> {
    let (i, o) = (i.vector(), o.vector());
    let squared_distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let distances = pairs
        .iter()
        .map(|pair| squared_distance(pair[0].vector(), i) + squared_distance(pair[1].vector(), o));
    distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number)
}

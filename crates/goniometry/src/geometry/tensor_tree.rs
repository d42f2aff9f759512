//! Cells of variable size: the tensor trees of Radiance (Ward, Kurt & Bonneel 2014).
//!
//! Directions are points of the unit square, mapped from the disc of direction cosines by the equal-area map
//! of Shirley & Chiu (1997): a cell's fraction of the square is its fraction of the projected solid angle.
//! Rank 4: the square of `-i`, then that of `o`. Rank 3, for isotropic samples: `(1 - sin theta_i)/2`, then
//! the square of `o` rotated so that the specular direction is at azimuth 0. A node of the tree halves every
//! side; a leaf is a grid of equal cells.

use std::f64::consts::{FRAC_PI_4, PI};

use crate::Direction;

/// Node of a [`TensorTree`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TreeNode {
    /// 2^rank children; bit k of a child's index selects the half of side k.
    Branch {
        /// Index of the first child among the nodes; the others follow it.
        children: u32,
        /// First cell of the subtree.
        cell: u32,
    },
    /// Leaf: a grid of 2^(rank log2) cells, the last side fastest.
    Grid {
        /// Binary logarithm of the number of cells of a side.
        log2: u8,
        /// First cell of the grid.
        cell: u32,
    },
}

impl TreeNode {
    fn cell(self) -> usize {
        match self {
            Self::Branch { cell, .. } | Self::Grid { cell, .. } => cell as usize,
        }
    }
}

/// Tree of cells, which are numbered in the order of the leaves.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TensorTree {
    rank: usize,
    nodes: Vec<TreeNode>,
    cells: usize,
}

/// Binary logarithm of the largest number of cells of a grid's side.
pub(crate) const LARGEST_LOG2: u8 = 12;

impl TensorTree {
    /// Tree from its nodes, the root first; `None` unless the rank is 3 or 4, children follow their parents,
    /// each has one parent, and cells are numbered from 0 in the order of the leaves.
    pub fn new(rank: usize, nodes: Vec<TreeNode>) -> Option<Self> {
        if !(3..=4).contains(&rank) || nodes.is_empty() {
            return None;
        }
        let branches = 1 << rank;
        let (mut cells, mut visited, mut stack) = (0, 0, vec![0]);
        while let Some(index) = stack.pop() {
            let node = *nodes.get(index)?;
            visited += 1;
            if node.cell() != cells || visited > nodes.len() {
                return None;
            }
            match node {
                TreeNode::Grid { log2, .. } if log2 <= LARGEST_LOG2 => {
                    cells += 1 << (rank * usize::from(log2))
                }
                TreeNode::Branch { children, .. } if children as usize > index => {
                    stack.extend((0..branches).rev().map(|child| children as usize + child));
                }
                _ => return None,
            }
        }
        (visited == nodes.len() && u32::try_from(cells).is_ok()).then_some(Self { rank, nodes, cells })
    }

    /// Rank: 3 (isotropic) or 4.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The nodes, the root first.
    pub fn nodes(&self) -> &[TreeNode] {
        &self.nodes
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Returns the cell of light from `i` towards `o`; `None` in the unused half of a rank 3 cube.
    pub(super) fn cell(&self, i: Direction, o: Direction) -> Option<usize> {
        let place = match self.rank {
            3 => {
                let [x, y] = square_of_direction(Direction::new(o.theta_deg, o.phi_deg - i.phi_deg - 180.0));
                [of_isotropic(i), x, y, 0.0]
            }
            _ => {
                let ([x, y], [u, v]) = (square_of_direction(i.specular()), square_of_direction(o));
                [x, y, u, v]
            }
        };
        self.cell_at(place.map(within_square))
    }

    /// Number of the smallest cells on a side of the square, at most 2^16.
    pub(crate) fn finest_side(&self) -> usize {
        let mut finest = 0;
        let mut stack = vec![(0, 0)];
        while let Some((node, depth)) = stack.pop() {
            match self.nodes.get(node) {
                Some(TreeNode::Branch { children, .. }) => {
                    stack.extend((0..1 << self.rank).map(|child| (*children as usize + child, depth + 1)));
                }
                Some(TreeNode::Grid { log2, .. }) => finest = finest.max(depth + u32::from(*log2)),
                None => {}
            }
        }
        1 << finest.min(16)
    }

    /// Directions of the light of an inclination over which means are formed: several azimuths for an
    /// anisotropic sample.
    pub(crate) fn lights(&self, theta_deg: f64) -> Vec<Direction> {
        match self.rank {
            3 => vec![Direction::new(theta_deg, 180.0)],
            // None of them on an edge of cells.
            _ => (0..AZIMUTHS)
                .map(|k| Direction::new(theta_deg, (f64::from(k) + 0.5) * 360.0 / f64::from(AZIMUTHS)))
                .collect(),
        }
    }

    /// Calls `each` with every square of the viewer's square in which light of this direction has a value
    /// above 0. For rank 3 the square is rotated, so that the specular direction has azimuth 0.
    pub(crate) fn each_lit(&self, values: &[f64], light: Direction, each: &mut dyn FnMut(LitSquare)) {
        let place = match self.rank {
            3 => [of_isotropic(light), 0.0],
            _ => square_of_direction(light.specular()),
        };
        self.descend(values, 0, (place.map(within_square), true), ([0.0, 0.0], 1.0), each);
    }

    /// Integral over the light of f cos, for light that is scattered in this direction; rank 4.
    pub(crate) fn arriving(&self, values: &[f64], to: Direction) -> f64 {
        let place = square_of_direction(to).map(within_square);
        let mut sum = 0.0;
        let mut add = |LitSquare { size, value, .. }: LitSquare| sum += value * size * size;
        self.descend(values, 0, (place, false), ([0.0, 0.0], 1.0), &mut add);
        PI * sum
    }

    /// Visits the cells below a node that contain the place of the light (`of_light`), or of the viewer.
    fn descend(
        &self,
        values: &[f64],
        node: usize,
        (place, of_light): ([f64; 2], bool),
        (corner, size): ([f64; 2], f64),
        each: &mut dyn FnMut(LitSquare),
    ) {
        // The light has the first sides, the viewer the last two.
        let sides = if of_light { self.rank - 2 } else { 2 };
        let shifts = if of_light { [0, sides] } else { [2, 0] };
        match self.nodes.get(node) {
            Some(TreeNode::Branch { children, .. }) => {
                let mut place = place;
                let mut fixed = 0;
                for (k, x) in place.iter_mut().enumerate().take(sides) {
                    *x *= 2.0;
                    if *x >= 1.0 {
                        *x -= 1.0;
                        fixed |= 1 << k;
                    }
                }
                for free in 0..4 {
                    let half = [free & 1, free >> 1 & 1].map(|bit| 0.5 * size * f64::from(bit as u8));
                    let corner = [corner[0] + half[0], corner[1] + half[1]];
                    let child = *children as usize + (fixed << shifts[0] | free << shifts[1]);
                    self.descend(values, child, (place, of_light), (corner, 0.5 * size), each);
                }
            }
            Some(TreeNode::Grid { log2, cell }) => {
                let side = 1_usize << log2;
                let fixed = place[..sides].iter().fold(0, |n, x| n * side + (x * side as f64) as usize);
                let size = size / side as f64;
                for k in 0..side * side {
                    let within = if of_light { fixed * side * side + k } else { k * side * side + fixed };
                    let value = values.get(*cell as usize + within).copied().unwrap_or(0.0);
                    if value > 0.0 {
                        let corner =
                            [corner[0] + size * (k / side) as f64, corner[1] + size * (k % side) as f64];
                        each(LitSquare { corner, size, value });
                    }
                }
            }
            None => {}
        }
    }

    fn cell_at(&self, mut place: [f64; 4]) -> Option<usize> {
        let mut node = *self.nodes.first()?;
        while let TreeNode::Branch { children, .. } = node {
            let mut child = 0;
            for (k, x) in place.iter_mut().enumerate().take(self.rank) {
                *x *= 2.0;
                if *x >= 1.0 {
                    *x -= 1.0;
                    child |= 1 << k;
                }
            }
            node = *self.nodes.get(children as usize + child)?;
        }
        let TreeNode::Grid { log2, cell } = node else { return None };
        let side = 1_usize << log2;
        let within =
            place[..self.rank].iter().fold(0, |number, x| number * side + (x * side as f64) as usize);
        Some(cell as usize + within)
    }

    /// Directions of light and viewer at the centre of a cell; `None` in the unused half of a rank 3 cube.
    pub(super) fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        let (mut index, mut corner, mut size) = (0, [0.0; 4], 1.0);
        let (log2, first) = loop {
            match *self.nodes.get(index)? {
                TreeNode::Grid { log2, cell } => break (log2, cell as usize),
                TreeNode::Branch { children, .. } => {
                    let first = children as usize;
                    let children = self.nodes.get(first..first + (1 << self.rank))?;
                    let child = children.iter().rposition(|child| child.cell() <= cell)?;
                    size /= 2.0;
                    corner.iter_mut().enumerate().for_each(|(k, x)| *x += size * (child >> k & 1) as f64);
                    index = first + child;
                }
            }
        };
        let (side, mut within) = (1_usize << log2, cell.checked_sub(first)?);
        if cell >= self.cells {
            return None;
        }
        for k in (0..self.rank).rev() {
            corner[k] += size * ((within % side) as f64 + 0.5) / side as f64;
            within /= side;
        }
        self.directions_of(corner)
    }

    fn directions_of(&self, place: [f64; 4]) -> Option<[Direction; 2]> {
        if self.rank == 4 {
            return Some([
                direction_of_square([place[0], place[1]]).specular(),
                direction_of_square([place[2], place[3]]),
            ]);
        }
        let sin = 1.0 - 2.0 * place[0];
        let light = Direction::new(sin.clamp(0.0, 1.0).asin().to_degrees(), 180.0);
        (sin >= 0.0).then(|| [light, direction_of_square([place[1], place[2]])])
    }
}

/// Number of azimuths of the light in means of an anisotropic sample.
const AZIMUTHS: u32 = 24;

/// A square of directions with one value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LitSquare {
    /// Its corner at the smallest coordinates, in the unit square.
    pub(crate) corner: [f64; 2],
    /// Its side.
    pub(crate) size: f64,
    /// f, 1/sr.
    pub(crate) value: f64,
}

impl LitSquare {
    /// Middles of its parts, which are at most `finest` of the unit square wide, and their side.
    pub(crate) fn parts(self, finest: f64) -> (impl Iterator<Item = [f64; 2]>, f64) {
        let side = (self.size / finest).ceil().max(1.0);
        let count = side as usize;
        let at = move |k: usize, corner: f64| corner + self.size * (k as f64 + 0.5) / side;
        let parts =
            (0..count * count).map(move |k| [at(k / count, self.corner[0]), at(k % count, self.corner[1])]);
        (parts, self.size / side)
    }
}

/// Limits a coordinate to the square. A cell includes its lower limits, not its upper ones; a place that
/// differs from a limit by rounding is on it, so that light and its specular direction are in corresponding
/// cells.
fn within_square(x: f64) -> f64 {
    (x + ROUNDING).clamp(0.0, 1.0 - ROUNDING)
}

/// Distance in the square of places that are the same.
const ROUNDING: f64 = 1e-9;

/// Place of the light on its side of a rank 3 cube. Light along the normal, at the border, is in the half that is used: the
/// other one often holds zeros.
fn of_isotropic(light: Direction) -> f64 {
    (0.5 - 0.5 * light.theta_deg.to_radians().sin()).min(0.5 - 2.0 * ROUNDING)
}

/// Place of a direction in the square.
fn square_of_direction(direction: Direction) -> [f64; 2] {
    let [x, y, _] = direction.vector();
    square_of_disk([x, y])
}

/// Direction of a place in the square.
pub(crate) fn direction_of_square(square: [f64; 2]) -> Direction {
    let [x, y] = disk_of_square(square);
    Direction::of_vector([x, y, (1.0 - x * x - y * y).max(0.0).sqrt()])
}

/// Maps the unit disc to the unit square (Shirley & Chiu 1997).
fn square_of_disk([x, y]: [f64; 2]) -> [f64; 2] {
    let r = x.hypot(y);
    let phi = y.atan2(x);
    // The angle is measured from the centre of the quadrant's side, -45 to 45 deg.
    let quadrant = ((phi / (2.0 * FRAC_PI_4)).round() as i64).rem_euclid(4);
    let from_middle = phi - (phi / (2.0 * FRAC_PI_4)).round() * 2.0 * FRAC_PI_4;
    let along = r * from_middle / FRAC_PI_4;
    let [a, b] = match quadrant {
        0 => [r, along],
        1 => [-along, r],
        2 => [-r, -along],
        _ => [along, -r],
    };
    [(a + 1.0) / 2.0, (b + 1.0) / 2.0]
}

/// Maps the unit square to the unit disc.
fn disk_of_square([x, y]: [f64; 2]) -> [f64; 2] {
    let (a, b) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let (r, phi) = if a == 0.0 && b == 0.0 {
        (0.0, 0.0)
    } else if a.abs() > b.abs() {
        (a.abs(), FRAC_PI_4 * b / a + if a < 0.0 { PI } else { 0.0 })
    } else {
        (b.abs(), (if b < 0.0 { 6.0 } else { 2.0 } - a / b) * FRAC_PI_4)
    };
    [r * phi.cos(), r * phi.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_between_square_and_disk_are_inverse() {
        for k in 0..1000 {
            let square = [(f64::from(k) * 0.618_034).fract(), (f64::from(k) + 0.5) / 1000.0];
            let back = square_of_disk(disk_of_square(square));
            assert!((back[0] - square[0]).abs() + (back[1] - square[1]).abs() < 1e-12, "{square:?} {back:?}");
        }
        // (1, 0) is the middle of the right side; 45 deg is a corner.
        assert_eq!(square_of_disk([1.0, 0.0]), [1.0, 0.5]);
        assert_eq!(square_of_disk([0.0, 1.0]), [0.5, 1.0]);
        let corner = square_of_disk([0.5_f64.sqrt(), 0.5_f64.sqrt()]);
        assert!(corner.iter().all(|x| (x - 1.0).abs() < 1e-12));
    }

    fn tree(rank: usize) -> TensorTree {
        let count = 1 << rank;
        let mut nodes = vec![TreeNode::Branch { children: 1, cell: 0 }];
        let grid = 1 << rank;
        nodes.extend((0..count).map(|k| TreeNode::Grid { log2: 1, cell: k * grid }));
        TensorTree::new(rank, nodes).unwrap()
    }

    #[test]
    fn cell_centres_are_in_their_cells() {
        for rank in [3, 4] {
            let tree = tree(rank);
            assert_eq!(tree.cells(), 1 << (2 * rank));
            let mut inside = 0;
            for cell in 0..tree.cells() {
                if let Some([i, o]) = tree.directions(cell) {
                    inside += 1;
                    assert_eq!(tree.cell(i, o), Some(cell), "{i:?} {o:?}");
                }
            }
            assert_eq!(inside, if rank == 3 { 32 } else { 256 });
        }
    }

    /// The half beyond the border, at which the light along the normal is, holds zeros.
    #[test]
    fn light_along_the_normal_is_in_the_used_half() {
        let tree = tree(3);
        let used = |cell: usize| tree.directions(cell).is_some();
        let values: Vec<f64> = (0..tree.cells()).map(|cell| f64::from(u8::from(used(cell)))).collect();
        for theta in [0.0, 1e-9, 30.0, 90.0] {
            let light = Direction::new(theta, 70.0);
            assert!(tree.cell(light, Direction::new(40.0, 33.0)).is_some_and(used), "{theta}");
            assert!((tree.mean_total(&values, theta) - PI).abs() < 1e-12, "{theta}");
        }
    }

    #[test]
    fn malformed_trees_are_refused() {
        let branch = |children| TreeNode::Branch { children, cell: 0 };
        assert_eq!(TensorTree::new(3, vec![]), None);
        assert_eq!(TensorTree::new(3, vec![branch(0)]), None, "its own child");
        assert_eq!(TensorTree::new(3, vec![branch(1)]), None, "no children");
        assert_eq!(TensorTree::new(5, vec![TreeNode::Grid { log2: 0, cell: 0 }]), None);
        assert_eq!(TensorTree::new(3, vec![TreeNode::Grid { log2: 0, cell: 1 }]), None);
        assert_eq!(TensorTree::new(3, vec![TreeNode::Grid { log2: 60, cell: 0 }]), None);
    }
}

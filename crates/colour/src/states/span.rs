//! Coordinates in which a set of colours has the size 1 in each direction, however flat it is.

use crate::Xyz;
use crate::matrix::{cross, dot};

/// A direction in which the colours extend less than this part of their largest extent has no coordinate.
const FLAT: f64 = 1e-9;
/// Relative rounding error of colours.
const ROUNDING: f64 = 1e-14;

/// Affine coordinates of colours: orthogonal directions, each divided by the extent of the set of colours.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Span {
    origin: [f64; 3],
    /// Orthogonal directions, of the set (the first `rank`) and perpendicular to it.
    directions: [[f64; 3]; 3],
    /// Extent of the set in each direction; 0 perpendicular to it.
    extents: [f64; 3],
    /// Number of dimensions of the set, 0 to 3.
    pub(super) rank: usize,
    /// Largest distance of a colour from black: the scale of rounding errors.
    pub(super) size: f64,
}

pub(super) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|part| part / length)
}

impl Span {
    /// Finds the directions, beginning with the farthest colour from the first.
    pub(super) fn of(colours: &[Xyz]) -> Self {
        let origin = colours[0].to_array();
        let size = colours.iter().map(|colour| length(colour.to_array())).fold(f64::MIN_POSITIVE, f64::max);
        let mut span = Self { origin, directions: [[0.0; 3]; 3], extents: [0.0; 3], rank: 0, size };
        let mut rests: Vec<_> = colours.iter().map(|colour| difference(colour.to_array(), origin)).collect();
        while span.rank < 3 {
            let farthest = rests
                .iter()
                .copied()
                .fold([0.0; 3], |most, rest| if length(rest) > length(most) { rest } else { most });
            let extent = length(farthest);
            if extent <= FLAT * span.extents[0] || extent <= ROUNDING * size {
                break;
            }
            let direction = unit(farthest);
            for rest in &mut rests {
                let along = dot(*rest, direction);
                *rest = [0, 1, 2].map(|k| rest[k] - along * direction[k]);
            }
            (span.directions[span.rank], span.extents[span.rank]) = (direction, extent);
            span.rank += 1;
        }
        span.complete();
        span
    }

    /// Adds directions that are perpendicular to those of the set.
    fn complete(&mut self) {
        let [first, second, _] = self.directions;
        self.directions = match self.rank {
            0 => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            1 => {
                let axis = (0..3).min_by(|i, k| first[*i].abs().total_cmp(&first[*k].abs())).unwrap_or(0);
                let across = unit(cross(first, [0, 1, 2].map(|k| f64::from(u8::from(k == axis)))));
                [first, across, cross(first, across)]
            }
            2 => [first, second, unit(cross(first, second))],
            _ => self.directions,
        };
    }

    /// Directions perpendicular to the set.
    pub(super) fn perpendicular(&self) -> &[[f64; 3]] {
        &self.directions[self.rank..]
    }

    /// Coordinates of a colour; 0 perpendicular to the set.
    pub(super) fn coordinates(&self, colour: Xyz) -> [f64; 3] {
        let from_origin = difference(colour.to_array(), self.origin);
        [0, 1, 2]
            .map(|k| if k < self.rank { dot(from_origin, self.directions[k]) / self.extents[k] } else { 0.0 })
    }

    /// Distance of a colour from the line or plane of the set, in X, Y, Z.
    pub(super) fn distance(&self, colour: Xyz) -> f64 {
        let from_origin = difference(colour.to_array(), self.origin);
        self.perpendicular().iter().map(|normal| dot(from_origin, *normal).powi(2)).sum::<f64>().sqrt()
    }

    /// Unit normal, in X, Y, Z, of a plane whose normal in coordinates is given.
    pub(super) fn normal(&self, in_coordinates: [f64; 3]) -> [f64; 3] {
        let part = |i: usize| -> f64 {
            (0..self.rank).map(|k| in_coordinates[k] / self.extents[k] * self.directions[k][i]).sum()
        };
        unit([part(0), part(1), part(2)])
    }
}

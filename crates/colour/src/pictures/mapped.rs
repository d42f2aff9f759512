//! Pictures whose colours follow from those of stored pixels by an affine map, which need no pixels of their own.

use crate::Xyz;

/// An affine map of X, Y, Z, such as an adaptation, or that to the white and black of a display.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AffineMap {
    matrix: [[f64; 3]; 3],
    offset: [f64; 3],
}

impl AffineMap {
    /// Each colour itself.
    pub const IDENTITY: Self =
        Self { matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset: [0.0; 3] };

    /// The map that a function is, which must be affine: from its values at 0 and at unit colours.
    pub fn of(map: impl Fn(Xyz) -> Xyz) -> Self {
        let offset = map(Xyz { x: 0.0, y: 0.0, z: 0.0 }).to_array();
        let column = |x: f64, y: f64, z: f64| map(Xyz { x, y, z }).to_array();
        let columns = [column(1.0, 0.0, 0.0), column(0.0, 1.0, 0.0), column(0.0, 0.0, 1.0)];
        let matrix = [0, 1, 2].map(|row| columns.map(|column| column[row] - offset[row]));
        Self { matrix, offset }
    }

    /// A colour after the map.
    pub fn apply(&self, colour: Xyz) -> Xyz {
        let colour = colour.to_array();
        let row = |k: usize| self.offset[k] + (0..3).map(|i| self.matrix[k][i] * colour[i]).sum::<f64>();
        Xyz { x: row(0), y: row(1), z: row(2) }
    }

    /// This map, and then a matrix.
    pub(super) fn then(&self, matrix: &[[f32; 3]; 3]) -> SingleMap {
        let row = |k: usize, of: &dyn Fn(usize) -> f64| -> f32 {
            (0..3).map(|i| f64::from(matrix[k][i]) * of(i)).sum::<f64>() as f32
        };
        SingleMap {
            matrix: [0, 1, 2].map(|k| [0, 1, 2].map(|j| row(k, &|i| self.matrix[i][j]))),
            offset: [0, 1, 2].map(|k| row(k, &|i| self.offset[i])),
        }
    }
}

/// An affine map in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct SingleMap {
    pub(super) matrix: [[f32; 3]; 3],
    pub(super) offset: [f32; 3],
}

/// A picture: X, Y, Z of pixels after an affine map.
#[derive(Debug, Clone, Copy)]
pub struct MappedPicture<'a> {
    /// X, Y, Z of each pixel before the map, rows from the top.
    pub pixels: &'a [[f32; 3]],
    /// The map.
    pub map: AffineMap,
}

impl<'a> From<&'a [[f32; 3]]> for MappedPicture<'a> {
    fn from(pixels: &'a [[f32; 3]]) -> Self {
        Self { pixels, map: AffineMap::IDENTITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Adaptation, D65_WHITE};

    #[test]
    fn map_equals_the_function_that_it_is_made_of() {
        let adaptation = Adaptation::between(D65_WHITE, Xyz { x: 1.1, y: 0.9, z: 0.4 }).unwrap();
        let darker = |colour: Xyz| {
            let [x, y, z] = adaptation.apply(colour).to_array().map(|one| 0.05 + 0.9 * one);
            Xyz { x, y, z }
        };
        let colour = Xyz { x: 0.2, y: 0.3, z: 0.7 };
        let [found, expected] = [AffineMap::of(darker).apply(colour), darker(colour)].map(Xyz::to_array);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?} {expected:?}");
        assert_eq!(AffineMap::IDENTITY.apply(colour), colour);
    }
}

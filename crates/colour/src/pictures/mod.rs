//! Pictures, and how much two of them differ for a reader at a distance.
//!
//! - [`Picture`]: three values for each pixel.
//! - [`Picture::into_lab`] and [`Picture::delta_e_2000`]: colour differences of the pixels.
//! - [`scielab`]: colours after the eye's blur, whose differences are those of S-CIELAB (Zhang and Wandell
//!   1996).
//! - [`compared`]: the same differences of large pictures, with little memory and several threads.
//! - [`FlipPicture`]: the difference that is noticed when two pictures alternate (FLIP, Andersson and others
//!   2020).
//!
//! Both compare pictures **in the same light**, such as what a display shows with what it should show.
//!
//! A reader's distance enters as [pixels per degree](pixels_per_degree) of the visual angle.

mod difference;
mod eye;
mod filter;
mod flip;
mod flip_rows;
mod histogram;
mod lab;
mod mapped;
mod planes;
mod rows;
mod scielab;
mod stripes;
mod view;

pub(crate) use flip::cube_root;
pub use flip::{FLIP_PIXELS_PER_DEGREE, FlipPicture};
pub use mapped::{AffineMap, MappedPicture};
pub use planes::NO_CONTRAST;
pub use scielab::{scielab, scielab_transfer};
pub use stripes::{Comparison, LEAST_PER_DEGREE, Reader, Spread, compared};

use crate::ColourError;

/// Three values for each pixel, such as X, Y and Z or linear sRGB. Rows begin at the top, pixels of a row at
/// the left.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    columns: usize,
    planes: [Vec<f64>; 3],
}

impl Picture {
    /// Creates a picture from its planes, each with the values of all pixels.
    ///
    /// # Errors
    ///
    /// [`ColourError::PictureShape`] unless the planes are equally long and consist of whole rows, at least
    /// one.
    pub fn new(columns: usize, planes: [Vec<f64>; 3]) -> Result<Self, ColourError> {
        let [count, ..] = [&planes[0], &planes[1], &planes[2]].map(|plane| plane.len());
        let is_whole = columns > 0 && count > 0 && count % columns == 0;
        if is_whole && planes.iter().all(|plane| plane.len() == count) {
            Ok(Self { columns, planes })
        } else {
            Err(ColourError::PictureShape { columns, values: planes.map(|plane| plane.len()) })
        }
    }

    /// Number of pixels in a row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.planes[0].len() / self.columns
    }

    /// Values of all pixels, by plane.
    pub fn planes(&self) -> &[Vec<f64>; 3] {
        &self.planes
    }

    /// Iterates over the three values of each pixel.
    pub fn pixels(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let [one, two, three] = &self.planes;
        one.iter().zip(two).zip(three).map(|((one, two), three)| [*one, *two, *three])
    }

    /// Replaces the values of each pixel.
    fn change(&mut self, change: impl Fn([f64; 3]) -> [f64; 3]) {
        let [one, two, three] = &mut self.planes;
        for ((one, two), three) in one.iter_mut().zip(two).zip(three) {
            [*one, *two, *three] = change([*one, *two, *three]);
        }
    }

    /// Checks that another picture has the same columns and rows.
    fn require_same_size(&self, other: &Self) -> Result<(), ColourError> {
        let [one, other] = [self, other].map(|picture| [picture.columns(), picture.rows()]);
        if one == other { Ok(()) } else { Err(ColourError::PictureSizes { one, other }) }
    }
}

/// Computes the number of pixels in one degree of the visual angle, in the middle of a picture.
///
/// `pitch_um`: distance of two pixels, micrometres; `distance_mm`: distance of the eye, millimetres.
pub fn pixels_per_degree(pitch_um: f64, distance_mm: f64) -> f64 {
    distance_mm * 1.0_f64.to_radians().tan() / (1e-3 * pitch_um)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn picture_consists_of_whole_rows() {
        let plane = || vec![0.0; 6];
        let picture = Picture::new(3, [plane(), plane(), plane()]).unwrap();
        assert_eq!((picture.columns(), picture.rows()), (3, 2));
        for (columns, last) in [(4, 6), (0, 6), (3, 3)] {
            let refused = Picture::new(columns, [plane(), plane(), vec![0.0; last]]);
            assert!(matches!(refused, Err(ColourError::PictureShape { .. })), "{columns} {last}");
        }
        assert!(Picture::new(3, [vec![], vec![], vec![]]).is_err());
    }

    /// 300 ppi at 400 mm: 82.46 pixels per degree.
    #[test]
    fn pixels_per_degree_depend_on_pitch_and_distance() {
        assert!((pixels_per_degree(25_400.0 / 300.0, 400.0) - 82.4649).abs() < 1e-4);
    }
}

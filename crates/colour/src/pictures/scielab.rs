//! S-CIELAB: colour differences of pictures after the eye's blur.
//!
//! **What.** X, Y and Z are converted to three opponent colours (luminance, red-green, blue-yellow), each of
//! them is blurred by a sum of Gaussians, and the blurred colours are compared in CIELAB.
//!
//! **Parameters.** The Gaussians of the filters, by full width at half maximum (degrees) and weight.
//!
//! **White.** The opponent colours are those of a reader who is adapted to D65. X, Y and Z are scaled by
//! those of the two whites, as CIELAB does: otherwise the dots of a halftone of greys would leak into the
//! colours in other lights.
//!
//! **Range.** Uniform pictures have the differences of CIELAB. The filters are applied by their continuous
//! transfer function, `sum of w exp(-(pi f FWHM)²/(4 ln 2))`; the original program samples kernels that are
//! one sample narrower and end at 0.5 degrees, which cuts off most of the widest Gaussian. Beyond its
//! borders, the picture continues as its mirror image.
//!
//! **Source.** Zhang and Wandell, *A spatial extension of CIELAB for digital color image reproduction*, SID
//! Symposium Digest 27, 731 (1996); matrix and filters of the authors' program `scielab.m`, 1996. (Those
//! printed in J. SID 5, 61 (1997) are others.)

use std::f64::consts::{LN_2, PI};

use papilio_fourier::{Separable, filtered};

use super::Picture;
use crate::matrix::{Matrix, inverse, times};
use crate::{ColourError, D65_WHITE, Xyz};

/// Matrix from X, Y, Z to the opponent colours: luminance, red-green, blue-yellow.
pub(super) const OPPONENT: Matrix = [
    [0.278_733_6, 0.721_803_1, -0.106_552_0],
    [-0.448_773_6, 0.289_805_6, 0.077_156_9],
    [0.085_951_3, -0.589_985_9, 0.501_108_9],
];

/// Filters of the opponent colours: full widths at half maximum (degrees) and weights of their Gaussians,
/// which sum to 1 within 2e-6; they are divided by their sum.
pub(super) const FILTERS: [&[(f64, f64)]; 3] = [
    &[(0.05, 1.003_27), (0.225, 0.114_416), (7.0, -0.117_686)],
    &[(0.0685, 0.616_725), (0.826, 0.383_275)],
    &[(0.092, 0.567_885), (0.6451, 0.432_115)],
];

/// Transfer function of a Gaussian.
pub(super) fn gaussian(cycles_per_degree: f64, width_deg: f64) -> f64 {
    (-(PI * cycles_per_degree * width_deg).powi(2) / (4.0 * LN_2)).exp()
}

/// Transfer functions of luminance, red-green and blue-yellow at a spatial frequency, cycles per degree; 1 at
/// 0.
pub fn scielab_transfer(cycles_per_degree: f64) -> [f64; 3] {
    FILTERS.map(|filter| {
        let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
        filter.iter().map(|(width, weight)| weight * gaussian(cycles_per_degree, *width)).sum::<f64>() / total
    })
}

/// Computes CIELAB of each pixel after the eye's blur; the colour differences of such pictures are those of
/// S-CIELAB.
///
/// All pictures have X, Y, Z on the scale of `white`. The source takes
/// [`delta_e_1976`](crate::Lab::delta_e_1976).
///
/// # Errors
///
/// [`ColourError::PictureSizes`] if the sizes differ; [`ColourError::NoWhite`] unless all values of the white
/// are positive.
pub fn scielab<const N: usize>(
    mut pictures: [Picture; N],
    white: Xyz,
    pixels_per_degree: f64,
) -> Result<[Picture; N], ColourError> {
    white.lab(white).ok_or(ColourError::NoWhite)?;
    let Some(first) = pictures.first() else { return Ok(pictures) };
    pictures.iter().try_for_each(|picture| first.require_same_size(picture))?;
    let (columns, rows) = (first.columns(), first.rows());
    let [x, y, z] = [D65_WHITE.x / white.x, D65_WHITE.y / white.y, D65_WHITE.z / white.z];
    let to_opponent = OPPONENT.map(|[a, b, c]| [a * x, b * y, c * z]);
    pictures.iter_mut().for_each(|picture| picture.change(|pixel| times(&to_opponent, pixel)));
    let transfers = [0, 1, 2].map(|k| terms(FILTERS[k], [columns, rows], pixels_per_degree));
    let mut planes: Vec<(usize, &mut [f64])> = Vec::with_capacity(3 * N);
    for picture in &mut pictures {
        planes.extend(picture.planes.iter_mut().map(Vec::as_mut_slice).enumerate());
    }
    for pair in planes.chunks_mut(2) {
        match pair {
            [(k, one), (l, other)] => filtered([one, other], columns, [&transfers[*k], &transfers[*l]]),
            [(k, one)] => filtered([one, &mut []], columns, [&transfers[*k], &[]]),
            _ => {}
        }
    }
    let back = inverse(&to_opponent);
    pictures.iter_mut().for_each(|picture| picture.change(|pixel| times(&back, pixel)));
    pictures.iter_mut().for_each(|picture| picture.change_to_lab(white));
    Ok(pictures)
}

/// The terms of a filter at the frequencies of the columns and rows: a Gaussian is the product of one along x
/// and one along y.
fn terms(filter: &[(f64, f64)], size: [usize; 2], pixels_per_degree: f64) -> Vec<Separable> {
    let total: f64 = filter.iter().map(|(_, weight)| weight).sum();
    let values = |count: usize, scale: f64, width: f64| -> Vec<f64> {
        let frequency = |k: usize| k as f64 / (2 * count) as f64 * pixels_per_degree;
        (0..count).map(|k| scale * gaussian(frequency(k), width)).collect()
    };
    let term = |(width, weight): &(f64, f64)| Separable {
        along_x: values(size[0], weight / total, *width),
        along_y: values(size[1], 1.0, *width),
    };
    filter.iter().map(term).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lab;

    /// Colour differences of two pictures.
    fn compared(
        pictures: [Picture; 2],
        white: Xyz,
        pixels_per_degree: f64,
        difference: impl Fn(Lab, Lab) -> f64,
    ) -> Result<Vec<f64>, ColourError> {
        let lab = |[l, a, b]: [f64; 3]| Lab { l, a, b };
        let [one, other] = scielab(pictures, white, pixels_per_degree)?;
        Ok(one.pixels().zip(other.pixels()).map(|(one, other)| difference(lab(one), lab(other))).collect())
    }

    /// Computed from the filters by a separate program.
    #[test]
    fn transfer_functions_have_known_values() {
        for (frequency, expected) in [
            (0.0, [1.0, 1.0, 1.0]),
            (4.0, [0.876_52, 0.472_09, 0.350_67]),
            (8.0, [0.567_63, 0.211_75, 0.082_57]),
            (16.0, [0.102_80, 0.008_57, 0.000_25]),
        ] {
            for (found, expected) in scielab_transfer(frequency).into_iter().zip(expected) {
                assert!((found - expected).abs() < 5.1e-6, "{frequency}: {found} {expected}");
            }
        }
    }

    fn grey(columns: usize, rows: usize, level: impl Fn(usize) -> f64) -> Picture {
        let pixel = |k: usize| (D65_WHITE * level(k % columns)).to_array();
        let plane = |i: usize| (0..columns * rows).map(|k| pixel(k)[i]).collect();
        Picture::new(columns, [plane(0), plane(1), plane(2)]).unwrap()
    }

    /// Dots of black and white have the difference of a grey in all lights: no light leaks into the colours.
    #[test]
    fn dots_of_grey_have_no_colour_in_any_light() {
        let dots = |light: Xyz| {
            let pixel = |k: usize| light * if (k % 24 + k / 24).is_multiple_of(2) { 0.9 } else { 0.1 };
            let plane = |i: usize| (0..24 * 24).map(|k| pixel(k).to_array()[i]).collect();
            Picture::new(24, [plane(0), plane(1), plane(2)]).unwrap()
        };
        let even = |light: Xyz| {
            let plane = |i: usize| vec![(light * 0.5).to_array()[i]; 24 * 24];
            Picture::new(24, [plane(0), plane(1), plane(2)]).unwrap()
        };
        let in_light =
            |light: Xyz| compared([dots(light), even(light)], light, 20.0, Lab::delta_e_2000).unwrap();
        let warm = Xyz { x: 1.0985, y: 1.0, z: 0.3558 };
        for (one, other) in in_light(D65_WHITE).into_iter().zip(in_light(warm)) {
            assert!((one - other).abs() < 1e-6 && one > 0.1, "{one} {other}");
        }
    }

    #[test]
    fn uniform_pictures_have_the_differences_of_cielab() {
        let (one, other) = (grey(20, 9, |_| 0.6), grey(20, 9, |_| 0.4));
        let expected = [0.6, 0.4].map(|level| (D65_WHITE * level).lab(D65_WHITE).unwrap());
        for measure in [Lab::delta_e_1976, Lab::delta_e_2000] {
            let found = compared([one.clone(), other.clone()], D65_WHITE, 60.0, measure).unwrap();
            let expected = measure(expected[0], expected[1]);
            assert!(found.iter().all(|found| (found - expected).abs() < 1e-9), "{expected} {found:?}");
        }
    }

    /// Two sinusoidal gratings of grey, 0.4 to 0.6 of the white, of opposite phase: the largest colour
    /// difference. Values of a separate program. (At 2 cycles per degree it exceeds 12.369, that of uniform
    /// greys: the widest Gaussian of luminance is negative.)
    #[test]
    fn fine_gratings_are_not_seen() {
        // The middle of an odd number of pixels is the extreme of a cycle.
        const PIXELS: usize = 61;
        let phase = |column: usize| 2.0 * PI * (column as f64 + 0.5) / PIXELS as f64;
        let grating = |sign: f64| grey(3 * PIXELS, 2, |column| 0.5 + 0.1 * sign * phase(column).cos());
        for (frequency, expected) in [(2.0, 13.313), (8.0, 7.647), (16.0, 1.480), (30.0, 0.005)] {
            let per_degree = frequency * PIXELS as f64;
            let found =
                compared([grating(1.0), grating(-1.0)], D65_WHITE, per_degree, Lab::delta_e_1976).unwrap();
            let most = found.into_iter().fold(0.0, f64::max);
            assert!((most - expected).abs() < 0.001, "{frequency}: {most} {expected}");
        }
    }

    #[test]
    fn other_size_or_no_white_is_refused() {
        let (one, other) = (grey(4, 4, |_| 0.5), grey(5, 4, |_| 0.5));
        let refused = compared([one.clone(), other], D65_WHITE, 60.0, Lab::delta_e_2000);
        assert!(matches!(refused, Err(ColourError::PictureSizes { .. })), "{refused:?}");
        let refused = compared([one.clone(), one], D65_WHITE * 0.0, 60.0, Lab::delta_e_2000);
        assert!(matches!(refused, Err(ColourError::NoWhite)), "{refused:?}");
    }
}

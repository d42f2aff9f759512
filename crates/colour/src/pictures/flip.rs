//! FLIP: the difference that is noticed when two pictures alternate at the same place.
//!
//! **What.** Two differences are combined. That of *colour*: the pictures, filtered by the eye's contrast
//! sensitivity, are compared in CIELAB, whose chroma is reduced in dark colours (Hunt effect), by the sum of
//! the difference of lightness and the distance in chroma (HyAB); the result is compressed to 0 to 1. That of
//! *features*: edges and points, found by the first and second derivatives of a Gaussian in lightness.
//! `FLIP = colour^(1 - features)`.
//!
//! **Parameters.** Pixels per degree; the source's 67.02 are those of a monitor of 3840 pixels and 0.7 m at
//! 0.7 m.
//!
//! **Range.** Pictures with values from 0 to 1 (low dynamic range); others are clipped. 0 means no
//! difference, 1 that of black and white, approximately.
//!
//! **Source.** Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, *FLIP: a difference
//! evaluator for alternating images*, Proc. ACM Comput. Graph. Interact. Tech. 3(2), 15 (2020). Results agree
//! with the authors' program `flip-evaluator` 1.7, to 1e-4; both compute in single precision.

use std::f32::consts::FRAC_1_SQRT_2;
use std::f64::consts::PI;

use super::Picture;
use super::filter::Kernel;
use crate::ColourError;

/// Pixels per degree that the source assumes: 3840 pixels on 0.7 m, seen from 0.7 m.
pub const FLIP_PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_25;

/// Matrix from linear sRGB to X, Y, Z, from the chromaticities of its primaries; its rows sum to [`WHITE`].
#[allow(clippy::excessive_precision, reason = "the digits of the source")]
const RGB_TO_XYZ: [[f32; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
/// Its inverse.
#[allow(clippy::excessive_precision, reason = "the digits of the source")]
const XYZ_TO_RGB: [[f32; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];
/// The white of sRGB.
#[allow(clippy::excessive_precision, reason = "the digits of the source")]
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// The Gaussians of the contrast sensitivity to lightness, red-green and blue-yellow:
/// `a sqrt(pi/b) exp(-(pi r)²/b)`, with the amplitude a and b in square degrees.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The largest b: it sets the radius of all kernels.
const WIDEST: f64 = 0.04;

/// Exponent of the colour difference.
const COLOUR_EXPONENT: f32 = 0.7;
/// This part of the largest colour difference is mapped to [`COMPRESSED`].
const COMPRESSED_FROM: f32 = 0.4;
const COMPRESSED: f32 = 0.95;
/// Width of a feature, degrees.
const FEATURE_DEG: f64 = 0.082;

/// A picture as FLIP sees it, to be compared with others.
pub struct FlipPicture {
    size: [usize; 2],
    /// Lightness and chroma of each pixel after the eye's blur.
    colours: Vec<[f32; 3]>,
    /// Strength of the edge and the point at each pixel.
    features: Vec<[f32; 2]>,
}

impl FlipPicture {
    /// Computes what is seen of a picture in linear sRGB. `pixels_per_degree`: of the visual angle, in the
    /// middle of the picture.
    pub fn new(picture: &Picture, pixels_per_degree: f64) -> Self {
        let columns = picture.columns();
        let mut planes =
            picture.planes.each_ref().map(|plane| plane.iter().map(|one| *one as f32).collect::<Vec<_>>());
        let [one, two, three] = &mut planes;
        for ((one, two), three) in one.iter_mut().zip(two).zip(three) {
            [*one, *two, *three] = opponent_of([*one, *two, *three]);
        }
        let features = features(&planes[0], columns, pixels_per_degree);
        let colours = seen(planes, columns, pixels_per_degree);
        Self { size: [columns, picture.rows()], colours, features }
    }

    /// Computes the difference of each pixel, 0 to 1.
    ///
    /// # Errors
    ///
    /// [`ColourError::PictureSizes`] if the sizes differ.
    pub fn differences(&self, other: &Self) -> Result<Vec<f32>, ColourError> {
        if self.size != other.size {
            return Err(ColourError::PictureSizes { one: self.size, other: other.size });
        }
        let most = largest_colour_difference();
        let colours = self.colours.iter().zip(&other.colours);
        let features = self.features.iter().zip(&other.features);
        let mut differences = Vec::with_capacity(self.colours.len());
        for (colours, features) in colours.zip(features) {
            differences.push(difference(colours, features, most));
        }
        Ok(differences)
    }
}

/// The difference of a pixel from its colours and features.
#[inline(always)]
pub(super) fn difference(
    (one, other): (&[f32; 3], &[f32; 3]),
    (feature, far): (&[f32; 2], &[f32; 2]),
    most: f32,
) -> f32 {
    let strength = (feature[0] - far[0]).abs().max((feature[1] - far[1]).abs());
    // The exponent of the difference of features is a half.
    let feature = (strength * FRAC_1_SQRT_2).sqrt();
    let value = power(compressed(hyab(*one, *other), most), 1.0 - feature);
    // Without branches, for vectors.
    let is_same = (one[0] == other[0]) & (one[1] == other[1]) & (one[2] == other[2]);
    if is_same { 0.0 } else { value }
}

/// Power of a number from 0 to 200, within 2e-6 of it for exponents from 0 to 1: without branches, for vectors.
#[inline(always)]
fn power(base: f32, exponent: f32) -> f32 {
    // The mantissa is between the roots of 1/2 and 2.
    let shifted = base.to_bits().wrapping_add(0x3F80_0000 - 0x3F35_04F3);
    let mantissa = f32::from_bits((shifted & 0x007F_FFFF) + 0x3F35_04F3);
    let t = (mantissa - 1.0) / (mantissa + 1.0);
    let s = t * t;
    let series = 2.0 * t * (1.0 + s * (1.0 / 3.0 + s * (1.0 / 5.0 + s * (1.0 / 7.0 + s * (1.0 / 9.0)))));
    let binary = ((shifted >> 23) as i32 - 127) as f32 + series * std::f32::consts::LOG2_E;
    let raised = (exponent * binary).clamp(-125.0, 125.0);
    // Adding and subtracting it rounds; the last bits of the sum are those of the whole number.
    const ROUNDS: f32 = 12_582_912.0;
    let rounded = raised + ROUNDS;
    let whole = rounded.to_bits().wrapping_sub(ROUNDS.to_bits());
    let x = (raised - (rounded - ROUNDS)) * std::f32::consts::LN_2;
    let part =
        1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0 + x / 720.0)))));
    let power = part * f32::from_bits(whole.wrapping_add(127) << 23);
    if base > 0.0 { power } else { 0.0 }
}

#[inline(always)]
fn times(matrix: &[[f32; 3]; 3], [a, b, c]: [f32; 3]) -> [f32; 3] {
    let row = |[x, y, z]: [f32; 3]| x * a + y * b + z * c;
    [row(matrix[0]), row(matrix[1]), row(matrix[2])]
}

/// X, Y and Z relative to the white.
#[inline(always)]
fn to_xyz(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = times(&RGB_TO_XYZ, rgb);
    [x / WHITE[0], y, z / WHITE[2]]
}

/// CIELAB without its cube roots: linear in light, so that it can be filtered. Lightness is on a scale of 0
/// to 1.
#[inline(always)]
fn opponent([x, y, z]: [f32; 3]) -> [f32; 3] {
    [y, 500.0 * (x - y), 200.0 * (y - z)]
}

/// That of linear sRGB, which is clipped to 0 to 1.
#[inline(always)]
pub(super) fn opponent_of([red, green, blue]: [f32; 3]) -> [f32; 3] {
    opponent(to_xyz([red.clamp(0.0, 1.0), green.clamp(0.0, 1.0), blue.clamp(0.0, 1.0)]))
}

#[inline(always)]
fn from_opponent([y, red_green, blue_yellow]: [f32; 3]) -> [f32; 3] {
    [WHITE[0] * (y + red_green / 500.0), y, WHITE[2] * (y - blue_yellow / 200.0)]
}

/// Cube root of a normal positive number, within 3e-7 of it: a third of its exponent, and two steps of
/// Halley's method.
#[inline(always)]
pub(crate) fn cube_root(value: f32) -> f32 {
    let first = f32::from_bits(value.to_bits() / 3 + 709_958_130);
    let mut root = first;
    for _ in 0..2 {
        let cube = root * root * root;
        root = root * (cube + 2.0 * value) / (2.0 * cube + value);
    }
    root
}

/// Cube root of a ratio to the white, linear below the toe. Both branches are computed: vectors have no others.
#[inline(always)]
fn hunt_root(ratio: f32) -> f32 {
    const DELTA: f32 = 6.0 / 29.0;
    const TOE: f32 = DELTA * DELTA * DELTA;
    let straight = ratio / (3.0 * DELTA * DELTA) + 4.0 / 29.0;
    let cube = cube_root(if ratio > TOE { ratio } else { TOE });
    if ratio > TOE { cube } else { straight }
}

/// CIELAB with less chroma in dark colours.
#[inline(always)]
fn hunt_adjusted(xyz: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = [hunt_root(xyz[0]), hunt_root(xyz[1]), hunt_root(xyz[2])];
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// Difference of lightness plus distance in chroma, to the power of [`COLOUR_EXPONENT`].
#[inline(always)]
fn hyab(one: [f32; 3], other: [f32; 3]) -> f32 {
    let [l, a, b] = [one[0] - other[0], one[1] - other[1], one[2] - other[2]];
    power(l.abs() + (a * a + b * b).sqrt(), COLOUR_EXPONENT)
}

/// That of the green and the blue primary.
pub(super) fn largest_colour_difference() -> f32 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt_adjusted(to_xyz(rgb)));
    hyab(green, blue)
}

/// Maps 0 to `most` to 0 to 1, in two straight lines: large differences are compressed.
#[inline(always)]
fn compressed(difference: f32, most: f32) -> f32 {
    let bend = COMPRESSED_FROM * most;
    if difference < bend {
        COMPRESSED / bend * difference
    } else {
        COMPRESSED + (difference - bend) / (most - bend) * (1.0 - COMPRESSED)
    }
}

/// Radius of the kernels of colours, pixels.
fn radius(pixels_per_degree: f64) -> f64 {
    (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil()
}

/// The colours of a picture after the eye's blur.
fn seen(planes: [Vec<f32>; 3], columns: usize, pixels_per_degree: f64) -> Vec<[f32; 3]> {
    let mut blurs = blurs(pixels_per_degree).into_iter();
    let [l, a, b] = planes.map(|plane| blurred(&plane, columns, &blurs.next().unwrap_or_default()));
    l.into_iter().zip(a).zip(b).map(|((l, a), b)| seen_colour([l, a, b])).collect()
}

/// The colour that is seen of opponent colours after the eye's blur.
#[inline(always)]
pub(super) fn seen_colour(opponent: [f32; 3]) -> [f32; 3] {
    let [red, green, blue] = times(&XYZ_TO_RGB, from_opponent(opponent));
    hunt_adjusted(to_xyz([red.clamp(0.0, 1.0), green.clamp(0.0, 1.0), blue.clamp(0.0, 1.0)]))
}

/// The Gaussians of each opponent colour, each with its part of their sum: normalised to the sum of its samples.
pub(super) fn blurs(pixels_per_degree: f64) -> [Vec<(f32, Kernel)>; 3] {
    let radius = radius(pixels_per_degree);
    SENSITIVITY.map(|gaussians| {
        let terms: Vec<(f64, Vec<f64>)> = gaussians
            .iter()
            .map(|(amplitude, b)| {
                let kernel = samples(radius, |pixel| (-(PI * pixel / pixels_per_degree).powi(2) / b).exp());
                let sum = both_sides(&kernel);
                let kernel = kernel.into_iter().map(|weight| weight / sum).collect();
                (amplitude * (PI / b).sqrt() * sum.powi(2), kernel)
            })
            .collect();
        let total: f64 = terms.iter().map(|(scale, _)| scale).sum();
        terms.iter().map(|(scale, kernel)| ((scale / total) as f32, Kernel::even(kernel))).collect()
    })
}

/// Filters a plane by a sum of Gaussians.
fn blurred(plane: &[f32], columns: usize, gaussians: &[(f32, Kernel)]) -> Vec<f32> {
    let mut result = vec![0.0; plane.len()];
    for (scale, kernel) in gaussians {
        let part = kernel.along_columns(&kernel.along_rows(plane, columns), columns);
        result.iter_mut().zip(part).for_each(|(sum, value)| *sum += scale * value);
    }
    result
}

/// Values at distances of 0, 1, ... pixels.
fn samples(radius: f64, function: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=radius as i32).map(|pixel| function(f64::from(pixel))).collect()
}

/// Sum of the weights on both sides.
fn both_sides(weights: &[f64]) -> f64 {
    weights[0] + 2.0 * weights[1..].iter().sum::<f64>()
}

/// The kernels of features: a Gaussian, and its first and second derivatives, for edges and for points.
pub(super) fn feature_kernels(pixels_per_degree: f64) -> [Kernel; 3] {
    let sigma = 0.5 * FEATURE_DEG * pixels_per_degree;
    let radius = (3.0 * sigma).ceil();
    let gaussian = |pixel: f64| (-0.5 * (pixel / sigma).powi(2)).exp();
    let smooth = samples(radius, gaussian);
    let total = both_sides(&smooth);
    let smooth = Kernel::even(&smooth.iter().map(|weight| weight / total).collect::<Vec<_>>());
    // The positive weights of a kernel have a sum of 1, the negative ones -1.
    let edge = samples(radius, |pixel| -pixel * gaussian(pixel));
    let total = -edge.iter().sum::<f64>();
    let edge = Kernel::odd(&edge.iter().map(|weight| weight / total).collect::<Vec<_>>());
    let point = samples(radius, |pixel| ((pixel / sigma).powi(2) - 1.0) * gaussian(pixel));
    let half =
        |sign: f64| both_sides(&point.iter().map(|weight| (sign * weight).max(0.0)).collect::<Vec<_>>());
    let [positive, negative] = [half(1.0), half(-1.0)];
    let scaled = |weight: &f64| weight / if *weight > 0.0 { positive } else { negative };
    let point = Kernel::even(&point.iter().map(scaled).collect::<Vec<_>>());
    [smooth, edge, point]
}

/// Strength of edges and points at each pixel, from lightness on a scale of 0 to 1.
fn features(lightness: &[f32], columns: usize, pixels_per_degree: f64) -> Vec<[f32; 2]> {
    let [smooth, edge, point] = feature_kernels(pixels_per_degree);
    let along_y = smooth.along_rows(lightness, columns);
    let mut features = vec![[0.0; 2]; lightness.len()];
    for (k, kernel) in [edge, point].iter().enumerate() {
        let x = smooth.along_columns(&kernel.along_rows(lightness, columns), columns);
        let y = kernel.along_columns(&along_y, columns);
        for ((feature, x), y) in features.iter_mut().zip(&x).zip(&y) {
            feature[k] = (x * x + y * y).sqrt();
        }
    }
    features
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_those_of_the_library() {
        for (k, exponent) in (1..4000).map(|k| (k, (k % 101) as f32 / 100.0)) {
            let base = 10.0_f32.powf(k as f32 / 600.0 - 4.5);
            let (found, expected) = (power(base, exponent), base.powf(exponent));
            assert!((found / expected - 1.0).abs() < 2e-6, "{base} {exponent}: {found} {expected}");
        }
        assert_eq!(power(0.0, 0.7), 0.0);
    }

    fn uniform(rgb: [f64; 3]) -> Picture {
        Picture::new(64, rgb.map(|value| vec![value; 64 * 64])).unwrap()
    }

    fn flip(pictures: [&Picture; 2], pixels_per_degree: f64) -> Result<Vec<f64>, ColourError> {
        let [one, other] = pictures.map(|picture| FlipPicture::new(picture, pixels_per_degree));
        Ok(one.differences(&other)?.into_iter().map(f64::from).collect())
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Linear light of an encoded grey.
    fn linear(encoded: f64) -> f64 {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }

    /// Pixels of `flip-evaluator` 1.7. In uniform pictures its single precision finds features of 1e-7, whose
    /// root adds up to 1e-4.
    #[test]
    fn uniform_pictures_agree_with_the_authors_program() {
        let grey = |encoded: f64| uniform([linear(encoded); 3]);
        for ([one, other], expected) in [
            ([uniform([0.0; 3]), uniform([1.0; 3])], 0.967_388_3),
            ([grey(0.5), grey(0.6)], 0.285_063),
            ([uniform([1.0, 0.0, 0.0]), uniform([0.0, 1.0, 0.0])], 0.986_665),
        ] {
            let found = flip([&one, &other], FLIP_PIXELS_PER_DEGREE).unwrap();
            assert!(found.iter().all(|found| (found - expected).abs() < 1e-4), "{} {expected}", found[0]);
        }
    }

    /// A checkerboard of pixels and the grey of the same light.
    #[test]
    fn fine_checkerboard_is_a_grey() {
        let level = |k: usize| ((k / 64 + k % 64) % 2) as f64;
        let board = Picture::new(64, [0; 3].map(|_| (0..64 * 64).map(level).collect())).unwrap();
        let found = flip([&board, &uniform([linear(0.735_357); 3])], FLIP_PIXELS_PER_DEGREE).unwrap();
        assert!((mean(&found) - 0.004_205_6).abs() < 1e-5, "{}", mean(&found));
        assert!((found[0] - 0.515_740_7).abs() < 1e-4 && (found[3 * 64 + 5] - 0.002_297_3).abs() < 1e-5);
    }

    #[test]
    fn same_pictures_do_not_differ_and_other_sizes_are_refused() {
        let picture = uniform([0.2, 0.7, 0.4]);
        assert!(flip([&picture, &picture], 60.0).unwrap().iter().all(|value| *value == 0.0));
        let small = Picture::new(1, [vec![0.0], vec![0.0], vec![0.0]]).unwrap();
        assert!(matches!(flip([&picture, &small], 60.0), Err(ColourError::PictureSizes { .. })));
    }
}

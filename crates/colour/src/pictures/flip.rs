//! FLIP: the difference that is noticed when two pictures alternate at the same place.
//!
//! **What.** Two differences are combined. That of *colour*: the pictures, filtered by the eye's contrast sensitivity, are
//! compared in CIELAB, whose chroma is reduced in dark colours (Hunt effect), by the sum of the difference of lightness
//! and the distance in chroma (HyAB); the result is compressed to 0 to 1. That of *features*: edges and points, found
//! by the first and second derivatives of a Gaussian in lightness. `FLIP = colour^(1 - features)`.
//!
//! **Parameters.** Pixels per degree; the source's 67.02 are those of a monitor of 3840 pixels and 0.7 m at 0.7 m.
//!
//! **Range.** Pictures with values from 0 to 1 (low dynamic range); others are clipped. 0 means no difference, 1 that of
//! black and white, approximately.
//!
//! **Source.** Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, *FLIP: a difference evaluator for
//! alternating images*, Proc. ACM Comput. Graph. Interact. Tech. 3(2), 15 (2020). Results agree with the authors' program
//! `flip-evaluator` 1.7, which computes in single precision, to 1e-4.

use std::f64::consts::PI;

use super::filter::convolved;
use super::{Picture, xyz};
use crate::{ColourError, Lab, Xyz};

/// Pixels per degree that the source assumes: 3840 pixels on 0.7 m, seen from 0.7 m.
pub const FLIP_PIXELS_PER_DEGREE: f64 = 67.020_643_276_582_25;

/// Matrix from linear sRGB to X, Y, Z, from the chromaticities of its primaries; its rows sum to [`WHITE`].
const RGB_TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
/// Its inverse.
const XYZ_TO_RGB: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];
/// The white of sRGB.
const WHITE: Xyz = Xyz { x: 0.950_428_545_4, y: 1.0, z: 1.088_900_371 };

/// The Gaussians of the contrast sensitivity to lightness, red-green and blue-yellow: `a sqrt(pi/b) exp(-(pi r)²/b)`, with
/// the amplitude a and b in square degrees.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The largest b: it sets the radius of all kernels.
const WIDEST: f64 = 0.04;

/// Exponent of the colour difference.
const COLOUR_EXPONENT: f64 = 0.7;
/// This part of the largest colour difference is mapped to [`COMPRESSED`].
const COMPRESSED_FROM: f64 = 0.4;
const COMPRESSED: f64 = 0.95;
/// Exponent of the difference of features.
const FEATURE_EXPONENT: f64 = 0.5;
/// Width of a feature, degrees.
const FEATURE_DEG: f64 = 0.082;

/// Computes the difference of each pixel, 0 to 1.
///
/// Both pictures are linear sRGB. `pixels_per_degree`: of the visual angle, in the middle of the picture.
///
/// # Errors
///
/// [`ColourError::PictureSizes`] if the sizes differ.
pub fn flip([one, other]: [&Picture; 2], pixels_per_degree: f64) -> Result<Vec<f64>, ColourError> {
    one.require_same_size(other)?;
    let opponents = [one, other]
        .map(|picture| picture.clone().map(|rgb| opponent(to_xyz(rgb.map(|value| value.clamp(0.0, 1.0))))));
    let most = largest_colour_difference();
    let [colours, other_colours] = opponents.each_ref().map(|picture| seen(picture, pixels_per_degree));
    let [features, other_features] = opponents.each_ref().map(|picture| features(picture, pixels_per_degree));
    let colour =
        colours.into_iter().zip(other_colours).map(|(one, other)| compressed(hyab(one, other), most));
    let feature = features.into_iter().zip(other_features).map(|(one, other)| {
        let [edge, point] = [0, 1].map(|k| (one[k] - other[k]).abs());
        (edge.max(point) / 2.0_f64.sqrt()).powf(FEATURE_EXPONENT)
    });
    Ok(colour.zip(feature).map(|(colour, feature)| colour.powf(1.0 - feature)).collect())
}

fn to_xyz([r, g, b]: [f64; 3]) -> Xyz {
    xyz(RGB_TO_XYZ.map(|[x, y, z]| x * r + y * g + z * b))
}

/// CIELAB without its cube roots: linear in light, so that it can be filtered.
fn opponent(colour: Xyz) -> [f64; 3] {
    let [x, y, z] = [colour.x / WHITE.x, colour.y / WHITE.y, colour.z / WHITE.z];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([lightness, red_green, blue_yellow]: [f64; 3]) -> Xyz {
    let y = (lightness + 16.0) / 116.0;
    Xyz { x: WHITE.x * (y + red_green / 500.0), y: WHITE.y * y, z: WHITE.z * (y - blue_yellow / 200.0) }
}

/// CIELAB with less chroma in dark colours.
fn hunt_adjusted(colour: Xyz) -> Lab {
    let root = |ratio: f64| {
        const DELTA: f64 = 6.0 / 29.0;
        if ratio > DELTA.powi(3) { ratio.cbrt() } else { ratio / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let [x, y, z] = [colour.x / WHITE.x, colour.y / WHITE.y, colour.z / WHITE.z].map(root);
    let l = 116.0 * y - 16.0;
    Lab { l, a: 0.01 * l * 500.0 * (x - y), b: 0.01 * l * 200.0 * (y - z) }
}

/// Difference of lightness plus distance in chroma, to the power of [`COLOUR_EXPONENT`].
fn hyab(one: Lab, other: Lab) -> f64 {
    ((one.l - other.l).abs() + (one.a - other.a).hypot(one.b - other.b)).powf(COLOUR_EXPONENT)
}

/// That of the green and the blue primary.
fn largest_colour_difference() -> f64 {
    let [green, blue] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|rgb| hunt_adjusted(to_xyz(rgb)));
    hyab(green, blue)
}

/// Maps 0 to `most` to 0 to 1, in two straight lines: large differences are compressed.
fn compressed(difference: f64, most: f64) -> f64 {
    let bend = COMPRESSED_FROM * most;
    if difference < bend {
        COMPRESSED / bend * difference
    } else {
        COMPRESSED + (difference - bend) / (most - bend) * (1.0 - COMPRESSED)
    }
}

/// The colours of a picture after the eye's blur.
fn seen(opponent: &Picture, pixels_per_degree: f64) -> Vec<Lab> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
    let planes = [0, 1, 2]
        .map(|k| blurred(&opponent.planes[k], opponent.columns, SENSITIVITY[k], radius, pixels_per_degree));
    let filtered = Picture { columns: opponent.columns, planes };
    let labs = filtered.pixels().map(|pixel| {
        let colour = from_opponent(pixel);
        let rgb = XYZ_TO_RGB.map(|[x, y, z]| x * colour.x + y * colour.y + z * colour.z);
        hunt_adjusted(to_xyz(rgb.map(|value| value.clamp(0.0, 1.0))))
    });
    labs.collect()
}

/// Filters a plane by a sum of Gaussians, normalised to the sum of its samples.
fn blurred(
    plane: &[f64],
    columns: usize,
    gaussians: &[(f64, f64)],
    radius: f64,
    pixels_per_degree: f64,
) -> Vec<f64> {
    let terms: Vec<(f64, Vec<f64>)> = gaussians
        .iter()
        .map(|(amplitude, b)| {
            let kernel = samples(radius, |pixel| (-(PI * pixel / pixels_per_degree).powi(2) / b).exp());
            (amplitude * (PI / b).sqrt(), kernel)
        })
        .collect();
    let total: f64 = terms.iter().map(|(scale, kernel)| scale * kernel.iter().sum::<f64>().powi(2)).sum();
    let mut result = vec![0.0; plane.len()];
    for (scale, kernel) in terms {
        let part = convolved(plane, columns, &kernel, &kernel);
        result.iter_mut().zip(part).for_each(|(sum, value)| *sum += scale / total * value);
    }
    result
}

fn samples(radius: f64, function: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i32;
    (-radius..=radius).map(|pixel| function(f64::from(pixel))).collect()
}

/// Strength of edges and points at each pixel, from lightness on a scale of 0 to 1.
fn features(opponent: &Picture, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let lightness: Vec<f64> = opponent.planes[0].iter().map(|value| (value + 16.0) / 116.0).collect();
    let sigma = 0.5 * FEATURE_DEG * pixels_per_degree;
    let radius = (3.0 * sigma).ceil();
    let gaussian = |pixel: f64| (-0.5 * (pixel / sigma).powi(2)).exp();
    let total: f64 = samples(radius, gaussian).iter().sum();
    let smooth = samples(radius, |pixel| gaussian(pixel) / total);
    let edge = balanced(samples(radius, |pixel| -pixel * gaussian(pixel)));
    let point = balanced(samples(radius, |pixel| ((pixel / sigma).powi(2) - 1.0) * gaussian(pixel)));
    let [edges, points] = [edge, point].map(|kernel| {
        let along_x = convolved(&lightness, opponent.columns, &kernel, &smooth);
        let along_y = convolved(&lightness, opponent.columns, &smooth, &kernel);
        along_x.into_iter().zip(along_y).map(|(x, y)| x.hypot(y)).collect::<Vec<_>>()
    });
    edges.into_iter().zip(points).map(|(edge, point)| [edge, point]).collect()
}

/// Scales the positive weights of a kernel to a sum of 1, and the negative ones to -1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    kernel.into_iter().map(|weight| weight / if weight > 0.0 { positive } else { negative }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(rgb: [f64; 3]) -> Picture {
        Picture::new(64, rgb.map(|value| vec![value; 64 * 64])).unwrap()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    /// Linear light of an encoded grey.
    fn linear(encoded: f64) -> f64 {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }

    /// Pixels of `flip-evaluator` 1.7. In uniform pictures its single precision finds features of 1e-7, whose root adds up
    /// to 1e-4.
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

    /// Waves of colour that become finer downwards, at three distances: means and three pixels of `flip-evaluator` 1.7.
    #[test]
    fn coloured_waves_agree_with_the_authors_program() {
        let wave = |k: usize, row: usize, column: usize| {
            let (i, j, k) = (row as f64, column as f64, k as f64);
            0.5 + 0.5 * (0.37 * (k + 1.0) * i + 0.11 * (k + 2.0) * j * (1.0 + 0.05 * i)).sin()
        };
        let plane = |k: usize| (0..24 * 40).map(move |pixel| wave(k, pixel / 40, pixel % 40));
        let one = Picture::new(40, [0, 1, 2].map(|k| plane(k).collect())).unwrap();
        let other =
            Picture::new(40, [1, 2, 3].map(|k| plane(k).map(|value| value * value).collect())).unwrap();
        for (pixels_per_degree, expected_mean, expected) in [
            (FLIP_PIXELS_PER_DEGREE, 0.637_202, [0.378_011_2, 0.849_577_2, 0.332_997_1]),
            (30.0, 0.814_675, [0.525_255_4, 0.788_327_7, 0.439_944_1]),
            (120.0, 0.464_120, [0.404_519_5, 0.678_887_2, 0.271_789_4]),
        ] {
            let found = flip([&one, &other], pixels_per_degree).unwrap();
            assert!((mean(&found) - expected_mean).abs() < 1e-4, "{} {expected_mean}", mean(&found));
            for (pixel, expected) in [0, 3 * 40 + 5, 10 * 40 + 20].into_iter().zip(expected) {
                assert!((found[pixel] - expected).abs() < 1e-4, "{pixel}: {} {expected}", found[pixel]);
            }
        }
    }

    #[test]
    fn same_pictures_do_not_differ_and_other_sizes_are_refused() {
        let picture = uniform([0.2, 0.7, 0.4]);
        assert!(flip([&picture, &picture], 60.0).unwrap().iter().all(|value| *value == 0.0));
        let small = Picture::new(1, [vec![0.0], vec![0.0], vec![0.0]]).unwrap();
        assert!(matches!(flip([&picture, &small], 60.0), Err(ColourError::PictureSizes { .. })));
    }
}

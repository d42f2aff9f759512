//! The derived numbers in table 5.1 of Feng 2012 follow from its X, Y, Z.
//!
//! The tolerance follows from the rounding of X, Y, Z, which leaves a box of possible values. Each derived
//! number is computed at the eight corners of this box. The printed number must lie within their range,
//! extended by half a unit of its last digit.

use papilio_colour::{D65_UV, D65_WHITE, GamutReference, LUMENS_PER_WATT, UvPrime, Xyz, gamut_percent};
use papilio_validation::table_5_1::{Column, GAMUT_PERCENT, TABLE_5_1, half_digit};

/// Returns the corners of the box of colours that are rounded to `xyz`.
fn corners(xyz: Xyz) -> Vec<Xyz> {
    let moved = |value: f64, up: bool| value + if up { half_digit(value) } else { -half_digit(value) };
    (0..8)
        .map(|bits| Xyz {
            x: moved(xyz.x, bits & 1 != 0),
            y: moved(xyz.y, bits & 2 != 0),
            z: moved(xyz.z, bits & 4 != 0),
        })
        .collect()
}

/// Checks that `printed` is within the rounded range of `metric` over the box around `xyz`.
fn follows(column: &Column, row: &str, printed: f64, metric: impl Fn(Xyz) -> f64) {
    let values: Vec<f64> = corners(column.xyz).into_iter().map(metric).collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min) - half_digit(printed);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) + half_digit(printed);
    assert!((low..=high).contains(&printed), "{} {row}: {printed}, from XYZ {low} to {high}", column.name);
}

/// Checks that `computed` agrees with the printed number within the tolerance from the rounding of X, Y, Z.
fn close(column: &Column, row: &str, printed: f64, computed: f64, tolerance: f64) {
    assert!((printed - computed).abs() <= tolerance, "{} {row}: {printed}, computed {computed}", column.name);
}

fn uv(xyz: Xyz) -> UvPrime {
    xyz.uv_prime().unwrap()
}

#[test]
fn chromaticities_follow_from_xyz() {
    for column in &TABLE_5_1 {
        follows(column, "x", column.chromaticity[0], |c| c.chromaticity().unwrap().x);
        follows(column, "y", column.chromaticity[1], |c| c.chromaticity().unwrap().y);
        follows(column, "z", column.chromaticity[2], |c| c.z / (c.x + c.y + c.z));
        follows(column, "u'", column.uv[0], |c| uv(c).u);
        follows(column, "v'", column.uv[1], |c| uv(c).v);
        follows(column, "dR", column.distance_from_d65, |c| uv(c).distance(D65_UV));
        let distance = uv(column.xyz).distance(D65_UV);
        close(column, "dR", column.distance_from_d65, distance, 0.0007);
    }
}

#[test]
fn lab_follows_from_xyz_with_white_d65() {
    for column in &TABLE_5_1 {
        let lab = |c: Xyz| c.lab(D65_WHITE).unwrap();
        follows(column, "L*", column.lab[0], |c| lab(c).l);
        follows(column, "a*", column.lab[1], |c| lab(c).a);
        follows(column, "b*", column.lab[2], |c| lab(c).b);
        close(column, "a*", column.lab[1], lab(column.xyz).a, 0.2);
        close(column, "b*", column.lab[2], lab(column.xyz).b, 0.2);
    }
}

#[test]
fn luminance_and_contrast_follow_from_y() {
    let black = TABLE_5_1[1].xyz.y;
    for column in &TABLE_5_1 {
        follows(column, "Ynits", column.nits, |c| LUMENS_PER_WATT * c.y);
        if column.name != "black" {
            let relative = half_digit(column.xyz.y) / column.xyz.y + half_digit(black) / black;
            let tolerance = relative * column.contrast + half_digit(column.contrast);
            close(column, "CR", column.contrast, column.xyz.y / black, tolerance);
        }
    }
}

#[test]
fn rgb_rows_are_linear_matrix_of_chromaticity() {
    for column in &TABLE_5_1 {
        let computed = column.xyz.hue_rgb().unwrap();
        for (row, (printed, computed)) in ["R", "G", "B"].iter().zip(column.rgb.into_iter().zip(computed)) {
            close(column, row, printed, computed, 1.0);
        }
    }
}

/// 33.67 % of sRGB, 33.34 % of EBU: with the rounding, the printed 33.4 can be either.
#[test]
fn gamut_agrees_with_both_srgb_and_ebu() {
    let [_, _, red, green, blue] = TABLE_5_1.map(|column| column.xyz);
    for (reference, expected) in [(GamutReference::Srgb, 33.67), (GamutReference::Ebu, 33.34)] {
        let percent = |r, g, b| gamut_percent([uv(r), uv(g), uv(b)], reference);
        assert!((percent(red, green, blue) - expected).abs() < 0.005, "{}", percent(red, green, blue));
        let mut all = vec![];
        for r in corners(red) {
            for g in corners(green) {
                all.extend(corners(blue).into_iter().map(|b| percent(r, g, b)));
            }
        }
        let low = all.iter().copied().fold(f64::INFINITY, f64::min) - half_digit(GAMUT_PERCENT);
        let high = all.iter().copied().fold(0.0, f64::max) + half_digit(GAMUT_PERCENT);
        assert!((low..=high).contains(&GAMUT_PERCENT), "{reference:?}: {low} to {high}");
    }
}

/// A front surface of reflectance R in diffuse light, to first order:
/// `X' = (1 - R)^2 X + R X_D65`. Contrast and gamut (of sRGB) decrease.
#[test]
fn front_reflection_lowers_contrast_and_gamut() {
    let expected =
        [(0.0, 23.96, 33.7), (0.5, 16.31, 27.2), (1.0, 12.42, 22.4), (2.0, 8.50, 15.9), (4.0, 5.33, 9.1)];
    for (percent, contrast, gamut) in expected {
        let r = percent / 100.0;
        let seen = |xyz: Xyz| xyz * (1.0 - r) * (1.0 - r) + D65_WHITE * r;
        let [white, black, red, green, blue] = TABLE_5_1.map(|column| seen(column.xyz));
        assert!((white.y / black.y - contrast).abs() <= 0.005, "R = {percent} %: {}", white.y / black.y);
        let srgb = gamut_percent([red, green, blue].map(uv), GamutReference::Srgb);
        assert!((srgb - gamut).abs() <= 0.05, "R = {percent} %: {srgb}");
    }
}

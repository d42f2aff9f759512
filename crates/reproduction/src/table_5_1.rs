//! Table 5.1 of Feng 2012: the colorimetric output of one run, as printed.
//!
//! Five drive states of an interferometric panel with a diffuser. X, Y, Z are
//! relative to a perfect white under D65; all other rows follow from them.
//! Numbers are printed with three significant digits (without trailing zeros),
//! the RGB rows as integers.

use papilio_colour::Xyz;

/// A column of the table: one drive state.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// The drive state.
    pub name: &'static str,
    /// "Xcap, Ycap, Zcap": relative tristimulus values.
    pub xyz: Xyz,
    /// "dR": u'v' distance from D65.
    pub distance_from_d65: f64,
    /// "CR": contrast ratio, Y over Y of black.
    pub contrast: f64,
    /// "up, vp": u', v'.
    pub uv: [f64; 2],
    /// "x, y, z": chromaticity.
    pub chromaticity: [f64; 3],
    /// "Lst, ast, bst": CIELAB.
    pub lab: [f64; 3],
    /// "R, G, B".
    pub rgb: [f64; 3],
    /// "Ynits": luminance in its normalisation, 683.002 Y.
    pub nits: f64,
}

/// "Gamut": u'v' area of the three primaries, in percent.
pub const GAMUT_PERCENT: f64 = 33.4;

/// The columns: white, black, red, green and blue.
pub const TABLE_5_1: [Column; 5] = [
    Column {
        name: "white",
        xyz: Xyz { x: 0.225, y: 0.242, z: 0.223 },
        distance_from_d65: 0.0133,
        contrast: 24.0,
        uv: [0.199, 0.481],
        chromaticity: [0.326, 0.351, 0.324],
        lab: [56.3, -2.36, 6.67],
        rgb: [91.0, 91.0, 74.0],
        nits: 165.0,
    },
    Column {
        name: "black",
        xyz: Xyz { x: 0.0150, y: 0.0101, z: 0.0283 },
        distance_from_d65: 0.114,
        contrast: 1.0,
        uv: [0.239, 0.361],
        chromaticity: [0.281, 0.189, 0.530],
        lab: [9.07, 17.5, -16.0],
        rgb: [91.0, 26.0, 137.0],
        nits: 6.90,
    },
    Column {
        name: "red",
        xyz: Xyz { x: 0.0701, y: 0.0430, z: 0.0276 },
        distance_from_d65: 0.154,
        contrast: 4.26,
        uv: [0.351, 0.485],
        chromaticity: [0.498, 0.306, 0.196],
        lab: [24.6, 34.5, 11.3],
        rgb: [255.0, 25.0, 44.0],
        nits: 29.4,
    },
    Column {
        name: "green",
        xyz: Xyz { x: 0.151, y: 0.198, z: 0.130 },
        distance_from_d65: 0.0475,
        contrast: 19.6,
        uv: [0.172, 0.508],
        chromaticity: [0.316, 0.414, 0.271],
        lab: [51.6, -20.6, 18.2],
        rgb: [64.0, 123.0, 56.0],
        nits: 135.0,
    },
    Column {
        name: "blue",
        xyz: Xyz { x: 0.0335, y: 0.0208, z: 0.123 },
        distance_from_d65: 0.206,
        contrast: 2.06,
        uv: [0.188, 0.262],
        chromaticity: [0.189, 0.118, 0.693],
        lab: [15.9, 26.4, -41.6],
        rgb: [22.0, 17.0, 183.0],
        nits: 14.2,
    },
];

/// Returns half a unit of the last printed digit, the largest rounding error.
pub fn half_digit(printed: f64) -> f64 {
    0.5 * 10.0_f64.powf(printed.abs().log10().floor() - 2.0)
}

//! sRGB and Display P3 colours for figures on a screen.
//!
//! **What.** The linear sRGB matrix and the sRGB transfer function (IEC 61966-2-1 with its amendment 1),
//! limited to what a screen [displays](displayed). If the scene's light is not D65, the colour of a surface is first [adapted to
//! D65](Xyz::adapted_to_d65), so that paper is shown as white. Display P3 has the primaries of SMPTE RP
//! 431-2, and the white and transfer function of sRGB.

use std::sync::LazyLock;

use crate::matrix::{Matrix, inverse, times};
use crate::{D65_WHITE, Xyz};

/// Matrix from relative X, Y, Z to linear sRGB.
const SRGB: Matrix = [
    [3.240_625_5, -1.537_208_0, -0.498_628_6],
    [-0.968_930_7, 1.875_756_1, 0.041_517_5],
    [0.055_710_1, -0.204_021_1, 1.056_995_9],
];

/// Chromaticities x, y of the primaries of Display P3.
const P3_PRIMARIES: [[f64; 2]; 3] = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];

/// Matrix from relative X, Y, Z to linear Display P3.
const DISPLAY_P3: Matrix = from_xyz(P3_PRIMARIES);

/// Matrix from relative X, Y, Z to light of these primaries, whose sum is the white D65.
const fn from_xyz(primaries: [[f64; 2]; 3]) -> Matrix {
    let mut columns = [[0.0; 3]; 3];
    let mut k = 0;
    while k < 3 {
        let [x, y] = primaries[k];
        (columns[0][k], columns[1][k], columns[2][k]) = (x / y, 1.0, (1.0 - x - y) / y);
        k += 1;
    }
    let mut rows = inverse(&columns);
    let white = times(&rows, [D65_WHITE.x, D65_WHITE.y, D65_WHITE.z]);
    let mut k = 0;
    while k < 3 {
        rows[k] = [rows[k][0] / white[k], rows[k][1] / white[k], rows[k][2] / white[k]];
        k += 1;
    }
    rows
}

/// Colour space of a screen; the transfer function is that of sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScreenSpace {
    /// IEC 61966-2-1.
    #[default]
    Srgb,
    /// Display P3.
    DisplayP3,
}

impl ScreenSpace {
    /// Converts relative values under D65 to linear red, green and blue; components outside 0 to 1 are out of
    /// gamut.
    #[inline]
    pub fn linear(self, colour: Xyz) -> [f64; 3] {
        match self {
            Self::Srgb => colour.linear_srgb(),
            Self::DisplayP3 => times(&DISPLAY_P3, colour.to_array()),
        }
    }

    /// Converts relative values under D65 to the encoded bytes of what the screen [displays](displayed).
    pub fn bytes(self, colour: Xyz) -> [u8; 3] {
        displayed(self.linear(colour)).map(encoded_byte)
    }
}

/// What a screen shows of linear components: a colour that is too bright is the brightest one of its chromaticity, and then negative
/// components, which are out of gamut, are 0.
#[inline]
pub fn displayed(linear: [f64; 3]) -> [f64; 3] {
    let brightest = linear.into_iter().fold(1.0, f64::max);
    // `max` replaces NaN by 0.
    linear.map(|value| (value / brightest).max(0.0))
}

/// Encodes a linear component by the sRGB transfer function as the nearest byte, clipped to 0 to 1.
#[inline]
pub fn encoded_byte(linear: f64) -> u8 {
    BYTES.of(linear)
}

/// The linear component of an encoded byte, by the sRGB transfer function (IEC 61966-2-1).
pub fn decoded_byte(byte: u8) -> f64 {
    let encoded = f64::from(byte) / 255.0;
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// Bytes of linear components, without the power function.
static BYTES: LazyLock<Bytes> = LazyLock::new(Bytes::new);

/// A table of encoded bytes.
struct Bytes {
    /// The smallest component that has at least each byte; the last is NaN, which no component reaches.
    from: [f64; 257],
    /// Byte of the least component of each of [`CELLS`](Self::CELLS) cells of 0 to 1, and of 1.
    of_cell: Vec<u8>,
}

impl Bytes {
    /// Cells are shorter than a byte.
    const CELLS: usize = 4096;

    fn new() -> Self {
        let mut from = [f64::NEG_INFINITY; 257];
        from[256] = f64::NAN;
        for byte in 1..=255 {
            let (mut below, mut least) = (0.0, 1.0);
            // Until both are neighbours.
            loop {
                let middle = 0.5 * (below + least);
                if middle <= below || middle >= least {
                    break;
                }
                *(if computed_byte(middle) < byte { &mut below } else { &mut least }) = middle;
            }
            from[usize::from(byte)] = least;
        }
        let of_cell = (0..=Self::CELLS).map(|cell| computed_byte(cell as f64 / Self::CELLS as f64)).collect();
        Self { from, of_cell }
    }

    #[inline]
    fn of(&self, linear: f64) -> u8 {
        // Conversion to whole numbers makes 0 of negative ones and of NaN.
        let cell = ((linear * Self::CELLS as f64) as usize).min(Self::CELLS);
        let byte = self.of_cell[cell];
        byte + u8::from(linear >= self.from[usize::from(byte) + 1])
    }
}

/// Encodes a linear component as the nearest byte by its definition.
fn computed_byte(linear: f64) -> u8 {
    (255.0 * encoded_in_range(linear)).round() as u8
}

impl Xyz {
    /// Converts relative values under D65 to linear sRGB; components outside 0 to 1 are out of gamut.
    #[inline]
    pub fn linear_srgb(self) -> [f64; 3] {
        times(&SRGB, self.to_array())
    }

    /// Converts relative values under D65 to gamma-encoded sRGB, 0 to 1, of what a screen [displays](displayed).
    pub fn srgb_encoded(self) -> [f64; 3] {
        displayed(self.linear_srgb()).map(encoded_in_range)
    }

    /// Converts relative values under D65 to gamma-encoded sRGB bytes of what a screen [displays](displayed).
    pub fn srgb_clipped(self) -> [u8; 3] {
        ScreenSpace::Srgb.bytes(self)
    }

    /// Computes the "RGB" rows of Feng 2012, table 5.1: 255 times the linear sRGB matrix
    /// applied to the chromaticity (x, y, z), clipped, without gamma. `None` without light.
    ///
    /// The values show hue without lightness; they are not meant for display.
    pub fn hue_rgb(self) -> Option<[f64; 3]> {
        let sum = self.x + self.y + self.z;
        (sum > 0.0).then(|| (self * (1.0 / sum)).linear_srgb().map(|v| (255.0 * v).clamp(0.0, 255.0)))
    }
}

/// Encodes a linear component by the sRGB transfer function.
fn encoded(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Encodes a linear component, clipped to 0 to 1.
// `max` replaces NaN by 0, which `clamp` does not.
#[allow(clippy::manual_clamp, reason = "NaN")]
fn encoded_in_range(linear: f64) -> f64 {
    encoded(linear).max(0.0).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_black_grey_and_red_have_their_known_bytes() {
        assert_eq!(D65_WHITE.srgb_clipped(), [255; 3]);
        assert_eq!((D65_WHITE * 0.0).srgb_clipped(), [0; 3]);
        // Middle grey: 18.4 % of white is L* = 50, sRGB 119.
        assert_eq!((D65_WHITE * 0.184_187).srgb_clipped(), [119; 3]);
        // Red primary: Y = 0.2126 at x = 0.64, y = 0.33.
        assert_eq!(Xyz { x: 0.4124, y: 0.2126, z: 0.0193 }.srgb_clipped(), [255, 0, 0]);
    }

    #[test]
    fn bytes_of_the_table_are_those_of_the_definition() {
        let table = Bytes::new();
        let edges = table.from.iter().flat_map(|edge| [edge.next_down(), *edge, edge.next_up()]);
        let cells = (0..=4 * Bytes::CELLS).map(|k| k as f64 / (4 * Bytes::CELLS) as f64);
        let others = [f64::INFINITY, -1.0, -0.0, 1e-300, 0.5, 1.0 + 1e-12, 7.0, f64::NAN];
        for linear in edges.chain(cells).chain(others) {
            assert_eq!(encoded_byte(linear), computed_byte(linear), "{linear}");
        }
        // A component crosses at most one edge within a cell.
        assert!(table.of_cell.windows(2).all(|pair| pair[1] - pair[0] <= 1));
    }

    /// The matrix of W3C's CSS Color 4, whose white has four digits: x = 0.3127, y = 0.3290. Its Z is larger
    /// than ours by 2.1e-4, and rows of the matrix have as large a part of their elements, of up to 2.5.
    #[test]
    fn display_p3_has_its_published_matrix() {
        let css = [
            [2.493_496_9, -0.931_383_6, -0.402_710_8],
            [-0.829_489_0, 1.762_664_1, 0.023_624_7],
            [0.035_845_8, -0.076_172_4, 0.956_884_5],
        ];
        for (ours, published) in DISPLAY_P3.as_flattened().iter().zip(css.as_flattened()) {
            assert!((ours - published).abs() < 5e-4, "{ours} {published}");
        }
        let white = ScreenSpace::DisplayP3.linear(D65_WHITE);
        assert!(white.iter().all(|value| (value - 1.0).abs() < 1e-12), "{white:?}");
        // The red of sRGB is inside: color(display-p3 0.9175 0.2003 0.1386).
        assert_eq!(ScreenSpace::DisplayP3.bytes(Xyz { x: 0.4124, y: 0.2126, z: 0.0193 }), [234, 51, 35]);
    }

    /// A colour of luminance 1 or more has the chromaticity that it has at a tenth of its light.
    #[test]
    fn colours_that_are_too_bright_keep_their_chromaticity() {
        let orange = Xyz { x: 1.4, y: 1.1, z: 0.3 };
        let (bright, dim) = (orange.srgb_encoded(), (orange * 0.1).linear_srgb());
        let most = dim.into_iter().fold(0.0, f64::max);
        assert!((bright[0] - 1.0).abs() < 1e-12, "{bright:?}");
        for (bright, dim) in bright.into_iter().zip(dim) {
            assert!((bright - encoded_in_range(dim / most)).abs() < 1e-12, "{bright} {dim}");
        }
        assert_eq!(orange.srgb_clipped(), bright.map(|value| (255.0 * value).round() as u8));
    }

    #[test]
    fn out_of_gamut_colours_are_clipped() {
        assert_eq!(Xyz { x: -0.1, y: 2.0, z: f64::NAN }.srgb_clipped()[2], 0);
        assert_eq!(Xyz { x: -1e-9, y: -1e-9, z: -1e-9 }.srgb_clipped(), [0; 3]);
    }
}

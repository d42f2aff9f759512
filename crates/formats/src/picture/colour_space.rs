//! Colour spaces of red, green and blue: primaries, white and transfer function.

use super::transfer::Transfer;

/// Chromaticity of D65 in the standards of these colour spaces.
const D65: [f64; 2] = [0.3127, 0.3290];

/// A colour space of red, green and blue.
#[derive(Debug, Clone, PartialEq)]
pub struct RgbSpace {
    /// Name for messages.
    pub name: String,
    /// Chromaticities x, y of red, green and blue.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity x, y of white.
    pub white: [f64; 2],
    /// Transfer function of all three.
    pub transfer: Transfer,
}

impl RgbSpace {
    fn new(name: &str, primaries: [[f64; 2]; 3], transfer: Transfer) -> Self {
        Self { name: name.to_owned(), primaries, white: D65, transfer }
    }

    /// sRGB (IEC 61966-2-1).
    pub fn srgb() -> Self {
        Self::new("sRGB", BT_709, Transfer::Srgb)
    }

    /// Display P3: the primaries of SMPTE RP 431-2, white and transfer function of sRGB.
    pub fn display_p3() -> Self {
        Self::new("Display P3", P3, Transfer::Srgb)
    }

    /// Rec. 2020 as displays show it: ITU-R BT.2020 primaries, and BT.1886 with a perfect black (gamma 2.4).
    pub fn rec_2020() -> Self {
        Self::new("Rec. 2020", BT_2020, Transfer::Gamma(2.4))
    }

    /// The colour space of this name in scenario files: `srgb`, `display-p3`, `rec-2020`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "srgb" => Some(Self::srgb()),
            "display-p3" => Some(Self::display_p3()),
            "rec-2020" => Some(Self::rec_2020()),
            _ => None,
        }
    }

    /// Primaries and transfer function of ITU-T H.273 (`cICP`); `None` for those without a white, or unknown
    /// ones.
    pub(super) fn from_code_points(primaries: u8, transfer: u8) -> Option<Self> {
        let (name, primaries) = match primaries {
            1 => ("BT.709", BT_709),
            9 => ("BT.2020", BT_2020),
            12 => ("P3", P3),
            _ => return None,
        };
        let transfer = match transfer {
            1 | 6 | 14 | 15 => Transfer::Gamma(2.4),
            4 => Transfer::Gamma(2.2),
            5 => Transfer::Gamma(2.8),
            8 => Transfer::Linear,
            13 => Transfer::Srgb,
            _ => return None,
        };
        Some(Self::new(name, primaries, transfer))
    }

    /// Matrix from linear red, green and blue to X, Y, Z under D65, Y of white = 1. Another white is adapted
    /// to D65 with Bradford's matrix. `None` if the primaries are on a line, or white is not a colour.
    pub fn xyz_from_rgb(&self) -> Option<[[f64; 3]; 3]> {
        let columns = self.primaries.map(xyz_of);
        let unscaled = transposed(columns);
        let white = xyz_of(self.white);
        let scales = times(inverse(unscaled)?, white);
        let matrix = unscaled.map(|row| std::array::from_fn(|k| row[k] * scales[k]));
        let adapted = if self.white == D65 { matrix } else { product(adaptation(white, d65())?, matrix) };
        adapted.iter().flatten().all(|value| value.is_finite()).then_some(adapted)
    }
}

const BT_709: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];
const P3: [[f64; 2]; 3] = [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]];
const BT_2020: [[f64; 2]; 3] = [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]];

/// Bradford's matrix.
const BRADFORD: [[f64; 3]; 3] =
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];

/// X, Y, Z of a chromaticity with Y = 1.
fn xyz_of([x, y]: [f64; 2]) -> [f64; 3] {
    [x / y, 1.0, (1.0 - x - y) / y]
}

/// X, Y, Z of white, Y = 1.
pub(super) fn d65() -> [f64; 3] {
    xyz_of(D65)
}

/// Matrix that adapts X, Y, Z from one white to another.
pub(super) fn adaptation(from: [f64; 3], to: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let (from, to) = (times(BRADFORD, from), times(BRADFORD, to));
    let scaled = std::array::from_fn(|k| BRADFORD[k].map(|value| value * to[k] / from[k]));
    Some(product(inverse(BRADFORD)?, scaled))
}

pub(super) fn transposed(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|row| std::array::from_fn(|column| m[column][row]))
}

fn times(m: [[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
}

pub(super) fn product(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    a.map(|row| std::array::from_fn(|column| (0..3).map(|k| row[k] * b[k][column]).sum()))
}

fn inverse(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let cofactor = |row: usize, column: usize| {
        let [r, s] = [(row + 1) % 3, (row + 2) % 3];
        let [c, d] = [(column + 1) % 3, (column + 2) % 3];
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    let determinant: f64 = (0..3).map(|k| m[0][k] * cofactor(0, k)).sum();
    let inverse =
        std::array::from_fn(|row| std::array::from_fn(|column| cofactor(column, row) / determinant));
    (determinant.is_finite() && determinant.abs() > 1e-9).then_some(inverse)
}

//! Colour spaces of source pictures.
//!
//! **What.** Linear RGB with 0 for black and 1 for white, whose white is D65.
//!
//! **Source.** Chromaticities of the primaries: IEC 61966-2-1 (sRGB), SMPTE EG 432-1 (P3), ITU-R BT.2020-2.
//! The matrices are computed from them, so that (1, 1, 1) is [`D65_WHITE`] exactly.

use crate::matrix::{Matrix, inverse, times};
use crate::{D65_WHITE, Xy, Xyz};

/// Colour space of a source picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SourceSpace {
    /// sRGB.
    #[default]
    Srgb,
    /// Display P3: the primaries of DCI-P3 with the white D65.
    DisplayP3,
    /// ITU-R BT.2020.
    Rec2020,
}

impl SourceSpace {
    /// Chromaticities x, y of red, green and blue.
    pub fn primaries(self) -> [Xy; 3] {
        let xy = match self {
            Self::Srgb => [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]],
            Self::DisplayP3 => [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]],
            Self::Rec2020 => [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
        };
        xy.map(|[x, y]| Xy { x, y })
    }

    /// Matrix from linear RGB to X, Y, Z relative to D65.
    pub(super) fn matrix(self) -> Matrix {
        let [r, g, b] = self.primaries().map(|Xy { x, y }| [x / y, 1.0, (1.0 - x - y) / y]);
        let unscaled = [0, 1, 2].map(|k| [r[k], g[k], b[k]]);
        let scale = times(&inverse(&unscaled), D65_WHITE.to_array());
        unscaled.map(|row| [0, 1, 2].map(|k| row[k] * scale[k]))
    }

    /// Converts linear RGB to X, Y, Z relative to D65, with Y = 1 for white.
    pub fn xyz(self, linear_rgb: [f64; 3]) -> Xyz {
        let [x, y, z] = times(&self.matrix(), linear_rgb);
        Xyz { x, y, z }
    }
}

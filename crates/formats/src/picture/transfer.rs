//! Transfer functions: from the numbers of a file to linear light.

use super::icc::{fixed, number};

/// Transfer function of a colour channel: linear light, 0 to 1, of an encoded number, 0 to 1.
#[derive(Debug, Clone, PartialEq)]
pub enum Transfer {
    /// Light is proportional to the number.
    Linear,
    /// IEC 61966-2-1 (sRGB, Display P3).
    Srgb,
    /// A power of the number.
    Gamma(f64),
    /// Light at equal steps of the number, in units of 1/65535; linear between them.
    Table(Vec<u16>),
    /// ICC's parametric curves, all as type 4 with the parameters g a b c d e f: `(a x + b)^g + e` from x =
    /// d, `c x + f` below.
    Parametric([f64; 7]),
}

impl Transfer {
    /// Linear light of an encoded number; both are limited to 0 to 1.
    pub fn decode(&self, number: f64) -> f64 {
        let x = number.clamp(0.0, 1.0);
        let light = match self {
            Self::Linear => x,
            Self::Srgb if x <= 0.04045 => x / 12.92,
            Self::Srgb => ((x + 0.055) / 1.055).powf(2.4),
            Self::Gamma(gamma) => x.powf(*gamma),
            Self::Table(steps) => {
                let at = x * (steps.len().max(1) - 1) as f64;
                let below = at as usize;
                let value =
                    |k: usize| steps.get(k).or(steps.last()).map_or(x, |step| f64::from(*step) / 65535.0);
                value(below) + (at - at.floor()) * (value(below + 1) - value(below))
            }
            Self::Parametric([g, a, b, c, d, e, f]) => {
                if x >= *d {
                    (a * x + b).max(0.0).powf(*g) + e
                } else {
                    c * x + f
                }
            }
        };
        if light.is_nan() { 0.0 } else { light.clamp(0.0, 1.0) }
    }

    /// A curve of an ICC profile (`curveType`, `parametricCurveType`), and the number of its bytes.
    pub(super) fn of_icc(tag: &[u8]) -> Option<(Self, usize)> {
        match tag.get(..4)? {
            b"curv" => {
                let count = number(tag.get(8..12)?)? as usize;
                let bytes = tag.get(12..)?.get(..count.checked_mul(2)?)?;
                let steps: Vec<u16> =
                    bytes.as_chunks().0.iter().map(|two| u16::from_be_bytes(*two)).collect();
                let curve = match steps[..] {
                    [] => Self::Linear,
                    [gamma] => Self::Gamma(f64::from(gamma) / 256.0),
                    _ => Self::Table(steps),
                };
                Some((curve, 12 + bytes.len()))
            }
            b"para" => {
                let value = |k: usize| fixed(tag.get(12 + 4 * k..16 + 4 * k)?);
                let values = |count: usize| (0..count).map(value).collect::<Option<Vec<f64>>>();
                let count = match tag.get(8..10)? {
                    [0, 0] => 1,
                    [0, kind @ 1..=3] => usize::from(*kind) + 2,
                    [0, 4] => 7,
                    _ => return None,
                };
                let curve = match values(count)?[..] {
                    [g] => Self::Gamma(g),
                    [g, a, b] => Self::Parametric([g, a, b, 0.0, -b / a, 0.0, 0.0]),
                    [g, a, b, c] => Self::Parametric([g, a, b, 0.0, -b / a, c, c]),
                    [g, a, b, c, d] => Self::Parametric([g, a, b, c, d, 0.0, 0.0]),
                    [g, a, b, c, d, e, f] => Self::Parametric([g, a, b, c, d, e, f]),
                    _ => return None,
                };
                Some((curve, 12 + 4 * count))
            }
            _ => None,
        }
    }

    /// Linear light of all whole numbers up to `largest`.
    pub(super) fn table(&self, largest: u16) -> Vec<f32> {
        (0..=largest).map(|k| self.decode(f64::from(k) / f64::from(largest)) as f32).collect()
    }
}

//! Transfer functions: from the numbers of a file to linear light.

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
    /// ICC's parametric curves, all as type 4 with the parameters g a b c d e f: `(a x + b)^g + e` from x = d, `c x + f` below.
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

    /// Linear light of all whole numbers up to `largest`.
    pub(super) fn table(&self, largest: u16) -> Vec<f32> {
        (0..=largest).map(|k| self.decode(f64::from(k) / f64::from(largest)) as f32).collect()
    }
}

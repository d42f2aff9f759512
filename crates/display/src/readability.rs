//! Daylight readability of black text on white.
//!
//! **What.** The mean luminance of text, `.75 K_w + .25 K_k`, its contrast,
//! `(K_w - K_k)/(K_w + K_k/3)` (Feng 2012, eq. 5-13 and 5-14, after Kelley, Lindfors, Penczek,
//! J. SID 14 (2006)), and how well it is read.
//!
//! **The surrogate.** Feng 2012, table 5.3, has relative visual performance read by eye off charts
//! of CIE 145:2002 for details of 1.5 minutes of arc (small print at 400 mm). The charts' formula
//! is not at hand; `P = p0 + p1 ln(C/.35) + p2 ln(L/1000 cd/m2)`, cut to 0 ... 1 and calibrated
//! on that table, gives its numbers back. It is *a surrogate, not the CIE's model*: twelve numbers
//! off a chart, for three ages. Age 20 has but one number below 1, and age 50's slopes.
//!
//! **Range.** L from 1000 to 5200 cd/m2, C from .35 to .9: beyond there is no number.

/// Luminance of text that the surrogate is calibrated for, cd/m2.
pub const LUMINANCE_RANGE_CD_M2: [f64; 2] = [1000.0, 5200.0];

/// Contrast of text that the surrogate is calibrated for.
pub const CONTRAST_RANGE: [f64; 2] = [0.35, 0.9];

/// How old the reader is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reader {
    /// 20 years.
    Age20,
    /// 50 years.
    Age50,
    /// 75 years.
    Age75,
}

impl Reader {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Age20, Self::Age50, Self::Age75];

    /// Years.
    pub fn age(self) -> u32 {
        match self {
            Self::Age20 => 20,
            Self::Age50 => 50,
            Self::Age75 => 75,
        }
    }

    /// p0, p1 and p2 of the surrogate.
    fn coefficients(self) -> [f64; 3] {
        match self {
            Self::Age20 => [0.8121, 0.1845, 0.0481],
            Self::Age50 => [0.6619, 0.1845, 0.0481],
            Self::Age75 => [0.2971, 0.3141, 0.0074],
        }
    }
}

/// Black text on white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Text {
    /// Mean luminance, cd/m2.
    pub luminance_cd_m2: f64,
    /// Contrast, 0 to 1.
    pub contrast: f64,
}

impl Text {
    /// From the luminances of white and black, cd/m2; `None` without light.
    pub fn new(white_cd_m2: f64, black_cd_m2: f64) -> Option<Self> {
        let below = white_cd_m2 + black_cd_m2 / 3.0;
        (below > 0.0).then(|| Self {
            luminance_cd_m2: 0.75 * white_cd_m2 + 0.25 * black_cd_m2,
            contrast: (white_cd_m2 - black_cd_m2) / below,
        })
    }

    /// Reading performance by the calibrated surrogate, 0 to 1; `None` beyond its range.
    pub fn reading_surrogate(self, reader: Reader) -> Option<f64> {
        let [dimmest, brightest] = LUMINANCE_RANGE_CD_M2;
        let [faintest, strongest] = CONTRAST_RANGE;
        let known = (dimmest..=brightest).contains(&self.luminance_cd_m2)
            && (faintest..=strongest).contains(&self.contrast);
        let [p0, p1, p2] = reader.coefficients();
        let (contrast, luminance) = (self.contrast / 0.35, self.luminance_cd_m2 / 1000.0);
        known.then(|| (p0 + p1 * contrast.ln() + p2 * luminance.ln()).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beyond_its_range_there_is_no_number() {
        let text = |luminance_cd_m2, contrast| Text { luminance_cd_m2, contrast };
        assert!(text(1000.0, 0.35).reading_surrogate(Reader::Age20).is_some());
        for outside in [text(999.0, 0.8), text(5201.0, 0.8), text(2000.0, 0.3), text(2000.0, 0.91)] {
            assert!(Reader::ALL.iter().all(|reader| outside.reading_surrogate(*reader).is_none()));
        }
        assert_eq!(Text::new(0.0, 0.0), None);
    }

    /// More light and more contrast never make reading harder, and years never make it easier.
    #[test]
    fn it_rises_with_light_and_contrast_and_falls_with_age() {
        let at = |l: f64, c: f64, reader| {
            Text { luminance_cd_m2: l, contrast: c }.reading_surrogate(reader).unwrap()
        };
        for (l, c) in [(1000.0, 0.35), (2500.0, 0.6), (5000.0, 0.85)] {
            for reader in Reader::ALL {
                assert!(at(l + 100.0, c, reader) >= at(l, c, reader));
                assert!(at(l, c + 0.04, reader) >= at(l, c, reader));
            }
            assert!(at(l, c, Reader::Age20) >= at(l, c, Reader::Age50));
            assert!(at(l, c, Reader::Age50) >= at(l, c, Reader::Age75));
        }
    }
}

//! Daylight readability of black text on white.
//!
//! **What.** The mean luminance of text, `0.75 K_w + 0.25 K_k`, its contrast,
//! `(K_w - K_k)/(K_w + K_k/3)` (Feng 2012, eq. 5-13 and 5-14, after Kelley, Lindfors, Penczek,
//! J. SID 14 (2006)), and the reading performance.
//!
//! **Surrogate.** Feng 2012, table 5.3, contains relative visual performance read from charts
//! of CIE 145:2002 for details of 1.5 minutes of arc (small print at 400 mm). The formula of the charts
//! is not available. The expression `P = p0 + p1 ln(C/0.35) + p2 ln(L/1000 cd/m2)`, limited to 0 ... 1 and calibrated
//! on that table, reproduces its values. It is *a surrogate, not the model of the CIE*: twelve values
//! from a chart, for readers of 20, 50 and 75 years. For age 20 only one value is below 1; its slopes are
//! those of age 50. Between these ages p0, p1 and p2 are interpolated linearly, which is not based on charts.
//!
//! **Range.** L from 1000 to 5200 cd/m2, C from 0.35 to 0.9, 20 to 75 years; not defined outside.

/// Range of the luminance of text for which the surrogate is calibrated, cd/m2.
pub const LUMINANCE_RANGE_CD_M2: [f64; 2] = [1000.0, 5200.0];

/// Range of the contrast of text for which the surrogate is calibrated.
pub const CONTRAST_RANGE: [f64; 2] = [0.35, 0.9];

/// Ages of readers for which the surrogate is calibrated, years.
pub const AGES_YEARS: [f64; 3] = [20.0, 50.0, 75.0];

/// Coefficients p0, p1 and p2 at each age.
const COEFFICIENTS: [[f64; 3]; 3] =
    [[0.8121, 0.1845, 0.0481], [0.6619, 0.1845, 0.0481], [0.2971, 0.3141, 0.0074]];

/// Returns p0, p1 and p2 of a reader; `None` outside the range of ages.
fn coefficients(age_years: f64) -> Option<[f64; 3]> {
    let before = AGES_YEARS.windows(2).position(|ages| (ages[0]..=ages[1]).contains(&age_years))?;
    let fraction = (age_years - AGES_YEARS[before]) / (AGES_YEARS[before + 1] - AGES_YEARS[before]);
    let (younger, older) = (COEFFICIENTS[before], COEFFICIENTS[before + 1]);
    Some(std::array::from_fn(|k| (1.0 - fraction) * younger[k] + fraction * older[k]))
}

/// Photometric quantities of black text on white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Text {
    /// Mean luminance, cd/m2.
    pub luminance_cd_m2: f64,
    /// Contrast, 0 to 1.
    pub contrast: f64,
}

impl Text {
    /// Computes the quantities from the luminances of white and black, cd/m2; `None` without light.
    pub fn new(white_cd_m2: f64, black_cd_m2: f64) -> Option<Self> {
        let below = white_cd_m2 + black_cd_m2 / 3.0;
        (below > 0.0).then(|| Self {
            luminance_cd_m2: 0.75 * white_cd_m2 + 0.25 * black_cd_m2,
            contrast: (white_cd_m2 - black_cd_m2) / below,
        })
    }

    /// Computes the reading performance by the calibrated surrogate, 0 to 1; `None` outside its range.
    pub fn reading_surrogate(self, age_years: f64) -> Option<f64> {
        let [dimmest, brightest] = LUMINANCE_RANGE_CD_M2;
        let [faintest, strongest] = CONTRAST_RANGE;
        let in_range = (dimmest..=brightest).contains(&self.luminance_cd_m2)
            && (faintest..=strongest).contains(&self.contrast);
        let [p0, p1, p2] = coefficients(age_years)?;
        let (contrast, luminance) = (self.contrast / 0.35, self.luminance_cd_m2 / 1000.0);
        in_range.then(|| (p0 + p1 * contrast.ln() + p2 * luminance.ln()).clamp(0.0, 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(luminance_cd_m2: f64, contrast: f64) -> Text {
        Text { luminance_cd_m2, contrast }
    }

    #[test]
    fn reading_performance_outside_the_range_is_undefined() {
        for age in AGES_YEARS {
            assert!(text(1000.0, 0.35).reading_surrogate(age).is_some());
            for outside in [text(999.0, 0.8), text(5201.0, 0.8), text(2000.0, 0.3), text(2000.0, 0.91)] {
                assert_eq!(outside.reading_surrogate(age), None);
            }
        }
        for age in [19.9, 75.1, -50.0, f64::NAN] {
            assert_eq!(text(2000.0, 0.8).reading_surrogate(age), None);
        }
        assert_eq!(Text::new(0.0, 0.0), None);
    }

    #[test]
    fn reading_performance_increases_with_light_and_contrast_and_decreases_with_age() {
        let at = |l: f64, c: f64, age: f64| text(l, c).reading_surrogate(age).unwrap();
        for (l, c) in [(1000.0, 0.35), (2500.0, 0.6), (5000.0, 0.85)] {
            for age in (20..=75).map(f64::from) {
                assert!(at(l + 100.0, c, age) >= at(l, c, age));
                assert!(at(l, c + 0.04, age) >= at(l, c, age));
                assert!(at(l, c, (age + 1.0).min(75.0)) <= at(l, c, age));
            }
        }
    }

    /// The interpolation is linear if the performance is not limited at either age.
    #[test]
    fn reading_performance_between_two_ages_is_interpolated() {
        let at = |age: f64| text(1500.0, 0.5).reading_surrogate(age).unwrap();
        assert!((at(35.0) - 0.5 * (at(20.0) + at(50.0))).abs() < 1e-12);
        assert!((at(55.0) - (0.8 * at(50.0) + 0.2 * at(75.0))).abs() < 1e-12);
    }
}

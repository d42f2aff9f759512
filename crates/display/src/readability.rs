//! Readability of black text on white.
//!
//! **What.** The mean luminance of text, `0.75 K_w + 0.25 K_k` (Feng 2012, eq. 5-13, after Kelley, Lindfors,
//! Penczek, J. SID 14 (2006)), and three numbers for a [`Reader`]:
//!
//! - the *visibility level*, `|K_w - K_k|` over the luminance difference at which a detail of the text is
//!   just visible ([`papilio_colour::reader::VisibilityTask`], Adrian 1989): the detail is a fifth of the
//!   height of the lower-case x, seen for 0.2 s, the background has the mean luminance of text;
//! - the *contrast margin*, `(K_w - K_k)/(K_w + K_k)` over the contrast at which a grating of 2.5 cycles per
//!   height of the x is just visible ([`papilio_colour::reader::contrast_sensitivity`], Barten 1999, in a
//!   field of 10 deg), with the same age factor;
//! - the *reading performance*, a surrogate for Feng 2012, table 5.3, with the contrast
//!   `(K_w - K_k)/(K_w + K_k/3)` (eq. 5-14).
//!
//! The first two are 1 for text that is just visible.
//!
//! **Surrogate.** Feng 2012, table 5.3, contains relative visual performance read from charts
//! of CIE 145:2002 for details of 1.5 minutes of arc (small print at 400 mm). The formula of the charts
//! is not available. The expression `P = p0 + p1 ln(C/0.35) + p2 ln(L/1000 cd/m2)`, limited to 0 ... 1 and
//! calibrated on that table, reproduces its values. It is *a surrogate, not the model of the CIE*: twelve
//! values from a chart, for readers of 20, 50 and 75 years. For age 20 only one value is below 1; its slopes
//! are those of age 50. Between these ages p0, p1 and p2 are interpolated linearly, which is not based on
//! charts. Its range: L from 1000 to 5200 cd/m2, C from 0.35 to 0.9, 20 to 75 years; not defined outside.
//!
//! **Range** of visibility level and contrast margin: 0.1 to 1e4 cd/m2, 23 to 75 years; outside, they are
//! reported with `in_range = false`.

use papilio_colour::reader::{
    Polarity, VisibilityTask, age_factor, contrast_sensitivity, is_age_in_range, is_luminance_in_range,
};

use crate::scene::Scene;

/// Age of a reader that is not specified, years.
pub const DEFAULT_AGE_YEARS: f64 = 25.0;

/// Height of the lower-case x of text that is not specified, mm: that of printed text of 10 points.
pub const DEFAULT_TEXT_HEIGHT_MM: f64 = 1.6;

/// Height of the lower-case x over the size of its details: three strokes and two gaps.
const DETAILS_PER_HEIGHT: f64 = 5.0;

/// Time in which a detail must be seen, s: a fixation of the eye.
const FIXATION_S: f64 = 0.2;

/// Field of the contrast sensitivity, degrees.
const FIELD_DEG: f64 = 10.0;

/// Reader, and the size of the text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reader {
    /// Age, years.
    pub age_years: f64,
    /// Height of the lower-case x, mm.
    pub text_height_mm: f64,
    /// Distance of the eye from the text, mm.
    pub distance_mm: f64,
}

impl Reader {
    /// Returns the reader of a scene, with defaults for what is not specified.
    pub fn of(scene: &Scene) -> Self {
        Self {
            age_years: scene.metrics.reader_age_years.unwrap_or(DEFAULT_AGE_YEARS),
            text_height_mm: scene.metrics.text_height_mm.unwrap_or(DEFAULT_TEXT_HEIGHT_MM),
            distance_mm: scene.viewer.distance_mm,
        }
    }

    /// Computes the size of a detail of the text, minutes of arc.
    pub fn detail_arcmin(&self) -> f64 {
        60.0 * (self.text_height_mm / DETAILS_PER_HEIGHT / self.distance_mm).atan().to_degrees()
    }

    /// Computes the spatial frequency of the strokes of the text, cycles per degree: a stroke and a gap are a
    /// cycle.
    pub fn cycles_per_degree(&self) -> f64 {
        0.5 * DETAILS_PER_HEIGHT / self.text_height_mm * self.distance_mm * 1_f64.to_radians().tan()
    }

    /// Computes the visibility level of black text on white from the two luminances, cd/m2; `None` without
    /// light.
    pub fn visibility_level(&self, white_cd_m2: f64, black_cd_m2: f64) -> Option<f64> {
        let task = self.task(if white_cd_m2 >= black_cd_m2 { Polarity::Darker } else { Polarity::Brighter });
        let threshold = task.threshold_cd_m2(mean_luminance(white_cd_m2, black_cd_m2))?;
        Some((white_cd_m2 - black_cd_m2).abs() / threshold)
    }

    /// Computes the contrast margin of black text on white from the two luminances, cd/m2; `None` without
    /// light. It is negative if black is brighter than white.
    pub fn contrast_margin(&self, white_cd_m2: f64, black_cd_m2: f64) -> Option<f64> {
        let (difference, sum) = (white_cd_m2 - black_cd_m2, white_cd_m2 + black_cd_m2);
        let luminance = mean_luminance(white_cd_m2, black_cd_m2);
        let sensitivity = contrast_sensitivity(self.cycles_per_degree(), luminance, FIELD_DEG)?;
        (sum > 0.0).then(|| difference / sum * sensitivity / age_factor(self.age_years))
    }

    /// Returns true if text of this mean luminance, cd/m2, is within the range of Adrian's model.
    pub fn is_visibility_in_range(&self, luminance_cd_m2: f64) -> bool {
        self.task(Polarity::Darker).in_range(luminance_cd_m2)
    }

    /// Returns true if text of this mean luminance, cd/m2, is within the range of Barten's model and of the
    /// age factor.
    pub fn is_margin_in_range(&self, luminance_cd_m2: f64) -> bool {
        is_luminance_in_range(luminance_cd_m2) && is_age_in_range(self.age_years)
    }

    fn task(&self, polarity: Polarity) -> VisibilityTask {
        VisibilityTask {
            diameter_arcmin: self.detail_arcmin(),
            time_s: FIXATION_S,
            polarity,
            age_years: self.age_years,
        }
    }
}

/// Mean luminance of text, cd/m2 (Feng 2012, eq. 5-13).
fn mean_luminance(white_cd_m2: f64, black_cd_m2: f64) -> f64 {
    0.75 * white_cd_m2 + 0.25 * black_cd_m2
}

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
            luminance_cd_m2: mean_luminance(white_cd_m2, black_cd_m2),
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

    const AT_60: Reader = Reader { age_years: 60.0, text_height_mm: 1.6, distance_mm: 500.0 };

    /// A fifth of 1.6 mm at 500 mm is 2.2002'; a stroke and a gap of 0.64 mm are 1/13.637 deg.
    #[test]
    fn details_of_text_are_a_fifth_of_its_height() {
        assert!((AT_60.detail_arcmin() - 2.200_158).abs() < 1e-6, "{}", AT_60.detail_arcmin());
        assert!((AT_60.cycles_per_degree() - 13.636_769).abs() < 1e-6, "{}", AT_60.cycles_per_degree());
    }

    /// Text of 10 and of 0.5 cd/m2 has 7.625 cd/m2. The expressions of Radiance and of colour-science give
    /// the threshold of a dark detail of 2.200158', 4.29727340 cd/m2 for 60 years, and S = 105.01200880 at
    /// 13.636769 cycles per degree.
    #[test]
    fn readability_agrees_with_other_programs() {
        let level = AT_60.visibility_level(10.0, 0.5).unwrap();
        assert!((level / (9.5 / 4.29727340) - 1.0).abs() < 1e-7, "{level}");
        let margin = AT_60.contrast_margin(10.0, 0.5).unwrap();
        let expected = 9.5 / 10.5 * 105.01200880 / (41.0_f64.powi(2) / 2160.0 + 0.99);
        assert!((margin / expected - 1.0).abs() < 1e-7, "{margin}");
    }

    /// Larger text, a shorter distance, more contrast and a younger reader never make text harder to read.
    #[test]
    fn readability_follows_size_distance_contrast_and_age() {
        let both = |reader: &Reader, white: f64, black: f64| {
            [reader.visibility_level(white, black).unwrap(), reader.contrast_margin(white, black).unwrap()]
        };
        for white in [0.2, 1.0, 8.0, 90.0, 1000.0, 9000.0] {
            for age_years in [20.0, 30.0, 45.0, 63.9, 64.1, 70.0, 75.0] {
                // From 8 cycles per degree on, the eye's sensitivity decreases with frequency.
                for text_height_mm in [0.5, 1.0, 1.5, 2.5] {
                    let reader = Reader { age_years, text_height_mm, distance_mm: 500.0 };
                    let here = both(&reader, white, 0.1 * white);
                    let others = [
                        both(&Reader { text_height_mm: 1.1 * text_height_mm, ..reader }, white, 0.1 * white),
                        both(&Reader { distance_mm: 460.0, ..reader }, white, 0.1 * white),
                        both(&Reader { age_years: age_years - 1.0, ..reader }, white, 0.1 * white),
                        both(&reader, white, 0.08 * white),
                    ];
                    for (other, better) in others.iter().enumerate() {
                        assert!(
                            better[0] >= here[0] && better[1] >= here[1],
                            "{other}: {reader:?}, {white} cd/m2"
                        );
                    }
                    assert!(here.iter().all(|number| number.is_finite() && *number > 0.0));
                }
            }
        }
    }

    #[test]
    fn readability_is_undefined_without_light_and_zero_without_contrast() {
        assert_eq!((AT_60.visibility_level(0.0, 0.0), AT_60.contrast_margin(0.0, 0.0)), (None, None));
        assert_eq!(
            (AT_60.visibility_level(5.0, 5.0), AT_60.contrast_margin(5.0, 5.0)),
            (Some(0.0), Some(0.0))
        );
        // White text on black.
        assert!(
            AT_60.visibility_level(1.0, 5.0).unwrap() > 0.0 && AT_60.contrast_margin(1.0, 5.0).unwrap() < 0.0
        );
    }

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

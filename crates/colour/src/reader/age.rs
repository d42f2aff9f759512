//! Age of a reader.
//!
//! **What.** The factor by which the threshold contrast of older readers is higher: less light reaches the
//! retina, and more of it is scattered in the eye. Adrian, Lighting Res. Technol. 21, 181 (1989):
//! `(a - 19)²/2160 + 0.99` up to 64 years, `(a - 56.6)²/116.3 + 1.43` above. It is 1 at 23.6 years, 1.77 at
//! 60.
//!
//! **Range.** 23 to 75 years.
//!
//! **Source.** The constants are those of two independent programs: the visibility level script of Radiance
//! (LBNL), and `calcDeltaL.m` by J. Winter (TU Berlin), which also states the range.

/// Ages for which the age factor is known, years.
pub const AGES_YEARS: [f64; 2] = [23.0, 75.0];

/// Age at which the second formula begins, years.
const SECOND_FROM_YEARS: f64 = 64.0;

/// Returns the threshold contrast of a reader relative to that of a young reader.
///
/// Below 23 years and above 75 years, the factor of the limit is used. At 64 years, the second formula begins
/// 1.4 % below the first; up to 64.2 years, where it is equal, the factor is constant, so that it never
/// decreases with age.
pub fn age_factor(age_years: f64) -> f64 {
    let [youngest, oldest] = AGES_YEARS;
    let age_years = age_years.clamp(youngest, oldest);
    let first = |age: f64| (age - 19.0).powi(2) / 2160.0 + 0.99;
    if age_years <= SECOND_FROM_YEARS {
        first(age_years)
    } else {
        ((age_years - 56.6).powi(2) / 116.3 + 1.43).max(first(SECOND_FROM_YEARS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 60 years: 41²/2160 + 0.99; 75 years: 18.4²/116.3 + 1.43.
    #[test]
    fn age_factor_has_the_values_of_its_formulas() {
        for (age, expected) in [(23.0, 0.997_407), (25.0, 1.006_667), (60.0, 1.768_241), (75.0, 4.341_092)] {
            assert!((age_factor(age) - expected).abs() < 1e-6, "{age}: {}", age_factor(age));
        }
    }

    #[test]
    fn age_factor_never_decreases_with_age() {
        let mut last = 0.0;
        for tenths in 150..=900 {
            let factor = age_factor(f64::from(tenths) / 10.0);
            assert!(factor >= last, "{tenths}");
            last = factor;
        }
        assert_eq!((age_factor(20.0), age_factor(90.0)), (age_factor(23.0), age_factor(75.0)));
    }
}

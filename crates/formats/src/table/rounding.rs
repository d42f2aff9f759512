//! Rounding of numbers that were converted to another unit before they were written: 3.142 rad is 180 deg,
//! 3.26274 eV is 380 nm.
//!
//! The digits of a column state how far its values may be from those that were meant. If **all** values of
//! the column are within this distance of the multiples of a step, and values of any other kind hardly ever
//! would be, the multiples were meant. A column that is regular in its own unit (0.05, 0.10, 0.15 rad) is
//! none of these, and is not touched.

/// Digits with which the numbers of a column are written.
#[derive(Debug, Default, Clone, Copy, PartialEq)]
pub(crate) struct Digits {
    /// Most decimals: of numbers with a fixed number of decimals.
    decimals: i32,
    /// Most significant digits: of numbers with a fixed number of digits.
    significant: i32,
}

impl Digits {
    /// Digits of one number.
    pub(crate) fn of(text: &str) -> Self {
        let mut digits = Self::default();
        digits.note(text);
        digits
    }

    /// Takes a further number of the column into account.
    pub(crate) fn note(&mut self, text: &str) {
        let (mantissa, exponent) = text.split_once(['e', 'E', 'd', 'D']).unwrap_or((text, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        let is_digit = |c: &char| c.is_ascii_digit();
        let behind =
            mantissa.split_once(['.', ',']).map_or(0, |(_, behind)| behind.chars().filter(is_digit).count());
        let significant = mantissa.chars().filter(is_digit).skip_while(|c| *c == '0').count();
        self.decimals = self.decimals.max(behind as i32 - exponent.clamp(-400, 400));
        self.significant = self.significant.max(significant as i32);
    }

    /// Returns the largest error by rounding of a number of the column, in the unit of the column.
    pub(crate) fn error(self, value: f64) -> f64 {
        let magnitude = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
        let fixed = 0.5 * 10_f64.powi(-self.decimals);
        let floating = 0.5 * 10_f64.powi(magnitude - self.significant + 1);
        // Numbers of single precision are rounded to 24 bits.
        fixed.max(floating).max(value.abs() * f64::from(f32::EPSILON))
    }
}

/// Steps of the grids of instruments, degrees or nm, the largest first. Each divides 180.
const STEPS: [f64; 11] = [5.0, 2.5, 1.0, 0.5, 0.25, 0.1, 0.05, 0.025, 0.01, 0.005, 0.001];

/// Chance below which it is no accident that values of any other kind are all near the multiples of a step.
const CHANCE: f64 = 1e-3;

/// Returns the step whose multiples were meant by different values, each with the largest error by its
/// rounding.
pub(crate) fn step(values: &[(f64, f64)]) -> Option<f64> {
    STEPS.into_iter().find(|step| {
        let mut chance = 1.0;
        for &(value, error) in values.iter().filter(|(value, _)| *value != 0.0) {
            let error = error * (1.0 + 1e-6) + 1e-12;
            if 2.0 * error >= *step || (nearest(value, *step) - value).abs() > error {
                return false;
            }
            chance *= 2.0 * error / step;
        }
        chance < CHANCE
    })
}

/// Returns the multiple of a step nearest to a value.
pub(crate) fn nearest(value: f64, step: f64) -> f64 {
    if step >= 1.0 {
        return (value / step).round() * step;
    }
    // The number of steps in one is whole, and the quotient is the number that its decimal digits mean.
    let each = (1.0 / step).round();
    (value * each).round() / each
}

/// Largest rounding that is no other angle, degrees: that of radians with three decimals.
const LARGEST_DEG: f64 = 0.03;
/// Rounding of an angle that was in radians of seven decimals, degrees.
const LEAST_DEG: f64 = 1e-5;

/// Returns 90, 180, 270 or 360 deg for an angle that is one of these within its rounding: at 90 deg the sides
/// of a sample meet.
pub(crate) fn quarter(deg: f64, error_deg: f64) -> f64 {
    let near = nearest(deg / 90.0, 1.0) * 90.0;
    let error = if error_deg <= LARGEST_DEG { error_deg.max(LEAST_DEG) } else { LEAST_DEG };
    if near != 0.0 && (near - deg).abs() <= error { near } else { deg }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn digits<'a>(texts: impl IntoIterator<Item = &'a String>) -> Digits {
        let mut digits = Digits::default();
        texts.into_iter().for_each(|text| digits.note(text));
        digits
    }

    /// The step that is found for angles in degrees, written in radians.
    fn found(degrees: &[f64], write: impl Fn(f64) -> String) -> Option<f64> {
        let texts: Vec<String> = degrees.iter().map(|deg| write(deg.to_radians())).collect();
        let digits = digits(&texts);
        let value = |text: &String| {
            let rad: f64 = text.parse().unwrap();
            (rad.to_degrees(), digits.error(rad).to_degrees())
        };
        let values: Vec<_> = texts.iter().map(value).collect();
        let step = step(&values)?;
        let snapped: Vec<f64> = values.iter().map(|(deg, _)| nearest(*deg, step)).collect();
        assert_eq!(snapped, degrees);
        Some(step)
    }

    #[test]
    fn degrees_that_were_written_in_rounded_radians_are_found() {
        let degrees: Vec<f64> = (0..=24).map(|k| 7.5 * f64::from(k)).collect();
        for decimals in 3..=15 {
            assert_eq!(found(&degrees, |rad| format!("{rad:.decimals$}")), Some(2.5), "{decimals}");
            assert!(found(&degrees, |rad| format!("{rad:.decimals$e}")).is_some(), "{decimals}");
        }
        // Without the zeros at the end, and of single precision.
        assert_eq!(found(&degrees, |rad| format!("{}", (rad * 1e5).round() / 1e5)), Some(2.5));
        assert_eq!(found(&degrees, |rad| (rad as f32).to_string()), Some(2.5));
        assert_eq!(found(&[0.0, 7.77, 31.3], |rad| format!("{rad:.6}")), Some(0.01));
    }

    #[test]
    fn values_that_are_regular_in_their_own_unit_are_left() {
        for decimals in 2..8 {
            let radians: Vec<(f64, f64)> = (1..=31)
                .map(|k| {
                    let rad = 0.05 * f64::from(k);
                    (rad.to_degrees(), Digits::of(&format!("{rad:.decimals$}")).error(rad).to_degrees())
                })
                .collect();
            assert_eq!(step(&radians), None, "{decimals}");
        }
        assert_eq!(step(&[(20.003, 0.01)]), None);
    }

    #[test]
    fn right_angles_are_those_within_the_rounding() {
        let rad = |text: &str| {
            let value: f64 = text.parse().unwrap();
            quarter(value.to_degrees(), Digits::of(text).error(value).to_degrees())
        };
        assert_eq!(
            ["1.571", "1.5708", "1.5707964", "3.142", "3.1415927"].map(rad),
            [90.0, 90.0, 90.0, 180.0, 180.0]
        );
        assert!(rad("1.6") > 91.0 && rad("1.572") > 90.0 && rad("0.0001") > 0.0);
    }
}

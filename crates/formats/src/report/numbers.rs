//! Numbers of reports as text: with their errors, in percent, with their signs.

/// Numbers from here on have an exponent, so that no column is wider than a page.
const LARGE: f64 = 1e15;

/// A value with its standard error in units of the last digit, as in `0.1523(2)` (GUM, 7.2.2). If the error
/// is less than half of the last digit, only the value is printed.
pub fn measured(value: Option<f64>, error: Option<f64>, decimals: usize) -> String {
    let Some(value) = value else { return "-".to_owned() };
    let error = error.unwrap_or(0.0);
    if value.abs() >= LARGE {
        return format!("{value:.4e}");
    }
    if error.is_nan() || error < 0.5 * 0.1_f64.powi(decimals as i32) {
        return unsigned_zero(format!("{value:.decimals$}"));
    }
    // The first digit of the error decides the number of decimals. Round the error to one digit first, so
    // that 0.96 counts as 1.
    let magnitude = format!("{error:.0e}");
    let exponent: i32 = magnitude.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let decimals = decimals.min((-exponent).max(0) as usize);
    let last = (error * 10.0_f64.powi(decimals as i32)).round();
    unsigned_zero(format!("{value:.decimals$}({last})"))
}

/// Whether a text has a number with its error, as [`measured`] writes it.
pub fn has_errors(text: &str) -> bool {
    let is_error = |(at, _): (usize, &str)| {
        let (before, inner) = (&text[..at], &text[at + 1..]);
        let digits = inner.bytes().take_while(u8::is_ascii_digit).count();
        before.ends_with(|c: char| c.is_ascii_digit()) && digits > 0 && inner[digits..].starts_with(')')
    };
    text.match_indices('(').any(is_error)
}

/// A number with its sign, unless its rounded value is zero.
pub fn signed(value: f64, decimals: usize) -> String {
    if value.abs() >= LARGE {
        return format!("{value:+.4e}");
    }
    unsigned_zero(format!("{value:+.decimals$}"))
}

/// A number with five digits as [`digits`], and its error in units of the last digit.
pub fn digits_with_error(value: f64, error: Option<f64>) -> String {
    match error.filter(|error| *error > 0.0) {
        Some(error) => measured(Some(value), Some(error), decimals(value)),
        None => digits(value),
    }
}

/// A number with five digits, and all digits before the decimal point; numbers below 1 have five decimals.
pub fn digits(value: f64) -> String {
    if value.abs() >= LARGE {
        return format!("{value:.4e}");
    }
    unsigned_zero(format!("{value:.*}", decimals(value)))
}

/// Both ends of an interval with the same number of decimals, that of the end with more of them.
pub fn digits_alike(ends: [f64; 2]) -> [String; 2] {
    if ends.iter().any(|end| end.abs() >= LARGE) {
        return ends.map(digits);
    }
    let decimals = ends.map(decimals).into_iter().max().unwrap_or(0);
    ends.map(|end| unsigned_zero(format!("{end:.decimals$}")))
}

/// Decimals of a number with five digits.
fn decimals(value: f64) -> usize {
    let before = if value.abs() < 1.0 { 0 } else { value.abs().log10().floor() as usize + 1 };
    5_usize.saturating_sub(before)
}

/// Removes the sign of a number whose digits are all zero.
pub fn unsigned_zero(number: String) -> String {
    match number.strip_prefix(['-', '+']) {
        Some(rest) if rest.chars().take_while(|c| *c != '(').all(|c| matches!(c, '0' | '.')) => {
            rest.to_owned()
        }
        _ => number,
    }
}

/// A fraction in %, with two decimals, or as many as its first digit needs.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    let decimals = if percent > 0.0 { (-percent.log10().floor()).clamp(2.0, 12.0) as usize } else { 2 };
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::{digits, digits_alike, digits_with_error, has_errors, measured, percent, signed};

    #[test]
    fn number_is_printed_with_five_digits() {
        let texts = [0.19785, 27.41288, 14922.68596, -1e-9, -0.5, 0.0].map(digits);
        assert_eq!(texts, ["0.19785", "27.413", "14923", "0.00000", "-0.50000", "0.00000"]);
        assert_eq!([1e300, -1e15].map(digits), ["1.0000e300", "-1.0000e15"]);
        assert_eq!(
            (measured(Some(1e300), Some(1e290), 4), signed(1e300, 2)),
            ("1.0000e300".to_owned(), "+1.0000e300".to_owned())
        );
        assert_eq!(digits_with_error(27.41288, Some(0.02)), "27.41(2)");
        assert_eq!(digits_with_error(27.41288, Some(1e-5)), "27.413");
        assert_eq!(digits_with_error(0.19785, None), "0.19785");
    }

    #[test]
    fn ends_of_an_interval_have_the_same_number_of_decimals() {
        assert_eq!(digits_alike([0.999_97, 1.0]), ["0.99997", "1.00000"]);
        assert_eq!(digits_alike([99.0741, 105.06]), ["99.074", "105.060"]);
        assert_eq!(digits_alike([-1e-7, 0.5]), ["0.00000", "0.50000"]);
    }

    #[test]
    fn percentage_of_small_error_shows_its_first_digit() {
        assert_eq!(percent(0.1234), "12.34 %");
        assert_eq!(percent(3.2e-5), "0.003 %");
        assert_eq!(percent(0.96e-5), "0.0010 %");
        assert_eq!((percent(0.0).as_str(), percent(1e-30).as_str()), ("0.00 %", "0.000000000000 %"));
    }

    #[test]
    fn error_is_printed_in_units_of_the_last_digit() {
        assert_eq!(measured(Some(0.15234), Some(0.00021), 4), "0.1523(2)");
        assert!(has_errors("Y 0.1523(2)") && !has_errors("Y (%) 0.1523, black (0), f(i,o) 2(x)"));
        assert_eq!(measured(Some(0.15234), Some(0.0021), 4), "0.152(2)");
        assert_eq!(measured(Some(0.15234), Some(1e-9), 4), "0.1523");
        assert_eq!(measured(Some(612.34), Some(23.0), 1), "612(23)");
        assert_eq!(measured(Some(9.123), None, 2), "9.12");
        assert_eq!(measured(Some(11343.2), Some(0.96), 1), "11343(1)");
        assert_eq!(measured(Some(-0.001), Some(0.0001), 2), "0.00");
        assert_eq!([-0.04, 0.04, 0.06, -0.06].map(|v| signed(v, 1)), ["0.0", "0.0", "+0.1", "-0.1"]);
        assert_eq!(measured(Some(-0.1), Some(0.0001), 2), "-0.10");
        assert_eq!(measured(None, None, 2), "-");
    }
}

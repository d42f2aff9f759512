//! Numbers in messages and reports.

use std::borrow::Cow;

/// Integers below it have no error.
const LARGEST_INTEGER: f64 = 9_007_199_254_740_992.0;

/// Numbers from here on are written with an exponent if that is shorter.
const LARGE: f64 = 1e6;
/// Smaller numbers are written with an exponent.
const SMALL: f64 = 1e-4;
/// Longest number, in characters, that is left as it is: those that Rust prints with all digits of a double
/// have at most 20.
const LONGEST: usize = 21;

/// Writes a number with at most twelve significant digits and without zeros at the end; with an exponent
/// below 0.0001, and from a million on where that is shorter.
///
/// ```
/// use papilio_diagnostics::number;
/// assert_eq!([0.1 + 0.2, 380.0, 1e300, -2.5e-7, 0.0].map(number), ["0.3", "380", "1e300", "-2.5e-7", "0"]);
/// ```
pub fn number(value: f64) -> String {
    // All digits of an integer are exact.
    let is_whole = value.fract() == 0.0 && value.abs() < LARGEST_INTEGER;
    let rounded = if is_whole { value } else { format!("{value:.11e}").parse().unwrap_or(value) };
    match rounded.abs() {
        0.0 => "0".to_owned(),
        size if (SMALL..LARGE).contains(&size) || !size.is_finite() => rounded.to_string(),
        size => {
            let (plain, with_exponent) = (rounded.to_string(), format!("{rounded:e}"));
            if size >= LARGE && plain.len() <= with_exponent.len() { plain } else { with_exponent }
        }
    }
}

/// Returns a message in which numbers of hundreds of digits, as in a text made with `{value}`, are written as
/// [`number`] does.
///
/// ```
/// let text = format!("{} nm is not {} nm", 1e-30, 550);
/// assert_eq!(papilio_diagnostics::short_numbers(&text), "1e-30 nm is not 550 nm");
/// ```
pub fn short_numbers(text: &str) -> Cow<'_, str> {
    let is_part = |byte: u8| byte.is_ascii_digit() || byte == b'.';
    let (bytes, mut at, mut short) = (text.as_bytes(), 0, String::new());
    let mut copied = 0;
    while at < bytes.len() {
        let length = bytes[at..].iter().take_while(|byte| is_part(**byte)).count();
        if length > LONGEST {
            let word = text[at..at + length].trim_end_matches('.');
            // Digits within a name or a hash are no number.
            let is_word =
                |byte: Option<&u8>| byte.is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
            let inside = is_word(bytes[..at].last()) || is_word(bytes.get(at + length));
            if let (false, Ok(value)) = (inside, word.parse::<f64>()) {
                short.push_str(&text[copied..at]);
                short.push_str(&number(value));
                copied = at + word.len();
            }
        }
        at += length.max(1);
    }
    if copied == 0 {
        return Cow::Borrowed(text);
    }
    short.push_str(&text[copied..]);
    Cow::Owned(short)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_is_short_whatever_its_size() {
        let numbers = [
            999_999.5,
            8_076_432.0,
            1_234_567_890_123.0,
            1e9,
            -1.5e9,
            123.456,
            1e-4,
            9.9e-5,
            -0.0,
            f64::NEG_INFINITY,
            f64::MIN_POSITIVE,
        ];
        let written = [
            "999999.5",
            "8076432",
            "1234567890123",
            "1e9",
            "-1.5e9",
            "123.456",
            "0.0001",
            "9.9e-5",
            "0",
            "-inf",
            "2.22507385851e-308",
        ];
        assert_eq!(numbers.map(number), written);
    }

    #[test]
    fn long_numbers_of_a_message_are_shortened_and_nothing_else() {
        let text = format!("a {} b, {}. \u{b5} -{}", 1e300, f64::MAX, 1.5e-300);
        assert_eq!(short_numbers(&text), "a 1e300 b, 1.79769313486e308. \u{b5} -1.5e-300");
        for same in [
            "0.30000000000000004",
            "v1.2.3.4.5.6.7.8.9.10.11.12",
            "sha a1234567890123456789012345678901b",
            "1..2",
            "",
        ] {
            assert_eq!(short_numbers(same), same);
        }
    }
}

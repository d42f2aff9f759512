//! Numbers, names and tables as text.

use std::fmt::Write;

pub use papilio_diagnostics::{is_override, number, short_numbers, visible};
use papilio_goniometry::Channel;

/// Returns rows as an aligned table: the first column to the left, all others to the right; numbers of
/// hundreds of digits are shortened.
pub fn table(rows: &[Vec<String>]) -> String {
    let short = |row: &Vec<String>| row.iter().map(|cell| short_numbers(cell).into_owned()).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(short).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
    let mut text = String::new();
    for row in &rows {
        let _ = write!(text, "  {:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(text, "  {cell:>width$}");
        }
        // Headings of several lines have empty cells.
        text.truncate(text.trim_end_matches(' ').len());
        text.push('\n');
    }
    text
}

/// Formats a fraction in percent: with one decimal, or with two below 10 %.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent.abs() >= 10.0 || percent == 0.0 {
        format!("{percent:.1} %")
    } else {
        format!("{percent:.2} %")
    }
}

/// Writes an angle in degrees, or a wavelength in nm, with at most four decimals: what was in another unit
/// has many.
pub fn degrees(value: f64) -> String {
    let rounded = (value * 1e4).round() / 1e4;
    number(if rounded == 0.0 { value } else { rounded })
}

/// Describes ascending values by their number, the first and the last: `5 from 0 to 80`.
pub fn span(values: &[f64]) -> String {
    match values {
        [] => "none".to_owned(),
        [one] => degrees(*one),
        [first, .., last] => format!("{} from {} to {}", values.len(), degrees(*first), degrees(*last)),
    }
}

/// Returns the name of a channel; a wavelength has its unit.
pub fn channel(channel: &Channel) -> String {
    if matches!(channel, Channel::Wavelength(_)) { format!("{channel} nm") } else { channel.to_string() }
}

/// Returns whether a spreadsheet would read a text as a formula: `=...` and `@...`, and `+...` and `-...` if
/// more follows than letters, digits, blanks and the characters of names and numbers (a state may be called
/// `-5 V`).
pub fn is_formula(text: &str) -> bool {
    let harmless = |c: char| c.is_alphanumeric() || " ._-+%\u{b0}\u{b5}".contains(c);
    let mut rest = text.trim_start().chars();
    match rest.next() {
        Some('=' | '@' | '\u{ff1d}' | '\u{ff20}') => true,
        Some('+' | '-' | '\u{ff0b}' | '\u{ff0d}') => !rest.all(harmless),
        _ => false,
    }
}

/// Returns a user's text as a cell of a table. An apostrophe precedes a text that a spreadsheet would read as
/// a formula.
pub fn text_cell(text: String) -> String {
    if is_formula(&text) { format!("'{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_distinguished_from_names() {
        for formula in
            ["=HYPERLINK(\"http://x\")", "@SUM(1)", "+1+cmd|' /C calc'!A0", "-(1)", " =1", "\u{ff1d}1"]
        {
            assert!(is_formula(formula), "{formula}");
        }
        for name in ["-5 V", "+10.5 µm", "red", "50 %", "a=b", "#1", ""] {
            assert!(!is_formula(name), "{name}");
        }
        assert_eq!(text_cell("=1".to_owned()), "'=1");
    }
}

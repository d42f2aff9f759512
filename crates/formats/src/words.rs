//! Numbers and names as lines of text have them.

use std::fmt::Write;

pub use papilio_diagnostics::{is_override, visible};
use papilio_goniometry::Channel;

/// Left-aligned first column, right-aligned numbers.
pub fn table(rows: &[Vec<String>]) -> String {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..rows.first().map_or(0, Vec::len)).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let _ = write!(text, "  {:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            let _ = write!(text, "  {cell:>width$}");
        }
        text.push('\n');
    }
    text
}

/// A share in per cent: one decimal, or two below 10 %.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent.abs() >= 10.0 || percent == 0.0 {
        format!("{percent:.1} %")
    } else {
        format!("{percent:.2} %")
    }
}

/// Values that rise: how many, and from where to where.
pub fn span(values: &[f64]) -> String {
    match values {
        [] => "none".to_owned(),
        [one] => format!("{one}"),
        [first, .., last] => format!("{} from {first} to {last}", values.len()),
    }
}

/// A channel's name; of a wavelength, with its unit.
pub fn channel(of: &Channel) -> String {
    if matches!(of, Channel::Wavelength(_)) { format!("{of} nm") } else { of.to_string() }
}

/// True of a text that a spreadsheet takes for a formula: `=...`, `@...`; `+...` and `-...` with more than letters, digits, blanks and
/// what names and numbers have (a state may be called `-5 V`).
pub fn is_formula(text: &str) -> bool {
    let harmless = |c: char| c.is_alphanumeric() || " ._-+%\u{b0}\u{b5}".contains(c);
    let mut rest = text.trim_start().chars();
    match rest.next() {
        Some('=' | '@' | '\u{ff1d}' | '\u{ff20}') => true,
        Some('+' | '-' | '\u{ff0b}' | '\u{ff0d}') => !rest.all(harmless),
        _ => false,
    }
}

/// A text that the user wrote as a cell of a table: of what a spreadsheet would take for a formula an apostrophe says that it is none.
pub fn text_cell(text: String) -> String {
    if is_formula(&text) { format!("'{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_told_from_names() {
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

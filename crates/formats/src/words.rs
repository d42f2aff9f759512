//! Numbers and names as lines of text have them.

use std::borrow::Cow;
use std::fmt::Write;

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

/// True of a character that a terminal obeys or that turns the order of what follows: a control character other than the end
/// of a line and a tab, or one of Unicode's embeddings, overrides and isolates.
fn is_obeyed(c: char) -> bool {
    (c.is_control() && c != '\n' && c != '\t') || is_override(c)
}

/// True of the characters that turn the direction of the text after them (Unicode, UAX #9): what is read is then not what stands there.
pub fn is_override(c: char) -> bool {
    matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text as a terminal may have it: in the place of a character that is obeyed stands `\u001b`, as JSON writes it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_obeyed(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

/// [`visible`] text in one line.
pub(crate) fn in_one_line(text: &str) -> Cow<'_, str> {
    match visible(text) {
        shown if shown.contains('\n') => Cow::Owned(shown.replace('\n', "\\n")),
        shown => shown,
    }
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
    fn what_is_obeyed_is_shown() {
        let text = "\u{1b}]0;x\u{7}\u{9b}2J\u{202e}\u{2066}\r";
        assert_eq!(visible(text), "\\u001b]0;x\\u0007\\u009b2J\\u202e\\u2066\\u000d");
        assert_eq!(visible("a\n\tµ = \u{2265} 5"), "a\n\tµ = \u{2265} 5");
        assert_eq!(in_one_line("a\nerror: b"), "a\\nerror: b");
    }

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

//! Texts of numbers: their encoding, and how their numbers are separated.

use papilio_diagnostics::Diagnostic;

use super::not_a_map;

use std::borrow::Cow;

/// The content as a text, in the encodings of all tables.
///
/// # Errors
/// A file with zero bytes, which is no text.
pub(super) fn decoded(bytes: &[u8]) -> Result<Cow<'_, str>, Diagnostic> {
    let text = crate::table::decode(bytes).filter(|text| !text.contains('\0'));
    text.ok_or_else(not_a_map)
}

/// How the numbers of a text are separated and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Style {
    /// `None`: blanks.
    pub(super) separator: Option<char>,
    pub(super) has_decimal_commas: bool,
}

impl Style {
    /// The style of a text, from its lines of numbers.
    pub(super) fn of(text: &str) -> Self {
        let mut found = [false; 5];
        let [semicolon, tab, dot, comma, bare_comma] = &mut found;
        for line in text.lines().map(str::trim).filter(|line| is_numbers(line)) {
            *semicolon |= line.contains(';');
            *tab |= line.contains('\t');
            *dot |= line.contains('.');
            *comma |= line.contains(',');
            // A comma that separates: next to a blank or another comma, at an end, or two in a word.
            *bare_comma |= line
                .split_whitespace()
                .any(|word| word.starts_with(',') || word.ends_with(',') || word.matches(',').count() > 1);
            *bare_comma |= line.contains(',') && !line.contains(char::is_whitespace);
        }
        let [semicolon, tab, dot, comma, bare_comma] = found;
        let (separator, has_decimal_commas) = match (semicolon, tab) {
            (true, _) => (Some(';'), comma),
            (_, true) if !bare_comma => (Some('\t'), comma),
            _ if comma && !dot && !bare_comma => (None, true),
            _ if comma => (Some(','), false),
            _ => (None, false),
        };
        Self { separator, has_decimal_commas }
    }

    /// The cells of a line, each with its first byte. A separator at the end of a line separates nothing.
    pub(super) fn cells<'a>(&self, line: &'a str, cells: &mut Vec<(usize, &'a str)>) {
        cells.clear();
        let place = |cell: &'a str| (cell.as_ptr() as usize - line.as_ptr() as usize, cell);
        match self.separator {
            Some(separator) => {
                cells.extend(line.split(separator).map(|cell| place(cell.trim().trim_matches('"'))));
                if cells.last().is_some_and(|(_, cell)| cell.is_empty()) {
                    cells.pop();
                }
            }
            None => cells.extend(line.split_whitespace().map(place)),
        }
        // Two words for a missing height.
        if let Some(at) = cells.windows(2).position(|pair| is_no_data(pair[0].1, pair[1].1)) {
            cells.remove(at + 1);
            cells[at].1 = "NoData";
        }
    }

    /// The number of a cell, NaN if it marks a missing one; `None` if it is neither.
    pub(super) fn number(&self, cell: &str) -> Option<f64> {
        if is_missing(cell) {
            return Some(f64::NAN);
        }
        let number = cell.parse::<f64>().ok();
        let number = number.or_else(|| {
            let changed = cell.replace('\u{2212}', "-").replace(['d', 'D'], "e");
            let changed = if self.has_decimal_commas { changed.replace(',', ".") } else { changed };
            changed.parse::<f64>().ok()
        });
        number.map(|number| if number.is_finite() { number } else { f64::NAN })
    }
}

fn is_no_data(first: &str, second: &str) -> bool {
    ["no", "not", "non"].iter().any(|word| first.eq_ignore_ascii_case(word))
        && ["data", "measured"].iter().any(|word| second.eq_ignore_ascii_case(word))
}

/// Words of programs for a height that was not measured.
const MISSING: [&str; 15] = [
    "", "BAD", "NAN", "NODATA", "NO DATA", "NO_DATA", "NULL", "NA", "N/A", "#N/A", "NM", "-", "--", "---",
    "***",
];

pub(super) fn is_missing(cell: &str) -> bool {
    MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
        || ["nan(ind)", "-nan", "-nan(ind)", "1.#QNAN", "-1.#IND", "?"]
            .iter()
            .any(|word| cell.eq_ignore_ascii_case(word))
}

/// Whether a line has numbers only, and words for missing ones.
fn is_numbers(line: &str) -> bool {
    line.contains(|c: char| c.is_ascii_digit())
        && line.split(|c: char| c.is_whitespace() || c == ',' || c == ';').all(|word| {
            is_missing(word)
                || ["no", "not", "data", "measured"].iter().any(|missing| word.eq_ignore_ascii_case(missing))
                || word.chars().all(|c| {
                    c.is_ascii_digit()
                        || matches!(c, '+' | '-' | '\u{2212}' | '.' | 'e' | 'E' | 'd' | 'D' | '"')
                })
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn style_of_a_text_is_that_of_its_numbers() {
        let style = |text| {
            let Style { separator, has_decimal_commas } = Style::of(text);
            (separator, has_decimal_commas)
        };
        assert_eq!(style("1 2\n3 4"), (None, false));
        assert_eq!(style("# a, b; c\n1.5 2\n3 4"), (None, false));
        assert_eq!(style("1,2\n3,4"), (Some(','), false));
        assert_eq!(style("1, 2\n3, 4"), (Some(','), false));
        assert_eq!(style("1,5 2,25\n3,0 4"), (None, true));
        assert_eq!(style("1,5;2,25"), (Some(';'), true));
        assert_eq!(style("1.5;2.25"), (Some(';'), false));
        assert_eq!(style("1,5\t2,25\t"), (Some('\t'), true));
        assert_eq!(style("1.5\t2.25"), (Some('\t'), false));
        assert_eq!(style("1.5,\t2.25,"), (Some(','), false));
        assert_eq!(style("0 1 No Data\n1 2 0,5"), (None, true));
    }

    #[test]
    fn cells_have_their_places_and_missing_ones_are_not_numbers() {
        let style = Style { separator: None, has_decimal_commas: true };
        let mut cells = Vec::new();
        style.cells(" 1 2,5 No Data", &mut cells);
        assert_eq!(cells, [(1, "1"), (3, "2,5"), (7, "NoData")]);
        assert_eq!(style.number("2,5"), Some(2.5));
        assert!(style.number("NoData").is_some_and(f64::is_nan));
        assert_eq!(style.number("1.0D-3"), Some(0.001));
        assert_eq!(style.number("two"), None);
    }

    #[test]
    fn encodings_are_recognised() {
        assert_eq!(decoded("µm".as_bytes()).unwrap(), "µm");
        assert_eq!(decoded(b"\xB5m").unwrap(), "µm");
        assert_eq!(decoded(b"\xFF\xFE\xB5\x00m\x00").unwrap(), "µm");
        assert_eq!(decoded(b"\xFE\xFF\x00\xB5\x00m").unwrap(), "µm");
        assert!(decoded(b"a\0b").is_err());
    }
}

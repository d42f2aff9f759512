//! Places in a text: the text's name, line and column.

use std::fmt;
use std::ops::Range;

use crate::text::{is_override, visible};

/// A place in a named text, or the text as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file's name as the user wrote it, or for example `--set 1`.
    pub name: String,
    /// The part of one line; `None` means the text as a whole.
    pub spot: Option<Spot>,
}

/// A part of one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spot {
    /// Line, from 1.
    pub line: usize,
    /// Column of the first character, from 1, counted in characters.
    pub column: usize,
    /// Number of characters, at least 1.
    pub width: usize,
    /// The whole line.
    pub text: String,
}

/// A longer line is shown only in part; in characters.
const LONGEST_LINE_SHOWN: usize = 160;

impl Place {
    /// Returns the text as a whole.
    pub fn whole(name: &str) -> Self {
        Self { name: name.to_owned(), spot: None }
    }

    /// Returns the place of the bytes `range` of `text`. A range that extends beyond the line of its start is
    /// shortened.
    pub fn in_text(name: &str, text: &str, range: Range<usize>) -> Self {
        let start = char_start(text, range.start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let end = char_start(text, range.end).clamp(start, line_end);
        let spot = Spot {
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            width: text[start..end].trim_end().chars().count().max(1),
            text: text[line_start..line_end].trim_end().to_owned(),
        };
        Self { name: name.to_owned(), spot: Some(spot) }
    }

    /// Returns line and column, both from 1, or `None` for a text as a whole.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        self.spot.as_ref().map(|spot| (spot.line, spot.column))
    }
}

impl fmt::Display for Place {
    /// Writes `file:line:column`, or the name alone.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.spot {
            Some(spot) => write!(f, "{}:{}:{}", self.name, spot.line, spot.column),
            None => f.write_str(&self.name),
        }
    }
}

impl Spot {
    /// Writes the line and, below it, a caret for each character, followed by a label.
    pub(crate) fn show(&self, margin: usize, label: Option<&str>, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A very long line is shown from 20 characters before the place.
        let hidden = if self.column > LONGEST_LINE_SHOWN { self.column - 20 } else { 0 };
        let shown = self.text.chars().skip(hidden).take(LONGEST_LINE_SHOWN);
        let shown: String = shown.map(|c| if c.is_control() || is_override(c) { ' ' } else { c }).collect();
        let indent = self.column - 1 - hidden;
        let carets = "^".repeat(self.width.min(LONGEST_LINE_SHOWN.saturating_sub(indent)).max(1));
        write!(f, "\n{:margin$} |\n{:margin$} | {shown}", "", self.line)?;
        write!(f, "\n{:margin$} | {:indent$}{carets}", "", "")?;
        label.map_or(Ok(()), |label| write!(f, " {}", visible(label)))
    }
}

/// Returns the start of the character that holds the byte `index`.
fn char_start(text: &str, index: usize) -> usize {
    let mut start = index.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    start
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Diagnostic;

    #[test]
    fn column_of_a_place_counts_characters() {
        let text = "µ = \"ä\"; x";
        let start = text.find('x').unwrap();
        assert_eq!(Place::in_text("t", text, start..start + 1).line_column(), Some((1, 10)));
    }

    #[test]
    fn place_of_any_range_can_be_printed() {
        for text in ["", "\n", "ä\n\u{1F98B}", "\u{feff}x"] {
            for start in 0..8 {
                for end in 0..8 {
                    let place = Place::in_text("t", text, start..end);
                    assert!(!Diagnostic::new("bad").at(&place).to_string().is_empty());
                }
            }
        }
        let long = format!("{}!", "y".repeat(100_000));
        let place = Place::in_text("t", &long, 100_000..100_001);
        assert!(Diagnostic::new("bad").at(&place).to_string().len() < 1000);
    }
}

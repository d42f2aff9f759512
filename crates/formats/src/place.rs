//! Where in a text something stands, and how to show it.

use std::fmt;
use std::ops::Range;

use crate::words::{in_one_line, is_override, visible};

/// A place in a named text, or the text as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file's name as the user wrote it, or for example `--set 1`.
    pub name: String,
    /// The spot in it; `None`: all of it.
    pub spot: Option<Spot>,
}

/// A stretch of one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Spot {
    /// Line, from 1.
    pub line: usize,
    /// Column of the first character, from 1, counted in characters.
    pub column: usize,
    /// How many characters it covers, at least 1.
    pub width: usize,
    /// The whole line.
    pub text: String,
}

/// A line longer than this is shown in part.
const LONGEST_LINE_SHOWN: usize = 160;

impl Place {
    /// The text as a whole.
    pub fn whole(name: &str) -> Self {
        Self { name: name.to_owned(), spot: None }
    }

    /// The bytes `range` of `text`; a range that leaves the text is cut off.
    pub fn in_text(name: &str, text: &str, range: Range<usize>) -> Self {
        let start = floor_char(text, range.start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
        let end = floor_char(text, range.end).clamp(start, line_end);
        let spot = Spot {
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            width: text[start..end].trim_end().chars().count().max(1),
            text: text[line_start..line_end].trim_end().to_owned(),
        };
        Self { name: name.to_owned(), spot: Some(spot) }
    }

    /// Line and column, both from 1, where there are any.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        self.spot.as_ref().map(|spot| (spot.line, spot.column))
    }
}

impl fmt::Display for Place {
    /// `file:line:column`, or the name alone.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.spot {
            Some(spot) => write!(f, "{}:{}:{}", self.name, spot.line, spot.column),
            None => f.write_str(&self.name),
        }
    }
}

/// What to say about a place where something is wrong.
#[derive(Debug, Clone, Copy)]
pub struct Remark<'a> {
    /// What is wrong.
    pub message: &'a str,
    /// Shown beside the caret: what was expected, in words that begin so.
    pub expected: Option<&'a str>,
    /// Lines below: where it was asked for.
    pub note: Option<&'a str>,
    /// Lines below: what to do.
    pub hint: Option<&'a str>,
}

impl Remark<'_> {
    /// Writes the remark with its place, as compilers do, without a final newline.
    ///
    /// # Errors
    /// Those of the formatter.
    pub fn show(&self, place: &Place, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What is quoted may hold anything.
        write!(f, "error: {}", in_one_line(self.message))?;
        let margin = place.spot.as_ref().map_or(1, |spot| spot.line.to_string().len());
        write!(f, "\n{:margin$}--> {}", "", in_one_line(&place.to_string()))?;
        match &place.spot {
            Some(spot) => spot.show(margin, self.expected, f)?,
            None => line("", self.expected, margin, f)?,
        }
        line("note: ", self.note, margin, f)?;
        line("help: ", self.hint, margin, f)
    }
}

/// A line below the text.
fn line(word: &str, text: Option<&str>, margin: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    text.map_or(Ok(()), |text| write!(f, "\n{:margin$} = {word}{}", "", visible(text)))
}

impl Spot {
    fn show(&self, margin: usize, label: Option<&str>, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A very long line is shown from a little before the spot.
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

fn floor_char(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Shown(Place);
    impl fmt::Display for Shown {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            let remark =
                Remark { message: "bad", expected: Some("a length"), note: None, hint: Some("mend it") };
            remark.show(&self.0, f)
        }
    }

    #[test]
    fn a_spot_is_shown_as_compilers_do() {
        let text = "a = 1\r\nthickness_nm = -5\r\n";
        let place = Place::in_text("x.toml", text, 22..24);
        assert_eq!(place.line_column(), Some((2, 16)));
        let expected = "error: bad\n --> x.toml:2:16\n  |\n2 | thickness_nm = -5\n  |                ^^ a length\n  = help: mend it";
        assert_eq!(Shown(place).to_string(), expected);
    }

    #[test]
    fn columns_count_characters() {
        let text = "µ = \"ä\"; x";
        let start = text.find('x').unwrap();
        assert_eq!(Place::in_text("t", text, start..start + 1).line_column(), Some((1, 10)));
    }

    #[test]
    fn any_range_of_any_text_is_a_place() {
        for text in ["", "\n", "ä\n\u{1F98B}", "\u{feff}x"] {
            for start in 0..8 {
                for end in 0..8 {
                    let place = Place::in_text("t", text, start..end);
                    assert!(!Shown(place).to_string().is_empty());
                }
            }
        }
        let long = format!("{}!", "y".repeat(100_000));
        assert!(Shown(Place::in_text("t", &long, 100_000..100_001)).to_string().len() < 1000);
    }
}

//! A diagnostic: what is wrong, what was expected, and what to do.

use std::fmt;

use crate::place::Place;
use crate::text::{in_one_line, visible};

/// What is wrong with something that the user wrote. It is written where the mistake is found.
///
/// ```
/// use papilio_diagnostics::{Diagnostic, Place};
/// let wrong = Diagnostic::new("-5 is out of range").expected("a number from 0 to 1").hint("fractions are of 1");
/// let shown = wrong.at(&Place::in_text("x.toml", "haze = -5", 7..9)).to_string();
/// assert_eq!(
///     shown,
///     "error: -5 is out of range\n --> x.toml:1:8\n  |\n1 | haze = -5\n  |        ^^ expected a number from 0 to 1\n  \
///      = help: fractions are of 1"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong: a sentence without a final stop.
    pub message: String,
    /// What should stand there, in words that begin with "expected"; shown beside the caret.
    pub expected: Option<String>,
    /// What else there is to know, such as where a file is asked for.
    pub note: Option<String>,
    /// What to do.
    pub hint: Option<String>,
}

impl Diagnostic {
    /// What is wrong.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), expected: None, note: None, hint: None }
    }

    /// With what should stand there: `a number from 0 to 1`.
    #[must_use]
    pub fn expected(mut self, words: impl fmt::Display) -> Self {
        self.expected = Some(format!("expected {words}"));
        self
    }

    /// With what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// With what to do, if there is something.
    #[must_use]
    pub fn hint_if(mut self, hint: Option<impl Into<String>>) -> Self {
        self.hint = hint.map(Into::into);
        self
    }

    /// With what else there is to know; what was known before comes first.
    #[must_use]
    pub fn note(mut self, note: impl AsRef<str>) -> Self {
        self.note = Some(match self.note {
            Some(before) => format!("{before}; {}", note.as_ref()),
            None => note.as_ref().to_owned(),
        });
        self
    }

    /// The diagnostic at a place, which prints as compilers do, with the line and a caret below it, without a final newline.
    pub fn at<'a>(&'a self, place: &'a Place) -> Placed<'a> {
        Placed { diagnostic: self, place }
    }
}

impl fmt::Display for Diagnostic {
    /// The message alone.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

/// A diagnostic and its place.
#[derive(Debug, Clone, Copy)]
pub struct Placed<'a> {
    diagnostic: &'a Diagnostic,
    place: &'a Place,
}

impl fmt::Display for Placed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { diagnostic: Diagnostic { message, expected, note, hint }, place } = self;
        // What is quoted may hold anything.
        write!(f, "error: {}", in_one_line(message))?;
        let margin = place.spot.as_ref().map_or(1, |spot| spot.line.to_string().len());
        write!(f, "\n{:margin$}--> {}", "", in_one_line(&place.to_string()))?;
        match &place.spot {
            Some(spot) => spot.show(margin, expected.as_deref(), f)?,
            None => line("", expected.as_deref(), margin, f)?,
        }
        line("note: ", note.as_deref(), margin, f)?;
        line("help: ", hint.as_deref(), margin, f)
    }
}

/// A line below the text.
fn line(word: &str, text: Option<&str>, margin: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    text.map_or(Ok(()), |text| write!(f, "\n{:margin$} = {word}{}", "", visible(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagnostic_at_a_place_prints_as_compilers_do() {
        let text = "a = 1\r\nthickness_nm = -5\r\n";
        let place = Place::in_text("x.toml", text, 22..24);
        assert_eq!(place.line_column(), Some((2, 16)));
        let diagnostic = Diagnostic::new("bad").expected("a length").note("one").note("two").hint("mend it");
        let expected = "error: bad\n --> x.toml:2:16\n  |\n2 | thickness_nm = -5\n  |                ^^ expected a length\n  \
                        = note: one; two\n  = help: mend it";
        assert_eq!(diagnostic.at(&place).to_string(), expected);
        let whole =
            Diagnostic::new("bad\nworse").expected("a length").at(&Place::whole("x.toml")).to_string();
        assert_eq!(whole, "error: bad\\nworse\n --> x.toml\n  = expected a length");
    }
}

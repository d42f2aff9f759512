//! Diagnostics: what is wrong, what was expected and what to do.

use std::fmt;

use crate::number::short_numbers;
use crate::place::Place;
use crate::remedy::{Interface, Remedy};
use crate::text::{in_one_line, visible};

/// Description of a mistake in the user's input. The code that finds the mistake creates it.
///
/// ```
/// use papilio_diagnostics::{Diagnostic, Place};
/// let wrong = Diagnostic::new("-5 is out of range").expected("a number from 0 to 1").hint("write 5 % as 0.05");
/// let shown = wrong.at(&Place::in_text("x.toml", "haze = -5", 7..9)).to_string();
/// assert_eq!(
///     shown,
///     "error: -5 is out of range\n --> x.toml:1:8\n  |\n1 | haze = -5\n  |        ^^ expected a number from 0 to 1\n  \
///      = help: write 5 % as 0.05"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// What is wrong: a sentence without a full stop.
    pub message: String,
    /// What was expected at this place, beginning with the word "expected"; printed next to the caret.
    pub expected: Option<String>,
    /// Further information, such as the key that refers to a file.
    pub note: Option<String>,
    /// What the user can do.
    pub hint: Option<String>,
    /// What mends the mistake, after the hint: each interface has its own words for it.
    pub remedies: Vec<Remedy>,
    /// A value that is accepted at this place, as JSON: a program can offer it as a button.
    pub accepted: Option<String>,
}

impl Diagnostic {
    /// Creates a diagnostic with a message alone.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            message: short_numbers(&message.into()).into_owned(),
            expected: None,
            note: None,
            hint: None,
            remedies: Vec::new(),
            accepted: None,
        }
    }

    /// Adds what was expected: `a number from 0 to 1`.
    #[must_use]
    pub fn expected(mut self, words: impl fmt::Display) -> Self {
        self.expected = Some(short_numbers(&format!("expected {words}")).into_owned());
        self
    }

    /// Adds a hint: what the user can do.
    #[must_use]
    pub fn hint(self, hint: impl Into<String>) -> Self {
        self.hint_if(Some(hint))
    }

    /// Sets or clears the hint.
    #[must_use]
    pub fn hint_if(mut self, hint: Option<impl Into<String>>) -> Self {
        self.hint = hint.map(|hint| short_numbers(&hint.into()).into_owned());
        self
    }

    /// Adds a remedy.
    #[must_use]
    pub fn remedy(mut self, remedy: Remedy) -> Self {
        self.remedies.push(remedy);
        self
    }

    /// Returns the hint with the remedies in the words of an interface.
    pub fn help(&self, interface: Interface) -> Option<String> {
        match (&self.hint, Remedy::words(&self.remedies, interface)) {
            (Some(hint), Some(words)) => Some(format!("{hint}: {words}")),
            (hint, words) => words.or_else(|| hint.clone()),
        }
    }

    /// Adds a value that is accepted at this place, as JSON.
    #[must_use]
    pub fn accepted(mut self, json: impl fmt::Display) -> Self {
        self.accepted = Some(json.to_string());
        self
    }

    /// Adds a note after those that the diagnostic already has.
    #[must_use]
    pub fn note(mut self, note: impl AsRef<str>) -> Self {
        let note = short_numbers(note.as_ref());
        self.note = Some(match self.note {
            Some(before) => format!("{before}; {note}"),
            None => note.into_owned(),
        });
        self
    }

    /// Returns the diagnostic with its place. It prints as a compiler's message: with the line of the text
    /// and a caret below it, in the words of the command line, and without a final newline.
    pub fn at<'a>(&'a self, place: &'a Place) -> Placed<'a> {
        Placed { diagnostic: self, place }
    }
}

impl fmt::Display for Diagnostic {
    /// Writes the message alone.
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
        let Self { diagnostic, place } = self;
        let Diagnostic { message, expected, note, hint: _, remedies: _, accepted: _ } = diagnostic;
        let help = diagnostic.help(Interface::CommandLine);
        // Quoted text may hold any character.
        write!(f, "error: {}", in_one_line(message))?;
        let margin = place.spot.as_ref().map_or(1, |spot| spot.line.to_string().len());
        write!(f, "\n{:margin$}--> {}", "", in_one_line(&place.to_string()))?;
        match &place.spot {
            Some(spot) => spot.show(margin, expected.as_deref(), f)?,
            None => write_line("", expected.as_deref(), margin, f)?,
        }
        write_line("note: ", note.as_deref(), margin, f)?;
        write_line("help: ", help.as_deref(), margin, f)
    }
}

/// Writes one line below the quoted text, if there is anything to write.
fn write_line(prefix: &str, text: Option<&str>, margin: usize, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    text.map_or(Ok(()), |text| write!(f, "\n{:margin$} = {prefix}{}", "", visible(text)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagnostic_with_a_place_prints_as_a_compiler_message() {
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

//! Fast reader of the lines and numbers of a text file, with their places.

use std::ops::Range;

use papilio_diagnostics::{Place, Spot};

use super::{BsdfProblem, LARGEST_VALUE, LONGEST_LINE, VALUE_RANGE};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// The bytes of a text. Comments and names may have any encoding; keywords and numbers are ASCII.
#[derive(Clone, Copy)]
pub(super) struct Text<'a> {
    pub(super) name: &'a str,
    pub(super) bytes: &'a [u8],
    /// Whether numbers are written as `0,5`.
    pub(super) decimal_comma: bool,
}

/// Number of bytes of a line that a message shows after the place.
const SHOWN_BEYOND: usize = 200;

impl<'a> Text<'a> {
    pub(super) fn new(file: &'a DataFile) -> Self {
        let bytes = file.bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&file.bytes);
        Self { name: &file.name, bytes, decimal_comma: false }
    }

    /// Returns an error about the bytes `range`.
    pub(super) fn error(&self, range: Range<usize>, problem: impl Into<Problem>) -> FormatError {
        let start = range.start.min(self.bytes.len());
        let line_start = self.bytes[..start].iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let rest = &self.bytes[start..];
        let line_end = start + rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        let end = range.end.clamp(start, line_end);
        let shown = &self.bytes[line_start..line_end.min(end + SHOWN_BEYOND)];
        let characters = |range: Range<usize>| String::from_utf8_lossy(&self.bytes[range]).chars().count();
        let spot = Spot {
            line: count_lines(&self.bytes[..start]) + 1,
            column: characters(line_start..start) + 1,
            width: characters(start..end).max(1),
            text: String::from_utf8_lossy(shown).trim_end().to_owned(),
        };
        FormatError { place: Place { name: self.name.to_owned(), spot: Some(spot) }, problem: problem.into() }
    }

    /// Returns an error about the file as a whole.
    pub(super) fn whole(&self, problem: impl Into<Problem>) -> FormatError {
        FormatError::whole(self.name, problem)
    }

    /// Returns an error about the end of the file.
    pub(super) fn ends(&self, what: &'static str) -> FormatError {
        let end = self.bytes.trim_ascii_end().len();
        self.error(end..end, BsdfProblem::Ends { what })
    }

    /// Returns a part of the text for a message or a remark, at most 200 bytes.
    pub(super) fn quote(&self, range: Range<usize>) -> String {
        const LONGEST: usize = 200;
        let text = String::from_utf8_lossy(&self.bytes[range.start..range.end.min(range.start + LONGEST)]);
        text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
    }

    /// Reads a finite number.
    pub(super) fn number(&self, range: Range<usize>) -> Result<f64, FormatError> {
        let word = std::str::from_utf8(&self.bytes[range.clone()]).ok();
        let parsed = word.and_then(|word| crate::table::number(word, self.decimal_comma));
        match parsed {
            Some(value) if f64::is_finite(value) => Ok(value),
            Some(_) => Err(self.error(range.clone(), Problem::NotFinite { found: self.quote(range) })),
            None if range.is_empty() => Err(self.error(range, Problem::EmptyCell)),
            None => Err(self.error(range.clone(), Problem::NotANumber { found: self.quote(range) })),
        }
    }

    /// Reads a value of a BSDF: a number from 0 to [`LARGEST_VALUE`].
    pub(super) fn value(&self, range: Range<usize>) -> Result<f64, FormatError> {
        match self.number(range.clone())? {
            value if (0.0..=LARGEST_VALUE).contains(&value) => Ok(value),
            value => Err(self.error(
                range,
                Problem::OutOfRange { what: "a value of the BSDF", value, expected: VALUE_RANGE },
            )),
        }
    }

    /// Returns the words of a line, which are separated by blanks, tabs and commas.
    pub(super) fn words(&self, line: Range<usize>) -> Words<'a> {
        Words { bytes: self.bytes, at: line.start, end: line.end }
    }

    /// Returns whether two words are equal, ignoring case.
    pub(super) fn is(&self, word: &Range<usize>, what: &str) -> bool {
        self.bytes[word.clone()].eq_ignore_ascii_case(what.as_bytes())
    }
}

fn count_lines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&b| b == b'\n').count()
}

/// Iterator over the words of a line.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    end: usize,
}

impl Iterator for Words<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        let separates = |b: &u8| matches!(b, b' ' | b'\t' | b',' | b'\r' | b'\n' | 0x0B | 0x0C);
        let line = &self.bytes[self.at..self.end];
        let start = self.at + line.iter().position(|b| !separates(b))?;
        let rest = &self.bytes[start..self.end];
        let end = start + rest.iter().position(separates).unwrap_or(rest.len());
        self.at = end;
        Some(start..end)
    }
}

/// Iterator over the lines of a text, except blank lines and comments.
pub(super) struct Lines<'a> {
    pub(super) text: Text<'a>,
    at: usize,
    /// Comments read so far, without their `#`.
    pub(super) comments: Vec<String>,
}

/// Largest number of comments that are stored.
const MOST_COMMENTS: usize = 200;

impl<'a> Lines<'a> {
    pub(super) fn new(text: Text<'a>) -> Self {
        Self { text, at: 0, comments: Vec::new() }
    }

    /// Returns the next line with content, or `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<Range<usize>>, FormatError> {
        while self.at < self.text.bytes.len() {
            let line = self.line()?;
            let content = self.text.bytes[line.clone()].trim_ascii_start();
            match content.first() {
                None => {}
                Some(b'#') => self.comment(line.end - content.len() + 1..line.end),
                Some(_) => return Ok(Some(line.end - content.len()..line.end)),
            }
        }
        Ok(None)
    }

    /// Returns the next line with content. At the end, fails with "the file ends before `what`".
    pub(super) fn expect(&mut self, what: &'static str) -> Result<Range<usize>, FormatError> {
        self.next()?.ok_or_else(|| self.text.ends(what))
    }

    fn line(&mut self) -> Result<Range<usize>, FormatError> {
        let rest = &self.text.bytes[self.at..];
        let length = rest.iter().take(LONGEST_LINE + 1).position(|&b| b == b'\n');
        let length = length.unwrap_or(rest.len());
        let line = self.at..self.at + length;
        if length > LONGEST_LINE {
            let problem = BsdfProblem::LongLine { limit: LONGEST_LINE };
            return Err(self.text.error(line.start..line.start + 1, problem));
        }
        self.at = line.end + 1;
        Ok(line.start..line.start + self.text.bytes[line].trim_ascii_end().len())
    }

    fn comment(&mut self, range: Range<usize>) {
        let comment = self.text.quote(range);
        if !comment.is_empty() && self.comments.len() < MOST_COMMENTS {
            self.comments.push(comment);
        }
    }
}

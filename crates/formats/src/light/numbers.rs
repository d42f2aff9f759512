//! Numbers of photometric files: separated by blanks, commas and newlines, each with its place.

use std::ops::Range;

use papilio_diagnostics::Place;

use crate::error::{FormatError, Problem};

/// Largest number of vertical, and of horizontal, angles.
const MOST_ANGLES: usize = 2000;

/// Reader of numbers.
pub(super) struct Numbers<'a> {
    pub(super) name: &'a str,
    pub(super) text: &'a str,
    pub(super) at: usize,
    /// Whether a comma separates numbers, as in LM-63, or stands for a decimal point.
    pub(super) comma_separates: bool,
    /// Error of a file that ends early.
    pub(super) cut: fn() -> Problem,
}

impl Numbers<'_> {
    pub(super) fn error(&self, place: Range<usize>, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, place), problem }
    }

    fn separates(&self, c: char) -> bool {
        // Files of DOS may end with a substitute character.
        c.is_whitespace() || c == '\u{1a}' || self.comma_separates && c == ','
    }

    /// Returns the next word and its place; the word is empty at the end.
    pub(super) fn word(&mut self) -> (&str, Range<usize>) {
        let rest = &self.text[self.at..];
        let start = self.at + rest.find(|c| !self.separates(c)).unwrap_or(rest.len());
        let rest = &self.text[start..];
        let word = &rest[..rest.find(|c| self.separates(c)).unwrap_or(rest.len())];
        self.at = start + word.len();
        (word, start..start + word.len())
    }

    pub(super) fn next(&mut self) -> Result<(f64, Range<usize>), FormatError> {
        let comma_separates = self.comma_separates;
        let (word, place) = self.word();
        let word = word.to_owned();
        if word.is_empty() {
            return Err(FormatError::whole(self.name, (self.cut)()));
        }
        let number = if comma_separates { word.parse() } else { word.replace(',', ".").parse::<f64>() };
        match number {
            Ok(number) if number.is_finite() => Ok((number, place)),
            Ok(_) => Err(self.error(place, Problem::NotFinite { found: word })),
            Err(_) => Err(self.error(place, Problem::NotANumber { found: word.chars().take(40).collect() })),
        }
    }

    pub(super) fn within(
        &mut self,
        what: &'static str,
        range: (f64, f64),
        expected: &'static str,
    ) -> Result<f64, FormatError> {
        let (value, place) = self.next()?;
        if (range.0..=range.1).contains(&value) {
            return Ok(value);
        }
        Err(self.error(place, Problem::OutOfRange { what, value, expected }))
    }

    pub(super) fn count(&mut self, what: &'static str) -> Result<usize, FormatError> {
        let (value, place) = self.next()?;
        if value.fract() == 0.0 && (1.0..=MOST_ANGLES as f64).contains(&value) {
            return Ok(value as usize);
        }
        Err(self.error(place, Problem::OutOfRange { what, value, expected: "an integer from 1 to 2000" }))
    }

    /// Reads ascending angles in this range.
    pub(super) fn angles(
        &mut self,
        count: usize,
        what: &'static str,
        range: (f64, f64),
        expected: &'static str,
    ) -> Result<Vec<f64>, FormatError> {
        let mut angles: Vec<f64> = Vec::with_capacity(count);
        for _ in 0..count {
            let (value, place) = self.next()?;
            let ascends = angles.last().is_none_or(|last| *last < value);
            if !ascends || !(range.0..=range.1).contains(&value) {
                return Err(self.error(place, Problem::OutOfRange { what, value, expected }));
            }
            angles.push(value);
        }
        Ok(angles)
    }

    pub(super) fn intensities(&mut self, count: usize, factor: f64) -> Result<Vec<f64>, FormatError> {
        let value = |_| self.within("the intensity", (0.0, 1e12), "an intensity from 0 to 1e12");
        let values: Result<Vec<f64>, FormatError> = (0..count).map(value).collect();
        Ok(values?.into_iter().map(|value| value * factor).collect())
    }

    /// Returns the place of a word that follows the last number.
    pub(super) fn surplus(&mut self) -> Option<Range<usize>> {
        let (word, place) = self.word();
        (!word.is_empty()).then_some(place)
    }
}

//! What is done, kept line by line: a journal is JSON, a line each, first its head and then what is done as it is done.
//!
//! A line without its end was cut off when the program was killed, and counts for nothing. Any other line that is not as it was
//! written is an error: see [`seal`].

mod folder;
mod held;
mod rows;
mod seal;

use std::io::{self, Write};

use papilio_diagnostics::Place;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;

pub use folder::{
    Journals, foreign, journal_name, journal_paths, open_journal, read_journals, tidy_journals, trusted_lines,
};
pub use held::HeldJournal;
pub use rows::{JournalRows, RowsHead};

use seal::Seal;

/// No journal may be larger, in bytes.
pub const LARGEST_JOURNAL: u64 = 4 << 30;

/// A journal as it was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal<H, L> {
    /// What it is of; `None` if even that was cut off.
    pub head: Option<H>,
    /// What is done.
    pub lines: Vec<L>,
    /// Bytes up to the end of the last whole line.
    pub whole: usize,
}

/// Reads a journal; a last line without its end is left out, and all lines of a journal whose head is not `wanted`.
///
/// # Errors
/// A whole line that is not what it should be, with its number.
pub fn read_journal<H: DeserializeOwned, L: DeserializeOwned>(
    file: &DataFile,
    wanted: impl Fn(&H) -> bool,
) -> Result<Journal<H, L>, FormatError> {
    let mut journal = Journal { head: None, lines: Vec::new(), whole: 0 };
    for line in Lines::of(file) {
        match &journal.head {
            None => journal.head = Some(line.read()?),
            Some(head) if !wanted(head) => break,
            Some(_) => journal.lines.push(line.read()?),
        }
        journal.whole += line.bytes.len();
    }
    Ok(journal)
}

/// The whole lines of a journal, one after the other.
struct Lines<'a> {
    file: &'a DataFile,
    next: usize,
    /// Whether the first line has a checksum: then all have one.
    sealed: bool,
}

/// A whole line of a journal, its end included.
struct Line<'a> {
    file: &'a DataFile,
    bytes: &'a [u8],
    from: usize,
    /// Whether it has to have a checksum.
    sealed: bool,
}

impl<'a> Lines<'a> {
    fn of(file: &'a DataFile) -> Self {
        Self { file, next: 0, sealed: false }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let from = self.next;
        let length = self.file.bytes[from..].iter().position(|byte| *byte == b'\n')? + 1;
        let bytes = &self.file.bytes[from..from + length];
        self.next += length;
        if from == 0 {
            self.sealed = seal::seal(bytes) != Seal::None;
        }
        Some(Line { file: self.file, bytes, from, sealed: self.sealed })
    }
}

impl Line<'_> {
    /// What it holds.
    fn read<T: DeserializeOwned>(&self) -> Result<T, FormatError> {
        self.check()?;
        serde_json::from_slice(self.bytes).map_err(|error| self.broken(error.to_string()))
    }

    /// Nothing, if it is as it was written.
    fn check(&self) -> Result<(), FormatError> {
        match seal::seal(self.bytes) {
            Seal::Broken => Err(self.broken("its checksum is that of another line".to_owned())),
            Seal::None if self.sealed => {
                Err(self.broken("it has no checksum, as the first line has".to_owned()))
            }
            Seal::Good | Seal::None => Ok(()),
        }
    }

    /// What is wrong with it, and where it is.
    fn broken(&self, reason: String) -> FormatError {
        let text = String::from_utf8_lossy(&self.file.bytes[..self.from + self.bytes.len()]);
        // What is not UTF-8 is longer as text: the line is the last one of it.
        let from = text.trim_end_matches('\n').rfind('\n').map_or(0, |end| end + 1);
        let problem =
            if self.from == 0 { Problem::BrokenHead { reason } } else { Problem::BrokenLine { reason } };
        FormatError { place: Place::in_text(&self.file.name, &text, from..from + 1), problem }
    }
}

/// Writes a line of a journal, its checksum and its end included.
///
/// # Errors
/// Those of `out`.
pub fn write_journal_line(mut out: impl Write, line: &impl Serialize) -> io::Result<()> {
    // In one piece: another program's reader sees all of a line or nothing.
    let mut text = seal::sealed(serde_json::to_vec(line)?);
    text.push(b'\n');
    out.write_all(&text)
}

/// Numbers that are done, known by the number of their row: a line of a light journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JournalRow {
    /// Which row.
    pub row: usize,
    /// Its numbers.
    pub values: Vec<JournalNumber>,
}

impl JournalRow {
    /// As it was kept.
    pub fn into_numbers(self) -> (usize, Vec<f64>) {
        (self.row, self.values.into_iter().map(|one| one.0).collect())
    }
}

/// A number of a journal: what is read is what was written, to the last bit; null is NaN.
#[derive(Debug, Clone, Copy)]
pub struct JournalNumber(pub f64);

impl PartialEq for JournalNumber {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Serialize for JournalNumber {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.0.is_finite() { serializer.serialize_f64(self.0) } else { serializer.serialize_unit() }
    }
}

impl<'de> Deserialize<'de> for JournalNumber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Serde's own reading of numbers is fast, and a bit off.
        let text = <&RawValue>::deserialize(deserializer)?.get();
        let number = if text == "null" { Ok(f64::NAN) } else { text.parse() };
        number.map(Self).map_err(|_| serde::de::Error::custom("expected a number or null"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_kept_to_the_last_bit() {
        let mut dice = papilio_testing::Dice::new(1, 0);
        let mut values = vec![0.1 + 0.2, -0.0, 5e-324, f64::MAX, 27.123_456_789_012_345, f64::NAN];
        for _ in 0..2000 {
            values.push(f64::from_bits((dice.bits() >> 2) | (1 << 61)));
        }
        let row = JournalRow { row: 3, values: values.into_iter().map(JournalNumber).collect() };
        let mut bytes = Vec::new();
        write_journal_line(&mut bytes, &"head").unwrap();
        write_journal_line(&mut bytes, &row).unwrap();
        let read: Journal<String, JournalRow> =
            read_journal(&DataFile { name: "j".to_owned(), bytes }, |_| true).unwrap();
        let bits = |row: &JournalRow| -> Vec<u64> { row.values.iter().map(|one| one.0.to_bits()).collect() };
        assert_eq!(bits(&read.lines[0]), bits(&row));
    }

    fn read(text: &str) -> Result<Journal<serde_json::Value, JournalRow>, FormatError> {
        read_journal(&DataFile { name: "j".to_owned(), bytes: text.as_bytes().to_vec() }, |_| true)
    }

    /// A digit that was changed in a line that stays JSON is found, with its line; a line that was cut off is not missed.
    #[test]
    fn a_changed_line_is_found_and_a_cut_one_left_out() {
        let mut bytes = Vec::new();
        write_journal_line(&mut bytes, &serde_json::json!({ "of": "this" })).unwrap();
        for row in 0..3 {
            let values = vec![JournalNumber(0.5 + row as f64)];
            write_journal_line(&mut bytes, &JournalRow { row, values }).unwrap();
        }
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(read(&text).unwrap().lines.len(), 3);
        assert_eq!(read(&text[..text.len() - 1]).unwrap().lines.len(), 2);
        let error = read(&text.replace("[1.5]", "[1.7]")).unwrap_err();
        assert_eq!(error.place.line_column(), Some((3, 1)));
        assert!(matches!(error.problem, Problem::BrokenLine { .. }), "{error}");
        assert!(error.to_string().contains("take the line out"), "{error}");
        let error = read(&text.replace("this", "that")).unwrap_err();
        assert!(matches!(error.problem, Problem::BrokenHead { .. }), "{error}");
        // A line that lost its checksum with what it held.
        let from = text.find("\"values\":[1.5]").unwrap();
        let end = from + text[from..].find('\n').unwrap();
        let error = read(&[&text[..from], "\"values\":[9]}", &text[end..]].concat()).unwrap_err();
        assert_eq!(error.place.line_column(), Some((3, 1)));
    }

    /// A journal of a version that wrote no checksums is read, and may go on with lines that have one.
    #[test]
    fn a_journal_without_checksums_goes_on() {
        let old = "{\"of\":\"this\"}\n{\"row\":0,\"values\":[1]}\n";
        let mut bytes = old.as_bytes().to_vec();
        write_journal_line(&mut bytes, &JournalRow { row: 1, values: vec![JournalNumber(2.0)] }).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(read(&text).unwrap().lines.len(), 2);
        assert!(read(&text.replace("[2.0]", "[2.5]")).is_err());
    }
}

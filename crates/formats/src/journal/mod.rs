//! Journals: files in which a study saves each finished result, so that it can be resumed.
//!
//! A journal holds one JSON value per line: first its head, which identifies the computation, then one line
//! per finished result. A last line without a newline was cut off when the program was killed, and is
//! ignored. Any other damaged line is an error: see [`seal`].

mod folder;
mod held;
mod rows;
mod seal;

use std::io::{self, Write};

use papilio_diagnostics::{Diagnostic, Place};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;

use crate::error::FormatError;
use crate::file::DataFile;

pub use folder::{
    Journals, foreign_journal_error, journal_name, journal_paths, open_journal, read_journals,
    read_verified_lines,
};
pub use held::LockedJournal;
pub use rows::{JournalRows, RowsHead, TableHead};

use seal::Checksum;

/// Largest size of a journal, bytes.
pub const LARGEST_JOURNAL: u64 = 4 << 30;

/// Content of a journal.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal<H, L> {
    /// Head: identifies the computation; `None` if the file ends within its first line.
    pub head: Option<H>,
    /// The finished results.
    pub lines: Vec<L>,
    /// Bytes up to the end of the last complete line.
    pub whole: usize,
}

/// Reads a journal. A last line without a newline is ignored. If the head is not `wanted`, no further line is
/// read.
///
/// # Errors
/// If a complete line is malformed or damaged, with its place.
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

/// Iterator over the complete lines of a journal.
struct Lines<'a> {
    file: &'a DataFile,
    next: usize,
    /// Whether the first line has a checksum; then all lines must have one.
    has_checksums: bool,
}

/// A complete line of a journal, newline included.
struct Line<'a> {
    file: &'a DataFile,
    bytes: &'a [u8],
    from: usize,
    /// Whether the line must have a checksum.
    must_have_checksum: bool,
}

impl<'a> Lines<'a> {
    fn of(file: &'a DataFile) -> Self {
        Self { file, next: 0, has_checksums: false }
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
            self.has_checksums = seal::verify(bytes) != Checksum::Absent;
        }
        Some(Line { file: self.file, bytes, from, must_have_checksum: self.has_checksums })
    }
}

impl Line<'_> {
    /// Checks the line and parses it.
    fn read<T: DeserializeOwned>(&self) -> Result<T, FormatError> {
        self.check()?;
        serde_json::from_slice(self.bytes).map_err(|error| self.damaged(error.to_string()))
    }

    /// Fails if the checksum is wrong, or missing although the first line has one.
    fn check(&self) -> Result<(), FormatError> {
        match seal::verify(self.bytes) {
            Checksum::Wrong => Err(self.damaged("its checksum does not match its content".to_owned())),
            Checksum::Absent if self.must_have_checksum => {
                Err(self.damaged("it has no checksum, although the first line has one".to_owned()))
            }
            Checksum::Correct | Checksum::Absent => Ok(()),
        }
    }

    /// Returns an error about this line.
    fn damaged(&self, reason: String) -> FormatError {
        let text = String::from_utf8_lossy(&self.file.bytes[..self.from + self.bytes.len()]);
        // Replacement characters for invalid UTF-8 change the length of the text: the line is found as its
        // last one.
        let from = text.trim_end_matches('\n').rfind('\n').map_or(0, |end| end + 1);
        let wrong = match self.from {
            0 => Diagnostic::new(format!("the first line of this journal is damaged: {reason}")).hint(
                "the first line identifies the computation: restore it from a copy, or move the file to another folder to compute \
                 everything again",
            ),
            _ => Diagnostic::new(format!("this line of a journal is damaged: {reason}")).hint(
                "delete the line from the file (in the journal of a search, optimize.jsonl, also all lines after it) and run the same \
                 command again: the deleted results are computed again, all others are used",
            ),
        };
        let place = Place::in_text(&self.file.name, &text, from..from + 1);
        FormatError { place, problem: wrong.into() }
    }
}

/// Writes a line of a journal, with its checksum and a newline.
///
/// # Errors
/// Those of `out`.
pub fn write_journal_line(out: impl Write, line: &impl Serialize) -> io::Result<()> {
    write_text(out, serde_json::to_vec(line)?)
}

/// Writes the line of a [`JournalRow`]. A kernel has hundred thousands of numbers, most of them zero, for
/// which `serde_json` takes longer than rays take to find them.
fn write_row(out: impl Write, row: usize, values: &[f64]) -> io::Result<()> {
    let mut text = format!("{{\"row\":{row},\"values\":[").into_bytes();
    for run in values.chunk_by(|a, b| a.to_bits() == 0 && b.to_bits() == 0) {
        if run[0].to_bits() == 0 {
            text.extend_from_slice(&b"0.0,".repeat(run.len()));
        } else {
            serde_json::to_writer(&mut text, &JournalNumber(run[0]))?;
            text.push(b',');
        }
    }
    text.pop_if(|last| *last == b',');
    text.extend_from_slice(b"]}");
    write_text(out, text)
}

fn write_text(mut out: impl Write, text: Vec<u8>) -> io::Result<()> {
    // One write: a concurrent reader sees the complete line or nothing.
    let mut text = seal::with_checksum(text);
    text.push(b'\n');
    out.write_all(&text)
}

/// Line of a light journal: the finished numbers of one row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JournalRow {
    /// Index of the row.
    pub row: usize,
    /// Numbers of the row.
    pub values: Vec<JournalNumber>,
}

impl JournalRow {
    /// Returns the index and the numbers of the row.
    pub fn into_numbers(self) -> (usize, Vec<f64>) {
        (self.row, self.values.into_iter().map(|one| one.0).collect())
    }
}

/// A number of a journal. Reading it returns the same bits as were written; null is NaN.
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
        // Serde's own parser of numbers is fast, but may be wrong in the last bit.
        let text = <&RawValue>::deserialize(deserializer)?.get();
        let number = if text == "null" { Ok(f64::NAN) } else { text.parse() };
        number.map(Self).map_err(|_| serde::de::Error::custom("expected a number or null"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_row_read_back_bit_for_bit() {
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

    /// A row that is written without `serde_json` has the same bytes.
    #[test]
    fn row_of_numbers_is_the_line_of_its_row() {
        for values in [&[][..], &[0.0], &[0.0, -0.0, 0.0, f64::NAN, f64::INFINITY, 0.1, 1e300, 5.0]] {
            let (mut row, mut line) = (Vec::new(), Vec::new());
            write_row(&mut row, 7, values).unwrap();
            let values = values.iter().copied().map(JournalNumber).collect();
            write_journal_line(&mut line, &JournalRow { row: 7, values }).unwrap();
            assert_eq!(row, line);
        }
    }

    fn read(text: &str) -> Result<Journal<serde_json::Value, JournalRow>, FormatError> {
        read_journal(&DataFile { name: "j".to_owned(), bytes: text.as_bytes().to_vec() }, |_| true)
    }

    /// A changed digit is found, with its line, even if the line is still JSON; a last line that was cut off
    /// is ignored.
    #[test]
    fn changed_line_is_an_error_and_cut_off_line_is_ignored() {
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
        assert!(error.to_string().contains("this line of a journal is damaged"), "{error}");
        assert!(error.to_string().contains("delete the line from the file"), "{error}");
        let error = read(&text.replace("this", "that")).unwrap_err();
        assert!(error.to_string().contains("the first line of this journal is damaged"), "{error}");
        // A line without its checksum and with a changed value.
        let from = text.find("\"values\":[1.5]").unwrap();
        let end = from + text[from..].find('\n').unwrap();
        let error = read(&[&text[..from], "\"values\":[9]}", &text[end..]].concat()).unwrap_err();
        assert_eq!(error.place.line_column(), Some((3, 1)));
    }

    /// A journal of an earlier version, without checksums, can be read and extended by lines with checksums.
    #[test]
    fn journal_without_checksums_can_be_extended() {
        let old = "{\"of\":\"this\"}\n{\"row\":0,\"values\":[1]}\n";
        let mut bytes = old.as_bytes().to_vec();
        write_journal_line(&mut bytes, &JournalRow { row: 1, values: vec![JournalNumber(2.0)] }).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert_eq!(read(&text).unwrap().lines.len(), 2);
        assert!(read(&text.replace("[2.0]", "[2.5]")).is_err());
    }
}

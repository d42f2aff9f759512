//! What is done, kept line by line: a journal is JSON, a line each, first its head and then what is done as it is done.
//!
//! A line without its end was cut off when the program was killed, and counts for nothing.

mod folder;
mod rows;

use std::io::{self, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::value::RawValue;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::place::Place;

pub use folder::{
    HeldJournal, Journals, foreign, journal_name, journal_paths, open_journal, read_journals, tidy_journals,
    trusted_lines,
};
pub use rows::{JournalRows, RowsHead};

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
    for line in file.bytes.split_inclusive(|byte| *byte == b'\n').take_while(|line| line.ends_with(b"\n")) {
        let at = journal.whole..journal.whole + line.len();
        let wrong = |error: serde_json::Error| {
            let text = String::from_utf8_lossy(&file.bytes[..at.end]);
            let problem = Problem::NotAJournal { reason: error.to_string() };
            FormatError { place: Place::in_text(&file.name, &text, at.start..at.end), problem }
        };
        match &journal.head {
            None => journal.head = Some(serde_json::from_slice(line).map_err(wrong)?),
            Some(head) if !wanted(head) => break,
            Some(_) => journal.lines.push(serde_json::from_slice(line).map_err(wrong)?),
        }
        journal.whole += line.len();
    }
    Ok(journal)
}

/// Writes a line of a journal, its end included.
///
/// # Errors
/// Those of `out`.
pub fn write_journal_line(mut out: impl Write, line: &impl Serialize) -> io::Result<()> {
    // In one piece: another program's reader sees all of a line or nothing.
    let mut text = serde_json::to_vec(line)?;
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
        let mut state = 1_u64;
        let mut values = vec![0.1 + 0.2, -0.0, 5e-324, f64::MAX, 27.123_456_789_012_345, f64::NAN];
        for _ in 0..2000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            values.push(f64::from_bits((state >> 2) | (1 << 61)));
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
}

//! Rows and cells of a text table, with their places.
//!
//! A line is a row. A cell may be in double quotes, as in CSV: separators and
//! blanks inside the quotes belong to the cell, and `""` is a quote.

use std::borrow::Cow;
use std::ops::Range;

use papilio_diagnostics::Place;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// A text whose lines are rows; blank lines are skipped.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

/// A row of cells.
pub(crate) struct Row<'a> {
    pub(crate) table: Table<'a>,
    pub(crate) cells: Vec<Cell<'a>>,
}

/// A cell: its text and its place.
pub(crate) struct Cell<'a> {
    /// Text without its quotes or, if it has none, without blanks around it.
    pub(crate) text: Cow<'a, str>,
    /// Place in the file, bytes.
    place: Range<usize>,
    /// Whether a quote is not closed, or text follows the closing quote.
    has_bad_quotes: bool,
}

impl<'a> Table<'a> {
    pub(crate) fn new(file: &'a DataFile) -> Result<Self, FormatError> {
        Ok(Self { name: &file.name, text: file.text()? })
    }

    /// Returns the rows, comments included. Cells are separated by semicolons, or else by commas, or else by blanks.
    pub(crate) fn rows(self) -> impl Iterator<Item = Row<'a>> {
        let lines = self.text.split_inclusive('\n').scan(0, |next, line| {
            let start = *next;
            *next += line.len();
            Some((start, line))
        });
        let lines = lines.filter(|(_, line)| !line.trim().is_empty());
        lines.map(move |(start, line)| Row { table: self, cells: cells(start, line) })
    }

    /// Returns an error about the whole file.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        FormatError { place: Place::whole(self.name), problem }
    }

    /// Returns an error about the line that holds the byte `at`, from that byte to the end of the line.
    pub(crate) fn error_at_line(&self, at: usize, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, at..self.text.len()), problem }
    }
}

impl Cell<'_> {
    pub(crate) fn is_number(&self) -> bool {
        self.text.parse::<f64>().is_ok()
    }

    /// Returns the start of the cell in the file, bytes.
    pub(crate) fn start(&self) -> usize {
        self.place.start
    }
}

impl Row<'_> {
    /// Returns an error about the whole row.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        FormatError { place: self.place(), problem }
    }

    /// Returns the place of the row in the file.
    pub(crate) fn place(&self) -> Place {
        let start = self.cells.first().map_or(0, |cell| cell.place.start);
        let end = self.cells.last().map_or(0, |cell| cell.place.end);
        Place::in_text(self.table.name, self.table.text, start..end)
    }

    /// Returns an error about cell `i`.
    pub(crate) fn cell_error(&self, i: usize, problem: Problem) -> FormatError {
        match self.cells.get(i) {
            Some(cell) => {
                let place = Place::in_text(self.table.name, self.table.text, cell.place.clone());
                FormatError { place, problem }
            }
            None => self.error(problem),
        }
    }

    /// Returns the finite number in cell `i`.
    pub(crate) fn number(&self, i: usize) -> Result<f64, FormatError> {
        let text = self.cells.get(i).map_or("", |cell| &cell.text);
        let problem = match text.parse::<f64>() {
            Ok(value) if value.is_finite() => return Ok(value),
            Ok(_) => Problem::NotFinite { found: clip(text) },
            Err(_) if text.is_empty() => Problem::EmptyCell,
            Err(_) => Problem::NotANumber { found: clip(text) },
        };
        Err(self.cell_error(i, problem))
    }

    /// Returns whether the row is a header: no cell is a number.
    pub(crate) fn is_header(&self) -> bool {
        !self.cells.iter().any(Cell::is_number)
    }

    /// Returns whether the row begins with `#`. Where names may begin with `#`, this is not sufficient for a comment.
    pub(crate) fn begins_with_hash(&self) -> bool {
        self.cells.first().is_some_and(|cell| self.table.text[cell.place.clone()].starts_with('#'))
    }

    /// Fails unless the row has exactly `count` cells, all with matching quotes.
    pub(crate) fn expect_cells(&self, count: usize, expected: &'static str) -> Result<(), FormatError> {
        if let Some(i) = self.cells.iter().position(|cell| cell.has_bad_quotes) {
            return Err(self.cell_error(i, Problem::Quotes));
        }
        if self.cells.len() == count {
            return Ok(());
        }
        Err(self.error(Problem::Columns { expected, count, found: self.cells.len() }))
    }
}

/// Returns the text of a cell for a message, shortened to 40 characters.
fn clip(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Largest number of cells of a row, far above that of any valid table; the rest of the row is not split.
const MOST_CELLS: usize = 1000;

fn cells(line_start: usize, line: &str) -> Vec<Cell<'_>> {
    let line = line.trim_end_matches(['\n', '\r']);
    let separator = separator(line);
    let mut cells = Vec::new();
    let mut start = 0;
    loop {
        let end = cell_end(line, start, separator);
        let range = trimmed(line, start..end);
        if separator.is_some() || !range.is_empty() {
            cells.push(cell(line_start, line, range));
        }
        match line[end..].chars().next() {
            Some(c) if cells.len() < MOST_CELLS => start = end + c.len_utf8(),
            _ => return cells,
        }
    }
}

/// Returns the separator of the cells: a semicolon if the line has any, or else a comma; `None` means blanks.
fn separator(line: &str) -> Option<char> {
    let (mut at_start, mut is_quoted, mut inside) = (true, false, false);
    let mut found = None;
    for c in line.chars() {
        is_quoted |= at_start && c == '"';
        inside ^= is_quoted && c == '"';
        at_start &= c.is_whitespace();
        match c {
            // In a line with semicolons, a comma is a decimal comma.
            ';' if !inside => return Some(';'),
            ',' if !inside => (found, at_start, is_quoted) = (Some(','), true, false),
            _ => {}
        }
    }
    found
}

/// Returns the end of the cell that begins at `start`: the first separator outside quotes.
fn cell_end(line: &str, start: usize, separator: Option<char>) -> usize {
    let rest = &line[start..];
    let begins = if separator.is_some() { rest.trim_start() } else { rest };
    let is_quoted = begins.starts_with('"');
    let ends = |c: char| separator.map_or(c.is_whitespace(), |s| c == s);
    let mut inside = false;
    let end = rest.char_indices().find(|&(_, c)| {
        // A doubled quote closes and reopens the quotes.
        inside ^= is_quoted && c == '"';
        !inside && ends(c)
    });
    end.map_or(line.len(), |(i, _)| start + i)
}

/// Returns a range of `line` without blanks at its ends.
fn trimmed(line: &str, range: Range<usize>) -> Range<usize> {
    let text = &line[range.clone()];
    let start = range.end - text.trim_start().len();
    start..start + text.trim().len()
}

fn cell(line_start: usize, line: &str, range: Range<usize>) -> Cell<'_> {
    let text = &line[range.clone()];
    let place = line_start + range.start..line_start + range.end;
    let Some(rest) = text.strip_prefix('"') else {
        return Cell { text: text.into(), place, has_bad_quotes: false };
    };
    match rest.strip_suffix('"') {
        Some(inner) => {
            let has_bad_quotes = inner.replace("\"\"", "").contains('"');
            let text = if inner.contains('"') { inner.replace("\"\"", "\"").into() } else { inner.into() };
            Cell { text, place: place.start + 1..place.end - 1, has_bad_quotes }
        }
        None => Cell { text: rest.into(), place, has_bad_quotes: true },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<Vec<Cow<'_, str>>> {
        let table = Table { name: "t", text };
        table.rows().map(|row| row.cells.into_iter().map(|cell| cell.text).collect()).collect()
    }

    #[test]
    fn row_with_any_separator_is_split_into_cells() {
        assert_eq!(
            split("1, 2\r\n\n3;4\n5\t6\n 7   8 \n\"9\" 10"),
            [["1", "2"], ["3", "4"], ["5", "6"], ["7", "8"], ["9", "10"]]
        );
        assert_eq!(split("1,,2,\n"), [["1", "", "2", ""]]);
        assert_eq!(split("\"a, b\",1\n\"a; b\",2"), [["a, b", "1"], ["a; b", "2"]]);
        assert_eq!(split("380;0,5"), [["380", "0,5"]]);
    }

    #[test]
    fn cell_in_quotes_keeps_separators_and_unmatched_quotes_are_refused() {
        assert_eq!(split("\"q\"\"x\"\"\",\" a \", b "), [["q\"x\"", " a ", "b"]]);
        assert_eq!(split("5\" glass,1"), [["5\" glass", "1"]]);
        let has_bad_quotes =
            |text| Table { name: "t", text }.rows().any(|row| row.expect_cells(2, "two").is_err());
        assert!(!has_bad_quotes("\"\"\"\",1"));
        for text in ["\"a,1", "\"a\"b\",1", "\"a\"b,1", "\",1", "1,\"2"] {
            assert!(has_bad_quotes(text), "{text}");
        }
    }

    #[test]
    fn error_about_a_cell_has_its_place() {
        let table = Table { name: "t", text: "# c\n550,  \"nan\"\n" };
        let row = table.rows().nth(1).unwrap();
        assert_eq!(row.number(1).unwrap_err().place.line_column(), Some((2, 8)));
        let last = Table { name: "t", text: "500,\r\n600,1\n" }.rows().next().unwrap();
        let error = last.number(1).unwrap_err();
        assert_eq!((error.place.line_column(), error.problem), (Some((1, 5)), Problem::EmptyCell));
    }
}

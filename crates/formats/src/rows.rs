//! Rows and cells of a text table, each with its place.

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::place::Place;

/// A text whose lines are rows; blank lines and `#` comments are no rows.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
}

/// A row's cells.
pub(crate) struct Row<'a> {
    pub(crate) table: Table<'a>,
    pub(crate) cells: Vec<Cell<'a>>,
}

/// A cell: its text without blanks or quotes, and where that begins.
#[derive(Clone, Copy)]
pub(crate) struct Cell<'a> {
    pub(crate) text: &'a str,
    start: usize,
}

impl<'a> Table<'a> {
    pub(crate) fn new(file: &'a DataFile) -> Result<Self, FormatError> {
        Ok(Self { name: &file.name, text: file.text()? })
    }

    /// The rows, their cells parted by semicolons, or else commas, or else blanks.
    pub(crate) fn rows(self) -> impl Iterator<Item = Row<'a>> {
        let lines = self.text.split_inclusive('\n').scan(0, |next, line| {
            let start = *next;
            *next += line.len();
            Some((start, line))
        });
        let lines = lines.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'));
        lines.map(move |(start, line)| Row { table: self, cells: cells(start, line) })
    }

    /// An error about the whole file.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        FormatError { place: Place::whole(self.name), problem }
    }

    /// An error about the line that holds the byte `at`, from there on.
    pub(crate) fn error_at_line(&self, at: usize, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, at..self.text.len()), problem }
    }
}

impl Cell<'_> {
    /// Where it begins in the file, in bytes.
    pub(crate) fn start(&self) -> usize {
        self.start
    }
}

impl Row<'_> {
    /// An error about the whole row.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        let start = self.cells.first().map_or(0, |cell| cell.start);
        let end = self.cells.last().map_or(0, |cell| cell.start + cell.text.len());
        FormatError { place: Place::in_text(self.table.name, self.table.text, start..end), problem }
    }

    /// An error about cell `i`.
    pub(crate) fn cell_error(&self, i: usize, problem: Problem) -> FormatError {
        match self.cells.get(i) {
            Some(cell) => {
                let range = cell.start..cell.start + cell.text.len();
                FormatError { place: Place::in_text(self.table.name, self.table.text, range), problem }
            }
            None => self.error(problem),
        }
    }

    /// The finite number in cell `i`.
    pub(crate) fn number(&self, i: usize) -> Result<f64, FormatError> {
        let found = || self.cells.get(i).map_or_else(String::new, |cell| clip(cell.text));
        match self.cells.get(i).and_then(|cell| cell.text.parse::<f64>().ok()) {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(self.cell_error(i, Problem::NotFinite { found: found() })),
            None => Err(self.cell_error(i, Problem::NotANumber { found: found() })),
        }
    }

    /// True if the first cell is not a number: the names of the columns.
    pub(crate) fn is_header(&self) -> bool {
        self.cells.first().is_none_or(|cell| cell.text.parse::<f64>().is_err())
    }

    /// Fails unless there are exactly `count` cells.
    pub(crate) fn expect_cells(&self, count: usize, expected: &'static str) -> Result<(), FormatError> {
        if self.cells.len() == count {
            return Ok(());
        }
        Err(self.error(Problem::Columns { expected, found: self.cells.len() }))
    }
}

/// A cell as an error quotes it.
fn clip(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

fn cells(line_start: usize, line: &str) -> Vec<Cell<'_>> {
    // What stands in quotes parts nothing. A comma beside semicolons is a decimal one.
    let bare: String = line.split('"').step_by(2).collect();
    let separator = [';', ','].into_iter().find(|&c| bare.contains(c));
    let mut cells = Vec::new();
    let mut start = 0;
    let mut quoted = false;
    for (i, c) in line.char_indices().chain([(line.len(), '\n')]) {
        quoted ^= c == '"';
        let ends = i == line.len() || (!quoted && separator.map_or(c.is_whitespace(), |s| c == s));
        if ends {
            let text = line[start..i].trim();
            if separator.is_some() || !text.is_empty() {
                let offset = start + (line[start..i].len() - line[start..i].trim_start().len());
                cells.push(unquoted(line_start + offset, text));
            }
            start = (i + c.len_utf8()).min(line.len());
        }
    }
    cells
}

fn unquoted(start: usize, text: &str) -> Cell<'_> {
    match text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        Some(inner) => Cell { text: inner, start: start + 1 },
        None => Cell { text, start },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(text: &str) -> Vec<Vec<&str>> {
        let table = Table { name: "t", text };
        table.rows().map(|row| row.cells.iter().map(|cell| cell.text).collect()).collect()
    }

    #[test]
    fn separators() {
        assert_eq!(
            split("# c\n1, 2\r\n\n3;4\n5\t6\n 7   8 "),
            [["1", "2"], ["3", "4"], ["5", "6"], ["7", "8"]]
        );
        assert_eq!(split("1,,2,\n"), [["1", "", "2", ""]]);
        assert_eq!(split("\"a, b\",1\n\"a; b\",2"), [["a, b", "1"], ["a; b", "2"]]);
        assert_eq!(split("380;0,5"), [["380", "0,5"]]);
    }

    #[test]
    fn a_cell_knows_its_place() {
        let table = Table { name: "t", text: "# c\n550,  \"nan\"\n" };
        let row = table.rows().next().unwrap();
        assert_eq!(row.number(1).unwrap_err().place.line_column(), Some((2, 8)));
    }
}

//! Rows and cells of a text table, with their places.
//!
//! A line is a row. A cell may be in double quotes, as in CSV: separators and
//! blanks inside the quotes belong to the cell, and `""` is a quote.

use std::borrow::Cow;
use std::ops::Range;

use papilio_diagnostics::{Diagnostic, Place};

use super::dialect::{self, Dialect};
use super::encoding;
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// The decoded text of a file, whose lines are rows.
pub(crate) struct TableText<'a> {
    name: &'a str,
    text: Cow<'a, str>,
    dialect: Dialect,
}

impl<'a> TableText<'a> {
    /// Decodes a file in any of the supported encodings and finds its separator and decimal mark.
    pub(crate) fn new(file: &'a DataFile) -> Result<Self, FormatError> {
        let text =
            encoding::decode(&file.bytes).ok_or_else(|| FormatError::whole(&file.name, Problem::NotText))?;
        let dialect = Dialect::of(&text);
        Ok(Self { name: &file.name, text, dialect })
    }

    pub(crate) fn table(&self) -> Table<'_> {
        Table { name: self.name, text: &self.text, dialect: self.dialect }
    }
}

/// A text whose lines are rows; blank lines are skipped.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    pub(crate) name: &'a str,
    pub(crate) text: &'a str,
    pub(crate) dialect: Dialect,
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
    /// Whether the cell is in quotes.
    pub(crate) is_quoted: bool,
    /// Place in the file, bytes.
    place: Range<usize>,
    /// Whether a quote is not closed, or text follows the closing quote.
    has_bad_quotes: bool,
}

impl<'a> Table<'a> {
    /// Returns the rows, comments included.
    pub(crate) fn rows(self) -> impl Iterator<Item = Row<'a>> {
        let lines = self.text.split_inclusive('\n').scan(0, |next, line| {
            let start = *next;
            *next += line.len();
            Some((start, line))
        });
        // Programs of DOS end a file with the character 0x1A.
        let is_empty =
            |line: &str| line.trim_matches(|c: char| c.is_whitespace() || c == '\u{1A}').is_empty();
        let has_content = move |(start, line): &(usize, &str)| {
            !is_empty(line) && (*start > 0 || dialect::directive(line).is_none())
        };
        let separator = self.dialect.separator;
        lines
            .filter(has_content)
            .map(move |(start, line)| Row { table: self, cells: cells(start, line, separator) })
    }

    /// Returns the rows that are no comments.
    pub(crate) fn data(self) -> impl Iterator<Item = Row<'a>> {
        self.rows().filter(|row| !row.is_comment())
    }

    /// Returns the line at a range of bytes as a row.
    pub(crate) fn row_at(self, line: Range<usize>) -> Row<'a> {
        let cells = cells(line.start, &self.text[line], self.dialect.separator);
        Row { table: self, cells }
    }

    /// Returns an error about the whole file.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        FormatError::whole(self.name, problem)
    }

    /// Returns an error about a range of bytes.
    pub(crate) fn error_at(&self, at: Range<usize>, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, at), problem }
    }

    /// Returns an error about the line that holds the byte `at`, from that byte to the end of the line.
    pub(crate) fn error_at_line(&self, at: usize, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, at..self.text.len()), problem }
    }
}

impl Cell<'_> {
    /// Returns the start of the cell in the file, bytes.
    pub(crate) fn start(&self) -> usize {
        self.place.start
    }

    /// Returns the place of the cell in the file, bytes.
    pub(crate) fn bytes(&self) -> Range<usize> {
        self.place.clone()
    }
}

impl<'a> Row<'a> {
    /// Returns an error about the whole row.
    pub(crate) fn error(&self, problem: Problem) -> FormatError {
        FormatError { place: self.place(), problem }
    }

    /// Returns the place of the row in the file.
    pub(crate) fn place(&self) -> Place {
        Place::in_text(self.table.name, self.table.text, self.bytes())
    }

    /// Returns the place of the row in the file, bytes.
    pub(crate) fn bytes(&self) -> Range<usize> {
        let start = self.cells.first().map_or(0, |cell| cell.place.start);
        let end = self.cells.last().map_or(0, |cell| cell.place.end);
        start..end
    }

    /// Returns the number of the row's line, from 1.
    pub(crate) fn line(&self) -> usize {
        self.table.text[..self.bytes().start].matches('\n').count() + 1
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

    /// Returns whether cell `i` is a number.
    pub(crate) fn is_number(&self, i: usize) -> bool {
        let dialect = self.table.dialect;
        self.cells.get(i).is_some_and(|cell| dialect::number(&cell.text, dialect.decimal_comma).is_some())
    }

    /// Returns the finite number in cell `i`.
    pub(crate) fn number(&self, i: usize) -> Result<f64, FormatError> {
        let text = self.cells.get(i).map_or("", |cell| &cell.text);
        let problem = match dialect::number(text, self.table.dialect.decimal_comma) {
            Some(value) if value.is_finite() => return Ok(value),
            Some(_) => Problem::NotFinite { found: clip(text) },
            None if text.is_empty() => Problem::EmptyCell,
            None if is_missing(text) => Problem::MissingValue { found: clip(text) },
            None => Problem::NotANumber { found: clip(text) },
        };
        Err(self.cell_error(i, problem))
    }

    /// Returns whether the row is a header: no cell is a number.
    pub(crate) fn is_header(&self) -> bool {
        !(0..self.cells.len()).any(|cell| self.is_number(cell))
    }

    /// Returns whether the row is a comment. Where names may begin with `#`, this is not sufficient.
    pub(crate) fn is_comment(&self) -> bool {
        self.cells.first().is_some_and(|cell| is_comment_line(&self.table.text[cell.place.start..]))
    }

    /// Returns the cells of a comment without its mark, separated as the rows are, or else by blanks if those
    /// give `count` cells.
    pub(crate) fn uncommented(&self, count: usize) -> Option<Row<'a>> {
        let bytes = self.bytes();
        let line = &self.table.text[bytes.clone()];
        let inside = line.trim_start_matches(['#', '!', '%', '/']);
        let start = bytes.end - inside.len();
        [self.table.dialect.separator, None]
            .into_iter()
            .map(|separator| Row { table: self.table, cells: cells(start, inside, separator) })
            .find(|row| row.cells.len() == count)
    }

    /// Fails unless the row has exactly `count` cells, all with matching quotes.
    pub(crate) fn expect_cells(&self, count: usize, expected: &'static str) -> Result<(), FormatError> {
        if let Some(i) = self.cells.iter().position(|cell| cell.has_bad_quotes) {
            let wrong = Diagnostic::new("the quotation marks of this cell do not match").hint(
                "begin and end a quoted cell with a double quote; write a double quote inside it twice",
            );
            return Err(self.cell_error(i, wrong.into()));
        }
        if self.cells.len() == count {
            return Ok(());
        }
        Err(self.error(Problem::Columns { expected, count, found: self.cells.len() }))
    }
}

/// Returns whether a line is a comment: it begins with `#`, `!`, `//`, `%%` or `%` and a blank.
pub(crate) fn is_comment_line(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "!", "//", "%%", "% ", "%\t"].iter().any(|mark| line.starts_with(mark))
}

/// Returns whether a text stands for a value that was not measured.
pub(crate) fn is_missing(text: &str) -> bool {
    const MARKS: [&str; 12] = ["", "-", "--", "---", "*", "?", "na", "n/a", "#n/a", "nan", "null", "none"];
    MARKS.iter().any(|mark| text.trim().eq_ignore_ascii_case(mark))
}

/// Returns the text of a cell for a message, shortened to 40 characters.
pub(crate) fn clip(text: &str) -> String {
    match text.char_indices().nth(40) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Largest number of cells of a row, far above that of any valid table; the rest of the row is not split.
const MOST_CELLS: usize = 5000;

pub(super) fn cells(line_start: usize, line: &str, separator: Option<char>) -> Vec<Cell<'_>> {
    let line = line.trim_end_matches(['\n', '\r', '\u{1A}']);
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

/// Returns the end of the cell that begins at `start`: the first separator outside quotes.
fn cell_end(line: &str, start: usize, separator: Option<char>) -> usize {
    let rest = &line[start..];
    // Blanks before a quote belong to the cell, unless they separate cells.
    let is_blank = |c: char| c.is_whitespace() && separator.is_some_and(|separator| separator != c);
    let is_quoted = rest.trim_start_matches(is_blank).starts_with('"');
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
        return Cell { text: text.into(), is_quoted: false, place, has_bad_quotes: false };
    };
    match rest.strip_suffix('"') {
        Some(inner) => {
            let has_bad_quotes = inner.replace("\"\"", "").contains('"');
            let text = if inner.contains('"') { inner.replace("\"\"", "\"").into() } else { inner.into() };
            Cell { text, is_quoted: true, place: place.start + 1..place.end - 1, has_bad_quotes }
        }
        None => Cell { text: rest.into(), is_quoted: true, place, has_bad_quotes: true },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Table<'_> {
        Table { name: "t", text, dialect: Dialect::of(text) }
    }

    fn split(text: &str) -> Vec<Vec<Cow<'_, str>>> {
        table(text).rows().map(|row| row.cells.into_iter().map(|cell| cell.text).collect()).collect()
    }

    #[test]
    fn row_with_any_separator_is_split_into_cells() {
        assert_eq!(split("1, 2\r\n\n3,4"), [["1", "2"], ["3", "4"]]);
        assert_eq!(split("3;4\n5;0,6"), [["3", "4"], ["5", "0,6"]]);
        assert_eq!(split("5\t6\n7\t\n9\t1"), [["5", "6"], ["7", ""], ["9", "1"]]);
        assert_eq!(split(" 7   8 \n\"9\" 10"), [["7", "8"], ["9", "10"]]);
        assert_eq!(split("1,,2,\n"), [["1", "", "2", ""]]);
        assert_eq!(split("\"a, b\",1\n\"a; b\",2"), [["a, b", "1"], ["a; b", "2"]]);
        assert_eq!(split("sep=;\n380;0,5\n\u{1A}"), [["380", "0,5"]]);
    }

    #[test]
    fn cell_in_quotes_keeps_separators_and_unmatched_quotes_are_refused() {
        assert_eq!(split("\"q\"\"x\"\"\",\" a \", b "), [["q\"x\"", " a ", "b"]]);
        assert_eq!(split("5\" glass,1"), [["5\" glass", "1"]]);
        let has_bad_quotes = |text| table(text).rows().any(|row| row.expect_cells(2, "two").is_err());
        assert!(!has_bad_quotes("\"\"\"\",1"));
        for text in ["\"a,1", "\"a\"b\",1", "\"a\"b,1", "\",1", "1,\"2"] {
            assert!(has_bad_quotes(text), "{text}");
        }
    }

    #[test]
    fn error_about_a_cell_has_its_place() {
        let row = table("# c\n550,  \"nan\"\n").rows().nth(1).unwrap();
        assert_eq!(row.number(1).unwrap_err().place.line_column(), Some((2, 8)));
        assert_eq!(row.line(), 2);
        let last = table("500,\r\n600,1\n").rows().next().unwrap();
        let error = last.number(1).unwrap_err();
        assert_eq!((error.place.line_column(), error.problem), (Some((1, 5)), Problem::EmptyCell));
        let missing = table("500,N/A\n600,1\n").rows().next().unwrap().number(1).unwrap_err();
        assert_eq!(missing.problem, Problem::MissingValue { found: "N/A".to_owned() });
    }

    #[test]
    fn comment_gives_its_cells() {
        let rows: Vec<Row<'_>> = table("# nm k n\n% a, b\n400,1,2\n500,1,2\n").rows().collect();
        let names: Vec<Cow<'_, str>> =
            rows[0].uncommented(3).unwrap().cells.into_iter().map(|c| c.text).collect();
        assert_eq!(names, ["nm", "k", "n"]);
        assert!(rows[1].is_comment() && rows[1].uncommented(3).is_none() && !rows[2].is_comment());
    }
}

//! Texts of heights: rows of a map, or points x, y, z in any order, below lines that state sizes and units.
//!
//! Numbers may have decimal points or commas, and are separated by semicolons, tabs, commas or blanks.
//! Lengths without a unit are in um.

use std::borrow::Cow;
use std::ops::Range;

use papilio_diagnostics::{Diagnostic, Place};

use super::header::{Header, shown};
use super::text::{Style, decoded};
use super::{HeightFile, MOST_HEIGHTS, not_a_map, points, wrong_size, wyko, zygo};
use crate::DataFile;
use crate::error::{FormatError, Problem};

/// Most columns of a row, as many as heights of a square map of the largest size and some more.
const MOST_COLUMNS: usize = 1 << 16;

/// A text, for errors with their place.
pub(super) struct Source<'a> {
    pub(super) name: &'a str,
    pub(super) text: Cow<'a, str>,
}

impl Source<'_> {
    pub(super) fn error(&self, at: Range<usize>, problem: impl Into<Problem>) -> FormatError {
        FormatError { place: Place::in_text(self.name, &self.text, at), problem: problem.into() }
    }

    pub(super) fn whole(&self, problem: impl Into<Problem>) -> FormatError {
        FormatError::whole(self.name, problem)
    }

    /// Lines, each with its first byte.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.split_inclusive(['\n', '\r']).scan(0, |next, line| {
            let start = *next;
            *next += line.len();
            Some((start, line.trim_end()))
        })
    }
}

/// Rows of numbers, all of the same length, NaN where one is missing.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) columns: usize,
    pub(super) numbers: Vec<f64>,
}

impl Rows {
    pub(super) fn count(&self) -> usize {
        self.numbers.len().checked_div(self.columns).unwrap_or(0)
    }
}

/// Reads a map.
pub(super) fn read(file: &DataFile) -> Result<HeightFile, FormatError> {
    let whole = |problem: Diagnostic| FormatError::whole(&file.name, problem);
    let source = Source { name: &file.name, text: decoded(&file.bytes).map_err(whole)? };
    if zygo::is_zygo(&source.text) {
        return zygo::read(&source);
    }
    if wyko::is_wyko(&source.text) {
        return wyko::read(&source.text).map_err(whole);
    }
    let (mut header, rows) = rows(&source)?;
    header.take_names(rows.columns);
    let is_list = points::are_points(&header, &rows).map_err(whole)?;
    let map = if is_list { points::map(&header, &rows) } else { matrix(&header, rows) };
    let mut map = map.map_err(whole)?;
    if !header.unused.is_empty() {
        map.warnings.push(format!("lines of the header that are not used: `{}`", header.unused.join("`, `")));
    }
    Ok(map)
}

/// The header and the rows.
fn rows(source: &Source<'_>) -> Result<(Header, Rows), FormatError> {
    let style = Style::of(&source.text);
    let (mut header, mut rows) = (Header::default(), Rows::default());
    let mut cells = Vec::new();
    for (start, line) in source.lines() {
        let line_at = start..start + line.len();
        let bare = line.trim_start();
        if bare.is_empty() {
            continue;
        }
        if let Some(comment) = bare.strip_prefix(['#', '%', '!']).or_else(|| bare.strip_prefix("//")) {
            let read = header.read(comment.trim_start_matches('#'), true);
            read.map_err(|what| source.error(line_at, text_problem(what)))?;
            continue;
        }
        style.cells(line, &mut cells);
        if rows.columns == 0 && !is_row(&style, &cells) {
            header.read(bare, false).map_err(|what| source.error(line_at, text_problem(what)))?;
            continue;
        }
        if rows.columns == 0 {
            rows.columns = cells.len();
        }
        if cells.len() != rows.columns || cells.len() > MOST_COLUMNS {
            let problem = Problem::Columns {
                expected: "as many numbers as the first row",
                count: rows.columns,
                found: cells.len(),
            };
            return Err(source.error(line_at, problem));
        }
        for (at, cell) in &cells {
            let number = style.number(cell).ok_or_else(|| {
                let at = start + at;
                source.error(at..at + cell.len(), Problem::NotANumber { found: shown(cell) })
            })?;
            rows.numbers.push(if Some(number) == header.missing { f64::NAN } else { number });
        }
        // Points take three numbers each.
        if rows.numbers.len() > 4 * MOST_HEIGHTS {
            return Err(source.whole(wrong_size(rows.columns, rows.count())));
        }
    }
    if rows.columns == 0 {
        return Err(source.whole(not_a_map()));
    }
    Ok((header, rows))
}

fn text_problem(what: String) -> Diagnostic {
    Diagnostic::new(what).expected("a line such as `Width: 100 um`, `X Pixels = 512` or `Value units: nm`")
}

/// Whether a line before the first row is a row: numbers, or words for missing ones.
fn is_row(style: &Style, cells: &[(usize, &str)]) -> bool {
    let are_numbers = cells.iter().all(|(_, cell)| style.number(cell).is_some());
    are_numbers && cells.iter().any(|(_, cell)| !cell.is_empty())
}

/// Rows of a map.
fn matrix(header: &Header, rows: Rows) -> Result<HeightFile, Diagnostic> {
    let Rows { mut columns, numbers } = rows;
    let wrong = |what: String, expected: &str| Diagnostic::new(what).expected(expected);
    if let [Some(x), Some(y)] = header.count {
        if x * y != numbers.len() {
            let what = format!("the header states {x} x {y} heights, and the file has {}", numbers.len());
            return Err(wrong(what, "as many heights as the header states"));
        }
        columns = x;
    } else if let Some(x) = header.count[0].filter(|x| *x != columns) {
        return Err(wrong(
            format!("the header states {x} columns, and the rows have {columns}"),
            "equal numbers",
        ));
    } else if let Some(y) = header.count[1].filter(|y| y * columns != numbers.len()) {
        let what = format!("the header states {y} rows, and the file has {}", numbers.len() / columns);
        return Err(wrong(what, "equal numbers"));
    }
    let rows = numbers.len() / columns;
    let mut map = HeightFile::plain(columns, numbers).upside_down();
    let pitch_um = [header.pitch_um(0, columns), header.pitch_um(1, rows)];
    let either = pitch_um[0].or(pitch_um[1]);
    map.pitch_um = either.map(|either| pitch_um.map(|pitch| pitch.unwrap_or(either)));
    if header.lacks_a_unit() {
        map.warnings.push("the header states lengths without a unit: um are taken".to_owned());
    }
    map.unit_um = match (header.unit_um[2], header.factor) {
        (None, None) => None,
        (unit, factor) => Some(unit.unwrap_or(1.0) * factor.unwrap_or(1.0)),
    };
    if map.unit_um.is_none() && map.pitch_um.is_some() {
        map.warnings.push("the header states no unit of the heights: um are taken".to_owned());
    }
    Ok(map)
}

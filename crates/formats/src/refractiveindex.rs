//! The YAML pages of refractiveindex.info.
//!
//! A page has a `DATA` list whose entries are `tabulated nk`, `tabulated n`,
//! `tabulated k` (rows of um and values) or `formula 1` to `formula 9` (their
//! arithmetic is [`Dispersion::formula`]'s); n and k may come from two entries
//! with ranges of their own. Entries of n2, the non-linear index, are ignored.

use papilio_spectra::{Dispersion, Tabulated};
use serde::Deserialize;
use serde_saphyr::Spanned;

use crate::error::{FormatError, Problem};
use crate::place::Place;
use crate::rows::Table;
use crate::spectrum::Columns;

/// True if the text has a `DATA` list at its outermost level.
pub(crate) fn is_page(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("DATA:"))
}

#[derive(Deserialize)]
struct Page {
    #[serde(rename = "DATA")]
    data: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    r#type: Spanned<String>,
    #[serde(alias = "range")]
    wavelength_range: Option<Spanned<String>>,
    coefficients: Option<Spanned<String>>,
    data: Option<Spanned<String>>,
}

/// Where n comes from.
enum Source<'a> {
    Table(Tabulated),
    Formula(u8, &'a Entry),
}

pub(crate) fn read(file: Table<'_>) -> Result<Dispersion, FormatError> {
    let page: Page = serde_saphyr::from_str(file.text).map_err(|e| not_a_page(file, &e))?;
    let (mut n, mut k) = (None, None);
    for entry in &page.data {
        let kind = entry.r#type.value.trim();
        match kind.split_once(' ') {
            _ if kind.ends_with("n2") => {}
            Some(("tabulated", "nk")) => {
                let [table_n, table_k] = entry.table::<2>(file)?;
                set(&mut n, Source::Table(table_n), file, entry)?;
                set(&mut k, table_k, file, entry)?;
            }
            Some(("tabulated", "n")) => {
                let [table] = entry.table::<1>(file)?;
                set(&mut n, Source::Table(table), file, entry)?;
            }
            Some(("tabulated", "k")) => {
                let [table] = entry.table::<1>(file)?;
                set(&mut k, table, file, entry)?;
            }
            Some(("formula", number)) if matches!(number.parse::<u8>(), Ok(1..=9)) => {
                let number = number.parse().unwrap_or_default();
                set(&mut n, Source::Formula(number, entry), file, entry)?;
            }
            _ => return Err(at(file, &entry.r#type, Problem::UnknownData { found: kind.to_owned() })),
        }
    }
    match n {
        Some(Source::Table(n)) => Dispersion::tabulated(n, k).map_err(|e| file.error(e.into())),
        Some(Source::Formula(number, entry)) => entry.formula(number, k, file),
        None => Err(file.error(Problem::NoIndex)),
    }
}

fn set<T>(slot: &mut Option<T>, value: T, file: Table<'_>, entry: &Entry) -> Result<(), FormatError> {
    if slot.replace(value).is_none() {
        return Ok(());
    }
    let message = "the same quantity is given twice".to_owned();
    Err(at(file, &entry.r#type, Problem::Yaml { message }))
}

impl Entry {
    /// The rows of `data` as `N` tables against nm.
    fn table<const N: usize>(&self, file: Table<'_>) -> Result<[Tabulated; N], FormatError> {
        let data = self.needs(self.data.as_ref(), "data", file)?;
        let mut columns = Columns::<N>::default();
        for row in data.value.lines().filter(|row| !row.trim().is_empty()) {
            let numbers = numbers(row).map_err(|problem| at_row(file, data, row, problem))?;
            if numbers.len() != N + 1 {
                let expected =
                    if N == 2 { "expected three: um, n, k" } else { "expected two: um and the value" };
                return Err(at_row(
                    file,
                    data,
                    row,
                    Problem::Columns { expected, count: N + 1, found: numbers.len() },
                ));
            }
            let values = std::array::from_fn(|i| numbers[i + 1]);
            let added = columns.add(nm_from_um(numbers[0]), values);
            added.map_err(|problem| at_row(file, data, row, problem))?;
        }
        columns.into_tables().map_err(|problem| at(file, data, problem))
    }

    fn formula(&self, number: u8, k: Option<Tabulated>, file: Table<'_>) -> Result<Dispersion, FormatError> {
        let coefficients = self.needs(self.coefficients.as_ref(), "coefficients", file)?;
        let range = self.needs(self.wavelength_range.as_ref(), "wavelength_range", file)?;
        let values = numbers(&coefficients.value).map_err(|problem| at(file, coefficients, problem))?;
        let [first, last] = numbers(&range.value).map_err(|problem| at(file, range, problem))?[..] else {
            return Err(at(file, range, Problem::Yaml { message: "a range has two ends, in um".to_owned() }));
        };
        Dispersion::formula(number, &values, (nm_from_um(first), nm_from_um(last)), k)
            .map_err(|e| at(file, coefficients, e.into()))
    }

    fn needs<'a, T>(&self, part: Option<&'a T>, key: &str, file: Table<'_>) -> Result<&'a T, FormatError> {
        let message = || format!("this entry has no `{key}`");
        part.ok_or_else(|| at(file, &self.r#type, Problem::Yaml { message: message() }))
    }
}

fn numbers(text: &str) -> Result<Vec<f64>, Problem> {
    let number = |word: &str| match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Problem::NotFinite { found: word.to_owned() }),
        Err(_) => Err(Problem::NotANumber { found: word.chars().take(40).collect() }),
    };
    text.split_whitespace().map(number).collect()
}

/// To the nearest 1e-6 nm, so that .57 um is 570 nm and not a little less.
fn nm_from_um(um: f64) -> f64 {
    (um * 1e9).round() / 1e6
}

/// An error at a value of the page.
fn at<T>(file: Table<'_>, value: &Spanned<T>, problem: Problem) -> FormatError {
    at_line_column(file, value.referenced.line(), value.referenced.column(), problem)
}

fn at_line_column(file: Table<'_>, line: u64, column: u64, problem: Problem) -> FormatError {
    let wanted = usize::try_from(line).unwrap_or(usize::MAX).saturating_sub(1);
    let start = file.text.split_inclusive('\n').take(wanted).map(str::len).sum::<usize>();
    let rest = file.text.get(start..).unwrap_or_default();
    let skip = usize::try_from(column).unwrap_or(usize::MAX).saturating_sub(1);
    let offset = rest.char_indices().nth(skip).map_or(0, |(i, _)| i);
    FormatError { place: Place::in_text(file.name, file.text, start + offset..file.text.len()), problem }
}

/// An error at a row of a block of text; the parser says only where the block begins.
fn at_row(file: Table<'_>, block: &Spanned<String>, row: &str, problem: Problem) -> FormatError {
    let first = usize::try_from(block.referenced.line()).unwrap_or(usize::MAX).saturating_sub(1);
    let mut start = 0;
    for (i, line) in file.text.split_inclusive('\n').enumerate() {
        if i >= first && line.trim() == row.trim() {
            let start = start + line.len() - line.trim_start().len();
            return FormatError {
                place: Place::in_text(file.name, file.text, start..start + row.trim().len()),
                problem,
            };
        }
        start += line.len();
    }
    at(file, block, problem)
}

fn not_a_page(file: Table<'_>, error: &serde_saphyr::Error) -> FormatError {
    let error = error.without_snippet();
    let message = error.to_string().lines().next().unwrap_or_default().to_owned();
    match error.location() {
        Some(place) => at_line_column(file, place.line(), place.column(), Problem::Yaml { message }),
        None => file.error(Problem::Yaml { message }),
    }
}

//! YAML pages of refractiveindex.info.
//!
//! A page has a list `DATA` whose entries are `tabulated nk`, `tabulated n`,
//! `tabulated k` (rows of wavelengths in um and values) or `formula 1` to `formula 9` (evaluated
//! by [`Dispersion::formula`]). n and k may come from two entries
//! with separate ranges. Entries of n2, the non-linear index, are ignored.
//!
//! A caller that needs only some wavelengths can read a page whose errors (a repeated or unsorted wavelength,
//! a negative n or k, two entries for n or k) do not affect them.

use std::ops::Range;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_spectra::{Dispersion, Tabulated};

mod download;
mod page;

pub(crate) use self::download::{are_um, is_download, read_download};
use self::page::{Entry, Value, fault};
use crate::error::{FormatError, Problem};
use crate::spectrum::Columns;
use crate::table::Table;
use papilio_diagnostics::Warned;

/// Returns whether the text has a key `DATA` at its outermost level.
pub(crate) fn is_page(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("DATA:"))
}

/// Data of n or of k in an entry.
enum Source<'a> {
    Table(Rows<'a>),
    Formula(u8, &'a Entry<'a>),
}

/// One quantity of an entry, with the range of its wavelengths.
struct Quantity<'a> {
    entry: &'a Entry<'a>,
    source: Source<'a>,
    range_nm: (f64, f64),
}

/// The quantities of a page; several for n or for k if several entries hold it.
#[derive(Default)]
struct Quantities<'a> {
    n: Vec<Quantity<'a>>,
    k: Vec<Quantity<'a>>,
}

/// Reads a page. A fault that does not affect the wavelengths from `wanted_nm.0` to `wanted_nm.1` becomes a
/// note; without a wanted range, every fault is an error.
pub(crate) fn read(
    file: Table<'_>,
    wanted_nm: Option<(f64, f64)>,
) -> Result<Warned<Dispersion>, FormatError> {
    let entries = page::entries(file)?;
    let Quantities { n, k } = quantities(&entries, file)?;
    let mut reading = Reading { file, wanted_nm, notes: Vec::new() };
    let k = match reading.choose(k, "k")? {
        Some(Quantity { source: Source::Table(rows), .. }) => Some(reading.table(&rows)?),
        _ => None,
    };
    let value = match reading.choose(n, "n")? {
        Some(Quantity { source: Source::Table(rows), .. }) => {
            let n = reading.table(&rows)?;
            Dispersion::tabulated(n, k).map_err(|e| file.error(e.into()))?
        }
        Some(Quantity { source: Source::Formula(number, entry), range_nm, .. }) => {
            entry.formula(number, range_nm, k, file)?
        }
        None => {
            let wrong = Diagnostic::new("no entry of `DATA` holds the refractive index n");
            let expected = "an entry of type `tabulated nk`, `tabulated n` or `formula 1` to `formula 9`";
            return Err(file.error(wrong.expected(expected).into()));
        }
    };
    Ok(Warned { value, warnings: reading.notes })
}

fn quantities<'a>(entries: &'a [Entry<'a>], file: Table<'a>) -> Result<Quantities<'a>, FormatError> {
    let mut found = Quantities::default();
    for entry in entries {
        let named = entry.kind(file)?;
        let kind = named.text.trim();
        let table = |column, what| entry.rows(column, what, file).map(|rows| entry.table(rows));
        match kind.split_once(' ') {
            _ if kind.ends_with("n2") => {}
            Some(("tabulated", "nk")) => {
                found.n.push(table((0, 2), "n")?);
                found.k.push(table((1, 2), "k")?);
            }
            Some(("tabulated", "n")) => found.n.push(table((0, 1), "n")?),
            Some(("tabulated", "k")) => found.k.push(table((0, 1), "k")?),
            Some(("formula", number)) if matches!(number.parse::<u8>(), Ok(1..=9)) => {
                let source = Source::Formula(number.parse().unwrap_or_default(), entry);
                found.n.push(Quantity { entry, source, range_nm: entry.range(file)? });
            }
            _ => {
                let wrong = Diagnostic::new(format!("`{kind}` is not a known type of optical data"));
                let expected = "`tabulated nk`, `tabulated n`, `tabulated k` or `formula 1` to `formula 9`";
                return Err(error_at(file, named, wrong.expected(expected).into()));
            }
        }
    }
    Ok(found)
}

/// State of the reading of a page.
struct Reading<'a> {
    file: Table<'a>,
    wanted_nm: Option<(f64, f64)>,
    notes: Vec<String>,
}

impl Reading<'_> {
    /// Returns the only entry that holds a quantity. Of several entries, returns the only one with
    /// wavelengths in the wanted range.
    fn choose<'a>(
        &mut self,
        mut quantities: Vec<Quantity<'a>>,
        what: &str,
    ) -> Result<Option<Quantity<'a>>, FormatError> {
        let count = quantities.len();
        if count > 1
            && let Some((first, last)) = self.wanted_nm
        {
            let touches = |one: &Quantity<'_>| one.range_nm.0 <= last && one.range_nm.1 >= first;
            if quantities.iter().filter(|one| touches(one)).count() == 1 {
                quantities.retain(touches);
                self.notes.push(format!(
                    "{count} entries hold {what}; only one of them has wavelengths from {first} to {last} nm, and only that one was read"
                ));
            }
        }
        match quantities.get(1) {
            None => Ok(quantities.pop()),
            Some(second) => {
                let message = format!("a second entry holds {what}; remove one of the two");
                Err(error_at(self.file, second.entry.kind(self.file)?, page::yaml(&message)))
            }
        }
    }

    /// Returns the rows as a table: all of them or, if a fault does not affect the wanted wavelengths, those
    /// without the fault.
    fn table(&mut self, rows: &Rows<'_>) -> Result<Tabulated, FormatError> {
        let fault = match rows.tabulated(0..rows.rows.len(), self.file) {
            Ok(table) => return Ok(table),
            Err(fault) => fault,
        };
        let Some((first, last)) = self.wanted_nm else { return Err(fault) };
        let Some(sound) = rows.sound_within(first, last) else { return Err(fault) };
        let table = rows.tabulated(sound, self.file)?;
        let (from, to) = table.range_nm();
        let line = fault.place.spot.as_ref().map_or(String::new(), |spot| format!("line {}: ", spot.line));
        self.notes.push(format!(
            "{line}{}; this does not affect {first} to {last} nm, and {} was read only from {from} to {to} nm",
            fault.problem, rows.what
        ));
        Ok(table)
    }
}

/// One column of the numbers of an entry.
struct Rows<'a> {
    block: &'a Value<'a>,
    what: &'static str,
    rows: Vec<Row>,
}

struct Row {
    place: Range<usize>,
    nm: f64,
    value: f64,
}

impl Rows<'_> {
    /// Returns the range of the wavelengths of all rows, nm.
    fn range_nm(&self) -> (f64, f64) {
        let nm = self.rows.iter().map(|row| row.nm);
        nm.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), nm| (first.min(nm), last.max(nm)))
    }

    /// Returns some of the rows as a table against wavelength in nm.
    fn tabulated(&self, rows: Range<usize>, file: Table<'_>) -> Result<Tabulated, FormatError> {
        let mut columns = Columns::<1>::default();
        for row in &self.rows[rows] {
            let added =
                columns.add(row.nm, [row.value]).and_then(|()| check_not_negative(row.value, self.what));
            added.map_err(|problem| error_at_row(file, row.place.clone(), problem))?;
        }
        let [table] = columns.into_tables().map_err(|problem| error_at(file, self.block, problem))?;
        Ok(table)
    }

    /// Returns consecutive rows without a fault that determine all values from `first` to `last`, or `None`
    /// if there are none.
    fn sound_within(&self, first: f64, last: f64) -> Option<Range<usize>> {
        let overlap = |rows: &Range<usize>| {
            let nm = || self.rows[rows.clone()].iter().map(|row| row.nm);
            nm().fold(f64::NEG_INFINITY, f64::max).min(last) - nm().fold(f64::INFINITY, f64::min).max(first)
        };
        let best = self.runs().into_iter().max_by(|a, b| overlap(a).total_cmp(&overlap(b)))?;
        let (mine, all) = (&self.rows[best.clone()], self.range_nm());
        // The rows must cover the wanted range as far as the whole block does.
        let covers_first = |row: &Row| row.nm <= first.max(all.0);
        let covers_last = |row: &Row| row.nm >= last.min(all.1);
        if overlap(&best) < 0.0 || !mine.iter().any(covers_first) || !mine.iter().any(covers_last) {
            return None;
        }
        // From the nearest wavelength below the wanted range to the nearest one above: other rows in this
        // range must have equal values.
        let nm = || mine.iter().map(|row| row.nm);
        let from = nm().filter(|nm| *nm <= first).max_by(f64::total_cmp).unwrap_or(f64::NEG_INFINITY);
        let to = nm().filter(|nm| *nm >= last).min_by(f64::total_cmp).unwrap_or(f64::INFINITY);
        let others = self.rows[..best.start].iter().chain(&self.rows[best.end..]);
        let agrees = |row: &Row| mine.iter().any(|own| own.nm == row.nm && own.value == row.value);
        let touches = |row: &&Row| row.nm >= from && row.nm <= to;
        let sound = others.filter(touches).all(agrees);
        sound.then_some(best)
    }

    /// Returns the longest runs of rows whose wavelengths increase or decrease and whose values are not
    /// negative.
    fn runs(&self) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        let mut start = 0;
        for k in 0..=self.rows.len() {
            let continues = self.rows.get(k).is_some_and(|row| {
                let before = (k > start).then(|| self.rows[k - 1].nm);
                let first = (k > start + 1).then(|| self.rows[start + 1].nm > self.rows[start].nm);
                let rises = before.map(|before| row.nm > before);
                row.value >= 0.0 && before != Some(row.nm) && first.is_none_or(|first| Some(first) == rises)
            });
            if !continues {
                if k > start {
                    runs.push(start..k);
                }
                // A negative row belongs to no run; a row out of order begins the next one.
                let is_negative = self.rows.get(k).is_some_and(|row| row.value < 0.0);
                start = if is_negative { k + 1 } else { k };
            }
        }
        runs
    }
}

fn check_not_negative(value: f64, what: &'static str) -> Result<(), Problem> {
    if value >= 0.0 {
        return Ok(());
    }
    Err(Problem::OutOfRange { what, value, expected: "a number of 0 or more" })
}

impl Entry<'_> {
    fn table<'a>(&'a self, rows: Rows<'a>) -> Quantity<'a> {
        Quantity { entry: self, range_nm: rows.range_nm(), source: Source::Table(rows) }
    }

    /// Returns column number `column` of the `of` value columns of `data`, against wavelength in nm.
    fn rows<'a>(
        &'a self,
        (column, of): (usize, usize),
        what: &'static str,
        file: Table<'_>,
    ) -> Result<Rows<'a>, FormatError> {
        let data = self.needs("data", file)?;
        let mut rows = Vec::new();
        for (place, text) in data.rows(file) {
            let numbers = numbers(text).map_err(|problem| error_at_row(file, place.clone(), problem))?;
            if numbers.len() != of + 1 {
                let expected = if of == 2 {
                    "three columns: wavelength in um, n, k"
                } else {
                    "two columns: wavelength in um and value"
                };
                let problem = Problem::Columns { expected, count: of + 1, found: numbers.len() };
                return Err(error_at_row(file, place, problem));
            }
            rows.push(Row { place, nm: nm_from_um(numbers[0]), value: numbers[column + 1] });
        }
        Ok(Rows { block: data, what, rows })
    }

    /// Returns the range of validity of a formula, nm.
    fn range(&self, file: Table<'_>) -> Result<(f64, f64), FormatError> {
        let range = self.get("range").map_or_else(|| self.needs("wavelength_range", file), Ok)?;
        match numbers(&range.text).map_err(|problem| error_at(file, range, problem))?[..] {
            [first, last] => Ok((nm_from_um(first), nm_from_um(last))),
            _ => Err(error_at(file, range, page::yaml("expected a range of two wavelengths in um"))),
        }
    }

    fn formula(
        &self,
        number: u8,
        range_nm: (f64, f64),
        k: Option<Tabulated>,
        file: Table<'_>,
    ) -> Result<Dispersion, FormatError> {
        let coefficients = self.needs("coefficients", file)?;
        let values = numbers(&coefficients.text).map_err(|problem| error_at(file, coefficients, problem))?;
        Dispersion::formula(number, &values, range_nm, k).map_err(|e| error_at(file, coefficients, e.into()))
    }

    fn needs(&self, key: &str, file: Table<'_>) -> Result<&Value<'_>, FormatError> {
        match self.get(key) {
            Some(value) => Ok(value),
            None => Err(fault(file, self.kind(file)?.place.start, &format!("this entry has no `{key}`"))),
        }
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

/// Converts um to nm, rounded to 1e-6 nm, so that 0.57 um is exactly 570 nm.
fn nm_from_um(um: f64) -> f64 {
    (um * 1e9).round() / 1e6
}

/// Returns an error at a value of the page.
fn error_at(file: Table<'_>, value: &Value<'_>, problem: Problem) -> FormatError {
    file.error_at_line(value.place.start, problem)
}

/// Returns an error at a row of a block.
fn error_at_row(file: Table<'_>, place: Range<usize>, problem: Problem) -> FormatError {
    FormatError { place: Place::in_text(file.name, file.text, place), problem }
}

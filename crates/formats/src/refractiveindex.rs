//! The YAML pages of refractiveindex.info.
//!
//! A page has a `DATA` list whose entries are `tabulated nk`, `tabulated n`,
//! `tabulated k` (rows of um and values) or `formula 1` to `formula 9` (their
//! arithmetic is [`Dispersion::formula`]'s); n and k may come from two entries
//! with ranges of their own. Entries of n2, the non-linear index, are ignored.
//!
//! Who wants some wavelengths alone can read a page whose only faults (a repeated or unsorted wavelength, a
//! negative n or k, n or k given twice) lie where they touch none of these.

use std::ops::Range;

use papilio_diagnostics::Place;
use papilio_spectra::{Dispersion, Tabulated};

mod page;

use self::page::{Entry, Value, fault};
use crate::error::{FormatError, Problem};
use crate::rows::Table;
use crate::spectrum::Columns;
use papilio_diagnostics::Warned;

/// True if the text has a `DATA` list at its outermost level.
pub(crate) fn is_page(text: &str) -> bool {
    text.lines().any(|line| line.starts_with("DATA:"))
}

/// What an entry holds of n or of k.
enum Source<'a> {
    Table(Rows<'a>),
    Formula(u8, &'a Entry<'a>),
}

/// One of the quantities of an entry, and the wavelengths that it is for, nm.
struct Given<'a> {
    entry: &'a Entry<'a>,
    source: Source<'a>,
    range_nm: (f64, f64),
}

/// What a page gives: more than one of n, or of k, where several entries do.
#[derive(Default)]
struct Quantities<'a> {
    n: Vec<Given<'a>>,
    k: Vec<Given<'a>>,
}

/// Reads a page. A fault that no wavelength from `wanted_nm.0` to `wanted_nm.1` depends on is a note; without a wanted range
/// every fault is an error.
pub(crate) fn read(
    file: Table<'_>,
    wanted_nm: Option<(f64, f64)>,
) -> Result<Warned<Dispersion>, FormatError> {
    let entries = page::entries(file)?;
    let Quantities { n, k } = quantities(&entries, file)?;
    let mut reading = Reading { file, wanted_nm, notes: Vec::new() };
    let k = match reading.choose(k, "k")? {
        Some(Given { source: Source::Table(rows), .. }) => Some(reading.table(&rows)?),
        _ => None,
    };
    let value = match reading.choose(n, "n")? {
        Some(Given { source: Source::Table(rows), .. }) => {
            let n = reading.table(&rows)?;
            Dispersion::tabulated(n, k).map_err(|e| file.error(e.into()))?
        }
        Some(Given { source: Source::Formula(number, entry), range_nm, .. }) => {
            entry.formula(number, range_nm, k, file)?
        }
        None => return Err(file.error(Problem::NoIndex)),
    };
    Ok(Warned { value, warnings: reading.notes })
}

fn quantities<'a>(entries: &'a [Entry<'a>], file: Table<'a>) -> Result<Quantities<'a>, FormatError> {
    let mut found = Quantities::default();
    for entry in entries {
        let named = entry.kind(file)?;
        let kind = named.text.trim();
        let table = |column, what| entry.rows(column, what, file).map(|rows| entry.given(rows));
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
                found.n.push(Given { entry, source, range_nm: entry.range(file)? });
            }
            _ => return Err(at(file, named, Problem::UnknownData { found: kind.to_owned() })),
        }
    }
    Ok(found)
}

/// A page on its way to a dispersion.
struct Reading<'a> {
    file: Table<'a>,
    wanted_nm: Option<(f64, f64)>,
    notes: Vec<String>,
}

impl Reading<'_> {
    /// The one entry that gives a quantity; of several, the only one that has any of the wanted wavelengths.
    fn choose<'a>(
        &mut self,
        mut given: Vec<Given<'a>>,
        what: &str,
    ) -> Result<Option<Given<'a>>, FormatError> {
        let count = given.len();
        if count > 1
            && let Some((first, last)) = self.wanted_nm
        {
            let touches = |one: &Given<'_>| one.range_nm.0 <= last && one.range_nm.1 >= first;
            if given.iter().filter(|one| touches(one)).count() == 1 {
                given.retain(touches);
                self.notes.push(format!(
                    "{what} is given {count} times; only one of them has wavelengths from {first} to {last} nm, and it is read"
                ));
            }
        }
        match given.get(1) {
            None => Ok(given.pop()),
            Some(again) => {
                let message = format!("{what} is given twice");
                Err(at(self.file, again.entry.kind(self.file)?, Problem::Yaml { message }))
            }
        }
    }

    /// The rows as a table: all of them, or, if a fault lies where nothing is wanted, those without it.
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
            "{line}{}; it does not touch {first} to {last} nm, and {} is read from {from} to {to} nm alone",
            fault.problem, rows.what
        ));
        Ok(table)
    }
}

/// A column of an entry's block of numbers.
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
    /// Wavelengths of all rows, nm.
    fn range_nm(&self) -> (f64, f64) {
        let nm = self.rows.iter().map(|row| row.nm);
        nm.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), nm| (first.min(nm), last.max(nm)))
    }

    /// Some rows as a table against nm.
    fn tabulated(&self, rows: Range<usize>, file: Table<'_>) -> Result<Tabulated, FormatError> {
        let mut columns = Columns::<1>::default();
        for row in &self.rows[rows] {
            let added = columns.add(row.nm, [row.value]).and_then(|()| not_negative(row.value, self.what));
            added.map_err(|problem| fault_at(file, row.place.clone(), problem))?;
        }
        let [table] = columns.into_tables().map_err(|problem| at(file, self.block, problem))?;
        Ok(table)
    }

    /// Rows that follow each other without a fault, and are all that wavelengths from `first` to `last` depend on.
    fn sound_within(&self, first: f64, last: f64) -> Option<Range<usize>> {
        let overlap = |rows: &Range<usize>| {
            let nm = || self.rows[rows.clone()].iter().map(|row| row.nm);
            nm().fold(f64::NEG_INFINITY, f64::max).min(last) - nm().fold(f64::INFINITY, f64::min).max(first)
        };
        let best = self.runs().into_iter().max_by(|a, b| overlap(a).total_cmp(&overlap(b)))?;
        let (mine, all) = (&self.rows[best.clone()], self.range_nm());
        // It reaches as far as the block does.
        let reaches = |row: &Row| row.nm <= first.max(all.0);
        let reaches_on = |row: &Row| row.nm >= last.min(all.1);
        if overlap(&best) < 0.0 || !mine.iter().any(reaches) || !mine.iter().any(reaches_on) {
            return None;
        }
        // The wavelengths that the wanted ones lie between: another row for one of them must say the same.
        let nm = || mine.iter().map(|row| row.nm);
        let from = nm().filter(|nm| *nm <= first).max_by(f64::total_cmp).unwrap_or(f64::NEG_INFINITY);
        let to = nm().filter(|nm| *nm >= last).min_by(f64::total_cmp).unwrap_or(f64::INFINITY);
        let others = self.rows[..best.start].iter().chain(&self.rows[best.end..]);
        let agrees = |row: &Row| mine.iter().any(|own| own.nm == row.nm && own.value == row.value);
        let touches = |row: &&Row| row.nm >= from && row.nm <= to;
        let sound = others.filter(touches).all(agrees);
        sound.then_some(best)
    }

    /// The longest stretches of rows whose wavelengths rise or fall and whose values are not negative.
    fn runs(&self) -> Vec<Range<usize>> {
        let mut runs: Vec<Range<usize>> = Vec::new();
        let mut start = 0;
        for k in 0..=self.rows.len() {
            let goes_on = self.rows.get(k).is_some_and(|row| {
                let before = (k > start).then(|| self.rows[k - 1].nm);
                let first = (k > start + 1).then(|| self.rows[start + 1].nm > self.rows[start].nm);
                let rises = before.map(|before| row.nm > before);
                row.value >= 0.0 && before != Some(row.nm) && first.is_none_or(|first| Some(first) == rises)
            });
            if !goes_on {
                if k > start {
                    runs.push(start..k);
                }
                // A row with a fault of its own is in no stretch; one out of order begins the next.
                let spoilt = self.rows.get(k).is_some_and(|row| row.value < 0.0);
                start = if spoilt { k + 1 } else { k };
            }
        }
        runs
    }
}

fn not_negative(value: f64, what: &'static str) -> Result<(), Problem> {
    if value >= 0.0 {
        return Ok(());
    }
    Err(Problem::OutOfRange { what, value, expected: "0 or more" })
}

impl Entry<'_> {
    fn given<'a>(&'a self, rows: Rows<'a>) -> Given<'a> {
        Given { entry: self, range_nm: rows.range_nm(), source: Source::Table(rows) }
    }

    /// Column `(number, of)` of the rows of `data`, against nm.
    fn rows<'a>(
        &'a self,
        (column, of): (usize, usize),
        what: &'static str,
        file: Table<'_>,
    ) -> Result<Rows<'a>, FormatError> {
        let data = self.needs("data", file)?;
        let mut rows = Vec::new();
        for (place, text) in data.rows(file) {
            let numbers = numbers(text).map_err(|problem| fault_at(file, place.clone(), problem))?;
            if numbers.len() != of + 1 {
                let expected = if of == 2 { "three: um, n, k" } else { "two: um and the value" };
                let problem = Problem::Columns { expected, count: of + 1, found: numbers.len() };
                return Err(fault_at(file, place, problem));
            }
            rows.push(Row { place, nm: nm_from_um(numbers[0]), value: numbers[column + 1] });
        }
        Ok(Rows { block: data, what, rows })
    }

    /// Where a formula holds, nm.
    fn range(&self, file: Table<'_>) -> Result<(f64, f64), FormatError> {
        let range = self.get("range").map_or_else(|| self.needs("wavelength_range", file), Ok)?;
        match numbers(&range.text).map_err(|problem| at(file, range, problem))?[..] {
            [first, last] => Ok((nm_from_um(first), nm_from_um(last))),
            _ => Err(at(file, range, Problem::Yaml { message: "a range has two ends, in um".to_owned() })),
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
        let values = numbers(&coefficients.text).map_err(|problem| at(file, coefficients, problem))?;
        Dispersion::formula(number, &values, range_nm, k).map_err(|e| at(file, coefficients, e.into()))
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

/// To the nearest 1e-6 nm, so that .57 um is 570 nm and not a little less.
fn nm_from_um(um: f64) -> f64 {
    (um * 1e9).round() / 1e6
}

/// An error at a value of the page.
fn at(file: Table<'_>, value: &Value<'_>, problem: Problem) -> FormatError {
    file.error_at_line(value.place.start, problem)
}

/// An error at a row of a block.
fn fault_at(file: Table<'_>, place: Range<usize>, problem: Problem) -> FormatError {
    FormatError { place: Place::in_text(file.name, file.text, place), problem }
}

//! Headers of tables: which column holds which quantity, in which unit.

use papilio_diagnostics::Diagnostic;

use super::names::ColumnName;
use super::quantities::{ERROR, KNOWN, Quantity, REMARK};
use super::rounding::{self, Digits};
use super::rows::{Row, Table, clip};
use super::units::{Dimension, Unit};
use crate::error::{FormatError, Problem};

/// A column of a quantity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Column {
    pub(crate) quantity: &'static Quantity,
    /// Index of its cell in each row.
    pub(crate) cell: usize,
    /// The unit that the header states.
    pub(crate) unit: Option<Unit>,
    /// The step whose multiples its values are but for the rounding of their unit.
    pub(crate) step: Option<f64>,
}

/// The columns of a table, found by their names.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) columns: Vec<Column>,
    /// Columns that hold none of the accepted quantities.
    pub(crate) others: Vec<Other>,
    /// The names of all columns, as they stand in the file.
    pub(crate) names: Vec<String>,
    /// Number of cells of the header.
    pub(crate) count: usize,
    /// How the header was read, for the user.
    pub(crate) notes: Vec<String>,
}

/// A column that holds none of the accepted quantities.
#[derive(Debug)]
pub(crate) struct Other {
    pub(crate) cell: usize,
    pub(crate) name: ColumnName,
}

/// Rows of a table below its header.
pub(crate) struct Body<'a> {
    /// The header; `None` if the table has none.
    pub(crate) header: Option<Header>,
    /// The row of the header, for errors.
    pub(crate) head: Option<Row<'a>>,
    /// The rows of data.
    pub(crate) rows: Vec<Row<'a>>,
}

/// Number of rows among which the header is searched.
const FIRST_ROWS: usize = 60;

impl Header {
    /// Reads the names of a row; a quantity with two columns is an error.
    pub(crate) fn of(row: &Row<'_>, accepted: &[&'static Quantity]) -> Result<Self, FormatError> {
        let names = row.cells.iter().map(|cell| cell.text.to_string()).collect();
        let (columns, others, notes) = (Vec::new(), Vec::new(), Vec::new());
        let mut header = Self { columns, others, names, count: row.cells.len(), notes };
        for (cell, text) in row.cells.iter().map(|cell| &cell.text).enumerate() {
            let name = ColumnName::new(text);
            let Some(quantity) = quantity_of(&name, accepted) else {
                header.others.push(Other { cell, name });
                continue;
            };
            if let Some(other) = header.columns.iter().find(|column| std::ptr::eq(column.quantity, quantity))
            {
                let other = row.cells[other.cell].text.to_string();
                let wrong = format!("`{other}` and `{}` both name {}", clip(text), quantity.what);
                let wrong = Diagnostic::new(wrong).expected("one column for each quantity");
                let hint = "remove one of the two columns, or rename it";
                return Err(row.cell_error(cell, wrong.hint(hint).into()));
            }
            let unit = unit_of(&name, quantity).map_err(|problem| row.cell_error(cell, problem))?;
            header.columns.push(Column { quantity, cell, unit, step: None });
        }
        Ok(header)
    }

    /// Returns the column of a quantity.
    pub(crate) fn get(&self, quantity: &'static Quantity) -> Option<Column> {
        self.columns.iter().find(|column| std::ptr::eq(column.quantity, quantity)).copied()
    }

    /// Fails for a column that is not understood; remarks and uncertainties are passed over with a note.
    pub(crate) fn refuse_others(
        &mut self,
        row: &Row<'_>,
        accepted: &[&'static Quantity],
    ) -> Result<(), FormatError> {
        for other in &self.others {
            if other.name.raw.trim().is_empty() && is_empty_below(row, other.cell) {
                continue;
            }
            if !other.name.is_one_of(REMARK.names, false) && !other.name.is_one_of(ERROR.names, false) {
                return Err(row.cell_error(other.cell, unknown(&other.name, accepted)));
            }
            self.notes.push(format!("the column `{}` is not used", clip(&other.name.raw)));
        }
        Ok(())
    }

    /// Notes that all further columns are not used.
    pub(crate) fn note_others(&mut self) {
        let names: Vec<String> = self
            .others
            .iter()
            .filter(|other| !other.name.raw.trim().is_empty())
            .map(|other| format!("`{}`", clip(&other.name.raw)))
            .collect();
        match names.len() {
            0 => {}
            1 => self.notes.push(format!("the column {} is not used", names[0])),
            _ => self.notes.push(format!("the columns {} are not used", names.join(", "))),
        }
    }

    /// Takes the units of a row below the names, if it has nothing but units.
    fn take_units(&mut self, row: &Row<'_>) -> bool {
        let bare = |text: &str| text.trim().trim_matches(['(', ')', '[', ']']).trim().to_owned();
        let units: Vec<Option<Unit>> =
            row.cells.iter().map(|cell| super::units::unit(&bare(&cell.text))).collect();
        let all =
            row.cells.iter().zip(&units).all(|(cell, unit)| cell.text.trim().is_empty() || unit.is_some());
        let any = row.cells.iter().any(|cell| !matches!(cell.text.trim(), "" | "-" | "1"));
        let fits = self.columns.iter().all(|column| {
            units
                .get(column.cell)
                .copied()
                .flatten()
                .is_none_or(|unit| unit.fits(column.quantity.dimension) || unit == Unit::Fraction(1.0))
        });
        if row.cells.len() != self.count || !all || !any || !fits || row.is_number(0) {
            return false;
        }
        for column in &mut self.columns {
            let unit = units[column.cell].filter(|unit| unit.fits(column.quantity.dimension));
            column.unit = column.unit.or(unit);
        }
        true
    }
}

impl Column {
    /// Returns the number in the column's cell of a row, in the unit of Papilio.
    pub(crate) fn number(&self, row: &Row<'_>) -> Result<f64, FormatError> {
        let value = row.number(self.cell)?;
        let (Some(unit), dimension) = (self.unit, self.quantity.dimension) else { return Ok(value) };
        let converted = unit.convert(value, dimension);
        Ok(match self.step {
            Some(step) => rounding::nearest(converted, step),
            None if dimension == Dimension::Angle && unit.is_rounded(dimension) => {
                let digits = Digits::of(&row.cells[self.cell].text);
                rounding::quarter(converted, unit.error(value, digits, dimension))
            }
            None => converted,
        })
    }

    /// Returns the number as [`Self::number`], if it is within a range.
    pub(crate) fn number_within(
        &self,
        row: &Row<'_>,
        what: &'static str,
        (least, most): (f64, f64),
        expected: &'static str,
    ) -> Result<f64, FormatError> {
        // Adding 0 turns -0 into 0, so that both compare and sort as equal.
        let value = self.number(row)? + 0.0;
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        let is_micrometres = self.quantity.dimension == Dimension::Wavelength && value > 0.0 && value < least;
        let out_of_range = Problem::OutOfRange { what, value, expected };
        Err(row.cell_error(self.cell, if is_micrometres { Problem::Micrometres } else { out_of_range }))
    }

    /// Finds the step whose multiples the values are, if their unit is converted.
    fn find_step(&mut self, rows: &[Row<'_>]) {
        let Some(unit) = self.unit.filter(|unit| unit.is_rounded(self.quantity.dimension)) else { return };
        let numbers =
            || rows.iter().filter_map(|row| Some((row.cells.get(self.cell)?, row.number(self.cell).ok()?)));
        let mut digits = Digits::default();
        numbers().for_each(|(cell, _)| digits.note(&cell.text));
        let dimension = self.quantity.dimension;
        let converted =
            |(_, value): (_, f64)| (unit.convert(value, dimension), unit.error(value, digits, dimension));
        let mut values: Vec<(f64, f64)> = numbers().map(converted).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        values.dedup_by(|a, b| a.0 == b.0);
        self.step = rounding::step(&values);
    }

    /// Returns the text of the column's cell.
    pub(crate) fn text<'r>(&self, row: &'r Row<'_>) -> &'r str {
        row.cells.get(self.cell).map_or("", |cell| &cell.text)
    }

    /// Returns the column at a place, for tables without header.
    pub(crate) fn at(cell: usize, quantity: &'static Quantity) -> Self {
        Self { quantity, cell, unit: None, step: None }
    }
}

/// Splits a table into its header and its rows. The header is the first row with all columns that
/// `is_complete` requires, and rows of text above it are passed over with a note. If there is none, the last
/// comment above the data is the header if it names every column of the data. If there is neither, and the
/// first row has numbers, the table has no header.
///
/// # Errors
/// If the first row has no numbers but is not complete: with the column that is not understood, or the
/// quantity that is missing.
pub(crate) fn body<'a>(
    table: Table<'a>,
    accepted: &[&'static Quantity],
    is_complete: impl Fn(&Header) -> bool,
    missing: &'static str,
) -> Result<Body<'a>, FormatError> {
    let mut rows: Vec<Row<'a>> = table.data().collect();
    let complete = |row: &Row<'_>| Header::of(row, accepted).is_ok_and(|header| is_complete(&header));
    let wrong_unit = |row: &Row<'_>| Header::of(row, accepted).is_err();
    let at = rows.iter().take(FIRST_ROWS).position(complete);
    if let Some(at) = at {
        let mut header = Header::of(&rows[at], accepted)?;
        if at > 0 {
            let (first, last) = (rows[0].line(), rows[at].line() - 1);
            let lines =
                if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
            header.notes.push(format!("{lines} above the names of the columns are not read"));
        }
        let mut rows = rows.split_off(at);
        let head = rows.remove(0);
        if rows.first().is_some_and(|row| header.take_units(row)) {
            rows.remove(0);
        }
        header.columns.iter_mut().for_each(|column| column.find_step(&rows));
        return Ok(Body { header: Some(header), head: Some(head), rows });
    }
    let Some(first) = rows.first() else { return Ok(Body { header: None, head: None, rows }) };
    // Lines of text of one cell are titles.
    let named =
        rows.iter().take(FIRST_ROWS).take_while(|row| row.is_header()).find(|row| row.cells.len() > 1);
    if let Some(named) = named {
        // A header with a fault is more likely than a title.
        let row =
            rows.iter().take(FIRST_ROWS).find(|row| row.is_header() && wrong_unit(row)).unwrap_or(named);
        let header = Header::of(row, accepted)?;
        return Err(match header.others.iter().find(|other| !other.name.raw.trim().is_empty()) {
            Some(other) => row.cell_error(other.cell, unknown(&other.name, accepted)),
            None => row.error(Problem::MissingColumn { missing }),
        });
    }
    if let Some((head, mut header)) = commented(table, first, accepted)? {
        if !is_complete(&header) {
            return Err(head.error(Problem::MissingColumn { missing }));
        }
        header.columns.iter_mut().for_each(|column| column.find_step(&rows));
        return Ok(Body { header: Some(header), head: Some(head), rows });
    }
    Ok(Body { header: None, head: None, rows })
}

/// Returns the last comment above the first row of data, if it names all columns of the data.
fn commented<'a>(
    table: Table<'a>,
    first: &Row<'a>,
    accepted: &[&'static Quantity],
) -> Result<Option<(Row<'a>, Header)>, FormatError> {
    let count = first.cells.len();
    let above = table.rows().take_while(|row| row.is_comment()).last();
    let Some(row) = above.and_then(|row| row.uncommented(count)) else { return Ok(None) };
    let is_known = |text: &str| {
        let name = ColumnName::new(text);
        let known = quantity_of(&name, accepted).or_else(|| quantity_of(&name, &KNOWN));
        known.is_some() && !matches!(name.unit, Some(Err(_)))
    };
    if count < 2 || !row.cells.iter().all(|cell| is_known(&cell.text)) {
        return Ok(None);
    }
    let header = Header::of(&row, accepted)?;
    match header.others.first() {
        Some(other) => Err(row.cell_error(other.cell, unknown(&other.name, accepted))),
        None => Ok(Some((row, header))),
    }
}

/// Returns which of `quantities` a name means.
fn quantity_of(name: &ColumnName, quantities: &[&'static Quantity]) -> Option<&'static Quantity> {
    // The same letter may be the name of several quantities; the case decides first.
    let with_case = quantities.iter().find(|one| one.with_case && name.is_one_of(one.names, true));
    let by_name = || {
        quantities
            .iter()
            .find(|one| !one.with_case && name.is_one_of(one.names, false) && is_plausible(one, name))
    };
    let is_bare = || matches!(&name.unit, Some(Ok(unit)) if super::units::unit(&name.raw).or_else(|| super::units::unit(name.raw.trim().trim_end_matches('.'))) == Some(*unit));
    let by_unit = || {
        let fits = |one: &&&Quantity| matches!(name.unit, Some(Ok(unit)) if unit.fits(one.dimension));
        quantities.iter().filter(|one| one.by_unit).find(fits).filter(|_| is_bare())
    };
    with_case.or_else(by_name).or_else(by_unit).copied()
}

/// Returns whether a name, which several quantities may have, is that of this one: an energy or a frequency
/// is a wavelength only with its unit.
fn is_plausible(quantity: &Quantity, name: &ColumnName) -> bool {
    let needs_unit =
        quantity.dimension == Dimension::Wavelength && matches!(name.name.as_str(), "e" | "wave");
    !needs_unit || name.unit.is_some()
}

/// Returns the unit of a column, if it fits the quantity. Photon energies and frequencies must state theirs;
/// wavenumbers are in 1/cm.
fn unit_of(name: &ColumnName, quantity: &Quantity) -> Result<Option<Unit>, Problem> {
    let wrong = |unit: &str| wrong_unit(&clip(&name.raw), &clip(unit), quantity.dimension.units());
    let unit = match &name.unit {
        Some(Ok(unit)) if unit.fits(quantity.dimension) => Some(*unit),
        Some(Ok(Unit::Fraction(1.0))) | None => None,
        Some(Ok(_)) => return Err(wrong(&name.raw)),
        Some(Err(text)) => return Err(wrong(text)),
    };
    if quantity.dimension == Dimension::Wavelength {
        let is = |words: &[&str]| name.is_one_of(words, false);
        let is_wavenumber = is(&["wavenumber", "wave_number", "wellenzahl"]);
        match unit {
            None if is_wavenumber => return Ok(Some(Unit::Wavenumber(1.0))),
            None if is(&["energy", "energie", "photon_energy", "hnu", "frequency"]) => {
                return Err(wrong("none"));
            }
            Some(Unit::Length(_))
                if is_wavenumber || is(&["energy", "energie", "photon_energy", "e", "hnu", "frequency"]) =>
            {
                return Err(wrong(&name.raw));
            }
            _ => {}
        }
    }
    Ok(unit)
}

/// The error of a column whose unit, or `none`, is not understood, or is that of another quantity.
fn wrong_unit(column: &str, unit: &str, expected: &str) -> Problem {
    let wrong = match unit {
        "none" => format!("the column `{column}` states no unit"),
        unit if unit == column => format!("the column `{column}` has the unit of another quantity"),
        unit => format!("the unit `{unit}` of the column `{column}` is not understood"),
    };
    let hint = match unit {
        "none" => "write the unit in brackets behind the name, or as in `wavelength_nm`".to_owned(),
        "grad" | "gon" => {
            "convert the values to deg: 100 gon are 90 deg; for degrees, write deg or Grad".to_owned()
        }
        _ if expected == "no unit" => {
            "remove what is in brackets, or behind the name, if the values have no unit".to_owned()
        }
        _ => format!(
            "the accepted units are {expected}: convert the values, or correct the unit if it is written in another way"
        ),
    };
    Diagnostic::new(wrong).expected(expected).hint(hint).into()
}

/// Returns the error about a column that is not understood.
pub(crate) fn unknown(name: &ColumnName, accepted: &[&'static Quantity]) -> Problem {
    let known = quantity_of(name, &KNOWN).map(|quantity| quantity.what);
    let in_words = |one: &&Quantity| {
        let names = one.names.iter().take(3).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        format!("{names} ({})", one.dimension.units())
    };
    let accepted = accepted.iter().map(in_words).collect::<Vec<_>>().join("; ");
    let holds = known.map_or(String::new(), |known| format!(": it names {known}"));
    Diagnostic::new(format!("the column `{}` is not understood{holds}", clip(&name.raw)))
        .expected("a name of a column that this file may have")
        .hint(format!("rename the column, or remove it; the columns are {accepted}"))
        .into()
}

/// Returns whether no row of the table has anything in this column: lines that end with a separator.
fn is_empty_below(head: &Row<'_>, cell: usize) -> bool {
    head.table.data().all(|row| row.cells.get(cell).is_none_or(|cell| cell.text.trim().is_empty()))
}

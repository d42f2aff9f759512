//! Two-column spectra: wavelength in nm, value.

use std::ops::RangeInclusive;

use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::rows::{Row, Table};

/// Range of the largest value of a source's spectrum. The scale has no meaning, but
/// the squares of the values must remain finite.
const SOURCE_MAXIMUM: RangeInclusive<f64> = 1e-30..=1e30;

/// Reads a two-column spectrum: wavelength in nm, value.
///
/// A header row (without a number) and `#` comments are permitted. Columns are separated by
/// commas, semicolons, tabs or blanks. Wavelengths increase or decrease.
///
/// # Errors
/// With line and column: cells that are not finite numbers, rows without two
/// columns, wavelengths out of order or probably in micrometres.
///
/// ```
/// # use papilio_formats::{DataFile, read_spectrum};
/// let file = DataFile { name: "r.csv".into(), bytes: b"nm,R\n400,0.1\n500,0.3\n".to_vec() };
/// assert_eq!(read_spectrum(&file)?.at(450.0).unwrap(), 0.2);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_spectrum(file: &DataFile) -> Result<Tabulated, FormatError> {
    read_checked(file, |_, _| Ok(()))
}

/// Reads a spectrum of fractions, each from 0 to 1: a reflectance, an absorptance or a transmittance.
///
/// # Errors
/// As [`read_spectrum`], and for values out of range, with their line.
pub fn read_fractions(file: &DataFile) -> Result<Tabulated, FormatError> {
    read_checked(file, |row, value| within(row, value, 0.0..=1.0, "the fraction", "a number from 0 to 1"))
}

/// Reads the relative spectrum of a light source: values of 0 or more, the largest between 1e-30 and 1e30.
///
/// # Errors
/// As [`read_spectrum`], and for values out of range, with their line.
pub fn read_light(file: &DataFile) -> Result<Tabulated, FormatError> {
    let light = read_checked(file, |row, value| {
        within(row, value, 0.0..=*SOURCE_MAXIMUM.end(), "the spectral value", "a number from 0 to 1e30")
    })?;
    let largest = light.values().iter().copied().fold(0.0, f64::max);
    if SOURCE_MAXIMUM.contains(&largest) {
        return Ok(light);
    }
    let expected = "a largest value between 1e-30 and 1e30";
    Err(Table::new(file)?.error(Problem::OutOfRange {
        what: "the largest value of the spectrum",
        value: largest,
        expected,
    }))
}

fn read_checked(
    file: &DataFile,
    check: impl Fn(&Row<'_>, f64) -> Result<(), FormatError>,
) -> Result<Tabulated, FormatError> {
    let table = Table::new(file)?;
    let mut columns = Columns::default();
    for row in data_rows(table) {
        row.expect_cells(2, "two columns: wavelength in nm, value")?;
        columns.push(&row)?;
        check(&row, row.number(1)?)?;
    }
    let [value] = columns.finish(table)?;
    Ok(value)
}

/// Fails, with the place of the second cell, if a value is outside `range`.
fn within(
    row: &Row<'_>,
    value: f64,
    range: RangeInclusive<f64>,
    what: &'static str,
    expected: &'static str,
) -> Result<(), FormatError> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(row.cell_error(1, Problem::OutOfRange { what, value, expected }))
}

/// Returns the rows of numbers, without comments and header.
pub(crate) fn data_rows(table: Table<'_>) -> impl Iterator<Item = Row<'_>> {
    let rows = table.rows().filter(|row| !row.begins_with_hash());
    rows.enumerate().filter(|(i, row)| *i > 0 || !row.is_header()).map(|(_, row)| row)
}

/// Wavelengths and `N` columns of values.
pub(crate) struct Columns<const N: usize> {
    nm: Vec<f64>,
    values: [Vec<f64>; N],
}

impl<const N: usize> Default for Columns<N> {
    fn default() -> Self {
        Self { nm: Vec::new(), values: std::array::from_fn(|_| Vec::new()) }
    }
}

impl<const N: usize> Columns<N> {
    /// Adds a row: wavelength in nm and values.
    pub(crate) fn push(&mut self, row: &Row<'_>) -> Result<(), FormatError> {
        let nm = row.number(0)?;
        let mut values = [0.0; N];
        for (i, value) in values.iter_mut().enumerate() {
            *value = row.number(i + 1)?;
        }
        self.add(nm, values).map_err(|problem| row.cell_error(0, problem))
    }

    /// Adds a wavelength and its values. All wavelengths must increase, or all decrease, as the first two do.
    pub(crate) fn add(&mut self, nm: f64, values: [f64; N]) -> Result<(), Problem> {
        if nm <= 0.0 {
            let expected = "a wavelength above 0";
            return Err(Problem::OutOfRange { what: "a wavelength", value: nm, expected });
        }
        if let Some(&before) = self.nm.last() {
            let reverses = self.nm.len() > 1 && (nm < before) != self.is_descending();
            if nm == before || reverses {
                return Err(Problem::OutOfOrder { nm, before });
            }
        }
        self.nm.push(nm);
        for (column, value) in self.values.iter_mut().zip(values) {
            column.push(value);
        }
        Ok(())
    }

    fn is_descending(&self) -> bool {
        self.nm.len() > 1 && self.nm[1] < self.nm[0]
    }

    /// Returns the columns of a file as tables.
    pub(crate) fn finish(self, table: Table<'_>) -> Result<[Tabulated; N], FormatError> {
        // Optical data of displays do not end at 30 nm; tables in um often end at 2 um.
        if !self.nm.is_empty() && self.nm.iter().all(|nm| *nm < 30.0) {
            return Err(table.error(Problem::Micrometres));
        }
        self.into_tables().map_err(|problem| table.error(problem))
    }

    /// Returns the columns as tables with ascending wavelengths.
    pub(crate) fn into_tables(mut self) -> Result<[Tabulated; N], Problem> {
        if self.is_descending() {
            self.nm.reverse();
            self.values.iter_mut().for_each(|column| column.reverse());
        }
        if self.nm.len() < 2 {
            return Err(Problem::TooFew { rows: self.nm.len() });
        }
        let mut tables = Vec::with_capacity(N);
        for column in self.values {
            tables.push(Tabulated::new(self.nm.clone(), column)?);
        }
        tables.try_into().map_err(|_| Problem::TooFew { rows: 0 })
    }
}

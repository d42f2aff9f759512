//! Refractive indices: n-k tables in nm, and pages of refractiveindex.info.

use papilio_diagnostics::Warned;
use papilio_spectra::{Dispersion, Tabulated};

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::refractiveindex;
use crate::rows::{Row, Table};
use crate::spectrum::{Columns, data_rows};

/// Reads n + ik from a file. The format is detected from the content.
///
/// - A table: wavelength in nm, n, k; without a third column, k = 0. A header
///   row and `#` comments are permitted.
/// - A refractiveindex.info page (YAML with a `DATA` list): tables and formulas 1
///   to 9, wavelengths in um; non-linear entries (n2) are ignored.
/// - The CSV that refractiveindex.info offers for download: blocks `wl,n` and `wl,k`, wavelengths in um.
///
/// # Errors
/// With line and column: malformed tables, negative n or k, and invalid
/// formulas.
///
/// ```
/// # use papilio_formats::{DataFile, read_index};
/// let file = DataFile { name: "n.csv".into(), bytes: b"nm,n,k\n400,2.0,0\n600,2.2,0.1\n".to_vec() };
/// let index = read_index(&file)?.index(500.0).unwrap();
/// assert!((index.re - 2.1).abs() < 1e-12 && (index.im - 0.05).abs() < 1e-12);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_index(file: &DataFile) -> Result<Dispersion, FormatError> {
    read(file, None).map(|read| read.value)
}

/// Reads n + ik for wavelengths from `wanted_nm.0` to `wanted_nm.1` as [`read_index`], but tolerates errors of a
/// refractiveindex.info page that do not affect these wavelengths (a repeated or unsorted wavelength, a negative n or k, two entries
/// for n or k). Such errors become warnings, and the data end before them.
///
/// # Errors
/// As [`read_index`], for errors that affect the wanted wavelengths.
pub fn read_index_within(file: &DataFile, wanted_nm: (f64, f64)) -> Result<Warned<Dispersion>, FormatError> {
    read(file, Some(wanted_nm))
}

fn read(file: &DataFile, wanted_nm: Option<(f64, f64)>) -> Result<Warned<Dispersion>, FormatError> {
    let table = Table::new(file)?;
    if refractiveindex::is_page(table.text) {
        return refractiveindex::read(table, wanted_nm);
    }
    if refractiveindex::is_download(table) {
        let value = refractiveindex::read_download(table)?;
        return Ok(Warned { value, warnings: Vec::new() });
    }
    let mut rows = data_rows(table).peekable();
    let has_k = rows.peek().is_some_and(|row| row.cells.len() > 2);
    let (n, k) = if has_k { read_n_and_k(table, rows)? } else { (read_n(table, rows)?, None) };
    let value = Dispersion::tabulated(n, k).map_err(|e| table.error(e.into()))?;
    Ok(Warned { value, warnings: Vec::new() })
}

fn read_n_and_k<'a>(
    table: Table<'a>,
    rows: impl Iterator<Item = Row<'a>>,
) -> Result<(Tabulated, Option<Tabulated>), FormatError> {
    let mut columns = Columns::default();
    for row in rows {
        row.expect_cells(3, "three columns: wavelength in nm, n, k")?;
        columns.push(&row)?;
        check_not_negative(&row, 1, "n")?;
        check_not_negative(&row, 2, "k")?;
    }
    let [n, k] = columns.finish(table)?;
    Ok((n, Some(k)))
}

fn read_n<'a>(table: Table<'a>, rows: impl Iterator<Item = Row<'a>>) -> Result<Tabulated, FormatError> {
    let mut columns = Columns::default();
    for row in rows {
        row.expect_cells(2, "two columns, as on the first row: wavelength in nm, n")?;
        columns.push(&row)?;
        check_not_negative(&row, 1, "n")?;
    }
    let [n] = columns.finish(table)?;
    Ok(n)
}

fn check_not_negative(row: &Row<'_>, cell: usize, what: &'static str) -> Result<(), FormatError> {
    let value = row.number(cell)?;
    if value >= 0.0 {
        return Ok(());
    }
    Err(row.cell_error(cell, Problem::OutOfRange { what, value, expected: "a number of 0 or more" }))
}

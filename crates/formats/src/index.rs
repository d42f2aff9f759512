//! Refractive indices: n-k tables, tables of permittivities, and pages of refractiveindex.info.

use num_complex::Complex64;
use papilio_diagnostics::Warned;
use papilio_spectra::Dispersion;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::refractiveindex;
use crate::spectrum::Columns;
use crate::table::quantities::{EPS_1, EPS_2, K, N, WAVELENGTH};
use crate::table::{Column, Dialect, Header, Quantity, Row, Table, TableText, Unit, body};
use crate::woollam;

/// Reads n + ik from a file. The format is detected from the content.
///
/// - A table whose header names its columns, in any order and with their units: a wavelength (or wavenumber,
///   photon energy, frequency), and n, k or the permittivity eps1, eps2 = (n + ik)². Without k, k = 0.
///   Without a header: wavelength in nm, n, k.
/// - A refractiveindex.info page (YAML with a `DATA` list): tables and formulas 1
///   to 9, wavelengths in um; non-linear entries (n2) are ignored.
/// - Text files `.mat` of WVASE and CompleteEASE: a title, a unit, `NK` or `e1e2`, and rows of three numbers.
/// - The CSV that refractiveindex.info offers for download: blocks `wl,n` and `wl,k`, wavelengths in um.
///
/// # Errors
/// With line and column: columns or units that are not understood, malformed tables, negative n or k, and
/// invalid formulas.
///
/// ```
/// # use papilio_formats::{DataFile, read_index};
/// let file = DataFile { name: "n.csv".into(), bytes: b"k,n,wavelength_um\n0,2.0,0.4\n0.1,2.2,0.6\n".to_vec() };
/// let index = read_index(&file)?.index(500.0).unwrap();
/// assert!((index.re - 2.1).abs() < 1e-12 && (index.im - 0.05).abs() < 1e-12);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_index(file: &DataFile) -> Result<Dispersion, FormatError> {
    read(file, None).map(|read| read.value)
}

/// Reads n + ik for wavelengths from `wanted_nm.0` to `wanted_nm.1` as [`read_index`], but tolerates errors
/// of a refractiveindex.info page that do not affect these wavelengths (a repeated or unsorted wavelength, a
/// negative n or k, two entries for n or k). Such errors become warnings, and the data end before them.
///
/// # Errors
/// As [`read_index`], for errors that affect the wanted wavelengths.
pub fn read_index_within(file: &DataFile, wanted_nm: (f64, f64)) -> Result<Warned<Dispersion>, FormatError> {
    read(file, Some(wanted_nm))
}

fn read(file: &DataFile, wanted_nm: Option<(f64, f64)>) -> Result<Warned<Dispersion>, FormatError> {
    let text = TableText::new(file)?;
    let table = text.table();
    if refractiveindex::is_page(table.text) {
        return refractiveindex::read(table, wanted_nm);
    }
    if refractiveindex::is_download(table) {
        let value = refractiveindex::read_download(table)?;
        return Ok(Warned { value, warnings: Vec::new() });
    }
    match woollam::head(table.name, table.text)? {
        Some(head) => read_mat(table, &head),
        None => read_table(table),
    }
}

/// Reads the rows of a file of Woollam's programs.
fn read_mat(table: Table<'_>, head: &woollam::Head) -> Result<Warned<Dispersion>, FormatError> {
    let table = Table { dialect: Dialect::of(&table.text[head.rows_at..]), ..table };
    let rows: Vec<Row<'_>> = table.data().skip_while(|row| row.bytes().start < head.rows_at).collect();
    let nm = Column { unit: Some(head.unit), ..Column::at(0, &WAVELENGTH) };
    let index = match head.is_permittivity {
        true => Index::Permittivity(Column::at(1, &EPS_1), Column::at(2, &EPS_2)),
        false => Index::Parts(Column::at(1, &N), Some(Column::at(2, &K))),
    };
    let value =
        tabulated(table, &rows, (nm, &index), (3, "three columns: a wavelength or energy, and two numbers"))?;
    Ok(Warned { value, warnings: Vec::new() })
}

/// Quantities of the columns of a table.
static ACCEPTED: [&Quantity; 5] = [&WAVELENGTH, &N, &K, &EPS_1, &EPS_2];

const MISSING: &str =
    "the columns of a wavelength (`wavelength_nm`, `energy_eV`) and of `n` (and `k`) or `eps1` and `eps2`";

/// The columns of n and k.
enum Index {
    /// n, and k if there is any.
    Parts(Column, Option<Column>),
    /// The real and the imaginary part of (n + ik)².
    Permittivity(Column, Column),
}

impl Index {
    fn of(header: &Header) -> Option<Self> {
        let permittivity = header.get(&EPS_1).zip(header.get(&EPS_2));
        match header.get(&N) {
            Some(n) => Some(Self::Parts(n, header.get(&K))),
            None => permittivity.map(|(one, two)| Self::Permittivity(one, two)),
        }
    }

    /// Returns n and k of a row.
    fn of_row(&self, row: &Row<'_>) -> Result<[f64; 2], FormatError> {
        match self {
            Self::Parts(n, k) => {
                let n = not_negative(row, *n, "n")?;
                Ok([n, k.map_or(Ok(0.0), |k| not_negative(row, k, "k"))?])
            }
            Self::Permittivity(one, two) => {
                let (real, imaginary) = (one.number(row)?, not_negative(row, *two, "eps2")?);
                // The principal root has a positive real part, and a positive imaginary one as eps2.
                let root = Complex64::new(real, imaginary).sqrt();
                Ok([root.re, root.im])
            }
        }
    }
}

fn read_table(table: Table<'_>) -> Result<Warned<Dispersion>, FormatError> {
    let found = body(
        table,
        &ACCEPTED,
        |header| header.get(&WAVELENGTH).is_some() && Index::of(header).is_some(),
        MISSING,
    )?;
    let mut notes = Vec::new();
    let (nm, index, count, expected) = match (found.header, &found.head) {
        (Some(mut header), Some(head)) => {
            header.refuse_others(head, &ACCEPTED)?;
            let columns = header.get(&WAVELENGTH).zip(Index::of(&header));
            let (nm, index) =
                columns.ok_or_else(|| head.error(Problem::MissingColumn { missing: MISSING }))?;
            notes.append(&mut header.notes);
            if matches!(index, Index::Parts(..))
                && (header.get(&EPS_1).is_some() || header.get(&EPS_2).is_some())
            {
                notes.push("n and k are read, and the permittivity beside them is not used".to_owned());
            }
            let is_wl = nm.text(head).eq_ignore_ascii_case("wl") && nm.unit.is_none();
            let um =
                Some(Unit::Length(1e3)).filter(|_| is_wl && refractiveindex::are_um(&found.rows, nm.cell));
            (Column { unit: nm.unit.or(um), ..nm }, index, header.count, "as many columns as the header")
        }
        _ => {
            let has_k = found.rows.first().is_some_and(|row| row.cells.len() > 2);
            let k = has_k.then_some(Column::at(2, &K));
            let (count, expected) = match has_k {
                true => (3, "three columns: wavelength in nm, n, k"),
                false => (2, "two columns, as on the first row: wavelength in nm, n"),
            };
            (Column::at(0, &WAVELENGTH), Index::Parts(Column::at(1, &N), k), count, expected)
        }
    };
    if matches!(index, Index::Parts(_, None)) {
        notes.push("the table has no column of k: the material absorbs nothing (k = 0)".to_owned());
    }
    let value = tabulated(table, &found.rows, (nm, &index), (count, expected))?;
    Ok(Warned { value, warnings: notes })
}

/// Returns n + ik of rows with this number of columns.
fn tabulated(
    table: Table<'_>,
    rows: &[Row<'_>],
    (nm, index): (Column, &Index),
    (count, expected): (usize, &'static str),
) -> Result<Dispersion, FormatError> {
    let mut columns = Columns::<2>::default();
    for row in rows {
        row.expect_cells(count, expected)?;
        let at = nm.number(row)?;
        let index = index.of_row(row)?;
        columns.add(at, index).map_err(|problem| row.cell_error(nm.cell, problem))?;
    }
    let has_k = !matches!(index, Index::Parts(_, None));
    let [n, k] = columns.finish().map_err(|problem| table.error(problem))?;
    Dispersion::tabulated(n, has_k.then_some(k)).map_err(|e| table.error(e.into()))
}

fn not_negative(row: &Row<'_>, column: Column, what: &'static str) -> Result<f64, FormatError> {
    let value = column.number(row)?;
    if value >= 0.0 {
        return Ok(value);
    }
    Err(row.cell_error(column.cell, Problem::OutOfRange { what, value, expected: "a number of 0 or more" }))
}

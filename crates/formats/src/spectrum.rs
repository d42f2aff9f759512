//! Two-column spectra: wavelength in nm, value.

use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::rows::{Row, Table};

/// Reads a two-column spectrum: wavelength in nm, value.
///
/// One header row and `#` comments may stand there; columns are parted by
/// commas, semicolons, tabs or blanks.
///
/// # Errors
/// With line and column: cells that are not finite numbers, rows without two
/// columns, wavelengths that do not ascend or look like micrometres.
///
/// ```
/// # use papilio_formats::{DataFile, read_spectrum};
/// let file = DataFile { name: "r.csv".into(), bytes: b"nm,R\n400,0.1\n500,0.3\n".to_vec() };
/// assert_eq!(read_spectrum(&file)?.at(450.0).unwrap(), 0.2);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_spectrum(file: &DataFile) -> Result<Tabulated, FormatError> {
    let table = Table::new(file)?;
    let mut columns = Columns::default();
    for row in data_rows(table) {
        row.expect_cells(2, "expected two: wavelength in nm, value")?;
        columns.push(&row)?;
    }
    let [value] = columns.finish(table)?;
    Ok(value)
}

/// The rows below the header, if there is one.
pub(crate) fn data_rows(table: Table<'_>) -> impl Iterator<Item = Row<'_>> {
    table.rows().enumerate().filter(|(i, row)| *i > 0 || !row.is_header()).map(|(_, row)| row)
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
    /// Takes a row of wavelength and values.
    pub(crate) fn push(&mut self, row: &Row<'_>) -> Result<(), FormatError> {
        let nm = row.number(0)?;
        if nm <= 0.0 {
            let expected = "expected a wavelength above 0";
            return Err(row.cell_error(0, Problem::OutOfRange { what: "a wavelength", value: nm, expected }));
        }
        if let Some(&before) = self.nm.last().filter(|&&before| nm <= before) {
            return Err(row.cell_error(0, Problem::NotAscending { nm, before }));
        }
        for (i, column) in self.values.iter_mut().enumerate() {
            column.push(row.number(i + 1)?);
        }
        self.nm.push(nm);
        Ok(())
    }

    /// The columns as tables.
    pub(crate) fn finish(self, table: Table<'_>) -> Result<[Tabulated; N], FormatError> {
        // No table of a display's optics ends at 30 nm; tables in um often end at 2.
        if self.nm.last().is_some_and(|&last| last < 30.0) {
            return Err(table.error(Problem::Micrometres));
        }
        if self.nm.len() < 2 {
            return Err(table.error(Problem::Empty));
        }
        let mut tables = Vec::with_capacity(N);
        for column in self.values {
            tables.push(Tabulated::new(self.nm.clone(), column).map_err(|e| table.error(e.into()))?);
        }
        tables.try_into().map_err(|_| table.error(Problem::Empty))
    }
}

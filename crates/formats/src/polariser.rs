//! Spectra of polarisers: both polarisations in one table.

use papilio_diagnostics::Diagnostic;
use papilio_spectra::Tabulated;

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::table::quantities::{EXTINCTION_RATIO, K_ABSORBED, K_TRANSMITTED, TRANSMITTANCE, WAVELENGTH};
use crate::table::{Header, Quantity, TableText};

/// The columns of the table, of which it has three.
static COLUMNS: [&Quantity; 5] =
    [&WAVELENGTH, &TRANSMITTANCE, &EXTINCTION_RATIO, &K_TRANSMITTED, &K_ABSORBED];

/// What the columns of a polariser's table hold.
#[derive(Debug, Clone, PartialEq)]
pub enum PolariserTable {
    /// Transmittance for unpolarised light, and that of the absorbed polarisation over that of the transmitted one.
    Transmittance([Tabulated; 2]),
    /// Extinction coefficients k of the transmitted and of the absorbed polarisation.
    Extinction([Tabulated; 2]),
}

/// Reads the table of a polariser. Its first row holds the names of its columns in any order: `wavelength_nm,transmittance,extinction` or
/// `wavelength_nm,k_transmitted,k_absorbed`.
///
/// # Errors
/// With line and column: other columns, cells that are not numbers in their range, wavelengths out of order.
///
/// ```
/// # use papilio_formats::{DataFile, PolariserTable, read_polariser};
/// let bytes = b"wavelength_nm,transmittance,extinction\n400,0.40,2e-3\n700,0.44,1e-4\n".to_vec();
/// let found = read_polariser(&DataFile { name: "film.csv".into(), bytes })?;
/// let PolariserTable::Transmittance([transmittance, _]) = found else { panic!() };
/// assert!((transmittance.at(550.0).unwrap() - 0.42).abs() < 1e-12);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_polariser(file: &DataFile) -> Result<PolariserTable, FormatError> {
    let text = TableText::new(file)?;
    let table = text.table();
    let mut rows = table.rows().filter(|row| !row.is_comment());
    let head = rows.next().ok_or_else(|| table.error(no_rows()))?;
    let mut header = Header::of(&head, &COLUMNS)?;
    header.refuse_others(&head, &COLUMNS)?;
    let [wavelength, transmittance, ratio, along, across] = COLUMNS.map(|quantity| header.get(quantity));
    let expected = "`wavelength_nm,transmittance,extinction` or `wavelength_nm,k_transmitted,k_absorbed`";
    let (nm, columns, of_k) = match (wavelength, [transmittance, ratio], [along, across]) {
        (Some(nm), [Some(t), Some(ratio)], [None, None]) => (nm, [t, ratio], false),
        (Some(nm), [None, None], [Some(along), Some(across)]) => (nm, [along, across], true),
        _ => {
            let wrong = Diagnostic::new("this is not the header of a table of a polariser");
            return Err(head.error(wrong.expected(expected).into()));
        }
    };
    let mut all = [Vec::new(), Vec::new(), Vec::new()];
    for row in rows {
        row.expect_cells(header.count, "three columns, as in the header")?;
        let at = nm.number(&row)?;
        if let Some(before) = all[0].last().filter(|before| at <= **before) {
            let wrong = Diagnostic::new(format!("{at} nm does not follow {before} nm"));
            return Err(row.error(wrong.expected("ascending wavelengths").into()));
        }
        all[0].push(at);
        for (values, column) in all[1..].iter_mut().zip(columns) {
            values.push(if of_k {
                column.number_within(&row, "an extinction coefficient", (0.0, 100.0), "0 to 100")?
            } else {
                column.number_within(&row, "a fraction", (0.0, 1.0), "a number from 0 to 1")?
            });
        }
    }
    let [nm, first, second] = all;
    let tabulated = |values: Vec<f64>| {
        Tabulated::new(nm.clone(), values)
            .map_err(|error| FormatError::whole(&file.name, Diagnostic::new(error.to_string())))
    };
    let both = [tabulated(first)?, tabulated(second)?];
    Ok(if of_k { PolariserTable::Extinction(both) } else { PolariserTable::Transmittance(both) })
}

fn no_rows() -> Problem {
    too_few(0).expected("rows of wavelength_nm, transmittance, extinction").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<PolariserTable, FormatError> {
        read_polariser(&DataFile { name: "p.csv".into(), bytes: text.into() })
    }

    #[test]
    fn both_forms_are_read_by_the_names_of_their_columns() {
        let found =
            read("# film\nextinction;wavelength (um);transmittance (%)\n1e-3;0,4;40\n1e-4;0,7;44\n").unwrap();
        let PolariserTable::Transmittance([transmittance, ratio]) = found else { panic!("{found:?}") };
        assert!((transmittance.at(400.0).unwrap() - 0.4).abs() < 1e-12);
        assert!((ratio.at(700.0).unwrap() - 1e-4).abs() < 1e-12);
        let found = read("wavelength_nm,k_absorbed,k_transmitted\n400,0.02,1e-4\n700,0.01,2e-4\n").unwrap();
        let PolariserTable::Extinction([along, across]) = found else { panic!("{found:?}") };
        assert_eq!((along.at(400.0).unwrap(), across.at(700.0).unwrap()), (1e-4, 0.01));
    }

    #[test]
    fn mistakes_have_their_place() {
        for (text, problem) in [
            ("", "there are no rows of data"),
            ("wavelength_nm,transmittance\n400,0.4\n", "not the header of a table of a polariser"),
            (
                "wavelength_nm,transmittance,k_absorbed\n400,0.4,0.1\n",
                "not the header of a table of a polariser",
            ),
            ("wavelength_nm,transmittance,extinction\n400,1.4,0.1\n", "1.4"),
            ("wavelength_nm,transmittance,extinction\n400,0.4,x\n", "x"),
            ("wavelength_nm,transmittance,extinction\n700,0.4,0.1\n700,0.4,0.1\n", "700"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(problem), "{text}: {message}");
        }
    }
}

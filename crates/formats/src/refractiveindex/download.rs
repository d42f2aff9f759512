//! The CSV that refractiveindex.info offers for download: a block `wl,n`, and for absorbing materials a block `wl,k`, with wavelengths in
//! um. The two blocks may have different wavelengths.

use papilio_spectra::{Dispersion, Tabulated};

use super::{check_not_negative, nm_from_um};
use crate::error::{FormatError, Problem};
use crate::rows::{Row, Table};
use crate::spectrum::Columns;

/// Wavelengths of at least this many um are in fact nm.
const LONGEST_UM: f64 = 30.0;

/// Returns which quantity the block below this row has: `n` or `k`.
fn block(row: &Row<'_>) -> Option<&'static str> {
    match &row.cells[..] {
        [wl, value] if wl.text.eq_ignore_ascii_case("wl") => {
            ["n", "k"].into_iter().find(|name| value.text == *name)
        }
        _ => None,
    }
}

/// Returns whether the first row is `wl,n` or `wl,k`.
pub(crate) fn is_download(file: Table<'_>) -> bool {
    file.rows().find(|row| !row.begins_with_hash()).is_some_and(|row| block(&row).is_some())
}

/// Reads a download.
pub(crate) fn read_download(file: Table<'_>) -> Result<Dispersion, FormatError> {
    let mut found: [Option<Tabulated>; 2] = [None, None];
    let mut rows = file.rows().filter(|row| !row.begins_with_hash()).peekable();
    while let Some(head) = rows.next() {
        let Some(what) = block(&head) else { break };
        let place = &mut found[usize::from(what == "k")];
        if place.is_some() {
            let message = format!("a second block holds {what}; remove one of the two");
            return Err(head.error(Problem::Yaml { message }));
        }
        let mut values: Vec<(Row<'_>, f64, f64)> = Vec::new();
        while let Some(row) = rows.next_if(|row| block(row).is_none()) {
            row.expect_cells(
                2,
                "two columns: wavelength in um and value, or the head of a block, `wl,n` or `wl,k`",
            )?;
            let (wavelength, value) = (row.number(0)?, row.number(1)?);
            check_not_negative(value, what).map_err(|problem| row.cell_error(1, problem))?;
            values.push((row, wavelength, value));
        }
        let is_um = values.iter().all(|(_, wavelength, _)| *wavelength < LONGEST_UM);
        let mut columns = Columns::<1>::default();
        for (row, wavelength, value) in &values {
            let nm = if is_um { nm_from_um(*wavelength) } else { *wavelength };
            columns.add(nm, [*value]).map_err(|problem| row.cell_error(0, problem))?;
        }
        let [table] = columns.into_tables().map_err(|problem| head.error(problem))?;
        *place = Some(table);
    }
    let [n, k] = found;
    let no_n = || file.error(Problem::Yaml { message: "there is no block `wl,n`".to_owned() });
    let n = n.ok_or_else(no_n)?;
    Dispersion::tabulated(n, k).map_err(|error| file.error(error.into()))
}

//! The CSV that refractiveindex.info offers for download: a block `wl,n`, and for absorbing materials a block
//! `wl,k`, with wavelengths in um. The two blocks may have different wavelengths.

use papilio_spectra::{Dispersion, Tabulated};

use super::check_not_negative;
use super::page::yaml;
use crate::error::FormatError;
use crate::spectrum::Columns;
use crate::table::quantities::{K, N, WAVELENGTH};
use crate::table::{Column, Header, Quantity, Row, Table, Unit};

/// Wavelengths of at least this many um are in fact nm.
const LONGEST_UM: f64 = 30.0;

/// Returns the columns of the block below this row, if it is the head of one: a wavelength, and n or k.
fn block(row: &Row<'_>) -> Option<(Column, Column, &'static str)> {
    const ACCEPTED: [&Quantity; 3] = [&WAVELENGTH, &N, &K];
    let header = Header::of(row, &ACCEPTED).ok().filter(|header| header.count == 2)?;
    let value = header.get(&N).map(|n| (n, "n")).or_else(|| header.get(&K).map(|k| (k, "k")));
    let ((value, what), wavelength) = (value?, header.get(&WAVELENGTH)?);
    Some((wavelength, value, what))
}

/// Returns whether the first row is `wl,n` or `wl,k`, or a head with other names that is followed by a second
/// one.
pub(crate) fn is_download(file: Table<'_>) -> bool {
    let mut rows = file.data();
    let Some(first) = rows.next().filter(|row| block(row).is_some()) else { return false };
    first.cells[0].text.eq_ignore_ascii_case("wl") || rows.any(|row| block(&row).is_some())
}

/// Returns whether wavelengths without a unit, named `wl`, are in um.
pub(crate) fn are_um(rows: &[Row<'_>], cell: usize) -> bool {
    rows.iter().all(|row| row.number(cell).is_ok_and(|wavelength| wavelength < LONGEST_UM))
}

/// Reads a download.
pub(crate) fn read_download(file: Table<'_>) -> Result<Dispersion, FormatError> {
    let mut found: [Option<Tabulated>; 2] = [None, None];
    let mut rows = file.data().peekable();
    while let Some(head) = rows.next() {
        let Some((wavelength, value, what)) = block(&head) else { break };
        let place = &mut found[usize::from(what == "k")];
        if place.is_some() {
            let message = format!("a second block holds {what}; remove one of the two");
            return Err(head.error(yaml(&message)));
        }
        let mut data: Vec<Row<'_>> = Vec::new();
        while let Some(row) = rows.next_if(|row| block(row).is_none()) {
            let expected = "two columns: wavelength and value, or the head of a block, `wl,n` or `wl,k`";
            row.expect_cells(2, expected)?;
            data.push(row);
        }
        let is_wl = wavelength.text(&head).eq_ignore_ascii_case("wl");
        let um = Some(Unit::Length(1e3)).filter(|_| is_wl && are_um(&data, wavelength.cell));
        let wavelength = Column { unit: wavelength.unit.or(um), ..wavelength };
        let mut columns = Columns::<1>::default();
        for row in &data {
            let (nm, number) = (wavelength.number(row)?, value.number(row)?);
            check_not_negative(number, what).map_err(|problem| row.cell_error(value.cell, problem))?;
            columns.add(nm, [number]).map_err(|problem| row.cell_error(wavelength.cell, problem))?;
        }
        let [table] = columns.into_tables().map_err(|problem| head.error(problem))?;
        *place = Some(table);
    }
    let [n, k] = found;
    let no_n = || file.error(yaml("there is no block `wl,n`"));
    let n = n.ok_or_else(no_n)?;
    Dispersion::tabulated(n, k).map_err(|error| file.error(error.into()))
}

//! Power spectral densities of heights: tables of frequency and density.

use super::damaged;
use crate::DataFile;
use crate::error::{FormatError, Problem};
use crate::table::quantities::{DENSITY, FREQUENCY};
use crate::table::{Column, Quantity, TableText, body};

/// Most points of a table.
const MOST_POINTS: usize = 100_000;

const MISSING: &str = "the columns `frequency_per_um` and `psd_um4`";

/// Reads a table of frequency, ascending, in cycles per um, and two-dimensional power spectral density in
/// um^4: the columns that its header names, in any order and with their units, or without a header frequency,
/// density. `#` comments are permitted.
///
/// # Errors
/// With line and column: columns that are not understood, cells that are not finite numbers of at least 0,
/// rows without two columns, frequencies out of order.
pub fn read_density(file: &DataFile) -> Result<Vec<[f64; 2]>, FormatError> {
    static ACCEPTED: [&Quantity; 2] = [&FREQUENCY, &DENSITY];
    let text = TableText::new(file)?;
    let table = text.table();
    let found = body(table, &ACCEPTED, |header| header.columns.len() == 2, MISSING)?;
    let (columns, count) = match (found.header, &found.head) {
        (Some(mut header), Some(head)) => {
            header.refuse_others(head, &ACCEPTED)?;
            let columns = header.get(&FREQUENCY).zip(header.get(&DENSITY));
            let (frequency, density) =
                columns.ok_or_else(|| head.error(Problem::MissingColumn { missing: MISSING }))?;
            ([frequency, density], header.count)
        }
        _ => ([Column::at(0, &FREQUENCY), Column::at(1, &DENSITY)], 2),
    };
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in &found.rows {
        row.expect_cells(count, "two columns: frequency in cycles per um, density in um^4")?;
        let point = [columns[0].number(row)?, columns[1].number(row)?];
        let wrong = |column: usize, what: String| {
            row.cell_error(columns[column].cell, damaged("density", what).into())
        };
        if let Some(column) = (0..2).find(|column| point[*column] < 0.0) {
            return Err(wrong(column, format!("{} is negative", point[column])));
        }
        if let Some([before, _]) = points.last().filter(|[before, _]| point[0] <= *before) {
            return Err(wrong(
                0,
                format!("the frequency {} follows {before} (expected ascending ones)", point[0]),
            ));
        }
        points.push(point);
        if points.len() > MOST_POINTS {
            return Err(wrong(0, format!("the table has more than {MOST_POINTS} points")));
        }
    }
    if !points.iter().any(|[frequency, density]| *frequency > 0.0 && *density > 0.0) {
        return Err(table.error(damaged("density", "it has no density above 0").into()));
    }
    Ok(points)
}

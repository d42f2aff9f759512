//! Light profiles: angle, relative radiance.

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::table::quantities::{RADIANCE, THETA};
use crate::table::{Column, QUARTER_TURN, Quantity, TableText, body, may_be_radians};

/// Largest relative radiance. The scale has no meaning, but computed values must remain finite.
const LARGEST: f64 = 1e30;

const MISSING: &str = "the columns `theta_deg` and `radiance`";

/// Reads a light profile: ascending angles from 0 to 90 deg, and relative radiances of
/// 0 or more.
///
/// The columns are those that the header names, in any order and with their units (`theta_deg,radiance`), or
/// without a header angle in degrees, radiance. `#` comments are permitted. Columns are separated as in
/// [`read_spectrum`](crate::read_spectrum).
///
/// # Errors
/// With line and column: columns that are not understood, cells that are not finite numbers, rows without two
/// columns, angles out of order or range, radiances below 0; fewer than two rows.
///
/// ```
/// # use papilio_formats::{DataFile, read_profile};
/// let file = DataFile { name: "room.csv".into(), bytes: b"theta_deg,radiance\n0,1\n60,0.5\n".to_vec() };
/// assert_eq!(read_profile(&file)?, [(0.0, 1.0), (60.0, 0.5)]);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_profile(file: &DataFile) -> Result<Vec<(f64, f64)>, FormatError> {
    static ACCEPTED: [&Quantity; 2] = [&THETA, &RADIANCE];
    let text = TableText::new(file)?;
    let table = text.table();
    let found = body(table, &ACCEPTED, |header| header.columns.len() == 2, MISSING)?;
    let (theta, value, count) = match (found.header, &found.head) {
        (Some(mut header), Some(head)) => {
            header.refuse_others(head, &ACCEPTED)?;
            let columns = header.get(&THETA).zip(header.get(&RADIANCE));
            let (theta, value) =
                columns.ok_or_else(|| head.error(Problem::MissingColumn { missing: MISSING }))?;
            (theta, value, header.count)
        }
        _ => (Column::at(0, &THETA), Column::at(1, &RADIANCE), 2),
    };
    let mut points: Vec<(f64, f64)> = Vec::new();
    for row in &found.rows {
        row.expect_cells(count, "two columns: angle in degrees, relative radiance")?;
        let angle = theta.number_within(row, "the angle", (0.0, 90.0), "an angle from 0 to 90 deg")?;
        if points.last().is_some_and(|last| last.0 >= angle) {
            let expected = "angles that increase from row to row";
            let problem = Problem::OutOfRange { what: "the angle", value: angle, expected };
            return Err(row.cell_error(theta.cell, problem));
        }
        let expected = "a relative radiance from 0 to 1e30";
        points.push((angle, value.number_within(row, "the radiance", (0.0, LARGEST), expected)?));
    }
    let angles: Vec<f64> = points.iter().map(|point| point.0).collect();
    if theta.unit.is_none()
        && may_be_radians([(QUARTER_TURN, &angles[..])])
        && let Some(row) = found.rows.last()
    {
        return Err(row.cell_error(theta.cell, Problem::Radians));
    }
    if points.len() < 2 {
        return Err(table.error(too_few(points.len()).expected("at least two angles").into()));
    }
    Ok(points)
}

//! Light profiles in two columns: angle in degrees, relative radiance.

use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::rows::Table;
use crate::spectrum::data_rows;

/// Largest relative radiance. The scale has no meaning, but computed values must remain finite.
const LARGEST: f64 = 1e30;

/// Reads a light profile: ascending angles in degrees from 0 to 90, and relative radiances of
/// 0 or more.
///
/// A header row and `#` comments are permitted. Columns are separated as in
/// [`read_spectrum`](crate::read_spectrum).
///
/// # Errors
/// With line and column: cells that are not finite numbers, rows without two columns, angles out of order or
/// range, radiances below 0; fewer than two rows.
///
/// ```
/// # use papilio_formats::{DataFile, read_profile};
/// let file = DataFile { name: "room.csv".into(), bytes: b"theta_deg,radiance\n0,1\n60,0.5\n".to_vec() };
/// assert_eq!(read_profile(&file)?, [(0.0, 1.0), (60.0, 0.5)]);
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_profile(file: &DataFile) -> Result<Vec<(f64, f64)>, FormatError> {
    let table = Table::new(file)?;
    let mut points: Vec<(f64, f64)> = Vec::new();
    for row in data_rows(table) {
        row.expect_cells(2, "two columns: angle in degrees, relative radiance")?;
        let (angle, radiance) = (row.number(0)?, row.number(1)?);
        let out_of_range = |cell, what, value, expected| {
            Err(row.cell_error(cell, Problem::OutOfRange { what, value, expected }))
        };
        if !(0.0..=90.0).contains(&angle) {
            return out_of_range(0, "the angle", angle, "an angle from 0 to 90 deg");
        }
        if points.last().is_some_and(|last| last.0 >= angle) {
            return out_of_range(0, "the angle", angle, "angles that increase from row to row");
        }
        if !(0.0..=LARGEST).contains(&radiance) {
            return out_of_range(1, "the radiance", radiance, "a relative radiance from 0 to 1e30");
        }
        points.push((angle, radiance));
    }
    if points.len() < 2 {
        return Err(table.error(Problem::TooFewAngles { rows: points.len() }));
    }
    Ok(points)
}

//! Power spectral densities of heights: tables of frequency and density.

use super::SurfaceProblem;
use crate::DataFile;
use crate::error::{FormatError, Problem};
use crate::rows::Table;
use crate::spectrum::data_rows;

/// Most points of a table.
const MOST_POINTS: usize = 100_000;

/// Reads a two-column table: frequency in cycles per um, ascending, and two-dimensional power spectral density in um^4. A header and `#` comments
/// are permitted.
///
/// # Errors
/// With line and column: cells that are not finite numbers of at least 0, rows without two columns, frequencies out of order.
pub fn read_density(file: &DataFile) -> Result<Vec<[f64; 2]>, FormatError> {
    let table = Table::new(file)?;
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in data_rows(table) {
        row.expect_cells(2, "two columns: frequency in cycles per um, density in um^4")?;
        let point = [row.number(0)?, row.number(1)?];
        let damaged = |cell: usize, what: String| {
            row.cell_error(cell, SurfaceProblem::Damaged { format: "density", what }.into())
        };
        if let Some(cell) = (0..2).find(|cell| point[*cell] < 0.0) {
            return Err(damaged(cell, format!("{} is negative", point[cell])));
        }
        if let Some([before, _]) = points.last().filter(|[before, _]| point[0] <= *before) {
            return Err(damaged(
                0,
                format!("the frequency {} follows {before} (expected ascending ones)", point[0]),
            ));
        }
        points.push(point);
        if points.len() > MOST_POINTS {
            return Err(damaged(0, format!("the table has more than {MOST_POINTS} points")));
        }
    }
    if !points.iter().any(|[frequency, density]| *frequency > 0.0 && *density > 0.0) {
        let what = "it has no density above 0".to_owned();
        let problem: Problem = SurfaceProblem::Damaged { format: "density", what }.into();
        return Err(table.error(problem));
    }
    Ok(points)
}

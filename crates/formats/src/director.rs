//! Directors of a liquid crystal by depth, as solvers for cells write them.

use papilio_diagnostics::Diagnostic;

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::table::quantities::{DEPTH, TILT, TWIST};
use crate::table::{HALF_TURN, Header, Quantity, TURN, TableText, may_be_radians};

/// The columns of the table.
static COLUMNS: [&Quantity; 3] = [&DEPTH, &TILT, &TWIST];

/// A director at a depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectorRow {
    /// Fraction of the gap, from the top: 0 to 1.
    pub depth: f64,
    /// Tilt out of the panel, degrees; beyond 90, the director has turned through the normal.
    pub tilt_deg: f64,
    /// Azimuth from that of rubbing at the top, degrees.
    pub twist_deg: f64,
}

/// Reads a table of directors. Its first row holds the names of the columns, `depth,tilt_deg,twist_deg` in any order; `depth` is a fraction of
/// the gap from its top, ascending from 0 to 1.
///
/// # Errors
/// With line and column: cells that are not numbers, depths that do not ascend from 0 to 1, tilts beyond 180 deg.
///
/// ```
/// # use papilio_formats::{DataFile, read_director};
/// let bytes = b"depth,tilt_deg,twist_deg\n0,2,0\n1,2,90\n".to_vec();
/// let found = read_director(&DataFile { name: "off.csv".into(), bytes })?;
/// assert_eq!((found.len(), found[1].twist_deg), (2, 90.0));
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_director(file: &DataFile) -> Result<Vec<DirectorRow>, FormatError> {
    let text = TableText::new(file)?;
    let table = text.table();
    let mut rows = table.rows().filter(|row| !row.is_comment());
    let head = rows.next().ok_or_else(|| table.error(no_rows()))?;
    let mut header = Header::of(&head, &COLUMNS)?;
    header.refuse_others(&head, &COLUMNS)?;
    let [Some(depth), Some(tilt), Some(twist)] = COLUMNS.map(|quantity| header.get(quantity)) else {
        let wrong = Diagnostic::new("this is not the header of a table of directors");
        return Err(head.error(wrong.expected("`depth,tilt_deg,twist_deg`").into()));
    };
    let mut found: Vec<DirectorRow> = Vec::new();
    let mut last = None;
    for row in rows {
        row.expect_cells(header.count, "three columns: depth, tilt_deg, twist_deg")?;
        let expected = "a fraction of the gap from 0 (top) to 1 (bottom)";
        let director = DirectorRow {
            depth: depth.number_within(&row, "a depth", (0.0, 1.0), expected)?,
            tilt_deg: tilt.number_within(&row, "a tilt", (-180.0, 180.0), "-180 to 180 degrees")?,
            twist_deg: twist.number_within(&row, "a twist", (-3600.0, 3600.0), "-3600 to 3600 degrees")?,
        };
        let is_wrong = found.last().map_or(director.depth != 0.0, |last| director.depth <= last.depth);
        if is_wrong {
            let wrong = Diagnostic::new(format!("the depth {} is out of order", director.depth));
            return Err(row.error(wrong.expected("depths that ascend from 0 to 1").into()));
        }
        found.push(director);
        last = Some(row);
    }
    if tilt.unit.is_none() && twist.unit.is_none() {
        let [tilts, twists] = [|row: &DirectorRow| row.tilt_deg, |row: &DirectorRow| row.twist_deg]
            .map(|angle| found.iter().map(angle).collect::<Vec<f64>>());
        if may_be_radians([(HALF_TURN, &tilts[..]), (TURN, &twists)]) {
            return Err(head.cell_error(tilt.cell, Problem::Radians));
        }
    }
    match (found.last(), last) {
        (Some(end), Some(row)) if end.depth != 1.0 => {
            let wrong = Diagnostic::new(format!("the depths of this table end at {}", end.depth));
            Err(row.error(wrong.expected("a last row at a depth of 1, the bottom of the cell").into()))
        }
        (Some(_), _) if found.len() > 1 => Ok(found),
        _ => Err(table.error(no_rows())),
    }
}

fn no_rows() -> Problem {
    too_few(0).expected("rows from depth 0 to 1: depth, tilt_deg, twist_deg").into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<DirectorRow>, FormatError> {
        read_director(&DataFile { name: "d.csv".into(), bytes: text.into() })
    }

    #[test]
    fn directors_are_read_in_any_order_of_columns() {
        let found = read("# on\ntwist (deg);depth;tilt (rad)\n0;0;0,5\n45;0,5;1\n90;1;0,5\n").unwrap();
        assert_eq!(found.len(), 3);
        assert!((found[1].tilt_deg - 1.0_f64.to_degrees()).abs() < 1e-9 && found[2].twist_deg == 90.0);
    }

    /// Those of a pi cell turn through the normal.
    #[test]
    fn directors_turn_through_the_normal() {
        let found = read("depth,tilt_deg,twist_deg\n0,5,0\n0.5,90,0\n1,175,0\n").unwrap();
        assert_eq!(found.iter().map(|row| row.tilt_deg).collect::<Vec<_>>(), [5.0, 90.0, 175.0]);
    }

    #[test]
    fn mistakes_have_their_line() {
        const HEAD: &str = "depth,tilt_deg,twist_deg\n";
        for (rows, problem) in [
            ("", "there are no rows of data"),
            ("0,0,0\n0.5,0,0\n", "the depths of this table end at 0.5"),
            ("0.1,0,0\n1,0,0\n", "the depth 0.1 is out of order"),
            ("0,0,0\n1,0,0\n1,0,0\n", "the depth 1 is out of order"),
            ("0,0,0\n1,181,0\n", "181"),
            ("0,0,0\n2,0,0\n", "2"),
        ] {
            let error = read(&format!("{HEAD}{rows}")).unwrap_err();
            assert!(error.to_string().contains(problem), "{rows}: {error}");
        }
        let radians = "depth,tilt,twist\n0,0.349066,0\n0.5,0.698132,0\n1,0.349066,0\n";
        assert!(read(radians).unwrap_err().to_string().contains("in radians"));
        assert_eq!(read("depth,tilt,twist\n0,2,0\n1,4.5,90\n").unwrap()[1].tilt_deg, 4.5);
        assert!(read("depth,tilt_deg\n0,0\n1,0\n").unwrap_err().to_string().contains("not the header"));
    }
}

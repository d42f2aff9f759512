//! Rectangles of sub-pixels: name, and corners in fractions of the pixel's pitch.

use papilio_diagnostics::{Diagnostic, Place};

use crate::error::{FormatError, Problem, too_few};
use crate::file::DataFile;
use crate::pixel_table::is_name;
use crate::table::quantities::{NAME, X_0, X_1, Y_0, Y_1};
use crate::table::{Column, Header, Quantity, Row, TableText};

/// The columns of the table.
static COLUMNS: [&Quantity; 5] = [&NAME, &X_0, &Y_0, &X_1, &Y_1];

/// A rectangle of a sub-pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedRectangle {
    /// Name of the sub-pixel.
    pub name: String,
    /// x0, y0, x1, y1 in fractions of the pitch.
    pub corners: [f64; 4],
    /// Its row in the file.
    pub place: Place,
}

/// Reads a table of rectangles in the order of its rows. Its first row holds the names of the columns,
/// `name,x0,y0,x1,y1` in any order.
///
/// # Errors
/// With line and column: cells that are not numbers from 0 to 1, rectangles without area, names that are not
/// [permitted](is_name), a table without rows.
///
/// ```
/// # use papilio_formats::{DataFile, read_windows};
/// let file = DataFile { name: "w.csv".into(), bytes: b"name,x0,y0,x1,y1\nred,0,0,0.5,1\n".to_vec() };
/// let found = read_windows(&file)?;
/// assert_eq!((found[0].name.as_str(), found[0].corners), ("red", [0.0, 0.0, 0.5, 1.0]));
/// # Ok::<(), papilio_formats::FormatError>(())
/// ```
pub fn read_windows(file: &DataFile) -> Result<Vec<NamedRectangle>, FormatError> {
    let text = TableText::new(file)?;
    let table = text.table();
    let mut rows = table.rows().filter(|row| !is_comment(row));
    let head = rows.next().ok_or_else(|| table.error(no_rectangles()))?;
    let mut header = Header::of(&head, &COLUMNS)?;
    header.refuse_others(&head, &COLUMNS)?;
    let all = COLUMNS.map(|quantity| header.get(quantity));
    let [Some(name), Some(x0), Some(y0), Some(x1), Some(y1)] = all else {
        let wrong = Diagnostic::new("this is not the header of a table of rectangles");
        return Err(head.error(wrong.expected("`name,x0,y0,x1,y1`").into()));
    };
    let columns = ([x0, y0, x1, y1], name, header.count);
    let rectangles = rows.map(|row| rectangle(&row, columns)).collect::<Result<Vec<_>, _>>()?;
    if rectangles.is_empty() {
        return Err(table.error(no_rectangles()));
    }
    Ok(rectangles)
}

fn no_rectangles() -> Problem {
    too_few(0).expected("a row for each rectangle: name, x0, y0, x1, y1").into()
}

fn rectangle(
    row: &Row<'_>,
    (edges, name, count): ([Column; 4], Column, usize),
) -> Result<NamedRectangle, FormatError> {
    row.expect_cells(count, "five columns: name, x0, y0, x1, y1")?;
    let text = name.text(row);
    if !is_name(text) {
        return Err(row.cell_error(name.cell, Problem::BadName));
    }
    let expected = "a fraction of the pitch from 0 to 1";
    let edge = |column: Column| column.number_within(row, "an edge", (0.0, 1.0), expected);
    let corners = [edge(edges[0])?, edge(edges[1])?, edge(edges[2])?, edge(edges[3])?];
    if corners[0] >= corners[2] || corners[1] >= corners[3] {
        let wrong = Diagnostic::new("this rectangle has no area")
            .expected("x0 below x1, and y0 below y1")
            .hint("x0, y0 is the lower left corner, x1, y1 the upper right one");
        return Err(row.error(wrong.into()));
    }
    Ok(NamedRectangle { name: text.to_owned(), corners, place: row.place() })
}

/// Returns whether a row is a comment: it begins with `#` and is not a rectangle of a sub-pixel such as `#1`.
fn is_comment(row: &Row<'_>) -> bool {
    row.is_comment()
        && !(row.cells.len() >= COLUMNS.len() && (1..row.cells.len()).any(|cell| row.is_number(cell)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<NamedRectangle>, FormatError> {
        read_windows(&DataFile { name: "w.csv".into(), bytes: text.into() })
    }

    #[test]
    fn rectangles_are_read_in_order() {
        let text = "# a quad\nx0;name;y0;x1 (%);y1\n0;red;0,5;50;1\n\n0,5;blue;0;100;0,5\n0;red;0;10;0,1\n";
        let found = read(text).unwrap();
        let names: Vec<&str> = found.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["red", "blue", "red"]);
        assert_eq!(found[1].corners, [0.5, 0.0, 1.0, 0.5]);
        assert_eq!(found[1].place.line_column(), Some((5, 1)));
    }

    #[test]
    fn mistakes_have_their_line() {
        const HEAD: &str = "name,x0,y0,x1,y1\n";
        for (text, line, problem) in [
            ("", None, "there are no rows of data"),
            (HEAD, None, "there are no rows of data"),
            ("name,x0,y0,x1\nred,0,0,1\n", Some(1), "this is not the header of a table of rectangles"),
            (&format!("{HEAD}red,0.5,0,0.5,1\n"), Some(2), "this rectangle has no area"),
            (&format!("{HEAD}red,0,0.6,0.5,0.5\n"), Some(2), "this rectangle has no area"),
            (&format!("{HEAD}=red,0,0,1,1\n"), Some(2), "this name is not permitted"),
            (&format!("{HEAD}red,0,0,1,x\n"), Some(2), "`x` is not a number"),
        ] {
            let error = read(text).unwrap_err();
            assert_eq!(error.problem.to_string(), problem);
            assert_eq!(error.place.spot.as_ref().map(|spot| spot.line), line, "{error}");
        }
        let outside = read(&format!("{HEAD}red,0,0,1.2,1\n")).unwrap_err().to_string();
        assert!(outside.contains("an edge is 1.2") && outside.contains("from 0 to 1"), "{outside}");
        assert!(matches!(read(&format!("{HEAD}red,0,0,1\n")).unwrap_err().problem, Problem::Columns { .. }));
    }
}

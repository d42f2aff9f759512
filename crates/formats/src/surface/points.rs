//! Lists of points x, y, z: put on the grid on which they are.

use papilio_diagnostics::Diagnostic;

use super::header::Header;
use super::table::Rows;
use super::units::um_of;
use super::{HeightFile, sized};

/// Largest distance of a point from its place on the grid, in distances of the grid.
const OFF_GRID: f64 = 0.1;

/// Least share of the places of a grid that have a point.
const LEAST_FILLED: f64 = 0.25;

/// Columns of x, y and z, and their units in um.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Columns {
    at: [usize; 3],
    unit_um: [Option<f64>; 3],
}

/// Whether rows are points and not a map: their columns have names, or there are three columns and at least
/// four rows. A header that states the size of a map says that they are none.
///
/// # Errors
/// Names of columns that are no points, and two columns.
pub(super) fn are_points(header: &Header, rows: &Rows) -> Result<bool, Diagnostic> {
    if named(header, rows)?.is_some() {
        return Ok(true);
    }
    let is_map = header.count.iter().any(Option::is_some) || header.size.iter().any(Option::is_some);
    if is_map || rows.count() < 4 {
        return Ok(false);
    }
    match rows.columns {
        2 => Err(Diagnostic::new(format!(
            "this table has 2 columns and {} rows, as a profile x, z has",
            rows.count()
        ))
        .expected("a map: rows of heights, or points x, y, z")),
        3 => Ok(true),
        _ => Ok(false),
    }
}

/// The columns of x, y and z by their names.
fn named(header: &Header, rows: &Rows) -> Result<Option<Columns>, Diagnostic> {
    let Some(names) = &header.names else { return Ok(None) };
    let parts: Vec<(String, Option<f64>)> = names.cells.iter().map(|name| name_and_unit(name)).collect();
    let find = |known: &[&str]| parts.iter().position(|(name, _)| known.contains(&name.as_str()));
    let x = find(&["x", "pos x", "x position", "x coordinate"]);
    let y = find(&["y", "pos y", "y position", "y coordinate"]);
    let z = find(&["z", "height", "pos z", "z position", "z coordinate", "topography", "h", "elevation"]);
    match (x, y, z) {
        (Some(x), Some(y), Some(z)) => {
            Ok(Some(Columns { at: [x, y, z], unit_um: [parts[x].1, parts[y].1, parts[z].1] }))
        }
        // A comment, or names of the columns of a map.
        (None, None, _) if names.is_comment || rows.columns > 3 => Ok(None),
        _ if names.is_comment => Ok(None),
        _ => Err(Diagnostic::new(format!("the columns of this table are `{}`", names.cells.join("`, `")))
            .expected("the columns x, y and z of points, with their units, such as `x (mm)`")),
    }
}

/// A name of a column, and its unit: `X [mm]`, `z(um)`, `x/nm`, `x_um`.
fn name_and_unit(name: &str) -> (String, Option<f64>) {
    let lower = |name: &str| name.trim().to_lowercase();
    for split in
        [name.split_once(['(', '[']), name.rsplit_once('/'), name.rsplit_once('_'), name.rsplit_once(' ')]
    {
        if let Some((name, unit)) = split
            && let Some(um) = um_of(unit)
        {
            return (lower(name), Some(um));
        }
    }
    (lower(name), None)
}

/// Puts points on their grid.
///
/// # Errors
/// Points that are not on a grid, two points at a place, and unknown names of columns.
pub(super) fn map(header: &Header, rows: &Rows) -> Result<HeightFile, Diagnostic> {
    let unnamed = Columns { at: [0, 1, 2], unit_um: [None; 3] };
    let mut columns = named(header, rows)?.unwrap_or(unnamed);
    for (own, stated) in columns.unit_um.iter_mut().zip(header.unit_um) {
        *own = own.or(stated);
    }
    // An axis that states no unit has that of the other.
    let [x_um, y_um, z_um] = columns.unit_um;
    let lateral_um = [x_um.or(y_um), y_um.or(x_um)];
    let points: Vec<[f64; 3]> =
        rows.numbers.chunks_exact(rows.columns).map(|row| columns.at.map(|at| row[at])).collect();
    let mut map = on_grid(&points)?;
    map.pitch_um =
        map.pitch_um.map(|[x, y]| [x * lateral_um[0].unwrap_or(1.0), y * lateral_um[1].unwrap_or(1.0)]);
    map.unit_um = match (z_um, header.factor) {
        (None, None) => None,
        (unit, factor) => Some(unit.unwrap_or(1.0) * factor.unwrap_or(1.0)),
    };
    let size = [map.columns, map.numbers.len() / map.columns];
    map.warnings.push(format!(
        "a list of {} points x, y, z was put on its grid of {} x {}",
        points.len(),
        size[0],
        size[1]
    ));
    if lateral_um[0].is_none() || map.unit_um.is_none() {
        let what = match (lateral_um[0], map.unit_um) {
            (None, None) => "places and heights",
            (None, _) => "places",
            _ => "heights",
        };
        map.warnings.push(format!("the list states no unit of its {what}: um are taken"));
    }
    let others = rows.columns - 3;
    if others > 0 {
        map.warnings.push(format!("{others} further columns of the list are not used"));
    }
    Ok(map)
}

/// The map of points on a regular grid along x and y; its distances are in the unit of the points.
pub(super) fn on_grid(points: &[[f64; 3]]) -> Result<HeightFile, Diagnostic> {
    let axes = [axis(points, 0)?, axis(points, 1)?];
    let [columns, rows] = [axes[0].count, axes[1].count];
    // A list with many more places than points would take memory that the file does not have.
    let total = columns.saturating_mul(rows);
    if (points.len() as f64) < LEAST_FILLED * total as f64 {
        return Err(off_grid(format!("{} points do not fill a grid of {columns} x {rows}", points.len())));
    }
    let mut numbers = vec![f64::NAN; sized(columns, rows)?];
    let mut has_point = vec![false; numbers.len()];
    for [x, y, z] in points {
        let at = axes[1].place(*y) * columns + axes[0].place(*x);
        if std::mem::replace(&mut has_point[at], true) {
            return Err(off_grid(format!("there are two points at x {x}, y {y}")));
        }
        numbers[at] = *z;
    }
    let mut map = HeightFile::plain(columns, numbers);
    map.pitch_um = Some([axes[0].step, axes[1].step]);
    Ok(map)
}

fn off_grid(what: String) -> Diagnostic {
    Diagnostic::new(format!("this list of points x, y, z is not on a regular grid: {what}"))
        .expected("points on a regular grid along x and y (three columns are points, and not a map)")
}

/// Places of points along x or y.
struct Axis {
    first: f64,
    step: f64,
    count: usize,
}

impl Axis {
    fn place(&self, value: f64) -> usize {
        ((value - self.first) / self.step).round().clamp(0.0, (self.count - 1) as f64) as usize
    }
}

/// The regular places along an axis.
fn axis(points: &[[f64; 3]], axis: usize) -> Result<Axis, Diagnostic> {
    let name = ["x", "y"][axis];
    let mut values: Vec<f64> = points.iter().map(|point| point[axis]).collect();
    if let Some(at) = values.iter().position(|value| !value.is_finite()) {
        return Err(off_grid(format!("point {} has no {name}", at + 1)));
    }
    values.sort_unstable_by(f64::total_cmp);
    let largest = values.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    // Values closer than this are the same place, rounded.
    let same = 0.4 * largest;
    let mut middles: Vec<f64> = Vec::new();
    let mut begins = 0;
    for end in 1..=values.len() {
        if end == values.len() || values[end] - values[end - 1] > same {
            middles.push(0.5 * (values[begins] + values[end - 1]));
            begins = end;
        }
    }
    if middles.len() < 2 {
        return Err(off_grid(format!("all points have the same {name}")));
    }
    let span = middles[middles.len() - 1] - middles[0];
    let mut steps: Vec<f64> = middles.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_unstable_by(f64::total_cmp);
    // A few places may be missing: the number of steps is a whole one.
    let count = (span / steps[steps.len() / 2]).round() as usize + 1;
    let axis = Axis { first: middles[0], step: span / (count - 1) as f64, count };
    let is_off = |value: &&f64| {
        let steps = (**value - axis.first) / axis.step;
        (steps - steps.round()).abs() > OFF_GRID
    };
    match values.iter().find(is_off) {
        None => Ok(axis),
        Some(value) => {
            Err(off_grid(format!("{name} {value} is no multiple of {} from {} on", axis.step, axis.first)))
        }
    }
}

//! Reader of goniometer scans: a table of two columns, angle and BSDF, for light along the normal.
//!
//! A scan has one line of directions, and therefore says nothing about other azimuths and other incidences. It is read as the lobe
//! of a sample that is rotationally symmetric about the normal: rings about the specular direction. Angles on the two sides of the
//! normal (negative and positive) are averaged. Above 90 deg, the light is behind the sample: 180 deg is straight through.

use std::ops::Range;

use papilio_goniometry::{Channel, Geometry, MeasuredPart, Measurement, ScatterMode, SpecularGrid, Symmetry};

use super::table_read::{cells, is_not_measured, provenance, table_of, way_of_name};
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::table::quantities::{BSDF, THETA};
use crate::table::{Dimension, Header, Quantity, Unit};

/// Name of the format.
const NAME: &str = "scan at normal incidence";

/// Fewest and most angles of a scan.
const FEWEST: usize = 3;
const MOST: usize = 100_000;

/// Angles up to here, without a unit, are probably in radians.
const LARGEST_RADIAN: f64 = 1.571;

/// Relative difference of the two sides of a scan that gives a warning.
const ASYMMETRY: f64 = 0.02;

/// Assumptions that turn a scan into a lobe.
const NOTE: &str = "a scan at normal incidence: the lobe is taken as rotationally symmetric about the specular direction, and as \
                    shift-invariant in direction cosines (at other incidences it depends on beta_out - beta_in alone)";

/// Number of lines among which the header is searched.
const FIRST_LINES: usize = 60;

/// Columns of a scan.
struct Layout {
    separator: Option<u8>,
    has_header: bool,
    /// Whether the angle is the second column.
    is_reversed: bool,
    /// The unit of the angles, if it is stated.
    unit: Option<Unit>,
    /// The part that the name of the value column states.
    way: Option<ScatterMode>,
}

impl Layout {
    /// Detects the layout from a line. A line of numbers, or with other names, begins a scan only if the caller states that
    /// the file is one (`is_stated`): other tables have two columns, too.
    fn of(row: &crate::table::Row<'_>, is_stated: bool) -> Option<Self> {
        static ACCEPTED: [&Quantity; 2] = [&THETA, &BSDF];
        let separator = row.table.dialect.separator.and_then(|separator| u8::try_from(separator).ok());
        if row.cells.len() != 2 {
            return None;
        }
        let (first, second) = (row.is_number(0), row.is_number(1));
        if first && second {
            let layout = Self { separator, has_header: false, is_reversed: false, unit: None, way: None };
            return is_stated.then_some(layout);
        }
        if first || second {
            return None;
        }
        let header = Header::of(row, &ACCEPTED).ok()?;
        let theta = header.get(&THETA)?;
        let value = header.get(&BSDF);
        // A quantity that is called `value` is a BSDF only if the caller states it.
        let is_named =
            value.is_some_and(|value| !header.names[value.cell].trim().eq_ignore_ascii_case("value"));
        let way = value.and_then(|value| way_of_name(&header.names[value.cell]));
        let is_reversed = theta.cell == 1;
        (is_stated || is_named).then_some(Self {
            separator,
            has_header: true,
            is_reversed,
            unit: theta.unit,
            way,
        })
    }
}

/// Returns the text of a scan, its layout and its first line.
fn find(file: &DataFile, is_stated: bool) -> Option<(Text<'_>, Layout, Range<usize>)> {
    let (text, table) = table_of(file)?;
    let mut lines = Lines::new(text);
    for k in 0..FIRST_LINES {
        let line = lines.next().ok()??;
        let row = table.row_at(line.clone());
        if let Some(layout) = Layout::of(&row, is_stated) {
            return (k == 0 || layout.has_header).then_some((text, layout, line));
        }
        // Below rows of numbers there is no header.
        if row.cells.len() == 2 && row.is_number(0) && row.is_number(1) {
            return None;
        }
    }
    None
}

pub(super) fn is_scan(file: &DataFile, is_stated: bool) -> bool {
    find(file, is_stated).is_some()
}

/// A row: angle, degrees, value, and its place.
type Row = (f64, f64, Range<usize>);

pub(super) fn read(file: &DataFile, is_stated: bool) -> Result<BsdfFile, FormatError> {
    let unknown = || Text::new(file).whole(BsdfProblem::Unknown);
    let (text, layout, first) = find(file, is_stated).ok_or_else(unknown)?;
    let mut lines = Lines::new(text);
    while lines.expect("the first row of data")?.start < first.start {}
    let mut rows: Vec<Row> = Vec::new();
    let mut line = if layout.has_header { lines.next()? } else { Some(first) };
    while let Some(place) = line {
        rows.extend(row(text, &layout, place)?);
        if rows.len() > MOST {
            return Err(text.whole(BsdfProblem::TooManyCells { limit: MOST }));
        }
        line = lines.next()?;
    }
    if rows.is_empty() {
        return Err(text.ends("the first row of data"));
    }
    let most = rows.iter().map(|(theta, ..)| theta.abs()).fold(0.0, f64::max);
    let is_whole = rows.iter().all(|(theta, ..)| theta.fract() == 0.0);
    if layout.unit.is_none() && most <= LARGEST_RADIAN && !is_whole {
        return Err(text.whole(Problem::Radians));
    }
    let (behind, before): (Vec<Row>, Vec<Row>) = rows.into_iter().partition(|(theta, ..)| theta.abs() > 90.0);
    let states_side = !behind.is_empty();
    let states_part = layout.way.is_some() || states_side;
    let way = layout.way.filter(|_| behind.is_empty()).unwrap_or(ScatterMode::FrontReflection);
    let (mut parts, mut warnings) = (Vec::new(), Vec::new());
    for (way, rows) in [(way, before), (ScatterMode::FrontTransmission, behind)] {
        if !rows.is_empty() {
            parts.push(part(text, way, rows, &mut warnings)?);
        }
    }
    let mut provenance = provenance(lines.comments);
    NAME.clone_into(&mut provenance.format);
    let measurement = Measurement { provenance, media: [1.0, 1.0], parts };
    Ok(BsdfFile { measurement, warnings, notes: vec![NOTE.to_owned()], states_part, states_side })
}

/// Reads a row; an empty value was not measured.
fn row(text: Text<'_>, layout: &Layout, line: Range<usize>) -> Result<Option<Row>, FormatError> {
    let found: Vec<Range<usize>> = cells(text, line.clone(), layout.separator).take(3).collect();
    let [angle, value] = &found[..] else {
        let expected = "two columns: the angle from the normal in deg, and the BSDF in 1/sr";
        return Err(text.error(line, Problem::Columns { count: 2, expected, found: found.len() }));
    };
    let (angle, value) = if layout.is_reversed { (value, angle) } else { (angle, value) };
    let theta = text.number(angle.clone())?;
    let theta = layout.unit.map_or(theta, |unit| unit.convert(theta, Dimension::Angle));
    if !(-180.0..=180.0).contains(&theta) {
        let expected = "an angle from -180 to 180 deg, from the normal";
        return Err(text.error(angle.clone(), Problem::OutOfRange { what: "theta", value: theta, expected }));
    }
    if is_not_measured(text, value) {
        return Ok(None);
    }
    Ok(Some((theta, text.value(value.clone())?, line)))
}

/// Returns the rows of one side of the sample as a lobe: the mean of the two sides of the normal.
fn part(
    text: Text<'_>,
    way: ScatterMode,
    rows: Vec<Row>,
    warnings: &mut Vec<String>,
) -> Result<MeasuredPart, FormatError> {
    let radial = |theta: f64| if theta.abs() > 90.0 { 180.0 - theta.abs() } else { theta.abs() };
    let mut rows: Vec<(f64, bool, f64, Range<usize>)> =
        rows.into_iter().map(|(theta, value, place)| (radial(theta), theta < 0.0, value, place)).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut radials, mut values) = (Vec::<f64>::new(), Vec::<f64>::new());
    let (mut differences, mut sums) = (0.0, 0.0);
    for same in rows.chunk_by(|a, b| a.0 == b.0) {
        let twice = same.iter().enumerate().find(|(k, row)| same[..*k].iter().any(|other| other.1 == row.1));
        if let Some((_, (_, _, _, place))) = twice {
            return Err(text.error(place.clone(), BsdfProblem::Twice { what: "this angle".to_owned() }));
        }
        let mean = same.iter().map(|row| row.2).sum::<f64>() / same.len() as f64;
        differences += same.iter().map(|row| (row.2 - mean).powi(2)).sum::<f64>();
        sums += same.len() as f64 * mean * mean;
        radials.push(same[0].0);
        values.push(mean);
    }
    if radials.len() < FEWEST {
        let what = format!("a scan with {} angles", radials.len());
        return Err(text.whole(BsdfProblem::Unsupported { what, expected: "at least three angles" }));
    }
    let asymmetry = if sums > 0.0 { (differences / sums).sqrt() } else { 0.0 };
    if asymmetry > ASYMMETRY {
        warnings.push(format!(
            "the two sides of the scan differ from their mean by {:.1} % rms; the mean is used",
            100.0 * asymmetry
        ));
    }
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: vec![0.0],
        azimuths_deg: vec![0.0, 180.0],
        radials_deg: radials,
        symmetry: Symmetry::Plane,
    };
    let values = [&values[..], &values[..]].concat();
    Ok(MeasuredPart {
        way,
        channels: vec![Channel::Monochrome],
        geometry: Geometry::Specular(grid),
        values,
        tis: Vec::new(),
    })
}

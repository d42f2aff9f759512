//! Reader of goniometer scans: a table of two columns, angle and BSDF, for light along the normal.
//!
//! A scan has one line of directions, and therefore says nothing about other azimuths and other incidences.
//! It is read as the lobe of a sample that is rotationally symmetric about the normal: rings about the
//! specular direction. Angles on the two sides of the normal (negative and positive) are averaged. Above 90
//! deg, the light is behind the sample: 180 deg is straight through. A row at 90 deg belongs to the side that
//! has other rows; to the front, if both have some.

use std::ops::Range;

use papilio_goniometry::{Channel, Geometry, MeasuredPart, Measurement, ScatterMode, SpecularGrid, Symmetry};

use super::angles::{Angles, DEGREES};
use super::table_read::{cells, is_not_measured, provenance, relative_note, table_of, way_of_name};
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;
use crate::table::quantities::{BSDF, LIGHT, PHI_I, THETA, THETA_I};
use crate::table::rounding::nearest;
use crate::table::{ColumnName, Header, QUARTER_TURN, Quantity, Unit, may_be_radians};

/// Name of the format.
const NAME: &str = "scan at normal incidence";

/// Fewest and most angles of a scan.
const FEWEST: usize = 3;
const MOST: usize = 100_000;

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
    /// Number of columns, and the places of the angle and of the value.
    count: usize,
    theta: usize,
    value: usize,
    /// The unit of the angles, if it is stated.
    unit: Option<Unit>,
    /// The part that the name of the value column states.
    way: Option<ScatterMode>,
    /// How the header was read.
    notes: Vec<String>,
}

/// The quantities of a scan; a relative radiance only if the caller states that the file is one.
static ACCEPTED: [&Quantity; 3] = [&THETA, &BSDF, &LIGHT];

impl Layout {
    /// Detects the layout from a line. A line of numbers, or with other names, begins a scan only if the
    /// caller states that the file is one (`is_stated`): other tables have two columns, too.
    ///
    /// # Errors
    /// If the line is the header of a scan with a column or a unit that is not understood.
    fn of(row: &crate::table::Row<'_>, is_stated: bool) -> Result<Option<Self>, FormatError> {
        let separator = row.table.dialect.separator.and_then(|separator| u8::try_from(separator).ok());
        let count = row.cells.len();
        let numbers = (0..count).filter(|cell| row.is_number(*cell)).count();
        let bare = Self {
            separator,
            has_header: false,
            count,
            theta: 0,
            value: 1,
            unit: None,
            way: None,
            notes: Vec::new(),
        };
        if numbers > 0 || count < 2 {
            return Ok((is_stated && count == 2 && numbers == 2).then_some(bare));
        }
        let names: Vec<ColumnName> = row.cells.iter().map(|cell| ColumnName::new(&cell.text)).collect();
        let has = |one: &Quantity| names.iter().any(|name| name.is_one_of(one.names, one.with_case));
        // A quantity that is called `value` is a BSDF only if the caller states it.
        let is_bsdf =
            |name: &ColumnName| name.is_one_of(BSDF.names, false) && !name.is_one_of(&["value"], false);
        let is_named = names.iter().any(is_bsdf) && count < MOST_COLUMNS;
        let may_be_theta =
            has(&THETA) || names.iter().any(|name| matches!(name.unit, Some(Ok(Unit::Angle(_)))));
        if !may_be_theta || has(&THETA_I) || has(&PHI_I) || !(is_named || is_stated) {
            return Ok(None);
        }
        let mut header = Header::of(row, &ACCEPTED)?;
        let Some(theta) = header.get(&THETA) else { return Ok(None) };
        let of_light = || header.get(&LIGHT).filter(|_| is_stated);
        let value = match header.get(&BSDF).or_else(of_light) {
            Some(value) => value.cell,
            // The other one of two columns, whatever its name.
            None if is_stated && count == 2 => 1 - theta.cell,
            None => return Ok(None),
        };
        if count > 2 {
            header.refuse_others(row, &ACCEPTED[..2])?;
        }
        let way = way_of_name(&header.names[value]);
        let mut notes = header.notes;
        notes.extend(relative_note(&header.names[value]));
        Ok(Some(Self { has_header: true, theta: theta.cell, value, unit: theta.unit, way, notes, ..bare }))
    }
}

/// Most columns of a scan: tables with more hold other things.
const MOST_COLUMNS: usize = 10;

/// Returns the text of a scan, its layout and its first line; `None` if the file is no scan.
fn find(file: &DataFile, is_stated: bool) -> Result<Option<(Text<'_>, Layout, Range<usize>)>, FormatError> {
    let Some((text, table)) = table_of(file) else { return Ok(None) };
    let mut lines = Lines::new(text);
    // A faulty header counts unless a valid one follows: then it was a title.
    let mut fault = None;
    for k in 0..FIRST_LINES {
        let Ok(Some(line)) = lines.next() else { break };
        let row = table.row_at(line.clone());
        match Layout::of(&row, is_stated) {
            Ok(Some(layout)) if k == 0 || layout.has_header => return Ok(Some((text, layout, line))),
            // Below rows of numbers there is no header.
            Ok(_) if row.cells.len() > 1 && row.is_number(0) && row.is_number(1) => break,
            Ok(_) => {}
            Err(error) => fault = fault.or(Some(error)),
        }
    }
    fault.map_or(Ok(None), Err)
}

/// Returns whether a file is a scan, also one with a mistake in its header.
pub(super) fn is_scan(file: &DataFile, is_stated: bool) -> bool {
    !matches!(find(file, is_stated), Ok(None))
}

/// A row: angle, degrees, value, and its place.
type Row = (f64, f64, Range<usize>);

pub(super) fn read(file: &DataFile, is_stated: bool) -> Result<BsdfFile, FormatError> {
    let unknown = || Text::new(file).whole(BsdfProblem::Unknown);
    let (text, layout, first) = find(file, is_stated)?.ok_or_else(unknown)?;
    let mut lines = Lines::new(text);
    while lines.expect("the first row of data")?.start < first.start {}
    let (mut rows, mut angles) = (Vec::<Row>::new(), Angles::default());
    let mut line = if layout.has_header { lines.next()? } else { Some(first) };
    while let Some(place) = line {
        rows.extend(row(text, &layout, place, &mut angles)?);
        if rows.len() > MOST {
            return Err(text.whole(BsdfProblem::TooManyCells { limit: MOST }));
        }
        line = lines.next()?;
    }
    if rows.is_empty() {
        return Err(text.ends("the first row of data"));
    }
    if let Some(step) = angles.step(rows.iter().map(|row| row.0)) {
        rows.iter_mut().for_each(|row| row.0 = nearest(row.0, step));
    }
    let inclinations: Vec<f64> = rows.iter().map(|row| row.0).collect();
    if layout.unit.is_none() && may_be_radians([(QUARTER_TURN, &inclinations[..])]) {
        return Err(text.whole(Problem::Radians));
    }
    let (mut behind, mut before): (Vec<Row>, Vec<Row>) =
        rows.into_iter().partition(|(theta, ..)| theta.abs() > 90.0);
    if !behind.is_empty() && before.iter().all(|(theta, ..)| theta.abs() == 90.0) {
        behind.append(&mut before);
    }
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
    Ok(BsdfFile {
        measurement,
        warnings,
        notes: [vec![NOTE.to_owned()], layout.notes].concat(),
        states_part,
        states_side,
    })
}

/// Reads a row; an empty value was not measured.
fn row(
    text: Text<'_>,
    layout: &Layout,
    line: Range<usize>,
    angles: &mut Angles,
) -> Result<Option<Row>, FormatError> {
    let count = layout.count;
    let found: Vec<Range<usize>> = cells(text, line.clone(), layout.separator).take(count + 1).collect();
    if found.len() != count {
        let expected = match count {
            2 => "two columns: the angle from the normal in deg, and the BSDF in 1/sr",
            _ => "as many columns as the header",
        };
        return Err(text.error(line, Problem::Columns { count, expected, found: found.len() }));
    }
    let (angle, value) = (&found[layout.theta], &found[layout.value]);
    let theta = angles.degrees(text, angle.clone(), layout.unit.unwrap_or(DEGREES))?;
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
        let angles = if radials.len() == 1 { "angle" } else { "angles" };
        let what = format!("a scan with {} {angles} of the {}", radials.len(), way.name());
        return Err(
            text.whole(BsdfProblem::Unsupported { what, expected: "at least three angles on each side" })
        );
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

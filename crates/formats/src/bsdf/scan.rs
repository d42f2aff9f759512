//! Reader of goniometer scans: a table of two columns, angle and BSDF, for light along the normal.
//!
//! A scan has one line of directions, and therefore says nothing about other azimuths and other incidences. It is read as the lobe
//! of a sample that is rotationally symmetric about the normal: rings about the specular direction. Angles on the two sides of the
//! normal (negative and positive) are averaged. Above 90 deg, the light is behind the sample: 180 deg is straight through.

use std::ops::Range;

use papilio_goniometry::{Channel, Geometry, MeasuredPart, Measurement, ScatterMode, SpecularGrid, Symmetry};

use super::table_read::{cells, provenance, separator};
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

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

/// Names of the column of angles, without a unit.
const ANGLES: [&str; 8] =
    ["theta", "theta_o", "theta_s", "theta_r", "theta_t", "theta_out", "angle", "scattering_angle"];

/// Columns of a scan.
struct Layout {
    separator: Option<u8>,
    has_header: bool,
    /// The part that the name of the value column states.
    way: Option<ScatterMode>,
}

impl Layout {
    /// Detects the layout from the first line. A line of numbers, or with other names, begins a scan only if the caller states that
    /// the file is one (`is_stated`): other tables have two columns, too.
    fn of(text: Text<'_>, line: Range<usize>, is_stated: bool) -> Option<Self> {
        let separator = separator(text, line.clone());
        let words: Vec<String> = cells(text, line, separator).take(3).map(|cell| text.quote(cell)).collect();
        let [angle, value] = &words[..] else { return None };
        let is_number = |word: &String| word.parse::<f64>().is_ok();
        if words.iter().all(is_number) {
            return is_stated.then_some(Self { separator, has_header: false, way: None });
        }
        if words.iter().any(is_number) {
            return None;
        }
        let way = match without_unit(value, &["1_sr", "sr_1", "per_sr"]).as_str() {
            "btdf" => Some(ScatterMode::FrontTransmission),
            "brdf" => Some(ScatterMode::FrontReflection),
            "bsdf" => None,
            _ if is_stated => None,
            _ => return None,
        };
        let is_angle = ANGLES.contains(&without_unit(angle, &["deg", "degree", "degrees"]).as_str());
        is_angle.then_some(Self { separator, has_header: true, way })
    }
}

/// Returns the name of a column in lower case, without its unit: `theta` of `"Theta (deg)"`.
fn without_unit(name: &str, units: &[&str]) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    let words: Vec<&str> = plain.split('_').filter(|word| !word.is_empty()).collect();
    let name = words.join("_");
    let bare = units.iter().find_map(|unit| name.strip_suffix(unit)?.strip_suffix('_'));
    bare.unwrap_or(&name).to_owned()
}

pub(super) fn is_scan(file: &DataFile, is_stated: bool) -> bool {
    let text = Text::new(file);
    let first = Lines::new(text).next().ok().flatten();
    first.is_some_and(|line| Layout::of(text, line, is_stated).is_some())
}

/// A row: angle, degrees, value, and its place.
type Row = (f64, f64, Range<usize>);

pub(super) fn read(file: &DataFile, is_stated: bool) -> Result<BsdfFile, FormatError> {
    let text = Text::new(file);
    let mut lines = Lines::new(text);
    let first = lines.expect("the first row of data")?;
    let layout =
        Layout::of(text, first.clone(), is_stated).ok_or_else(|| text.whole(BsdfProblem::Unknown))?;
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
    let theta = text.number(angle.clone())?;
    if !(-180.0..=180.0).contains(&theta) {
        let expected = "an angle from -180 to 180 deg, from the normal";
        return Err(text.error(angle.clone(), Problem::OutOfRange { what: "theta", value: theta, expected }));
    }
    if value.is_empty() {
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

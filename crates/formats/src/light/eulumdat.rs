//! Luminaires in EULUMDAT files (.ldt): intensity by direction in planes C.
//!
//! A. W. Stockmar, *EULUMDAT - ein Leuchtendatenformat für den europäischen Beleuchtungsplaner*, Licht '90,
//! 641-644 (1990), and *EULUMDAT/2*, CIBSE National Lighting Conference 1998, 353-362: one value in each
//! line. Intensities are in cd per 1000 lm of the lamps; those in cd are for the first set of lamps, times
//! the conversion factor. The length of the luminaire is across the plane C = 0. Decimal commas are read.

use std::ops::Range;

use papilio_diagnostics::{Diagnostic, Place};

use super::luminaire::{Luminaire, Photometry};
use super::numbers::Numbers;
use super::opening::{Opening, OpeningShape};
use crate::error::{FormatError, Problem};

/// Lines before the sets of lamps, and lines of one set.
const LINES: usize = 26;
const LINES_OF_A_SET: usize = 6;
/// Largest number of sets.
const MOST_SETS: f64 = 20.0;
/// Lines of direct ratios after the sets.
const RATIOS: usize = 10;
/// Largest difference between the flux of the intensities and that of the light output ratio without a note.
const SAME_FLUX: f64 = 0.05;

/// Returns true if the lines that hold the symmetry and the numbers of angles do so.
pub(super) fn is_eulumdat(text: &str) -> bool {
    let number =
        |line: usize| -> Option<f64> { text.lines().nth(line - 1)?.trim().replace(',', ".").parse().ok() };
    let is_count = |line| number(line).is_some_and(|count| count >= 1.0 && count.fract() == 0.0);
    // A column of numbers has no names.
    let has_names = [1, 8, 9, 10, 11, 12].into_iter().any(|line| number(line).is_none());
    let is_one_of = |line, most| number(line).is_some_and(|value| (0.0..=most).contains(&value));
    has_names && is_one_of(2, 3.0) && is_one_of(3, 4.0) && is_count(4) && is_count(6)
}

fn problem(what: &str) -> Problem {
    Diagnostic::new(format!("this EULUMDAT file cannot be used: {what}")).into()
}

fn cut() -> Problem {
    problem(
        "the file ends before its last number; it may be cut off, or a count of angles or lamps may be wrong",
    )
}

/// Lines of a file, and their places.
struct Lines<'a> {
    name: &'a str,
    text: &'a str,
    places: Vec<Range<usize>>,
}

impl<'a> Lines<'a> {
    fn new(name: &'a str, text: &'a str) -> Self {
        let mut at = 0;
        let place = |line: &str| {
            let start = at;
            at += line.len();
            start..start + line.trim_end().len()
        };
        Self { name, text, places: text.split_inclusive('\n').map(place).collect() }
    }

    fn place(&self, line: usize) -> Result<Range<usize>, FormatError> {
        let missing = || FormatError::whole(self.name, cut());
        self.places.get(line - 1).cloned().ok_or_else(missing)
    }

    fn text(&self, line: usize) -> Result<&'a str, FormatError> {
        Ok(self.text[self.place(line)?].trim())
    }

    /// Returns the number in a line, counted from 1.
    fn number(
        &self,
        line: usize,
        what: &'static str,
        range: (f64, f64),
        expected: &'static str,
    ) -> Result<f64, FormatError> {
        let place = self.place(line)?;
        let error =
            |problem| FormatError { place: Place::in_text(self.name, self.text, place.clone()), problem };
        let word = self.text(line)?;
        let Ok(value) = word.replace(',', ".").parse::<f64>() else {
            return Err(error(Problem::NotANumber { found: word.chars().take(40).collect() }));
        };
        // Not a number is in no range.
        if (range.0..=range.1).contains(&value) {
            return Ok(value);
        }
        Err(error(Problem::OutOfRange { what, value, expected }))
    }

    /// As [`Self::number`]; 0 for an empty line, as programs write it for unknown values.
    fn optional(
        &self,
        line: usize,
        what: &'static str,
        range: (f64, f64),
        expected: &'static str,
    ) -> Result<f64, FormatError> {
        if self.text(line)?.is_empty() { Ok(0.0) } else { self.number(line, what, range, expected) }
    }

    fn count(&self, line: usize, what: &'static str) -> Result<usize, FormatError> {
        let expected = "an integer from 1 to 2000";
        let value = self.number(line, what, (1.0, 2000.0), expected)?;
        if value.fract() == 0.0 {
            return Ok(value as usize);
        }
        let place = Place::in_text(self.name, self.text, self.place(line)?);
        Err(FormatError { place, problem: Problem::OutOfRange { what, value, expected } })
    }
}

/// Reads a EULUMDAT file.
pub(super) fn read(name: &str, text: &str) -> Result<Luminaire, FormatError> {
    let lines = Lines::new(name, text);
    let symmetry = lines.number(3, "the symmetry", (0.0, 4.0), "0, 1, 2, 3 or 4")?;
    let planes = lines.count(4, "the number of planes C")?;
    let rows = lines.count(6, "the number of angles of each plane")?;
    let opening = opening(&lines)?;
    let conversion = lines.number(24, "the conversion factor", (1e-9, 1e9), "a number from 1e-9 to 1e9")?;
    let mut notes = Vec::new();
    let tilt = lines.optional(25, "the tilt", (-360.0, 360.0), "an angle from -360 to 360 deg")?;
    if tilt != 0.0 {
        notes.push(format!(
            "the luminaire was tilted by {tilt} deg when it was measured, which is not used: it hangs level"
        ));
    }
    let sets =
        lines.number(LINES, "the number of sets of lamps", (1.0, MOST_SETS), "an integer from 1 to 20")?;
    let lumens = |set: usize| {
        let line = LINES + LINES_OF_A_SET * set + 3;
        lines.number(line, "the luminous flux of the lamps", (1e-9, 1e9), "a flux from 1e-9 to 1e9 lm")
    };
    let lamps = lumens(0)?;
    for set in 1..sets as usize {
        notes.push(format!(
            "set {} of lamps, of {} lm, is not used: intensities are those of the first set, of {lamps} lm",
            set + 1,
            lumens(set)?
        ));
    }
    let first = LINES + LINES_OF_A_SET * sets as usize + RATIOS + 1;
    let mut numbers = Numbers { name, text, at: lines.place(first)?.start, comma_separates: false, cut };
    let expected = "ascending angles, from 0 to 360 deg (C) or 0 to 180 deg (from the nadir)";
    let all = numbers.angles(planes, "the angle of a plane C", (0.0, 360.0), expected)?;
    let vertical_deg = numbers.angles(rows, "the angle in a plane C", (0.0, 180.0), expected)?;
    let stored = stored(name, &all, symmetry)?;
    let values = numbers.intensities(rows * stored.len(), conversion * lamps / 1000.0)?;
    if let Some(place) = numbers.surplus() {
        let what = "a number follows the last intensity; the symmetry or a count of angles may be wrong";
        return Err(numbers.error(place, problem(what)));
    }
    let (horizontal_deg, candela) = ascending(&stored, &values, rows, symmetry);
    let mut luminaire =
        Luminaire { photometry: Photometry::C, vertical_deg, horizontal_deg, candela, opening, notes };
    let per_cent = |line, what| lines.optional(line, what, (0.0, 1e4), "a percentage");
    let ratios = [per_cent(22, "the downward flux fraction")?, per_cent(23, "the light output ratio")?];
    check_flux(&mut luminaire, ratios, lamps);
    Ok(luminaire)
}

/// Returns the luminous area. Its length is across C = 0; a width of 0 means that it is round.
fn opening(lines: &Lines<'_>) -> Result<Opening, FormatError> {
    let side = |line, what| Ok(lines.optional(line, what, (0.0, 1e6), "a length from 0 to 1e6 mm")? / 1000.0);
    let length = side(16, "the length of the luminous area")?;
    let width = side(17, "the width of the luminous area")?;
    let mut height_m = [0.0; 4];
    for (k, height) in height_m.iter_mut().enumerate() {
        *height = side(18 + k, "the height of the luminous area")?;
    }
    let is_round = width == 0.0;
    Ok(Opening {
        shape: match (length, is_round) {
            (0.0, _) => OpeningShape::Point,
            (_, true) => OpeningShape::VerticalCylinder,
            _ => OpeningShape::Box,
        },
        along_m: if is_round { length } else { width },
        across_m: length,
        height_m,
    })
}

/// Returns the planes whose intensities the file holds, in its order.
fn stored(name: &str, planes: &[f64], symmetry: f64) -> Result<Vec<f64>, FormatError> {
    let from_to = |from: f64, to: f64| -> Option<Vec<f64>> {
        let stored: Vec<f64> = planes.iter().copied().filter(|plane| (from..=to).contains(plane)).collect();
        (stored.first() == Some(&from) && stored.last() == Some(&to)).then_some(stored)
    };
    let found = match symmetry as u8 {
        0 => (planes[0] == 0.0).then(|| planes.to_vec()),
        1 => Some(vec![0.0]),
        2 => from_to(0.0, 180.0),
        // From C = 270 deg over 0 to 90 deg.
        3 => from_to(0.0, 90.0).and_then(|end| {
            let start = planes.iter().copied().filter(|plane| (270.0..360.0).contains(plane));
            let stored: Vec<f64> = start.chain(end).collect();
            (stored[0] == 270.0).then_some(stored)
        }),
        4 => from_to(0.0, 90.0),
        _ => None,
    };
    found.ok_or_else(|| FormatError::whole(name, problem(
            "the symmetry needs planes C that the file does not list: 0; 0 to 180; 270 to 90; or 0 to 90 deg",
        )))
}

/// Returns the planes in ascending order, as the symmetries of type C need them, and their intensities.
fn ascending(stored: &[f64], values: &[f64], rows: usize, symmetry: f64) -> (Vec<f64>, Vec<f64>) {
    let planes = stored.iter().copied().zip(values.chunks_exact(rows));
    let planes: Vec<(f64, &[f64])> = match symmetry as u8 {
        // The mirror images of these planes, from 90 to 270 deg.
        3 => planes.map(|(plane, values)| ((180.0 - plane).rem_euclid(360.0), values)).rev().collect(),
        0 => {
            let first = (360.0, &values[..rows]);
            let is_open = stored.last().is_some_and(|last| *last < 360.0);
            planes.chain((is_open && stored.len() > 1).then_some(first)).collect()
        }
        _ => planes.collect(),
    };
    (planes.iter().map(|plane| plane.0).collect(), planes.iter().flat_map(|plane| plane.1).copied().collect())
}

/// Notes intensities whose flux is not that of the light output ratio, or whose downward fraction is not the
/// stated one.
fn check_flux(luminaire: &mut Luminaire, [downward, output]: [f64; 2], lamps: f64) {
    let [flux, below] = luminaire.flux_lm();
    let found = 100.0 * flux / lamps;
    if output > 0.0 && (found / output - 1.0).abs() > SAME_FLUX {
        luminaire.notes.push(format!(
            "the intensities have a flux of {found:.1} % of that of the lamps; the file states a light output ratio of {output} %, \
             which is not used"
        ));
    }
    let found = 100.0 * below / flux.max(1e-300);
    if downward > 0.0 && (found - downward).abs() > 100.0 * SAME_FLUX {
        luminaire.notes.push(format!(
            "{found:.1} % of the flux of the intensities goes down; the file states {downward} %, which is not used"
        ));
    }
}

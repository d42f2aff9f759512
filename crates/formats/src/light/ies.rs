//! Luminaires in IES LM-63 files (.ies), 1986 to 2019: intensity by direction, photometry of types A, B and
//! C.
//!
//! ANSI/IES LM-63-19, *IES standard file format for the electronic transfer of photometric data*, and its
//! editions of 1986, 1991, 1995 and 2002. The first line names the edition; a file without it is of 1986. The
//! number after the ballast factor is the ballast-lamp photometric factor up to LM-63-1995; LM-63-2002
//! reserves it, and LM-63-2019 states the origin of the data by it. `TILT=` describes the light of the
//! luminaire when it is inclined; here it hangs level, so that its factor for 0 deg counts.

use std::ops::Range;

use papilio_diagnostics::Diagnostic;

use super::luminaire::{Luminaire, Photometry};
use super::numbers::Numbers;
use super::opening::{Edition, by_signs};
use crate::error::{FormatError, Problem};

/// First words of the editions.
const EDITIONS: [(&str, Edition); 8] = [
    ("IESNA86", Edition::Of1986),
    ("IESNA:LM-63-1986", Edition::Of1986),
    ("IESNA91", Edition::Of1991),
    ("IESNA:LM-63-1991", Edition::Of1991),
    ("IESNA:LM-63-1995", Edition::Of1995),
    ("IESNA:LM-63-2002", Edition::Of2002),
    ("IES:LM-63-2019", Edition::Of2019),
    ("IESNA:LM-63-2019", Edition::Of2019),
];

/// Returns true if the text has a line `TILT=`.
pub(super) fn is_ies(text: &str) -> bool {
    tilt_line(text).is_some()
}

/// Reads an IES LM-63 file.
pub(super) fn read(name: &str, text: &str) -> Result<Luminaire, FormatError> {
    let whole = |what| FormatError::whole(name, problem(what));
    let (tilt, after) = tilt_line(text).ok_or_else(|| whole("there is no line `TILT=NONE`"))?;
    let (edition, mut notes) = header(&text[..tilt.start]);
    let mut numbers = Numbers { name, text, at: after, comma_separates: true, cut };
    let factor = match text[tilt].trim() {
        "NONE" => 1.0,
        "INCLUDE" => tilt_factor(&mut numbers, &mut notes)?,
        file => {
            notes.push(format!(
                "TILT={file} is not read: the luminaire hangs level, where the factor of its light is taken as 1"
            ));
            1.0
        }
    };
    luminaire(numbers, edition, factor, notes)
}

fn problem(what: &str) -> Problem {
    Diagnostic::new(format!("this IES LM-63 file cannot be used: {what}")).into()
}

fn cut() -> Problem {
    problem("the file ends before its last number; it may be cut off, or a count of angles may be wrong")
}

/// Returns the edition, and notes about keywords that change the meaning of the numbers.
fn header(text: &str) -> (Edition, Vec<String>) {
    let mut lines = text.lines();
    let first = lines.clone().next().unwrap_or_default().trim().to_ascii_uppercase();
    let known = EDITIONS.iter().find(|(word, _)| first.starts_with(word));
    let mut notes = Vec::new();
    let edition = match known {
        Some((_, edition)) => *edition,
        // A later edition keeps the rules of the last.
        None if first.starts_with("IES") && first.contains("LM-63-20") => {
            notes.push(format!("its edition, {first}, is not known: it is read as LM-63-2019"));
            Edition::Of2019
        }
        None => Edition::Of1986,
    };
    // [MORE] continues the line before it.
    let mut keyword = String::new();
    for line in lines.by_ref().map(str::trim) {
        let Some((word, value)) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) else {
            continue;
        };
        if word != "MORE" {
            keyword = word.to_ascii_uppercase();
        }
        let value = value.trim();
        if keyword == "NEARFIELD" && !value.is_empty() {
            notes.push(format!(
                "[NEARFIELD] {value}: the file is meant for near distances; it is used as a far field"
            ));
        }
    }
    (edition, notes)
}

/// Returns the place of the value of `TILT=`, and the start of the numbers.
fn tilt_line(text: &str) -> Option<(Range<usize>, usize)> {
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let start = line.trim_start();
        if let Some(value) = start.strip_prefix("TILT").and_then(|rest| rest.trim_start().strip_prefix('=')) {
            let start = at + line.len() - value.trim_start().len();
            return Some((start..start + value.trim().len(), at + line.len()));
        }
        at += line.len();
    }
    None
}

/// Reads the block of `TILT=INCLUDE`; returns the factor of a level luminaire.
fn tilt_factor(numbers: &mut Numbers<'_>, notes: &mut Vec<String>) -> Result<f64, FormatError> {
    numbers.within("the geometry of lamp and luminaire", (1.0, 3.0), "1, 2 or 3")?;
    let count = numbers.count("the number of angles of TILT")?;
    let expected = "ascending angles from 0 to 180 deg";
    let angles = numbers.angles(count, "the angle of TILT", (0.0, 180.0), expected)?;
    let mut factors = Vec::new();
    for _ in 0..count {
        factors.push(numbers.within("the factor of TILT", (0.0, 1e3), "a factor from 0 to 1000")?);
    }
    let factor = if angles[0] == 0.0 { factors[0] } else { 1.0 };
    notes.push(format!(
        "TILT: the luminaire hangs level, for which the factor of its light is {factor}; the factors of other angles are not used"
    ));
    Ok(factor)
}

fn luminaire(
    mut numbers: Numbers<'_>,
    edition: Edition,
    tilt: f64,
    mut notes: Vec<String>,
) -> Result<Luminaire, FormatError> {
    let any = (f64::MIN, f64::MAX);
    numbers.within("the number of lamps", any, "")?;
    // Intensities are those of the luminaire with its lamps; -1 means that they were measured without
    // reference to lamps.
    numbers.within("lumens per lamp", any, "")?;
    let positive = (1e-9, 1e9);
    let multiplier = numbers.within("the multiplier", positive, "a number from 1e-9 to 1e9")?;
    let (rows, columns) =
        (numbers.count("the number of vertical angles")?, numbers.count("the number of horizontal angles")?);
    let photometry = match numbers.next()? {
        (1.0, _) => Photometry::C,
        (2.0, _) => Photometry::B,
        (3.0, _) => Photometry::A,
        (value, place) => {
            let (what, expected) = ("the photometric type", "1 (type C), 2 (type B) or 3 (type A)");
            return Err(numbers.error(place, Problem::OutOfRange { what, value, expected }));
        }
    };
    let unit = numbers.within("the unit", (1.0, 2.0), "1 (feet) or 2 (metres)")?;
    let metres = if unit == 1.0 { 0.3048 } else { 1.0 };
    let (mut sides, mut place) = ([0.0; 3], numbers.at..numbers.at);
    for side in &mut sides {
        *side = metres * numbers.within("a side of the opening", (-1e4, 1e4), "a length from -1e4 to 1e4")?;
    }
    place.end = numbers.at;
    let Some(opening) = by_signs(edition, sides) else {
        let what = "width, length and height of the opening have signs that no edition of LM-63 defines";
        return Err(numbers.error(place, problem(what)));
    };
    let ballast = numbers.within("the ballast factor", positive, "a number from 1e-9 to 1e9")?;
    let lamp = if edition <= Edition::Of1995 {
        numbers.within("the ballast-lamp photometric factor", positive, "a number from 1e-9 to 1e9")?
    } else {
        let number = numbers.within("the number after the ballast factor", any, "")?;
        notes.extend(origin(edition, number));
        1.0
    };
    numbers.within("the input power", any, "")?;
    let (vertical_deg, mut horizontal_deg) = angles(&mut numbers, photometry, [rows, columns])?;
    let factor = multiplier * ballast * lamp * tilt;
    let mut candela = numbers.intensities(rows * columns, factor)?;
    if let Some(place) = numbers.surplus() {
        let what = "a number follows the last intensity; a count of angles may be wrong, or a row may have too many numbers";
        return Err(numbers.error(place, problem(what)));
    }
    // Without symmetry the last angle may be below 360 deg: the first plane follows it.
    let last = horizontal_deg.last().copied().unwrap_or_default();
    if photometry == Photometry::C && horizontal_deg[0] == 0.0 && last > 180.0 && last < 360.0 {
        horizontal_deg.push(360.0);
        candela.extend_from_within(..rows);
    }
    Ok(Luminaire { photometry, vertical_deg, horizontal_deg, candela, opening, notes })
}

/// Returns a note on the origin of the data by LM-63-2019: digits after the point for an accredited
/// laboratory, interpolation, scaled flux, simulation, unknown origin.
fn origin(edition: Edition, number: f64) -> Option<String> {
    if edition < Edition::Of2019 {
        return (number != 1.0)
            .then(|| format!("the number after the ballast factor, {number}, is not used"));
    }
    let digits = ((number - 1.0) * 1e5).round();
    let digit = |place: f64| (digits / place).floor() % 10.0 == 1.0;
    if !(0.0..=11_111.0).contains(&digits) {
        return Some(format!("the type of its generation, {number}, is not one of LM-63-2019"));
    }
    let words =
        [(1e3, "interpolated"), (1e2, "scaled in flux"), (1e1, "simulated"), (1.0, "of unknown origin")];
    let found: Vec<&str> =
        words.into_iter().filter(|(place, _)| digit(*place)).map(|(_, word)| word).collect();
    (!found.is_empty())
        .then(|| format!("its intensities are {} (type of generation {number})", found.join(", ")))
}

/// Returns whether these angles from 0 lack only 360 deg: the next step would end there.
fn ends_one_step_early(angles_deg: &[f64]) -> bool {
    /// Angles are written with a decimal or two.
    const ROUNDED_DEG: f64 = 0.1;
    let last = angles_deg[angles_deg.len() - 1];
    angles_deg.len() > 2 && {
        let steps = [angles_deg[1] - angles_deg[0], last - angles_deg[angles_deg.len() - 2]];
        steps.iter().any(|step| (360.0 - last - step).abs() <= ROUNDED_DEG)
    }
}

fn angles(
    numbers: &mut Numbers<'_>,
    photometry: Photometry,
    [rows, columns]: [usize; 2],
) -> Result<(Vec<f64>, Vec<f64>), FormatError> {
    if photometry != Photometry::C {
        let (range, expected) = ((-90.0, 90.0), "ascending angles from -90 to 90 deg");
        let vertical = numbers.angles(rows, "the vertical angle", range, expected)?;
        let horizontal = numbers.angles(columns, "the horizontal angle", range, expected)?;
        let [first, last] = [horizontal[0], horizontal[columns - 1]];
        if columns > 1 && last == 90.0 && (first == 0.0 || first == -90.0) {
            return Ok((vertical, horizontal));
        }
        let what = "the horizontal angles have none of the symmetries of types A and B; expected angles from 0 or -90 to 90 deg";
        return Err(FormatError::whole(numbers.name, problem(what)));
    }
    let expected = "ascending angles, from 0 to 180 deg (vertical) or 0 to 360 deg (horizontal)";
    let vertical = numbers.angles(rows, "the vertical angle", (0.0, 180.0), expected)?;
    let horizontal = numbers.angles(columns, "the horizontal angle", (0.0, 360.0), expected)?;
    let (first, last) = (horizontal[0], horizontal[columns - 1]);
    let known = if first == 0.0 {
        columns == 1
            || [90.0, 180.0, 360.0].contains(&last)
            || (last > 180.0 && ends_one_step_early(&horizontal))
    } else {
        (first, last) == (90.0, 270.0)
    };
    if known {
        return Ok((vertical, horizontal));
    }
    let what = "the horizontal angles have none of the symmetries of type C; expected one angle of 0, or angles from 0 to 90, \
                0 to 180, 0 to 360 (or to one step before) or 90 to 270 deg";
    Err(FormatError::whole(numbers.name, problem(what)))
}

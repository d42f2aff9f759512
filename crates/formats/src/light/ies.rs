//! Luminaires in IES LM-63 files (.ies), 1986 to 2019: intensity by direction, type C photometry.
//!
//! ANSI/IES LM-63-19, *IES standard file format for the electronic transfer of photometric data*. Vertical angles
//! are measured from the luminaire's nadir, horizontal angles around it. Luminaires whose horizontal angles end at 0, 90 or
//! 180 deg are symmetric, as the standard defines it.

use std::ops::Range;

use papilio_diagnostics::Place;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Largest number of vertical, and of horizontal, angles.
const MOST_ANGLES: usize = 2000;

/// Far field of a luminaire.
#[derive(Debug, Clone, PartialEq)]
pub struct Luminaire {
    /// Angles from the nadir, degrees, ascending.
    vertical_deg: Vec<f64>,
    /// Angles around the nadir, degrees, ascending.
    horizontal_deg: Vec<f64>,
    /// Intensity, cd, `[horizontal][vertical]`, ballast factor and multiplier included.
    candela: Vec<f64>,
    /// Sides of the luminous opening, m; 0 by 0 is a point source.
    pub opening_m: [f64; 2],
    /// Whether the opening is round: an ellipse with these diameters.
    pub is_round: bool,
}

impl Luminaire {
    /// Returns the intensity, cd, in a direction given by the angles from the nadir and around it, degrees. It is interpolated
    /// linearly, and is 0 beyond the last vertical angle.
    pub fn intensity(&self, vertical_deg: f64, horizontal_deg: f64) -> f64 {
        let last = self.horizontal_deg.last().copied().unwrap_or_default();
        let turn = horizontal_deg.rem_euclid(360.0);
        let half = if turn > 180.0 { 360.0 - turn } else { turn };
        let turn = match last {
            last if last <= 0.0 => 0.0,
            last if last <= 90.0 => half.min(180.0 - half),
            last if last <= 180.0 => half,
            _ => turn,
        };
        let (Some((v, along)), Some((h, around))) =
            (between(&self.vertical_deg, vertical_deg), between(&self.horizontal_deg, turn))
        else {
            return 0.0;
        };
        let rows = self.vertical_deg.len();
        let at =
            |h: usize, v: usize| self.candela[h.min(self.horizontal_deg.len() - 1) * rows + v.min(rows - 1)];
        let on = |h: usize| (1.0 - along) * at(h, v) + along * at(h, v + 1);
        (1.0 - around) * on(h) + around * on(h + 1)
    }

    /// Returns the angles between which the intensity is smooth, degrees: from the nadir, and around it modulo 180 deg. Angles that
    /// follow from the symmetry are included.
    pub fn angles_deg(&self) -> [Vec<f64>; 2] {
        let symmetric = self.horizontal_deg.last().is_none_or(|last| *last <= 180.0);
        let turns = self.horizontal_deg.iter().flat_map(|turn| [Some(*turn), symmetric.then_some(-turn)]);
        let mut turns: Vec<f64> = turns.flatten().map(|turn| turn.rem_euclid(180.0)).collect();
        turns.sort_by(f64::total_cmp);
        turns.dedup_by(|a, b| *a - *b < 1e-9);
        if self.horizontal_deg.len() < 2 {
            turns.clear();
        }
        [self.vertical_deg.clone(), turns]
    }

    /// Returns the area of the opening, m2.
    pub fn opening_m2(&self) -> f64 {
        let [a, b] = self.opening_m;
        a * b * if self.is_round { 0.25 * std::f64::consts::PI } else { 1.0 }
    }
}

/// Returns the index of the last of the `angles` that is not larger than `angle`, and the relative position between it and the next
/// one; `None` outside the angles.
fn between(angles: &[f64], angle: f64) -> Option<(usize, f64)> {
    let (first, last) = (*angles.first()?, *angles.last()?);
    if !(first - 1e-9..=last + 1e-9).contains(&angle) {
        return None;
    }
    let k = angles.partition_point(|known| *known <= angle).max(1) - 1;
    let next = angles.get(k + 1).copied().unwrap_or(angles[k] + 1.0);
    Some((k, ((angle - angles[k]) / (next - angles[k])).clamp(0.0, 1.0)))
}

/// Reads an IES LM-63 file.
///
/// # Errors
/// With line and column: cells that are not numbers, angles out of order, negative intensities, photometry of type A or B, a
/// tilt, too few numbers.
pub fn read_ies(file: &DataFile) -> Result<Luminaire, FormatError> {
    let text = file.text()?;
    let whole = |what| FormatError { place: Place::whole(&file.name), problem: Problem::Ies { what } };
    let (tilt, after) = tilt_line(text).ok_or(whole("there is no line `TILT=NONE`"))?;
    if text[tilt.clone()].trim() != "NONE" {
        let place = Place::in_text(&file.name, text, tilt);
        return Err(FormatError {
            place,
            problem: Problem::Ies {
                what: "luminaires whose light depends on the tilt are not supported; expected `TILT=NONE`",
            },
        });
    }
    Numbers { name: &file.name, text, at: after }.luminaire()
}

/// Returns the place of the value of `TILT=`, and the start of the numbers.
fn tilt_line(text: &str) -> Option<(Range<usize>, usize)> {
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if let Some(value) = line.trim_start().strip_prefix("TILT=") {
            let start = at + line.len() - value.len();
            return Some((start..start + value.trim_end().len(), at + line.len()));
        }
        at += line.len();
    }
    None
}

/// Reader of numbers that are separated by blanks, commas and newlines.
struct Numbers<'a> {
    name: &'a str,
    text: &'a str,
    at: usize,
}

impl Numbers<'_> {
    fn error(&self, place: Range<usize>, problem: Problem) -> FormatError {
        FormatError { place: Place::in_text(self.name, self.text, place), problem }
    }

    fn next(&mut self) -> Result<(f64, Range<usize>), FormatError> {
        let separates = |c: char| c.is_whitespace() || c == ',';
        let rest = &self.text[self.at..];
        let start = self.at + rest.find(|c| !separates(c)).unwrap_or(rest.len());
        let rest = &self.text[start..];
        let word = &rest[..rest.find(separates).unwrap_or(rest.len())];
        let place = start..start + word.len();
        self.at = place.end;
        if word.is_empty() {
            let problem = Problem::Ies {
                what: "the file ends before its last number; it may be cut off, or a count of angles may be wrong",
            };
            return Err(FormatError { place: Place::whole(self.name), problem });
        }
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok((number, place)),
            Ok(_) => Err(self.error(place, Problem::NotFinite { found: word.to_owned() })),
            Err(_) => Err(self.error(place, Problem::NotANumber { found: word.chars().take(40).collect() })),
        }
    }

    fn within(
        &mut self,
        what: &'static str,
        range: (f64, f64),
        expected: &'static str,
    ) -> Result<f64, FormatError> {
        let (value, place) = self.next()?;
        if (range.0..=range.1).contains(&value) {
            return Ok(value);
        }
        Err(self.error(place, Problem::OutOfRange { what, value, expected }))
    }

    fn count(&mut self, what: &'static str) -> Result<usize, FormatError> {
        let (value, place) = self.next()?;
        if value.fract() == 0.0 && (1.0..=MOST_ANGLES as f64).contains(&value) {
            return Ok(value as usize);
        }
        Err(self.error(place, Problem::OutOfRange { what, value, expected: "an integer from 1 to 2000" }))
    }

    fn angles(&mut self, count: usize, what: &'static str, most: f64) -> Result<Vec<f64>, FormatError> {
        let mut angles: Vec<f64> = Vec::with_capacity(count);
        for _ in 0..count {
            let (value, place) = self.next()?;
            let ascends = angles.last().is_none_or(|last| *last < value);
            if !ascends || !(0.0..=most).contains(&value) {
                let expected = "ascending angles, from 0 to 180 deg (vertical) or 0 to 360 deg (horizontal)";
                return Err(self.error(place, Problem::OutOfRange { what, value, expected }));
            }
            angles.push(value);
        }
        Ok(angles)
    }

    fn luminaire(mut self) -> Result<Luminaire, FormatError> {
        let any = (f64::MIN, f64::MAX);
        self.within("the number of lamps", any, "")?;
        self.within("lumens per lamp", any, "")?;
        let positive = (1e-9, 1e9);
        let multiplier = self.within("the multiplier", positive, "a number from 1e-9 to 1e9")?;
        let (rows, columns) =
            (self.count("the number of vertical angles")?, self.count("the number of horizontal angles")?);
        self.within("the photometric type", (1.0, 1.0), "1 (type C)")?;
        let unit = self.within("the unit", (1.0, 2.0), "1 (feet) or 2 (metres)")?;
        let metres = if unit == 1.0 { 0.3048 } else { 1.0 };
        let mut sides = [0.0; 3];
        for side in &mut sides {
            *side =
                metres * self.within("a side of the opening", (-1e4, 1e4), "a length from -1e4 to 1e4")?;
        }
        let ballast = self.within("the ballast factor", positive, "a number from 1e-9 to 1e9")?;
        self.within("the number after the ballast factor", any, "")?;
        self.within("the input power", any, "")?;
        let vertical_deg = self.angles(rows, "the vertical angle", 180.0)?;
        let horizontal_deg = self.angles(columns, "the horizontal angle", 360.0)?;
        let mut candela = Vec::new();
        for _ in 0..rows * columns {
            let value = self.within("the intensity", (0.0, 1e12), "an intensity from 0 to 1e12 cd")?;
            candela.push(value * multiplier * ballast);
        }
        Ok(Luminaire {
            vertical_deg,
            horizontal_deg,
            candela,
            opening_m: [sides[0].abs(), sides[1].abs()],
            is_round: sides[0] < 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Luminaire, FormatError> {
        read_ies(&DataFile { name: "luminaire.ies".into(), bytes: text.as_bytes().to_vec() })
    }

    const LUMINAIRE: &str = "IESNA:LM-63-2002\n[TEST] synthetic\nTILT=NONE\n1 1000 2 3 2 1 2 0.6 0.6 0\n0.5 1 30\n\
        0 45 90\n0 90\n100 80 0\n100 40 0\n";

    #[test]
    fn intensity_between_angles_is_linear_and_symmetric() {
        let luminaire = read(LUMINAIRE).unwrap();
        assert_eq!(luminaire.intensity(0.0, 12.0), 100.0);
        assert_eq!(luminaire.intensity(45.0, 0.0), 80.0);
        // The file holds one quadrant, which is mirrored into the others.
        for turn in [45.0, 135.0, 225.0, 315.0, -45.0] {
            assert!((luminaire.intensity(22.5, turn) - 80.0).abs() < 1e-12, "{turn}");
        }
        assert_eq!(luminaire.intensity(91.0, 0.0), 0.0);
        assert_eq!((luminaire.opening_m, luminaire.is_round), ([0.6, 0.6], false));
    }

    #[test]
    fn malformed_luminaire_is_an_error_with_its_reason() {
        for (from, to, wanted) in [
            ("TILT=NONE", "TILT=INCLUDE", "expected `TILT=NONE`"),
            ("TILT=NONE\n", "", "there is no line `TILT=NONE`"),
            ("2 3 2 1 2", "2 3 2 2 2", "expected 1 (type C)"),
            ("2 3 2 1 2", "2 3e9 2 1 2", "expected an integer from 1 to 2000"),
            ("0 45 90", "0 95 90", "expected ascending angles"),
            ("100 40 0", "100 -40 0", "expected an intensity from 0 to 1e12 cd"),
            ("100 40 0\n", "100", "ends before its last number"),
            ("100 40 0", "100 forty 0", "`forty` is not a number"),
        ] {
            assert!(LUMINAIRE.contains(from));
            let error = read(&LUMINAIRE.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(wanted) && error.contains("luminaire.ies"), "{error}");
        }
    }
}

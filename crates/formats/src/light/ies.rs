//! Luminaires in IES LM-63 files (.ies), 1986 to 2019: intensity by direction, type C photometry.
//!
//! ANSI/IES LM-63-19, *IES standard file format for the electronic transfer of photometric data*. Vertical angles
//! are measured from the luminaire's nadir, horizontal angles around it. Luminaires whose horizontal angles end at 0, 90 or
//! 180 deg, or that extend from 90 to 270 deg, are symmetric, as the standard defines it. The number after the ballast factor
//! is the ballast-lamp photometric factor up to LM-63-1995; later editions reserve it, and it has no effect. A negative side of the
//! luminous opening is a diameter. Header lines may be UTF-8 or Latin-1.

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
        let first = self.horizontal_deg.first().copied().unwrap_or_default();
        let last = self.horizontal_deg.last().copied().unwrap_or_default();
        let turn = horizontal_deg.rem_euclid(360.0);
        // Files from 90 to 270 deg are symmetric about the plane through these angles.
        let turn = if first > 0.0 && !(90.0..=270.0).contains(&turn) {
            (180.0 - turn).rem_euclid(360.0)
        } else {
            turn
        };
        let half = if turn > 180.0 { 360.0 - turn } else { turn };
        let turn = match last {
            last if last <= 0.0 => 0.0,
            last if last <= 90.0 => half.min(180.0 - half),
            last if last <= 180.0 => half,
            _ if first > 0.0 => turn.clamp(first, last),
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
        let halved = self.horizontal_deg.first().is_some_and(|first| *first > 0.0);
        let symmetric = halved || self.horizontal_deg.last().is_none_or(|last| *last <= 180.0);
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

/// Returns the sides of the opening's projection below the luminaire, m, from width, length and height. A negative number is a
/// diameter; a circle is width alone (editions up to 1995) or equal width and length.
fn opening([width, length, _height]: [f64; 3]) -> [f64; 2] {
    let diameter = if width < 0.0 { width.abs() } else { length.abs() };
    let side = |side: f64| if side == 0.0 && (width < 0.0 || length < 0.0) { diameter } else { side.abs() };
    [side(width), side(length)]
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
/// tilt, too few or too many numbers, horizontal angles of no symmetry of the standard.
pub fn read_ies(file: &DataFile) -> Result<Luminaire, FormatError> {
    crate::guard::read(file, of_text)
}

fn of_text(file: &DataFile) -> Result<Luminaire, FormatError> {
    let latin: String;
    let text = match str::from_utf8(&file.bytes) {
        Ok(_) => file.text()?,
        Err(_) => {
            latin = file.bytes.iter().map(|byte| char::from(*byte)).collect();
            &latin
        }
    };
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
    let numbers = Numbers { name: &file.name, text, at: after };
    numbers.luminaire(has_lamp_factor(text))
}

/// Returns whether the number after the ballast factor is the ballast-lamp photometric factor: in LM-63-1986 (no first line of
/// its own), 1991 and 1995.
fn has_lamp_factor(text: &str) -> bool {
    let first = text.trim_start_matches('\u{feff}').lines().next().unwrap_or_default().trim();
    let edition = first.rsplit_once("LM-63-").map(|(_, year)| year.trim());
    edition.is_none_or(|year| ["1986", "86", "1991", "91", "1995", "95"].contains(&year))
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

    fn luminaire(mut self, has_lamp_factor: bool) -> Result<Luminaire, FormatError> {
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
        let lamp = if has_lamp_factor {
            self.within("the ballast-lamp photometric factor", positive, "a number from 1e-9 to 1e9")?
        } else {
            self.within("the number after the ballast factor", any, "")?;
            1.0
        };
        self.within("the input power", any, "")?;
        let vertical_deg = self.angles(rows, "the vertical angle", 180.0)?;
        let mut horizontal_deg = self.angles(columns, "the horizontal angle", 360.0)?;
        self.symmetry(&horizontal_deg)?;
        let mut candela = Vec::new();
        for _ in 0..rows * columns {
            let value = self.within("the intensity", (0.0, 1e12), "an intensity from 0 to 1e12 cd")?;
            candela.push(value * multiplier * ballast * lamp);
        }
        self.end()?;
        // Without symmetry the last angle may be below 360 deg: the first plane follows it.
        let last = horizontal_deg.last().copied().unwrap_or_default();
        if horizontal_deg[0] == 0.0 && last > 180.0 && last < 360.0 {
            horizontal_deg.push(360.0);
            candela.extend_from_within(..rows);
        }
        Ok(Luminaire {
            vertical_deg,
            horizontal_deg,
            candela,
            opening_m: opening(sides),
            is_round: sides[0] < 0.0 || sides[1] < 0.0,
        })
    }

    /// Fails unless the horizontal angles belong to one of the standard's symmetries.
    fn symmetry(&self, angles: &[f64]) -> Result<(), FormatError> {
        let (first, last) = (angles[0], angles[angles.len() - 1]);
        let known = if first == 0.0 {
            angles.len() == 1 || [90.0, 180.0].contains(&last) || last > 180.0
        } else {
            (first, last) == (90.0, 270.0)
        };
        if known {
            return Ok(());
        }
        let what = "the horizontal angles have none of the symmetries of type C; expected one angle of 0, or angles from 0 to 90, \
                    0 to 180, 0 to 360 or 90 to 270 deg";
        Err(FormatError { place: Place::whole(self.name), problem: Problem::Ies { what } })
    }

    /// Fails if a word follows the last number.
    fn end(&mut self) -> Result<(), FormatError> {
        let rest = &self.text[self.at..];
        let separates = |c: char| c.is_whitespace() || c == ',' || c == '\u{1a}';
        let Some(start) = rest.find(|c| !separates(c)) else { return Ok(()) };
        let word = &rest[start..];
        let start = self.at + start;
        let place = start..start + word.find(separates).unwrap_or(word.len());
        let what = "a number follows the last intensity; a count of angles may be wrong, or a row may have too many numbers";
        Err(self.error(place, Problem::Ies { what }))
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
    fn round_opening_has_its_diameter_in_every_edition() {
        for (edition, opening) in [
            ("LM-63-1995", "-0.6 0 0"),
            ("LM-63-1991", "-0.6 0 0"),
            ("LM-63-2002", "-0.6 -0.6 0"),
            ("LM-63-2019", "-0.6 -0.6 0"),
        ] {
            let text = LUMINAIRE.replace("LM-63-2002", edition).replace("0.6 0.6 0", opening);
            let luminaire = read(&text).unwrap();
            assert_eq!((luminaire.opening_m, luminaire.is_round), ([0.6, 0.6], true), "{edition}");
            assert!((luminaire.opening_m2() - std::f64::consts::PI * 0.09).abs() < 1e-12);
        }
    }

    /// 1 and 0.9: ballast factor 0.5 of the file, times 0.9 up to 1995.
    #[test]
    fn ballast_lamp_factor_counts_up_to_1995() {
        for (edition, wanted) in [
            ("IESNA:LM-63-1995", 90.0),
            ("IESNA91", 90.0),
            ("IESNA:LM-63-1991", 90.0),
            ("IESNA:LM-63-2002", 100.0),
            ("IES:LM-63-2019", 100.0),
        ] {
            let text = LUMINAIRE.replace("IESNA:LM-63-2002", edition).replace("0.5 1 30", "0.5 0.9 30");
            assert!((read(&text).unwrap().intensity(0.0, 0.0) - wanted).abs() < 1e-12, "{edition}");
        }
    }

    /// Intensities at 45 deg from the nadir by plane, and those of the planes that symmetry adds.
    #[test]
    fn each_symmetry_of_the_horizontal_angles_is_completed() {
        for (angles, wanted) in [
            ("0", [10.0, 10.0, 10.0, 10.0]),
            ("0 90", [10.0, 20.0, 10.0, 20.0]),
            ("0 90 180", [10.0, 20.0, 30.0, 20.0]),
            ("90 180 270", [20.0, 10.0, 20.0, 30.0]),
            ("0 90 180 270 360", [10.0, 20.0, 30.0, 40.0]),
            ("0 90 180 270", [10.0, 20.0, 30.0, 40.0]),
        ] {
            let count = angles.split(' ').count();
            let levels = [10.0, 20.0, 30.0, 40.0, 10.0];
            let rows: String = levels[..count].iter().map(|level| format!("{level} {level}\n")).collect();
            let text = format!("TILT=NONE\n1 -1 1 2 {count} 1 2 0 0 0\n1 1 30\n0 90\n{angles}\n{rows}");
            let luminaire = read(&text).unwrap();
            for (turn, wanted) in [0.0, 90.0, 180.0, 270.0].into_iter().zip(wanted) {
                assert!((luminaire.intensity(45.0, turn) - wanted).abs() < 1e-12, "{angles}: {turn}");
            }
        }
    }

    #[test]
    fn header_in_latin_1_is_read() {
        let mut bytes = LUMINAIRE.as_bytes().to_vec();
        let at = LUMINAIRE.find("synthetic").unwrap();
        bytes[at] = 0xe9;
        let file = DataFile { name: "luminaire.ies".into(), bytes };
        assert_eq!(read_ies(&file).unwrap(), read(LUMINAIRE).unwrap());
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
            ("100 40 0\n", "100 40 0 7\n", "a number follows the last intensity"),
            ("0 90\n100", "0 60\n100", "none of the symmetries"),
            ("100 40 0", "100 forty 0", "`forty` is not a number"),
        ] {
            assert!(LUMINAIRE.contains(from));
            let error = read(&LUMINAIRE.replace(from, to)).unwrap_err().to_string();
            assert!(error.contains(wanted) && error.contains("luminaire.ies"), "{error}");
        }
    }
}

//! Reader of ASTM E1392 (and its successor E2387): a header of keywords, a line `VARS` with the names of the
//! columns, and rows of angles in radians and values.

use std::ops::Range;

use papilio_goniometry::{Channel, Measurement, Provenance};

use super::angles::RADIANS;
use super::table_read::is_front_reflection;
use super::table_rows::Rows;
use super::text::{Lines, Text};
use super::{BsdfFile, BsdfProblem};
use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Name of the format.
const NAME: &str = "ASTM E1392";

/// Longest header, lines.
const LONGEST_HEADER: usize = 1000;

/// Largest number of values in a row.
const MOST_CHANNELS: usize = 1000;

/// Columns of angles, in the order of the file.
const ANGLES: [&str; 4] = ["theta_i", "phi_i", "theta_s", "phi_s"];

/// Returns whether a file has the header of this format.
pub(super) fn is_astm(file: &DataFile) -> bool {
    let text = Text::new(file);
    let mut lines = Lines::new(text);
    for _ in 0..LONGEST_HEADER {
        let Ok(Some(line)) = lines.next() else { return false };
        let mut words = text.words(line);
        let Some(key) = words.next() else { return false };
        if text.is(&key, "VARS") {
            return words.next().is_some_and(|word| text.is(&word, ANGLES[0]));
        }
        if !text.bytes[key.start].is_ascii_alphabetic() {
            return false;
        }
    }
    false
}

pub(super) fn read(file: &DataFile) -> Result<BsdfFile, FormatError> {
    let text = Text::new(file);
    let mut lines = Lines::new(text);
    let mut provenance = Provenance { format: NAME.to_owned(), ..Provenance::default() };
    let (mut points, mut channels) = (None, Vec::new());
    let mut next = Some(lines.expect("the line `VARS`")?);
    // Other keywords may follow `VARS`.
    while let Some(line) = next.take_if(|line| channels.is_empty() || is_keyword(text, line)) {
        next = if channels.is_empty() { Some(lines.expect("the line `VARS`")?) } else { lines.next()? };
        let mut words = text.words(line.clone());
        let Some(key) = words.next() else { continue };
        let value = text.quote(key.end..line.end);
        match text.quote(key).to_ascii_uppercase().as_str() {
            "VARS" if channels.is_empty() => channels = columns(text, &line)?,
            "VARS" => return Err(text.error(line, BsdfProblem::Twice { what: "the line `VARS`".to_owned() })),
            "NUM_POINTS" => {
                points = words.next().map(|word| Ok((word.clone(), text.number(word)?))).transpose()?
            }
            "SAMPLE" | "SAMPLE_ID" | "SAMPLE_NAME" | "MATERIAL" if provenance.sample.is_empty() => {
                provenance.sample = value;
            }
            "INSTRUMENT" | "LABORATORY" | "SOURCE" if provenance.source.is_empty() => {
                provenance.source = value
            }
            _ if provenance.remarks.len() < LONGEST_HEADER => provenance.remarks.push(text.quote(line)),
            _ => {}
        }
    }
    let mut rows = Rows::default();
    let mut count = 0;
    while let Some(line) = next {
        row(text, line, &channels, &mut rows)?;
        count += 1;
        next = lines.next()?;
    }
    if count == 0 {
        return Err(text.ends("the first row of data"));
    }
    match points {
        Some((place, points)) if points != f64::from(count) => {
            let problem =
                BsdfProblem::Count { what: "rows", found: count as usize, count: points.max(0.0) as usize };
            Err(text.error(place, problem))
        }
        _ => {
            provenance.remarks.append(&mut lines.comments);
            let parts = rows.parts(text)?;
            let states_part = !is_front_reflection(&parts);
            let measurement = Measurement { provenance, media: [1.0, 1.0], parts };
            Ok(BsdfFile {
                measurement,
                warnings: Vec::new(),
                notes: Vec::new(),
                states_part,
                states_side: states_part,
            })
        }
    }
}

/// Returns whether a line begins with a word of letters, digits and underscores that is no number.
fn is_keyword(text: Text<'_>, line: &Range<usize>) -> bool {
    let Some(first) = text.words(line.clone()).next() else { return false };
    let word = String::from_utf8_lossy(&text.bytes[first]);
    word.len() > 1
        && word.starts_with(|letter: char| letter.is_ascii_alphabetic())
        && word.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
        && word.parse::<f64>().is_err()
}

/// Reads the channels of the line `VARS`.
fn columns(text: Text<'_>, line: &Range<usize>) -> Result<Vec<Channel>, FormatError> {
    let mut words = text.words(line.clone()).skip(1);
    for angle in ANGLES {
        let word = words.next().unwrap_or(line.end..line.end);
        if !text.is(&word, angle) {
            let expected = "`VARS theta_i,phi_i,theta_s,phi_s`, followed by the names of the value columns";
            return Err(
                text.error(word.clone(), BsdfProblem::Unexpected { found: text.quote(word), expected })
            );
        }
    }
    let mut channels: Vec<Channel> = Vec::new();
    for word in words {
        let name = text.quote(word.clone());
        let channel = channel(&name).ok_or_else(|| {
            let expected = "R, G, B, X, Y, Z, a wavelength as `550nm`, or BSDF";
            text.error(word.clone(), BsdfProblem::Unexpected { found: name.clone(), expected })
        })?;
        if channels.contains(&channel) {
            return Err(text.error(word, BsdfProblem::Twice { what: name }));
        }
        if channels.len() >= MOST_CHANNELS {
            let expected = "at most 1000 columns of values";
            return Err(text.error(word, BsdfProblem::Unexpected { found: name, expected }));
        }
        channels.push(channel);
    }
    if channels.is_empty() {
        return Err(text.error(line.clone(), BsdfProblem::Missing { what: "column of values" }));
    }
    Ok(channels)
}

fn channel(name: &str) -> Option<Channel> {
    let name = name.to_ascii_lowercase();
    Some(match name.as_str() {
        "r" => Channel::Red,
        "g" => Channel::Green,
        "b" => Channel::Blue,
        "x" => Channel::X,
        "y" => Channel::Y,
        "z" => Channel::Z,
        "bsdf" | "brdf" | "btdf" | "value" => Channel::Monochrome,
        _ => {
            return super::wavelength(name.strip_suffix("nm")?.parse().ok()?);
        }
    })
}

fn row(text: Text<'_>, line: Range<usize>, channels: &[Channel], rows: &mut Rows) -> Result<(), FormatError> {
    let mut angles = [0.0; 4];
    let count = ANGLES.len() + channels.len();
    let found = text.words(line.clone()).take(count + 1).count();
    if found != count {
        let expected = "as many columns as the line `VARS`";
        return Err(text.error(line, Problem::Columns { count, expected, found }));
    }
    let mut words = text.words(line.clone());
    for ((k, angle), word) in angles.iter_mut().enumerate().zip(words.by_ref()) {
        let value = rows.angles.degrees(text, word.clone(), RADIANS)?;
        let range = if k % 2 == 0 { 0.0..=180.0 } else { -360.0..=360.0 };
        if !range.contains(&value) {
            let expected = "radians: inclinations from 0 to pi from the normal of the front, azimuths from -2 pi to 2 pi";
            let value = text.number(word.clone())?;
            return Err(text.error(word, Problem::OutOfRange { what: ANGLES[k], value, expected }));
        }
        *angle = value;
    }
    for (channel, word) in channels.iter().zip(words) {
        let value = text.value(word)?;
        rows.add_unfolded(text, line.clone(), angles, (*channel, value))?;
    }
    Ok(())
}

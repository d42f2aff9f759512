//! Output formats of measured scattering.

use std::fmt;
use std::io::{self, Write};

use papilio_goniometry::{Channel, MeasuredPart, Measurement};

use super::{LARGEST_VALUE, klems_write, papilio_write, radiant_write, table_write};

/// The output formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BsdfFormat {
    /// Tabular BSDF of Radiant Imaging and Zemax: a single part, monochrome or XYZ.
    Radiant,
    /// CSV with one row per pair of directions and channel.
    Csv,
    /// Klems matrices as the XML of WINDOW and Radiance; grids are averaged over the patches.
    Klems,
    /// Papilio's own format, without any loss.
    Papilio,
}

/// Why a measurement cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// An error of the operating system.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A number that the readers refuse.
    #[error("{what} of the {way} is {value:e}, which cannot be written (expected {})", LIMITS)]
    Number {
        /// The value or TIS, with its place.
        what: String,
        /// Name of the part.
        way: &'static str,
        /// The number.
        value: f64,
    },
    /// The format cannot represent the measurement.
    #[error("{format} cannot hold {what}")]
    CannotHold {
        /// The format.
        format: &'static str,
        /// What it cannot hold.
        what: &'static str,
    },
}

/// Numbers that the readers accept.
const LIMITS: &str =
    "0 to 1e15; check whether a calibration reference is nearly dark there, or a value of the file is wrong";

/// Returns a note on channels that a format does not hold.
pub(super) fn not_written(channels: &[Channel]) -> Option<String> {
    match channels {
        [] => None,
        [one] => Some(format!("the channel {one} was not written")),
        [first, .., last] => Some(format!("{} channels were not written: {first} to {last}", channels.len())),
    }
}

/// Fails if the readers would refuse a number of a part.
pub(super) fn check(part: &MeasuredPart) -> Result<(), WriteError> {
    let fits = |value: &f64| (0.0..=LARGEST_VALUE).contains(value);
    if let Some(at) = part.values.iter().position(|value| !fits(value) && !value.is_nan()) {
        let cells = part.geometry.cells().max(1);
        let place = part.geometry.directions(at % cells).map_or(String::new(), |[i, o]| {
            format!(", light from ({}, {}) to ({}, {}) deg,", i.theta_deg, i.phi_deg, o.theta_deg, o.phi_deg)
        });
        let channel = part.channels.get(at / cells).map_or(String::new(), ToString::to_string);
        let what = format!("a value (channel {channel}{place})");
        return Err(WriteError::Number { what, way: part.way.name(), value: part.values[at] });
    }
    match part.tis.iter().find(|tis| !fits(tis)) {
        Some(&value) => Err(WriteError::Number { what: "a TIS".to_owned(), way: part.way.name(), value }),
        None => Ok(()),
    }
}

/// Writes a measurement, and returns complete sentences on the information that the format cannot represent.
///
/// # Errors
/// Those of `out`; if the format cannot represent the measurement at all, or the readers would refuse a
/// number.
pub fn write_measurement(
    mut out: impl Write,
    format: BsdfFormat,
    measurement: &Measurement,
) -> Result<Vec<String>, WriteError> {
    let out: &mut dyn Write = &mut out;
    measurement.parts.iter().try_for_each(check)?;
    let lost = match format {
        BsdfFormat::Radiant => radiant_write::write(out, measurement)?,
        BsdfFormat::Csv => table_write::write(out, measurement)?,
        BsdfFormat::Klems => klems_write::write(out, measurement)?,
        BsdfFormat::Papilio => papilio_write::write(out, measurement)?,
    };
    out.flush()?;
    Ok(lost)
}

/// A number, printed with the fewest digits from which the same bits are read.
pub(super) struct Number(pub(super) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.abs() {
            // Without the sign of a negative zero.
            size if size == 0.0 || (1e-5..1e15).contains(&size) => write!(f, "{}", self.0 + 0.0),
            _ => write!(f, "{:e}", self.0),
        }
    }
}

/// Returns a text without line breaks and other control characters.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
}

/// Reports the media in `lost` if they are not air, for a format that cannot represent them.
pub(super) fn lost_media(measurement: &Measurement, lost: &mut Vec<String>) {
    let [front, back] = measurement.media;
    if measurement.media != [1.0, 1.0] {
        lost.push(format!("the media on both sides (n = {front} and {back}) were not written"));
    }
}

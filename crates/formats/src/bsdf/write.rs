//! What a measurement is written as.

use std::fmt;
use std::io::{self, Write};

use papilio_goniometry::Measurement;

use super::{klems_write, papilio_write, radiant_write, table_write};

/// The formats that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BsdfFormat {
    /// Tabular BSDF of Radiant Imaging and Zemax: one way, monochrome or XYZ.
    Radiant,
    /// A row for each pair of directions and channel.
    Csv,
    /// Klems matrices as the XML of WINDOW and Radiance; grids are averaged over the patches.
    Klems,
    /// Papilio's own: everything.
    Papilio,
}

/// Why a measurement cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system's words.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The format cannot hold it.
    #[error("{format} cannot hold {what}")]
    CannotHold {
        /// The format.
        format: &'static str,
        /// What it cannot hold.
        what: &'static str,
    },
}

/// Writes a measurement; what comes back are whole sentences on what the format could not keep.
///
/// # Errors
/// Those of `out`; a measurement that the format cannot hold at all.
pub fn write_measurement(
    mut out: impl Write,
    format: BsdfFormat,
    measurement: &Measurement,
) -> Result<Vec<String>, WriteError> {
    let out: &mut dyn Write = &mut out;
    let lost = match format {
        BsdfFormat::Radiant => radiant_write::write(out, measurement)?,
        BsdfFormat::Csv => table_write::write(out, measurement)?,
        BsdfFormat::Klems => klems_write::write(out, measurement)?,
        BsdfFormat::Papilio => papilio_write::write(out, measurement)?,
    };
    out.flush()?;
    Ok(lost)
}

/// A number as short as it reads back bit for bit.
pub(super) struct Number(pub(super) f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.abs() {
            size if size == 0.0 || (1e-5..1e15).contains(&size) => write!(f, "{}", self.0),
            _ => write!(f, "{:e}", self.0),
        }
    }
}

/// A text that stays on its line.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>().trim().to_owned()
}

/// What becomes of the media where a format has no place for them.
pub(super) fn lost_media(measurement: &Measurement, lost: &mut Vec<String>) {
    let [front, back] = measurement.media;
    if measurement.media != [1.0, 1.0] {
        lost.push(format!("the media on both sides (n = {front} and {back}) are left out"));
    }
}

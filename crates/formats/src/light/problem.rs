//! What can be wrong with a map of light.

use papilio_diagnostics::Diagnostic;

/// What can be wrong with a map of light.
#[derive(Debug, Clone, PartialEq)]
pub enum MapProblem {
    /// Neither Radiance's nor OpenEXR's first bytes.
    NotAMap,
    /// A header that cannot be read.
    Header {
        /// Which line, from 1.
        line: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Scanlines in another order.
    Orientation {
        /// The resolution line.
        found: String,
    },
    /// Not twice as wide as high.
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The file ends before the map does.
    Truncated {
        /// The row, from 1.
        row: usize,
        /// Rows that there should be.
        height: usize,
    },
    /// A run that is longer than its row, or an empty one.
    Run {
        /// The row, from 1.
        row: usize,
    },
    /// A pixel that is no radiance.
    Pixel {
        /// Its name.
        channel: String,
        /// From 1.
        column: usize,
        /// From 1.
        row: usize,
        /// What stands there.
        value: f32,
    },
    /// No colours.
    Channels {
        /// Their names.
        found: String,
    },
    /// Something that the decoder says.
    Exr {
        /// Its words.
        message: String,
    },
}

impl MapProblem {
    /// What is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::NotAMap => {
                Diagnostic::new("this is neither a Radiance picture (.hdr) nor an OpenEXR file (.exr)")
            }
            Self::Header { line, what } => Diagnostic::new(format!("line {line} of the header: {what}")),
            Self::Orientation { found } => Diagnostic::new(format!("this map's scanlines run as `{found}`"))
                .expected("`-Y height +X width`")
                .hint("turn the picture upright with the tool that made it"),
            Self::Size { width, height } => Diagnostic::new(format!("this map has {width} x {height} pixels"))
                .expected(
                    "an equirectangular map, twice as wide as high, of 2 x 2 to 4096 x 2048 pixels, its height even",
                )
                .hint("resize or reproject the map: other projections and parts of the sphere are not read"),
            Self::Truncated { row, height } => {
                Diagnostic::new(format!("the file ends in row {row} of {height}")).hint(DAMAGED)
            }
            Self::Run { row } => {
                Diagnostic::new(format!("row {row} does not hold as many pixels as it should")).hint(DAMAGED)
            }
            Self::Pixel { channel, column, row, value } => {
                let pixel = format!("channel {channel} of pixel {column} in row {row} is {value}");
                Diagnostic::new(pixel).expected("a radiance of 0 or more")
            }
            Self::Channels { found } => Diagnostic::new(format!("this map has the channels {found}"))
                .expected("R, G and B, or Y, or wavelengths such as `S0.550,0nm`; all in one part"),
            Self::Exr { message } => Diagnostic::new(format!("this OpenEXR file cannot be read: {message}")),
        }
    }
}

/// What to do about a file that does not hold what its header says.
const DAMAGED: &str = "the file is damaged: download or copy it again";

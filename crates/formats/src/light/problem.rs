//! Errors of light maps.

use papilio_diagnostics::Diagnostic;

use crate::picture::convert_to;

/// The errors of a light map.
#[derive(Debug, Clone, PartialEq)]
pub enum MapProblem {
    /// The file does not begin as a Radiance picture or an OpenEXR file.
    NotAMap,
    /// A picture of a format without radiances.
    Format {
        /// Its name.
        format: &'static str,
    },
    /// A malformed header.
    Header {
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// An unsupported order of scanlines.
    Orientation {
        /// The resolution line.
        found: String,
    },
    /// An unsupported size.
    Size {
        /// Pixels in a row.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// A cube whose faces do not have a supported size.
    Cube {
        /// Pixels in a row.
        width: usize,
        /// Number of rows.
        height: usize,
    },
    /// The file ends before the last row.
    Truncated {
        /// The row, from 1.
        row: usize,
        /// Number of rows according to the header.
        height: usize,
    },
    /// A run that is empty or longer than its row.
    Run {
        /// The row, from 1.
        row: usize,
    },
    /// A pixel whose value is not a radiance.
    Pixel {
        /// Name of the channel.
        channel: String,
        /// Column, from 1.
        column: usize,
        /// Row, from 1.
        row: usize,
        /// Value of the pixel.
        value: f32,
    },
    /// Primaries that span no colours.
    Primaries {
        /// x and y of red, green, blue and white.
        found: [[f64; 2]; 4],
    },
    /// The channels do not form a supported set.
    Channels {
        /// Names of the channels.
        found: String,
    },
    /// An error of the OpenEXR decoder.
    Exr {
        /// The decoder's message.
        message: String,
    },
}

impl MapProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Primaries { found } => {
                Diagnostic::new(format!("the primaries {found:?} do not span a range of colours"))
                    .expected("x and y of red, green, blue and white")
            }
            Self::NotAMap => {
                Diagnostic::new("this is neither a Radiance picture (.hdr) nor an OpenEXR file (.exr)")
            }
            Self::Format { format } => Diagnostic::new(format!("this is a {format} file, which is not supported"))
                .expected("a Radiance picture (.hdr) or an OpenEXR file (.exr)")
                .hint(convert_to(format, "OpenEXR; a usual photograph has no radiances, and lamps in it are as bright as paper")),
            Self::Header { line, what } => Diagnostic::new(format!("line {line} of the header: {what}")),
            Self::Orientation { found } => Diagnostic::new(format!("the scanlines of this map have the order `{found}`"))
                .expected("an order such as `-Y height +X width`"),
            Self::Cube { width, height } => Diagnostic::new(format!("this cube has {width} x {height} pixels"))
                .expected("six square faces of 2 to 1024 pixels, one below the other"),
            Self::Size { width, height } => Diagnostic::new(format!("this map has {width} x {height} pixels"))
                .expected(
                    "an equirectangular map, twice as wide as high, of 4 x 2 to 4096 x 2048 pixels, with an even number of rows",
                )
                .hint("resize or reproject the map: other projections and parts of the sphere are not supported"),
            Self::Truncated { row, height } => {
                Diagnostic::new(format!("the file ends in row {row} of {height}")).hint(DAMAGED)
            }
            Self::Run { row } => {
                Diagnostic::new(format!("the data of row {row} do not match the width in the header")).hint(DAMAGED)
            }
            Self::Pixel { channel, column, row, value } => {
                let pixel = format!("channel {channel} of pixel {column} in row {row} is {value}");
                Diagnostic::new(pixel).expected("a radiance of 0 or more")
            }
            Self::Channels { found } => Diagnostic::new(format!("this map has the channels {found}"))
                .expected("R, G and B, or X, Y and Z, or Y, or wavelengths such as `S0.550,0nm`, all in one part of the file"),
            Self::Exr { message } => Diagnostic::new(format!("this OpenEXR file cannot be read: {message}")),
        }
    }
}

/// Hint for a file whose data do not match its header.
const DAMAGED: &str = "the file is damaged or incomplete: download or copy it again";

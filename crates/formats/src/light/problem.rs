//! What can be wrong with a map of light.

/// What can be wrong with a map of light.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapProblem {
    /// Neither Radiance's nor OpenEXR's first bytes.
    #[error("this is neither a Radiance picture (.hdr) nor an OpenEXR file (.exr)")]
    NotAMap,
    /// A header that cannot be read.
    #[error("line {line} of the header: {what}")]
    Header {
        /// Which line, from 1.
        line: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// Scanlines in another order.
    #[error("this map's scanlines run as `{found}`")]
    Orientation {
        /// The resolution line.
        found: String,
    },
    /// Not twice as wide as high.
    #[error("this map has {width} x {height} pixels")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The file ends before the map does.
    #[error("the file ends in row {row} of {height}")]
    Truncated {
        /// The row, from 1.
        row: usize,
        /// Rows that there should be.
        height: usize,
    },
    /// A run that is longer than its row, or an empty one.
    #[error("row {row} does not hold as many pixels as it should")]
    Run {
        /// The row, from 1.
        row: usize,
    },
    /// A pixel that is no radiance.
    #[error("channel {channel} of pixel {column} in row {row} is {value}")]
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
    #[error("this map has the channels {found}")]
    Channels {
        /// Their names.
        found: String,
    },
    /// Something that the decoder says.
    #[error("this OpenEXR file cannot be read: {message}")]
    Exr {
        /// Its words.
        message: String,
    },
}

impl MapProblem {
    /// What should stand there.
    pub fn expected(&self) -> Option<&'static str> {
        Some(match self {
            Self::Orientation { .. } => "expected `-Y height +X width`",
            Self::Size { .. } => {
                "expected an equirectangular map, twice as wide as high, of 2 x 2 to 4096 x 2048 pixels, its height even"
            }
            Self::Pixel { .. } => "expected a radiance of 0 or more",
            Self::Channels { .. } => {
                "expected R, G and B, or Y, or wavelengths such as `S0.550,0nm`; all in one part"
            }
            _ => return None,
        })
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<&'static str> {
        Some(match self {
            Self::Orientation { .. } => "turn the picture upright with the tool that made it",
            Self::Size { .. } => {
                "resize or reproject the map: other projections and parts of the sphere are not read"
            }
            Self::Truncated { .. } | Self::Run { .. } => "the file is damaged: get it anew",
            _ => return None,
        })
    }
}

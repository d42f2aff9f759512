//! Errors of pictures.

use papilio_diagnostics::Diagnostic;

use super::convert_to;

/// The errors of a picture, in addition to those of any data file.
#[derive(Debug, Clone, PartialEq)]
pub enum PictureProblem {
    /// The file is neither PNG nor JPEG.
    NotAPicture,
    /// A picture of another format.
    Format {
        /// Its name.
        format: &'static str,
    },
    /// An unsupported size.
    Size {
        /// Pixels in a row.
        columns: usize,
        /// Number of rows.
        rows: usize,
    },
    /// The file is damaged.
    Damaged {
        /// PNG or JPEG.
        format: &'static str,
        /// The decoder's message.
        message: String,
    },
    /// The file ends before the picture is complete.
    CutOff {
        /// PNG or JPEG.
        format: &'static str,
    },
    /// An unsupported feature.
    Unsupported {
        /// The feature.
        what: String,
        /// What is supported.
        expected: &'static str,
    },
}

impl PictureProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::NotAPicture => Diagnostic::new("this is not a picture in a supported format")
                .expected("a PNG or JPEG file")
                .hint("save the picture as PNG in the program that created it"),
            Self::Format { format } => {
                Diagnostic::new(format!("this is a {format} file, which is not supported"))
                    .expected("a PNG or JPEG file")
                    .hint(convert_to(format, "PNG"))
            }
            Self::Size { columns, rows } => {
                Diagnostic::new(format!("this picture has {columns} x {rows} pixels"))
                    .expected("1 to 64 million pixels")
                    .hint("reduce the picture; a panel has a few million pixels")
            }
            Self::Damaged { format, message } => {
                Diagnostic::new(format!("this {format} file cannot be decoded: {message}")).hint(AGAIN)
            }
            Self::CutOff { format } => {
                Diagnostic::new(format!("this {format} file ends before its picture is complete")).hint(AGAIN)
            }
            Self::Unsupported { what, expected } => {
                Diagnostic::new(format!("{what} is not supported")).expected(expected)
            }
        }
    }
}

/// Hint for a damaged file.
const AGAIN: &str = "the file is damaged or incomplete: copy or download it again, or save it again in the program that created it";

//! Errors of BSDF files.

use papilio_diagnostics::{Diagnostic, Remedy, number};
use papilio_goniometry::{Overlap, ScatterMode};

/// The errors of a BSDF file, in addition to those of any data file.
#[derive(Debug, Clone, PartialEq)]
pub enum BsdfProblem {
    /// The content has none of the supported formats.
    Unknown,
    /// The file has no lines but comments.
    Empty,
    /// The file lacks the requested part.
    NoPart {
        /// The requested part.
        wanted: ScatterMode,
        /// The parts of the file.
        found: Vec<ScatterMode>,
    },
    /// An unsupported version or feature of a format.
    Unsupported {
        /// The version or feature.
        what: String,
        /// What is supported.
        expected: &'static str,
    },
    /// A required item is missing.
    Missing {
        /// The item.
        what: &'static str,
    },
    /// A different item than the expected one.
    Unexpected {
        /// The item found.
        found: String,
        /// The item expected.
        expected: &'static str,
    },
    /// An item that may occur only once is repeated.
    Twice {
        /// The item.
        what: String,
    },
    /// The file is cut off.
    Ends {
        /// The next expected item, or the condition that is not yet met.
        what: &'static str,
    },
    /// A list with the wrong number of items.
    Count {
        /// The items that are counted.
        what: &'static str,
        /// Number of items found.
        found: usize,
        /// Required number of items.
        count: usize,
    },
    /// The values of an axis are not ascending.
    Order {
        /// The axis.
        what: &'static str,
        /// The value.
        value: f64,
        /// The previous value.
        before: f64,
    },
    /// The azimuths of the scattered light cover too little of a circle.
    PartOfCircle {
        /// The first azimuth from that of the light, degrees.
        from_deg: f64,
        /// The last azimuth from that of the light, degrees.
        to_deg: f64,
        /// Whether the azimuths of the light lie in one plane of incidence.
        in_one_plane: bool,
    },
    /// Both sides of the plane of incidence were measured at some azimuths, and differ.
    SidesDisagree(Overlap),
    /// The measurement exceeds the limit of cells.
    TooManyCells {
        /// Largest number of cells.
        limit: usize,
    },
    /// A line exceeds the limit of length.
    LongLine {
        /// Largest number of bytes.
        limit: usize,
    },
    /// Elements are nested too deeply.
    TooDeep {
        /// Largest number of levels.
        limit: usize,
    },
    /// The file is not well-formed.
    Damaged {
        /// Kind of file: XML, an archive.
        what: &'static str,
        /// The parser's message.
        message: String,
    },
}

impl BsdfProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unknown => Diagnostic::new("this is not a BSDF file in a supported format").hint(format!(
                "the supported formats are {}; CSV has the columns theta_i,phi_i,theta_o,phi_o[,wavelength],value, a scan at normal \
                 incidence theta_deg,btdf (or brdf; with other names, state the part)",
                super::bsdf_formats()
            ))
            .remedy(Remedy::OnCommandLine("--part front-transmission".to_owned())),
            Self::Empty => Diagnostic::new("this file has no data").expected("a BSDF file: rows of measured values"),
            Self::NoPart { wanted, found } => {
                let found: Vec<&str> = found.iter().map(|way| way.name()).collect();
                Diagnostic::new(format!("this file has no {}", wanted.name()))
                    .expected(format!("one of its parts: {}", found.join(", ")))
            }
            Self::Unsupported { what, expected } => {
                Diagnostic::new(format!("{what} is not supported")).expected(expected)
            }
            Self::Missing { what } => Diagnostic::new(format!("there is no {what}")),
            Self::Unexpected { found, expected } => {
                Diagnostic::new(format!("`{found}` is not permitted here")).expected(expected)
            }
            Self::Twice { what } => Diagnostic::new(format!("{what} occurs twice")).hint("remove one of the two"),
            Self::Ends { what } => Diagnostic::new(format!("the file ends before {what}"))
                .hint("the file is probably cut off: copy or export it again"),
            Self::Count { what, found, count } => {
                Diagnostic::new(format!("the number of {what} is {found}")).expected(count)
            }
            Self::Order { what, value, before } => {
                Diagnostic::new(format!("{what} {} is out of order after {}", number(*value), number(*before)))
                    .expected("ascending values")
            }
            Self::PartOfCircle { from_deg, to_deg, in_one_plane: false } => Diagnostic::new(format!(
                "the azimuths of the scattered light reach from {} to {} deg from that of the first light, and the light comes from azimuths in \
                 several planes of incidence",
                number(*from_deg),
                number(*to_deg)
            ))
            .expected("a whole circle (0 to 360 deg), which holds every side of every plane")
            .hint("measure or add the other azimuths, or write a file for each plane of incidence"),
            Self::PartOfCircle { from_deg, to_deg, .. } => Diagnostic::new(format!(
                "the azimuths of the scattered light reach from {} to {} deg from that of the light: neither half a circle nor a whole one",
                number(*from_deg),
                number(*to_deg)
            ))
            .expected("half a circle on either side of the plane of incidence (0 to 180 or -180 to 0 deg), or a whole one")
            .hint("measure or add the other azimuths, or keep one azimuth, which then stands for all"),
            Self::SidesDisagree(overlap) => Diagnostic::new(format!(
                "the azimuths from {} to {} deg were measured on both sides of the plane of incidence, and their values differ by {} % in the mean",
                number(overlap.from_deg),
                number(overlap.to_deg),
                number((100.0 * overlap.difference).round())
            ))
            .expected("one side of the plane of incidence, or a whole circle")
            .hint("remove the azimuths of one side where both were measured, or add the others up to a whole circle"),
            Self::TooManyCells { limit } => {
                Diagnostic::new(format!("this measurement has more than {limit} cells"))
                    .hint("use a coarser grid or fewer wavelengths")
            }
            Self::LongLine { limit } => Diagnostic::new(format!("this line is longer than {limit} bytes")),
            Self::TooDeep { limit } => {
                Diagnostic::new(format!("this is nested more than {limit} levels deep"))
            }
            Self::Damaged { what, message } => {
                let hint = match *what {
                    "archive" => {
                        "copy the file again, or write it again: `papilio diffuser convert` and numpy.savez (not \
                         numpy.savez_compressed) write supported archives"
                    }
                    _ => "copy the file again, or export it again from the program that wrote it",
                };
                Diagnostic::new(format!("this {what} is damaged: {message}")).hint(hint)
            }
        }
    }
}

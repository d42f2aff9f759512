//! What can be wrong with a BSDF file in particular.

use papilio_diagnostics::Diagnostic;

/// What can be wrong with a BSDF file, beside what can be wrong with any.
#[derive(Debug, Clone, PartialEq)]
pub enum BsdfProblem {
    /// Its content is none of the formats.
    Unknown,
    /// A version of a format, or a feature of it, that is not read.
    Unsupported {
        /// What it is.
        what: String,
        /// What is read instead.
        expected: &'static str,
    },
    /// Something that must be there is not.
    Missing {
        /// What it is.
        what: &'static str,
    },
    /// Something else than what must stand here.
    Unexpected {
        /// What stands here.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// Something that may be there once is there again.
    Twice {
        /// What it is.
        what: String,
    },
    /// The file ends too early.
    Ends {
        /// What is still to come.
        what: &'static str,
    },
    /// A list with the wrong number of items.
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        count: usize,
    },
    /// An axis that does not rise.
    Order {
        /// What the axis is.
        what: &'static str,
        /// The value.
        value: f64,
        /// The one before.
        before: f64,
    },
    /// More cells than any sensible measurement has.
    TooManyCells {
        /// The most that are read.
        limit: usize,
    },
    /// A line longer than any sensible one.
    LongLine {
        /// The most that are read.
        limit: usize,
    },
    /// Nesting deeper than any sensible one.
    TooDeep {
        /// The most that is read.
        limit: usize,
    },
    /// Not well-formed.
    Damaged {
        /// What it is: XML, an archive.
        what: &'static str,
        /// What its parser says.
        message: String,
    },
}

impl BsdfProblem {
    /// What is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unknown => Diagnostic::new("this is not a BSDF file in any known format").hint(format!(
                "the formats are {}; CSV has the columns theta_i,phi_i,theta_o,phi_o[,wavelength],value",
                super::bsdf_formats()
            )),
            Self::Unsupported { what, expected } => {
                Diagnostic::new(format!("{what} is not read")).expected(expected)
            }
            Self::Missing { what } => Diagnostic::new(format!("there is no {what}")),
            Self::Unexpected { found, expected } => {
                Diagnostic::new(format!("`{found}` does not belong here")).expected(expected)
            }
            Self::Twice { what } => Diagnostic::new(format!("{what} is given twice")),
            Self::Ends { what } => Diagnostic::new(format!("the file ends before {what}"))
                .hint("the file seems to be cut off: copy it again"),
            Self::Count { what, found, count } => {
                Diagnostic::new(format!("there are {found} {what}, not {count}"))
            }
            Self::Order { what, value, before } => {
                Diagnostic::new(format!("{what} {value} does not follow {before}"))
                    .expected("values that rise")
            }
            Self::TooManyCells { limit } => {
                Diagnostic::new(format!("this table would have more than {limit} cells"))
            }
            Self::LongLine { limit } => Diagnostic::new(format!("this line has more than {limit} bytes")),
            Self::TooDeep { limit } => Diagnostic::new(format!("this is nested deeper than {limit} times")),
            Self::Damaged { what, message } => {
                let hint = match *what {
                    "archive" => {
                        "copy the file again, or write it again: `papilio diffuser convert` and numpy.savez (not \
                         numpy.savez_compressed) write archives that can be read"
                    }
                    _ => "copy the file again, or export it again from the program that wrote it",
                };
                Diagnostic::new(format!("this {what} is damaged: {message}")).hint(hint)
            }
        }
    }
}

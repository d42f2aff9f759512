//! What can be wrong with a BSDF file in particular.

use std::borrow::Cow;

/// What can be wrong with a BSDF file, beside what can be wrong with any.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BsdfProblem {
    /// Its content is none of the formats.
    #[error("this is not a BSDF file in any known format")]
    Unknown,
    /// A version of a format, or a feature of it, that is not read.
    #[error("{what} is not read")]
    Unsupported {
        /// What it is.
        what: String,
        /// What is read instead.
        expected: &'static str,
    },
    /// Something that must be there is not.
    #[error("there is no {what}")]
    Missing {
        /// What it is.
        what: &'static str,
    },
    /// Something else than what must stand here.
    #[error("`{found}` does not belong here")]
    Unexpected {
        /// What stands here.
        found: String,
        /// What should.
        expected: &'static str,
    },
    /// Something that may be there once is there again.
    #[error("{what} is given twice")]
    Twice {
        /// What it is.
        what: String,
    },
    /// The file ends too early.
    #[error("the file ends before {what}")]
    Ends {
        /// What is still to come.
        what: &'static str,
    },
    /// A list with the wrong number of items.
    #[error("there are {found} {what}, not {count}")]
    Count {
        /// What is counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        count: usize,
    },
    /// An axis that does not rise.
    #[error("{what} {value} does not follow {before}")]
    Order {
        /// What the axis is.
        what: &'static str,
        /// The value.
        value: f64,
        /// The one before.
        before: f64,
    },
    /// More cells than any sensible measurement has.
    #[error("this table would have more than {limit} cells")]
    TooManyCells {
        /// The most that are read.
        limit: usize,
    },
    /// A line longer than any sensible one.
    #[error("this line has more than {limit} bytes")]
    LongLine {
        /// The most that are read.
        limit: usize,
    },
    /// Nesting deeper than any sensible one.
    #[error("this is nested deeper than {limit} times")]
    TooDeep {
        /// The most that is read.
        limit: usize,
    },
    /// Not well-formed.
    #[error("this {what} is damaged: {message}")]
    Damaged {
        /// What it is: XML, an archive.
        what: &'static str,
        /// What its parser says.
        message: String,
    },
}

impl BsdfProblem {
    /// What should stand there.
    pub fn expected(&self) -> Option<&'static str> {
        Some(match self {
            Self::Unexpected { expected, .. } | Self::Unsupported { expected, .. } => expected,
            Self::Order { .. } => "expected values that rise",
            _ => return None,
        })
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<Cow<'static, str>> {
        match self {
            Self::Unknown => Some(Cow::Owned(format!(
                "the formats are {}; CSV has the columns theta_i,phi_i,theta_o,phi_o[,wavelength],value",
                super::bsdf_formats()
            ))),
            Self::Ends { .. } => Some(Cow::Borrowed("the file seems to be cut off: copy it again")),
            _ => None,
        }
    }
}

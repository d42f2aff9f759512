//! What can be wrong with a data file, and where.

use std::borrow::Cow;
use std::fmt;

use papilio_spectra::SpectraError;

use crate::bsdf::BsdfProblem;
use crate::light::MapProblem;
use papilio_diagnostics::{Diagnostic, Place};

/// A file that cannot be used: what is wrong, and where in it.
///
/// Prints as compilers do, with the line and a caret below it.
#[derive(Debug, Clone, PartialEq)]
pub struct FormatError {
    /// The file, line and column.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

/// What can be wrong with a data file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The system does not hand the file over.
    #[error("this file cannot be read: {reason}")]
    Unreadable {
        /// The system's words.
        reason: String,
    },
    /// The file cannot be written.
    #[error("this file cannot be written: {reason}")]
    Unwritable {
        /// The system's words.
        reason: String,
    },
    /// The file is a journal, and another program adds to it.
    #[error("another program is writing this journal")]
    Busy,
    /// The file is a journal, but not of what it is to be joined with.
    #[error("this journal belongs to another scenario, other files or another version")]
    ForeignJournal,
    /// Larger than any sensible table.
    #[error("this file has {bytes} bytes, more than {limit}")]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The largest size that is read.
        limit: u64,
    },
    /// The bytes are not UTF-8.
    #[error("this is not a text file in UTF-8")]
    NotUtf8,
    /// Fewer rows than a table needs.
    #[error("there are {}", match .rows { 0 => "no rows of data", _ => "too few rows of data" })]
    TooFew {
        /// How many there are.
        rows: usize,
    },
    /// Fewer rows than a profile needs.
    #[error("there are {}", match .rows { 0 => "no rows of data", _ => "too few rows of data" })]
    TooFewAngles {
        /// How many there are.
        rows: usize,
    },
    /// A row with the wrong number of columns.
    #[error("this row has {found} {}", if *.found == 1 { "column" } else { "columns" })]
    Columns {
        /// How many there should be.
        count: usize,
        /// What a row should look like.
        expected: &'static str,
        /// How many there are.
        found: usize,
    },
    /// A quote that is not closed, or closed before the end of its cell.
    #[error("the quotes of this cell do not match")]
    Quotes,
    /// A name that would spoil the tables.
    #[error("this is not a name")]
    BadName,
    /// The first row of a pixel table must name its columns.
    #[error("this is not the header of a pixel table")]
    Header,
    /// The first row of a measured panel must name its columns.
    #[error("this is not the header of a measured panel")]
    PanelHeader,
    /// A measured panel without rows.
    #[error("there are no rows of data")]
    EmptyPanel,
    /// Two rows of a measured panel for the same state and direction.
    #[error("state `{state}` at theta {theta_deg} deg, phi {phi_deg} deg is given twice")]
    MeasuredTwice {
        /// The state.
        state: String,
        /// Inclination, degrees.
        theta_deg: f64,
        /// Azimuth, degrees.
        phi_deg: f64,
    },
    /// Not JSON, or not what a run writes.
    #[error("this is not a result.json: {message}")]
    NotAResult {
        /// What is wrong with it.
        message: String,
    },
    /// Nothing where a number should be.
    #[error("this cell is empty")]
    EmptyCell,
    /// A cell that is not a number.
    #[error("`{found}` is not a number")]
    NotANumber {
        /// The cell.
        found: String,
    },
    /// NaN or infinity, where only numbers make sense.
    #[error("`{found}` is not a finite number")]
    NotFinite {
        /// The cell.
        found: String,
    },
    /// A number outside its range.
    #[error("{what} is {value}")]
    OutOfRange {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// A line of a journal that is not as it was written.
    #[error("this line of a journal is damaged: {reason}")]
    BrokenLine {
        /// What is wrong with it.
        reason: String,
    },
    /// The first line of a journal, which says what the others are of, is not as it was written.
    #[error("the first line of this journal is damaged: {reason}")]
    BrokenHead {
        /// What is wrong with it.
        reason: String,
    },
    /// Wavelengths that look like micrometres.
    #[error("these wavelengths look like micrometres")]
    Micrometres,
    /// A wavelength that does not follow the one before.
    #[error("wavelength {nm} nm does not follow {before} nm")]
    OutOfOrder {
        /// The wavelength.
        nm: f64,
        /// The one on the row before.
        before: f64,
    },
    /// Two rows of a pixel table for the same point.
    #[error("state `{state}` at {theta_deg} deg and {nm} nm is given twice")]
    Duplicate {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// A point that a pixel table lacks.
    #[error("state `{state}` has no row for {theta_deg} deg and {nm} nm")]
    Hole {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// The angles of a pixel table begin above 0.
    #[error("the angles begin at {theta_deg} deg")]
    NoNormal {
        /// The smallest angle, degrees.
        theta_deg: f64,
    },
    /// Not YAML, or not in the layout of refractiveindex.info.
    #[error("this is not a refractiveindex.info file: {message}")]
    Yaml {
        /// The parser's words.
        message: String,
    },
    /// A `DATA` entry of a kind that is not known.
    #[error("`{found}` is not a kind of optical data")]
    UnknownData {
        /// Its `type`.
        found: String,
    },
    /// No entry gives the refractive index.
    #[error("no `DATA` entry gives the refractive index n")]
    NoIndex,
    /// Something about a map of light.
    #[error(transparent)]
    Map(Box<MapProblem>),
    /// Something about a luminaire's file.
    #[error("this IES LM-63 file cannot be used: {what}")]
    Ies {
        /// What is wrong.
        what: &'static str,
    },
    /// Something about a BSDF.
    #[error(transparent)]
    Bsdf(Box<BsdfProblem>),
    /// The table or formula makes no sense as optical data.
    #[error(transparent)]
    Spectra(#[from] SpectraError),
}

impl From<MapProblem> for Problem {
    fn from(problem: MapProblem) -> Self {
        Self::Map(Box::new(problem))
    }
}

impl From<BsdfProblem> for Problem {
    fn from(problem: BsdfProblem) -> Self {
        Self::Bsdf(Box::new(problem))
    }
}

/// What [`is_name`](crate::is_name) takes.
const GOOD_NAME: &str = "expected 1 to 64 characters, no control characters, no blanks at the ends, nothing that a spreadsheet takes for a \
                         formula (`=` or `@` at the beginning)";

/// What a negative k usually means.
const SIGN_OF_K: &str = "Papilio uses n + ik, k positive in an absorber: change the sign of n - ik data";

impl Problem {
    /// What is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        Diagnostic {
            expected: self.expected().map(str::to_owned),
            hint: self.hint().map(Cow::into_owned),
            ..Diagnostic::new(self.to_string())
        }
    }

    /// What should stand there.
    pub fn expected(&self) -> Option<&'static str> {
        Some(match self {
            Self::Bsdf(problem) => return problem.expected(),
            Self::Map(problem) => return problem.expected(),
            Self::TooFew { .. } => "expected at least two wavelengths",
            Self::TooFewAngles { .. } => "expected at least two angles",
            Self::BadName => GOOD_NAME,
            Self::Columns { expected, .. } | Self::OutOfRange { expected, .. } => expected,
            Self::Header => "expected `state,theta_deg,wavelength_nm,reflectance`",
            Self::EmptyPanel => {
                "expected a first row with the names of the columns, and a row for each state and direction (of spectra: \
                 for each wavelength, too)"
            }
            Self::PanelHeader => {
                "expected the columns `state`, `theta_deg`, and `wavelength_nm`, `reflectance_factor` or `X`, `Y`, `Z`"
            }
            Self::EmptyCell | Self::NotANumber { .. } | Self::NotFinite { .. } => "expected a number",
            Self::OutOfOrder { .. } => "expected wavelengths that rise, or fall, from row to row",
            Self::Hole { .. } => "expected every wavelength at every angle of every state",
            Self::NoNormal { .. } => "expected 0 deg to be the first angle",
            Self::UnknownData { .. } => {
                "expected `tabulated nk`, `tabulated n`, `tabulated k` or `formula 1` to `formula 9`"
            }
            _ => return None,
        })
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<Cow<'static, str>> {
        Some(Cow::Borrowed(match self {
            Self::Bsdf(problem) => return problem.hint(),
            Self::Map(problem) => return problem.hint().map(Cow::Borrowed),
            Self::Busy => "wait for it, or choose another folder",
            Self::ForeignJournal => "parts are computed from the same file with the same --set",
            Self::NotUtf8 => "save it as plain text in UTF-8",
            Self::Columns { count, found, .. } if found < count => {
                "separate the columns with commas, semicolons, tabs or blanks"
            }
            Self::Columns { .. } => {
                "leave out what is too much; write decimals with a point, and names that hold separators in double quotes"
            }
            Self::Quotes => "a quoted cell begins and ends with a double quote; a quote inside it is doubled",
            Self::NotANumber { found } if found.contains([',', ';', ' ', '\t']) => {
                "decimal commas are not read: write decimals with a point, and use the same separator in all rows"
            }
            Self::BrokenLine { .. } => {
                "take the line out of the file (of a search, optimize.jsonl, all lines after it, too), and give the same command again: \
                 what was in it is computed again, all else is kept"
            }
            Self::BrokenHead { .. } => {
                "it says what all others are of: put it back from a copy, or move the file to another place, and all is computed again"
            }
            Self::NotANumber { .. } => {
                "numbers are written as 0.5 or 1.2e-3; a line that begins with `#` is a comment"
            }
            Self::EmptyCell => "give its value, or take the row out",
            Self::TooLarge { .. } => "take out of it what is not needed: fewer rows, or a coarser grid",
            Self::MeasuredTwice { .. } | Self::Duplicate { .. } => "take one of the two rows out",
            Self::Hole { .. } => "add the row, or take the wavelength or the angle out of all states",
            Self::TooFew { .. } | Self::TooFewAngles { .. } | Self::EmptyPanel => {
                "is this the file that was meant, and is it whole? Lines that begin with `#` are comments"
            }
            Self::NotAResult { .. } => {
                "name a result.json that `papilio run` wrote, or the folder that holds it"
            }
            Self::Micrometres => "give wavelengths in nm: multiply them by 1000",
            Self::OutOfOrder { .. } => "sort the rows by wavelength and leave one row for each",
            Self::NotFinite { .. } => "leave the row out, or give its value",
            Self::OutOfRange { what: "reflectance" | "the share", value, .. } if *value > 1.0 => {
                "fractions are of 1, not percent"
            }
            Self::OutOfRange { what: "k", .. } => SIGN_OF_K,
            Self::Spectra(SpectraError::NoIndex { k, .. }) if *k < 0.0 => SIGN_OF_K,
            _ => return None,
        }))
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.diagnostic().at(&self.place).fmt(f)
    }
}

impl std::error::Error for FormatError {}

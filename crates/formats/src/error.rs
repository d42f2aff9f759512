//! What can be wrong with a data file, and where.

use std::fmt;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_spectra::SpectraError;

use crate::bsdf::BsdfProblem;
use crate::light::MapProblem;

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
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The system does not hand the file over.
    Unreadable {
        /// The system's words.
        reason: String,
    },
    /// The file cannot be written.
    Unwritable {
        /// The system's words.
        reason: String,
    },
    /// The file is a journal, and another program adds to it.
    Busy,
    /// The file is a journal, but not of what it is to be joined with.
    ForeignJournal,
    /// Larger than any sensible table.
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The largest size that is read.
        limit: u64,
    },
    /// The bytes are not UTF-8.
    NotUtf8,
    /// Fewer rows than a table needs.
    TooFew {
        /// How many there are.
        rows: usize,
    },
    /// Fewer rows than a profile needs.
    TooFewAngles {
        /// How many there are.
        rows: usize,
    },
    /// A row with the wrong number of columns.
    Columns {
        /// How many there should be.
        count: usize,
        /// What a row should look like.
        expected: &'static str,
        /// How many there are.
        found: usize,
    },
    /// A quote that is not closed, or closed before the end of its cell.
    Quotes,
    /// A name that would spoil the tables.
    BadName,
    /// The first row of a pixel table must name its columns.
    Header,
    /// The first row of a measured panel must name its columns.
    PanelHeader,
    /// A measured panel without rows.
    EmptyPanel,
    /// Two rows of a measured panel for the same state and direction.
    MeasuredTwice {
        /// The state.
        state: String,
        /// Inclination, degrees.
        theta_deg: f64,
        /// Azimuth, degrees.
        phi_deg: f64,
    },
    /// Not JSON, or not what a run writes.
    NotAResult {
        /// What is wrong with it.
        message: String,
    },
    /// Nothing where a number should be.
    EmptyCell,
    /// A cell that is not a number.
    NotANumber {
        /// The cell.
        found: String,
    },
    /// NaN or infinity, where only numbers make sense.
    NotFinite {
        /// The cell.
        found: String,
    },
    /// A number outside its range.
    OutOfRange {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The range in words.
        expected: &'static str,
    },
    /// A line of a journal that is not as it was written.
    BrokenLine {
        /// What is wrong with it.
        reason: String,
    },
    /// The first line of a journal, which says what the others are of, is not as it was written.
    BrokenHead {
        /// What is wrong with it.
        reason: String,
    },
    /// Wavelengths that look like micrometres.
    Micrometres,
    /// A wavelength that does not follow the one before.
    OutOfOrder {
        /// The wavelength.
        nm: f64,
        /// The one on the row before.
        before: f64,
    },
    /// Two rows of a pixel table for the same point.
    Duplicate {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// A point that a pixel table lacks.
    Hole {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// The angles of a pixel table begin above 0.
    NoNormal {
        /// The smallest angle, degrees.
        theta_deg: f64,
    },
    /// Not YAML, or not in the layout of refractiveindex.info.
    Yaml {
        /// The parser's words.
        message: String,
    },
    /// A `DATA` entry of a kind that is not known.
    UnknownData {
        /// Its `type`.
        found: String,
    },
    /// No entry gives the refractive index.
    NoIndex,
    /// Something about a map of light.
    Map(Box<MapProblem>),
    /// Something about a luminaire's file.
    Ies {
        /// What is wrong.
        what: &'static str,
    },
    /// Something about a BSDF.
    Bsdf(Box<BsdfProblem>),
    /// The table or formula makes no sense as optical data.
    Spectra(SpectraError),
}

impl From<SpectraError> for Problem {
    fn from(error: SpectraError) -> Self {
        Self::Spectra(error)
    }
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
const GOOD_NAME: &str = "1 to 64 characters, no control characters, no blanks at the ends, nothing that a spreadsheet takes for a formula \
                         (`=` or `@` at the beginning)";

/// What a negative k usually means.
const SIGN_OF_K: &str = "Papilio uses n + ik, k positive in an absorber: change the sign of n - ik data";

/// What to do about a table without rows.
const WHOLE_FILE: &str =
    "is this the file that was meant, and is it whole? Lines that begin with `#` are comments";

impl Problem {
    /// What is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unreadable { reason } => Diagnostic::new(format!("this file cannot be read: {reason}")),
            Self::Unwritable { reason } => Diagnostic::new(format!("this file cannot be written: {reason}")),
            Self::Busy | Self::ForeignJournal | Self::BrokenLine { .. } | Self::BrokenHead { .. } => self.of_journal(),
            Self::TooLarge { bytes, limit } => {
                Diagnostic::new(format!("this file has {bytes} bytes, more than {limit}"))
                    .hint("remove what is not needed: use fewer rows, or a coarser grid")
            }
            Self::NotUtf8 => Diagnostic::new("this is not a text file in UTF-8").hint("save it as plain text in UTF-8"),
            Self::BadName => Diagnostic::new("this is not a name").expected(GOOD_NAME),
            Self::Header => Diagnostic::new("this is not the header of a pixel table")
                .expected("`state,theta_deg,wavelength_nm,reflectance`"),
            Self::PanelHeader => Diagnostic::new("this is not the header of a measured panel").expected(
                "the columns `state`, `theta_deg`, and `wavelength_nm`, `reflectance_factor` or `X`, `Y`, `Z`",
            ),
            Self::NotAResult { message } => Diagnostic::new(format!("this is not a result.json: {message}"))
                .hint("name a result.json that `papilio run` wrote, or the folder that holds it"),
            Self::Yaml { message } => {
                Diagnostic::new(format!("this is not a refractiveindex.info file: {message}"))
            }
            Self::UnknownData { found } => Diagnostic::new(format!("`{found}` is not a kind of optical data"))
                .expected("`tabulated nk`, `tabulated n`, `tabulated k` or `formula 1` to `formula 9`"),
            Self::NoIndex => Diagnostic::new("no `DATA` entry gives the refractive index n"),
            Self::Ies { what } => Diagnostic::new(format!("this IES LM-63 file cannot be used: {what}")),
            Self::Map(problem) => problem.diagnostic(),
            Self::Bsdf(problem) => problem.diagnostic(),
            Self::Spectra(error) => {
                let sign = matches!(error, SpectraError::NoIndex { k, .. } if *k < 0.0);
                Diagnostic::new(error.to_string()).hint_if(sign.then_some(SIGN_OF_K))
            }
            _ => self.of_rows(),
        }
    }

    /// Of a journal.
    fn of_journal(&self) -> Diagnostic {
        match self {
            Self::Busy => Diagnostic::new("another program is writing this journal")
                .hint("wait for it, or choose another folder"),
            Self::ForeignJournal => {
                Diagnostic::new("this journal belongs to another scenario, other files or another version")
                    .hint("parts are computed from the same file with the same --set")
            }
            Self::BrokenLine { reason } => {
                Diagnostic::new(format!("this line of a journal is damaged: {reason}")).hint(
                    "take the line out of the file (of a search, optimize.jsonl, all lines after it, too), and give the same \
                     command again: what was in it is computed again, all else is kept",
                )
            }
            Self::BrokenHead { reason } => {
                Diagnostic::new(format!("the first line of this journal is damaged: {reason}")).hint(
                    "it says what all others are of: put it back from a copy, or move the file to another place, and all is \
                     computed again",
                )
            }
            _ => Diagnostic::new("this is not a journal"),
        }
    }

    /// Of rows and cells.
    fn of_rows(&self) -> Diagnostic {
        let too_few = |rows: usize| match rows {
            0 => Diagnostic::new("there are no rows of data"),
            _ => Diagnostic::new("there are too few rows of data"),
        };
        match self {
            Self::TooFew { rows } => too_few(*rows).expected("at least two wavelengths").hint(WHOLE_FILE),
            Self::TooFewAngles { rows } => too_few(*rows).expected("at least two angles").hint(WHOLE_FILE),
            Self::EmptyPanel => too_few(0)
                .expected(
                    "a first row with the names of the columns, and a row for each state and direction (of spectra: for \
                     each wavelength, too)",
                )
                .hint(WHOLE_FILE),
            Self::Columns { count, expected, found } => {
                let columns = if *found == 1 { "column" } else { "columns" };
                let wrong = Diagnostic::new(format!("this row has {found} {columns}")).expected(expected);
                wrong.hint(if found < count {
                    "separate the columns with commas, semicolons, tabs or blanks"
                } else {
                    "remove what is too much; write decimals with a point, and names that hold separators in double quotes"
                })
            }
            Self::Quotes => Diagnostic::new("the quotes of this cell do not match")
                .hint("a quoted cell begins and ends with a double quote; a quote inside it is doubled"),
            Self::MeasuredTwice { state, theta_deg, phi_deg } => Diagnostic::new(format!(
                "state `{state}` at theta {theta_deg} deg, phi {phi_deg} deg is given twice"
            ))
            .hint("remove one of the two rows"),
            Self::Duplicate { state, theta_deg, nm } => {
                Diagnostic::new(format!("state `{state}` at {theta_deg} deg and {nm} nm is given twice"))
                    .hint("remove one of the two rows")
            }
            Self::Hole { state, theta_deg, nm } => {
                Diagnostic::new(format!("state `{state}` has no row for {theta_deg} deg and {nm} nm"))
                    .expected("every wavelength at every angle of every state")
                    .hint("add the row, or remove the wavelength or the angle from all states")
            }
            Self::NoNormal { theta_deg } => Diagnostic::new(format!("the angles begin at {theta_deg} deg"))
                .expected("0 deg to be the first angle"),
            Self::Micrometres => Diagnostic::new("these wavelengths look like micrometres")
                .hint("give wavelengths in nm: multiply them by 1000"),
            Self::OutOfOrder { nm, before } => {
                Diagnostic::new(format!("wavelength {nm} nm does not follow {before} nm"))
                    .expected("wavelengths that rise, or fall, from row to row")
                    .hint("sort the rows by wavelength and leave one row for each")
            }
            _ => self.of_number(),
        }
    }

    /// Of a number.
    fn of_number(&self) -> Diagnostic {
        match self {
            Self::EmptyCell => Diagnostic::new("this cell is empty")
                .expected("a number")
                .hint("give its value, or remove the row"),
            Self::NotANumber { found } => {
                let wrong = Diagnostic::new(format!("`{found}` is not a number")).expected("a number");
                wrong.hint(if found.contains([',', ';', ' ', '\t']) {
                    "decimal commas are not read: write decimals with a point, and use the same separator in all rows"
                } else {
                    "numbers are written as 0.5 or 1.2e-3; a line that begins with `#` is a comment"
                })
            }
            Self::NotFinite { found } => Diagnostic::new(format!("`{found}` is not a finite number"))
                .expected("a number")
                .hint("remove the row, or give its value"),
            Self::OutOfRange { what, value, expected } => {
                let hint = match *what {
                    "reflectance" | "the share" if *value > 1.0 => Some("fractions are of 1, not percent"),
                    "k" => Some(SIGN_OF_K),
                    _ => None,
                };
                Diagnostic::new(format!("{what} is {value}")).expected(expected).hint_if(hint)
            }
            _ => Diagnostic::new("this number cannot be used"),
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.diagnostic().fmt(f)
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.diagnostic().at(&self.place).fmt(f)
    }
}

impl std::error::Error for FormatError {}

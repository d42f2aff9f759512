//! Errors of data files, with their place.

use std::fmt;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_spectra::SpectraError;

use crate::bsdf::BsdfProblem;
use crate::picture::a_file;

/// Error of a data file: what is wrong, and where.
///
/// Prints as a compiler's message, with the line of the file and a caret below it.
#[derive(Debug, Clone, PartialEq)]
pub struct FormatError {
    /// The file, line and column.
    pub place: Place,
    /// What is wrong there.
    pub problem: Problem,
}

impl FormatError {
    /// An error of a whole file, given by its name.
    pub fn whole(name: &str, problem: impl Into<Problem>) -> Self {
        Self { place: Place::whole(name), problem: problem.into() }
    }
}

/// The errors of a data file.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The file cannot be read.
    Unreadable {
        /// The operating system's message.
        reason: String,
    },
    /// The file cannot be written.
    Unwritable {
        /// The operating system's message.
        reason: String,
        /// Whether this holds for the place alone, as if a file is in its way: another one helps. Otherwise the system fails, as
        /// with a full disk.
        is_of_place: bool,
    },
    /// The file is a journal that another program is writing.
    Busy,
    /// The file exceeds the size limit.
    TooLarge {
        /// Size in bytes.
        bytes: u64,
        /// Largest permitted size, bytes.
        limit: u64,
    },
    /// The bytes are not UTF-8.
    NotUtf8,
    /// The bytes are a text in UTF-16 where UTF-8 is expected.
    Utf16,
    /// A picture in place of a text.
    Picture {
        /// Format of the picture.
        format: &'static str,
    },
    /// The bytes are no text in any supported encoding.
    NotText,
    /// A header without a required column.
    MissingColumn {
        /// The required columns.
        missing: &'static str,
    },
    /// Angles that are probably in radians.
    Radians,
    /// A table has too few rows.
    TooFew {
        /// Number of rows found.
        rows: usize,
    },
    /// A row with the wrong number of columns.
    Columns {
        /// Required number of columns.
        count: usize,
        /// Description of a correct row.
        expected: &'static str,
        /// Number of columns found.
        found: usize,
    },
    /// A name that is not permitted in tables.
    BadName,
    /// An empty cell instead of a number.
    EmptyCell,
    /// A mark of a missing value instead of a number.
    MissingValue {
        /// Content of the cell.
        found: String,
    },
    /// A cell that is not a number.
    NotANumber {
        /// Content of the cell.
        found: String,
    },
    /// NaN or infinity instead of a finite number.
    NotFinite {
        /// Content of the cell.
        found: String,
    },
    /// A number outside its range.
    OutOfRange {
        /// The quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The permitted range in words.
        expected: &'static str,
    },
    /// Wavelengths that are probably in micrometres.
    Micrometres,
    /// A wavelength out of order.
    OutOfOrder {
        /// The wavelength.
        nm: f64,
        /// The wavelength of the previous row.
        before: f64,
    },
    /// An error of a BSDF file.
    Bsdf(Box<BsdfProblem>),
    /// The table or formula is not valid optical data.
    Spectra(SpectraError),
    /// Any other error, in the words of the reader that found it.
    Stated(Box<Diagnostic>),
}

impl From<SpectraError> for Problem {
    fn from(error: SpectraError) -> Self {
        Self::Spectra(error)
    }
}

impl From<Diagnostic> for Problem {
    fn from(stated: Diagnostic) -> Self {
        Self::Stated(Box::new(stated))
    }
}

impl From<BsdfProblem> for Problem {
    fn from(problem: BsdfProblem) -> Self {
        Self::Bsdf(Box::new(problem))
    }
}

/// Names that [`is_name`](crate::is_name) accepts.
const GOOD_NAME: &str = "1 to 64 characters, no control characters, no blanks at the ends, nothing that a spreadsheet would read as a \
                         formula (`=` or `@` at the beginning)";

/// Hint for a negative k.
const SIGN_OF_K: &str =
    "Papilio uses n + ik, with k positive in an absorber: change the sign of k in n - ik data";

/// The error of a table with too few rows.
pub(crate) fn too_few(rows: usize) -> Diagnostic {
    let wrong = match rows {
        0 => Diagnostic::new("there are no rows of data"),
        _ => Diagnostic::new("there are too few rows of data"),
    };
    wrong.hint(
        "check that this is the intended file and that it is complete; lines that begin with `#` are comments",
    )
}

impl Problem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unreadable { reason } => Diagnostic::new(format!("this file cannot be read: {reason}")),
            Self::Unwritable { reason, is_of_place } => {
                let wrong = Diagnostic::new(format!("this file cannot be written: {reason}"));
                wrong.hint(match is_of_place {
                    true => "change the permissions or remove what is in its way, or choose another folder",
                    false => "free some space, or choose a folder on another disk",
                })
            }
            Self::Busy => Diagnostic::new("another program is writing this journal")
                .hint("wait until it has finished, or specify a different folder"),
            Self::TooLarge { bytes, limit } => Diagnostic::new(format!("this file has {bytes} bytes"))
                .expected(format!("at most {limit} bytes"))
                .hint("remove unnecessary data: use fewer rows, a coarser grid or a smaller picture"),
            Self::NotUtf8 => {
                Diagnostic::new("this file is not text in UTF-8").hint("save it as plain text in UTF-8")
            }
            Self::Utf16 => Diagnostic::new("this file is not text in UTF-8: it looks like UTF-16")
                .hint("save it as UTF-8"),
            Self::Picture { format } => {
                Diagnostic::new(format!("this is a picture, {}", a_file(format))).expected("a text in UTF-8")
            }
            Self::NotText => Diagnostic::new("this file is not text")
                .expected("text in UTF-8, UTF-16 or Latin-1")
                .hint("save it as plain text, such as CSV"),
            Self::MissingColumn { missing } => {
                Diagnostic::new("a required column is missing").expected(missing)
            }
            Self::Radians => Diagnostic::new("the angles are probably in radians")
                .expected("angles in degrees")
                .hint("write the unit in the names of the columns, such as `theta (rad)` or `theta (deg)`"),
            Self::BadName => Diagnostic::new("this name is not permitted").expected(GOOD_NAME),
            Self::Bsdf(problem) => problem.diagnostic(),
            Self::Spectra(error) => {
                let sign = matches!(error, SpectraError::NoIndex { k, .. } if *k < 0.0);
                Diagnostic::new(error.to_string()).hint_if(sign.then_some(SIGN_OF_K))
            }
            Self::Stated(stated) => (**stated).clone(),
            _ => self.row_diagnostic(),
        }
    }

    /// Diagnostics of rows and cells.
    fn row_diagnostic(&self) -> Diagnostic {
        match self {
            Self::TooFew { rows } => too_few(*rows).expected("at least two wavelengths"),
            Self::Columns { count, expected, found } => {
                let columns = if *found == 1 { "column" } else { "columns" };
                let wrong = Diagnostic::new(format!("this row has {found} {columns}")).expected(expected);
                wrong.hint(if found < count {
                    "separate the columns with commas, semicolons, tabs or blanks"
                } else {
                    "remove the additional columns; with decimal commas, separate the columns by semicolons or tabs; write names that \
                     contain separators in double quotes"
                })
            }
            Self::Micrometres => Diagnostic::new("the wavelengths are probably in micrometres or in eV")
                .expected("wavelengths in nm")
                .hint(
                    "state the unit in the header (`wavelength_um`, `energy_eV`), or convert the values to nm",
                ),
            Self::OutOfOrder { nm, before } => {
                Diagnostic::new(format!("wavelength {nm} nm is out of order after {before} nm"))
                    .expected("wavelengths that all increase, or all decrease, from row to row")
                    .hint("sort the rows by wavelength and keep one row for each wavelength")
            }
            _ => self.number_diagnostic(),
        }
    }

    /// Diagnostics of numbers.
    fn number_diagnostic(&self) -> Diagnostic {
        match self {
            Self::EmptyCell => Diagnostic::new("this cell is empty")
                .expected("a number")
                .hint("enter the value, or remove the row"),
            Self::MissingValue { found } => Diagnostic::new(format!("`{found}` stands for a missing value"))
                .expected("a number")
                .hint("enter the value, or remove the row"),
            Self::NotANumber { found } => {
                let wrong = Diagnostic::new(format!("`{found}` is not a number")).expected("a number");
                wrong.hint(if found.contains([',', ';', ' ', '\t']) {
                    "use the same separator in all rows, and the same decimal mark in all numbers; with decimal commas, separate the \
                     columns by semicolons or tabs"
                } else {
                    "write numbers as 0.5 or 1.2e-3; a line that begins with `#` is a comment"
                })
            }
            Self::NotFinite { found } => Diagnostic::new(format!("`{found}` is not a finite number"))
                .expected("a finite number")
                .hint("remove the row, or enter its value"),
            Self::OutOfRange { what, value, expected } => {
                let hint = match *what {
                    "reflectance" | "the fraction" | "the reflectance factor" if *value > 1.0 => {
                        Some("write fractions as numbers from 0 to 1, not in percent")
                    }
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

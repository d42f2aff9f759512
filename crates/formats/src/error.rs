//! Errors of data files, with their place.

use std::fmt;

use papilio_diagnostics::{Diagnostic, Place};
use papilio_spectra::SpectraError;

use crate::bsdf::BsdfProblem;
use crate::light::MapProblem;
use crate::picture::PictureProblem;
use crate::surface::SurfaceProblem;
use crate::table::ColumnProblem;

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

/// The errors of a data file.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The file cannot be read.
    Unreadable {
        /// The operating system's message.
        reason: String,
    },
    /// The library that decodes the file has failed on its contents.
    Undecodable {
        /// Name of its format, if it is one of pictures.
        format: Option<&'static str>,
    },
    /// The file cannot be written.
    Unwritable {
        /// The operating system's message.
        reason: String,
    },
    /// The file is a journal that another program is writing.
    Busy,
    /// The file is a journal of a different computation.
    ForeignJournal,
    /// The file exceeds the size limit.
    TooLarge {
        /// Size in bytes.
        bytes: u64,
        /// Largest permitted size, bytes.
        limit: u64,
    },
    /// The bytes are not UTF-8.
    NotUtf8,
    /// The bytes are no text in any supported encoding.
    NotText,
    /// A column whose name or unit cannot be used.
    Column(Box<ColumnProblem>),
    /// A header without a required column.
    MissingColumn {
        /// The required columns.
        missing: &'static str,
    },
    /// A spectrum of light over photon energies, wavenumbers or frequencies.
    EnergyAxis,
    /// Angles that are probably in radians.
    Radians,
    /// Reflectance factors that may be fractions or per cent.
    NoScale {
        /// The largest value.
        largest: f64,
    },
    /// An error of a file of an instrument.
    Instrument {
        /// Name of the format.
        format: &'static str,
        /// What is wrong.
        what: String,
    },
    /// The file holds another quantity than the one that is needed.
    OtherQuantity {
        /// The quantity of the file.
        found: &'static str,
        /// The quantity that is needed.
        expected: &'static str,
    },
    /// A table has too few rows.
    TooFew {
        /// Number of rows found.
        rows: usize,
    },
    /// A profile has too few rows.
    TooFewAngles {
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
    /// A quotation mark that is not closed, or that is closed before the end of its cell.
    Quotes,
    /// A name that is not permitted in tables.
    BadName,
    /// The first row of a pixel table is not the required header.
    Header,
    /// The first row of a measured panel lacks required columns.
    PanelHeader,
    /// The first row of a table of rectangles is not the required header.
    WindowHeader,
    /// A table of rectangles without rows.
    NoRectangles,
    /// A rectangle without area.
    EmptyRectangle,
    /// A measured panel without rows.
    EmptyPanel,
    /// The first row of a measured palette lacks required columns.
    PaletteHeader,
    /// A measured palette without rows.
    EmptyPalette,
    /// Two values for the same measured state, direction and wavelength.
    StateTwice {
        /// The state.
        state: String,
        /// Inclination (degrees), if it is stated, and wavelength (nm); `None` for a colour.
        at: Box<[Option<f64>; 2]>,
    },
    /// The file is not JSON, or not a result of a run.
    NotAResult {
        /// What is wrong.
        message: String,
    },
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
    /// A damaged line of a journal.
    BrokenLine {
        /// What is wrong.
        reason: String,
    },
    /// The first line of a journal, which identifies the computation, is damaged.
    BrokenHead {
        /// What is wrong.
        reason: String,
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
    /// Two rows of a pixel table for the same point.
    Duplicate {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// A missing point of a pixel table.
    Hole {
        /// The state.
        state: String,
        /// Angle, degrees.
        theta_deg: f64,
        /// Wavelength, nm.
        nm: f64,
    },
    /// The smallest angle of a pixel table is not 0.
    NoNormal {
        /// The smallest angle, degrees.
        theta_deg: f64,
    },
    /// The file is not YAML, or not in the layout of refractiveindex.info.
    Yaml {
        /// What is wrong.
        message: String,
    },
    /// A `DATA` entry of an unknown type.
    UnknownData {
        /// The value of its `type`.
        found: String,
    },
    /// No entry holds the refractive index.
    NoIndex,
    /// An error of a light map.
    Map(Box<MapProblem>),
    /// An error of a picture.
    Picture(Box<PictureProblem>),
    /// An error of a map of heights.
    Surface(Box<SurfaceProblem>),
    /// An error of an IES LM-63 file.
    Ies {
        /// What is wrong.
        what: String,
    },
    /// An error of a EULUMDAT file.
    Eulumdat {
        /// What is wrong.
        what: String,
    },
    /// An error of a BSDF file.
    Bsdf(Box<BsdfProblem>),
    /// The table or formula is not valid optical data.
    Spectra(SpectraError),
}

impl From<SpectraError> for Problem {
    fn from(error: SpectraError) -> Self {
        Self::Spectra(error)
    }
}

impl From<ColumnProblem> for Problem {
    fn from(problem: ColumnProblem) -> Self {
        Self::Column(Box::new(problem))
    }
}

impl From<MapProblem> for Problem {
    fn from(problem: MapProblem) -> Self {
        Self::Map(Box::new(problem))
    }
}

impl From<PictureProblem> for Problem {
    fn from(problem: PictureProblem) -> Self {
        Self::Picture(Box::new(problem))
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

/// Hint for a table without rows.
const WHOLE_FILE: &str =
    "check that this is the intended file and that it is complete; lines that begin with `#` are comments";

impl Problem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Undecodable { format } => {
                let file = format.map_or("file".to_owned(), |format| format!("{format} file"));
                Diagnostic::new(format!(
                    "this {file} cannot be read: its contents contradict each other, so that the decoder failed"
                ))
                .hint("is it damaged or cut off? Save it again, if possible in another format")
            }
            Self::Unreadable { reason } => Diagnostic::new(format!("this file cannot be read: {reason}")),
            Self::Unwritable { reason } => Diagnostic::new(format!("this file cannot be written: {reason}"))
                .hint("free some space or change the permissions, or choose another folder"),
            Self::Busy | Self::ForeignJournal | Self::BrokenLine { .. } | Self::BrokenHead { .. } => self.journal_diagnostic(),
            Self::TooLarge { bytes, limit } => {
                Diagnostic::new(format!("this file has {bytes} bytes"))
                    .expected(format!("at most {limit} bytes"))
                    .hint("remove unnecessary data: use fewer rows or a coarser grid")
            }
            Self::NotUtf8 => Diagnostic::new("this file is not text in UTF-8").hint("save it as plain text in UTF-8"),
            Self::NotText => Diagnostic::new("this file is not text")
                .expected("text in UTF-8, UTF-16 or Latin-1")
                .hint("save it as plain text, such as CSV"),
            Self::Column(problem) => problem.diagnostic(),
            Self::MissingColumn { .. } | Self::EnergyAxis | Self::Radians | Self::NoScale { .. } => self.header_diagnostic(),
            Self::Instrument { format, what } => Diagnostic::new(format!("this {format} file cannot be used: {what}")),
            Self::OtherQuantity { found, expected } => {
                Diagnostic::new(format!("this file holds {found}")).expected(expected)
            }
            Self::BadName => Diagnostic::new("this name is not permitted").expected(GOOD_NAME),
            Self::Header => Diagnostic::new("this is not the header of a pixel table")
                .expected("`state,theta_deg,wavelength_nm,reflectance`"),
            Self::PanelHeader => Diagnostic::new("this is not the header of a measured panel").expected(
                "the columns `state`, optionally `theta_deg`, and `wavelength_nm`, `reflectance_factor` or `X`, `Y`, `Z` or `L`, `a`, `b`; \
                 or `wavelength_nm` and a column for each state; or `state` and a column for each wavelength",
            ),
            Self::PaletteHeader => Diagnostic::new("this is not the header of a measured palette").expected(
                "the columns `state`, and `wavelength_nm`, `reflectance_factor` or `L`, `a`, `b`; or `wavelength_nm` and a column for each \
                 state; or `state` and a column for each wavelength",
            ),
            Self::WindowHeader => Diagnostic::new("this is not the header of a table of rectangles").expected("`name,x0,y0,x1,y1`"),
            Self::NotAResult { message } => Diagnostic::new(format!("this is not a result.json: {message}"))
                .hint("specify a result.json that `papilio run` has written, or its folder"),
            Self::Yaml { message } => {
                Diagnostic::new(format!("this page of refractiveindex.info cannot be read: {message}"))
            }
            Self::UnknownData { found } => Diagnostic::new(format!("`{found}` is not a known type of optical data"))
                .expected("`tabulated nk`, `tabulated n`, `tabulated k` or `formula 1` to `formula 9`"),
            Self::NoIndex => Diagnostic::new("no entry of `DATA` holds the refractive index n")
                .expected("an entry of type `tabulated nk`, `tabulated n` or `formula 1` to `formula 9`"),
            Self::Ies { what } => Diagnostic::new(format!("this IES LM-63 file cannot be used: {what}")),
            Self::Eulumdat { what } => Diagnostic::new(format!("this EULUMDAT file cannot be used: {what}")),
            Self::Map(problem) => problem.diagnostic(),
            Self::Picture(problem) => problem.diagnostic(),
            Self::Surface(problem) => problem.diagnostic(),
            Self::Bsdf(problem) => problem.diagnostic(),
            Self::Spectra(error) => {
                let sign = matches!(error, SpectraError::NoIndex { k, .. } if *k < 0.0);
                Diagnostic::new(error.to_string()).hint_if(sign.then_some(SIGN_OF_K))
            }
            _ => self.row_diagnostic(),
        }
    }

    /// Diagnostics of the names and units of columns.
    fn header_diagnostic(&self) -> Diagnostic {
        match self {
            Self::MissingColumn { missing } => Diagnostic::new("a required column is missing").expected(missing),
            Self::EnergyAxis => Diagnostic::new("this spectrum of light is given over photon energy, wavenumber or frequency")
                .expected("a wavelength")
                .hint(
                    "power per eV (or per cm-1) is not power per nm: multiply the values by the square of the energy, and convert the                      energies to wavelengths (1239.84 nm eV)",
                ),
            Self::NoScale { largest } => Diagnostic::new(format!(
                "the values reach {largest}, and no column states whether a perfect white is 1 or 100"
            ))
            .expected("values of which a perfect white is 1, or a unit")
            .hint("write the unit in the names of the columns, such as `Y (1)` or `Y (%)`; without one, values above 10 are read as per cent"),
            _ => Diagnostic::new("the angles are probably in radians")
                .expected("angles in degrees")
                .hint("write the unit in the names of the columns, such as `theta_i (rad)` or `theta_i (deg)`"),
        }
    }

    /// Diagnostics of journals.
    fn journal_diagnostic(&self) -> Diagnostic {
        match self {
            Self::Busy => Diagnostic::new("another program is writing this journal")
                .hint("wait until it has finished, or specify a different folder"),
            Self::ForeignJournal => {
                Diagnostic::new(
                    "this journal belongs to a different scenario, different input files or a different version of Papilio",
                )
                .hint("compute all shards from the same scenario file with the same --set options")
            }
            Self::BrokenLine { reason } => {
                Diagnostic::new(format!("this line of a journal is damaged: {reason}")).hint(
                    "delete the line from the file (in the journal of a search, optimize.jsonl, also all lines after it) and run the same \
                     command again: the deleted results are computed again, all others are used",
                )
            }
            Self::BrokenHead { reason } => {
                Diagnostic::new(format!("the first line of this journal is damaged: {reason}")).hint(
                    "the first line identifies the computation: restore it from a copy, or move the file to another folder to \
                     compute everything again",
                )
            }
            _ => Diagnostic::new("this file is not a journal"),
        }
    }

    /// Diagnostics of rows and cells.
    fn row_diagnostic(&self) -> Diagnostic {
        let too_few = |rows: usize| match rows {
            0 => Diagnostic::new("there are no rows of data"),
            _ => Diagnostic::new("there are too few rows of data"),
        };
        match self {
            Self::TooFew { rows } => too_few(*rows).expected("at least two wavelengths").hint(WHOLE_FILE),
            Self::TooFewAngles { rows } => too_few(*rows).expected("at least two angles").hint(WHOLE_FILE),
            Self::EmptyPanel => too_few(0)
                .expected(
                    "a first row with the names of the columns, and a row for each state and direction (for spectra, a row \
                     for each state, direction and wavelength)",
                )
                .hint(WHOLE_FILE),
            Self::EmptyPalette => too_few(0)
                .expected(
                    "a first row with the names of the columns, and a row for each state (for spectra, for each state and wavelength)",
                )
                .hint(WHOLE_FILE),
            Self::StateTwice { state, at } => {
                let [theta_deg, nm] = **at;
                let direction = theta_deg.map_or(String::new(), |theta| format!(" at {theta} deg"));
                let at = nm.map_or(String::new(), |nm| format!(" at {nm} nm"));
                Diagnostic::new(format!("state `{state}`{direction}{at} has two values")).hint("remove one of the two")
            }
            Self::NoRectangles => {
                too_few(0).expected("a row for each rectangle: name, x0, y0, x1, y1").hint(WHOLE_FILE)
            }
            Self::EmptyRectangle => Diagnostic::new("this rectangle has no area")
                .expected("x0 below x1, and y0 below y1")
                .hint("x0, y0 is the lower left corner, x1, y1 the upper right one"),
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
            Self::Quotes => Diagnostic::new("the quotation marks of this cell do not match")
                .hint("begin and end a quoted cell with a double quote; write a double quote inside it twice"),
            Self::Duplicate { state, theta_deg, nm } => {
                Diagnostic::new(format!("state `{state}` at {theta_deg} deg and {nm} nm has two rows"))
                    .hint("remove one of the two rows")
            }
            Self::Hole { state, theta_deg, nm } => {
                Diagnostic::new(format!("state `{state}` has no row for {theta_deg} deg and {nm} nm"))
                    .expected("a row for every wavelength at every angle of every state")
                    .hint("add the row, or remove the wavelength or the angle from all states")
            }
            Self::NoNormal { theta_deg } => Diagnostic::new(format!("the smallest angle is {theta_deg} deg"))
                .expected("0 deg as the smallest angle")
                .hint("add rows for 0 deg, the normal of the display"),
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

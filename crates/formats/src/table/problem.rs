//! What is wrong with the name or the unit of a column.

use papilio_diagnostics::Diagnostic;

/// The errors of the columns of a table, by their names.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnProblem {
    /// A column whose name is not understood.
    Unknown {
        /// Its name.
        found: String,
        /// The quantity that it names, if it is one that this file cannot hold.
        known: Option<&'static str>,
        /// The names that are accepted, with their units.
        accepted: String,
    },
    /// A column whose unit is not understood, or is that of another quantity.
    UnknownUnit {
        /// Name of the column.
        column: String,
        /// The unit.
        unit: String,
        /// The units that are accepted.
        expected: &'static str,
    },
    /// Two columns for the same quantity.
    Twice {
        /// The quantity.
        what: &'static str,
        /// The second column.
        found: String,
        /// The first column.
        other: String,
    },
}

impl ColumnProblem {
    /// Returns what is wrong, what was expected and what to do, in words.
    pub fn diagnostic(&self) -> Diagnostic {
        match self {
            Self::Unknown { found, known, accepted } => {
                let holds = known.map_or(String::new(), |known| format!(": it names {known}"));
                Diagnostic::new(format!("the column `{found}` is not understood{holds}"))
                    .expected("a name of a column that this file may have")
                    .hint(format!("rename the column, or remove it; the columns are {accepted}"))
            }
            Self::UnknownUnit { column, unit, expected } => {
                let wrong = match unit.as_str() {
                    "none" => format!("the column `{column}` states no unit"),
                    unit if unit == column => {
                        format!("the column `{column}` has the unit of another quantity")
                    }
                    unit => format!("the unit `{unit}` of the column `{column}` is not understood"),
                };
                let hint = match unit.as_str() {
                    "none" => {
                        "write the unit in brackets behind the name, or as in `wavelength_nm`".to_owned()
                    }
                    _ if *expected == "no unit" => {
                        "remove what is in brackets, or behind the name, if the values have no unit"
                            .to_owned()
                    }
                    _ => format!(
                        "the accepted units are {expected}: convert the values, or correct the unit if it is written in another way"
                    ),
                };
                Diagnostic::new(wrong).expected(*expected).hint(hint)
            }
            Self::Twice { what, found, other } => {
                Diagnostic::new(format!("`{other}` and `{found}` both name {what}"))
                    .expected("one column for each quantity")
                    .hint("remove one of the two columns, or rename it")
            }
        }
    }
}

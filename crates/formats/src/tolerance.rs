//! Heads of the journals of tolerance analyses and searches, and tables.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

/// First line of the journal of a tolerance analysis: identifies the analysis to which the rows belong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToleranceHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of everything that a row depends on besides its number.
    pub hash: String,
    /// Metrics, in the order of a row's numbers.
    pub metrics: Vec<String>,
}

/// First line of the journal of a search, `optimize.jsonl`: identifies the search to which the records
/// belong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of the search, its scenarios and their input files.
    pub search: String,
}

/// Writes a table as CSV: a row of column names, then rows of cells. A cell without a value is empty.
///
/// # Errors
/// Those of `out`.
pub fn write_table(
    out: impl Write,
    columns: &[String],
    rows: impl Iterator<Item = Vec<String>>,
) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(columns)?;
    for row in rows {
        csv.write_record(row)?;
    }
    csv.flush()
}

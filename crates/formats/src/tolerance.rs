//! What tolerances and searches keep and write: the heads of their journals, and tables.

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

/// What the rows of a tolerance's journal are of: its first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ToleranceHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of all that a row depends on besides its number.
    pub hash: String,
    /// The metrics of a display, in order.
    pub metrics: Vec<String>,
}

/// What the records of a search's journal, `optimize.jsonl`, are of: its first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchHead {
    /// Version of the program.
    pub papilio: String,
    /// SHA-256 of the search, its scenarios and their files.
    pub search: String,
}

/// Writes a table: names of columns, then rows of cells; a cell without a value is empty.
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

//! What a tolerance analysis keeps and writes: the head of its journal, `tolerance.jsonl`, and its tables.

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

//! Output files of `papilio sparkle`: `sparkle.json` and `sparkle.csv`.

use std::io::{self, Write};

use papilio_display::spatial::SparkleResult;
use schemars::JsonSchema;
use serde::Serialize;

/// Content of `sparkle.json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct SparkleFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// Seed of the faces.
    pub seed: u64,
    /// Notes on how the scenario was interpreted, and on the computation.
    pub notes: &'a [String],
    /// The result.
    #[serde(flatten)]
    pub result: &'a SparkleResult,
}

/// Returns the JSON Schema of `sparkle.json`.
pub fn sparkle_schema() -> serde_json::Value {
    schemars::schema_for!(SparkleFile<'_>).to_value()
}

/// Writes `sparkle.csv`: a line for each row of the result, with the same names. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_sparkle(out: impl Write, result: &SparkleResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    for row in &result.rows {
        csv.serialize(row).map_err(io::Error::other)?;
    }
    csv.flush()
}

//! Output files of `papilio gloss`: `gloss.json` and `gloss.csv`.

use std::io::{self, Write};

use papilio_display::gloss::GlossResult;

use crate::spatial::SpatialFile;

/// Content of `gloss.json`.
pub type GlossFile<'a> = SpatialFile<'a, GlossResult>;

/// Returns the JSON Schema of `gloss.json`.
pub fn gloss_schema() -> serde_json::Value {
    schemars::schema_for!(GlossFile<'_>).to_value()
}

/// Writes `gloss.csv`: a row for each state and number. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_gloss(out: impl Write, result: &GlossResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["state", "metric", "value", "error"])?;
    let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for (state, gloss) in result.states.iter() {
        for ((metric, value), (_, error)) in gloss.values.named().zip(gloss.error.named()) {
            csv.write_record([state, metric, &text(value), &text(error)])?;
        }
    }
    csv.flush()
}

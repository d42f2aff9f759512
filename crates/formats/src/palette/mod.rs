//! Palettes: measured colours of the states of a panel ([`read_palette`]), and the files of `papilio palette` ([`PaletteFile`],
//! [`palette_files`]).

mod read;
mod swatches;

use papilio_display::palette::PaletteResult;
pub use read::{PaletteTable, read_palette};
use schemars::JsonSchema;
use serde::Serialize;
pub use swatches::palette_files;

/// Content of `palette.json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct PaletteFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// The result.
    #[serde(flatten)]
    pub result: &'a PaletteResult,
}

/// Returns the JSON Schema of `palette.json`.
pub fn palette_schema() -> serde_json::Value {
    schemars::schema_for!(PaletteFile<'_>).to_value()
}

//! `image.json`, the numbers of `papilio image`.

use papilio_display::image::ImageNumbers;
use schemars::JsonSchema;
use serde::Serialize;

/// Content of `image.json`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ImageFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// SHA-256 of the scenario and the bytes of its files, the picture included.
    pub hash: &'a str,
    /// The result.
    #[serde(flatten)]
    pub result: &'a ImageNumbers,
}

/// Returns the JSON Schema of `image.json`.
pub fn image_schema() -> serde_json::Value {
    schemars::schema_for!(ImageFile<'_>).to_value()
}

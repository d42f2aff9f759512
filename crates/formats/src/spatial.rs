//! The heads that `mtf.json` and `crosstalk.json`, and `palette.json` and `image.json`, share.

use papilio_display::image::ImageNumbers;
use papilio_display::palette::PaletteResult;
use schemars::JsonSchema;
use serde::Serialize;

use crate::panel::FrameNumbers;

/// Content of a JSON file: the scenario and its result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpatialFile<'a, R> {
    /// Version of the program.
    pub papilio: &'a str,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// The scenario with its defaults filled in.
    pub scenario: &'a serde_json::Value,
    /// Notes on how the scenario was interpreted, and on the computation.
    pub notes: &'a [String],
    /// The result.
    #[serde(flatten)]
    pub result: &'a R,
}

/// Content of a JSON file: the title and hash of the scenario, and its result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TitledFile<'a, R> {
    /// Version of the program.
    pub papilio: &'a str,
    /// Title of the scenario.
    pub title: &'a str,
    /// SHA-256 of the scenario and the bytes of its files, a picture included.
    pub hash: &'a str,
    /// Notes on how the scenario was interpreted, and on the computation.
    pub notes: &'a [String],
    /// The result.
    #[serde(flatten)]
    pub result: &'a R,
}

/// Content of `image.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImageFile<'a> {
    /// The head, and the numbers of the picture.
    #[serde(flatten)]
    pub file: TitledFile<'a, ImageNumbers>,
    /// The frame for the panel, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<&'a FrameNumbers>,
}

/// Returns the JSON Schema of `palette.json`.
pub fn palette_schema() -> serde_json::Value {
    schemars::schema_for!(TitledFile<'_, PaletteResult>).to_value()
}

/// Returns the JSON Schema of `image.json`.
pub fn image_schema() -> serde_json::Value {
    schemars::schema_for!(ImageFile<'_>).to_value()
}

//! The head that `mtf.json` and `crosstalk.json` share.

use schemars::JsonSchema;
use serde::Serialize;

/// Content of a JSON file: the scenario and its result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SpatialFile<'a, R> {
    /// Version of the program.
    pub papilio: &'a str,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// The scenario with its defaults filled in.
    pub scenario: &'a serde_json::Value,
    /// The result.
    #[serde(flatten)]
    pub result: &'a R,
}

//! The endpoints `/data` and `/data/file`: the data files of the program and of this visit, with which designs leave the page.

use papilio_scenario::MemoryFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::export::Exported;
use crate::fault::Fault;
use crate::shipped;
use crate::site::Site;

/// A data file that is part of the program.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct DataEntry {
    /// A name by which scenarios use it: `data/H65.bsdf`.
    name: &'static str,
    /// SHA-256 of its bytes.
    sha256: &'static str,
}

pub(super) fn list(_: &Site) -> Result<Vec<DataEntry>, Fault> {
    let entry =
        |(name, file): (&'static String, &'static MemoryFile)| DataEntry { name, sha256: file.sha256() };
    Ok(shipped::DATA.iter().map(entry).collect())
}

/// A request for the bytes of a file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DataOf {
    /// The id of an uploaded file, or the name of a file of the program.
    file: String,
}

pub(super) async fn file(site: Site, request: DataOf) -> Result<Exported, Fault> {
    let found = site.store().get(&request.file).or_else(|| shipped::DATA.get(&request.file).cloned());
    let file = found.ok_or_else(|| Fault::unknown("file", &request.file))?;
    Ok(Exported { kind: "application/octet-stream", bytes: file.file().bytes.clone() })
}

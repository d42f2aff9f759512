//! Scenarios as texts: examples, presets, the schema, changes. Nothing here computes.

use std::collections::BTreeMap;

use papilio_scenario::{Edit, new_scenario, preset_names};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::fault::Fault;
use crate::reading::edited;
use crate::shipped;
use crate::site::Site;

/// The server is there.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Health {
    /// Version of the program.
    papilio: &'static str,
}

pub(super) fn health(_: &Site) -> Result<Health, Fault> {
    Ok(Health { papilio: env!("CARGO_PKG_VERSION") })
}

/// The scenario that the page opens.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Start {
    /// Its name.
    name: String,
    /// Its text.
    scenario: String,
    /// Ids of its files by the names that it gives them.
    files: BTreeMap<String, String>,
}

pub(super) fn start(site: &Site) -> Result<Start, Fault> {
    match site.start() {
        Some(start) => {
            let keep =
                |file: &papilio_formats::DataFile| (file.name.clone(), site.store().keep(file.clone()));
            let files = start.files.iter().map(keep).collect();
            Ok(Start { name: start.name.clone(), scenario: start.scenario.clone(), files })
        }
        None => {
            let scenario = example(shipped::FIRST)?.scenario;
            Ok(Start { name: shipped::FIRST.to_owned(), scenario, files: BTreeMap::new() })
        }
    }
}

pub(super) fn schema(_: &Site) -> Result<Value, Fault> {
    Ok(papilio_scenario::schema())
}

/// A scenario to begin with.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Listed {
    /// What it is asked for by.
    name: String,
    /// What it is, in a sentence or two.
    summary: String,
}

/// A scenario's text.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Text {
    /// TOML.
    scenario: String,
}

pub(super) fn presets(_: &Site) -> Result<Vec<Listed>, Fault> {
    let listed = |name: &str| Some(Listed { name: name.to_owned(), summary: summary(&new_scenario(name)?) });
    Ok(preset_names().filter_map(listed).collect())
}

pub(super) fn preset(name: &str) -> Result<Text, Fault> {
    let scenario = new_scenario(name).ok_or_else(|| Fault::unknown("preset", name))?;
    Ok(Text { scenario })
}

pub(super) fn examples(_: &Site) -> Result<Vec<Listed>, Fault> {
    let listed = |name: String| Some(Listed { summary: summary(&shipped::example(&name)?), name });
    Ok(shipped::examples().filter_map(listed).collect())
}

pub(super) fn example(name: &str) -> Result<Text, Fault> {
    let scenario = shipped::example(name).ok_or_else(|| Fault::unknown("example", name))?;
    Ok(Text { scenario })
}

/// The first paragraph of a scenario's opening comment.
fn summary(scenario: &str) -> String {
    let lines = scenario.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Changes to a scenario's text.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Edits {
    /// TOML.
    scenario: String,
    /// Made one after the other.
    edits: Vec<Edit>,
}

pub(super) async fn edit(site: Site, asked: Edits) -> Result<Text, Fault> {
    site.quick().work(move |_| Ok(Text { scenario: edited(asked.scenario, &asked.edits)? })).await
}

//! The endpoints for texts of scenarios: examples, presets, schema and edits. They compute nothing.

use std::collections::BTreeMap;

use papilio_display::scene::Metric;
use papilio_scenario::{Edit, ExampleDisplay, labelled_names, new_scenario, new_scenario_of, preset_names};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::fault::Fault;
use crate::reading::edited;
use crate::shipped;
use crate::site::Site;

/// The state of the server.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Health {
    /// The version of the program.
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
    /// Its text: TOML.
    scenario: String,
    /// Ids of its files by their names in the scenario.
    files: BTreeMap<String, String>,
}

pub(super) fn start(site: &Site) -> Result<Start, Fault> {
    match site.start() {
        Some(start) => {
            let keep =
                |file: &papilio_formats::DataFile| (file.name.clone(), site.store().insert(file.clone()));
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

/// Names whose labels are requested.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Names {
    /// Names of metrics (`white.Y`) and paths of keys (`display.diffuser.haze`). Without them: all numbers of a result.
    names: Option<Vec<String>>,
}

/// A quantity in words.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Label {
    /// The quantity, such as `Luminance of white`.
    quantity: String,
    /// Its unit, empty if it has none.
    unit: String,
    /// Both: `Luminance of white (cd/m²)`.
    text: String,
}

pub(super) async fn labels(_: Site, request: Names) -> Result<BTreeMap<String, Label>, Fault> {
    let names = request.names.unwrap_or_else(|| labelled_names().collect());
    let label = |name: String| {
        let label = papilio_scenario::label(&name);
        let text = label.to_string();
        (name, Label { quantity: label.quantity, unit: label.unit, text })
    };
    Ok(names.into_iter().map(label).collect())
}

/// A metric of sweeps and searches.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct MetricEntry {
    /// Its name; that of a state, such as `Y`, follows the state's name: `white.Y`.
    name: &'static str,
    /// True if each state has one, false if it is one of the whole display.
    of_state: bool,
    /// The command that prints it: `mtf`, `crosstalk` or `sparkle`; null for those of a run. A sweep computes it only if `sweep.metrics`
    /// names it.
    command: Option<&'static str>,
}

pub(super) fn metrics(_: &Site) -> Result<Vec<MetricEntry>, Fault> {
    let entry = |metric: &Metric| MetricEntry {
        name: metric.name(),
        of_state: !metric.is_of_view(),
        command: metric.source().command(),
    };
    Ok(Metric::ALL.iter().map(entry).collect())
}

/// An entry of a list of presets or examples.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Listed {
    /// Its name, by which it is requested.
    name: String,
    /// A description of one or two sentences.
    summary: String,
}

/// The text of a scenario.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Text {
    /// The scenario: TOML.
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

/// A display to start from, in the light of a preset.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct NewOf {
    /// The kind of display: a name of `/displays`.
    display: String,
    /// The preset of lighting and viewer.
    light: String,
}

/// A new scenario, and the files that it names.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct NewDisplay {
    /// The scenario: TOML.
    scenario: String,
    /// Its files.
    files: Vec<NewFile>,
}

/// A file of a new scenario.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct NewFile {
    /// Its name.
    name: String,
    /// Its text.
    text: String,
}

/// Returns the kinds of displays of `papilio new`.
pub(super) fn displays(_: &Site) -> Result<Vec<Listed>, Fault> {
    let listed = |one: ExampleDisplay| Listed { name: one.name.to_owned(), summary: one.about.to_owned() };
    Ok(ExampleDisplay::ALL.into_iter().map(listed).collect())
}

/// Returns a new scenario, as `papilio new` writes it.
pub(super) async fn new_display(_: Site, request: NewOf) -> Result<NewDisplay, Fault> {
    let NewOf { display: name, light } = request;
    let display = ExampleDisplay::named(&name).ok_or_else(|| Fault::unknown("display", &name))?;
    let scenario = new_scenario_of(display, &light).ok_or_else(|| Fault::unknown("preset", &light))?;
    let file = |(name, text): &(&str, &str)| NewFile { name: (*name).to_owned(), text: (*text).to_owned() };
    Ok(NewDisplay { scenario, files: display.files.iter().map(file).collect() })
}

pub(super) fn examples(_: &Site) -> Result<Vec<Listed>, Fault> {
    let listed = |name: String| Some(Listed { summary: summary(&shipped::example(&name)?), name });
    Ok(shipped::examples().filter_map(listed).collect())
}

pub(super) fn example(name: &str) -> Result<Text, Fault> {
    let scenario = shipped::example(name).ok_or_else(|| Fault::unknown("example", name))?;
    Ok(Text { scenario })
}

pub(super) fn surface_schema(_: &Site) -> Result<Value, Fault> {
    Ok(papilio_scenario::surface_schema())
}

pub(super) fn surfaces(_: &Site) -> Result<Vec<Listed>, Fault> {
    let listed = |name: String| Some(Listed { summary: summary(&shipped::surface(&name)?), name });
    Ok(shipped::surfaces().filter_map(listed).collect())
}

pub(super) fn surface(name: &str) -> Result<Text, Fault> {
    let scenario = shipped::surface(name).ok_or_else(|| Fault::unknown("surface", name))?;
    Ok(Text { scenario })
}

/// Returns the first paragraph of the comment at the beginning of a scenario.
fn summary(scenario: &str) -> String {
    let lines = scenario.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Edits of the text of a scenario.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Edits {
    /// The scenario: TOML.
    scenario: String,
    /// The edits, which are applied in this order.
    edits: Vec<Edit>,
}

pub(super) async fn edit(site: Site, request: Edits) -> Result<Text, Fault> {
    site.quick().work(move |_| Ok(Text { scenario: edited(request.scenario, &request.edits)? })).await
}

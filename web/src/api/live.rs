//! The endpoint `/live`: the result of a scenario by adding, with a prepared display.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use papilio_display::result::RunResult;
use papilio_display::{Control, TransmittedLobe, transmitted_lobes};
use papilio_formats::ResultFile;
use papilio_scenario::{Edit, Resolved};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

use crate::fault::Fault;
use crate::prepared::Accuracy;
use crate::reading::{Given, Solver, edited};
use crate::site::Site;

/// A scenario, with edits that are applied before it is read.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Live {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Edits of the scenario.
    #[serde(default)]
    edits: Vec<Edit>,
    /// `exact` answers meet the target of the scenario; `first` answers are coarse and fast, with their error.
    #[serde(default)]
    accuracy: Accuracy,
    /// Number of the only view that is computed, from 0 (the last one if there are not so many); null: all views. A
    /// single view takes a fraction of the time of many.
    #[serde(default)]
    view: Option<usize>,
}

/// The result of a scenario.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Seen {
    /// The scenario after the edits.
    scenario: String,
    /// The scenario as it was read, with all defaults.
    #[schemars(with = "BTreeMap<String, Value>")]
    fields: Box<serde_json::value::RawValue>,
    /// The contents of result.json; if `is_final` and if all views are computed, as `papilio run --solver adding`
    /// writes it.
    result: Answer,
    /// The directions of all views of the scenario.
    views: Vec<Direction>,
    /// The number of the view that `result` contains; null: all of them.
    view: Option<usize>,
    /// Whether this is the exact answer.
    is_final: bool,
    /// The largest relative error of Y over states and views.
    relative_error: f64,
    /// The preset of lighting and viewer.
    preset: Option<PresetSeen>,
    /// The lobes of the diffusers for the first directed source (without one, along the normal), for the drawing.
    lobes: Vec<TransmittedLobe>,
    /// Warnings about the scenario.
    warnings: Vec<String>,
    /// Time for reading and computing, ms.
    cost_ms: f64,
}

/// The direction of a view.
#[derive(Debug, Serialize, JsonSchema)]
struct Direction {
    /// Inclination, degrees.
    theta_deg: f64,
    /// Azimuth, degrees.
    phi_deg: f64,
}

/// The preset of a scenario.
#[derive(Debug, Serialize, JsonSchema)]
struct PresetSeen {
    /// Its name.
    name: &'static str,
    /// Whether the scenario changes its light or its viewer.
    changed: bool,
}

/// The contents of `result.json`.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) resolved: Resolved,
    pub(super) result: RunResult,
}

impl Answer {
    /// Returns the title of the scenario; empty if it has none.
    pub(super) fn title(&self) -> &str {
        self.resolved.title.as_deref().unwrap_or_default()
    }

    /// Returns the contents in the form in which they are written.
    pub(super) fn file(&self) -> ResultFile<'_> {
        ResultFile {
            papilio: env!("CARGO_PKG_VERSION"),
            scenario: &self.resolved.canonical,
            hash: &self.resolved.hash,
            seed: self.resolved.scene.solver.seed,
            notes: &self.result.notes,
            result: &self.result,
        }
    }
}

impl Serialize for Answer {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.file().serialize(serializer)
    }
}

impl JsonSchema for Answer {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "ResultFile".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        ResultFile::<'_>::json_schema(generator)
    }
}

/// Computes the result of a scenario by adding, like `papilio run`.
pub(super) fn compute_scenario(site: &Site, given: &Given, stop: &AtomicBool) -> Result<Answer, Fault> {
    let (_, resolved) = given.resolve(site, Solver::Adding)?;
    compute_scene(site, resolved, Accuracy::Exact, stop)
}

/// Computes the result of a resolved scenario by adding.
pub(super) fn compute_scene(
    site: &Site,
    resolved: Resolved,
    accuracy: Accuracy,
    stop: &AtomicBool,
) -> Result<Answer, Fault> {
    let control = Control { threads: None, progress: &|_| {}, stop };
    let result = site.prepared().answer(&resolved.scene, accuracy, &control);
    let mut result = result.map_err(|error| Fault::of(&resolved, error))?;
    resolved.warn_before(&mut result.warnings);
    result.notes.splice(0..0, resolved.notes.iter().cloned());
    Ok(Answer { resolved, result })
}

pub(super) async fn live(site: Site, live: Live) -> Result<Seen, Fault> {
    let server = site.clone();
    site.quick().work(move |stop| compute(&server, live, stop)).await
}

fn compute(site: &Site, live: Live, stop: &AtomicBool) -> Result<Seen, Fault> {
    let started = Instant::now();
    let scenario = edited(live.scenario, &live.edits)?;
    let given = Given { scenario, files: live.files };
    let about = |fault: Fault| fault.about(&given.scenario);
    let (read, mut resolved) = given.resolve(site, Solver::Adding).map_err(about)?;
    let viewer = &resolved.scene.viewer;
    let views: Vec<Direction> =
        viewer.directions().map(|(theta_deg, phi_deg)| Direction { theta_deg, phi_deg }).collect();
    let view = live.view.filter(|_| views.len() > 1).map(|number| number.min(views.len() - 1));
    if let Some(number) = view {
        resolved.scene.viewer = viewer.with_view(number);
    }
    let fields = serde_json::value::to_raw_value(&read.filled());
    let fields = fields.map_err(|_| Fault::internal("the scenario cannot be serialised"))?;
    let preset = read.preset().map(|one| PresetSeen { name: one.name, changed: one.is_changed });
    let control = Control { threads: None, progress: &|_| {}, stop };
    let lobes = transmitted_lobes(&resolved.scene, &control);
    let lobes = lobes.map_err(|error| about(Fault::of(&resolved, error)))?;
    let result = compute_scene(site, resolved, live.accuracy, stop).map_err(about)?;
    let warnings = result.result.warnings.clone();
    let cost_ms = 1e3 * started.elapsed().as_secs_f64();
    let solver = &result.result.solver;
    let (is_final, relative_error) = (solver.is_final, solver.relative_error_reached);
    let scenario = given.scenario;
    Ok(Seen {
        scenario,
        fields,
        result,
        views,
        view,
        is_final,
        relative_error,
        preset,
        lobes,
        warnings,
        cost_ms,
    })
}

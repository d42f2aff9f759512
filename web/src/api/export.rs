//! The endpoint `/export`: results as files, those of `papilio run` and a report.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use axum::http::StatusCode;
use papilio_display::ambient_light_by_direction;
use papilio_display::scene::AngleMedium;
use papilio_figures::PngError;
use papilio_formats::report::RunReport;
use papilio_formats::{write_json, write_spectra, write_states};
use schemars::JsonSchema;
use serde::Deserialize;

use super::drawn::{CONE_STEPS_DEG, compute_cone};
use super::live::{Answer, compute_scenario};
use crate::fault::Fault;
use crate::reading::Given;
use crate::site::Site;

/// A request for the result of a scenario as a file.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ExportOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// `result.json`, `states.csv`, `spectra.csv`, `report.html`, or a figure's name with `.svg` or `.png`.
    what: String,
}

/// A file.
#[derive(Debug)]
pub(super) struct Exported {
    pub(super) kind: &'static str,
    pub(super) bytes: Vec<u8>,
}

pub(super) async fn export(site: Site, request: ExportOf) -> Result<Exported, Fault> {
    let server = site.clone();
    let given = Given { scenario: request.scenario, files: request.files };
    site.long().work(move |stop| exported(&server, &given, &request.what, stop)).await
}

fn exported(site: &Site, given: &Given, what: &str, stop: &AtomicBool) -> Result<Exported, Fault> {
    let answer = compute_scenario(site, given, stop)?;
    let mut bytes = Vec::new();
    let text = |bytes: Vec<u8>, kind| Exported { kind, bytes };
    let written =
        |done: Result<(), std::io::Error>| done.map_err(|_| Fault::internal("the file cannot be written"));
    let csv = "text/csv; charset=utf-8";
    match what {
        "result.json" => {
            written(write_json(&mut bytes, &answer.file())).map(|()| text(bytes, "application/json"))
        }
        "states.csv" => written(write_states(&mut bytes, &answer.result)).map(|()| text(bytes, csv)),
        "spectra.csv" => written(write_spectra(&mut bytes, &answer.result)).map(|()| text(bytes, csv)),
        "report.html" => {
            let page = report(&answer, stop)?;
            Ok(text(page.into_bytes(), "text/html; charset=utf-8"))
        }
        _ => figure(&answer, what, stop),
    }
}

/// The title of the report of a scenario without title, which has no file on the page.
const UNTITLED: &str = "A reflective display";

/// The page that `papilio run --report --cone` writes.
fn report(answer: &Answer, stop: &AtomicBool) -> Result<String, Fault> {
    let cone = compute_cone(&answer.resolved, CONE_STEPS_DEG.0, stop)?.allowing(None)?;
    let scene = &answer.resolved.scene;
    let light = ambient_light_by_direction(scene).map_err(|error| Fault::of(&answer.resolved, error))?;
    let title = if answer.title().is_empty() { UNTITLED } else { answer.title() };
    let figures = papilio_figures::of_run_with_maps(&answer.result, light.as_ref(), Some(&cone), title);
    let file = answer.file();
    let in_glass = scene.solver.angle_medium == AngleMedium::Glass;
    Ok(RunReport { title, file: &file, cone_warnings: &cone.warnings, figures: &figures, in_glass }.html())
}

fn figure(answer: &Answer, what: &str, stop: &AtomicBool) -> Result<Exported, Fault> {
    let unknown = || Fault::unknown("export", what);
    let (name, end) = what.rsplit_once('.').ok_or_else(unknown)?;
    let svg = match name {
        "cone" => {
            let cone = compute_cone(&answer.resolved, CONE_STEPS_DEG.0, stop)?.allowing(None)?;
            papilio_figures::cone(&cone, answer.title())
        }
        _ => {
            let all = papilio_figures::of_run(&answer.result, answer.title());
            all.into_iter().find(|(known, _)| known == name).map(|(_, svg)| svg)
        }
    };
    let svg = svg.ok_or_else(unknown)?;
    match end {
        "svg" => Ok(Exported { kind: "image/svg+xml", bytes: svg.into_bytes() }),
        "png" => {
            let png = papilio_figures::png(&svg, papilio_figures::PNG_SCALE);
            let bytes = png.map_err(|error| match error {
                PngError::NotBuilt => Fault::new(StatusCode::NOT_IMPLEMENTED, error.to_string(), ""),
                error => Fault::internal(&format!("the figure cannot be converted to PNG: {error}")),
            })?;
            Ok(Exported { kind: "image/png", bytes: bytes.value })
        }
        _ => Err(unknown()),
    }
}

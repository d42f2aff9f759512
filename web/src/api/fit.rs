//! The endpoint `/fit`: keys of a scenario from measured files, as by `papilio fit`, as a stream of events.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::path::Path;
use std::thread::available_parallelism;

use axum::http::StatusCode;
use papilio_design::DesignError;
use papilio_design::fit::{FitReport, Fitting};
use papilio_design::output::{fit_figures, fit_table, fitted_edits, fitted_text};
use papilio_design::search::was_stopped;
use papilio_display::compare::Measurement;
use papilio_formats::read_measurement;
use papilio_scenario::{Edit, Fit, Resolved};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver};
use crate::site::Site;

/// A scenario with `[fit]`, and measured files.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FitOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Ids of the uploaded measurements.
    measured: Vec<String>,
}

/// An event of a fit.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum FitEvent {
    /// What is done so far.
    Progress(FitProgress),
    /// The fit is complete.
    Done(Box<FitDone>),
    /// The fit has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a fit.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FitProgress {
    /// Fraction of the work that is done, 0 to 1.
    fraction: f64,
    /// What is done: starts, ends of intervals.
    words: String,
}

/// The result of a fit.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FitDone {
    /// The contents of fit.json.
    report: FitReport,
    /// The text of fitted.toml: the scenario with the fitted values, and the intervals in comments.
    scenario: String,
    /// The edits that give the scenario the fitted values.
    edits: Vec<Edit>,
    /// The text of fit.csv: each measured number with its fit.
    csv: String,
    /// Spectra with their fits, and residuals.
    figures: Vec<Figure>,
    /// How the measured files were read.
    notes: Vec<String>,
}

pub(super) async fn fit(site: Site, request: FitOf) -> Result<Events, Fault> {
    let server = site.clone();
    // Errors of the scenario and of the measured files are reported before the stream starts.
    let read = site.quick().work(move |_| Reading::new(&server, request)).await?;
    events::start(site.streamed(), move |events| {
        computed(read, events)
            .map_or_else(|fault| FitEvent::Failed(fault.body), |done| FitEvent::Done(Box::new(done)))
    })
    .await
}

/// A fit and its measurement, as they were read.
struct Reading {
    scenario: String,
    spec: Fit,
    resolved: Resolved,
    measured: Measurement,
    notes: Vec<String>,
}

impl Reading {
    fn new(site: &Site, request: FitOf) -> Result<Self, Fault> {
        let FitOf { scenario, files, measured: ids } = request;
        let (measured, notes) = measurement(site, &ids)?;
        let given = Given { scenario, files };
        let library = given.library(site)?;
        let set = given.overrides(&library, Solver::Adding)?;
        let spec = Fit::from_text(&given.scenario, "scenario", library, &set)?;
        let (_, resolved) = given.resolve(site, Solver::Adding)?;
        Ok(Self { scenario: given.scenario, spec, resolved, measured, notes })
    }
}

/// Reads the uploaded measurements, each once, with notes on how they were read.
fn measurement(site: &Site, ids: &[String]) -> Result<(Measurement, Vec<String>), Fault> {
    let (mut all, mut notes) = (Measurement::default(), Vec::new());
    if ids.is_empty() {
        return Err(Fault::too_much("nothing is measured", "choose at least one measured file"));
    }
    for id in ids.iter().collect::<BTreeSet<_>>() {
        let file = site.store().get(id).ok_or_else(|| {
            let mut fault =
                Fault::new(StatusCode::GONE, "a measurement is no longer stored", "send it again");
            fault.body.missing = Some(vec![id.clone()]);
            fault
        })?;
        let read = read_measurement(file.file())?;
        notes.extend(read.warnings.iter().map(|note| format!("{}: {note}", file.file().name)));
        all.append(read.value);
    }
    Ok((all, notes))
}

fn computed(read: Reading, events: &EventSender) -> Result<FitDone, Fault> {
    let Reading { scenario, spec, resolved, measured, mut notes } = read;
    let fault = |error| fault_of(&resolved, events, error);
    let title = spec.title.clone().unwrap_or_default();
    notes.extend(spec.notes.iter().cloned());
    let fitting = Fitting::new(spec, &measured, events.stop()).map_err(fault)?;
    let tell = |fraction: f64, words: &str| {
        events.stop_if_late();
        events.send(&FitEvent::Progress(FitProgress { fraction, words: words.to_owned() }));
    };
    let report = fitting.run(threads(), &tell).map_err(fault)?.ok_or_else(|| {
        let hint = "use more starts (fit.starts), or narrower bounds around what is known";
        Fault::too_much("no start led to a minimum", hint)
    })?;
    let here = Path::new("");
    let text = fitted_text(&scenario, [here, here], &fitting, &report).map_err(fault)?;
    let figures = fit_figures(&title, &report).into_iter();
    Ok(FitDone {
        scenario: text,
        edits: fitted_edits(&fitting, &report).map_err(fault)?,
        csv: fit_table(&report),
        figures: figures.map(|(name, svg)| Figure { name, svg }).collect(),
        notes,
        report,
    })
}

/// Threads of a long computation: one is left for live results.
pub(super) fn threads() -> usize {
    available_parallelism().map_or(1, NonZero::get).saturating_sub(1).max(1)
}

/// Error of a fit, a search or a tolerance analysis, with its place in the scenario if it has one.
pub(super) fn fault_of(resolved: &Resolved, events: &EventSender, error: DesignError) -> Fault {
    let is_late = was_stopped(&error) && events.stop_if_late();
    match error {
        _ if is_late => crate::work::too_long(events.deadline()),
        DesignError::Scenario(errors) => errors.into(),
        DesignError::Display(error) => Fault::of(resolved, error),
        DesignError::Fit { reason } => {
            let (message, hint) = reason.split_once("\n  = help: ").unwrap_or((&reason, ""));
            Fault::too_much(message, hint)
        }
        other => Fault::too_much(other.to_string(), ""),
    }
}

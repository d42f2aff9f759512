//! The endpoint `/sweep`: the results of a scenario at the points of its `[sweep]`, as a stream of events.

use std::collections::{BTreeMap, BTreeSet};

use papilio_design::{DesignError, Evaluator, LightStudy};
use papilio_display::Control;
use papilio_formats::{LightHead, SweepHead, SweepPoint, light_points, write_light_csv, write_sweep_csv};
use papilio_scenario::{LightSweep, Sweep};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use super::written::text;
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver, check_work};
use crate::site::Site;

/// Maximum number of points; the command line computes more.
const MOST_POINTS: usize = 4000;

/// Maximum number of points that are checked before the first one is computed.
const MOST_SAMPLES: usize = 100;

/// An event of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum SweepEvent {
    /// A point is computed.
    Point(Point),
    /// All points are computed.
    Done(SweepDone),
    /// The sweep has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// A computed point.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Point {
    /// Its index, from 0; the last axis varies fastest.
    index: usize,
    /// The number of points.
    of: usize,
    /// The values of the swept keys.
    values: BTreeMap<String, Value>,
    /// Metrics of the first view by name: `contrast_ratio`, `red.u_prime`; with `_de`: discretisation errors; with `_se`: standard
    /// errors. If the sweep names its `metrics`, these; otherwise all metrics of colours.
    metrics: BTreeMap<String, Option<f64>>,
}

/// The end of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct SweepDone {
    /// The text of `sweep.csv`.
    csv: String,
    /// The figures of `sweep.figures`, as `papilio sweep` draws them.
    figures: Vec<Figure>,
    /// The warnings of all points, without repetitions; if the sweep names its `metrics`, those of the points that are checked first.
    warnings: Vec<String>,
}

pub(super) async fn sweep(site: Site, given: Given) -> Result<Events, Fault> {
    let server = site.clone();
    let (sweep, light, warnings) = site.quick().work(move |_| read_sweep(&server, &given)).await?;
    let server = site.clone();
    events::start(site.streamed(), move |events| {
        let done = match light {
            Some(light) => named_metrics(&sweep, light, warnings, events),
            None => all_metrics(&server, &sweep, events),
        };
        done.unwrap_or_else(|fault| SweepEvent::Failed(fault.body))
    })
    .await
}

/// Reads a sweep and checks that each of its values can be used. Returns also the sweep of the metrics that it names, and the
/// warnings of the points that are checked.
fn read_sweep(site: &Site, given: &Given) -> Result<(Sweep, Option<LightSweep>, Vec<String>), Fault> {
    let library = given.library(site)?;
    let set = given.overrides(&library, Solver::Adding)?;
    let mut sweep = Sweep::from_text(&given.scenario, "scenario", library, &set)?;
    if sweep.len() > MOST_POINTS {
        let message = format!("{} points are too many for the page: at most {MOST_POINTS}", sweep.len());
        return Err(Fault::too_much(message, "choose fewer values on an axis, or use `papilio sweep`"));
    }
    let mut warnings = BTreeSet::new();
    for point in sweep.samples().into_iter().take(MOST_SAMPLES) {
        let resolved = sweep.scenario(point)?.resolve()?;
        check_work(&resolved, Solver::Adding)?;
        warnings.extend(resolved.warnings);
    }
    let light = sweep.light()?;
    Ok((sweep, light, warnings.into_iter().collect()))
}

/// Computes the metrics of colours of all points.
fn all_metrics(site: &Site, sweep: &Sweep, events: &EventSender) -> Result<SweepEvent, Fault> {
    let head = sweep.head(env!("CARGO_PKG_VERSION"), "");
    let control = Control { threads: Some(1), progress: &|_| {}, stop: events.stop() };
    let mut points = Vec::with_capacity(sweep.len());
    for index in 0..sweep.len() {
        if events.stop_if_late() {
            return Err(crate::work::too_long(events.deadline()));
        }
        let resolved = sweep.scenario(index)?.resolve()?;
        let result = site.prepared().run(&resolved.scene, &control);
        let mut result = result.map_err(|error| Fault::of(&resolved, error))?;
        result.warnings.splice(0..0, resolved.warnings);
        let point = SweepPoint::new(index, resolved.hash, env!("CARGO_PKG_VERSION"), &result);
        events.send_reliably(&SweepEvent::Point(point_event(&head, index, &point)));
        points.push(point);
    }
    let all: Vec<&SweepPoint> = points.iter().collect();
    let csv = text(|out| write_sweep_csv(out, &head, &all))?;
    let mut warnings: Vec<String> = points.iter().flat_map(|point| point.warnings.clone()).collect();
    warnings.sort_unstable();
    warnings.dedup();
    Ok(SweepEvent::Done(SweepDone { csv, figures: drawn(&head, &all), warnings }))
}

/// Computes the metrics that the sweep names, which may be those of pixels: sharpness, crosstalk and sparkle.
fn named_metrics(
    sweep: &Sweep,
    light: LightSweep,
    warnings: Vec<String>,
    events: &EventSender,
) -> Result<SweepEvent, Fault> {
    let mut head = sweep.head(env!("CARGO_PKG_VERSION"), "");
    let (views, hash) = (light.views.clone(), light.hash.clone());
    let study = LightStudy::new(light);
    head.light = Some(LightHead { metrics: study.columns(), views, hash });
    let mut evaluator = Evaluator::new(study.study().clone(), events.stop());
    let mut rows = Vec::with_capacity(sweep.len());
    for index in 0..sweep.len() {
        if events.stop_if_late() {
            return Err(crate::work::too_long(events.deadline()));
        }
        let row = study.evaluate(&mut evaluator, index).map_err(|error| fault_at(sweep, index, error))?;
        let point = light_points(&head, &[&row]).remove(0);
        events.send_reliably(&SweepEvent::Point(point_event(&head, index, &point)));
        rows.push(row);
    }
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let points = light_points(&head, &rows);
    let csv = text(|out| write_light_csv(out, &head, &rows))?;
    let figures = drawn(&head, &points.iter().collect::<Vec<_>>());
    Ok(SweepEvent::Done(SweepDone { csv, figures, warnings }))
}

/// Error of a point, with its place in the scenario if it has one.
fn fault_at(sweep: &Sweep, index: usize, error: DesignError) -> Fault {
    match error {
        DesignError::Scenario(errors) => errors.into(),
        DesignError::Display(error) => match sweep.scenario(index).and_then(|scenario| scenario.resolve()) {
            Ok(resolved) => Fault::of(&resolved, error),
            Err(_) => error.into(),
        },
        other => Fault::too_much(other.to_string(), ""),
    }
}

fn drawn(head: &SweepHead, points: &[&SweepPoint]) -> Vec<Figure> {
    let figures = papilio_figures::of_sweep(head, points, &papilio_scenario::label);
    figures.into_iter().map(|(name, svg)| Figure { name, svg }).collect()
}

fn point_event(head: &SweepHead, index: usize, point: &SweepPoint) -> Point {
    let view = point.views().first().copied().unwrap_or_default();
    let metric = |name: String| {
        let value = point.metric(view, &name);
        (name, value)
    };
    // Colours are computed by adding, which has no standard errors.
    let is_named = head.light.is_some();
    let names = point.metrics().into_iter().filter(|name| is_named || !name.ends_with("_se"));
    Point {
        index,
        of: head.points(),
        values: head.swept(index).map(|(key, value)| (key.to_owned(), value.clone())).collect(),
        metrics: names.map(metric).collect(),
    }
}

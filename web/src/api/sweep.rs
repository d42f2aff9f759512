//! A scenario at every point of its `[sweep]`, told point by point.

use std::collections::BTreeMap;

use papilio_display::Control;
use papilio_formats::{SweepHead, SweepPoint, write_sweep_csv};
use papilio_scenario::Sweep;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use super::drawn::Figure;
use super::events::{self, Events, Teller};
use crate::fault::{Fault, FaultBody};
use crate::reading::{By, Given, check_work};
use crate::site::Site;

/// More points are a matter of the command line.
const MOST_POINTS: usize = 4000;

/// Points that are looked at before any is computed.
const MOST_SAMPLES: usize = 100;

/// What a sweep tells.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum SweepEvent {
    /// A point is done.
    Point(Point),
    /// All are.
    Done(SweepDone),
    /// Instead of the end.
    Failed(FaultBody),
}

/// A point that is done.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Point {
    /// Its number, from 0; the last axis is the fastest.
    index: usize,
    /// How many there are.
    of: usize,
    /// What each swept key is there.
    values: BTreeMap<String, Value>,
    /// Every metric of the first view by its name: `contrast_ratio`, `red.u_prime`; `_de`: its discretisation error.
    metrics: BTreeMap<String, Option<f64>>,
}

/// The end of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct SweepDone {
    /// `sweep.csv`.
    csv: String,
    /// What `papilio sweep` draws of `sweep.figures`.
    figures: Vec<Figure>,
    /// Warnings of the points, each once.
    warnings: Vec<String>,
}

pub(super) async fn sweep(site: Site, given: Given) -> Result<Events, Fault> {
    let of = site.clone();
    let sweep = site.quick().work(move |_| prepared(&of, &given)).await?;
    let of = site.clone();
    events::start(site.walks(), move |teller| {
        run(&of, &sweep, teller).unwrap_or_else(|fault| SweepEvent::Failed(fault.body))
    })
    .await
}

/// The sweep, of which each value was looked at.
fn prepared(site: &Site, given: &Given) -> Result<Sweep, Fault> {
    let library = given.library(site)?;
    let set = given.overrides(&library, By::Adding)?;
    let sweep = Sweep::from_text(&given.scenario, "scenario", library, &set)?;
    if sweep.len() > MOST_POINTS {
        let message = format!("{} points are too many for the page: at most {MOST_POINTS}", sweep.len());
        return Err(Fault::too_much(message, "fewer values on an axis, or `papilio sweep`"));
    }
    for point in sweep.samples().into_iter().take(MOST_SAMPLES) {
        check_work(&sweep.scenario(point)?.resolve()?)?;
    }
    Ok(sweep)
}

fn run(site: &Site, sweep: &Sweep, teller: &Teller) -> Result<SweepEvent, Fault> {
    let head = sweep.head(env!("CARGO_PKG_VERSION"), "");
    let control = Control { threads: Some(1), progress: &|_| {}, stop: teller.stop() };
    let mut points = Vec::with_capacity(sweep.len());
    for index in 0..sweep.len() {
        if teller.is_late() {
            return Err(crate::work::too_long(teller.deadline()));
        }
        let resolved = sweep.scenario(index)?.resolve()?;
        let result = site.kept().run(&resolved.scene, &control);
        let mut result = result.map_err(|error| Fault::of(&resolved, error))?;
        result.warnings.splice(0..0, resolved.warnings);
        let point = SweepPoint::new(index, resolved.hash, env!("CARGO_PKG_VERSION"), &result);
        teller.tell_surely(&SweepEvent::Point(told(&head, index, &point)));
        points.push(point);
    }
    let mut csv = Vec::new();
    let all: Vec<&SweepPoint> = points.iter().collect();
    write_sweep_csv(&mut csv, &head, &all).map_err(|_| Fault::internal("the table cannot be written"))?;
    let mut warnings: Vec<String> = points.iter().flat_map(|point| point.warnings.clone()).collect();
    warnings.sort_unstable();
    warnings.dedup();
    let csv = String::from_utf8_lossy(&csv).into_owned();
    let figures = papilio_figures::of_sweep(&head, &all);
    let figures = figures.into_iter().map(|(name, svg)| Figure { name, svg }).collect();
    Ok(SweepEvent::Done(SweepDone { csv, figures, warnings }))
}

fn told(head: &SweepHead, index: usize, point: &SweepPoint) -> Point {
    let view = point.views().first().copied().unwrap_or_default();
    let metric = |name: String| {
        let value = point.metric(view, &name);
        (name, value)
    };
    // Adding has no standard errors.
    let names = point.metrics().into_iter().filter(|name| !name.ends_with("_se"));
    Point {
        index,
        of: head.points(),
        values: head.swept(index).map(|(key, value)| (key.to_owned(), value.clone())).collect(),
        metrics: names.map(metric).collect(),
    }
}

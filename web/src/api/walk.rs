//! The endpoint `/walk`: a run of the Monte Carlo solver, compared with the result of adding, as a stream of
//! events.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::Mutex;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use papilio_display::result::{StateValues, View};
use papilio_display::{Control, Progress};
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use serde_json::value::RawValue;

use super::events::{self, EventSender, Events};
use super::live::{Answer, compute_scenario};
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver};
use crate::site::Site;

/// Minimum time between progress events; rounds that finish earlier are not reported, except the first one.
const MIN_INTERVAL: Duration = Duration::from_millis(100);

/// An event of a Monte Carlo run.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum WalkEvent {
    /// Intermediate estimates.
    Progress(WalkProgress),
    /// The final result.
    Done(Box<WalkDone>),
    /// The run has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a Monte Carlo run.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct WalkProgress {
    /// Number of paths traced so far, for all views.
    paths: u64,
    /// Time since the start, s.
    seconds: f64,
    /// The largest relative standard error of Y in the current view.
    relative_error: f64,
    /// Number of finished views.
    views_done: usize,
    /// Number of views.
    views: usize,
    /// The estimates so far, for each view that was started and each state.
    states: Vec<WalkState>,
}

/// The result of a Monte Carlo run.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct WalkDone {
    /// Number of paths.
    paths: u64,
    /// Time of the run, s.
    seconds: f64,
    /// The largest relative standard error of Y.
    relative_error: f64,
    /// The estimates for each view and state.
    states: Vec<WalkState>,
    /// The contents of result.json, as `papilio run --solver monte-carlo` writes it.
    result: Answer,
    /// The scenario as it was read, with all defaults.
    #[schemars(with = "BTreeMap<String, Value>")]
    fields: Box<RawValue>,
}

/// A state by Monte Carlo and by adding (the live result).
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "as in result.json")]
pub(super) struct WalkState {
    /// Its name.
    name: String,
    /// Index of the view, from 0.
    view: usize,
    /// Tristimulus value X by Monte Carlo.
    X: f64,
    /// Standard error of X.
    X_se: f64,
    /// Tristimulus value Y by Monte Carlo.
    Y: f64,
    /// Standard error of Y.
    Y_se: f64,
    /// Tristimulus value Z by Monte Carlo.
    Z: f64,
    /// Standard error of Z.
    Z_se: f64,
    /// Y by adding; null if adding refuses the scenario.
    live_Y: Option<f64>,
    /// Difference of the two values of Y over the combined error; null if both are exact.
    z: Option<f64>,
    /// The same for X, Y and Z.
    z_of_xyz: [Option<f64>; 3],
}

pub(super) async fn walk(site: Site, given: Given) -> Result<Events, Fault> {
    let server = site.clone();
    // Errors of the scenario are reported before the stream starts.
    let (started, live) = site
        .quick()
        .work(move |stop| {
            let (read, resolved) = given.resolve(&server, Solver::MonteCarlo)?;
            let fields = serde_json::value::to_raw_value(&read.filled());
            let fields = fields.map_err(|_| Fault::internal("the scenario cannot be serialised"))?;
            let live = match compute_scenario(&server, &given, stop) {
                Ok(live) => Some(live),
                Err(fault) if fault.is_for_monte_carlo() => None,
                Err(fault) => return Err(fault),
            };
            Ok((Started { resolved, fields }, live))
        })
        .await?;
    events::start(site.streamed(), move |events| run(started, live.as_ref(), events)).await
}

/// A scenario whose run has started.
struct Started {
    resolved: Resolved,
    fields: Box<RawValue>,
}

fn run(started: Started, live: Option<&Answer>, events: &EventSender) -> WalkEvent {
    let Started { resolved, fields } = started;
    let reported = Mutex::new(Reported { time: None, states: Vec::new() });
    let report = |progress: Progress<'_>| {
        events.stop_if_late();
        if let Ok(mut reported) = reported.lock() {
            reported.report(progress, live, events);
        }
    };
    // One thread is left for live results.
    let threads = available_parallelism().map_or(1, NonZero::get).saturating_sub(1).max(1);
    let control = Control { threads: Some(threads), progress: &report, stop: events.stop() };
    match papilio_display::run(&resolved.scene, &control) {
        Ok(mut result) => {
            resolved.warn_before(&mut result.warnings);
            let views = result.views.iter().enumerate();
            let states = views.flat_map(|(number, view)| states(number, view, live)).collect();
            WalkEvent::Done(Box::new(WalkDone {
                paths: result.solver.paths.unwrap_or(0),
                seconds: events.seconds(),
                relative_error: result.solver.relative_error_reached,
                states,
                result: Answer { resolved, result },
                fields,
            }))
        }
        Err(error) => WalkEvent::Failed(Fault::of(&resolved, error).body),
    }
}

/// The estimates that were reported last, and the time of the report.
struct Reported {
    time: Option<Instant>,
    states: Vec<WalkState>,
}

impl Reported {
    fn report(&mut self, progress: Progress<'_>, live: Option<&Answer>, events: &EventSender) {
        let (done, views) = progress.views_done;
        let is_due = self.time.is_none_or(|time| time.elapsed() >= MIN_INTERVAL);
        let Some(so_far) = progress.so_far.filter(|_| is_due) else { return };
        let (number, view) = so_far();
        self.time = Some(Instant::now());
        self.states.retain(|state| state.view != number);
        self.states.extend(states(number, &view, live));
        events.send(&WalkEvent::Progress(WalkProgress {
            paths: progress.paths.unwrap_or(0),
            seconds: events.seconds(),
            relative_error: progress.relative_error.unwrap_or(f64::INFINITY),
            views_done: done,
            views,
            states: self.states.clone(),
        }));
    }
}

/// Compares the states of a view with those of the live result, if there is one.
fn states(number: usize, view: &View, live: Option<&Answer>) -> Vec<WalkState> {
    let live_view = live.and_then(|live| live.result.views.get(number));
    let compare = |(name, estimate): (&str, &papilio_display::result::State)| {
        let live = live_view.and_then(|view| view.states.get(name));
        let xyz = |values: &StateValues| [values.X, values.Y, values.Z];
        let (value, se) = (xyz(&estimate.value), xyz(&estimate.standard_error));
        let exact = live.map(|live| xyz(&live.value));
        let de = live.and_then(|live| live.discretisation_error.as_ref()).map_or([0.0; 3], xyz);
        let z = |k: usize| {
            let error = se[k].hypot(de[k]);
            exact.filter(|_| error > 0.0).map(|exact| (value[k] - exact[k]) / error)
        };
        WalkState {
            name: name.to_owned(),
            view: number,
            X: value[0],
            X_se: se[0],
            Y: value[1],
            Y_se: se[1],
            Z: value[2],
            Z_se: se[2],
            live_Y: exact.map(|exact| exact[1]),
            z: z(1),
            z_of_xyz: [z(0), z(1), z(2)],
        }
    };
    view.states.iter().map(compare).collect()
}

//! The Monte Carlo walk beside the live answer: progress, shrinking errors, agreement.

use std::num::NonZero;
use std::sync::Mutex;
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use papilio_display::result::{StateValues, View};
use papilio_display::{Control, Progress};
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::Serialize;

use super::events::{self, Events, Teller};
use super::live::{Answer, look};
use crate::fault::{Fault, FaultBody};
use crate::reading::{By, Given};
use crate::site::Site;

/// Rounds that come faster than this are not told, all but the first.
const OFTEN: Duration = Duration::from_millis(100);

/// What the walk tells.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum WalkEvent {
    /// As it goes.
    Progress(WalkProgress),
    /// At the end.
    Done(Box<WalkDone>),
    /// Instead of the end.
    Failed(FaultBody),
}

/// How far the walk has come.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct WalkProgress {
    /// Paths traced, all views together.
    paths: u64,
    /// Since it began.
    seconds: f64,
    /// The largest of Y in the current view: standard error over value.
    relative_error: f64,
    /// Views that are done.
    views_done: usize,
    /// All views.
    views: usize,
    /// What is known so far of each view that was looked at, and state.
    states: Vec<WalkState>,
}

/// The end of the walk.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct WalkDone {
    /// Paths traced.
    paths: u64,
    /// It took so long.
    seconds: f64,
    /// Reached.
    relative_error: f64,
    /// Each view and state.
    states: Vec<WalkState>,
    /// What `papilio run --solver monte-carlo` writes into result.json.
    result: Answer,
}

/// A state by the walk, and by the live answer.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "as in result.json")]
pub(super) struct WalkState {
    /// Its name.
    name: String,
    /// Number of the view, from 0.
    view: usize,
    /// By the walk.
    X: f64,
    /// Its standard error.
    X_se: f64,
    /// By the walk.
    Y: f64,
    /// Its standard error.
    Y_se: f64,
    /// By the walk.
    Z: f64,
    /// Its standard error.
    Z_se: f64,
    /// Y of the live answer.
    live_Y: f64,
    /// Distance of the two Y over the errors of both; null where both know it exactly.
    z: Option<f64>,
    /// The same of X, Y and Z.
    z_of_xyz: [Option<f64>; 3],
}

pub(super) async fn walk(site: Site, given: Given) -> Result<Events, Fault> {
    let of = site.clone();
    // What is wrong with the scenario is told before anything begins.
    let (resolved, live) = site
        .quick()
        .work(move |stop| {
            let (_, resolved) = given.resolve(&of, By::Walk)?;
            Ok((resolved, look(&of, &given, stop)?))
        })
        .await?;
    events::start(site.walks(), move |teller| run(resolved, &live, teller)).await
}

fn run(resolved: Resolved, live: &Answer, teller: &Teller) -> WalkEvent {
    let shown = Mutex::new(Shown { at: None, states: Vec::new() });
    let tell = |progress: Progress<'_>| {
        teller.is_late();
        if let Ok(mut shown) = shown.lock() {
            shown.tell(progress, live, teller);
        }
    };
    // One thread is left for whoever moves a slider meanwhile.
    let threads = available_parallelism().map_or(1, NonZero::get).saturating_sub(1).max(1);
    let control = Control { threads: Some(threads), progress: &tell, stop: teller.stop() };
    match papilio_display::run(&resolved.scene, &control) {
        Ok(mut result) => {
            result.warnings.splice(0..0, resolved.warnings.iter().cloned());
            let views = result.views.iter().enumerate();
            let states = views.flat_map(|(number, view)| states(number, view, live)).collect();
            WalkEvent::Done(Box::new(WalkDone {
                paths: result.solver.paths.unwrap_or(0),
                seconds: teller.seconds(),
                relative_error: result.solver.relative_error_reached,
                states,
                result: Answer { resolved, result },
            }))
        }
        Err(error) => WalkEvent::Failed(Fault::of(&resolved, error).body),
    }
}

/// What was told last.
struct Shown {
    at: Option<Instant>,
    states: Vec<WalkState>,
}

impl Shown {
    fn tell(&mut self, progress: Progress<'_>, live: &Answer, teller: &Teller) {
        let (done, views) = progress.views_done;
        let is_new = self.at.is_none_or(|at| at.elapsed() >= OFTEN);
        let Some(so_far) = progress.so_far.filter(|_| is_new) else { return };
        let (number, view) = so_far();
        self.at = Some(Instant::now());
        self.states.retain(|state| state.view != number);
        self.states.extend(states(number, &view, live));
        teller.tell(&WalkEvent::Progress(WalkProgress {
            paths: progress.paths.unwrap_or(0),
            seconds: teller.seconds(),
            relative_error: progress.relative_error,
            views_done: done,
            views,
            states: self.states.clone(),
        }));
    }
}

/// The states of a view, beside those of the live answer.
fn states(number: usize, view: &View, live: &Answer) -> Vec<WalkState> {
    let Some(beside) = live.result.views.get(number) else { return Vec::new() };
    let one = |(name, walk): (&str, &papilio_display::result::State)| {
        let live = beside.states.get(name)?;
        let xyz = |values: &StateValues| [values.X, values.Y, values.Z];
        let (value, se) = (xyz(&walk.value), xyz(&walk.standard_error));
        let (exact, de) = (xyz(&live.value), live.discretisation_error.as_ref().map_or([0.0; 3], xyz));
        let z = |k: usize| {
            let error = se[k].hypot(de[k]);
            (error > 0.0).then(|| (value[k] - exact[k]) / error)
        };
        Some(WalkState {
            name: name.to_owned(),
            view: number,
            X: value[0],
            X_se: se[0],
            Y: value[1],
            Y_se: se[1],
            Z: value[2],
            Z_se: se[2],
            live_Y: exact[1],
            z: z(1),
            z_of_xyz: [z(0), z(1), z(2)],
        })
    };
    view.states.iter().filter_map(one).collect()
}

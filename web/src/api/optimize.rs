//! The endpoint `/optimize`: a search for better designs, as by `papilio optimize`, as a stream of events.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use papilio_design::output::{SearchReport, design_texts, quantities, search_figures, search_table};
use papilio_design::search::{Record, Search, SearchProgress, SearchRecords, SearchSchedule};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_scenario::{Optimisation, Resolved};
use schemars::JsonSchema;
use serde::Serialize;

use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use super::fit::{fault_of, threads};
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver, check_work};
use crate::site::Site;

/// Time between two reports of the number of designs.
const BEAT: Duration = Duration::from_millis(250);

/// An event of a search.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum OptimizeEvent {
    /// What is done so far.
    Progress(OptimizeProgress),
    /// The best design of one of its searches.
    Found(FoundDesign),
    /// The search is complete.
    Done(Box<OptimizeDone>),
    /// The search has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a search.
#[derive(Debug, Clone, Default, Serialize, JsonSchema)]
pub(super) struct OptimizeProgress {
    /// Fraction of the work that is done, 0 to 1.
    fraction: f64,
    /// Searches that are finished, and those that are known.
    searches: [usize; 2],
    /// Number of evaluated designs.
    designs: usize,
}

/// The best design of one search, which may not be in the result.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct FoundDesign {
    /// Its metrics; null where undefined.
    quantities: BTreeMap<String, Option<f64>>,
    /// Largest relative violation of the constraints; 0 for a feasible design.
    missed: f64,
}

/// The result of a search.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct OptimizeDone {
    /// What `papilio optimize --json` prints, without the check by the Monte Carlo solver.
    report: SearchReport,
    /// The scenarios of the designs, in the order of the report: best.toml, closest.toml or front-01.toml.
    scenarios: Vec<DesignFile>,
    /// The text of optimize.csv.
    csv: String,
    /// The progress of the searches, and the Pareto front.
    figures: Vec<Figure>,
    /// Notes on the scenario and on searches that were cut short.
    notes: Vec<String>,
}

/// The scenario of a design.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct DesignFile {
    /// Name of the file.
    name: String,
    /// Its text (TOML).
    text: String,
}

pub(super) async fn optimize(site: Site, given: Given) -> Result<Events, Fault> {
    let server = site.clone();
    // Errors of the scenario are reported before the stream starts.
    let read = site.quick().work(move |_| Reading::new(&server, given)).await?;
    events::start(site.streamed(), move |events| {
        computed(read, events).map_or_else(
            |fault| OptimizeEvent::Failed(fault.body),
            |done| OptimizeEvent::Done(Box::new(done)),
        )
    })
    .await
}

/// A search as it was read.
struct Reading {
    scenario: String,
    spec: Optimisation,
    resolved: Resolved,
}

impl Reading {
    fn new(site: &Site, given: Given) -> Result<Self, Fault> {
        let library = given.library(site)?;
        let set = given.overrides(&library, Solver::Adding)?;
        let spec = Optimisation::from_text(&given.scenario, "scenario", library, &set)?;
        let (_, resolved) = given.resolve(site, Solver::Adding)?;
        check_work(&resolved, Solver::Adding)?;
        Ok(Self { scenario: given.scenario, spec, resolved })
    }
}

fn computed(read: Reading, events: &EventSender) -> Result<OptimizeDone, Fault> {
    let Reading { scenario, spec, resolved } = read;
    let fault = |error| fault_of(&resolved, events, error);
    let title = spec.title.clone().unwrap_or_default();
    let mut notes = spec.notes.clone();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&spec)), events.stop());
    let search = Arc::new(Search::new(spec, &mut evaluator).map_err(fault)?);
    let mut schedule = SearchSchedule::new(Arc::clone(&search), SearchRecords::default(), threads());
    run(&mut schedule, &search, &evaluator, events).map_err(fault)?;
    let results = schedule.results();
    let chosen = search.selected(&results, &mut evaluator).map_err(fault)?;
    let (stopped, descents) = search.cut_short(&results);
    if stopped > 0 {
        notes.push(format!(
            "{stopped} of {descents} gradient searches stopped because their part of optimize.evaluations ({}) was used up; \
             increase it to let them converge",
            search.spec().evaluations
        ));
    }
    let here = Path::new("");
    let texts = design_texts(&scenario, [here, here], &search, &chosen).map_err(fault)?;
    let figures = search_figures(&title, &search, &results, &chosen).into_iter();
    Ok(OptimizeDone {
        report: SearchReport::new(&title, &search, &results, &chosen),
        scenarios: texts.into_iter().map(|(name, text)| DesignFile { name, text }).collect(),
        csv: search_table(&search, &results),
        figures: figures.map(|(name, svg)| Figure { name, svg }).collect(),
        notes,
    })
}

/// Runs a search to its end. Reports the designs that its parts have found, and its progress in between.
fn run(
    schedule: &mut SearchSchedule,
    search: &Search,
    evaluator: &Evaluator<'_>,
    events: &EventSender,
) -> Result<(), DesignError> {
    let (now, is_over) = (Mutex::new(OptimizeProgress::default()), AtomicBool::new(false));
    let counter = evaluator.evaluated();
    let progress = || {
        let mut now = now.lock().unwrap_or_else(PoisonError::into_inner).clone();
        now.designs = counter.load(Ordering::Relaxed);
        events.send(&OptimizeEvent::Progress(now));
    };
    let mut tell = |record: &Record, done: SearchProgress| {
        let next = OptimizeProgress { fraction: done.fraction, searches: [done.done, done.of], designs: 0 };
        *now.lock().unwrap_or_else(PoisonError::into_inner) = next;
        if let Record::Task(found) = record
            && !found.design.is_empty()
        {
            events.send_reliably(&OptimizeEvent::Found(FoundDesign {
                quantities: quantities(search, &found.values),
                missed: search.aims().missed(&found.values),
            }));
        }
        Ok(())
    };
    thread::scope(|scope| {
        let _end = SetOnDrop(&is_over);
        scope.spawn(|| {
            while !is_over.load(Ordering::Relaxed) {
                events.stop_if_late();
                progress();
                thread::sleep(BEAT);
            }
        });
        schedule.run(evaluator, threads(), &mut tell)
    })
}

/// Sets a flag when it is dropped, also in a panic.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

//! The endpoint `/tolerance`: distributions of metrics in production, as by `papilio tolerance`, as a stream of events.

use papilio_design::output::{tolerance_figures, tolerance_tables};
use papilio_design::tolerance::{Production, Report};
use papilio_scenario::{Resolved, Tolerance};
use schemars::JsonSchema;
use serde::Serialize;

use super::detail::Table;
use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use super::fit::{fault_of, threads};
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver};
use crate::site::Site;

/// Most displays of an analysis; the command line computes more.
const MOST_DISPLAYS: usize = 2_000_000;

/// An event of a tolerance analysis.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum ToleranceEvent {
    /// What is done so far.
    Progress(ToleranceProgress),
    /// The analysis is complete.
    Done(Box<ToleranceDone>),
    /// The analysis has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a tolerance analysis.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ToleranceProgress {
    /// Number of rows that are computed.
    done: usize,
    /// Number of rows.
    of: usize,
}

/// The result of a tolerance analysis.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ToleranceDone {
    /// The contents of tolerance.json.
    report: Report,
    /// The tables that the command writes.
    tables: Vec<Table>,
    /// Histograms, sensitivities, and displays that pass or fail.
    figures: Vec<Figure>,
    /// Notes on the scenario.
    notes: Vec<String>,
}

pub(super) async fn tolerance(site: Site, given: Given) -> Result<Events, Fault> {
    let server = site.clone();
    // Errors of the scenario are reported before the stream starts.
    let read = site.quick().work(move |_| Reading::new(&server, &given)).await?;
    events::start(site.streamed(), move |events| {
        computed(&read, events).map_or_else(
            |fault| ToleranceEvent::Failed(fault.body),
            |done| ToleranceEvent::Done(Box::new(done)),
        )
    })
    .await
}

/// A tolerance analysis as it was read.
struct Reading {
    tolerance: Tolerance,
    production: Production,
    resolved: Resolved,
}

impl Reading {
    fn new(site: &Site, given: &Given) -> Result<Self, Fault> {
        let library = given.library(site)?;
        let set = given.overrides(&library, Solver::Adding)?;
        let tolerance = Tolerance::from_text(&given.scenario, "scenario", library, &set)?;
        let production = Production::new(&tolerance);
        let displays = production.displays();
        if displays > MOST_DISPLAYS {
            let message = format!("{displays} displays are too many for the page: at most {MOST_DISPLAYS}");
            return Err(Fault::too_much(
                message,
                "choose fewer tolerance.samples, or use `papilio tolerance`",
            ));
        }
        production.check(&tolerance)?;
        let (_, resolved) = given.resolve(site, Solver::Adding)?;
        Ok(Self { tolerance, production, resolved })
    }
}

fn computed(read: &Reading, events: &EventSender) -> Result<ToleranceDone, Fault> {
    let Reading { tolerance, production, resolved } = read;
    let tell = |done: usize| {
        events.stop_if_late();
        events.send(&ToleranceEvent::Progress(ToleranceProgress { done, of: production.rows() }));
    };
    let rows = production.evaluate_all(threads(), events.stop(), tell);
    let rows = rows.map_err(|error| fault_of(resolved, events, error))?;
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let report = Report::new(tolerance, production, &rows);
    let title = tolerance.title.clone().unwrap_or_default();
    let written = tolerance_tables(tolerance, production, &rows, &report);
    let written = written.map_err(|_| Fault::internal("a table cannot be written"))?;
    let table = |(name, bytes): (&'static str, Vec<u8>)| {
        let csv = String::from_utf8_lossy(&bytes).into_owned();
        name.strip_suffix(".csv").map(|name| Table { name, csv })
    };
    let figures = tolerance_figures(&title, tolerance, production, &rows, &report).into_iter();
    Ok(ToleranceDone {
        tables: written.into_iter().filter_map(table).collect(),
        figures: figures.map(|(name, svg)| Figure { name, svg }).collect(),
        notes: tolerance.notes.clone(),
        report,
    })
}

//! The search that a scenario's `[optimize]` describes: on threads, or as separate work items on any machine.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use papilio_design::output::{moved, search_figures, search_table};
use papilio_design::search::{
    self, Record, SearchProgress, SearchRecords, SearchResult, SearchSchedule, SelectedDesign, WorkItem,
    WorkResult, was_stopped,
};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_formats::{FormatError, LockedJournal, SearchHead, journal_name};
use papilio_scenario::Optimisation;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::errors;
use crate::scenario::library;
use crate::watch::{ProgressState, detached, watched};

exports! { classes Search; functions moved_text; }

/// A search, its progress and its journal. Work items and their results are JSON texts.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Search {
    of: Arc<search::Search>,
    hash: String,
    stop: &'static AtomicBool,
    evaluator: Mutex<Evaluator<'static>>,
    way: Mutex<Option<RunningSearch>>,
}

/// State of a search that has begun.
struct RunningSearch {
    schedule: SearchSchedule,
    journal: Option<LockedJournal>,
}

/// Error that ends a search.
enum Failure {
    Design(DesignError),
    Journal(FormatError),
}

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        Self::Design(error)
    }
}

impl Failure {
    fn raised(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Design(error) if was_stopped(error) => PyKeyboardInterrupt::new_err(()),
            Self::Design(error) => errors::search(py, error),
            Self::Journal(error) => errors::format(py, error),
        }
    }
}

impl RunningSearch {
    /// Writes new results to the journal.
    fn keep(&mut self) -> Result<(), FormatError> {
        let news = self.schedule.take_records();
        self.journal.as_mut().map_or(Ok(()), |journal| news.iter().try_for_each(|record| journal.add(record)))
    }
}

#[pymethods]
impl Search {
    /// Parses the scenario, and evaluates its own design.
    #[new]
    #[pyo3(signature = (text, name, folder, files=None))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
    ) -> PyResult<Self> {
        let optimisation = detached(py, || Optimisation::from_text(text, name, library(folder, files), &[]))?;
        let optimisation = optimisation.map_err(|errors| errors::scenario(py, &errors))?;
        let hash = optimisation.hash.clone();
        // Leaks one byte for each search.
        let stop: &'static AtomicBool = Box::leak(Box::new(AtomicBool::new(false)));
        let made = watched(py, stop, None, |_| {
            let mut evaluator = Evaluator::new(Arc::new(Study::of(&optimisation)), stop);
            search::Search::new(optimisation, &mut evaluator).map(|of| (of, evaluator))
        })?;
        let (of, evaluator) = made.map_err(|error| Failure::Design(error).raised(py))?;
        Ok(Self { of: Arc::new(of), hash, stop, evaluator: Mutex::new(evaluator), way: Mutex::new(None) })
    }

    /// SHA-256 of all inputs of the search.
    #[getter]
    fn hash(&self) -> &str {
        &self.hash
    }

    /// Begins the search, or resumes it from the journal in a folder; generations of populations are split into `cut` work items.
    fn begin(&self, py: Python<'_>, folder: Option<PathBuf>, cut: usize) -> PyResult<()> {
        let mut records = SearchRecords::default();
        let opened = folder.map(|folder| {
            LockedJournal::open(folder.join(journal_name("optimize", None)), &self.head(), |line| {
                Record::parse(line).map(|record| records.add(record)).is_ok()
            })
        });
        let journal = opened.transpose().map_err(|error| errors::format(py, &error))?;
        let mut way =
            RunningSearch { schedule: SearchSchedule::new(Arc::clone(&self.of), records, cut), journal };
        way.keep().map_err(|error| errors::format(py, &error))?;
        *self.way() = Some(way);
        Ok(())
    }

    /// The next work item; `None` while others must be completed first, or if the search is complete.
    fn piece(&self) -> PyResult<Option<String>> {
        let mut way = self.way();
        let piece = begun(&mut way)?.schedule.next_item();
        piece
            .map(|piece| serde_json::to_string(&piece).map_err(|error| errors::internal(&error.to_string())))
            .transpose()
    }

    /// Computes a work item.
    fn work(&self, py: Python<'_>, piece: &str) -> PyResult<String> {
        let piece: WorkItem =
            serde_json::from_str(piece).map_err(|error| errors::internal(&error.to_string()))?;
        let answer = watched(py, self.stop, None, |_| {
            self.stop.store(false, Ordering::Relaxed);
            let mut evaluator = self.evaluator.lock().unwrap_or_else(PoisonError::into_inner);
            self.of.work(&piece, &mut evaluator)
        })?;
        let answer = answer.map_err(|error| Failure::Design(error).raised(py))?;
        serde_json::to_string(&answer).map_err(|error| errors::internal(&error.to_string()))
    }

    /// Accepts the result of a work item, and writes it to the journal.
    fn take(&self, py: Python<'_>, answer: &str) -> PyResult<()> {
        let answer: WorkResult =
            serde_json::from_str(answer).map_err(|error| errors::internal(&error.to_string()))?;
        let mut way = self.way();
        let way = begun(&mut way)?;
        way.schedule.add_result(answer);
        way.keep().map_err(|error| errors::format(py, &error))
    }

    /// Computes all remaining work on threads.
    #[pyo3(signature = (threads, progress=None))]
    fn run(&self, py: Python<'_>, threads: usize, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        let outcome = watched(py, self.stop, progress.as_ref(), |watch| {
            self.stop.store(false, Ordering::Relaxed);
            let evaluator = self.evaluator.lock().unwrap_or_else(PoisonError::into_inner);
            let mut way = self.way();
            let Some(RunningSearch { schedule, journal }) = way.as_mut() else { return Ok(()) };
            let mut on_record = |record: &Record, now: SearchProgress| {
                watch.tell(ProgressState::Done(now.done, now.of));
                journal.as_mut().map_or(Ok(()), |journal| journal.add(record)).map_err(Failure::Journal)
            };
            schedule.run(&evaluator, threads, &mut on_record)
        })?;
        outcome.map_err(|failure| failure.raised(py))
    }

    /// Number of completed tasks, and of all tasks that are known.
    fn progress(&self) -> PyResult<(usize, usize)> {
        let now = begun(&mut self.way())?.schedule.progress();
        Ok((now.done, now.of))
    }

    /// The result as JSON: names of variables and quantities, the scenario's own design and the resulting designs with their values,
    /// figures, and the table of the results of all tasks. Sorts the journal.
    fn result(&self, py: Python<'_>, title: &str) -> PyResult<String> {
        let outcome = watched(py, self.stop, None, |_| {
            let mut evaluator = self.evaluator.lock().unwrap_or_else(PoisonError::into_inner);
            let mut way = self.way();
            let Some(RunningSearch { schedule, journal }) = way.as_mut() else { return Ok(Value::Null) };
            let found = schedule.results();
            let chosen = self.of.selected(&found, &mut evaluator)?;
            if let Some(journal) = journal {
                journal.put(&self.head(), found.iter()).map_err(Failure::Journal)?;
            }
            let mut result = result_json(&self.of, &found, &chosen);
            result["table"] = search_table(&self.of, &found).into();
            result["figures"] = json!(search_figures(title, &self.of, &found, &chosen));
            Ok(result)
        })?;
        outcome.map(|found| found.to_string()).map_err(|failure: Failure| failure.raised(py))
    }

    /// Closes the journal.
    fn close(&self) {
        *self.way() = None;
    }
}

impl Search {
    fn way(&self) -> MutexGuard<'_, Option<RunningSearch>> {
        self.way.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn head(&self) -> SearchHead {
        SearchHead { papilio: env!("CARGO_PKG_VERSION").to_owned(), search: self.hash.clone() }
    }
}

/// Text of a scenario that moves from one folder to another, with adapted relative paths of files.
#[pyfunction]
pub(crate) fn moved_text(text: &str, here: PathBuf, there: PathBuf) -> String {
    moved(text, &here, &there)
}

fn begun(way: &mut Option<RunningSearch>) -> PyResult<&mut RunningSearch> {
    way.as_mut().ok_or_else(|| errors::internal("the search has not begun"))
}

fn result_json(search: &search::Search, found: &[SearchResult], chosen: &[SelectedDesign]) -> Value {
    let study = search.study();
    // The value of every key: choices by their values, including keys that others replace.
    let set = |design: &[f64]| -> Value {
        let settings = study.settings(design).unwrap_or_default().into_iter();
        Value::Object(settings.map(|(path, value)| (path.to_owned(), value)).collect())
    };
    let one = |chosen: &SelectedDesign| {
        json!({
            "design": chosen.design, "set": set(&chosen.design), "values": chosen.values,
            "meets_limits": chosen.meets_limits(),
        })
    };
    let (own, own_values) = search.own();
    json!({
        "variables": study.variables.iter().map(|one| &one.name).collect::<Vec<_>>(),
        "quantities": study.quantities.iter().map(|one| &one.name).collect::<Vec<_>>(),
        "own": { "design": own, "set": set(own), "values": own_values },
        "chosen": chosen.iter().map(one).collect::<Vec<_>>(),
        "evaluations": found.iter().map(|one| one.evaluations).sum::<usize>(),
    })
}

//! Evaluators on several threads, reused from call to call.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use papilio_design::{DesignError, Evaluator, Study};
use papilio_display::DisplayError;
use papilio_scenario::{Interface, MistakeKind};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::errors;
use crate::watch::{ProgressState, Watch, watched};

/// Items that a thread takes at a time.
const BLOCK: usize = 8;

/// The evaluators of a study. Each concurrent call has its own crew, so that the end of one call does not end another.
pub(crate) struct Pool {
    study: Arc<Study>,
    idle: Mutex<Vec<Crew>>,
}

/// Evaluators of one call, one for each thread.
struct Crew {
    stop: &'static AtomicBool,
    evaluators: Vec<Evaluator<'static>>,
}

impl Crew {
    fn new(study: Arc<Study>) -> Self {
        // Leaks one byte for each study, and for each concurrent evaluation of the same study.
        let stop = Box::leak(Box::new(AtomicBool::new(false)));
        Self { stop, evaluators: vec![Evaluator::new(study, stop)] }
    }

    /// Returns evaluators for a number of threads; creates missing ones.
    fn of(&mut self, threads: usize) -> &mut [Evaluator<'static>] {
        while let (true, Some(first)) = (self.evaluators.len() < threads, self.evaluators.first()) {
            self.evaluators.push(first.worker());
        }
        let threads = threads.min(self.evaluators.len());
        &mut self.evaluators[..threads]
    }
}

impl Pool {
    pub(crate) fn new(study: Arc<Study>) -> Self {
        Self { study, idle: Mutex::new(Vec::new()) }
    }

    /// Applies `of` to every index below `count`; the results are in order.
    ///
    /// # Errors
    /// `DesignError` with the smallest index that fails, independent of the number of threads.
    pub(crate) fn each<T: Send>(
        &self,
        py: Python<'_>,
        count: usize,
        threads: usize,
        progress: Option<&Bound<'_, PyAny>>,
        of: impl Fn(&mut Evaluator<'static>, usize) -> Result<T, DesignError> + Sync,
    ) -> PyResult<Vec<T>> {
        let mut crew = self.idle().pop().unwrap_or_else(|| Crew::new(Arc::clone(&self.study)));
        let stop = crew.stop;
        stop.store(false, Ordering::Relaxed);
        let done = Mutex::new(None);
        let outcome = watched(py, stop, progress, |watch| {
            let outcome = each(crew.of(threads.clamp(1, count.max(1))), count, watch, &of);
            *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(crew);
            outcome
        });
        // Returned only when its flag is no longer set by others. A crew is dropped after a panic.
        self.idle().extend(done.into_inner().unwrap_or_else(PoisonError::into_inner));
        let outcome = outcome?;
        let done = outcome.map_err(|(at, error)| failed(py, at, &error))?;
        // Only a stopped call is incomplete, and this was raised above.
        done.into_iter().collect::<Option<_>>().ok_or_else(|| PyKeyboardInterrupt::new_err(()))
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Crew>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Evaluates every item; if items are invalid, returns the first of them with its error.
fn each<T: Send>(
    evaluators: &mut [Evaluator<'static>],
    count: usize,
    watch: &Watch<'_>,
    of: &(impl Fn(&mut Evaluator<'static>, usize) -> Result<T, DesignError> + Sync),
) -> Result<Vec<Option<T>>, (usize, DesignError)> {
    // Blocks are assigned in order, and all blocks before the first failure are completed, so that the first failure does not depend
    // on the number of threads.
    let [next, finished] = [0, 0].map(AtomicUsize::new);
    let limit = AtomicUsize::new(count);
    let (done, failed) = (Mutex::new((0..count).map(|_| None).collect::<Vec<_>>()), Mutex::new(None));
    let one = |evaluator: &mut Evaluator<'static>| loop {
        let start = next.fetch_add(BLOCK, Ordering::Relaxed);
        if start >= count {
            return;
        }
        for at in start..count.min(start + BLOCK) {
            if at >= limit.load(Ordering::Relaxed) || watch.stop.load(Ordering::Relaxed) {
                return;
            }
            let outcome = of(evaluator, at);
            watch.tell(ProgressState::Done(finished.fetch_add(1, Ordering::Relaxed) + 1, count));
            match outcome {
                Ok(found) => drop(done.lock().map(|mut done| done[at] = Some(found))),
                Err(error) if limit.fetch_min(at, Ordering::Relaxed) > at => {
                    drop(failed.lock().map(|mut failed| keep_first(&mut failed, at, error)));
                }
                Err(_) => {}
            }
        }
    };
    match evaluators {
        [alone] => one(alone),
        several => std::thread::scope(|scope| {
            several.iter_mut().for_each(|evaluator| {
                scope.spawn(|| one(evaluator));
            });
        }),
    }
    let done = done.into_inner().unwrap_or_default();
    failed.into_inner().ok().flatten().map_or(Ok(done), Err)
}

/// Keeps the failure with the smaller index if two threads fail.
fn keep_first(failed: &mut Option<(usize, DesignError)>, at: usize, error: DesignError) {
    if failed.as_ref().is_none_or(|(first, _)| at < *first) {
        *failed = Some((at, error));
    }
}

/// Whether an error concerns a key independent of its value.
pub(crate) fn is_of_a_path(error: &DesignError) -> bool {
    matches!(error, DesignError::Scenario(errors) if errors.iter().any(|one| one.kind == MistakeKind::Path))
}

/// The exception for a failed design.
fn failed(py: Python<'_>, design: usize, error: &DesignError) -> PyErr {
    match error {
        DesignError::Display(DisplayError::Interrupted) => PyKeyboardInterrupt::new_err(()),
        // A key that does not exist is not an error of a design.
        DesignError::Scenario(errors) if is_of_a_path(error) => errors::scenario(py, errors),
        error => errors::design(py, design, &reason(error)),
    }
}

/// Reason of a design's error, one line for each mistake: the key, what is wrong, what was expected.
pub(crate) fn reason(error: &DesignError) -> String {
    let DesignError::Scenario(errors) = error else { return error.to_string() };
    let lines = errors.iter().map(|one| {
        let place = &one.place;
        // The text of a varied value is its key.
        let key = place.spot.as_ref().filter(|_| place.name == "key").map(|spot| spot.text.clone());
        let at = key.or_else(|| one.path.clone()).unwrap_or_else(|| place.to_string());
        let expected = one.diagnostic.expected.iter().map(|expected| format!("; {expected}"));
        let hint = one.help(Interface::Python).map(|hint| format!(" ({hint})"));
        [format!("{at}: {}", one.diagnostic.message)]
            .into_iter()
            .chain(expected)
            .chain(hint)
            .collect::<String>()
    });
    lines.collect::<Vec<_>>().join("\n")
}

//! Computations that release the interpreter and can be interrupted by Ctrl-C.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use papilio_display::{Control, DisplayError, Progress, ProgressFraction};
use papilio_scenario::Resolved;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// Interval between checks for Ctrl-C and reports of progress.
const POLL: Duration = Duration::from_millis(50);

/// Progress of a computation, without borrows.
#[derive(Clone, Copy)]
pub(crate) enum ProgressState {
    /// A run.
    Run {
        /// Never less than in an earlier report.
        fraction: f64,
        paths: Option<u64>,
        relative_error: Option<f64>,
        target: Option<f64>,
        views_done: (usize, usize),
    },
    /// Number of completed designs, rows or tasks, and of all of them.
    Done(usize, usize),
    /// Fraction of the work that is done.
    Fraction(f64),
}

/// Connection of a computation to the thread that watches it.
pub(crate) struct Watch<'a> {
    /// Set to stop the computation.
    pub(crate) stop: &'a AtomicBool,
    last: Mutex<Option<ProgressState>>,
    fraction: ProgressFraction,
}

impl Watch<'_> {
    /// Reports the progress; only the latest report before a check is passed on.
    pub(crate) fn tell(&self, now: ProgressState) {
        if let Ok(mut last) = self.last.lock() {
            *last = Some(now);
        }
    }

    /// Runs `work` on a number of threads.
    pub(crate) fn run<T>(&self, threads: Option<usize>, work: impl FnOnce(&Control<'_>) -> T) -> T {
        let tell = |now: Progress<'_>| {
            let fraction = self.fraction.advance(now.fraction());
            let Progress { paths, relative_error, target, views_done, .. } = now;
            self.tell(ProgressState::Run { fraction, paths, relative_error, target, views_done });
        };
        work(&Control { threads, progress: &tell, stop: self.stop })
    }
}

/// Runs `work` on a separate thread, while this thread checks for Ctrl-C and reports to `progress` (a callable).
///
/// # Errors
/// `KeyboardInterrupt` or the exception of another signal's handler, or the exception of `progress` (both set `stop`, and the
/// function returns when the work ends); an internal error if the work panics.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch<'_>) -> T + Send,
) -> PyResult<T> {
    let watch = Watch { stop, last: Mutex::new(None), fraction: ProgressFraction::default() };
    std::thread::scope(|scope| {
        let (done, mut waiting) = channel();
        scope.spawn(|| {
            // The waiting thread is notified of a panic, too.
            let _ = { done }.send(catch_unwind(AssertUnwindSafe(|| work(&watch))));
        });
        let mut raised = None;
        let outcome = loop {
            let outcome;
            (waiting, outcome) = py.detach(move || wait(waiting));
            let latest = watch.last.lock().ok().and_then(|mut last| last.take());
            let outcome_of_check = py.check_signals().and_then(|()| match (progress, latest) {
                (Some(progress), Some(latest)) if raised.is_none() => call(progress, latest),
                _ => Ok(()),
            });
            if let Err(error) = outcome_of_check {
                raised.get_or_insert(error);
            }
            if raised.is_some() {
                stop.store(true, Ordering::Relaxed);
            }
            if let Some(outcome) = outcome {
                break outcome;
            }
        };
        match (raised, outcome) {
            (Some(raised), _) => Err(raised),
            (None, Ok(Ok(value))) => Ok(value),
            (None, _) => Err(errors::internal("the computation panicked")),
        }
    })
}

/// Computes a result of a scenario on a separate thread, with progress and Ctrl-C.
pub(crate) fn computed<T: Send>(
    py: Python<'_>,
    of: &Resolved,
    threads: Option<u16>,
    progress: Option<Bound<'_, PyAny>>,
    compute: impl FnOnce(&Control<'_>) -> Result<T, DisplayError> + Send,
) -> PyResult<T> {
    let found = watched(py, &AtomicBool::new(false), progress.as_ref(), |watch| {
        watch.run(threads.map(usize::from), compute)
    })?;
    found.map_err(|error| errors::display_of(py, of, &error))
}

/// Runs `work` without the interpreter. Constructors pass through here: the guard of the Python package wraps everything else.
///
/// # Errors
/// An internal error if the work panics.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let worked = py.detach(|| catch_unwind(AssertUnwindSafe(work)).ok());
    worked.ok_or_else(|| errors::internal("the computation panicked"))
}

/// Waits one interval for a result; `None` if there is none yet.
fn wait<T: Send>(from: Receiver<T>) -> (Receiver<T>, Option<Result<T, RecvTimeoutError>>) {
    let outcome = match from.recv_timeout(POLL) {
        Err(RecvTimeoutError::Timeout) => None,
        other => Some(other),
    };
    (from, outcome)
}

fn call(progress: &Bound<'_, PyAny>, latest: ProgressState) -> PyResult<()> {
    let now = PyDict::new(progress.py());
    match latest {
        ProgressState::Run { fraction, paths, relative_error, target, views_done } => {
            now.set_item("fraction", fraction)?;
            now.set_item("views_done", views_done.0)?;
            now.set_item("views", views_done.1)?;
            now.set_item("relative_error", relative_error)?;
            now.set_item("target", target)?;
            now.set_item("paths", paths)?;
        }
        ProgressState::Done(done, of) => {
            now.set_item("done", done)?;
            now.set_item("of", of)?;
        }
        ProgressState::Fraction(fraction) => now.set_item("fraction", fraction)?,
    }
    progress.call1((now,)).map(|_| ())
}

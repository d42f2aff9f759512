//! Computations that leave the interpreter free, and heed Ctrl-C.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use papilio_display::{Control, Progress};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;

/// How often Ctrl-C is looked for and progress is told.
const POLL: Duration = Duration::from_millis(50);

/// How far a run has come, without its borrows.
#[derive(Clone, Copy)]
struct Told {
    paths: Option<u64>,
    relative_error: f64,
    target: Option<f64>,
    views_done: (usize, usize),
}

/// Does `work` on a thread of its own while this one looks for Ctrl-C and tells `progress` (a callable).
///
/// # Errors
/// `KeyboardInterrupt` or what another signal's handler raised, what `progress` raised (the work is ended by `stop`),
/// and a fault of the work.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Control<'_>) -> T + Send,
) -> PyResult<T> {
    let (stop, last) = (AtomicBool::new(false), Mutex::new(None));
    let tell = |now: Progress<'_>| {
        let Progress { paths, relative_error, target, views_done, .. } = now;
        if let Ok(mut last) = last.lock() {
            *last = Some(Told { paths, relative_error, target, views_done });
        }
    };
    let control = Control { threads, progress: &tell, stop: &stop };
    std::thread::scope(|scope| {
        let (done, mut waiting) = channel();
        scope.spawn(|| {
            // Whoever waits hears of a panic, too.
            let _ = { done }.send(catch_unwind(AssertUnwindSafe(|| work(&control))));
        });
        let mut raised = None;
        let outcome = loop {
            let outcome;
            (waiting, outcome) = py.detach(move || wait(waiting));
            let told = last.lock().ok().and_then(|mut last| last.take());
            let heard = py.check_signals().and_then(|()| match (progress, told) {
                (Some(progress), Some(told)) if raised.is_none() => call(progress, told),
                _ => Ok(()),
            });
            if let Err(error) = heard {
                stop.store(true, Ordering::Relaxed);
                raised.get_or_insert(error);
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

/// What was received, or nothing yet.
fn wait<T: Send>(from: Receiver<T>) -> (Receiver<T>, Option<Result<T, RecvTimeoutError>>) {
    let outcome = match from.recv_timeout(POLL) {
        Err(RecvTimeoutError::Timeout) => None,
        other => Some(other),
    };
    (from, outcome)
}

fn call(progress: &Bound<'_, PyAny>, told: Told) -> PyResult<()> {
    let now = PyDict::new(progress.py());
    now.set_item("views_done", told.views_done.0)?;
    now.set_item("views", told.views_done.1)?;
    now.set_item("relative_error", told.relative_error)?;
    now.set_item("target", told.target)?;
    now.set_item("paths", told.paths)?;
    progress.call1((now,)).map(|_| ())
}

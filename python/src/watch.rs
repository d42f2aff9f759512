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

/// How far a computation has come, without borrows.
#[derive(Clone, Copy)]
pub(crate) enum Told {
    /// A run.
    Run { paths: Option<u64>, relative_error: f64, target: Option<f64>, views_done: (usize, usize) },
    /// So many of so many designs, rows or tasks.
    Done(usize, usize),
}

/// What a computation is watched by.
pub(crate) struct Watch<'a> {
    /// Set when it is to end.
    pub(crate) stop: &'a AtomicBool,
    last: Mutex<Option<Told>>,
}

impl Watch<'_> {
    /// Tells how far it has come; the last word before the next look counts.
    pub(crate) fn tell(&self, now: Told) {
        if let Ok(mut last) = self.last.lock() {
            *last = Some(now);
        }
    }

    /// Does a run's work on so many threads.
    pub(crate) fn run<T>(&self, threads: Option<usize>, work: impl FnOnce(&Control<'_>) -> T) -> T {
        let tell = |now: Progress<'_>| {
            let Progress { paths, relative_error, target, views_done, .. } = now;
            self.tell(Told::Run { paths, relative_error, target, views_done });
        };
        work(&Control { threads, progress: &tell, stop: self.stop })
    }
}

/// Does `work` on a thread of its own while this one looks for Ctrl-C and tells `progress` (a callable).
///
/// # Errors
/// `KeyboardInterrupt` or what another signal's handler raised, what `progress` raised (either sets `stop`, until
/// the work ends), and a fault of the work.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Watch<'_>) -> T + Send,
) -> PyResult<T> {
    let watch = Watch { stop, last: Mutex::new(None) };
    std::thread::scope(|scope| {
        let (done, mut waiting) = channel();
        scope.spawn(|| {
            // Whoever waits hears of a panic, too.
            let _ = { done }.send(catch_unwind(AssertUnwindSafe(|| work(&watch))));
        });
        let mut raised = None;
        let outcome = loop {
            let outcome;
            (waiting, outcome) = py.detach(move || wait(waiting));
            let told = watch.last.lock().ok().and_then(|mut last| last.take());
            let heard = py.check_signals().and_then(|()| match (progress, told) {
                (Some(progress), Some(told)) if raised.is_none() => call(progress, told),
                _ => Ok(()),
            });
            if let Err(error) = heard {
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
    match told {
        Told::Run { paths, relative_error, target, views_done } => {
            now.set_item("views_done", views_done.0)?;
            now.set_item("views", views_done.1)?;
            now.set_item("relative_error", relative_error)?;
            now.set_item("target", target)?;
            now.set_item("paths", paths)?;
        }
        Told::Done(done, of) => {
            now.set_item("done", done)?;
            now.set_item("of", of)?;
        }
    }
    progress.call1((now,)).map(|_| ())
}

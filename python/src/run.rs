//! Runs, and displays that are kept for more of them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;

use papilio_display::DisplayError;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

use crate::errors;
use crate::result::RunResult;
use crate::scenario::Resolved;
use crate::watch::watched;

/// How often a thread looks whether another has done with the display.
const WAIT: Duration = Duration::from_millis(1);

/// A display that keeps what the next run can use.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Prepared {
    kept: Mutex<papilio_display::Prepared>,
}

#[pymethods]
impl Prepared {
    #[new]
    fn new(py: Python<'_>, like: &Resolved) -> PyResult<Self> {
        let prepared = py.detach(|| papilio_display::Prepared::new(&like.of.scene));
        Ok(Self { kept: Mutex::new(prepared.map_err(|error| errors::display_of(py, &like.of, &error))?) })
    }

    #[pyo3(signature = (scenario, threads=None, progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        scenario: &Resolved,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<RunResult> {
        let of = &scenario.of;
        let outcome = watched(py, &AtomicBool::new(false), progress.as_ref(), |watch| {
            let Some(mut kept) = free(&self.kept, watch.stop)? else {
                return Some(Err(DisplayError::Interrupted));
            };
            Some(watch.run(threads.map(usize::from), |control| kept.run(&of.scene, control)))
        })?;
        match outcome {
            Some(Ok(result)) => Ok(RunResult::new(result, Arc::clone(of))),
            Some(Err(DisplayError::Interrupted)) => Err(PyKeyboardInterrupt::new_err(())),
            Some(Err(error)) => Err(errors::display_of(py, of, &error)),
            None => Err(errors::internal("this display was left half done by an earlier fault")),
        }
    }
}

/// The display, once no other thread computes with it; `Some(None)` if this one is stopped before, `None` after a fault of another.
fn free<'a, T>(kept: &'a Mutex<T>, stop: &AtomicBool) -> Option<Option<MutexGuard<'a, T>>> {
    loop {
        match kept.try_lock() {
            Ok(kept) => return Some(Some(kept)),
            Err(TryLockError::Poisoned(_)) => return None,
            Err(TryLockError::WouldBlock) if stop.load(Ordering::Relaxed) => return Some(None),
            Err(TryLockError::WouldBlock) => std::thread::sleep(WAIT),
        }
    }
}

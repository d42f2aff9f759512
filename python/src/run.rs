//! Runs, and displays that are prepared for several runs.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;

use papilio_display::DisplayError;
use pyo3::prelude::*;

use crate::errors;
use crate::result::RunResult;
use crate::scenario::Resolved;
use crate::watch::{computed, watched};

exports! { classes Prepared; }

/// Interval between attempts to lock a display that another thread uses.
const WAIT: Duration = Duration::from_millis(1);

/// A display that caches computations for later runs.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Prepared {
    display: Mutex<papilio_display::Prepared>,
}

#[pymethods]
impl Prepared {
    #[new]
    fn new(py: Python<'_>, like: &Resolved) -> PyResult<Self> {
        let scene = &like.of.scene;
        let prepared =
            computed(py, &like.of, None, None, |control| papilio_display::Prepared::new(scene, control))?;
        Ok(Self { display: Mutex::new(prepared) })
    }

    #[pyo3(signature = (scenario, threads=None, progress=None, first=false))]
    fn run(
        &self,
        py: Python<'_>,
        scenario: &Resolved,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
        first: bool,
    ) -> PyResult<RunResult> {
        let of = &scenario.of;
        let outcome = watched(py, &AtomicBool::new(false), progress.as_ref(), |watch| {
            let Some(mut display) = free(&self.display, watch.stop)? else {
                return Some(Err(DisplayError::Interrupted));
            };
            let answer =
                if first { papilio_display::Prepared::first } else { papilio_display::Prepared::run };
            Some(watch.run(threads.map(usize::from), |control| answer(&mut display, &of.scene, control)))
        })?;
        match outcome {
            Some(Ok(result)) => Ok(RunResult::new(result, Arc::clone(of))),
            Some(Err(error)) => Err(errors::display_of(py, of, &error)),
            None => {
                Err(errors::internal("an earlier internal error left this display in an incomplete state"))
            }
        }
    }
}

/// Waits for the display until no other thread uses it; `Some(None)` if stopped before, `None` after a panic of another thread.
fn free<'a, T>(display: &'a Mutex<T>, stop: &AtomicBool) -> Option<Option<MutexGuard<'a, T>>> {
    loop {
        match display.try_lock() {
            Ok(guard) => return Some(Some(guard)),
            Err(TryLockError::Poisoned(_)) => return None,
            Err(TryLockError::WouldBlock) if stop.load(Ordering::Relaxed) => return Some(None),
            Err(TryLockError::WouldBlock) => std::thread::sleep(WAIT),
        }
    }
}

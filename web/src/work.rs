//! Computing for a request: on a thread of its own, so many at a time, and no longer than someone waits for it.
//!
//! Whoever asks holds a [`Leash`]: when the browser goes away, the request's future is dropped, the leash with it, and
//! the computation sees its flag at its next step.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::fault::Fault;

/// Requests wait so long for their turn, if nothing else is said.
const PATIENCE: Duration = Duration::from_secs(2);

/// Places for computations of one kind.
#[derive(Debug, Clone)]
pub(crate) struct Gate {
    places: Arc<Semaphore>,
    /// A request waits so long for its turn.
    patience: Duration,
    /// A computation that takes longer is stopped.
    pub(crate) deadline: Duration,
}

impl Gate {
    pub(crate) fn new(places: usize, deadline: Duration) -> Self {
        Self { places: Arc::new(Semaphore::new(places)), patience: PATIENCE, deadline }
    }

    /// With requests that wait longer for their turn.
    pub(crate) fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// Waits for a place.
    pub(crate) async fn enter(&self) -> Result<OwnedSemaphorePermit, Fault> {
        match tokio::time::timeout(self.patience, self.places.clone().acquire_owned()).await {
            Ok(Ok(permit)) => Ok(permit),
            _ => Err(Fault::new(
                StatusCode::SERVICE_UNAVAILABLE,
                "the server is busy with other computations",
                "try again in a second",
            )),
        }
    }

    /// Computes something as soon as there is a place.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        compute: impl FnOnce(&AtomicBool) -> Result<T, Fault> + Send + 'static,
    ) -> Result<T, Fault> {
        let permit = self.enter().await?;
        let leash = Leash::default();
        let stop = leash.flag();
        let task = tokio::task::spawn_blocking(move || {
            // Kept until the thread is really free.
            let _permit = permit;
            if stop.load(Ordering::Relaxed) { Err(gone()) } else { compute(&stop) }
        });
        match tokio::time::timeout(self.deadline, task).await {
            Ok(Ok(done)) => done,
            Ok(Err(_)) => Err(Fault::internal("the computation failed; this is a fault of Papilio's")),
            Err(_) => Err(too_long(self.deadline)),
        }
    }
}

/// Stops a computation when it is dropped.
#[derive(Debug, Default)]
pub(crate) struct Leash(Arc<AtomicBool>);

impl Leash {
    /// Set when the leash is gone.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        self.0.clone()
    }
}

impl Drop for Leash {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The answer to what was stopped because it took too long.
pub(crate) fn too_long(deadline: Duration) -> Fault {
    Fault::too_much(
        format!("this took longer than {} s and was stopped", deadline.as_secs()),
        "ask for fewer views, states or wavelengths or a larger solver.relative_error, or run it with `papilio run`",
    )
}

/// Nobody hears this.
pub(crate) fn gone() -> Fault {
    Fault::internal("nobody waits for this any more")
}

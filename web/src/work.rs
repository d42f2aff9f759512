//! Runs the computations of requests on separate threads, limits their number, and stops them if the client
//! disconnects.
//!
//! The future of a request holds a [`StopOnDrop`]. If the browser disconnects, the future is dropped, which
//! sets the stop flag; the computation checks this flag at its next step.
//!
//! Fast computations have separate places. A computation that takes longer than a second moves to one of the
//! places for slow computations, and is refused if all of these are in use. Thus no client can hold all fast
//! places for longer than a second, whatever it requests.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::JoinError;

use crate::fault::Fault;

/// Default of the time for which a request waits for a place.
const PATIENCE: Duration = Duration::from_secs(2);

/// Places for computations of one kind.
#[derive(Debug, Clone)]
pub(crate) struct Gate {
    places: Arc<Semaphore>,
    /// Time for which a request waits for a place.
    patience: Duration,
    /// Time limit of a computation; it is stopped after it.
    pub(crate) deadline: Duration,
    /// Time after which a computation must move, and the places to which it moves.
    slow: Option<(Duration, Arc<Semaphore>)>,
}

/// The place of a computation, which can be exchanged for another one.
type Place = Arc<Mutex<OwnedSemaphorePermit>>;

impl Gate {
    pub(crate) fn new(places: usize, deadline: Duration) -> Self {
        Self { places: Arc::new(Semaphore::new(places)), patience: PATIENCE, deadline, slow: None }
    }

    /// Adds places for slow computations, to which computations move after the given time.
    pub(crate) fn with_slow(self, after: Duration, places: usize) -> Self {
        Self { slow: Some((after, Arc::new(Semaphore::new(places)))), ..self }
    }

    /// Sets the time for which requests wait for a place.
    pub(crate) fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// Waits for a place, and returns an error if there is none in time.
    pub(crate) async fn enter(&self) -> Result<OwnedSemaphorePermit, Fault> {
        match tokio::time::timeout(self.patience, self.places.clone().acquire_owned()).await {
            Ok(Ok(permit)) => Ok(permit),
            _ => Err(busy("the server is busy with other computations")),
        }
    }

    /// Runs a computation on a separate thread as soon as there is a place.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        compute: impl FnOnce(&AtomicBool) -> Result<T, Fault> + Send + 'static,
    ) -> Result<T, Fault> {
        let place: Place = Arc::new(Mutex::new(self.enter().await?));
        let guard = StopOnDrop::default();
        let (stop, place_of_thread) = (guard.flag(), place.clone());
        let mut task = tokio::task::spawn_blocking(move || {
            // The place is held until the thread has finished.
            let _place = place_of_thread;
            if stop.load(Ordering::Relaxed) { Err(abandoned()) } else { compute(&stop) }
        });
        let mut left = self.deadline;
        if let Some((after, slow)) = &self.slow {
            match tokio::time::timeout(*after, &mut task).await {
                Ok(done) => return finished(done),
                Err(_) => move_to(&place, slow)?,
            }
            left = left.saturating_sub(*after);
        }
        // From here on, only the thread holds the place.
        drop(place);
        match tokio::time::timeout(left, task).await {
            Ok(done) => finished(done),
            Err(_) => Err(too_long(self.deadline)),
        }
    }
}

/// Exchanges a place for one for slow computations; returns an error if all of these are in use.
fn move_to(place: &Place, slow: &Arc<Semaphore>) -> Result<(), Fault> {
    let permit = slow.clone().try_acquire_owned();
    let permit = permit.map_err(|_| busy("the server is busy with other slow computations"))?;
    *place.lock().unwrap_or_else(PoisonError::into_inner) = permit;
    Ok(())
}

/// Returns the result of a thread; a panic becomes an error.
fn finished<T>(done: Result<Result<T, Fault>, JoinError>) -> Result<T, Fault> {
    done.unwrap_or_else(|_| Err(Fault::panicked()))
}

/// Creates the response to a request for which there is no place.
fn busy(message: &str) -> Fault {
    Fault::new(StatusCode::SERVICE_UNAVAILABLE, message, "try again in a second")
}

/// Sets the stop flag of a computation when it is dropped.
#[derive(Debug, Default)]
pub(crate) struct StopOnDrop(Arc<AtomicBool>);

impl StopOnDrop {
    /// Returns the flag.
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        self.0.clone()
    }
}

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Creates the response to a computation that was stopped at its time limit.
pub(crate) fn too_long(deadline: Duration) -> Fault {
    Fault::too_much(
        format!("this took longer than {} s and was stopped", deadline.as_secs()),
        "choose fewer views, states or wavelengths or a larger solver.relative_error, or use `papilio run`",
    )
}

/// Creates the result of a computation whose client has disconnected; it is never sent.
pub(crate) fn abandoned() -> Fault {
    Fault::internal("the client has disconnected")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A computation that runs until it is stopped.
    fn endless(stop: &AtomicBool) -> Result<(), Fault> {
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err(abandoned())
    }

    async fn status(gate: Gate, compute: fn(&AtomicBool) -> Result<(), Fault>) -> u16 {
        gate.work(compute).await.map_or_else(|fault| fault.status.as_u16(), |()| 200)
    }

    /// Two clients with slow computations occupy both places; a third one waits only until they move.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn slow_computation_leaves_its_fast_place() {
        let after = Duration::from_millis(50);
        let gate =
            Gate::new(2, Duration::from_secs(3)).with_patience(Duration::from_secs(1)).with_slow(after, 2);
        let slow: Vec<_> = (0..2).map(|_| tokio::spawn(status(gate.clone(), endless))).collect();
        tokio::time::sleep(after / 5).await;
        assert_eq!(status(gate.clone(), |_| Ok(())).await, 200);
        // The next slow one has no place to move to and is refused, which frees its thread.
        assert_eq!(status(gate.clone(), endless).await, 503);
        for _ in 0..4 {
            assert_eq!(status(gate.clone(), |_| Ok(())).await, 200);
        }
        for one in slow {
            assert_eq!(one.await.unwrap(), 422);
        }
    }

    /// A panic is one error response; the places are free again.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn panic_of_a_computation_is_an_error_and_frees_its_place() {
        fn panics(_: &AtomicBool) -> Result<(), Fault> {
            assert!(std::hint::black_box(false), "a panic of this test");
            Ok(())
        }
        let gate = Gate::new(1, Duration::from_secs(9)).with_slow(Duration::from_secs(1), 1);
        for _ in 0..3 {
            assert_eq!(status(gate.clone(), panics).await, 500);
            assert_eq!(status(gate.clone(), |_| Ok(())).await, 200);
        }
    }

    /// A client that disconnects frees its place immediately, be it for fast or slow computations.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn disconnected_client_frees_its_place() {
        let gate = Gate::new(1, Duration::from_secs(9)).with_slow(Duration::from_millis(20), 1);
        for wait in [5, 100] {
            let first = tokio::spawn(status(gate.clone(), endless));
            tokio::time::sleep(Duration::from_millis(wait)).await;
            first.abort();
            let second = tokio::spawn(status(gate.clone(), endless));
            tokio::time::sleep(Duration::from_millis(100)).await;
            assert!(!second.is_finished());
            second.abort();
        }
        assert_eq!(status(gate, |_| Ok(())).await, 200);
    }
}

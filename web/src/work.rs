//! Computing for a request: on a thread of its own, so many at a time, and no longer than someone waits for it.
//!
//! Whoever asks holds a [`Leash`]: when the browser goes away, the request's future is dropped, the leash with it, and
//! the computation sees its flag at its next step.
//!
//! Quick computations have places of their own, and none is kept long: what takes longer than a second moves to one of
//! the places for slow ones, and is refused if all of those are taken. So nobody can hold all quick places for longer
//! than a second, whatever is asked.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::JoinError;

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
    /// Where computations go on that have held a place for so long.
    slow: Option<(Duration, Arc<Semaphore>)>,
}

/// The place of a computation, which may be exchanged for another.
type Place = Arc<Mutex<OwnedSemaphorePermit>>;

impl Gate {
    pub(crate) fn new(places: usize, deadline: Duration) -> Self {
        Self { places: Arc::new(Semaphore::new(places)), patience: PATIENCE, deadline, slow: None }
    }

    /// With computations that move to one of so many other places after this time.
    pub(crate) fn with_slow(self, after: Duration, places: usize) -> Self {
        Self { slow: Some((after, Arc::new(Semaphore::new(places)))), ..self }
    }

    /// With requests that wait longer for their turn.
    pub(crate) fn with_patience(self, patience: Duration) -> Self {
        Self { patience, ..self }
    }

    /// Waits for a place.
    pub(crate) async fn enter(&self) -> Result<OwnedSemaphorePermit, Fault> {
        match tokio::time::timeout(self.patience, self.places.clone().acquire_owned()).await {
            Ok(Ok(permit)) => Ok(permit),
            _ => Err(busy("the server is busy with other computations")),
        }
    }

    /// Computes something as soon as there is a place.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        compute: impl FnOnce(&AtomicBool) -> Result<T, Fault> + Send + 'static,
    ) -> Result<T, Fault> {
        let place: Place = Arc::new(Mutex::new(self.enter().await?));
        let leash = Leash::default();
        let (stop, of_thread) = (leash.flag(), place.clone());
        let mut task = tokio::task::spawn_blocking(move || {
            // Kept until the thread is really free.
            let _place = of_thread;
            if stop.load(Ordering::Relaxed) { Err(gone()) } else { compute(&stop) }
        });
        let mut left = self.deadline;
        if let Some((after, slow)) = &self.slow {
            match tokio::time::timeout(*after, &mut task).await {
                Ok(done) => return finished(done),
                Err(_) => move_to(&place, slow)?,
            }
            left = left.saturating_sub(*after);
        }
        // What is left of the place is the thread's.
        drop(place);
        match tokio::time::timeout(left, task).await {
            Ok(done) => finished(done),
            Err(_) => Err(too_long(self.deadline)),
        }
    }
}

/// Exchanges a place for a slow one, if there is one.
fn move_to(place: &Place, slow: &Arc<Semaphore>) -> Result<(), Fault> {
    let permit = slow.clone().try_acquire_owned();
    let permit =
        permit.map_err(|_| busy("the server is busy with other computations as slow as this one"))?;
    *place.lock().unwrap_or_else(PoisonError::into_inner) = permit;
    Ok(())
}

/// What a thread made of its work.
fn finished<T>(done: Result<Result<T, Fault>, JoinError>) -> Result<T, Fault> {
    done.unwrap_or_else(|_| Err(Fault::internal("the computation failed; this is a fault of Papilio's")))
}

/// There is no place.
fn busy(message: &str) -> Fault {
    Fault::new(StatusCode::SERVICE_UNAVAILABLE, message, "try again in a second")
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Until it is stopped, as a computation that heeds its flag.
    fn endless(stop: &AtomicBool) -> Result<(), Fault> {
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        Err(gone())
    }

    async fn status(gate: Gate, compute: fn(&AtomicBool) -> Result<(), Fault>) -> u16 {
        gate.work(compute).await.map_or_else(|fault| fault.status.as_u16(), |()| 200)
    }

    /// Two clients that ask for what is slow take both places, and a third one waits no longer than until they move.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn slow_computations_leave_the_quick_places() {
        let after = Duration::from_millis(50);
        let gate =
            Gate::new(2, Duration::from_secs(3)).with_patience(Duration::from_secs(1)).with_slow(after, 2);
        let slow: Vec<_> = (0..2).map(|_| tokio::spawn(status(gate.clone(), endless))).collect();
        tokio::time::sleep(after / 5).await;
        assert_eq!(status(gate.clone(), |_| Ok(())).await, 200);
        // The next slow one finds no place and is refused, and its thread is free again.
        assert_eq!(status(gate.clone(), endless).await, 503);
        for _ in 0..4 {
            assert_eq!(status(gate.clone(), |_| Ok(())).await, 200);
        }
        for one in slow {
            assert_eq!(one.await.unwrap(), 422);
        }
    }

    /// A client that hangs up gives its place back at once, quick or slow.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn who_hangs_up_frees_a_place() {
        let gate = Gate::new(1, Duration::from_secs(9)).with_slow(Duration::from_millis(20), 1);
        for wait in [5, 100] {
            let asked = tokio::spawn(status(gate.clone(), endless));
            tokio::time::sleep(Duration::from_millis(wait)).await;
            asked.abort();
            let again = tokio::spawn(status(gate.clone(), endless));
            tokio::time::sleep(Duration::from_millis(100)).await;
            assert!(!again.is_finished());
            again.abort();
        }
        assert_eq!(status(gate, |_| Ok(())).await, 200);
    }
}

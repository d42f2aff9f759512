//! Computations that report their progress as server-sent events, and stop when the browser disconnects.

use std::convert::Infallible;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde::Serialize;
use serde_json::json;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::{mpsc, oneshot};

use crate::fault::Fault;
use crate::work::{Gate, StopOnDrop};

/// Maximum number of events that wait for a slow client.
const QUEUE_LENGTH: usize = 16;

/// Time after which a computation stops if the client accepts no events.
const PATIENCE: Duration = Duration::from_secs(10);

/// The events of a running computation.
pub(super) struct Events {
    before: mpsc::Receiver<Event>,
    last: Option<oneshot::Receiver<Event>>,
    /// Stops the computation when the response is dropped because the browser has disconnected.
    _guard: StopOnDrop,
}

/// The sender of a computation's events, with its stop flag and its time limit.
pub(super) struct EventSender {
    sender: mpsc::Sender<Event>,
    stop: Arc<AtomicBool>,
    started: Instant,
    deadline: Duration,
}

impl EventSender {
    /// Returns the stop flag, which is set when the client has disconnected or the time limit is reached.
    pub(super) fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Returns the time since the start in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Returns the time limit.
    pub(super) fn deadline(&self) -> Duration {
        self.deadline
    }

    /// Returns true and sets the stop flag if the time limit is exceeded.
    pub(super) fn stop_if_late(&self) -> bool {
        let late = self.started.elapsed() > self.deadline;
        if late {
            self.stop.store(true, Ordering::Relaxed);
        }
        late
    }

    /// Sends an event that the next one will supersede; it is left out if the queue is full.
    pub(super) fn send(&self, event: &impl Serialize) {
        // A full queue and a disconnected client are treated equally: the latter has set the stop flag.
        let _ = self.sender.try_send(as_event(event));
    }

    /// Sends an event that must arrive: waits for a slow client, and stops the computation if it accepts no
    /// events.
    pub(super) fn send_reliably(&self, event: &impl Serialize) {
        let (mut event, waiting) = (as_event(event), Instant::now());
        loop {
            match self.sender.try_send(event) {
                Ok(()) => return,
                Err(TrySendError::Full(back)) if waiting.elapsed() < PATIENCE => {
                    event = back;
                    std::thread::sleep(Duration::from_millis(5));
                }
                Err(_) => return self.stop.store(true, Ordering::Relaxed),
            }
        }
    }
}

/// Starts a computation as soon as there is a place for it; its return value is the last event, or `failed`
/// if it panics.
pub(super) async fn start<E: Serialize + 'static>(
    gate: &Gate,
    compute: impl FnOnce(&EventSender) -> E + Send + 'static,
) -> Result<Events, Fault> {
    let permit = gate.enter().await?;
    let guard = StopOnDrop::default();
    let (sender, before) = mpsc::channel(QUEUE_LENGTH);
    let (finish, last) = oneshot::channel();
    let events = EventSender { sender, stop: guard.flag(), started: Instant::now(), deadline: gate.deadline };
    tokio::task::spawn_blocking(move || {
        let _permit = permit;
        // Nothing of the computation is used after a panic.
        let done = catch_unwind(AssertUnwindSafe(|| as_event(&compute(&events))));
        let event =
            done.unwrap_or_else(|_| as_event(&json!({ "event": "failed", "data": Fault::panicked().body })));
        let _ = finish.send(event);
    });
    Ok(Events { before, last: Some(last), _guard: guard })
}

/// Converts an enum that serialises as `event` and `data`.
fn as_event(event: &impl Serialize) -> Event {
    let json = serde_json::to_value(event).unwrap_or_default();
    let name = json.get("event").and_then(|name| name.as_str()).unwrap_or("message");
    let data = json.get("data").map(ToString::to_string).unwrap_or_default();
    Event::default().event(name).data(data)
}

impl IntoResponse for Events {
    fn into_response(self) -> Response {
        let stream = unfold(self, |mut events| async move {
            let next = match events.before.recv().await {
                Some(event) => Some(event),
                None => match events.last.take() {
                    Some(last) => last.await.ok(),
                    None => None,
                },
            };
            next.map(|event| (Ok::<_, Infallible>(event), events))
        });
        Sse::new(stream).keep_alive(KeepAlive::default()).into_response()
    }
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;

    use super::*;

    /// The stream of a computation that panics ends with an error, as that of one that fails.
    #[tokio::test]
    async fn panic_of_a_computation_is_the_last_event() {
        let gate = Gate::new(1, Duration::from_secs(9));
        for _ in 0..2 {
            let events = start(&gate, |events| {
                events.send(&json!({ "event": "progress", "data": 1 }));
                assert!(std::hint::black_box(false), "a panic of this test");
                json!({ "event": "done", "data": 2 })
            });
            let response = events.await.unwrap().into_response();
            let body = to_bytes(response.into_body(), 10_000).await.unwrap();
            let text = String::from_utf8(body.to_vec()).unwrap();
            assert!(text.contains("event: progress") && text.contains("event: failed"), "{text}");
            assert!(text.contains("this is an error in Papilio"), "{text}");
        }
    }
}

//! Work that reports as it goes: server-sent events, ended at once when the browser goes away.

use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde::Serialize;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::{mpsc, oneshot};

use crate::fault::Fault;
use crate::work::{Gate, Leash};

/// Events that wait for a slow reader.
const WAITING: usize = 16;

/// A reader that takes nothing for so long is given up.
const PATIENCE: Duration = Duration::from_secs(10);

/// Events of running work.
pub(super) struct Events {
    before: mpsc::Receiver<Event>,
    last: Option<oneshot::Receiver<Event>>,
    /// Dropped with the answer, when the browser goes away.
    _leash: Leash,
}

/// How work reports.
pub(super) struct Teller {
    sender: mpsc::Sender<Event>,
    stop: Arc<AtomicBool>,
    started: Instant,
    deadline: Duration,
}

impl Teller {
    /// Set when nobody listens any more, or time is up.
    pub(super) fn stop(&self) -> &AtomicBool {
        &self.stop
    }

    /// Seconds since the work began.
    pub(super) fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// How long the work may take.
    pub(super) fn deadline(&self) -> Duration {
        self.deadline
    }

    /// Stops the work when its time is up; true if it is.
    pub(super) fn is_late(&self) -> bool {
        let late = self.started.elapsed() > self.deadline;
        if late {
            self.stop.store(true, Ordering::Relaxed);
        }
        late
    }

    /// Tells something that the next event would make old: it is left out for a slow reader.
    pub(super) fn tell(&self, event: &impl Serialize) {
        // A full queue and a reader that is gone are alike here: the latter has set the flag.
        let _ = self.sender.try_send(as_event(event));
    }

    /// Tells something that must arrive, and waits for a slow reader; one that takes nothing ends the work.
    pub(super) fn tell_surely(&self, event: &impl Serialize) {
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

/// Starts work as soon as there is a place for it; what it returns is its last event.
pub(super) async fn start<E: Serialize + 'static>(
    gate: &Gate,
    compute: impl FnOnce(&Teller) -> E + Send + 'static,
) -> Result<Events, Fault> {
    let permit = gate.enter().await?;
    let leash = Leash::default();
    let (sender, before) = mpsc::channel(WAITING);
    let (finish, last) = oneshot::channel();
    let teller = Teller { sender, stop: leash.flag(), started: Instant::now(), deadline: gate.deadline };
    tokio::task::spawn_blocking(move || {
        let _permit = permit;
        let event = as_event(&compute(&teller));
        let _ = finish.send(event);
    });
    Ok(Events { before, last: Some(last), _leash: leash })
}

/// An enum that serialises as `event` and `data`.
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

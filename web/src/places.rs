//! Places for connections: limits their number, in total and for each address, and closes those whose clients
//! do not read.
//!
//! A connection is *active* from the header of a request to the end of its response, *blocked* while a
//! response cannot be written because the client does not read, and *late* while the body of its request
//! arrives at less than [`BODY_RATE`]. If all places are in use, a new connection replaces the one that has
//! been idle, blocked or late for the longest time; a connection that is neither is never closed. A
//! connection whose client reads nothing for [`Limits::unread`] is always closed.
//!
//! Bodies are held in memory while they arrive and are processed: 1 MiB of each, and what exceeds it up to
//! [`Limits::body_bytes`] of all connections together ([`BodyMemory`]).
//!
//! Requests that a client sends before earlier responses are complete are not read: hyper reads the next one
//! when the previous response has left its buffer. A connection therefore holds at most one response and 16
//! KiB of requests.

use std::net::IpAddr;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep};

/// Limits of the number of connections, and of the time for which they may be idle or blocked.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Maximum number of open connections.
    pub(crate) total: usize,
    /// Maximum number of open connections from one address.
    pub(crate) per_peer: usize,
    /// Time after which an idle or blocked connection may be replaced by a new one.
    pub(crate) idle: Duration,
    /// Time for which a new connection waits for a place; as many may wait as there are places.
    pub(crate) patience: Duration,
    /// Time after which a connection is closed if its client reads nothing of a response.
    pub(crate) unread: Duration,
    /// Maximum size of the bodies of all requests together, without the first MiB of each, in bytes.
    pub(crate) body_bytes: usize,
}

/// The server's limits. A browser opens at most six connections.
pub(crate) const LIMITS: Limits = Limits {
    total: 256,
    per_peer: 64,
    idle: Duration::from_secs(1),
    patience: Duration::from_secs(3),
    unread: Duration::from_secs(10),
    body_bytes: 192 << 20,
};

/// Rate of a body, in bytes per second, below which its connection is late.
const BODY_RATE: f64 = 256.0 * 1024.0;

/// Time for which a body whose first part arrived faster may stop before it is late.
const BODY_CREDIT: Duration = Duration::from_secs(5);

/// Unit of the memory of bodies, in bytes; the first of each body is always free.
const UNIT: usize = 1 << 20;

/// Interval at which a waiting connection looks for a place.
const RETRY: Duration = Duration::from_millis(20);

/// The open connections.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    taken: Arc<Mutex<Vec<Weak<Connection>>>>,
    /// Limits the number of connections that wait for a place.
    queue: Arc<Semaphore>,
    /// The memory for bodies, in units.
    bodies: Arc<Semaphore>,
    limits: Limits,
}

/// One connection and its state. Its place is free when it is dropped.
#[derive(Debug)]
pub(crate) struct Connection {
    peer: IpAddr,
    state: Mutex<State>,
    end: Notify,
}

#[derive(Debug)]
struct State {
    /// Number of requests in progress.
    requests: usize,
    /// Start of the time without requests.
    idle_since: Instant,
    /// Start of the time for which a response has been waiting for the client.
    blocked_since: Option<Instant>,
    /// Time of the last write.
    last_write: Instant,
    /// The time until which the body of a request would have arrived so far at [`BODY_RATE`].
    body_until: Option<Instant>,
    is_ended: bool,
}

impl Places {
    pub(crate) fn new(limits: Limits) -> Self {
        let [queue, bodies] =
            [limits.total, limits.body_bytes.div_ceil(UNIT)].map(|count| Arc::new(Semaphore::new(count)));
        Self { taken: Arc::default(), queue, bodies, limits }
    }

    /// Returns a place for a connection of this peer as soon as there is one ([`take`](Self::take)). Returns
    /// `None` if there is none within [`Limits::patience`], or if too many connections are waiting.
    pub(crate) async fn wait(&self, peer: IpAddr) -> Option<Arc<Connection>> {
        if let Some(connection) = self.take(peer) {
            return Some(connection);
        }
        let _queued = self.queue.clone().try_acquire_owned().ok()?;
        let since = Instant::now();
        while since.elapsed() < self.limits.patience {
            tokio::time::sleep(RETRY).await;
            if let Some(connection) = self.take(peer) {
                return Some(connection);
            }
        }
        None
    }

    /// Returns a place for a connection of this peer, if necessary that of the connection that has been idle
    /// or blocked for the longest time. Returns `None` if all of them are in use.
    fn take(&self, peer: IpAddr) -> Option<Arc<Connection>> {
        let mut taken = self.taken();
        let open: Vec<Arc<Connection>> = taken.iter().filter_map(Weak::upgrade).collect();
        let open: Vec<Arc<Connection>> = open.into_iter().filter(|one| !one.state().is_ended).collect();
        let own: Vec<&Arc<Connection>> = open.iter().filter(|one| one.peer == peer).collect();
        if own.len() >= self.limits.per_peer {
            self.longest_waiting(own.into_iter())?.close();
        } else if open.len() >= self.limits.total {
            self.longest_waiting(open.iter())?.close();
        }
        let connection = Arc::new(Connection::new(peer));
        taken.retain(|one| one.strong_count() > 0);
        taken.push(Arc::downgrade(&connection));
        Some(connection)
    }

    /// Closes the connections whose clients have stopped reading.
    pub(crate) fn close_unread(&self) {
        let is_unread = |one: &Arc<Connection>| {
            let state = one.state();
            state.blocked_since.is_some() && state.last_write.elapsed() >= self.limits.unread
        };
        let open: Vec<Arc<Connection>> = self.taken().iter().filter_map(Weak::upgrade).collect();
        open.iter().filter(|one| is_unread(one)).for_each(|one| one.close());
    }

    /// Reserves a unit of memory for a body as soon as there is one. Meanwhile, bodies that are late are
    /// given up. Returns `None` if there is none within [`Limits::patience`].
    async fn reserve(&self) -> Option<OwnedSemaphorePermit> {
        let since = Instant::now();
        loop {
            if let Ok(permit) = self.bodies.clone().try_acquire_owned() {
                return Some(permit);
            }
            if since.elapsed() >= self.limits.patience {
                return None;
            }
            let open: Vec<Arc<Connection>> = self.taken().iter().filter_map(Weak::upgrade).collect();
            let arriving = open.iter().filter(|one| one.state().body_until.is_some());
            self.longest_waiting(arriving).inspect(|one| one.close());
            tokio::time::sleep(RETRY).await;
        }
    }

    /// Returns the connection that has been idle, blocked or late for the longest time, if this time exceeds
    /// [`Limits::idle`].
    fn longest_waiting<'a>(
        &self,
        among: impl Iterator<Item = &'a Arc<Connection>>,
    ) -> Option<&'a Arc<Connection>> {
        let since = |one: &Arc<Connection>| one.state().waiting_since();
        let waiting = among.filter_map(|one| since(one).map(|since| (since, one)));
        let (since, one) = waiting.min_by_key(|(since, _)| *since)?;
        (since.elapsed() >= self.limits.idle).then_some(one)
    }

    fn taken(&self) -> MutexGuard<'_, Vec<Weak<Connection>>> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Returns the time since which the connection has been idle, blocked or late; `None` if it is neither.
    fn waiting_since(&self) -> Option<Instant> {
        self.blocked_since.or(self.body_until).or((self.requests == 0).then_some(self.idle_since))
    }
}

impl Connection {
    fn new(peer: IpAddr) -> Self {
        let now = Instant::now();
        let state = State {
            requests: 0,
            idle_since: now,
            blocked_since: None,
            last_write: now,
            body_until: None,
            is_ended: false,
        };
        Self { peer, state: Mutex::new(state), end: Notify::new() }
    }

    /// Waits until the connection must be closed.
    pub(crate) async fn ended(&self) {
        self.end.notified().await;
    }

    /// Marks a request as in progress until the returned guard is dropped.
    pub(crate) fn begin_request(self: &Arc<Self>) -> ActiveRequest {
        self.state().requests += 1;
        ActiveRequest(self.clone())
    }

    fn close(&self) {
        self.state().is_ended = true;
        // The notification is stored if the connection does not wait for it yet.
        self.end.notify_one();
    }

    fn record_write(&self, written: &Poll<std::io::Result<usize>>, wanted: usize) {
        let (mut state, now) = (self.state(), Instant::now());
        match written {
            Poll::Ready(Ok(bytes)) => {
                state.last_write = now;
                if *bytes == wanted {
                    state.blocked_since = None;
                }
            }
            Poll::Pending if state.blocked_since.is_none() => {
                (state.blocked_since, state.last_write) = (Some(now), now);
            }
            _ => {}
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The guard of a request in progress.
#[derive(Debug)]
pub(crate) struct ActiveRequest(Arc<Connection>);

impl Drop for ActiveRequest {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.requests -= 1;
        state.idle_since = Instant::now();
    }
}

/// A connection that receives the body of a request: an extension of the request.
#[derive(Debug, Clone)]
pub(crate) struct Receipt {
    pub(crate) places: Places,
    pub(crate) connection: Arc<Connection>,
}

impl Receipt {
    /// Marks the connection as receiving a body until the returned guard is dropped.
    pub(crate) fn begin_body(&self) -> ArrivingBody {
        self.connection.state().body_until = Some(Instant::now());
        ArrivingBody { receipt: self.clone(), memory: BodyMemory::default(), bytes: 0 }
    }
}

/// A body that arrives.
#[derive(Debug)]
pub(crate) struct ArrivingBody {
    receipt: Receipt,
    memory: BodyMemory,
    bytes: usize,
}

/// The memory of a body; it is free when this is dropped.
#[derive(Debug, Default)]
pub(crate) struct BodyMemory(Option<OwnedSemaphorePermit>);

impl ArrivingBody {
    /// Records that bytes of the body have arrived, and reserves their memory; `None` if there is none in
    /// time.
    pub(crate) async fn record(&mut self, bytes: usize) -> Option<()> {
        self.bytes += bytes;
        while self.bytes > UNIT * (1 + self.memory.0.as_ref().map_or(0, OwnedSemaphorePermit::num_permits)) {
            let more = self.receipt.places.reserve().await?;
            match &mut self.memory.0 {
                Some(memory) => memory.merge(more),
                none => *none = Some(more),
            }
        }
        let time = Duration::from_secs_f64(bytes as f64 / BODY_RATE);
        let latest = Instant::now() + BODY_CREDIT;
        let mut state = self.receipt.connection.state();
        state.body_until = state.body_until.map(|until| (until + time).min(latest));
        Some(())
    }

    /// Returns the memory of the complete body.
    pub(crate) fn complete(mut self) -> BodyMemory {
        std::mem::take(&mut self.memory)
    }
}

impl Drop for ArrivingBody {
    fn drop(&mut self) {
        self.receipt.connection.state().body_until = None;
    }
}

/// A stream that records whether its client reads. It is closed slowly: a response must be read before the
/// connection is reset, which happens as soon as data arrive after the end.
#[derive(Debug)]
pub(crate) struct MonitoredStream {
    stream: TcpStream,
    connection: Arc<Connection>,
    /// The end of the time for which what still arrives is read and discarded; set when the stream is shut
    /// down.
    linger: Option<Pin<Box<Sleep>>>,
}

/// Time limit for reading what a client still sends after the last response.
const LINGER: Duration = Duration::from_secs(10);

impl MonitoredStream {
    pub(crate) fn new(stream: TcpStream, connection: Arc<Connection>) -> Self {
        Self { stream, connection, linger: None }
    }

    /// Reads and discards what still arrives, until the client closes the connection or the time is over.
    fn poll_discard(&mut self, cx: &mut Context<'_>) -> Poll<()> {
        let until = self.linger.get_or_insert_with(|| Box::pin(tokio::time::sleep(LINGER)));
        if until.as_mut().poll(cx).is_ready() {
            return Poll::Ready(());
        }
        let mut space = [0; 16 << 10];
        loop {
            let mut buffer = ReadBuf::new(&mut space);
            match ready!(Pin::new(&mut self.stream).poll_read(cx, &mut buffer)) {
                Ok(()) if !buffer.filled().is_empty() => {}
                _ => return Poll::Ready(()),
            }
        }
    }
}

impl AsyncRead for MonitoredStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buffer)
    }
}

impl AsyncWrite for MonitoredStream {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, bytes);
        self.connection.record_write(&written, bytes.len());
        written
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        parts: &[std::io::IoSlice<'_>],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(cx, parts);
        self.connection.record_write(&written, parts.iter().map(|part| part.len()).sum());
        written
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<std::io::Result<()>> {
        if self.linger.is_none() {
            ready!(Pin::new(&mut self.stream).poll_shutdown(cx))?;
        }
        self.poll_discard(cx).map(Ok)
    }
}

#[cfg(test)]
mod tests;

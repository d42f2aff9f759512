//! Places for connections: so many in all, so many for each peer, and none for a client that does not read.
//!
//! A connection is *answering* from the head of a request to the end of its answer, and *behind* while an answer waits for its
//! reader. When all places are taken, a new connection takes the place of one that has been idle or behind for longest;
//! one that is being answered and reads its answer is never ended. A connection that is behind and takes nothing for
//! [`Limits::unread`] is ended in any case.
//!
//! Requests that a client sends ahead of their answers wait unread: hyper reads the next one when the last answer
//! has left its buffer, so that a connection holds one answer and 16 KiB of requests at the most.

use std::net::IpAddr;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::task::{Context, Poll};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::sync::{Notify, Semaphore};
use tokio::time::Instant;

/// How many connections there may be, and how long they may do nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Limits {
    /// Connections at once.
    pub(crate) all: usize,
    /// Connections of one address at once.
    pub(crate) of_one_peer: usize,
    /// A connection that is idle or behind for so long may lose its place to a new one.
    pub(crate) idle: Duration,
    /// A new connection waits so long for a place, as many at once as there are places.
    pub(crate) patience: Duration,
    /// A connection whose client reads nothing of its answer for so long is ended.
    pub(crate) unread: Duration,
}

/// The server's limits. A browser opens six connections at the most.
pub(crate) const LIMITS: Limits = Limits {
    all: 256,
    of_one_peer: 64,
    idle: Duration::from_secs(1),
    patience: Duration::from_secs(3),
    unread: Duration::from_secs(10),
};

/// How often a waiting connection looks for a place.
const RETRY: Duration = Duration::from_millis(20);

/// The connections that there are.
#[derive(Debug, Clone)]
pub(crate) struct Places {
    taken: Arc<Mutex<Vec<Weak<Connection>>>>,
    /// Connections that wait for a place.
    queue: Arc<Semaphore>,
    limits: Limits,
}

/// One connection: what it does at the moment. Its place is free when it is dropped.
#[derive(Debug)]
pub(crate) struct Connection {
    peer: IpAddr,
    state: Mutex<State>,
    end: Notify,
}

#[derive(Debug)]
struct State {
    /// Requests that are being answered.
    answers: usize,
    /// Since when nothing is asked.
    idle_since: Instant,
    /// Since when an answer waits for its reader.
    behind_since: Option<Instant>,
    /// When something was written last.
    written: Instant,
    is_ended: bool,
}

impl Places {
    pub(crate) fn new(limits: Limits) -> Self {
        Self { taken: Arc::default(), queue: Arc::new(Semaphore::new(limits.all)), limits }
    }

    /// A place for a connection of this peer, as soon as there is one ([`take`](Self::take)); `None` if there is none within
    /// [`Limits::patience`], or too many wait already.
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

    /// A place for a connection of this peer, if need be that of one which has been idle or behind for longest; `None` if
    /// all of them are in use.
    fn take(&self, peer: IpAddr) -> Option<Arc<Connection>> {
        let mut taken = self.taken();
        let there: Vec<Arc<Connection>> = taken.iter().filter_map(Weak::upgrade).collect();
        let there: Vec<Arc<Connection>> = there.into_iter().filter(|one| !one.state().is_ended).collect();
        let own: Vec<&Arc<Connection>> = there.iter().filter(|one| one.peer == peer).collect();
        if own.len() >= self.limits.of_one_peer {
            self.least_busy(own.into_iter())?.finish();
        } else if there.len() >= self.limits.all {
            self.least_busy(there.iter())?.finish();
        }
        let connection = Arc::new(Connection::new(peer));
        taken.retain(|one| one.strong_count() > 0);
        taken.push(Arc::downgrade(&connection));
        Some(connection)
    }

    /// Ends the connections whose clients have stopped to read.
    pub(crate) fn sweep(&self) {
        let stuck = |one: &Arc<Connection>| {
            let state = one.state();
            state.behind_since.is_some() && state.written.elapsed() >= self.limits.unread
        };
        let there: Vec<Arc<Connection>> = self.taken().iter().filter_map(Weak::upgrade).collect();
        there.iter().filter(|one| stuck(one)).for_each(|one| one.finish());
    }

    fn least_busy<'a>(
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
    /// Since when the connection has been idle or behind; `None` if it is neither.
    fn waiting_since(&self) -> Option<Instant> {
        self.behind_since.or((self.answers == 0).then_some(self.idle_since))
    }
}

impl Connection {
    fn new(peer: IpAddr) -> Self {
        let now = Instant::now();
        let state = State { answers: 0, idle_since: now, behind_since: None, written: now, is_ended: false };
        Self { peer, state: Mutex::new(state), end: Notify::new() }
    }

    /// Returns when the connection is to end.
    pub(crate) async fn ended(&self) {
        self.end.notified().await;
    }

    /// Marks a request that is being answered, until the mark is dropped.
    pub(crate) fn answering(self: &Arc<Self>) -> Answering {
        self.state().answers += 1;
        Answering(self.clone())
    }

    fn finish(&self) {
        self.state().is_ended = true;
        // Kept for a connection that does not wait yet.
        self.end.notify_one();
    }

    fn wrote(&self, written: &Poll<std::io::Result<usize>>, wanted: usize) {
        let (mut state, now) = (self.state(), Instant::now());
        match written {
            Poll::Ready(Ok(bytes)) => {
                state.written = now;
                if *bytes == wanted {
                    state.behind_since = None;
                }
            }
            Poll::Pending if state.behind_since.is_none() => {
                (state.behind_since, state.written) = (Some(now), now);
            }
            _ => {}
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A request is being answered as long as this is there.
#[derive(Debug)]
pub(crate) struct Answering(Arc<Connection>);

impl Drop for Answering {
    fn drop(&mut self) {
        let mut state = self.0.state();
        state.answers -= 1;
        state.idle_since = Instant::now();
    }
}

/// A stream that notes whether its client reads.
#[derive(Debug)]
pub(crate) struct Watched {
    stream: TcpStream,
    connection: Arc<Connection>,
}

impl Watched {
    pub(crate) fn new(stream: TcpStream, connection: Arc<Connection>) -> Self {
        Self { stream, connection }
    }
}

impl AsyncRead for Watched {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buffer)
    }
}

impl AsyncWrite for Watched {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(cx, bytes);
        self.connection.wrote(&written, bytes.len());
        written
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        parts: &[std::io::IoSlice<'_>],
    ) -> Poll<std::io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(cx, parts);
        self.connection.wrote(&written, parts.iter().map(|part| part.len()).sum());
        written
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<std::io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PEERS: [IpAddr; 2] =
        [IpAddr::V4(std::net::Ipv4Addr::LOCALHOST), IpAddr::V4(std::net::Ipv4Addr::UNSPECIFIED)];

    fn places(all: usize, of_one_peer: usize, idle_ms: u64) -> Places {
        let [idle, unread] = [idle_ms, 50].map(Duration::from_millis);
        Places::new(Limits { all, of_one_peer, idle, patience: idle, unread })
    }

    #[test]
    fn the_longest_idle_connection_makes_room_and_answers_are_protected() {
        let places = places(2, 2, 0);
        let first = places.take(PEERS[0]).unwrap();
        let second = places.take(PEERS[0]).unwrap();
        let answer = first.answering();
        let third = places.take(PEERS[1]).unwrap();
        assert!(!first.state().is_ended && second.state().is_ended && !third.state().is_ended);
        let (_busy, _other) = (third.answering(), &second);
        assert!(places.take(PEERS[1]).is_none());
        drop(answer);
        assert!(places.take(PEERS[1]).is_some() && first.state().is_ended);
    }

    #[test]
    fn a_peer_takes_places_from_itself_alone() {
        let places = places(9, 2, 0);
        let other = places.take(PEERS[1]).unwrap();
        let own: Vec<_> = (0..3).map(|_| places.take(PEERS[0]).unwrap()).collect();
        assert!(own[0].state().is_ended && !own[1].state().is_ended && !other.state().is_ended);
    }

    #[test]
    fn a_fresh_connection_has_time_to_ask() {
        let places = places(1, 1, 60_000);
        let first = places.take(PEERS[0]).unwrap();
        assert!(places.take(PEERS[0]).is_none() && !first.state().is_ended);
        drop(first);
        assert!(places.take(PEERS[0]).is_some());
    }

    #[test]
    fn an_answer_that_nobody_reads_ends_its_connection() {
        let places = places(2, 2, 0);
        let (stuck, slow) = (places.take(PEERS[0]).unwrap(), places.take(PEERS[0]).unwrap());
        let _answers = [stuck.answering(), slow.answering()];
        stuck.wrote(&Poll::Pending, 10);
        slow.wrote(&Poll::Pending, 10);
        std::thread::sleep(Duration::from_millis(60));
        slow.wrote(&Poll::Ready(Ok(5)), 10);
        places.sweep();
        assert!(stuck.state().is_ended && !slow.state().is_ended);
        assert!(slow.state().behind_since.is_some());
        slow.wrote(&Poll::Ready(Ok(5)), 5);
        assert!(slow.state().behind_since.is_none());
    }
}

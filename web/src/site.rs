//! The server as a whole: what it was asked to be, and what it keeps while it runs.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use papilio_formats::DataFile;
use papilio_scenario::Memo;
use tokio::net::TcpListener;

use crate::guard::Guard;
use crate::kept::Kept;
use crate::listen::{self, ServeError};
use crate::store::Store;
use crate::work::Gate;

/// What a server is to be.
#[derive(Debug, Clone)]
pub struct Options {
    /// The address to listen on; another than this machine's own demands a token of everyone.
    pub listen: IpAddr,
    /// The port; 0: any that is free.
    pub port: u16,
    /// What the page opens; `None`: the example "indoor".
    pub start: Option<Start>,
}

/// A scenario that the page opens.
#[derive(Debug, Clone)]
pub struct Start {
    /// Its name.
    pub name: String,
    /// Its text.
    pub scenario: String,
    /// The files that it names, under the names that it gives them.
    pub files: Vec<DataFile>,
}

impl Default for Options {
    /// On this machine alone, at the page's usual port: a browser keeps what was on screen by address and port.
    fn default() -> Self {
        Self { listen: IpAddr::V4(Ipv4Addr::LOCALHOST), port: 7417, start: None }
    }
}

/// The server; clones are the same one.
#[derive(Debug, Clone)]
pub struct Site(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    address: SocketAddr,
    guard: Guard,
    start: Option<Start>,
    store: Store,
    kept: Kept,
    memo: Arc<Memo>,
    quick: Gate,
    files: Gate,
    long: Gate,
    walks: Gate,
}

impl Site {
    /// Takes the port.
    ///
    /// # Errors
    /// If it is taken or not allowed, or there is no randomness for a token.
    pub async fn bind(options: Options) -> Result<(Self, TcpListener), ServeError> {
        let wanted = SocketAddr::new(options.listen, options.port);
        let listener = TcpListener::bind(wanted).await.map_err(|error| ServeError::Port { wanted, error })?;
        let address = listener.local_addr().map_err(|error| ServeError::Port { wanted, error })?;
        let seconds = Duration::from_secs;
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let inner = Inner {
            address,
            guard: Guard::new(address)?,
            start: options.start,
            store: Store::default(),
            kept: Kept::default(),
            memo: Arc::default(),
            quick: Gate::new(processors.max(2), seconds(20)).with_slow(seconds(1), processors.max(2)),
            // Uploads come in crowds, and most of them take milliseconds: they wait rather than being refused.
            files: Gate::new(processors.max(2), seconds(120)).with_patience(seconds(30)),
            long: Gate::new(processors.div_ceil(2), seconds(120)),
            walks: Gate::new(1.max(processors / 4), seconds(1800)),
        };
        Ok((Self(Arc::new(inner)), listener))
    }

    /// Answers until the process ends.
    pub async fn serve(self, listener: TcpListener) {
        listen::serve(self, listener).await;
    }

    /// Where a browser finds the page; with the token behind `#`, which browsers never send.
    pub fn url(&self) -> String {
        self.0.guard.url(self.0.address)
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.0.address
    }

    /// True if a token is demanded.
    pub fn has_token(&self) -> bool {
        self.0.guard.has_token()
    }

    pub(crate) fn guard(&self) -> &Guard {
        &self.0.guard
    }

    pub(crate) fn start(&self) -> Option<&Start> {
        self.0.start.as_ref()
    }

    pub(crate) fn store(&self) -> &Store {
        &self.0.store
    }

    pub(crate) fn kept(&self) -> &Kept {
        &self.0.kept
    }

    pub(crate) fn memo(&self) -> Arc<Memo> {
        self.0.memo.clone()
    }

    /// For what takes milliseconds; what takes longer than a second leaves its place to others.
    pub(crate) fn quick(&self) -> &Gate {
        &self.0.quick
    }

    /// For reading and auditing files.
    pub(crate) fn files(&self) -> &Gate {
        &self.0.files
    }

    /// For what takes seconds.
    pub(crate) fn long(&self) -> &Gate {
        &self.0.long
    }

    /// For what takes as long as someone watches.
    pub(crate) fn walks(&self) -> &Gate {
        &self.0.walks
    }
}

//! The server: its options, and the data that it stores while it runs.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;

use papilio_formats::DataFile;
use papilio_scenario::ResolveCache;
use tokio::net::TcpListener;

use crate::guard::Guard;
use crate::held::HeldPictures;
use crate::jobs::{JobOptions, Jobs};
use crate::listen::{self, ServeError};
use crate::prepared::PreparedDisplays;
use crate::store::Store;
use crate::work::Gate;

/// The options of a server.
#[derive(Debug, Clone)]
pub struct Options {
    /// The address to listen on. With any other address than a loopback address, all requests need a token.
    pub listen: IpAddr,
    /// The port; 0: any free port.
    pub port: u16,
    /// The scenario that the page opens; `None`: the example "indoor".
    pub start: Option<Start>,
    /// How jobs are run; `None`: there are none.
    pub jobs: Option<JobOptions>,
}

/// A scenario that the page opens.
#[derive(Debug, Clone)]
pub struct Start {
    /// Its name.
    pub name: String,
    /// Its text (TOML).
    pub scenario: String,
    /// Its files, under the names that it uses.
    pub files: Vec<DataFile>,
}

impl Default for Options {
    /// Listens to this machine only, on port 7417. The port is fixed because the browser stores designs by
    /// address and port.
    fn default() -> Self {
        Self { listen: IpAddr::V4(Ipv4Addr::LOCALHOST), port: 7417, start: None, jobs: None }
    }
}

/// The server; clones share its data.
#[derive(Debug, Clone)]
pub struct Site(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    address: SocketAddr,
    guard: Guard,
    start: Option<Start>,
    jobs: Option<Arc<Jobs>>,
    store: Store,
    prepared: PreparedDisplays,
    held: HeldPictures,
    memo: Arc<ResolveCache>,
    quick: Gate,
    files: Gate,
    long: Gate,
    streamed: Gate,
}

impl Site {
    /// Binds the port.
    ///
    /// # Errors
    /// If the port is in use or not permitted, or if the system provides no random numbers for a token.
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
            jobs: options.jobs.map(|jobs| Jobs::open(jobs, address.port())),
            store: Store::default(),
            prepared: PreparedDisplays::default(),
            held: HeldPictures::default(),
            memo: Arc::default(),
            quick: Gate::new(processors.max(2), seconds(20)).with_slow(seconds(1), processors.max(2)),
            // Many files are often uploaded together, and most take milliseconds: they wait longer before
            // they are refused.
            files: Gate::new(processors.max(2), seconds(120)).with_patience(seconds(30)),
            long: Gate::new(processors.div_ceil(2), seconds(120)),
            streamed: Gate::new(1.max(processors / 4), seconds(1800)),
        };
        Ok((Self(Arc::new(inner)), listener))
    }

    /// Serves requests until the process ends.
    pub async fn serve(self, listener: TcpListener) {
        listen::serve(self, listener).await;
    }

    /// Returns the address of the page for a browser, with the token after `#`, which browsers do not send.
    pub fn url(&self) -> String {
        self.0.guard.url(self.0.address)
    }

    /// Returns the address and port on which the server listens.
    pub fn address(&self) -> SocketAddr {
        self.0.address
    }

    /// Returns true if requests need a token.
    pub fn has_token(&self) -> bool {
        self.0.guard.has_token()
    }

    pub(crate) fn guard(&self) -> &Guard {
        &self.0.guard
    }

    pub(crate) fn start(&self) -> Option<&Start> {
        self.0.start.as_ref()
    }

    pub(crate) fn jobs(&self) -> Option<&Jobs> {
        self.0.jobs.as_deref()
    }

    pub(crate) fn store(&self) -> &Store {
        &self.0.store
    }

    pub(crate) fn prepared(&self) -> &PreparedDisplays {
        &self.0.prepared
    }

    pub(crate) fn held(&self) -> &HeldPictures {
        &self.0.held
    }

    pub(crate) fn memo(&self) -> Arc<ResolveCache> {
        self.0.memo.clone()
    }

    /// Places for computations that take milliseconds; those that take longer than a second move to other
    /// places.
    pub(crate) fn quick(&self) -> &Gate {
        &self.0.quick
    }

    /// Places for reading and auditing files.
    pub(crate) fn files(&self) -> &Gate {
        &self.0.files
    }

    /// Places for computations that take seconds.
    pub(crate) fn long(&self) -> &Gate {
        &self.0.long
    }

    /// Places for computations that report their progress: Monte Carlo runs and sweeps.
    pub(crate) fn streamed(&self) -> &Gate {
        &self.0.streamed
    }
}

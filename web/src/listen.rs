//! Connections: so many at once, and none that dawdles over its header.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use crate::api;
use crate::site::Site;

/// Connections at once; more wait in the system's queue.
const MOST_CONNECTIONS: usize = 256;

/// A header that takes longer to arrive ends its connection.
const HEADER_TIME: Duration = Duration::from_secs(10);

/// The longest header, in bytes; hyper's least.
const LONGEST_HEADER: usize = 16 << 10;

/// Why the server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port is not to be had.
    #[error(
        "{wanted} cannot be listened on: {error}\n  = help: choose another port with --port, or 0 for any"
    )]
    Port {
        /// The address and port.
        wanted: SocketAddr,
        /// The system's reason.
        error: io::Error,
    },
    /// The system gives no randomness for a token.
    #[error("there is no randomness for a token: {0}")]
    Token(getrandom::Error),
}

/// Answers on every connection until the process ends.
pub(crate) async fn serve(site: Site, listener: TcpListener) {
    let routes = api::routes(site);
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok(place) = places.clone().acquire_owned().await else { return };
        let Ok((stream, _)) = listener.accept().await else {
            // Out of descriptors, or a connection that is gone already.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        // Answers are small and wanted at once.
        let _ = stream.set_nodelay(true);
        let service = TowerToHyperService::new(routes.clone());
        tokio::spawn(async move {
            let connection = http1::Builder::new()
                .timer(TokioTimer::new())
                .header_read_timeout(HEADER_TIME)
                .max_buf_size(LONGEST_HEADER)
                .serve_connection(TokioIo::new(stream), service);
            // A broken connection is its client's affair.
            let _ = connection.await;
            drop(place);
        });
    }
}

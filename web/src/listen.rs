//! Connections: accepted, given a place, answered, and ended when their clients do not ask or do not read.

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::Request;
use axum::response::Response;
use http_body_util::BodyExt;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::{TcpListener, TcpStream};
use tower::ServiceExt;

use crate::api;
use crate::places::{Connection, LIMITS, Places, Watched};
use crate::site::Site;

/// How often connections whose clients do not read are looked for.
const SWEEP: Duration = Duration::from_secs(1);

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
    let places = Places::new(LIMITS);
    let swept = places.clone();
    tokio::spawn(async move {
        loop {
            tokio::time::sleep(SWEEP).await;
            swept.sweep();
        }
    });
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            // Out of descriptors, or a connection that is gone already.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let (places, routes) = (places.clone(), routes.clone());
        tokio::spawn(async move {
            // Without a place the stream is closed: its client may try again.
            if let Some(connection) = places.wait(peer.ip()).await {
                answer(stream, connection, routes).await;
            }
        });
    }
}

/// Answers what is asked on a connection, until its client or its place ends it.
async fn answer(stream: TcpStream, connection: Arc<Connection>, routes: Router) {
    // Answers are small and wanted at once.
    let _ = stream.set_nodelay(true);
    let service = service_fn(|request: Request<Incoming>| respond(request, &connection, &routes));
    let stream = Watched::new(stream, connection.clone());
    let answered = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEADER_TIME)
        .max_buf_size(LONGEST_HEADER)
        .serve_connection(TokioIo::new(stream), service);
    tokio::select! {
        // A broken connection is its client's affair.
        _ = answered => {}
        () = connection.ended() => {}
    }
}

/// The answer to one request; its connection counts as answering until the answer's body is written.
fn respond(
    request: Request<Incoming>,
    connection: &Arc<Connection>,
    routes: &Router,
) -> impl Future<Output = Result<Response, Infallible>> + use<> {
    let (answering, routes) = (connection.answering(), routes.clone());
    async move {
        let response = routes.oneshot(request.map(Body::new)).await?;
        Ok(response.map(|body| {
            Body::new(body.map_frame(move |frame| {
                let _until_the_end = &answering;
                frame
            }))
        }))
    }
}

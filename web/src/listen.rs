//! Accepts connections, serves their requests, and closes those whose clients are idle or do not read.

use std::convert::Infallible;
use std::io;
use std::net::SocketAddr;
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
use crate::places::{LIMITS, MonitoredStream, Places, Receipt};
use crate::site::Site;

/// Interval between the searches for connections whose clients do not read.
const SEARCH_INTERVAL: Duration = Duration::from_secs(1);

/// Time limit for a request header; the connection is closed after it.
const HEADER_TIME: Duration = Duration::from_secs(10);

/// Maximum length of a header in bytes; the smallest value that hyper accepts.
const LONGEST_HEADER: usize = 16 << 10;

/// The reason why the server cannot start.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The port cannot be bound.
    #[error(
        "cannot listen on {wanted}: {error}\n  = help: choose another port with --port; 0 selects any free port"
    )]
    Port {
        /// The address and port.
        wanted: SocketAddr,
        /// The error of the operating system.
        error: io::Error,
    },
    /// The operating system provides no random numbers for a token.
    #[error("the operating system provides no random numbers for a token: {0}")]
    Token(getrandom::Error),
}

/// Serves all connections until the process ends.
pub(crate) async fn serve(site: Site, listener: TcpListener) {
    let routes = api::routes(site);
    let places = Places::new(LIMITS);
    let open = places.clone();
    tokio::spawn(async move {
        loop {
            tokio::time::sleep(SEARCH_INTERVAL).await;
            open.close_unread();
        }
    });
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            // No file descriptors are left, or the connection was closed before it was accepted.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let (places, routes) = (places.clone(), routes.clone());
        tokio::spawn(async move {
            // Without a place the stream is closed; the client may try again.
            if let Some(connection) = places.wait(peer.ip()).await {
                serve_connection(stream, Receipt { places, connection }, routes).await;
            }
        });
    }
}

/// Serves the requests of a connection until its client closes it or its place is taken away.
async fn serve_connection(stream: TcpStream, receipt: Receipt, routes: Router) {
    // Responses are small, and must be sent without delay.
    let _ = stream.set_nodelay(true);
    let connection = receipt.connection.clone();
    let service = service_fn(|request: Request<Incoming>| respond(request, &receipt, &routes));
    let stream = MonitoredStream::new(stream, connection.clone());
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEADER_TIME)
        .max_buf_size(LONGEST_HEADER)
        .serve_connection(TokioIo::new(stream), service);
    tokio::select! {
        // An error of the connection concerns the client only.
        _ = served => {}
        () = connection.ended() => {}
    }
}

/// Responds to one request. The connection counts as active until the body of the response is written.
fn respond(
    mut request: Request<Incoming>,
    receipt: &Receipt,
    routes: &Router,
) -> impl Future<Output = Result<Response, Infallible>> + use<> {
    let (active, routes) = (receipt.connection.begin_request(), routes.clone());
    request.extensions_mut().insert(receipt.clone());
    async move {
        let response = routes.oneshot(request.map(Body::new)).await?;
        Ok(response.map(|body| {
            Body::new(body.map_frame(move |frame| {
                let _until_the_end = &active;
                frame
            }))
        }))
    }
}

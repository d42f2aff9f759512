//! A panic while a request is handled becomes one error response. Computations have threads of their own, see
//! `work` and `api::events`.

use std::future::{Future, poll_fn};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::task::Poll;

use axum::extract::Request;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use crate::fault::Fault;

/// Handles a request; a panic is the response 500.
pub(crate) async fn caught(request: Request, next: Next) -> Response {
    let mut handled = pin!(next.run(request));
    poll_fn(|context| {
        // The future is not polled again after a panic.
        let polled = catch_unwind(AssertUnwindSafe(|| handled.as_mut().poll(context)));
        polled.unwrap_or_else(|_| Poll::Ready(Fault::panicked().into_response()))
    })
    .await
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::routing::get;
    use axum::{Router, middleware};
    use tower::ServiceExt;

    use super::*;

    #[tokio::test]
    async fn panic_of_a_handler_is_an_error_response_and_others_are_answered() {
        let panics = async || assert!(std::hint::black_box(false), "a panic of this test");
        let router = Router::new().route("/panics", get(panics)).route("/works", get(async || "yes"));
        let router = router.layer(middleware::from_fn(caught));
        for (path, expected) in [("/panics", 500), ("/works", 200), ("/panics", 500)] {
            let request = Request::get(path).body(Body::empty()).unwrap();
            assert_eq!(router.clone().oneshot(request).await.unwrap().status(), expected, "{path}");
        }
    }
}

//! Reads the bodies of requests, with limits of size and time, and refuses those of other content types.

use std::time::Duration;

use axum::body::Body;
use axum::extract::Request;
use axum::http::{StatusCode, header};
use http_body_util::{BodyExt, LengthLimitError, Limited};
use papilio_formats::LARGEST_FILE;
use serde::de::DeserializeOwned;

use crate::fault::Fault;

/// Maximum length of a request in JSON, in bytes.
const LONGEST_JSON: usize = 1 << 20;

/// Time limit for receiving a body in JSON.
const BODY_TIME: Duration = Duration::from_secs(10);

/// Time limit for receiving a file.
const FILE_TIME: Duration = Duration::from_secs(120);

/// Reads a request in JSON, with limits of size, time and depth (128 levels, the limit of serde_json).
pub(super) async fn read_json<Q: DeserializeOwned>(request: Request) -> Result<Q, Fault> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    let is_json =
        kind.and_then(|kind| kind.split(';').next()).is_some_and(|kind| kind.trim() == "application/json");
    if !is_json {
        return Err(Fault::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "the content type of the request must be application/json",
            "",
        ));
    }
    let bytes = body(request.into_body(), LONGEST_JSON, BODY_TIME).await?;
    serde_json::from_slice(&bytes)
        .map_err(|error| Fault::malformed(format!("the request cannot be read: {error}")))
}

/// Reads an uploaded file: its name and its bytes.
pub(super) async fn read_file(request: Request) -> Result<(String, Vec<u8>), Fault> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    if kind != Some("application/octet-stream") {
        let message = "the content type of a file must be application/octet-stream";
        return Err(Fault::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, message, ""));
    }
    let name =
        request.uri().query().and_then(|query| query.split('&').find_map(|pair| pair.strip_prefix("name=")));
    let name = name.and_then(decoded).filter(|name| is_file_name(name));
    let name = name
        .ok_or_else(|| Fault::malformed("a file must have a name of 1 to 200 characters without folders"))?;
    let bytes = body(request.into_body(), LARGEST_FILE as usize, FILE_TIME).await?;
    Ok((name, bytes))
}

/// Returns true for a name of a file without folders. Such names are used only in scenarios, never on the
/// disk.
fn is_file_name(name: &str) -> bool {
    (1..=200).contains(&name.chars().count())
        && !name.contains(['/', '\\'])
        && !name.chars().any(char::is_control)
        && !matches!(name, "." | "..")
}

/// Decodes percent-encoded text: `%41` is a byte, `+` a space.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'%' => {
                let mut digit = || char::from(rest.next()?).to_digit(16);
                (16 * digit()? + digit()?) as u8
            }
            b'+' => b' ',
            other => other,
        });
    }
    String::from_utf8(bytes).ok()
}

/// Receives a body.
async fn body(body: Body, limit: usize, time: Duration) -> Result<Vec<u8>, Fault> {
    match tokio::time::timeout(time, Limited::new(body, limit).collect()).await {
        Ok(Ok(all)) => Ok(all.to_bytes().into()),
        Ok(Err(error)) if error.is::<LengthLimitError>() => {
            let message = format!("the request is longer than {} KiB", limit >> 10);
            Err(Fault::new(StatusCode::PAYLOAD_TOO_LARGE, message, ""))
        }
        Ok(Err(_)) => Err(Fault::malformed("the request is incomplete: the connection was closed")),
        Err(_) => Err(Fault::new(StatusCode::REQUEST_TIMEOUT, "the request took too long to arrive", "")),
    }
}

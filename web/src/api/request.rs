//! Reads the bodies of requests, with limits of size and time, and refuses those of other content types.

use std::time::Duration;

use axum::BoxError;
use axum::extract::Request;
use axum::http::{StatusCode, header};
use http_body_util::{BodyExt, LengthLimitError, Limited};
use papilio_formats::LARGEST_FILE;
use serde::de::DeserializeOwned;

use crate::fault::Fault;
use crate::places::{ArrivingBody, BodyMemory, Receipt};

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
    let received = body(request, LONGEST_JSON, BODY_TIME).await?;
    serde_json::from_slice(&received.bytes)
        .map_err(|error| Fault::malformed(format!("the request cannot be read: {error}")))
}

/// An uploaded file. Its memory is free when this is dropped.
#[derive(Debug)]
pub(super) struct ReadFile {
    pub(super) name: String,
    pub(super) bytes: Vec<u8>,
    pub(super) memory: Option<BodyMemory>,
}

/// Reads an uploaded file.
pub(super) async fn read_file(request: Request) -> Result<ReadFile, Fault> {
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
    let Received { bytes, memory } = body(request, LARGEST_FILE as usize, FILE_TIME).await?;
    Ok(ReadFile { name, bytes, memory })
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

/// The body of a request, and its memory, which is free when this is dropped.
#[derive(Debug)]
struct Received {
    bytes: Vec<u8>,
    memory: Option<BodyMemory>,
}

/// The memory for bodies is in use.
#[derive(Debug, thiserror::Error)]
#[error("no memory")]
struct NoMemory;

/// Receives a body.
async fn body(request: Request, limit: usize, time: Duration) -> Result<Received, Fault> {
    let (parts, body) = request.into_parts();
    let too_long = || {
        let message = format!("the request is longer than {} KiB", limit >> 10);
        Fault::new(StatusCode::PAYLOAD_TOO_LARGE, message, "")
    };
    let stated =
        parts.headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse().ok());
    let length: usize = stated.unwrap_or(limit);
    if length > limit {
        return Err(too_long());
    }
    let mut arriving = parts.extensions.get::<Receipt>().map(Receipt::begin_body);
    let all = async {
        let mut body = Limited::new(body, limit);
        let mut bytes = Vec::with_capacity(length.min(1 << 20));
        while let Some(frame) = body.frame().await.transpose()? {
            let Ok(data) = frame.into_data() else { continue };
            if let Some(arriving) = &mut arriving {
                arriving.record(data.len()).await.ok_or(NoMemory)?;
            }
            bytes.extend_from_slice(&data);
        }
        Ok(bytes)
    };
    match tokio::time::timeout(time, all).await {
        Ok(Ok(bytes)) => Ok(Received { bytes, memory: arriving.map(ArrivingBody::complete) }),
        Ok(Err(error)) if error.is::<NoMemory>() => {
            let message = "the server is busy with the data of other requests";
            Err(Fault::new(StatusCode::SERVICE_UNAVAILABLE, message, "try again in a second"))
        }
        Ok(Err::<_, BoxError>(error)) if error.is::<LengthLimitError>() => Err(too_long()),
        Ok(Err(_)) => Err(Fault::malformed("the request is incomplete: the connection was closed")),
        Err(_) => Err(Fault::new(StatusCode::REQUEST_TIMEOUT, "the request took too long to arrive", "")),
    }
}

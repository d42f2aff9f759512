//! A row for each endpoint: its route and its description come from the same types.

use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use http_body_util::{BodyExt, LengthLimitError, Limited};
use papilio_formats::LARGEST_FILE;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::drawn::Exported;
use super::events::Events;
use crate::fault::{Fault, FaultBody};
use crate::site::Site;

/// Where the API lives.
const ROOT: &str = "/api/v1";

/// The longest request in JSON, in bytes.
const LONGEST_JSON: usize = 1 << 20;

/// A body that takes longer to arrive is given up.
const BODY_TIME: Duration = Duration::from_secs(10);

/// So is a file.
const FILE_TIME: Duration = Duration::from_secs(120);

/// Endpoints as they are gathered.
pub(super) struct Endpoints {
    router: Router<Site>,
    paths: Map<String, Value>,
    schemas: SchemaGenerator,
}

impl Endpoints {
    pub(super) fn new() -> Self {
        let settings = SchemaSettings::draft2020_12().with(|settings| {
            settings.definitions_path = "/components/schemas".into();
            settings.meta_schema = None;
        });
        Self { router: Router::new(), paths: Map::new(), schemas: settings.into_generator() }
    }

    /// An answer that depends on nothing.
    pub(super) fn get<A>(self, path: &str, about: &str, answer: fn(&Site) -> Result<A, Fault>) -> Self
    where
        A: Serialize + JsonSchema + 'static,
    {
        let handler = get(move |State(site): State<Site>| async move { respond(answer(&site)) });
        self.add::<A>(path, about, handler)
    }

    /// An answer that depends on a name in the path.
    pub(super) fn get_named<A>(self, path: &str, about: &str, answer: fn(&str) -> Result<A, Fault>) -> Self
    where
        A: Serialize + JsonSchema + 'static,
    {
        let handler = get(move |Path(name): Path<String>| async move { respond(answer(&name)) });
        self.add::<A>(path, about, handler)
    }

    /// An answer to a question in JSON.
    pub(super) fn post<Q, A, F>(self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        A: Serialize + JsonSchema + 'static,
        F: Future<Output = Result<A, Fault>> + Send + 'static,
    {
        let mut this = self;
        let schema = this.schemas.subschema_for::<A>().to_value();
        let json = json!({ "application/json": { "schema": schema } });
        this.asked(path, about, json, move |site, question| async move {
            Ok(respond(answer(site, question).await))
        })
    }

    /// A file as the answer to a question in JSON.
    pub(super) fn export<Q, F>(self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        F: Future<Output = Result<Exported, Fault>> + Send + 'static,
    {
        let binary = json!({ "*/*": { "schema": { "type": "string", "contentMediaType": "application/octet-stream" } } });
        self.asked(path, about, binary, move |site, question| async move {
            let Exported { kind, bytes } = answer(site, question).await?;
            Ok(([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], bytes).into_response())
        })
    }

    /// Events `E` as the answer to a question in JSON; the description has the type of one of them.
    pub(super) fn events<Q, E, F>(mut self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        E: JsonSchema,
        F: Future<Output = Result<Events, Fault>> + Send + 'static,
    {
        let event = self.schemas.subschema_for::<E>().to_value();
        let stream = json!({ "text/event-stream": { "schema": event } });
        self.asked(path, about, stream, move |site, question| async move {
            Ok(answer(site, question).await?.into_response())
        })
    }

    /// An answer to the bytes of a file; its name is in the query.
    pub(super) fn upload<A, F>(
        mut self,
        path: &str,
        about: &str,
        answer: fn(Site, String, Vec<u8>) -> F,
    ) -> Self
    where
        A: Serialize + JsonSchema + 'static,
        F: Future<Output = Result<A, Fault>> + Send + 'static,
    {
        let handler = post(move |State(site): State<Site>, request: Request| async move {
            respond(match file(request).await {
                Ok((name, bytes)) => answer(site, name, bytes).await,
                Err(fault) => Err(fault),
            })
        });
        let schema = self.schemas.subschema_for::<A>().to_value();
        let bytes = json!({ "application/octet-stream": { "schema": {} } });
        self.describe("post", path, about, Some(bytes), json!({ "application/json": { "schema": schema } }));
        let name =
            json!([{ "name": "name", "in": "query", "required": true, "schema": { "type": "string" } }]);
        self.paths[&format!("{ROOT}{path}")]["post"]["parameters"] = name;
        self.router = self.router.route(&format!("{ROOT}{path}"), handler);
        self
    }

    /// What any answer to a question in JSON has in common.
    fn asked<Q, F>(
        mut self,
        path: &str,
        about: &str,
        content: Value,
        answer: impl Fn(Site, Q) -> F + Clone + Send + Sync + 'static,
    ) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        F: Future<Output = Result<Response, Fault>> + Send + 'static,
    {
        let handler = post(move |State(site): State<Site>, request: Request| async move {
            let answer = match question(request).await {
                Ok(question) => answer(site, question).await,
                Err(fault) => Err(fault),
            };
            answer.unwrap_or_else(Fault::into_response)
        });
        let question = self.schemas.subschema_for::<Q>().to_value();
        let body = json!({ "application/json": { "schema": question } });
        self.describe("post", path, about, Some(body), content);
        self.router = self.router.route(&format!("{ROOT}{path}"), handler);
        self
    }

    fn add<A: JsonSchema>(mut self, path: &str, about: &str, handler: MethodRouter<Site>) -> Self {
        let answer = self.schemas.subschema_for::<A>().to_value();
        let content = json!({ "application/json": { "schema": answer } });
        self.describe("get", path, about, None, content);
        self.router = self.router.route(&format!("{ROOT}{path}"), handler);
        self
    }

    fn describe(&mut self, method: &str, path: &str, about: &str, body: Option<Value>, answer: Value) {
        let fault = self.schemas.subschema_for::<FaultBody>().to_value();
        let mut operation = json!({
            "summary": about,
            "operationId": path.trim_matches('/').replace(['/', '.'], "_").replace(['{', '}'], ""),
            "responses": {
                "200": { "description": "The answer", "content": answer },
                "default": {
                    "description": "What is wrong",
                    "content": { "application/json": { "schema": fault } }
                },
            },
        });
        if let Some(content) = body {
            operation["requestBody"] = json!({ "required": true, "content": content });
        }
        if path.contains("{name}") {
            operation["parameters"] =
                json!([{ "name": "name", "in": "path", "required": true, "schema": { "type": "string" } }]);
        }
        self.paths.insert(format!("{ROOT}{path}"), json!({ method: operation }));
    }

    /// The routes, with that of the description.
    pub(super) fn router(self) -> Router<Site> {
        let router = self.router.clone();
        let description = self.description();
        let unknown =
            || async { Fault::new(StatusCode::NOT_FOUND, "there is no such endpoint", "").into_response() };
        router
            .route(&format!("{ROOT}/openapi.json"), get(move || async move { respond(Ok(description)) }))
            .route("/api/{*rest}", axum::routing::any(unknown))
            .method_not_allowed_fallback(|| async {
                Fault::new(StatusCode::METHOD_NOT_ALLOWED, "this endpoint does not take this method", "")
                    .into_response()
            })
    }

    /// The OpenAPI description.
    pub(super) fn description(mut self) -> Value {
        json!({
            "openapi": "3.1.0",
            "info": {
                "title": "Papilio",
                "summary": "Light transport in reflective displays",
                "version": env!("CARGO_PKG_VERSION"),
            },
            "paths": self.paths,
            "components": { "schemas": self.schemas.take_definitions(true) },
        })
    }
}

/// A question in JSON, bounded in size, time and depth (serde_json's 128 levels).
async fn question<Q: DeserializeOwned>(request: Request) -> Result<Q, Fault> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    let is_json =
        kind.and_then(|kind| kind.split(';').next()).is_some_and(|kind| kind.trim() == "application/json");
    if !is_json {
        return Err(Fault::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "the request must be application/json",
            "",
        ));
    }
    let bytes = body(request.into_body(), LONGEST_JSON, BODY_TIME).await?;
    serde_json::from_slice(&bytes)
        .map_err(|error| Fault::malformed(format!("the request cannot be read: {error}")))
}

/// A file: its name, and its bytes.
async fn file(request: Request) -> Result<(String, Vec<u8>), Fault> {
    let kind = request.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    if kind != Some("application/octet-stream") {
        let message = "a file must be sent as application/octet-stream";
        return Err(Fault::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, message, ""));
    }
    let name =
        request.uri().query().and_then(|query| query.split('&').find_map(|pair| pair.strip_prefix("name=")));
    let name = name.and_then(decoded).filter(|name| is_file_name(name));
    let name =
        name.ok_or_else(|| Fault::malformed("a file needs a name of 1 to 200 letters, without folders"))?;
    let bytes = body(request.into_body(), LARGEST_FILE as usize, FILE_TIME).await?;
    Ok((name, bytes))
}

/// A name that stands in a scenario, never for a place on the disk.
fn is_file_name(name: &str) -> bool {
    (1..=200).contains(&name.chars().count())
        && !name.contains(['/', '\\'])
        && !name.chars().any(char::is_control)
        && !matches!(name, "." | "..")
}

/// Text in which `%41` stands for a byte.
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

/// A whole body.
pub(super) async fn body(body: Body, limit: usize, time: Duration) -> Result<Vec<u8>, Fault> {
    match tokio::time::timeout(time, Limited::new(body, limit).collect()).await {
        Ok(Ok(all)) => Ok(all.to_bytes().into()),
        Ok(Err(error)) if error.is::<LengthLimitError>() => {
            let message = format!("the request is longer than {} KiB", limit >> 10);
            Err(Fault::new(StatusCode::PAYLOAD_TOO_LARGE, message, ""))
        }
        Ok(Err(_)) => Err(Fault::malformed("the request broke off")),
        Err(_) => Err(Fault::new(StatusCode::REQUEST_TIMEOUT, "the request took too long to arrive", "")),
    }
}

fn respond<A: Serialize>(answer: Result<A, Fault>) -> Response {
    let json = answer.and_then(|answer| {
        serde_json::to_vec(&answer).map_err(|_| Fault::internal("the answer cannot be written"))
    });
    match json {
        Ok(json) => {
            let kind = HeaderValue::from_static("application/json");
            ([(header::CONTENT_TYPE, kind)], json).into_response()
        }
        Err(fault) => fault.into_response(),
    }
}

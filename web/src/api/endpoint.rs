//! The table of endpoints: route and description of each are generated from the same types.

use std::sync::{Arc, OnceLock};

use axum::Router;
use axum::body::Bytes;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{MethodRouter, get, post};
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::events::Events;
use super::export::Exported;
use super::request::{ReadFile, read_file, read_json};
use crate::fault::{Fault, FaultBody};
use crate::site::Site;

/// The path of the API.
const ROOT: &str = "/api/v1";

/// A collection of endpoints: their routes and their descriptions.
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

    /// Adds a GET endpoint whose response depends only on the site; it is computed once.
    pub(super) fn get<A>(self, path: &str, about: &str, answer: fn(&Site) -> Result<A, Fault>) -> Self
    where
        A: Serialize + JsonSchema + 'static,
    {
        let cached: Arc<OnceLock<Bytes>> = Arc::default();
        let handler = get(move |State(site): State<Site>| async move {
            let json = match cached.get() {
                Some(json) => Ok(json.clone()),
                None => to_json(answer(&site)).map(|json| cached.get_or_init(|| json).clone()),
            };
            json.map_or_else(Fault::into_response, json_response)
        });
        self.add::<A>(path, about, handler)
    }

    /// Adds a GET endpoint whose response depends on a name in the path.
    pub(super) fn get_named<A>(self, path: &str, about: &str, answer: fn(&str) -> Result<A, Fault>) -> Self
    where
        A: Serialize + JsonSchema + 'static,
    {
        let handler = get(move |Path(name): Path<String>| async move { respond(answer(&name)) });
        self.add::<A>(path, about, handler)
    }

    /// Adds a POST endpoint that responds with JSON to a request in JSON.
    pub(super) fn post<Q, A, F>(self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        A: Serialize + JsonSchema + 'static,
        F: Future<Output = Result<A, Fault>> + Send + 'static,
    {
        let mut this = self;
        let schema = this.schemas.subschema_for::<A>().to_value();
        let json = json!({ "application/json": { "schema": schema } });
        this.post_json(path, about, json, move |site, request| async move {
            Ok(respond(answer(site, request).await))
        })
    }

    /// Adds a POST endpoint that responds with a file to a request in JSON.
    pub(super) fn export<Q, F>(self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        F: Future<Output = Result<Exported, Fault>> + Send + 'static,
    {
        let binary = json!({ "*/*": { "schema": { "type": "string", "contentMediaType": "application/octet-stream" } } });
        self.post_json(path, about, binary, move |site, request| async move {
            let Exported { kind, bytes } = answer(site, request).await?;
            Ok(([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], bytes).into_response())
        })
    }

    /// Adds a POST endpoint that responds with bytes that begin with a head in JSON: its length (32 bits, the lowest byte first), the
    /// head `H`, and data that the head describes.
    pub(super) fn packed<Q, H, F>(mut self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        H: JsonSchema,
        F: Future<Output = Result<Vec<u8>, Fault>> + Send + 'static,
    {
        let head = self.schemas.subschema_for::<H>().to_value();
        let kind = "application/octet-stream";
        let schema = json!({ "type": "string", "contentMediaType": kind, "x-head": head });
        self.post_json(path, about, json!({ kind: { "schema": schema } }), move |site, request| async move {
            let bytes = answer(site, request).await?;
            Ok(([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], bytes).into_response())
        })
    }

    /// Adds a POST endpoint that responds with a stream of events `E` to a request in JSON. The description
    /// has the type of one event.
    pub(super) fn events<Q, E, F>(mut self, path: &str, about: &str, answer: fn(Site, Q) -> F) -> Self
    where
        Q: DeserializeOwned + JsonSchema + Send + 'static,
        E: JsonSchema,
        F: Future<Output = Result<Events, Fault>> + Send + 'static,
    {
        let event = self.schemas.subschema_for::<E>().to_value();
        let stream = json!({ "text/event-stream": { "schema": event } });
        self.post_json(path, about, stream, move |site, request| async move {
            Ok(answer(site, request).await?.into_response())
        })
    }

    /// Adds a POST endpoint that responds with JSON to the bytes of a file, whose name is in the query.
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
            respond(match read_file(request).await {
                Ok(ReadFile { name, bytes, memory }) => {
                    let answer = answer(site, name, bytes).await;
                    drop(memory);
                    answer
                }
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

    /// Adds a POST endpoint for requests in JSON.
    fn post_json<Q, F>(
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
            let response = match read_json(request).await {
                Ok(request) => answer(site, request).await,
                Err(fault) => Err(fault),
            };
            response.unwrap_or_else(Fault::into_response)
        });
        let schema = self.schemas.subschema_for::<Q>().to_value();
        let body = json!({ "application/json": { "schema": schema } });
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
                "200": { "description": "The response", "content": answer },
                "default": {
                    "description": "The errors",
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

    /// Returns the routes, including that of the description.
    pub(super) fn router(self) -> Router<Site> {
        let router = self.router.clone();
        let description = self.description();
        let unknown = || async { Fault::new(StatusCode::NOT_FOUND, "unknown endpoint", "").into_response() };
        router
            .route(&format!("{ROOT}/openapi.json"), get(move || async move { respond(Ok(description)) }))
            .route("/api/{*rest}", axum::routing::any(unknown))
            .method_not_allowed_fallback(|| async {
                Fault::new(StatusCode::METHOD_NOT_ALLOWED, "this endpoint does not support this method", "")
                    .into_response()
            })
    }

    /// Returns the OpenAPI description.
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

fn respond<A: Serialize>(answer: Result<A, Fault>) -> Response {
    to_json(answer).map_or_else(Fault::into_response, json_response)
}

fn to_json<A: Serialize>(answer: Result<A, Fault>) -> Result<Bytes, Fault> {
    let json = serde_json::to_vec(&answer?);
    json.map(Bytes::from).map_err(|_| Fault::internal("the response cannot be serialised"))
}

fn json_response(json: Bytes) -> Response {
    ([(header::CONTENT_TYPE, HeaderValue::from_static("application/json"))], json).into_response()
}

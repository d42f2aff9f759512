//! A row for each endpoint: its route and its description come from the same types.

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
use super::request::{file, question};
use crate::fault::{Fault, FaultBody};
use crate::site::Site;

/// Where the API lives.
const ROOT: &str = "/api/v1";

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

    /// An answer that depends on the site alone, and is made once.
    pub(super) fn get<A>(self, path: &str, about: &str, answer: fn(&Site) -> Result<A, Fault>) -> Self
    where
        A: Serialize + JsonSchema + 'static,
    {
        let made: Arc<OnceLock<Bytes>> = Arc::default();
        let handler = get(move |State(site): State<Site>| async move {
            let json = match made.get() {
                Some(json) => Ok(json.clone()),
                None => written(answer(&site)).map(|json| made.get_or_init(|| json).clone()),
            };
            json.map_or_else(Fault::into_response, as_json)
        });
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

fn respond<A: Serialize>(answer: Result<A, Fault>) -> Response {
    written(answer).map_or_else(Fault::into_response, as_json)
}

fn written<A: Serialize>(answer: Result<A, Fault>) -> Result<Bytes, Fault> {
    let json = serde_json::to_vec(&answer?);
    json.map(Bytes::from).map_err(|_| Fault::internal("the answer cannot be written"))
}

fn as_json(json: Bytes) -> Response {
    ([(header::CONTENT_TYPE, HeaderValue::from_static("application/json"))], json).into_response()
}

//! The endpoints: each a row of [`endpoints`], from which both the router and the OpenAPI description are made.

mod endpoint;
mod live;
mod text;

use axum::Router;
use axum::middleware;
use serde_json::Value;

use self::endpoint::Endpoints;
use crate::site::Site;
use crate::{guard, page};

/// All of them, under `/api/v1`.
fn endpoints() -> Endpoints {
    Endpoints::new()
        .get("/health", "Whether the server is there, and which version", text::health)
        .get("/start", "The scenario that the page opens", text::start)
        .get("/schema", "The JSON Schema of a scenario: keys, units, ranges, defaults, help", text::schema)
        .get("/presets", "Ready-made lighting and viewers", text::presets)
        .get_named("/presets/{name}", "A scenario in a preset's light", text::preset)
        .get("/examples", "The scenarios that ship with the program", text::examples)
        .get_named("/examples/{name}", "A scenario that ships with the program", text::example)
        .post("/edit", "Changes a scenario's text; comments and order stay", text::edit)
        .post("/live", "What the reader sees, by the deterministic solver", live::live)
}

/// The router of the whole site.
pub(crate) fn routes(site: Site) -> Router {
    let guard = middleware::from_fn_with_state(site.clone(), guard::watch);
    endpoints().router().fallback(page::file).layer(guard).with_state(site)
}

/// The OpenAPI 3.1 description of the API, as `GET /api/v1/openapi.json` gives it.
pub fn openapi() -> Value {
    endpoints().description()
}

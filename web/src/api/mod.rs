//! The endpoints: each a row of [`endpoints`], from which both the router and the OpenAPI description are made.

mod drawn;
mod endpoint;
mod events;
mod export;
mod files;
mod live;
mod report;
mod request;
mod sweep;
mod text;
mod walk;

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
        .post("/angles", "Metrics against the viewing angle", drawn::angles)
        .post("/cone", "What is seen from all directions: numbers and conoscopic maps", drawn::cone)
        .post("/figures", "The figures that papilio run draws, as SVG", drawn::figures)
        .export("/export", "A file: result.json, tables, figures, a report on one page", export::export)
        .upload("/files", "Keeps a file and says what is in it; its bytes are the body", files::file)
        .events::<_, walk::WalkEvent, _>("/walk", "The Monte Carlo walk, told as it goes", walk::walk)
        .events::<_, sweep::SweepEvent, _>(
            "/sweep",
            "The points of [sweep], told as they are done",
            sweep::sweep,
        )
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

//! The endpoints. Each is a row of [`endpoints`], from which the router and the OpenAPI description are
//! generated.

mod catalogue;
mod compare;
mod data;
mod detail;
mod drawn;
mod endpoint;
mod events;
mod export;
mod files;
mod fit;
mod gonio;
mod image;
mod jobs;
mod live;
mod optimize;
mod packed;
mod pixel;
mod request;
mod sweep;
mod text;
mod tolerance;
mod validate;
mod walk;
mod written;

use axum::Router;
use axum::middleware;
use serde_json::Value;

use self::endpoint::Endpoints;
use crate::site::Site;
use crate::{guard, page, panics};

/// All endpoints, under `/api/v1`.
fn endpoints() -> Endpoints {
    Endpoints::new()
        .get("/health", "The version of the server, which shows that it runs", text::health)
        .get("/start", "The scenario that the page opens", text::start)
        .get("/schema", "The JSON Schema of a scenario: keys, units, ranges, defaults, help", text::schema)
        .post("/labels", "Labels of metrics and of keys: the quantity in words, and its unit", text::labels)
        .get(
            "/metrics",
            "The metrics of sweeps and searches, and the commands that print them",
            text::metrics,
        )
        .get("/presets", "The presets of lighting and viewer", text::presets)
        .get_named("/presets/{name}", "A new scenario with a preset", text::preset)
        .get("/displays", "The kinds of displays to start from, as of papilio new", text::displays)
        .post("/new", "A new scenario of a display in the light of a preset, with its files", text::new_display)
        .get("/surface-schema", "The JSON Schema of a surface: keys, units, ranges, defaults, help", text::surface_schema)
        .get("/surfaces", "The example surfaces", text::surfaces)
        .get_named("/surfaces/{name}", "An example surface", text::surface)
        .get("/examples", "The example scenarios", text::examples)
        .get_named("/examples/{name}", "An example scenario", text::example)
        .get(
            "/materials",
            "The named materials: substance, source, range, n and k at 550 nm",
            catalogue::materials,
        )
        .get_named("/materials/{name}", "A named material with its n and k", catalogue::material)
        .get("/illuminants", "The CIE illuminants: colour, colour temperature, Ra", catalogue::illuminants)
        .get_named("/illuminants/{name}", "A CIE illuminant with its spectrum", catalogue::illuminant)
        .post(
            "/edit",
            "Applies edits to the text of a scenario; comments and order are preserved",
            text::edit,
        )
        .post("/live", "The result of a scenario, computed by adding", live::live)
        .post("/angles", "Metrics against the viewing angle", drawn::angles)
        .post("/cone", "Metrics over all viewing directions: numbers and conoscopic maps", drawn::cone)
        .post("/figures", "The figures that papilio run draws, as SVG", drawn::figures)
        .post(
            "/compare",
            "A scenario compared with a measured panel: table, figures, differences",
            compare::compare,
        )
        .post("/detail", "Sharpness, crosstalk, sparkle or gloss of a scenario: tables and figures", detail::detail)
        .post("/gonio", "A preview of a surface, measured as by papilio gonio: light, audit, waves, figures", gonio::gonio)
        .events::<_, gonio::GonioEvent, _>("/gonio/full", "A full measurement of a surface, with its progress", gonio::full)
        .post("/gonio/layers", "The surfaces that are layers of a display", gonio::layers)
        .packed::<_, image::PictureHead, _>(
            "/image",
            "A picture on the display, as the reader sees it in each light of the room: a head in JSON, then the states and 16-bit \
             floating point numbers",
            image::image,
        )
        .post(
            "/pixel",
            "The reflectance of the pixel alone from 0 to 90 degrees: tables and figures, as by papilio pixel",
            pixel::pixel,
        )
        .get("/samples", "The samples that others measured, as of papilio validate", validate::samples)
        .export(
            "/image/export",
            "A file of papilio image or papilio palette: states.png, seen.png, image.json, frame.bin, palette.gpl",
            image::export,
        )
        .export(
            "/export",
            "A result as a file: result.json, tables, figures, or a report on one page",
            export::export,
        )
        .upload("/files", "Stores a file, whose bytes are the body, and describes its contents", files::file)
        .get("/jobs/commands", "The commands that run as jobs, with their options", jobs::commands)
        .post("/jobs", "All jobs: where they are, what they have printed and written", jobs::list)
        .post("/jobs/start", "Starts a job, which goes on when the page is closed", jobs::start)
        .post("/jobs/cancel", "Ends a job; its results so far stay", jobs::cancel)
        .post("/jobs/remove", "Removes a job that has ended, with its results", jobs::remove)
        .export("/jobs/file", "A file that a job has written", jobs::file)
        .get("/data", "The data files of the program, by the names that scenarios use", data::list)
        .export("/data/file", "The bytes of a file: an uploaded one or one of the program", data::file)
        .events::<_, walk::WalkEvent, _>(
            "/walk",
            "A run of the Monte Carlo solver, with its progress",
            walk::walk,
        )
        .events::<_, sweep::SweepEvent, _>(
            "/sweep",
            "The points of [sweep], as they are computed",
            sweep::sweep,
        )
        .events::<_, fit::FitEvent, _>(
            "/fit",
            "A fit of keys to measured files, as by papilio fit: progress, then variables with their intervals, figures, the fitted scenario",
            fit::fit,
        )
        .events::<_, optimize::OptimizeEvent, _>(
            "/optimize",
            "A search for better designs, as by papilio optimize: progress and designs, then the best one or the Pareto front",
            optimize::optimize,
        )
        .events::<_, tolerance::ToleranceEvent, _>(
            "/tolerance",
            "A tolerance analysis, as by papilio tolerance: progress, then yield, percentiles and sensitivities",
            tolerance::tolerance,
        )
        .events::<_, validate::ValidateEvent, _>(
            "/validate",
            "Samples that others measured, predicted from their printed inputs, as by papilio validate --measured",
            validate::validate,
        )
}

/// The router of the whole site.
pub(crate) fn routes(site: Site) -> Router {
    let guard = middleware::from_fn_with_state(site.clone(), guard::check_request);
    let caught = middleware::from_fn(panics::caught);
    endpoints().router().fallback(page::file).layer(caught).layer(guard).with_state(site)
}

/// Returns the OpenAPI 3.1 description of the API, as `GET /api/v1/openapi.json` does.
pub fn openapi() -> Value {
    endpoints().description()
}

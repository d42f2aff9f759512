//! The endpoints `/gonio`, `/gonio/full` and `/gonio/layers`: surfaces by their geometry, measured as by `papilio gonio`.
//!
//! A preview follows few rays, within seconds. A full measurement follows all of them, reports its progress, and can be stopped.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use papilio_formats::{
    SurfaceAuditFile, roads_that_hold, write_cutoffs, write_psd, write_totals, write_waves,
};
use papilio_microgeometry::{
    Findings, Measured, Measurement, MicrogeometryError, REPLICATES, Side, Surface, Total,
};
use papilio_scenario::{Edit, ResolvedSurface, SurfaceScenario};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::detail::Table;
use super::drawn::Figure;
use super::events::{self, EventSender, Events};
use super::written::text;
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver, edited};
use crate::site::Site;
use crate::work::abandoned;

/// Rays from each side at each inclination: most of a preview, and of a full measurement.
const MOST_PREVIEW_RAYS: u64 = 50_000;
const MOST_RAYS: u64 = 2_000_000;

/// Realisations of a phase screen in a preview. The full measurement has 8.
const PREVIEW_SCREENS: usize = 2;

/// Time after which a preview is stopped.
const LONGEST_PREVIEW: Duration = Duration::from_secs(20);

/// Most heights along a side of a random face that rays are followed through: 32 MiB for each thread, and as many in its transform twice.
const MOST_SIDE: usize = 2048;

/// A surface, with edits that are applied before it is read.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct GonioOf {
    /// The surface: TOML with the table `[microgeometry]`.
    scenario: String,
    /// Ids of uploaded files by their names in the surface.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Edits of the surface.
    #[serde(default)]
    edits: Vec<Edit>,
    /// Rays from each side at each inclination, and in each band of directions, at most 50000. A surface that asks for fewer gets these.
    rays: u64,
}

/// A measured surface.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Gonio {
    /// The surface after the edits: TOML.
    scenario: String,
    /// The surface as it was read, with all defaults.
    fields: BTreeMap<String, Value>,
    /// Rays from each side at each inclination.
    rays: u64,
    /// Whether this is the full measurement, as `papilio gonio` makes it.
    is_full: bool,
    /// The content of audit.json.
    #[schemars(with = "SurfaceAuditFile<'static>")]
    audit: Value,
    /// Where the light of each side and inclination goes.
    totals: Vec<TotalRow>,
    /// Whether rays or waves describe the surface; null without waves.
    roads: Option<&'static str>,
    /// The tables that `papilio gonio` writes.
    tables: Vec<Table>,
    /// The figures that it draws.
    figures: Vec<Figure>,
    /// Notes about the surface.
    notes: Vec<String>,
    /// Time for measuring, ms.
    cost_ms: f64,
}

/// Where the light of an inclination goes: fractions of it.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct TotalRow {
    /// The side from which it comes, `above` or `below`.
    from: &'static str,
    /// Inclination in the medium of the light, degrees.
    theta_deg: f64,
    /// Reflected light.
    reflected: Estimate,
    /// Transmitted light.
    transmitted: Estimate,
    /// The part of `transmitted` with |beta| above 1, which a flat face traps.
    trapped: Estimate,
    /// Light that leaves exactly as from a flat face.
    regular: Estimate,
    /// Light that facets absorb.
    absorbed: Estimate,
    /// Mean number of facets that light meets.
    mean_facets: Estimate,
    /// Of the transmitted light with |beta| up to 1, the fraction beyond 2.5 deg of the normal.
    haze: Estimate,
}

/// A mean and its standard error.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Estimate {
    /// The mean.
    value: f64,
    /// Its standard error.
    error: f64,
}

impl From<Measured> for Estimate {
    fn from(Measured { value, error }: Measured) -> Self {
        Self { value, error }
    }
}

impl From<&Total> for TotalRow {
    fn from(total: &Total) -> Self {
        let (reflected, transmitted) = (total.regular_reflected, total.regular_transmitted);
        let regular = Measured {
            value: reflected.value + transmitted.value,
            error: reflected.error.hypot(transmitted.error),
        };
        Self {
            from: if total.from == Side::Above { "above" } else { "below" },
            theta_deg: total.theta_deg,
            reflected: total.reflected.into(),
            transmitted: total.transmitted.into(),
            trapped: total.transmitted_beyond.into(),
            regular: regular.into(),
            absorbed: total.absorbed.into(),
            mean_facets: total.mean_facets.into(),
            haze: total.haze.into(),
        }
    }
}

/// An event of a full measurement.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum GonioEvent {
    /// Another part is finished.
    Progress(GonioProgress),
    /// The measurement.
    Done(Box<Gonio>),
    /// The measurement has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a measurement.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct GonioProgress {
    /// Finished parts: phase screens, and replicates of rays.
    done: usize,
    /// All parts.
    of: usize,
    /// Time since the start, s.
    seconds: f64,
}

/// A surface that is a layer of a display.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct SurfaceLayer {
    /// Path of the layer: `display.layers.0`.
    path: String,
    /// Name of the file of the surface.
    file: String,
    /// The surface with the keys of the layer, and with the indices of its neighbours: TOML.
    scenario: String,
}

/// Measures a preview.
pub(super) async fn gonio(site: Site, request: GonioOf) -> Result<Gonio, Fault> {
    let server = site.clone();
    site.long().work(move |stop| preview(&server, request, stop)).await
}

fn preview(site: &Site, request: GonioOf, stop: &AtomicBool) -> Result<Gonio, Fault> {
    let scenario = edited(request.scenario, &request.edits)?;
    let given = Given { scenario, files: request.files };
    let rays = request.rays.clamp(1, MOST_PREVIEW_RAYS);
    let measured = || {
        let mut surface = read(site, &given)?;
        let goniometer = &mut surface.measurement.goniometer;
        goniometer.rays = goniometer.rays.min(rays.div_ceil(REPLICATES));
        let started = Instant::now();
        let is_late = || stop.load(Ordering::Relaxed) || started.elapsed() > LONGEST_PREVIEW;
        let measurement = &surface.measurement;
        let found = measurement.measured_with(PREVIEW_SCREENS, None, &is_late, &|| {});
        let found = found.map_err(|error| match error {
            MicrogeometryError::Interrupted if stop.load(Ordering::Relaxed) => abandoned(),
            MicrogeometryError::Interrupted => too_slow(),
            other => refused(&other),
        })?;
        written(given.scenario.clone(), &surface, &found, started)
    };
    measured().map_err(|fault| fault.about(&given.scenario))
}

/// Starts a full measurement.
pub(super) async fn full(site: Site, given: Given) -> Result<Events, Fault> {
    let server = site.clone();
    // Errors of the surface are reported before the stream starts.
    let (given, surface) = site
        .quick()
        .work(move |_| {
            let surface = read(&server, &given)?;
            let rays = surface.measurement.goniometer.rays * REPLICATES;
            if rays > MOST_RAYS + REPLICATES {
                let message = format!("{rays} rays are too many for the page: at most {MOST_RAYS}");
                return Err(Fault::too_much(message, "choose fewer rays, or use `papilio gonio`"));
            }
            Ok((given, surface))
        })
        .await?;
    events::start(site.streamed(), move |events| {
        let done = measure(given.scenario, &surface, events);
        done.map_or_else(|fault| GonioEvent::Failed(fault.body), |gonio| GonioEvent::Done(Box::new(gonio)))
    })
    .await
}

fn measure(scenario: String, surface: &ResolvedSurface, events: &EventSender) -> Result<Gonio, Fault> {
    let started = Instant::now();
    let of = surface.measurement.parts();
    let finished = AtomicUsize::new(0);
    // One thread sends at a time.
    let sending = Mutex::new(());
    let tell = || {
        let done = finished.fetch_add(1, Ordering::Relaxed) + 1;
        let _one = sending.lock().unwrap_or_else(PoisonError::into_inner);
        events.send(&GonioEvent::Progress(GonioProgress { done, of, seconds: events.seconds() }));
    };
    let stop = || events.stop().load(Ordering::Relaxed) || started.elapsed() > events.deadline();
    let found = surface.measurement.measured(None, &stop, &tell);
    let found = found.map_err(|error| match error {
        MicrogeometryError::Interrupted => crate::work::too_long(events.deadline()),
        other => refused(&other),
    })?;
    Ok(Gonio { is_full: true, ..written(scenario, surface, &found, started)? })
}

/// The surfaces that are layers of a display.
pub(super) async fn layers(site: Site, given: Given) -> Result<Vec<SurfaceLayer>, Fault> {
    let server = site.clone();
    site.quick()
        .work(move |_| {
            let resolved = given.scenario(&server, Solver::Adding)?.resolve()?;
            let layer = |one: papilio_scenario::LayerSurface| SurfaceLayer {
                path: one.path,
                file: one.file,
                scenario: one.text,
            };
            Ok(resolved.surfaces.into_iter().map(layer).collect())
        })
        .await
}

/// Reads a surface, and checks that a server can measure it.
fn read(site: &Site, given: &Given) -> Result<ResolvedSurface, Fault> {
    let library = given.library(site)?;
    let surface = SurfaceScenario::from_text(&given.scenario, "surface", library, &[])?.resolve()?;
    let Measurement { surface: geometry, by_rays, .. } = &surface.measurement;
    if let (Surface::Random(face), true) = (geometry, by_rays) {
        let (side, _) = face.grid();
        if side > MOST_SIDE {
            let message = format!(
                "rays through this face need {side} x {side} heights; the page allows {MOST_SIDE} x {MOST_SIDE}"
            );
            let hint = "choose a longer cutoff_um, or road = \"waves\", or use `papilio gonio`, which has no such limit";
            return Err(Fault::too_much(message, hint));
        }
    }
    Ok(surface)
}

fn too_slow() -> Fault {
    let message = format!(
        "a preview of this surface takes longer than {} s and was stopped",
        LONGEST_PREVIEW.as_secs()
    );
    Fault::too_much(message, "start the full measurement, or use `papilio gonio`")
}

fn refused(error: &MicrogeometryError) -> Fault {
    Fault::too_much(error.to_string(), "")
}

/// The response.
fn written(
    scenario: String,
    surface: &ResolvedSurface,
    found: &Findings,
    started: Instant,
) -> Result<Gonio, Fault> {
    let goniometer = &surface.measurement.goniometer;
    let title = surface.title.as_deref().unwrap_or_default();
    let head = [env!("CARGO_PKG_VERSION"), title, &surface.hash];
    let audit = SurfaceAuditFile::new(head, &surface.notes, goniometer, found);
    let audit = serde_json::to_value(audit);
    let Value::Object(fields) = surface.canonical.clone() else {
        return Err(Fault::internal("the surface cannot be serialised"));
    };
    let mut tables = Vec::new();
    if let Some(rays) = &found.rays {
        tables.push(Table { name: "totals", csv: text(|out| write_totals(out, &rays.totals))? });
    }
    if let Some(waves) = &found.waves {
        tables.push(Table { name: "waves", csv: text(|out| write_waves(out, waves, found.rays.as_ref()))? });
    }
    if let Some(statistics) = &found.statistics {
        tables.push(Table { name: "psd", csv: text(|out| write_psd(out, statistics))? });
        tables.push(Table { name: "cutoff", csv: text(|out| write_cutoffs(out, statistics))? });
    }
    let figures = papilio_figures::of_surface(found, title);
    Ok(Gonio {
        scenario,
        fields: fields.into_iter().collect(),
        rays: goniometer.rays * REPLICATES,
        is_full: false,
        audit: audit.map_err(|_| Fault::internal("the audit cannot be serialised"))?,
        totals: found.rays.iter().flat_map(|rays| &rays.totals).map(TotalRow::from).collect(),
        roads: found.waves.as_ref().map(roads_that_hold),
        tables,
        figures: figures.into_iter().map(|(name, svg)| Figure { name, svg }).collect(),
        notes: surface.notes.clone(),
        cost_ms: 1e3 * started.elapsed().as_secs_f64(),
    })
}

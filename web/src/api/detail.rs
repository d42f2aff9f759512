//! The endpoint `/detail`: sharpness, crosstalk, sparkle or gloss, as by `papilio mtf`, `crosstalk`, `sparkle` and `gloss`.

use std::collections::BTreeMap;

use papilio_display::gloss::gloss;
use papilio_display::spatial::{self, MtfResult, SparkleResult, SparkleRow};
use papilio_display::{Control, Progress};
use papilio_formats::{
    write_crosstalk_csv, write_gloss, write_mtf_csv, write_patterns_csv, write_sparkle, write_spread_csv,
};
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::drawn::Figure;
use super::events::{self, Events};
use super::written::text;
use crate::fault::{Fault, FaultBody};
use crate::reading::{Given, Solver};
use crate::site::Site;

/// A metric's name and value.
type Named = (&'static str, Option<f64>);

/// What is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum Detail {
    /// Sharpness: `papilio mtf`.
    Mtf,
    /// Which sub-pixel lights which: `papilio crosstalk`.
    Crosstalk,
    /// Sparkle: `papilio sparkle`.
    Sparkle,
    /// Gloss: `papilio gloss`.
    Gloss,
}

/// A request for sharpness, crosstalk, sparkle or gloss.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DetailOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// The command.
    command: Detail,
}

/// A table.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Table {
    /// Its name: a file name without extension.
    pub(super) name: &'static str,
    /// Its text (CSV).
    pub(super) csv: String,
}

/// A number of the first view.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Number {
    /// Its name, as in sweeps and searches.
    metric: &'static str,
    /// Its state; null for a number of the whole display.
    state: Option<String>,
    /// Its value; null if it is undefined.
    value: Option<f64>,
    /// Its error.
    error: Option<f64>,
}

/// Sharpness, crosstalk, sparkle or gloss of a scenario.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Detailed {
    /// Numbers of the first view; those of sparkle are of the first row.
    numbers: Vec<Number>,
    /// The tables that the command writes.
    tables: Vec<Table>,
    /// The figures that it draws.
    figures: Vec<Figure>,
    /// Its warnings.
    warnings: Vec<String>,
}

pub(super) async fn detail(site: Site, request: DetailOf) -> Result<Detailed, Fault> {
    let server = site.clone();
    let given = Given { scenario: request.scenario, files: request.files };
    site.long()
        .work(move |stop| {
            let (_, resolved) = given.resolve(&server, Solver::Adding)?;
            detailed(&resolved, request.command, &Control { threads: None, progress: &|_| {}, stop })
        })
        .await
}

/// An event of a computation.
#[derive(Debug, Serialize, JsonSchema)]
#[serde(tag = "event", content = "data", rename_all = "lowercase")]
pub(super) enum DetailEvent {
    /// What is done so far.
    Progress(DetailProgress),
    /// A first answer with large errors: of sparkle, the first row.
    First(Box<Detailed>),
    /// It is complete.
    Done(Box<Detailed>),
    /// It has failed; this event replaces `done`.
    Failed(FaultBody),
}

/// The progress of a computation.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct DetailProgress {
    /// Fraction of the work that is done, 0 to 1.
    fraction: f64,
}

/// The same as [`detail`], with its progress.
pub(super) async fn follow(site: Site, request: DetailOf) -> Result<Events, Fault> {
    let server = site.clone();
    let given = Given { scenario: request.scenario, files: request.files };
    // Errors of the scenario are reported before the stream starts.
    let resolved = site
        .quick()
        .work(move |_| given.resolve(&server, Solver::Adding).map(|(_, resolved)| resolved))
        .await?;
    events::start(site.long(), move |events| {
        let report = |progress: Progress<'_>| {
            events.stop_if_late();
            events.send(&DetailEvent::Progress(DetailProgress { fraction: progress.fraction() }));
        };
        let control = Control { threads: None, progress: &report, stop: events.stop() };
        if let (Detail::Sparkle, Some(face)) = (request.command, &resolved.sparkle) {
            let quiet = Control { progress: &|_| {}, ..control };
            // What is refused is refused again below.
            if let Ok(first) = spatial::first_sparkle(&resolved.scene, face, &quiet)
                && let Ok(first) = of_sparkle(&resolved, &first)
            {
                events.send(&DetailEvent::First(Box::new(first)));
            }
        }
        match detailed(&resolved, request.command, &control) {
            Ok(done) => DetailEvent::Done(Box::new(done)),
            Err(fault) => DetailEvent::Failed(fault.body),
        }
    })
    .await
}

fn detailed(resolved: &Resolved, command: Detail, control: &Control<'_>) -> Result<Detailed, Fault> {
    let Resolved { scene, patterns, .. } = resolved;
    let title = resolved.title.as_deref().unwrap_or_default();
    let fault = |error| Fault::of(resolved, error);
    let (numbers, tables, figures, mut warnings) = match command {
        Detail::Mtf => {
            let found = spatial::mtf(scene, patterns, control).map_err(fault)?;
            let tables = vec![
                Table { name: "mtf", csv: text(|out| write_mtf_csv(out, &found))? },
                Table { name: "spread", csv: text(|out| write_spread_csv(out, &found))? },
            ];
            (of_sharpness(&found), tables, papilio_figures::of_mtf(&found, title), found.warnings)
        }
        Detail::Crosstalk => {
            let found = spatial::crosstalk(scene, &patterns.text, control).map_err(fault)?;
            let tables = vec![
                Table { name: "crosstalk", csv: text(|out| write_crosstalk_csv(out, &found))? },
                Table { name: "patterns", csv: text(|out| write_patterns_csv(out, &found))? },
            ];
            let numbers = found.views.first().map_or_else(Vec::new, |view| {
                numbers(None, view.metrics().named(), view.errors().named()).collect()
            });
            (numbers, tables, papilio_figures::crosstalk(&found, title), found.warnings)
        }
        Detail::Sparkle => {
            let face = resolved.sparkle.as_ref().ok_or_else(no_face)?;
            return of_sparkle(resolved, &spatial::sparkle(scene, face, control).map_err(fault)?);
        }
        Detail::Gloss => {
            let found = gloss(scene, control).map_err(fault)?;
            let tables = vec![Table { name: "gloss", csv: text(|out| write_gloss(out, &found))? }];
            let of_states = found.states.iter();
            let numbers = of_states
                .flat_map(|(name, state)| numbers(Some(name), state.values.named(), state.error.named()))
                .collect();
            (numbers, tables, Vec::new(), found.warnings)
        }
    };
    resolved.warn_before(&mut warnings);
    Ok(Detailed { numbers, tables, figures: drawn(figures), warnings })
}

fn of_sparkle(resolved: &Resolved, found: &SparkleResult) -> Result<Detailed, Fault> {
    let title = resolved.title.as_deref().unwrap_or_default();
    let of_row =
        |row: &SparkleRow| numbers(None, row.metrics().named(), row.errors().named()).collect::<Vec<_>>();
    let mut warnings = found.warnings.clone();
    resolved.warn_before(&mut warnings);
    Ok(Detailed {
        numbers: found.rows.first().map_or_else(Vec::new, of_row),
        tables: vec![Table { name: "sparkle", csv: text(|out| write_sparkle(out, found))? }],
        figures: drawn(papilio_figures::of_sparkle(found, title)),
        warnings,
    })
}

fn drawn(figures: Vec<(String, String)>) -> Vec<Figure> {
    figures.into_iter().map(|(name, svg)| Figure { name, svg }).collect()
}

/// Numbers of the whole display, then those of each state.
fn of_sharpness(found: &MtfResult) -> Vec<Number> {
    let Some(view) = found.views.first() else { return Vec::new() };
    let of_view = numbers(None, view.metrics().named(), view.errors().named());
    let of_states = view
        .states
        .iter()
        .flat_map(|(name, state)| numbers(Some(name), state.scalars.named(), state.error.named()));
    of_view.chain(of_states).collect()
}

/// Values and errors in the same order.
fn numbers(
    state: Option<&str>,
    values: impl Iterator<Item = Named>,
    errors: impl Iterator<Item = Named>,
) -> impl Iterator<Item = Number> {
    let state = state.map(str::to_owned);
    values.zip(errors).map(move |((metric, value), (_, error))| Number {
        metric,
        state: state.clone(),
        value,
        error,
    })
}

fn no_face() -> Fault {
    let hint = "add the table [sparkle] with slope_rms or haze and correlation_um, or a rough layer with distribution = \
                \"beckmann\" and correlation_um; a gloss number determines neither";
    Fault::too_much(
        "the scenario describes no antiglare face: the table [sparkle] is missing".to_owned(),
        hint,
    )
}

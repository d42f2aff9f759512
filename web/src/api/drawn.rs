//! The endpoints `/cone`, `/angles` and `/figures`: metrics over many viewing directions, and drawings.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use papilio_display::{ConeGrid, ConeResult, Control};
use papilio_formats::{CONE_QUANTITIES, cone_quantities};
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::live::{Answer, compute_scenario, compute_scene};
use crate::fault::Fault;
use crate::prepared::Accuracy;
use crate::reading::{Given, Solver};
use crate::site::Site;

/// Most memory of a cone on each thread, bytes.
const MOST_BYTES: f64 = 1e9;

/// Least and largest step of the inclinations of a cone, in degrees.
pub(super) const CONE_STEPS_DEG: (f64, f64) = (1.0, 15.0);

/// Maximum number of views of a scan of angles.
const MOST_ANGLES: f64 = 181.0;

/// A drawing.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Figure {
    /// Its name: a file name without extension.
    pub(super) name: String,
    /// The drawing as SVG.
    pub(super) svg: String,
}

/// A request for metrics over all viewing directions.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ConeOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Step of the inclinations, degrees, 1 to 15; that of the azimuths is five times as large, at most 30.
    #[serde(default = "one_degree")]
    step_deg: f64,
}

fn one_degree() -> f64 {
    1.0
}

/// Metrics over all viewing directions.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ConeSeen {
    /// Conoscopic maps; empty if the directions span no area.
    figures: Vec<Figure>,
    /// Inclinations, degrees.
    theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    phi_deg: Vec<f64>,
    /// States, in the order of the scenario.
    states: Vec<String>,
    /// Names of the quantities in `data`.
    quantities: [&'static str; CONE_QUANTITIES.len()],
    /// The quantities of each direction (theta varies fastest) and state.
    data: Vec<Vec<[Option<f64>; CONE_QUANTITIES.len()]>>,
    /// The largest relative discretisation error of Y.
    discretisation_error: f64,
    /// Warnings of the computation.
    warnings: Vec<String>,
}

pub(super) async fn cone(site: Site, request: ConeOf) -> Result<ConeSeen, Fault> {
    let (least, most) = CONE_STEPS_DEG;
    if !(least..=most).contains(&request.step_deg) {
        return Err(Fault::malformed(format!("step_deg must be from {least} to {most} deg")));
    }
    let server = site.clone();
    let given = Given { scenario: request.scenario, files: request.files };
    site.long()
        .work(move |stop| {
            let (_, resolved) = given.resolve(&server, Solver::Adding)?;
            let cone = compute_cone(&resolved, request.step_deg, stop)?;
            let title = resolved.title.unwrap_or_default();
            let drawn = [
                ("cone", papilio_figures::cone(&cone, &title)),
                ("cone_differences", papilio_figures::cone_differences(&cone, &title)),
            ];
            let figure =
                |(name, svg): (&str, Option<String>)| Some(Figure { name: name.to_owned(), svg: svg? });
            let figures = drawn.into_iter().filter_map(figure);
            Ok(ConeSeen {
                figures: figures.collect(),
                data: numbers(&cone),
                quantities: CONE_QUANTITIES,
                theta_deg: cone.theta_deg,
                phi_deg: cone.phi_deg,
                states: cone.states,
                discretisation_error: cone.discretisation_error,
                warnings: cone.warnings,
            })
        })
        .await
}

/// Computes the metrics over all viewing directions, at inclinations with the given step.
pub(super) fn compute_cone(
    resolved: &Resolved,
    step_deg: f64,
    stop: &AtomicBool,
) -> Result<ConeResult, Fault> {
    let scene = &resolved.scene;
    let mut grid = ConeGrid::within(scene)?;
    if step_deg > 1.0 {
        let last = grid.theta_deg.last().copied().unwrap_or(0.0);
        // The number of equal steps that complete the circle.
        let around = (360.0 / (5.0 * step_deg).min(30.0) - 1e-9).ceil();
        grid.theta_deg = uniform_steps(0.0, last, step_deg);
        grid.phi_deg = (0..around as usize).map(|k| 360.0 * k as f64 / around).collect();
    }
    let control = Control { threads: None, progress: &|_| {}, stop };
    let bytes = papilio_display::expected_map_bytes(scene, &control);
    if bytes.map_err(|error| Fault::of(resolved, error))? > MOST_BYTES {
        return Err(Fault::too_much(
            "all directions with display.diffuser.regular_fraction in light that depends on azimuth take gigabytes",
            "choose single views, or use `papilio run --cone --allow-long`",
        ));
    }
    papilio_display::cone(scene, grid, &control).map_err(|error| Fault::of(resolved, error))
}

/// Returns values from `from` to `to` with a constant step; `to` is included if a step reaches it.
fn uniform_steps(from: f64, to: f64, step: f64) -> Vec<f64> {
    let count = ((to - from) / step + 1e-9).floor() as usize;
    (0..=count).map(|k| from + step * k as f64).collect()
}

fn numbers(cone: &ConeResult) -> Vec<Vec<[Option<f64>; CONE_QUANTITIES.len()]>> {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let of_view = |view: &papilio_display::ConeView| {
        view.states.iter().map(|state| cone_quantities(view, state).map(finite)).collect()
    };
    cone.views.iter().map(of_view).collect()
}

/// A request for metrics against the viewing angle in a plane.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AnglesOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Azimuth of the plane, degrees.
    phi_deg: f64,
    /// First inclination, degrees, above -90.
    from_deg: f64,
    /// Last inclination, degrees, below 90.
    to_deg: f64,
    /// Step of the inclinations, degrees; at most 181 inclinations.
    step_deg: f64,
    /// A first answer is coarse and fast.
    #[serde(default)]
    accuracy: Accuracy,
}

/// Metrics against the viewing angle.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct AnglesSeen {
    /// Inclinations, degrees.
    theta_deg: Vec<f64>,
    /// Azimuth, degrees.
    phi_deg: f64,
    /// False for a first answer.
    is_final: bool,
    /// The largest relative error of Y.
    relative_error: f64,
    /// Metrics of a view by their names in result.json: a number for each inclination.
    metrics: BTreeMap<String, Vec<Option<f64>>>,
    /// Metrics of each state by their names in result.json: a number for each inclination.
    states: BTreeMap<String, BTreeMap<String, Vec<Option<f64>>>>,
}

pub(super) async fn angles(site: Site, request: AnglesOf) -> Result<AnglesSeen, Fault> {
    let AnglesOf { scenario, files, phi_deg, from_deg, to_deg, step_deg, accuracy } = request;
    let inside = |theta: f64| theta.abs() < 90.0;
    let count = ((to_deg - from_deg) / step_deg).floor() + 1.0;
    if !(inside(from_deg) && inside(to_deg) && phi_deg.abs() <= 360.0 && (1.0..=MOST_ANGLES).contains(&count))
    {
        let message = format!(
            "from_deg and to_deg must be above -90 and below 90 deg, in increasing order, phi_deg from -360 to 360 \
             deg, and there must be 1 to {MOST_ANGLES} inclinations"
        );
        return Err(Fault::malformed(message));
    }
    let server = site.clone();
    let given = Given { scenario, files };
    let gate = if accuracy == Accuracy::First { site.quick() } else { site.long() };
    gate.work(move |stop| {
        let (_, mut resolved) = given.resolve(&server, Solver::Adding)?;
        resolved.scene.viewer.theta_deg = uniform_steps(from_deg, to_deg, step_deg);
        resolved.scene.viewer.phi_deg = vec![phi_deg];
        Ok(by_angle(&compute_scene(&server, resolved, accuracy, stop)?, phi_deg))
    })
    .await
}

fn by_angle(answer: &Answer, phi_deg: f64) -> AnglesSeen {
    let views = &answer.result.views;
    let mut all = AnglesSeen {
        theta_deg: views.iter().map(|view| view.theta_deg).collect(),
        phi_deg,
        is_final: answer.result.solver.is_final,
        relative_error: answer.result.solver.relative_error_reached,
        metrics: BTreeMap::new(),
        states: BTreeMap::new(),
    };
    for view in views {
        for (name, value) in view.metrics.named() {
            all.metrics.entry(name.to_owned()).or_default().push(value);
        }
        for (name, state) in view.states.iter() {
            let metrics = all.states.entry(name.to_owned()).or_default();
            for (name, value) in plain_numbers(&state.value) {
                metrics.entry(name).or_default().push(value);
            }
        }
    }
    all
}

/// Returns the numbers of a struct by the names of its fields; fields of other types are left out.
fn plain_numbers(values: &impl Serialize) -> impl Iterator<Item = (String, Option<f64>)> {
    let all = match serde_json::to_value(values) {
        Ok(Value::Object(all)) => all,
        _ => Map::new(),
    };
    let plain = |(name, value): (String, Value)| match value {
        Value::Null => Some((name, None)),
        Value::Number(number) => Some((name, number.as_f64())),
        _ => None,
    };
    all.into_iter().filter_map(plain)
}

/// A request for figures of a scenario.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FiguresOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Names of the figures, as in the file names of `papilio run`; empty: all figures.
    #[serde(default)]
    names: Vec<String>,
}

pub(super) async fn figures(site: Site, request: FiguresOf) -> Result<Vec<Figure>, Fault> {
    let server = site.clone();
    let given = Given { scenario: request.scenario, files: request.files };
    let figures = site
        .quick()
        .work(move |stop| {
            let answer = compute_scenario(&server, &given, stop)?;
            Ok(papilio_figures::of_run(&answer.result, answer.title()))
        })
        .await?;
    let wanted = |name: &String| request.names.is_empty() || request.names.contains(name);
    Ok(figures.into_iter().filter(|(name, _)| wanted(name)).map(|(name, svg)| Figure { name, svg }).collect())
}

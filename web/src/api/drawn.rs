//! What is seen from many directions, and drawings of it: cone, angles, figures.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

use papilio_display::{ConeGrid, ConeResult, Control};
use papilio_formats::CONE_QUANTITIES;
use papilio_scenario::Resolved;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::live::{Answer, look, seen};
use crate::fault::Fault;
use crate::reading::{By, Given};
use crate::site::Site;

/// Steps of the cone's directions, degrees.
pub(super) const CONE_STEPS_DEG: (f64, f64) = (1.0, 15.0);

/// Views of a scan of angles.
const MOST_ANGLES: f64 = 181.0;

/// A drawing.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Figure {
    /// Its name, as of a file without its end.
    pub(super) name: String,
    /// SVG.
    pub(super) svg: String,
}

/// A scenario whose display is looked at from everywhere.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ConeOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Degrees between inclinations, 1 to 15; azimuths are five times as far apart, 30 at most.
    #[serde(default = "one_degree")]
    step_deg: f64,
}

fn one_degree() -> f64 {
    1.0
}

/// What is seen from everywhere.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ConeSeen {
    /// Conoscopic maps; none where the directions span no area.
    figures: Vec<Figure>,
    /// Inclinations, degrees.
    theta_deg: Vec<f64>,
    /// Azimuths, degrees.
    phi_deg: Vec<f64>,
    /// States, in the order of the scenario.
    states: Vec<String>,
    /// Names of the numbers of a direction.
    quantities: [&'static str; 8],
    /// For each direction (theta fastest) and state, the numbers.
    data: Vec<Vec<[Option<f64>; 8]>>,
    /// The largest relative discretisation error of Y that was found.
    discretisation_error: f64,
    /// Remarks.
    warnings: Vec<String>,
}

pub(super) async fn cone(site: Site, asked: ConeOf) -> Result<ConeSeen, Fault> {
    let (least, most) = CONE_STEPS_DEG;
    if !(least..=most).contains(&asked.step_deg) {
        return Err(Fault::malformed(format!("step_deg must be from {least} to {most}")));
    }
    let of = site.clone();
    let given = Given { scenario: asked.scenario, files: asked.files };
    site.long()
        .work(move |stop| {
            let (_, resolved) = given.resolve(&of, By::Adding)?;
            let cone = survey(&resolved, asked.step_deg, stop)?;
            let title = resolved.title.unwrap_or_default();
            let figures =
                papilio_figures::cone(&cone, &title).map(|svg| Figure { name: "cone".to_owned(), svg });
            Ok(ConeSeen {
                figures: figures.into_iter().collect(),
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

/// All directions so many degrees apart.
pub(super) fn survey(resolved: &Resolved, step_deg: f64, stop: &AtomicBool) -> Result<ConeResult, Fault> {
    let scene = &resolved.scene;
    let mut grid = ConeGrid::within(scene)?;
    if step_deg > 1.0 {
        let last = grid.theta_deg.last().copied().unwrap_or(0.0);
        // As many as close the circle.
        let around = (360.0 / (5.0 * step_deg).min(30.0) - 1e-9).ceil();
        grid.theta_deg = evenly(0.0, last, step_deg);
        grid.phi_deg = (0..around as usize).map(|k| 360.0 * k as f64 / around).collect();
    }
    let control = Control { threads: None, progress: &|_| {}, stop };
    papilio_display::cone(scene, grid, &control).map_err(|error| Fault::of(resolved, error))
}

/// From `from` on in steps, `to` included if they reach it.
fn evenly(from: f64, to: f64, step: f64) -> Vec<f64> {
    let count = ((to - from) / step + 1e-9).floor() as usize;
    (0..=count).map(|k| from + step * k as f64).collect()
}

fn numbers(cone: &ConeResult) -> Vec<Vec<[Option<f64>; 8]>> {
    let known = |value: f64| Some(value).filter(|value| value.is_finite());
    let one = |view: &papilio_display::ConeView| {
        let of = |state: &papilio_display::ConeState| {
            [
                known(state.reflectance_factor_y),
                known(state.luminance_cd_m2),
                state.u_prime,
                state.v_prime,
                state.uv_shift,
                view.contrast_ratio,
                view.gamut_percent_srgb,
                view.gamut_percent_ebu,
            ]
        };
        view.states.iter().map(of).collect()
    };
    cone.views.iter().map(one).collect()
}

/// A scenario that is looked at along a plane.
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
    /// Degrees between them; 181 inclinations at most.
    step_deg: f64,
}

/// Metrics against the viewing angle.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct AnglesSeen {
    /// Inclinations, degrees.
    theta_deg: Vec<f64>,
    /// Azimuth, degrees.
    phi_deg: f64,
    /// Metrics of the states together by their names in result.json: a number for each inclination.
    metrics: BTreeMap<String, Vec<Option<f64>>>,
    /// The same of each state.
    states: BTreeMap<String, BTreeMap<String, Vec<Option<f64>>>>,
}

pub(super) async fn angles(site: Site, asked: AnglesOf) -> Result<AnglesSeen, Fault> {
    let AnglesOf { scenario, files, phi_deg, from_deg, to_deg, step_deg } = asked;
    let inside = |theta: f64| theta.abs() < 90.0;
    let count = ((to_deg - from_deg) / step_deg).floor() + 1.0;
    if !(inside(from_deg) && inside(to_deg) && phi_deg.abs() <= 360.0 && (1.0..=MOST_ANGLES).contains(&count))
    {
        let message = format!("angles must run up between -90 and 90 degrees, in {MOST_ANGLES} at most");
        return Err(Fault::malformed(message));
    }
    let of = site.clone();
    let given = Given { scenario, files };
    site.quick()
        .work(move |stop| {
            let (_, mut resolved) = given.resolve(&of, By::Adding)?;
            resolved.scene.viewer.theta_deg = evenly(from_deg, to_deg, step_deg);
            resolved.scene.viewer.phi_deg = vec![phi_deg];
            Ok(by_angle(&seen(&of, resolved, stop)?, phi_deg))
        })
        .await
}

fn by_angle(answer: &Answer, phi_deg: f64) -> AnglesSeen {
    let views = &answer.result.views;
    let mut all = AnglesSeen {
        theta_deg: views.iter().map(|view| view.theta_deg).collect(),
        phi_deg,
        metrics: BTreeMap::new(),
        states: BTreeMap::new(),
    };
    for view in views {
        for (name, value) in view.metrics.named() {
            all.metrics.entry(name.to_owned()).or_default().push(value);
        }
        for (state, seen) in view.states.iter() {
            let metrics = all.states.entry(state.to_owned()).or_default();
            for (name, value) in plain_numbers(&seen.value) {
                metrics.entry(name).or_default().push(value);
            }
        }
    }
    all
}

/// The numbers of a struct by the names of its fields; what else it has is left out.
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

/// A scenario whose figures are wanted.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct FiguresOf {
    /// The scenario: TOML.
    scenario: String,
    /// Ids of uploaded files by their names in the scenario.
    #[serde(default)]
    files: BTreeMap<String, String>,
    /// Names of figures, as `papilio run` gives them to files; none: all.
    #[serde(default)]
    names: Vec<String>,
}

pub(super) async fn figures(site: Site, asked: FiguresOf) -> Result<Vec<Figure>, Fault> {
    let of = site.clone();
    let given = Given { scenario: asked.scenario, files: asked.files };
    let figures = site
        .quick()
        .work(move |stop| {
            let answer = look(&of, &given, stop)?;
            Ok(papilio_figures::of_run(&answer.result, answer.title()))
        })
        .await?;
    let wanted = |name: &String| asked.names.is_empty() || asked.names.contains(name);
    Ok(figures.into_iter().filter(|(name, _)| wanted(name)).map(|(name, svg)| Figure { name, svg }).collect())
}

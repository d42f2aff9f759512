//! Reader of `result.json`, for the parts that can be compared with a measurement.

use std::collections::BTreeMap;

use papilio_colour::{Standard, Xyz};
use papilio_diagnostics::{Diagnostic, Place};
use papilio_display::compare::{
    MeasuredMetric, Simulated, SimulatedMetric, SimulatedState, SimulatedView, StateDeviation,
};
use papilio_spectra::Grid;
use serde::Deserialize;
use serde_json::Value as Json;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Result of a run, with its title.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadResult {
    /// Title of the scenario, if it has one.
    pub title: Option<String>,
    /// SHA-256 of the scenario and its input files; `None` in a file that another program has written.
    pub hash: Option<String>,
    /// Warnings of the scenario and of the run.
    pub warnings: Vec<String>,
    /// The quantities that can be compared.
    pub simulated: Simulated,
}

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    scenario: Scenario,
    hash: Option<String>,
    #[serde(default)]
    warnings: Vec<String>,
    wavelength_nm: Vec<f64>,
    illuminant: Illuminant,
    views: Vec<View>,
}

#[derive(Deserialize, Default)]
struct Scenario {
    title: Option<String>,
    #[serde(default)]
    metrics: Metrics,
}

#[derive(Deserialize, Default)]
struct Metrics {
    observer: Option<String>,
}

#[derive(Deserialize)]
struct Illuminant {
    radiance_of_white: Vec<f64>,
}

#[derive(Deserialize)]
struct View {
    theta_deg: f64,
    phi_deg: f64,
    states: BTreeMap<String, State>,
}

#[derive(Deserialize)]
#[allow(non_snake_case, reason = "as in result.json")]
struct State {
    reflectance_factor: Option<Vec<f64>>,
    X: f64,
    Y: f64,
    Z: f64,
    #[serde(default)]
    standard_error: Errors,
    #[serde(default)]
    discretisation_error: Errors,
}

/// Errors of the numbers of a state.
#[derive(Deserialize, Default)]
#[serde(default)]
#[allow(non_snake_case, reason = "as in result.json")]
struct Errors {
    reflectance_factor: Option<Vec<Option<f64>>>,
    X: Option<f64>,
    Y: Option<f64>,
    Z: Option<f64>,
    L_star: Option<f64>,
    a_star: Option<f64>,
    b_star: Option<f64>,
}

/// Reads a `result.json`.
///
/// # Errors
/// If the file is not JSON or not a result, or if its parts are inconsistent.
pub fn read_result(file: &DataFile) -> Result<ReadResult, FormatError> {
    crate::guard::read(file, of_json)
}

/// Reads a `result.json` with those of its metrics that were measured.
///
/// # Errors
/// As [`read_result`].
pub fn read_result_with(file: &DataFile, metrics: &[MeasuredMetric]) -> Result<ReadResult, FormatError> {
    let mut read = read_result(file)?;
    if metrics.is_empty() {
        return Ok(read);
    }
    let whole: Json = serde_json::from_slice(&file.bytes).unwrap_or_default();
    for (view, json) in read.simulated.views.iter_mut().zip(whole["views"].as_array().into_iter().flatten()) {
        view.metrics = metrics.iter().filter_map(|metric| simulated_metric(json, metric)).collect();
    }
    Ok(read)
}

/// The metric of a view, with its errors; `None` if it is not in the result.
fn simulated_metric(view: &Json, metric: &MeasuredMetric) -> Option<SimulatedMetric> {
    let of = match &metric.state {
        Some(state) => view.get("states")?.get(state)?,
        None => view,
    };
    let name = metric.metric.name();
    let error = |kind: &str| of.get(kind).and_then(|errors| errors.get(name)).and_then(Json::as_f64);
    let errors = ["standard_error", "discretisation_error"].map(|kind| error(kind).unwrap_or(0.0));
    Some(SimulatedMetric {
        name: metric.name(),
        value: of.get(name)?.as_f64()?,
        standard_deviation: errors[0].hypot(errors[1]),
    })
}

impl State {
    /// Standard deviations by noise and discretisation together; an unknown one counts as 0.
    fn deviation(&self) -> StateDeviation {
        let both = |get: fn(&Errors) -> Option<f64>| {
            let [noise, levels] =
                [&self.standard_error, &self.discretisation_error].map(|errors| get(errors).unwrap_or(0.0));
            noise.hypot(levels)
        };
        let at = |errors: &Errors, bin: usize| {
            errors.reflectance_factor.as_ref().and_then(|all| all.get(bin).copied().flatten()).unwrap_or(0.0)
        };
        let bins = self.reflectance_factor.as_ref().map_or(0, Vec::len);
        let factor = |bin| at(&self.standard_error, bin).hypot(at(&self.discretisation_error, bin));
        StateDeviation {
            reflectance_factor: (0..bins).map(factor).collect(),
            xyz: [both(|one| one.X), both(|one| one.Y), both(|one| one.Z)],
            lab: [both(|one| one.L_star), both(|one| one.a_star), both(|one| one.b_star)],
        }
    }
}

fn of_json(file: &DataFile) -> Result<ReadResult, FormatError> {
    let text = file.text()?;
    let read: File = serde_json::from_str(text).map_err(|error| {
        let line_start = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let at = match error.line() {
            0 => 0,
            _ => usize::saturating_add(line_start, error.column().saturating_sub(1)),
        };
        let place = Place::in_text(&file.name, text, at..at + 1);
        FormatError { place, problem: not_a_result(&parser_message(&error)) }
    })?;
    simulated(read).map_err(|message| FormatError::whole(&file.name, not_a_result(message)))
}

fn not_a_result(message: &str) -> Problem {
    Diagnostic::new(format!("this is not a result.json: {message}"))
        .hint("specify a result.json that `papilio run` has written, or its folder")
        .into()
}

/// Returns the parser's message without the place, which the diagnostic prints separately.
fn parser_message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rsplit_once(" at line ").map_or(text.clone(), |(words, _)| words.to_owned())
}

/// Message for wavelengths that are not a [`Grid`].
const NOT_UNIFORM: &str = "the wavelengths in `wavelength_nm` are not a uniform grid that increases";

fn simulated(read: File) -> Result<ReadResult, &'static str> {
    let nm = &read.wavelength_nm;
    let (Some(first), Some(last)) = (nm.first(), nm.last()) else { return Err("`wavelength_nm` is empty") };
    let step = (last - first) / (nm.len().saturating_sub(1)) as f64;
    let grid = Grid::new(*first, *last, step).map_err(|_| NOT_UNIFORM)?;
    let is_uniform = nm.iter().enumerate().all(|(i, nm)| (grid.wavelength_nm(i) - nm).abs() < 1e-6 * step);
    if grid.len() != nm.len() || !is_uniform {
        return Err(NOT_UNIFORM);
    }
    let fits = |spectrum: &[f64]| spectrum.len() == nm.len();
    let spectra = read.views.iter().flat_map(|view| view.states.values());
    let factors: Option<Vec<&[f64]>> = spectra.map(|state| state.reflectance_factor.as_deref()).collect();
    let Some(factors) = factors else {
        return Err(
            "all of its light comes from the front light, so it has no reflectance factors to compare",
        );
    };
    if !fits(&read.illuminant.radiance_of_white) || !factors.into_iter().all(fits) {
        return Err("a spectrum does not have one value for each wavelength of `wavelength_nm`");
    }
    if !read.illuminant.radiance_of_white.iter().any(|value| *value > 0.0) {
        return Err("`illuminant.radiance_of_white` is zero at all wavelengths");
    }
    if read.views.is_empty() {
        return Err("`views` is empty");
    }
    let state = |(name, state): (String, State)| {
        let deviation = state.deviation();
        let reflectance_factor = state.reflectance_factor.unwrap_or_default();
        let xyz = Xyz { x: state.X, y: state.Y, z: state.Z };
        SimulatedState { name, reflectance_factor, xyz, deviation }
    };
    let views = read.views.into_iter().map(|View { theta_deg, phi_deg, states }| SimulatedView {
        theta_deg,
        phi_deg,
        states: states.into_iter().map(state).collect(),
        metrics: Vec::new(),
    });
    let observer = match read.scenario.metrics.observer.as_deref() {
        Some("1964") => Standard::Cie1964,
        _ => Standard::Cie1931,
    };
    let simulated = Simulated {
        grid,
        radiance_of_white: read.illuminant.radiance_of_white,
        observer,
        views: views.collect(),
    };
    Ok(ReadResult { title: read.scenario.title, hash: read.hash, warnings: read.warnings, simulated })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<ReadResult, FormatError> {
        read_result(&DataFile { name: "result.json".to_owned(), bytes: text.as_bytes().to_vec() })
    }

    const GOOD: &str = r#"{"scenario": {"title": "A", "metrics": {"observer": "1964"}}, "seed": 1,
"wavelength_nm": [400, 500, 600], "illuminant": {"radiance_of_white": [1, 1, 1]},
"views": [{"theta_deg": 8, "phi_deg": 0, "states": {"white": {"reflectance_factor": [0.1, 0.2, 0.3], "X": 0.2, "Y": 0.2, "Z": 0.1, "peak_nm": null}}}]}"#;

    #[test]
    fn result_of_a_run_is_read() {
        let result = read(GOOD).unwrap();
        assert_eq!((result.title.as_deref(), result.simulated.observer), (Some("A"), Standard::Cie1964));
        assert_eq!(result.simulated.views[0].states[0].reflectance_factor, [0.1, 0.2, 0.3]);
    }

    #[test]
    fn malformed_result_is_an_error_with_its_place() {
        let place = |text: &str| read(text).unwrap_err().place.line_column();
        assert_eq!(place("{\n\"views\": [},"), Some((2, 11)));
        assert!(place("").is_some() && place("[]").is_some() && place("{}").is_some());
        for (from, to) in [
            ("[400, 500, 600]", "[400, 500]"),
            ("[400, 500, 600]", "[]"),
            ("[400, 500, 600]", "[400, 400, 400]"),
            ("[400, 500, 600]", "[400, 450, 600]"),
            ("[0.1, 0.2, 0.3]", "[0.1]"),
            ("[1, 1, 1]", "[0, 0, 0]"),
            ("\"Y\": 0.2", "\"Y\": null"),
            ("\"theta_deg\": 8", "\"theta_deg\": 1e999"),
        ] {
            assert!(GOOD.contains(from));
            let error = read(&GOOD.replace(from, to)).unwrap_err();
            assert!(error.to_string().contains("this is not a result.json"), "{from} -> {to}: {error}");
        }
    }

    #[test]
    fn changed_result_never_panics() {
        let characters = "0123456789[]{},:\"abcdefghijklmnopqrstuvwxyz.-";
        papilio_testing::laws(
            300,
            |dice| (dice.below(400), dice.text(characters, 8)),
            |(cut, put)| {
                let at = (*cut).min(GOOD.len());
                let _ = read(&format!("{}{put}{}", &GOOD[..at], &GOOD[at..]));
                let _ = read(&GOOD[..at]);
            },
        );
    }
}

//! Reader of `result.json`, for the parts that can be compared with a measurement.

use std::collections::BTreeMap;

use papilio_colour::{Standard, Xyz};
use papilio_diagnostics::{Diagnostic, Place};
use papilio_display::compare::{Simulated, SimulatedView};
use papilio_spectra::Grid;
use serde::Deserialize;

use crate::error::{FormatError, Problem};
use crate::file::DataFile;

/// Result of a run, with its title.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadResult {
    /// Title of the scenario, if it has one.
    pub title: Option<String>,
    /// SHA-256 of the scenario and its input files; `None` in a file that another program has written.
    pub hash: Option<String>,
    /// The quantities that can be compared.
    pub simulated: Simulated,
}

#[derive(Deserialize)]
struct File {
    #[serde(default)]
    scenario: Scenario,
    hash: Option<String>,
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
}

/// Reads a `result.json`.
///
/// # Errors
/// If the file is not JSON or not a result, or if its parts are inconsistent.
pub fn read_result(file: &DataFile) -> Result<ReadResult, FormatError> {
    crate::guard::read(file, of_json)
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
        (name, state.reflectance_factor.unwrap_or_default(), Xyz { x: state.X, y: state.Y, z: state.Z })
    };
    let views = read.views.into_iter().map(|View { theta_deg, phi_deg, states }| SimulatedView {
        theta_deg,
        phi_deg,
        states: states.into_iter().map(state).collect(),
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
    Ok(ReadResult { title: read.scenario.title, hash: read.hash, simulated })
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
        assert_eq!(result.simulated.views[0].states[0].1, [0.1, 0.2, 0.3]);
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

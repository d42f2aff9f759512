//! Results: the bytes of `result.json`, and all numbers as arrays.

use std::sync::Arc;

use numpy::PyArray1;
use papilio_display::result as display;
use papilio_formats::{ResultFile, write_json, write_spectra, write_states};
use papilio_scenario::Resolved;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::columns::Columns;
use crate::errors;

exports! { classes RunResult; }

/// The result of a run.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct RunResult {
    result: display::RunResult,
    resolved: Arc<Resolved>,
}

impl RunResult {
    pub(crate) fn new(mut result: display::RunResult, resolved: Arc<Resolved>) -> Self {
        resolved.warn_before(&mut result.warnings);
        result.notes.splice(0..0, resolved.notes.iter().cloned());
        Self { result, resolved }
    }

    fn file(&self) -> ResultFile<'_> {
        ResultFile {
            papilio: env!("CARGO_PKG_VERSION"),
            scenario: &self.resolved.canonical,
            hash: &self.resolved.hash,
            seed: self.resolved.scene.solver.seed,
            notes: &self.result.notes,
            result: &self.result,
        }
    }
}

#[pymethods]
impl RunResult {
    /// The bytes of `result.json`.
    fn json<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        written(py, |out| write_json(out, &self.file()))
    }

    /// Version of the program, hash of the scenario, seed.
    fn about(&self) -> (&'static str, &str, u64) {
        (env!("CARGO_PKG_VERSION"), &self.resolved.hash, self.resolved.scene.solver.seed)
    }

    /// The bytes of `states.csv`.
    fn states_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        written(py, |out| write_states(out, &self.result))
    }

    /// The bytes of `spectra.csv`.
    fn spectra_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        written(py, |out| write_spectra(out, &self.result))
    }

    /// Names (`standard_error.Y`) and arrays: quantities of all states together (shape [view]) and of each state
    /// (shape [view, state, ...]).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let [views, states] =
            py.detach(|| columns(&self.result)).map_err(|error| errors::internal(&error.to_string()))?;
        Ok((views.into_dict(py)?, states.into_dict(py)?))
    }

    /// Wavelengths, nm.
    fn wavelength_nm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.result.wavelength_nm)
    }

    /// Spectral radiance of the reference white, W/(m2 sr nm).
    fn radiance_of_white<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.result.illuminant.radiance_of_white)
    }

    /// Names and SVG texts of the figures of `papilio run`.
    fn figures(&self, py: Python<'_>, title: &str) -> Vec<(String, String)> {
        py.detach(|| papilio_figures::of_run(&self.result, title))
    }

    /// SVG text of the overview of the first view.
    fn overview(&self, py: Python<'_>, title: &str) -> Option<String> {
        py.detach(|| Some(papilio_figures::overview(&self.result, self.result.views.first()?, title)))
    }

    /// Warnings of the scenario and of the run.
    fn warnings(&self) -> Vec<String> {
        self.result.warnings.clone()
    }

    /// Notes of the scenario.
    fn notes(&self) -> Vec<String> {
        self.result.notes.clone()
    }

    /// Names of the drive states.
    fn states(&self) -> Vec<&str> {
        let first = self.result.views.first();
        first.map(|view| view.states.iter().map(|(name, _)| name).collect()).unwrap_or_default()
    }

    /// Inclination and azimuth of every view, degrees.
    fn views(&self) -> Vec<(f64, f64)> {
        self.result.views.iter().map(|view| (view.theta_deg, view.phi_deg)).collect()
    }
}

/// Metrics of all states together, and of each state.
fn columns(result: &display::RunResult) -> serde_json::Result<[Columns; 2]> {
    let count = result.views.first().map_or(0, |view| view.states.0.len());
    let mut together = Columns::new(&[result.views.len()]);
    let mut alone = Columns::new(&[result.views.len(), count]);
    for (v, view) in result.views.iter().enumerate() {
        together.add(v, "", &serde_json::to_value(view.metrics)?);
        together.add(v, "standard_error", &serde_json::to_value(view.standard_error)?);
        together.add(v, "discretisation_error", &serde_json::to_value(view.discretisation_error)?);
        for (s, (name, state)) in view.states.iter().enumerate() {
            alone.add(v * count + s, "", &serde_json::to_value(state)?);
            alone.add(v * count + s, "ledger", &serde_json::to_value(view.ledger.get(name))?);
        }
    }
    Ok([together, alone])
}

/// Returns the bytes that `write` writes, without holding the interpreter.
pub(crate) fn written<'py>(
    py: Python<'py>,
    write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()> + Send,
) -> PyResult<Bound<'py, PyBytes>> {
    let mut bytes = Vec::new();
    py.detach(|| write(&mut bytes)).map_err(|error| errors::internal(&error.to_string()))?;
    Ok(PyBytes::new(py, &bytes))
}

//! Scenarios: conversion of text to scenes, or to errors with their positions.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use papilio_formats::DataFile;
use papilio_scenario::{Edit, Library, MemoryFile, ResolveCache, Scenario};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;

use crate::errors;
use crate::watch::detached;

exports! { classes Described, Resolved; functions edit, label, migrate, new_scenario, path_keys, preset_names, schema; }

/// A parsed scenario, with valid keys and types.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Described {
    pub(crate) scenario: Scenario,
}

#[pymethods]
impl Described {
    /// Reads a scenario from a file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<(String, Self)> {
        let name = path.display().to_string();
        let read = || {
            let file = DataFile::open(&path, &name)?;
            file.text().map(str::to_owned)
        };
        let text = py.detach(read).map_err(|_| {
            // Read again for the scenario's own error message.
            Scenario::load(&path, &[]).map_or_else(
                |errors| errors::scenario(py, &errors),
                |_| errors::internal("the file changed while it was read"),
            )
        })?;
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        let described = Self::new(py, &text, &name, Some(folder), None)?;
        Ok((text, described))
    }

    /// Parses a text; `files` in memory replace those of the folder.
    #[new]
    #[pyo3(signature = (text, name, folder, files=None))]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
    ) -> PyResult<Self> {
        let read = detached(py, || Scenario::from_text(text, name, library(folder, files), &[]))?;
        Ok(Self { scenario: read.map_err(|errors| errors::scenario(py, &errors))? })
    }

    /// The scenario including its defaults, as JSON.
    fn filled(&self) -> PyResult<String> {
        serde_json::to_string(&self.scenario.filled()).map_err(|error| errors::internal(&error.to_string()))
    }

    /// Resolves the scenario, with all its files.
    fn resolve(&self, py: Python<'_>) -> PyResult<Resolved> {
        let resolved = py.detach(|| self.scenario.resolve());
        Ok(Resolved { of: Arc::new(resolved.map_err(|errors| errors::scenario(py, &errors))?) })
    }
}

/// Source of a scenario's files: a folder, files in memory (without a folder, no file is read from the disk), or both.
pub(crate) fn library(folder: Option<PathBuf>, files: Option<BTreeMap<String, Vec<u8>>>) -> Library {
    let kept = |(name, bytes): (String, Vec<u8>)| (name.clone(), MemoryFile::new(DataFile { name, bytes }));
    let files = files.map(|files| Arc::new(files.into_iter().map(kept).collect()));
    match (folder, files) {
        (Some(folder), Some(files)) => Library::Both { files, folder },
        (None, Some(files)) => Library::Memory { files, memo: Arc::new(ResolveCache::default()) },
        (folder, None) => Library::Folder(folder.unwrap_or_default()),
    }
}

/// A resolved scenario.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Resolved {
    pub(crate) of: Arc<papilio_scenario::Resolved>,
}

#[pymethods]
impl Resolved {
    #[getter]
    fn title(&self) -> Option<&str> {
        self.of.title.as_deref()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.of.notes.clone()
    }

    /// Inclination and azimuth of every view, degrees.
    #[getter]
    fn views(&self) -> Vec<(f64, f64)> {
        let viewer = &self.of.scene.viewer;
        let all = viewer.phi_deg.iter().flat_map(|phi| viewer.theta_deg.iter().map(|theta| (*theta, *phi)));
        all.collect()
    }

    /// The wavelengths, nm.
    #[getter]
    fn wavelength_nm(&self) -> Vec<f64> {
        self.of.scene.grid.wavelengths_nm()
    }

    #[getter]
    fn hash(&self) -> &str {
        &self.of.hash
    }

    /// The canonical scenario, as JSON.
    fn canonical(&self) -> String {
        self.of.canonical.to_string()
    }
}

/// Applies edits, given as JSON, to a text.
#[pyfunction]
pub(crate) fn edit(py: Python<'_>, text: &str, edits: &str) -> PyResult<String> {
    let edits: Vec<Edit> =
        serde_json::from_str(edits).map_err(|error| PyValueError::new_err(error.to_string()))?;
    papilio_scenario::edit(text, &edits).map_err(|errors| errors::scenario(py, &errors))
}

/// A name that was replaced: its line, the old name and the new one.
type Replaced = (usize, String, String);

/// Returns a text with the current names of keys and values, and the replacements: line, old name, new name.
#[pyfunction]
pub(crate) fn migrate(py: Python<'_>, text: &str, name: &str) -> PyResult<(String, Vec<Replaced>)> {
    let migrated = papilio_scenario::migrate(text, name).map_err(|errors| errors::scenario(py, &errors))?;
    let renamed = migrated.renamed.into_iter().map(|one| (one.line, one.old, one.new)).collect();
    Ok((migrated.text, renamed))
}

/// Returns the current names of the keys of a path.
#[pyfunction]
pub(crate) fn path_keys(path: &str) -> Vec<String> {
    papilio_scenario::KeyPath::new(path).keys().map(str::to_owned).collect()
}

/// Text of a scenario in the light of a preset.
#[pyfunction]
pub(crate) fn new_scenario(preset: &str) -> PyResult<String> {
    papilio_scenario::new_scenario(preset).ok_or_else(|| PyKeyError::new_err(preset.to_owned()))
}

/// Quantity in words and unit of a metric or of a key of a scenario.
#[pyfunction]
pub(crate) fn label(name: &str) -> (String, String) {
    let label = papilio_scenario::label(name);
    (label.quantity, label.unit)
}

/// Names of the presets.
#[pyfunction]
pub(crate) fn preset_names() -> Vec<&'static str> {
    papilio_scenario::preset_names().collect()
}

/// JSON Schema of a scenario or of a result, as JSON.
#[pyfunction]
pub(crate) fn schema(of_result: bool) -> String {
    let schema = if of_result { papilio_formats::result_schema() } else { papilio_scenario::schema() };
    schema.to_string()
}

//! Sharpness, crosstalk, sparkle and gloss: the contents of the files of `papilio mtf`, `crosstalk`, `sparkle` and `gloss`.

use numpy::PyArrayDyn;
use papilio_display::gloss::{GlossResult, gloss};
use papilio_display::spatial::{CrosstalkResult, MtfResult, SparkleResult, crosstalk, mtf, sparkle};
use papilio_formats::{
    SparkleFile, SpatialFile, write_crosstalk_csv, write_gloss, write_json, write_kernel_npy, write_mtf_csv,
    write_patterns_csv, write_sparkle, write_spread_csv,
};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::columns::{Columns, array};
use crate::errors;
use crate::result::written;
use crate::scenario::Resolved;
use crate::watch::computed;

exports! { classes Crosstalk, Gloss, Mtf, Sparkle; }

/// Names and SVG texts of figures.
pub(crate) type Figures = Vec<(String, String)>;

/// Names and contents of the tables and pictures that the program writes beside the JSON file.
pub(crate) type Tables<'py> = Vec<(String, Bound<'py, PyBytes>)>;

/// Sharpness of a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Mtf {
    of: MtfResult,
    json: String,
}

#[pymethods]
impl Mtf {
    #[new]
    #[pyo3(signature = (scenario, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = &scenario.of;
        let mut of = computed(py, resolved, threads, progress, |control| {
            mtf(&resolved.scene, &resolved.patterns, control)
        })?;
        resolved.warn_before(&mut of.warnings);
        let json = content(scenario, &resolved.notes_of_places(), &of)?;
        Ok(Self { of, json })
    }

    /// The text of `mtf.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// Names (`error.f50_x_per_mm`) and arrays: numbers of all states together (shape [view, ...]) and of each state (shape
    /// [view, state, ...]).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyDict>, Bound<'py, PyDict>)> {
        let columns = || columns(&self.of).map_err(|error| errors::internal(&error.to_string()));
        let [together, alone] = py.detach(columns)?;
        Ok((together.into_dict(py)?, alone.into_dict(py)?))
    }

    /// Fraction of the light of a state in each cell, shape [view, y, x], y upwards.
    fn kernel<'py>(&self, py: Python<'py>, state: &str) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let kernels = || self.of.views.iter().filter_map(|view| Some(&view.states.get(state)?.kernel));
        let cells = kernels().map(|kernel| kernel.cells).next().unwrap_or(0);
        let fractions = kernels().flat_map(|kernel| kernel.fractions.iter().copied()).collect();
        array(py, &[self.of.views.len(), cells, cells], fractions)
    }

    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        let mut tables = vec![
            ("mtf.csv".to_owned(), written(py, |out| write_mtf_csv(out, &self.of))?),
            ("spread.csv".to_owned(), written(py, |out| write_spread_csv(out, &self.of))?),
        ];
        let states = self.of.views.first().into_iter().flat_map(|view| view.states.iter());
        let with_places: Vec<&str> =
            states.filter(|(_, state)| state.kernel.cells > 0).map(|(state, _)| state).collect();
        let files = papilio_figures::file_names(with_places.iter().copied(), "kernel-", ".npy");
        for (state, file) in with_places.into_iter().zip(files) {
            let kernel = written(py, |out| write_kernel_npy(out, &self.of, state))?;
            tables.push((file, kernel));
        }
        Ok(tables)
    }

    fn figures(&self, py: Python<'_>, title: &str) -> Figures {
        py.detach(|| papilio_figures::of_mtf(&self.of, title))
    }

    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }
}

/// Crosstalk of a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Crosstalk {
    of: CrosstalkResult,
    json: String,
}

#[pymethods]
impl Crosstalk {
    #[new]
    #[pyo3(signature = (scenario, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = &scenario.of;
        let mut of = computed(py, resolved, threads, progress, |control| {
            crosstalk(&resolved.scene, &resolved.patterns.text, control)
        })?;
        resolved.warn_before(&mut of.warnings);
        let json = content(scenario, &resolved.notes_of_places(), &of)?;
        Ok(Self { of, json })
    }

    /// The text of `crosstalk.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// Numbers of each view by name (`out`, `by_light.diffuse.out`, `patterns.line_1.contrast_ratio`).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut columns = Columns::new(&[self.of.views.len()]);
        for (number, view) in self.of.views.iter().enumerate() {
            let view = serde_json::to_value(view).map_err(|error| errors::internal(&error.to_string()))?;
            let keys = view.as_object().into_iter().flatten();
            for (key, value) in keys.filter(|(key, _)| !["theta_deg", "phi_deg"].contains(&key.as_str())) {
                match (key.as_str(), value.as_array()) {
                    ("patterns", Some(patterns)) => patterns.iter().for_each(|pattern| {
                        let name = pattern["name"].as_str().unwrap_or_default();
                        columns.add(number, &format!("patterns.{name}"), pattern);
                    }),
                    _ => columns.add(number, key, value),
                }
            }
        }
        columns.into_dict(py)
    }

    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        Ok(vec![
            ("crosstalk.csv".to_owned(), written(py, |out| write_crosstalk_csv(out, &self.of))?),
            ("patterns.csv".to_owned(), written(py, |out| write_patterns_csv(out, &self.of))?),
        ])
    }

    fn figures(&self, py: Python<'_>, title: &str) -> Figures {
        py.detach(|| papilio_figures::crosstalk(&self.of, title))
    }

    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }
}

/// Sparkle of a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Sparkle {
    of: SparkleResult,
    json: String,
}

#[pymethods]
impl Sparkle {
    #[new]
    #[pyo3(signature = (scenario, title, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        title: &str,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = &scenario.of;
        let missing = "scenario: it describes no antiglare face (expected the table [sparkle] with slope_rms or haze and \
                       correlation_um, or a rough layer with correlation_um)";
        let face = resolved.sparkle.as_ref().ok_or_else(|| errors::argument(py, missing))?;
        let mut of =
            computed(py, resolved, threads, progress, |control| sparkle(&resolved.scene, face, control))?;
        resolved.warn_before(&mut of.warnings);
        let json = text(&SparkleFile {
            papilio: env!("CARGO_PKG_VERSION"),
            title,
            hash: &resolved.hash,
            seed: resolved.scene.solver.seed,
            notes: &resolved.notes,
            result: &of,
        })?;
        Ok(Self { of, json })
    }

    /// The text of `sparkle.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// Numbers of each row by name.
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut columns = Columns::new(&[self.of.rows.len()]);
        for (number, row) in self.of.rows.iter().enumerate() {
            let row = serde_json::to_value(row).map_err(|error| errors::internal(&error.to_string()))?;
            columns.add(number, "", &row);
        }
        columns.into_dict(py)
    }

    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        Ok(vec![("sparkle.csv".to_owned(), written(py, |out| write_sparkle(out, &self.of))?)])
    }

    fn figures(&self, py: Python<'_>, title: &str) -> Figures {
        py.detach(|| papilio_figures::of_sparkle(&self.of, title))
    }
}

/// Gloss of a display.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Gloss {
    of: GlossResult,
    json: String,
}

#[pymethods]
impl Gloss {
    #[new]
    #[pyo3(signature = (scenario, threads=None, progress=None))]
    fn new(
        py: Python<'_>,
        scenario: &Resolved,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let resolved = &scenario.of;
        let mut of = computed(py, resolved, threads, progress, |control| gloss(&resolved.scene, control))?;
        resolved.warn_before(&mut of.warnings);
        let json = content(scenario, &resolved.notes, &of)?;
        Ok(Self { of, json })
    }

    /// The text of `gloss.json`.
    fn json(&self) -> &str {
        &self.json
    }

    /// Numbers of each state by name (`gloss_60`, `error.gloss_60`).
    fn arrays<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut columns = Columns::new(&[self.of.states.0.len()]);
        for (number, (_, state)) in self.of.states.iter().enumerate() {
            let state = serde_json::to_value(state).map_err(|error| errors::internal(&error.to_string()))?;
            columns.add(number, "", &state);
        }
        columns.into_dict(py)
    }

    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Tables<'py>> {
        Ok(vec![("gloss.csv".to_owned(), written(py, |out| write_gloss(out, &self.of))?)])
    }

    fn warnings(&self) -> Vec<String> {
        self.of.warnings.clone()
    }
}

/// Numbers of all states together, and of each state.
fn columns(result: &MtfResult) -> serde_json::Result<[Columns; 2]> {
    let count = result.views.first().map_or(0, |view| view.states.0.len());
    let mut together = Columns::new(&[result.views.len()]);
    let mut alone = Columns::new(&[result.views.len(), count]);
    for (v, view) in result.views.iter().enumerate() {
        let mut numbers = serde_json::to_value(view)?;
        // Directions and patterns are no numbers of a view.
        let states = numbers.as_object_mut().and_then(|numbers| {
            ["theta_deg", "phi_deg", "patterns"].iter().for_each(|key| drop(numbers.remove(*key)));
            numbers.remove("states")
        });
        together.add(v, "", &numbers);
        for (s, (name, _)) in view.states.iter().enumerate() {
            if let Some(state) = states.as_ref().and_then(|states| states.get(name)) {
                alone.add(v * count + s, "", state);
            }
        }
    }
    Ok([together, alone])
}

/// The text of `mtf.json` or `crosstalk.json`.
fn content(scenario: &Resolved, notes: &[String], result: &impl serde::Serialize) -> PyResult<String> {
    let Resolved { of: resolved, .. } = scenario;
    text(&SpatialFile {
        papilio: env!("CARGO_PKG_VERSION"),
        hash: &resolved.hash,
        scenario: &resolved.canonical,
        notes,
        result,
    })
}

/// The text of a file.
pub(crate) fn text(file: &impl serde::Serialize) -> PyResult<String> {
    let mut bytes = Vec::new();
    let written = write_json(&mut bytes, file).map(|()| String::from_utf8(bytes));
    match written {
        Ok(Ok(text)) => Ok(text),
        _ => Err(errors::internal("a result that is no text")),
    }
}

//! A fit of a scenario to measured data: the contents of the files of `papilio fit`.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use numpy::PyArray1;
use papilio_design::DesignError;
use papilio_design::fit::{FitReport, Fitting, Residual};
use papilio_design::output::{fit_figures, fit_table, fitted_text};
use papilio_design::search::was_stopped;
use papilio_display::compare::Measurement;
use papilio_formats::{DataFile, FormatError, read_measurement};
use papilio_scenario::{Library, ScenarioErrors};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors;
use crate::scenario::library;
use crate::spatial::{Figures, text};
use crate::watch::{ProgressState, Watch, watched};

exports! { classes Fit; }

/// A measurement: its path or name, and its bytes if it is in memory.
type Measured = (String, Option<Vec<u8>>);

/// Columns of words, by their names.
type Words<'a> = Vec<(&'a str, Vec<&'a str>)>;

/// Name of a column of numbers, and the number of a row.
type Column = (&'static str, fn(&Residual) -> f64);

/// A fitted scenario, with its report.
#[pyclass(frozen, module = "papilio._papilio")]
pub(crate) struct Fit {
    report: FitReport,
    /// The scenario with the fitted values, for the folder of the scenario.
    text: String,
    /// Notes on the scenario and on how the measurements were read.
    notes: Vec<String>,
}

/// Error that ends a fit.
enum Failure {
    Scenario(ScenarioErrors),
    Data(FormatError),
    Design(DesignError),
    NoMinimum,
}

impl From<ScenarioErrors> for Failure {
    fn from(errors: ScenarioErrors) -> Self {
        Self::Scenario(errors)
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        Self::Data(error)
    }
}

impl From<DesignError> for Failure {
    fn from(error: DesignError) -> Self {
        Self::Design(error)
    }
}

impl Failure {
    fn raised(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::Scenario(errors) => errors::scenario(py, errors),
            Self::Data(error) => errors::format(py, error),
            Self::Design(error) if was_stopped(error) => PyKeyboardInterrupt::new_err(()),
            Self::Design(DesignError::Fit { reason }) => errors::argument(py, &format!("measured: {reason}")),
            Self::Design(error) => errors::search(py, error),
            Self::NoMinimum => errors::argument(
                py,
                "scenario: no start of the fit led to a minimum; use more starts (fit.starts), or narrower bounds around what is \
                 known",
            ),
        }
    }
}

#[pymethods]
impl Fit {
    #[new]
    #[pyo3(signature = (text, name, folder, files, measured, threads=None, progress=None))]
    #[allow(clippy::too_many_arguments, reason = "the scenario as everywhere, and what is measured")]
    fn new(
        py: Python<'_>,
        text: &str,
        name: &str,
        folder: Option<PathBuf>,
        files: Option<BTreeMap<String, Vec<u8>>>,
        measured: Vec<Measured>,
        threads: Option<u16>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let stop = AtomicBool::new(false);
        let threads = threads.map(usize::from);
        let threads = threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let here = folder.clone().unwrap_or_default();
        let library = library(folder, files);
        let found = watched(py, &stop, progress.as_ref(), |watch| {
            let (fitting, mut notes) = fitting(text, name, library, measured, watch.stop)?;
            let mut found = fit(&fitting, threads, watch)?;
            let text = fitted_text(text, [&here, &here], &fitting, &found)?;
            notes.splice(0..0, fitting.spec().notes.iter().cloned());
            notes.append(&mut found.notes);
            found.notes.clone_from(&notes);
            Ok::<_, Failure>(Self { report: found, text, notes })
        })?;
        found.map_err(|failure| failure.raised(py))
    }

    /// The text of `fit.json`.
    fn json(&self) -> PyResult<String> {
        text(&self.report)
    }

    /// The text of `fit.csv`.
    fn table(&self) -> String {
        fit_table(&self.report)
    }

    /// The text of the fitted scenario, for the folder of the scenario.
    fn scenario(&self) -> &str {
        &self.text
    }

    /// Columns of `fit.csv`: the words, then the numbers (wavelengths are NaN where there are none).
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<(Words<'_>, Bound<'py, PyDict>)> {
        let all = &self.report.residuals;
        let words = vec![
            ("name", all.iter().map(|one| one.name.as_str()).collect()),
            ("quantity", all.iter().map(|one| one.quantity).collect()),
        ];
        let columns: [Column; 8] = [
            ("theta_deg", |one| one.theta_deg),
            ("phi_deg", |one| one.phi_deg),
            ("wavelength_nm", |one| one.wavelength_nm.unwrap_or(f64::NAN)),
            ("measured", |one| one.measured),
            ("standard_deviation", |one| one.standard_deviation),
            ("fitted", |one| one.predicted),
            ("residual", |one| one.predicted - one.measured),
            ("z", |one| (one.predicted - one.measured) / one.standard_deviation),
        ];
        let numbers = PyDict::new(py);
        for (name, of) in columns {
            numbers.set_item(name, PyArray1::from_iter(py, all.iter().map(of)))?;
        }
        Ok((words, numbers))
    }

    fn figures(&self, py: Python<'_>, title: &str) -> Figures {
        py.detach(|| fit_figures(title, &self.report))
    }

    fn warnings(&self) -> Vec<String> {
        self.report.warnings.clone()
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

/// Reads a scenario and its measurements, with notes on how these were read.
fn fitting<'stop>(
    text: &str,
    name: &str,
    library: Library,
    measured: Vec<Measured>,
    stop: &'stop AtomicBool,
) -> Result<(Fitting<'stop>, Vec<String>), Failure> {
    let spec = papilio_scenario::Fit::from_text(text, name, library, &[])?;
    let (mut all, mut notes) = (Measurement::default(), Vec::new());
    for (name, bytes) in measured {
        let file = match bytes {
            Some(bytes) => DataFile { name: name.clone(), bytes },
            None => DataFile::open(name.as_ref(), &name)?,
        };
        let read = read_measurement(&file)?;
        notes.extend(read.warnings.iter().map(|note| format!("{name}: {note}")));
        all.append(read.value);
    }
    Ok((Fitting::new(spec, &all, stop)?, notes))
}

fn fit(fitting: &Fitting<'_>, threads: usize, watch: &Watch<'_>) -> Result<FitReport, Failure> {
    let found = fitting.run(threads, &|fraction, _| watch.tell(ProgressState::Fraction(fraction)))?;
    found.ok_or(Failure::NoMinimum)
}

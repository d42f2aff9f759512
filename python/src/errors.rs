//! Mistakes as the exceptions that `papilio/errors.py` declares, with their texts and places.

use papilio_design::DesignError;
use papilio_display::DisplayError;
use papilio_formats::{FormatError, Place};
use papilio_scenario::ScenarioErrors;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Where the exceptions are.
const MODULE: &str = "papilio.errors";

/// What is wrong with a scenario.
pub(crate) fn scenario(py: Python<'_>, errors: &ScenarioErrors) -> PyErr {
    let all = errors.iter().map(|error| {
        let mistake = at(py, &error.place)?;
        mistake.set_item("message", &error.diagnostic.message)?;
        mistake.set_item("expected", error.diagnostic.expected.as_deref())?;
        mistake.set_item("hint", error.hint())?;
        mistake.set_item("path", error.path.clone())?;
        Ok(mistake)
    });
    raised(py, "ScenarioError", errors.to_string(), all.collect())
}

/// What is wrong with a data file.
pub(crate) fn format(py: Python<'_>, error: &FormatError) -> PyErr {
    let mistake = at(py, &error.place).and_then(|mistake| {
        mistake.set_item("message", error.problem.to_string())?;
        Ok(vec![mistake])
    });
    raised(py, "FileError", error.to_string(), mistake)
}

/// Why a scene cannot be computed.
pub(crate) fn display(py: Python<'_>, error: &DisplayError) -> PyErr {
    raised(py, "DisplayError", error.to_string(), Ok(Vec::new()))
}

/// An argument that is wrong; `text` begins with its name.
pub(crate) fn argument(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "ArgumentError", text.to_owned(), Ok(Vec::new()))
}

/// A design that cannot be: which one, and why.
pub(crate) fn design(py: Python<'_>, design: usize, why: &str) -> PyErr {
    let made = || py.import(MODULE)?.getattr("DesignError")?.call1((why, design));
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Why a search could not be.
pub(crate) fn search(py: Python<'_>, error: &DesignError) -> PyErr {
    match error {
        DesignError::Scenario(errors) => scenario(py, errors),
        DesignError::Display(error) => display(py, error),
        error => argument(py, &format!("scenario: {error}")),
    }
}

/// A fault of this program.
pub(crate) fn internal(what: &str) -> PyErr {
    PyRuntimeError::new_err(format!("an internal fault of papilio: {what}"))
}

/// A place as a dictionary.
fn at<'py>(py: Python<'py>, place: &Place) -> PyResult<Bound<'py, PyDict>> {
    let mistake = PyDict::new(py);
    mistake.set_item("file", &place.name)?;
    let (line, column) = place.line_column().unzip();
    mistake.set_item("line", line)?;
    mistake.set_item("column", column)?;
    Ok(mistake)
}

/// The exception of this name; an error on the way to it takes its place.
fn raised(py: Python<'_>, name: &str, text: String, mistakes: PyResult<Vec<Bound<'_, PyDict>>>) -> PyErr {
    let made = || {
        let mistakes = PyList::new(py, mistakes?)?;
        py.import(MODULE)?.getattr(name)?.call1((text, mistakes))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

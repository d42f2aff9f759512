//! Conversion of errors to the exceptions of `papilio/errors.py`, with their messages and positions.

use papilio_design::DesignError;
use papilio_display::DisplayError;
use papilio_formats::{FormatError, Place};
use papilio_scenario::{Interface, Resolved, ScenarioErrors, text_of};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// Module of the exceptions.
const MODULE: &str = "papilio.errors";

/// Errors of a scenario.
pub(crate) fn scenario(py: Python<'_>, errors: &ScenarioErrors) -> PyErr {
    let all = errors.iter().map(|error| {
        let mistake = at(py, &error.place)?;
        mistake.set_item("message", &error.diagnostic.message)?;
        mistake.set_item("expected", error.diagnostic.expected.as_deref())?;
        mistake.set_item("hint", error.help(Interface::Python))?;
        mistake.set_item("path", error.path.clone())?;
        Ok(mistake)
    });
    raised(py, "ScenarioError", errors.text(Interface::Python), all.collect())
}

/// Error of a data file.
pub(crate) fn format(py: Python<'_>, error: &FormatError) -> PyErr {
    let mistake = at(py, &error.place).and_then(|mistake| {
        mistake.set_item("message", error.problem.to_string())?;
        Ok(vec![mistake])
    });
    raised(py, "FileError", error.to_string(), mistake)
}

/// Error of the computation of a scene, with the position in its scenario if a key causes it;
/// `KeyboardInterrupt` if it was stopped.
pub(crate) fn display_of(py: Python<'_>, resolved: &Resolved, error: &DisplayError) -> PyErr {
    match error {
        DisplayError::Interrupted => PyKeyboardInterrupt::new_err(()),
        error => resolved.located(error).map_or_else(|| display(py, error), |errors| scenario(py, &errors)),
    }
}

/// Error of the computation of a scene.
fn display(py: Python<'_>, error: &DisplayError) -> PyErr {
    raised(py, "DisplayError", text_of(error, Interface::Python), Ok(Vec::new()))
}

/// Error of an argument; `text` begins with its name.
pub(crate) fn argument(py: Python<'_>, text: &str) -> PyErr {
    raised(py, "ArgumentError", text.to_owned(), Ok(Vec::new()))
}

/// Error of a design: its index and the reason.
pub(crate) fn design(py: Python<'_>, design: usize, why: &str) -> PyErr {
    let made = || py.import(MODULE)?.getattr("DesignError")?.call1((why, design));
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Error of a search.
pub(crate) fn search(py: Python<'_>, error: &DesignError) -> PyErr {
    match error {
        DesignError::Scenario(errors) => scenario(py, errors),
        DesignError::Display(error) => display(py, error),
        error => argument(py, &format!("scenario: {error}")),
    }
}

/// Internal error of this program.
pub(crate) fn internal(what: &str) -> PyErr {
    let text = format!("internal error of papilio: {what}");
    Python::attach(|py| {
        let made = || py.import(MODULE)?.getattr("InternalError")?.call1((&text,));
        made().map_or_else(|error| error, PyErr::from_value)
    })
}

/// Position in a text as a dictionary.
fn at<'py>(py: Python<'py>, place: &Place) -> PyResult<Bound<'py, PyDict>> {
    let mistake = PyDict::new(py);
    mistake.set_item("file", &place.name)?;
    let (line, column) = place.line_column().unzip();
    mistake.set_item("line", line)?;
    mistake.set_item("column", column)?;
    Ok(mistake)
}

/// Creates the exception of a name. If this fails, returns the error that occurred.
fn raised(py: Python<'_>, name: &str, text: String, mistakes: PyResult<Vec<Bound<'_, PyDict>>>) -> PyErr {
    let made = || {
        let mistakes = PyList::new(py, mistakes?)?;
        py.import(MODULE)?.getattr(name)?.call1((text, mistakes))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

//! Figures as images.

use std::ffi::CString;

use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;

exports! { functions png; }

/// Converts a figure to a PNG image.
#[pyfunction]
pub(crate) fn png<'py>(py: Python<'py>, svg: &str, scale: f32) -> PyResult<Bound<'py, PyBytes>> {
    let picture = py.detach(|| papilio_figures::png(svg, scale));
    let picture = picture.map_err(|error| errors::argument(py, &format!("svg: {error}")))?;
    for warning in &picture.warnings {
        let text = CString::new(warning.as_str())?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 2)?;
    }
    Ok(PyBytes::new(py, &picture.value))
}

//! What the display makes of light from any direction.

use std::sync::atomic::AtomicBool;

use papilio_display::pixel::state_names;
use papilio_display::{BrdfGrid, Control, DisplayError, brdf, reflection};
use papilio_formats::{BsdfSource, write_bsdf, write_reflection};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::scenario::Resolved;
use crate::watch::watched;

/// The display's BSDF at these inclinations of light and viewer and these azimuths between them, degrees: the bytes of
/// `display-bsdf.npz`; and how far a sum over the directions misses what leaves.
#[pyfunction]
#[pyo3(signature = (scenario, title, theta_i_deg, theta_o_deg, dphi_deg, threads=None, progress=None, allow_error=None))]
#[allow(clippy::too_many_arguments, reason = "directions of a table, and how it is computed")]
pub(crate) fn bsdf<'py>(
    py: Python<'py>,
    scenario: &Resolved,
    title: &str,
    theta_i_deg: Vec<f64>,
    theta_o_deg: Vec<f64>,
    dphi_deg: Vec<f64>,
    threads: Option<u16>,
    progress: Option<Bound<'py, PyAny>>,
    allow_error: Option<f64>,
) -> PyResult<(Bound<'py, PyBytes>, f64)> {
    let of = &scenario.of;
    let grid = BrdfGrid { theta_i_deg, theta_o_deg, dphi_deg };
    let others = state_names(&of.scene.display.pixel).len() * of.scene.grid.len();
    let numbers = grid.pairs().saturating_mul(others);
    if numbers > BrdfGrid::MOST_NUMBERS {
        return Err(errors::argument(
            py,
            &format!(
                "step_deg: the table would have {numbers} numbers (states x theta_i x theta_o x dphi x wavelengths); at most {}",
                BrdfGrid::MOST_NUMBERS
            ),
        ));
    }
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title, hash: &of.hash };
    let (bytes, missed) = computed(py, threads, progress, |control| {
        let table = brdf(&of.scene, grid, control)?.allowing(allow_error)?;
        let mut bytes = Vec::new();
        Ok((write_bsdf(&mut bytes, &source, &table).map(|()| bytes), table.missed()))
    })?;
    let bytes = bytes.map_err(|error| errors::internal(&error.to_string()))?;
    Ok((PyBytes::new(py, &bytes), missed))
}

/// What becomes of beams from these inclinations: the text of `reflection.csv`.
#[pyfunction]
#[pyo3(signature = (scenario, theta_deg, threads=None, progress=None))]
pub(crate) fn beams<'py>(
    py: Python<'py>,
    scenario: &Resolved,
    theta_deg: Vec<f64>,
    threads: Option<u16>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let found =
        computed(py, threads, progress, |control| reflection(&scenario.of.scene, &theta_deg, control))?;
    let mut text = Vec::new();
    write_reflection(&mut text, &found).map_err(|error| errors::internal(&error.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

fn computed<T: Send>(
    py: Python<'_>,
    threads: Option<u16>,
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&Control<'_>) -> Result<T, DisplayError> + Send,
) -> PyResult<T> {
    let found = watched(py, &AtomicBool::new(false), progress.as_ref(), |watch| {
        watch.run(threads.map(usize::from), work)
    })?;
    found.map_err(|error| match error {
        DisplayError::Interrupted => PyKeyboardInterrupt::new_err(()),
        error => errors::display(py, &error),
    })
}

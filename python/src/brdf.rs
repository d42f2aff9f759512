//! BSDF of the display, and the parts of reflected beams.

use papilio_design::output::{Refinable, between_warning, brdf_warnings, finer_step, smallest_step};
use papilio_display::pixel::state_names;
use papilio_display::scene::Stop;
use papilio_display::{
    BrdfGrid, LobeWidths, ProbeGrid, brdf, brdf_at_viewers, depends_on_azimuth, reflection,
};
use papilio_formats::{BsdfSource, Exported, between_error, write_bsdf, write_reflection};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::errors;
use crate::scenario::Resolved;
use crate::watch::computed;

exports! { functions beams, bsdf, bsdf_depends_on_azimuth; }

/// Bytes of a table, the deviation of its sum, warnings, and a sufficient step.
type Written<'py> = (Bound<'py, PyBytes>, f64, Vec<String>, Option<f64>);

/// Computes the display's BSDF at inclinations of light and viewer and azimuths between them, degrees, and at azimuths of the light, if there
/// are any.
///
/// Returns the bytes of `display-bsdf.npz`; the relative deviation of the sum over the directions from the light that leaves;
/// warnings; and a sufficient step if the sum with `step_deg` deviates and a table with that step is not too large. What readers
/// interpolate between the directions is only checked for steps of `step_deg`.
#[pyfunction]
#[pyo3(signature = (scenario, title, theta_i_deg, phi_i_deg, theta_o_deg, dphi_deg, step_deg, threads=None, progress=None, allow_error=None))]
#[allow(clippy::too_many_arguments, reason = "directions of a table and options of its computation")]
pub(crate) fn bsdf<'py>(
    py: Python<'py>,
    scenario: &Resolved,
    title: &str,
    theta_i_deg: Vec<f64>,
    phi_i_deg: Vec<f64>,
    theta_o_deg: Vec<f64>,
    dphi_deg: Vec<f64>,
    step_deg: Option<f64>,
    threads: Option<u16>,
    progress: Option<Bound<'py, PyAny>>,
    allow_error: Option<f64>,
) -> PyResult<Written<'py>> {
    let of = &scenario.of;
    let grid = BrdfGrid { theta_i_deg, phi_i_deg, theta_o_deg, dphi_deg };
    let phi_step = (!grid.phi_i_deg.is_empty()).then(|| 180.0 / grid.phi_i_deg.len() as f64);
    let others = state_names(&of.scene.display.pixel).len() * of.scene.grid.len();
    let numbers = grid.pairs().saturating_mul(others);
    if numbers > BrdfGrid::MOST_NUMBERS {
        return Err(errors::argument(
            py,
            &format!(
                "step_deg: the table would have {numbers} numbers (states x directions of light and viewer x wavelengths); expected at most {}",
                BrdfGrid::MOST_NUMBERS
            ),
        ));
    }
    let source = BsdfSource { papilio: env!("CARGO_PKG_VERSION"), title, hash: &of.hash };
    let target = match of.scene.solver.stop {
        Stop::RelativeError { target, .. } => Some(target),
        Stop::Paths(_) | Stop::Target(_) => None,
    };
    let (table, probes) = computed(py, of, threads, progress, |control| {
        let table = brdf(&of.scene, grid, control)?.allowing(allow_error)?;
        if step_deg.is_none() {
            return Ok((table, None));
        }
        let widths = LobeWidths::of_scene(&of.scene, control)?;
        let lights = &table.grid.theta_i_deg;
        let probes = match phi_step {
            Some(phi_step) => ProbeGrid::around(lights, phi_step, &widths),
            None => ProbeGrid::between(lights, &widths),
        };
        Ok((table, Some(brdf_at_viewers(&of.scene, probes, control)?)))
    })?;
    let internal = |error: std::io::Error| errors::internal(&error.to_string());
    let (mut bytes, missed) = (Vec::new(), table.missed());
    write_bsdf(&mut bytes, &source, &table).map_err(internal)?;
    let mut warnings = brdf_warnings(&table, target);
    if let (Some(step_deg), Some(probes)) = (step_deg, probes) {
        let error = between_error(Exported::Directions(&table), &probes).map_err(internal)?;
        let smallest = smallest_step(phi_step, table.states.len(), table.wavelength_nm.len());
        let refinable = Refinable::Step(step_deg, "step_deg=", smallest);
        warnings.extend(error.and_then(|error| between_warning(&error, refinable)));
    }
    let fits =
        |step: &f64, finer: &f64| numbers as f64 * (step / finer).powi(3) <= BrdfGrid::MOST_NUMBERS as f64;
    let finer = step_deg.and_then(|step| finer_step(step, missed).filter(|finer| fits(&step, finer)));
    Ok((PyBytes::new(py, &bytes), missed, warnings, finer))
}

/// Returns whether the BSDF of the display depends on the azimuth of the light.
#[pyfunction]
#[pyo3(signature = (scenario, threads=None, progress=None))]
pub(crate) fn bsdf_depends_on_azimuth<'py>(
    py: Python<'py>,
    scenario: &Resolved,
    threads: Option<u16>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<bool> {
    let of = &scenario.of;
    computed(py, of, threads, progress, |control| depends_on_azimuth(&of.scene, control))
}

/// Computes the parts of reflected beams from inclinations; returns the text of `reflection.csv`.
#[pyfunction]
#[pyo3(signature = (scenario, theta_deg, threads=None, progress=None))]
pub(crate) fn beams<'py>(
    py: Python<'py>,
    scenario: &Resolved,
    theta_deg: Vec<f64>,
    threads: Option<u16>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyBytes>> {
    let of = &scenario.of;
    let found = computed(py, of, threads, progress, |control| reflection(&of.scene, &theta_deg, control))?;
    let mut text = Vec::new();
    write_reflection(&mut text, &found).map_err(|error| errors::internal(&error.to_string()))?;
    Ok(PyBytes::new(py, &text))
}

//! Output files of `papilio mtf`: `mtf.json`, `mtf.csv`, `spread.csv` and `kernel-STATE.npy`.

use std::io::{self, Write};

use papilio_display::spatial::{Curves, MtfResult};

use crate::npy::{Items, write_npy};
use crate::spatial::SpatialFile;

/// Content of `mtf.json`.
pub type MtfFile<'a> = SpatialFile<'a, MtfResult>;

/// Returns the JSON Schema of `mtf.json`.
pub fn mtf_schema() -> serde_json::Value {
    schemars::schema_for!(MtfFile<'_>).to_value()
}

/// Names of the axes in tables.
const AXES: [&str; 2] = ["x", "y"];

/// Writes `mtf.csv`: one row per view, light, state, axis and frequency; `all` is all light.
///
/// # Errors
/// Those of `out`.
pub fn write_mtf_csv(out: impl Write, result: &MtfResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "light",
        "state",
        "axis",
        "frequency_per_mm",
        "cycles_per_degree",
        "mtf",
        "phase_rad",
        "error",
    ])?;
    for view in &result.views {
        for (name, state) in view.states.iter() {
            for (light, curves) in [("all", &state.otf)].into_iter().chain(state.by_light.iter()) {
                let Curves { otf_x, otf_y, error_x, error_y, .. } = curves;
                for (axis, (otf, errors)) in AXES.iter().zip([(otf_x, error_x), (otf_y, error_y)]) {
                    for (k, ([re, im], error)) in otf.iter().zip(errors).enumerate() {
                        csv.write_record([
                            &view.theta_deg.to_string(),
                            &view.phi_deg.to_string(),
                            light,
                            name,
                            axis,
                            &result.frequency_per_mm[k].to_string(),
                            &result.cycles_per_degree[k].to_string(),
                            &re.hypot(*im).to_string(),
                            &im.atan2(*re).to_string(),
                            &error.to_string(),
                        ])?;
                    }
                }
            }
        }
    }
    csv.flush()
}

/// Writes `spread.csv`: one row per view, light, state, axis and place.
///
/// # Errors
/// Those of `out`.
pub fn write_spread_csv(out: impl Write, result: &MtfResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "light",
        "state",
        "axis",
        "position_um",
        "line_spread_per_mm",
        "edge_spread",
        "error",
    ])?;
    for view in &result.views {
        for (name, state) in view.states.iter() {
            for table in &state.spread {
                for (k, position) in table.position_um.iter().enumerate() {
                    csv.write_record([
                        &view.theta_deg.to_string(),
                        &view.phi_deg.to_string(),
                        table.light.as_str(),
                        name,
                        AXES[table.axis],
                        &position.to_string(),
                        &table.line_spread_per_mm[k].to_string(),
                        &table.edge_spread[k].to_string(),
                        &table.error[k].to_string(),
                    ])?;
                }
            }
        }
    }
    csv.flush()
}

/// Writes `kernel-STATE.npy`: the fraction of the light in each cell, float64, `[view][y][x]`, y upwards; the
/// view's own ray is in the middle cell.
///
/// # Errors
/// Those of `out`, and if there is no such state.
pub fn write_kernel_npy(mut out: impl Write, result: &MtfResult, state: &str) -> io::Result<()> {
    let kernels: Vec<_> =
        result.views.iter().filter_map(|view| Some(&view.states.get(state)?.kernel)).collect();
    let cells = kernels.first().map_or(0, |kernel| kernel.cells);
    let values: Vec<f64> = kernels.iter().flat_map(|kernel| kernel.fractions.iter().copied()).collect();
    write_npy(&mut out, &[kernels.len(), cells, cells], Items::Double(&values))
}

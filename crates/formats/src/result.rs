//! What a run writes: `result.json`, `states.csv`, `spectra.csv`.

use std::io::{self, Write};

use papilio_display::result::{RunResult, State, StateValues, View};
use schemars::JsonSchema;
use serde::Serialize;

/// The JSON Schema of `result.json`.
pub fn result_schema() -> serde_json::Value {
    schemars::schema_for!(ResultFile<'_>).to_value()
}

/// The whole of `result.json`: what was asked, and the answer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ResultFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// The scenario with its defaults filled in.
    pub scenario: &'a serde_json::Value,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// Seed of the walk.
    pub seed: u64,
    /// How the scenario was understood.
    pub notes: &'a [String],
    /// The answer.
    #[serde(flatten)]
    pub result: &'a RunResult,
}

/// Writes `states.csv`: a row for each view and state, every scalar metric
/// beside its standard error (`Y`, `Y_se`). What is undefined is left empty.
///
/// # Errors
/// Those of `out`.
pub fn write_states(out: impl Write, result: &RunResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let mut header_is_there = false;
    for view in &result.views {
        for (name, state) in view.states.iter() {
            let columns = scalars(view, name, state);
            if !header_is_there {
                csv.write_record(columns.iter().map(|(title, _)| title.as_str()))?;
                header_is_there = true;
            }
            csv.write_record(columns.iter().map(|(_, cell)| cell.as_str()))?;
        }
    }
    csv.flush()
}

/// Writes `spectra.csv`: a row for each view, state and wavelength.
///
/// # Errors
/// Those of `out`.
pub fn write_spectra(out: impl Write, result: &RunResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        "theta_deg",
        "phi_deg",
        "state",
        "wavelength_nm",
        "radiance",
        "radiance_se",
        "reflectance_factor",
        "reflectance_factor_se",
    ])?;
    for view in &result.views {
        let angles = [view.theta_deg.to_string(), view.phi_deg.to_string()];
        for (name, state) in view.states.iter() {
            let (value, error) = (&state.value, &state.standard_error);
            for (i, nm) in result.wavelength_nm.iter().enumerate() {
                let numbers =
                    [&value.radiance, &error.radiance, &value.reflectance_factor, &error.reflectance_factor]
                        .map(|column| cell(column.get(i).copied()));
                let start = [angles[0].clone(), angles[1].clone(), name.to_owned(), nm.to_string()];
                csv.write_record(start.iter().chain(&numbers))?;
            }
        }
    }
    csv.flush()
}

/// A number that reads back as it is; nothing where there is none.
fn cell(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
}

type Columns = Vec<(String, String)>;

fn scalars(view: &View, name: &str, state: &State) -> Columns {
    let mut columns: Columns = vec![
        ("theta_deg".to_owned(), view.theta_deg.to_string()),
        ("phi_deg".to_owned(), view.phi_deg.to_string()),
        ("state".to_owned(), name.to_owned()),
    ];
    let mut push = |title: &str, value: Option<f64>, error: Option<f64>| {
        columns.push((title.to_owned(), cell(value)));
        columns.push((format!("{title}_se"), cell(error)));
    };
    let errors = of_state(&state.standard_error);
    for ((title, value), (_, error)) in of_state(&state.value).into_iter().zip(errors) {
        push(&title, value, error);
    }
    let error = &view.standard_error;
    push("contrast_ratio", view.contrast_ratio, error.contrast_ratio);
    push("gamut_percent_srgb", view.gamut_percent_srgb, error.gamut_percent_srgb);
    push("gamut_percent_ebu", view.gamut_percent_ebu, error.gamut_percent_ebu);
    if let Some(ledger) = view.ledger.get(name) {
        let (absorbed, error) = (&ledger.absorbed, &ledger.standard_error);
        push("ledger_returned", Some(ledger.returned), Some(error.returned));
        push("ledger_front", Some(absorbed.front), Some(error.absorbed.front));
        push("ledger_diffuser", Some(absorbed.diffuser), Some(error.absorbed.diffuser));
        push("ledger_glass", Some(absorbed.glass), Some(error.absorbed.glass));
        push("ledger_pixel", Some(absorbed.pixel), Some(error.absorbed.pixel));
        push("ledger_inactive", Some(absorbed.inactive), Some(error.absorbed.inactive));
        push("ledger_unaccounted", Some(ledger.unaccounted), Some(error.unaccounted));
    }
    columns
}

fn of_state(v: &StateValues) -> Vec<(String, Option<f64>)> {
    let fixed = [
        ("X", Some(v.X)),
        ("Y", Some(v.Y)),
        ("Z", Some(v.Z)),
        ("x", v.x),
        ("y", v.y),
        ("z", v.z),
        ("u_prime", v.u_prime),
        ("v_prime", v.v_prime),
        ("L_star", v.L_star),
        ("a_star", v.a_star),
        ("b_star", v.b_star),
        ("luminance_cd_m2", Some(v.luminance_cd_m2)),
        ("contrast", v.contrast),
        ("peak_nm", v.peak_nm),
        ("distance_from_white_uv", v.distance_from_white_uv),
        ("distance_from_d65_uv", v.distance_from_d65_uv),
        ("hue_r", v.hue_rgb.map(|rgb| rgb[0])),
        ("hue_g", v.hue_rgb.map(|rgb| rgb[1])),
        ("hue_b", v.hue_rgb.map(|rgb| rgb[2])),
        ("Y_diffuse", Some(v.terms.diffuse)),
        ("Y_front_reflection", Some(v.terms.front_reflection)),
    ];
    let directed = v.terms.directed.iter().enumerate().map(|(i, y)| (format!("Y_directed_{i}"), Some(*y)));
    let specular = v.specular.iter().enumerate().map(|(i, y)| (format!("specular_{i}"), Some(*y)));
    fixed
        .into_iter()
        .map(|(title, value)| (title.to_owned(), value))
        .chain(directed)
        .chain(specular)
        .collect()
}

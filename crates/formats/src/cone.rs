//! Output files of `papilio run --cone`: `cone.csv`, `cone.npy`, and `cone.json`, which describes them.

use std::io::{self, Write};

use papilio_display::result::ReferenceWhite;
use papilio_display::{ConeResult, ConeState, ConeView};
use serde::Serialize;

use crate::npy::{Items, write_npy};

/// Quantities of a direction and state, in the order of the columns and of the array's last index.
pub const CONE_QUANTITIES: [&str; 13] = [
    "Y",
    "luminance_cd_m2",
    "u_prime",
    "v_prime",
    "uv_shift",
    "contrast_ratio",
    "gamut_percent_srgb",
    "gamut_percent_ebu",
    "L_star",
    "a_star",
    "b_star",
    "delta_E_2000_with_angle",
    "delta_E_1976_with_angle",
];

/// Content of `cone.json`: the axes of the array and its origin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConeFile<'a> {
    papilio: &'a str,
    hash: &'a str,
    axes: [&'a str; 4],
    theta_deg: &'a [f64],
    phi_deg: &'a [f64],
    states: &'a [String],
    quantities: Vec<&'a str>,
    /// Direction with which the colour of each state is compared.
    reference: Direction,
    reference_white: ReferenceWhite,
    directed: Vec<Light>,
    solver: Solver<'a>,
    warnings: &'a [String],
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Direction {
    theta_deg: f64,
    phi_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Light {
    theta_deg: f64,
    phi_deg: f64,
    radius_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
struct Solver<'a> {
    method: &'a str,
    nodes: u64,
    discretisation_error: f64,
}

impl<'a> ConeFile<'a> {
    /// Creates the description of a conoscopic map. `papilio` is the version of the program, `hash` that of
    /// the scenario.
    pub fn new(papilio: &'a str, hash: &'a str, cone: &'a ConeResult) -> Self {
        let directed = cone.lights.iter().map(|light| Light {
            theta_deg: light.theta_deg,
            phi_deg: light.phi_deg,
            radius_deg: light.radius_deg,
        });
        let [theta_deg, phi_deg] = cone.reference_deg;
        let (nodes, discretisation_error) = (cone.nodes, cone.discretisation_error);
        Self {
            papilio,
            hash,
            axes: ["theta_deg", "phi_deg", "states", "quantities"],
            theta_deg: &cone.theta_deg,
            phi_deg: &cone.phi_deg,
            states: &cone.states,
            quantities: columns(cone),
            reference: Direction { theta_deg, phi_deg },
            reference_white: cone.reference_white,
            directed: directed.collect(),
            solver: Solver { method: "adding", nodes, discretisation_error },
            warnings: &cone.warnings,
        }
    }
}

/// Writes `cone.csv`: one row per direction and state. Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_cone_csv(out: impl Write, cone: &ConeResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(["theta_deg", "phi_deg", "state"].iter().chain(&columns(cone)))?;
    for (j, phi) in cone.phi_deg.iter().enumerate() {
        for (i, theta) in cone.theta_deg.iter().enumerate() {
            let Some(view) = cone.view(i, j) else { continue };
            for (number, (name, state)) in cone.states.iter().zip(&view.states).enumerate() {
                let start = [theta.to_string(), phi.to_string(), name.clone()];
                let numbers = cone_quantities(view, state).into_iter().chain(error(cone, [i, j, number]));
                let numbers: Vec<String> = numbers
                    .map(|value| if value.is_finite() { value.to_string() } else { String::new() })
                    .collect();
                csv.write_record(start.iter().chain(&numbers))?;
            }
        }
    }
    csv.flush()
}

/// Writes `cone.npy`: float64, `[theta][phi][state][quantity]`, NaN where undefined.
///
/// # Errors
/// Those of `out`.
pub fn write_cone_npy(mut out: impl Write, cone: &ConeResult) -> io::Result<()> {
    let (thetas, phis) = (cone.theta_deg.len(), cone.phi_deg.len());
    let quantity_count = columns(cone).len();
    let mut values = Vec::with_capacity(thetas * phis * cone.states.len() * quantity_count);
    for i in 0..thetas {
        for j in 0..phis {
            let view = cone.view(i, j);
            for state in 0..cone.states.len() {
                let numbers = view.and_then(|view| Some(cone_quantities(view, view.states.get(state)?)));
                values.extend(
                    numbers
                        .unwrap_or([f64::NAN; CONE_QUANTITIES.len()])
                        .into_iter()
                        .chain(error(cone, [i, j, state])),
                );
            }
        }
    }
    let shape = [thetas, phis, cone.states.len(), quantity_count];
    write_npy(&mut out, &shape, Items::Double(&values))
}

/// Returns the names of the quantities: [`CONE_QUANTITIES`], and `error` if the user has permitted an error.
fn columns(cone: &ConeResult) -> Vec<&'static str> {
    let error = cone.row_errors.allowed.map(|_| "error");
    CONE_QUANTITIES.into_iter().chain(error).collect()
}

/// Returns the relative error at given indices of theta, phi and state, if the user has permitted an error;
/// NaN where the map has no value.
fn error(cone: &ConeResult, [theta, phi, state]: [usize; 3]) -> Option<f64> {
    cone.row_errors.allowed?;
    let direction = phi * cone.theta_deg.len() + theta;
    let is_known = cone.views.get(direction)?.states.get(state)?.reflectance_factor_y.is_finite();
    let error = cone.row_errors.relative.get(direction * cone.states.len() + state).copied();
    Some(error.filter(|_| is_known).unwrap_or(f64::NAN))
}

/// Returns the quantities in the order of [`CONE_QUANTITIES`]; NaN for those that are not defined.
pub fn cone_quantities(view: &ConeView, state: &ConeState) -> [f64; CONE_QUANTITIES.len()] {
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    [
        state.reflectance_factor_y,
        state.luminance_cd_m2,
        or_nan(state.u_prime),
        or_nan(state.v_prime),
        or_nan(state.uv_shift),
        or_nan(view.contrast_ratio),
        or_nan(view.gamut_percent_srgb),
        or_nan(view.gamut_percent_ebu),
        or_nan(state.lab.map(|lab| lab.l)),
        or_nan(state.lab.map(|lab| lab.a)),
        or_nan(state.lab.map(|lab| lab.b)),
        or_nan(state.delta_e_2000),
        or_nan(state.delta_e_1976),
    ]
}

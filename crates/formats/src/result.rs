//! Output files of a run: `result.json`, `states.csv`, `spectra.csv`, `reflection.csv`.

use std::fmt::Write as _;
use std::io::{self, Write};

use papilio_display::Reflection;
use papilio_display::result::{Cam16, Ledger, LedgerError, RunResult, State, StateValues, View};
use schemars::JsonSchema;
use serde::Serialize;

/// Returns the JSON Schema of `result.json`.
pub fn result_schema() -> serde_json::Value {
    schemars::schema_for!(ResultFile<'_>).to_value()
}

/// Content of `result.json`: the scenario and its result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ResultFile<'a> {
    /// Version of the program.
    pub papilio: &'a str,
    /// The scenario with its defaults filled in.
    pub scenario: &'a serde_json::Value,
    /// SHA-256 of the scenario and the bytes of its files.
    pub hash: &'a str,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Notes on how the scenario was interpreted.
    pub notes: &'a [String],
    /// The result.
    #[serde(flatten)]
    pub result: &'a RunResult,
}

/// Writes `states.csv`: one row per view and state. Each scalar metric is followed by its standard error and, for results of
/// adding, its discretisation error (`Y`, `Y_se`, `Y_de`). Cells of undefined values are empty.
///
/// # Errors
/// Those of `out`.
pub fn write_states(out: impl Write, result: &RunResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let (titles, rows) = state_table(result);
    csv.write_record(&titles)?;
    rows.iter().try_for_each(|row| csv.write_record(row))?;
    csv.flush()
}

/// Returns the column titles and the rows of `states.csv`.
pub(crate) fn state_table(result: &RunResult) -> (Vec<String>, Vec<Vec<String>>) {
    let (mut titles, mut rows) = (Vec::new(), Vec::new());
    for view in &result.views {
        for (name, state) in view.states.iter() {
            let cells;
            (titles, cells) = scalars(view, name, state).into_iter().unzip();
            rows.push(cells);
        }
    }
    (titles, rows)
}

/// Writes `spectra.csv`: one row per view, state and wavelength.
///
/// # Errors
/// Those of `out`.
pub fn write_spectra(out: impl Write, result: &RunResult) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let mut has_header = false;
    let wavelengths: Vec<String> = result.wavelength_nm.iter().map(f64::to_string).collect();
    // There are so many cells that text of its own for each would take most of the time.
    let mut cell = String::new();
    for view in &result.views {
        let angles = [view.theta_deg.to_string(), view.phi_deg.to_string()];
        for (name, state) in view.states.iter() {
            let columns = spectra(state);
            if !has_header {
                let places = ["theta_deg", "phi_deg", "state", "wavelength_nm"].map(str::to_owned);
                csv.write_record(places.iter().chain(columns.iter().map(|(title, _)| title)))?;
                has_header = true;
            }
            for (i, nm) in wavelengths.iter().enumerate() {
                [angles[0].as_str(), angles[1].as_str(), name, nm.as_str()]
                    .into_iter()
                    .try_for_each(|text| csv.write_field(text))?;
                for (_, column) in &columns {
                    cell.clear();
                    push_number(&mut cell, column.get(i).copied());
                    csv.write_field(&cell)?;
                }
                csv.write_record(None::<&[u8]>)?;
            }
        }
    }
    csv.flush()
}

/// Returns the spectra of a state, each followed by its errors: `radiance`, `radiance_se`, ...
fn spectra(state: &State) -> Vec<(String, &[f64])> {
    let all = [
        ("", Some(&state.value)),
        ("_se", Some(&state.standard_error)),
        ("_de", state.discretisation_error.as_ref()),
    ];
    let all = all.map(|(end, values)| (end, values.map(spectra_of).unwrap_or_default()));
    let interleaved = (0..all[0].1.len()).flat_map(|k| {
        let one = all.iter().filter_map(move |(end, spectra)| Some((end, spectra.get(k)?)));
        one.map(|(end, (title, spectrum))| (format!("{title}{end}"), *spectrum))
    });
    interleaved.collect()
}

fn spectra_of(values: &StateValues) -> Vec<(String, &[f64])> {
    let mut all = vec![
        ("radiance".to_owned(), &values.radiance[..]),
        ("reflectance_factor".to_owned(), values.reflectance_factor.as_deref().unwrap_or_default()),
    ];
    if let Some(by_light) = &values.by_light {
        all.push(("R_hemi".to_owned(), by_light.R_hemi.as_deref().unwrap_or_default()));
        for (title, group) in [("R_dir", &by_light.R_dir), ("R_environment", &by_light.R_environment)] {
            let spectra = group.iter().map(|one| one.as_deref().unwrap_or_default()).enumerate();
            all.extend(spectra.map(|(i, spectrum)| (format!("{title}_{i}"), spectrum)));
        }
    }
    all
}

/// Writes `reflection.csv`: the reflection of a beam by each state, by inclination of the beam, and by its azimuth where the display depends
/// on it.
///
/// # Errors
/// Those of `out`.
pub fn write_reflection(out: impl Write, all: &[Reflection]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    let is_azimuthal = all.iter().any(|one| one.phi_deg.is_some());
    let titles =
        ["theta_deg", "phi_deg", "state", "returned", "mirror", "haze", "lambertian", "beyond_2_5_deg"];
    csv.write_record(titles.into_iter().filter(|title| is_azimuthal || *title != "phi_deg"))?;
    for one in all {
        for state in &one.states {
            let numbers = [state.returned, state.mirror, state.haze, state.lambertian].map(Some);
            let cells = numbers.into_iter().chain([state.beyond_straight]).map(cell);
            let light =
                [Some(one.theta_deg), one.phi_deg].into_iter().flatten().map(|angle| angle.to_string());
            csv.write_record(light.chain([state.name.clone()]).chain(cells))?;
        }
    }
    csv.flush()
}

/// Formats a number such that reading it returns the same bits; empty for a number that is undefined or not finite.
pub(crate) fn cell(value: Option<f64>) -> String {
    let mut text = String::new();
    push_number(&mut text, value);
    text
}

/// Appends a number in the format of [`cell`].
fn push_number(text: &mut String, value: Option<f64>) {
    match value.filter(|value| value.is_finite()) {
        // Most errors are exactly 0.
        Some(value) if value.to_bits() == 0 => text.push('0'),
        // Writing to a string does not fail.
        Some(value) => drop(write!(text, "{value}")),
        None => {}
    }
}

type Columns = Vec<(String, String)>;

fn scalars(view: &View, name: &str, state: &State) -> Columns {
    let mut columns: Columns = vec![
        ("theta_deg".to_owned(), view.theta_deg.to_string()),
        ("phi_deg".to_owned(), view.phi_deg.to_string()),
        ("state".to_owned(), name.to_owned()),
    ];
    let errors =
        [Some(&state.standard_error), state.discretisation_error.as_ref()].map(|e| e.map(state_metrics));
    let error = |which: usize, k: usize| errors[which].as_ref()?.get(k)?.1;
    let mut numbers: Vec<(String, [Option<f64>; 3])> = state_metrics(&state.value)
        .into_iter()
        .enumerate()
        .map(|(k, (title, value))| (title, [value, error(0, k), error(1, k)]))
        .collect();
    numbers.extend(view_metrics(view));
    numbers.extend(view.ledger.get(name).into_iter().flat_map(ledger_fractions));
    for (title, [value, standard, discretisation]) in numbers {
        columns.push((title.clone(), cell(value)));
        columns.push((format!("{title}_se"), cell(standard)));
        if view.discretisation_error.is_some() {
            columns.push((format!("{title}_de"), cell(discretisation)));
        }
    }
    columns
}

/// Returns the metrics of a view (those that combine states) and their errors.
fn view_metrics(view: &View) -> impl Iterator<Item = (String, [Option<f64>; 3])> + use<> {
    let discretisation = view.discretisation_error.unwrap_or_default();
    let errors = view.standard_error.named().zip(discretisation.named());
    let all = view.metrics.named().zip(errors);
    all.map(|((title, value), ((_, standard), (_, coarse)))| (title.to_owned(), [value, standard, coarse]))
}

/// Returns the fractions of an energy balance and their errors.
fn ledger_fractions(ledger: &Ledger) -> [(String, [Option<f64>; 3]); 7] {
    let [values, standard] = [&ledger.values(), &ledger.standard_error].map(LedgerError::named);
    let discretisation = ledger.discretisation_error.as_ref().map(LedgerError::named);
    std::array::from_fn(|k| {
        let (title, value) = values[k];
        let coarse = discretisation.as_ref().map(|all| all[k].1);
        (format!("ledger_{title}"), [Some(value), Some(standard[k].1), coarse])
    })
}

fn state_metrics(v: &StateValues) -> Vec<(String, Option<f64>)> {
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
    let looks = v.cam16.iter().flat_map(Cam16::named);
    let looks = looks.map(|(title, value)| (format!("cam16_{title}"), value));
    let alone = std::iter::once(("R_hemi".to_owned(), v.R_hemi));
    let alone = alone.chain(v.R_dir.iter().enumerate().map(|(i, y)| (format!("R_dir_{i}"), *y)));
    let environments = v.R_environment.iter().enumerate();
    let alone = alone.chain(environments.map(|(i, y)| (format!("R_environment_{i}"), *y)));
    let directed = v.terms.directed.iter().enumerate().map(|(i, y)| (format!("Y_directed_{i}"), Some(*y)));
    let environment =
        v.terms.environment.iter().enumerate().map(|(i, y)| (format!("Y_environment_{i}"), Some(*y)));
    let front_light = v.terms.front_light.map(|y| ("Y_front_light".to_owned(), Some(y)));
    let specular = v.specular.iter().enumerate().map(|(i, y)| (format!("specular_{i}"), Some(*y)));
    fixed
        .into_iter()
        .chain(v.metrics.named())
        .map(|(title, value)| (title.to_owned(), value))
        .chain(looks)
        .chain(alone)
        .chain(directed)
        .chain(environment)
        .chain(front_light)
        .chain(specular)
        .collect()
}

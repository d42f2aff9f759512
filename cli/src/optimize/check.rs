//! The best design computed by the Monte Carlo solver too, which shares no integration with adding.

use papilio_design::search::{Search, SelectedDesign};
use papilio_display::scene::{Method, Stop};
use serde_json::{Value, json};

use crate::Failure;
use crate::run::with_progress;

/// Relative standard error of Y by the Monte Carlo solver.
const RELATIVE_ERROR: f64 = 0.001;

/// A quantity computed by both solvers.
pub(super) struct SolverComparison {
    name: String,
    adding: Option<f64>,
    monte_carlo: Option<f64>,
    /// Standard error of the Monte Carlo result, if it is known.
    standard_error: Option<f64>,
}

impl SolverComparison {
    pub(super) fn json(&self) -> Value {
        json!({ "name": self.name, "adding": self.adding, "walk": self.monte_carlo, "standard_error": self.standard_error })
    }

    /// Row of the table on the terminal.
    pub(super) fn row(&self) -> Vec<String> {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), crate::report::digits);
        vec![
            papilio_scenario::label(&self.name).to_string(),
            number(self.adding),
            number(self.monte_carlo),
            number(self.standard_error),
        ]
    }
}

/// Computes a design by the Monte Carlo solver under every condition; `None` if interrupted.
pub(super) fn check(
    search: &Search,
    best: &SelectedDesign,
    threads: Option<u16>,
) -> Result<Option<Vec<SolverComparison>>, Failure> {
    let study = search.study();
    let values = study.values(&best.design)?;
    let mut results = Vec::new();
    for condition in &study.conditions {
        let resolved = condition.varied.scenario(&values)?.resolve()?;
        let mut scene = resolved.scene.clone();
        scene.solver.method = Method::MonteCarlo;
        scene.solver.stop = Stop::RelativeError { target: RELATIVE_ERROR, per_wavelength: false };
        match with_progress(&resolved, threads, |control| papilio_display::run(&scene, control))? {
            Some(result) if !result.solver.interrupted => results.push(result),
            _ => return Ok(None),
        }
    }
    let checked = study.quantities.iter().zip(&best.values).map(|(quantity, adding)| SolverComparison {
        name: quantity.name.clone(),
        adding: *adding,
        monte_carlo: quantity.quantity.of(&results[quantity.condition]),
        standard_error: quantity.quantity.standard_error(&results[quantity.condition]),
    });
    Ok(Some(checked.collect()))
}

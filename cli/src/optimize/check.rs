//! The best design computed by the Monte Carlo solver too, which shares no integration with adding.

use papilio_design::NamedQuantity;
use papilio_design::search::{Search, SelectedDesign};
use papilio_display::result::RunResult;
use papilio_display::scene::{Method, MetricSource, Stop};
use serde_json::{Value, json};

use crate::run::with_progress;
use crate::{Failure, print_message};

/// Relative standard error of Y by the Monte Carlo solver.
const RELATIVE_ERROR: f64 = 0.001;

/// Contrast to black below which a note mentions a state.
const LEAST_CONTRAST: f64 = 1.5;

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
        let number = |value: Option<f64>| value.map_or("-".to_owned(), crate::numbers::digits);
        vec![
            papilio_scenario::label(&self.name).to_string(),
            number(self.adding),
            number(self.monte_carlo),
            number(self.standard_error),
        ]
    }
}

/// Prints a note on the states that are hardly brighter than black, under any condition and in any view.
fn note_dark_states(results: &[RunResult]) {
    let mut dark: Vec<(&str, f64)> = Vec::new();
    for view in results.iter().flat_map(|result| &result.views) {
        for (name, state) in view.states.iter().filter(|(name, _)| *name != "black") {
            let Some(contrast) = state.value.contrast.filter(|contrast| *contrast < LEAST_CONTRAST) else {
                continue;
            };
            match dark.iter_mut().find(|(known, _)| *known == name) {
                Some((_, least)) => *least = least.min(contrast),
                None => dark.push((name, contrast)),
            }
        }
    }
    if let Some((first, _)) = dark.first() {
        let all: Vec<String> = dark.iter().map(|(name, contrast)| format!("{name} {contrast:.2}")).collect();
        print_message(&format!(
            "note: states of the best design that are hardly brighter than black, with their contrast to it: {}\n  = help: a constraint \
             prevents this: metric = \"{first}.contrast\", at_least = 2",
            all.join(", ")
        ));
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
    note_dark_states(&results);
    // Sharpness and sparkle are not computed by a run.
    let of_colours =
        |(quantity, _): &(&NamedQuantity, _)| quantity.quantity.source() == MetricSource::Colours;
    let checked = study.quantities.iter().zip(&best.values).filter(of_colours);
    let checked = checked.map(|(quantity, adding)| SolverComparison {
        name: quantity.name.clone(),
        adding: *adding,
        monte_carlo: quantity.quantity.of(&results[quantity.condition]),
        standard_error: quantity.quantity.standard_error(&results[quantity.condition]),
    });
    Ok(Some(checked.collect()))
}

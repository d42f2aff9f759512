//! The best design computed by the Monte Carlo solver too, which shares no integration with adding.

use papilio_design::NamedQuantity;
use papilio_design::search::{Search, SelectedDesign};
use papilio_display::result::RunResult;
use papilio_display::scene::{Method, MetricSource, Stop};
use papilio_display::spatial::{crosstalk, mtf};
use papilio_display::{Control, DisplayError};
use serde_json::{Value, json};

use crate::run::with_progress;
use crate::{Failure, print_message};

/// Relative standard error of Y by the Monte Carlo solver.
const RELATIVE_ERROR: f64 = 0.001;

/// Number of paths of a view with which its sharpness and crosstalk are computed.
const PATHS_WITH_PLACES: u64 = 1 << 20;

/// Why metrics of sparkle have no second solver here.
const SPARKLE: &str = "metrics of sparkle are those of random faces in any case; their standard errors are in sparkle.json of best.toml";

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
    /// Compares a value with value and standard error of the Monte Carlo solver.
    fn new(of: &NamedQuantity, adding: Option<f64>, [monte_carlo, standard_error]: [Option<f64>; 2]) -> Self {
        Self { name: of.name.clone(), adding, monte_carlo, standard_error }
    }

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

/// Computes a design by the Monte Carlo solver under every condition; `None` if interrupted. What that solver does not cover is
/// named in a note.
pub(super) fn check(
    search: &Search,
    best: &SelectedDesign,
    threads: Option<u16>,
) -> Result<Option<Vec<SolverComparison>>, Failure> {
    let study = search.study();
    let values = study.values(&best.design)?;
    let (mut results, mut compared) = (Vec::new(), Vec::new());
    for (number, condition) in study.conditions.iter().enumerate() {
        let resolved = condition.varied.scenario(&values)?.resolve()?;
        let mut scene = resolved.scene.clone();
        scene.solver.method = Method::MonteCarlo;
        let own = |source: MetricSource| {
            let own = study.quantities.iter().zip(&best.values);
            own.filter(move |(one, _)| one.condition == number && one.quantity.source() == source)
        };
        scene.solver.stop = Stop::RelativeError { target: RELATIVE_ERROR, per_wavelength: false };
        let run = |control: &Control<'_>| covered(papilio_display::run(&scene, control));
        let Some(result) = with_progress(&resolved, threads, run)? else { return Ok(None) };
        if let Some(result) = noted(result, own(MetricSource::Colours)) {
            if result.solver.interrupted {
                return Ok(None);
            }
            compared.extend(own(MetricSource::Colours).map(|(one, adding)| {
                let both = [one.quantity.of(&result), one.quantity.standard_error(&result)];
                SolverComparison::new(one, *adding, both)
            }));
            results.push(result);
        }
        if own(MetricSource::Mtf).next().is_some() {
            scene.solver.stop = Stop::Paths(PATHS_WITH_PLACES);
            let mtf = |control: &Control<'_>| covered(mtf(&scene, &resolved.patterns, control));
            let Some(result) = with_progress(&resolved, threads, mtf)? else { return Ok(None) };
            if let Some(result) = noted(result, own(MetricSource::Mtf)) {
                compared.extend(own(MetricSource::Mtf).map(|(one, adding)| {
                    SolverComparison::new(one, *adding, one.quantity.of_sharpness(&result))
                }));
            }
        }
        if own(MetricSource::Crosstalk).next().is_some() {
            scene.solver.stop = Stop::Paths(PATHS_WITH_PLACES);
            let text = &resolved.patterns.text;
            let shares = |control: &Control<'_>| covered(crosstalk(&scene, text, control));
            let Some(result) = with_progress(&resolved, threads, shares)? else { return Ok(None) };
            if let Some(result) = noted(result, own(MetricSource::Crosstalk)) {
                compared.extend(own(MetricSource::Crosstalk).map(|(one, adding)| {
                    SolverComparison::new(one, *adding, one.quantity.of_crosstalk(&result))
                }));
            }
        }
        let names: Vec<&str> = own(MetricSource::Sparkle).map(|(one, _)| one.name.as_str()).collect();
        if !names.is_empty() {
            print_message(&format!(
                "note: not checked by the Monte Carlo solver: {}\n  = help: {SPARKLE}",
                names.join(", ")
            ));
        }
        let names: Vec<&str> = own(MetricSource::Image).map(|(one, _)| one.name.as_str()).collect();
        if !names.is_empty() {
            print_message(&format!(
                "note: pictures are not checked by the Monte Carlo solver: {}",
                names.join(", ")
            ));
        }
    }
    note_dark_states(&results);
    let order = |one: &SolverComparison| study.quantities.iter().position(|known| known.name == one.name);
    compared.sort_by_key(order);
    Ok(Some(compared))
}

/// Result of a display, or what the Monte Carlo solver does not cover.
type Covered<T> = Result<T, DisplayError>;

/// Keeps the error of a display that is not covered as a result.
fn covered<T>(result: Result<T, DisplayError>) -> Result<Covered<T>, DisplayError> {
    match result {
        Err(error @ DisplayError::PlacesNotComputed { .. }) => Ok(Err(error)),
        other => other.map(Ok),
    }
}

/// Returns the result; prints a note instead if quantities are wanted of it and it is not covered.
fn noted<'a, T>(
    result: Covered<T>,
    mut wanted: impl Iterator<Item = (&'a NamedQuantity, &'a Option<f64>)>,
) -> Option<T> {
    match result {
        Ok(result) => Some(result),
        Err(error) => {
            if wanted.next().is_some() {
                print_message(&format!(
                    "note: the best design is not checked by the Monte Carlo solver: {error}"
                ));
            }
            None
        }
    }
}

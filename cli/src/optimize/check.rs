//! The selected designs computed by the Monte Carlo solver too, which shares no integration with adding, to
//! the scenario's own target.

use papilio_design::search::{Search, SelectedDesign};
use papilio_design::{NamedQuantity, Study};
use papilio_display::gloss::gloss;
use papilio_display::result::RunResult;
use papilio_display::scene::{Method, MetricSource};
use papilio_display::spatial::{crosstalk, mtf};
use papilio_display::{Control, DisplayError};
use serde_json::{Value, json};

use super::SEARCH;
use crate::progress::{Computation, FractionBar};
use crate::{Failure, print_message};

/// Why metrics of sparkle have no second solver here.
const SPARKLE: &str = "metrics of sparkle are those of random faces in any case; their standard errors are in sparkle.json of best.toml";

/// Contrast to black below which a note mentions a state.
const LEAST_CONTRAST: f64 = 1.5;

/// A quantity computed by both solvers.
pub(super) struct SolverComparison {
    /// Number of the design, from 1.
    pub(super) design: usize,
    name: String,
    adding: Option<f64>,
    monte_carlo: Option<f64>,
    /// Standard error of the Monte Carlo result, if it is known.
    standard_error: Option<f64>,
}

impl SolverComparison {
    /// Compares a value with value and standard error of the Monte Carlo solver.
    fn new(
        design: usize,
        (of, adding): (&NamedQuantity, &Option<f64>),
        [monte_carlo, standard_error]: [Option<f64>; 2],
    ) -> Self {
        Self { design, name: of.name.clone(), adding: *adding, monte_carlo, standard_error }
    }

    pub(super) fn json(&self) -> Value {
        json!({ "design": self.design, "name": self.name, "adding": self.adding, "walk": self.monte_carlo, "standard_error": self.standard_error })
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

/// Computes the selected designs by the Monte Carlo solver under every condition, to the target of the
/// scenario; `None` if interrupted. What that solver does not cover is named in a note.
pub(super) fn check(
    search: &Search,
    chosen: &[SelectedDesign],
    threads: Option<u16>,
    bar: FractionBar,
) -> Result<Option<Vec<SolverComparison>>, Failure> {
    let study = search.study();
    let is_of = |source: MetricSource| study.quantities.iter().any(|one| one.quantity.source() == source);
    if chosen.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let parts =
        chosen.len() * study.conditions.len() * BY_PATHS.iter().filter(|source| is_of(**source)).count();
    let mut check = Check {
        study,
        computation: Computation::after(SEARCH, bar, &vec![1.0; parts]),
        threads,
        compared: Vec::new(),
        uncovered: Vec::new(),
    };
    let mut results = Vec::new();
    for (number, design) in chosen.iter().enumerate() {
        for condition in 0..study.conditions.len() {
            match check.design(number + 1, design, condition)? {
                Some(result) => results.extend(result.filter(|_| number == 0)),
                None => return Ok(None),
            }
        }
    }
    let Check { computation, mut compared, uncovered, .. } = check;
    drop(computation);
    let which = if chosen.len() == 1 { "the best design is" } else { "the designs are" };
    for error in uncovered {
        print_message(&format!("note: {which} not checked by the Monte Carlo solver: {error}"));
    }
    note_other_sources(study);
    note_dark_states(&results);
    let order = |one: &SolverComparison| {
        (one.design, study.quantities.iter().position(|known| known.name == one.name))
    };
    compared.sort_by_key(order);
    Ok(Some(compared))
}

/// What the Monte Carlo solver computes, in this order.
const BY_PATHS: [MetricSource; 4] =
    [MetricSource::Colours, MetricSource::Mtf, MetricSource::Crosstalk, MetricSource::Gloss];

/// A check of designs.
struct Check<'a> {
    study: &'a Study,
    computation: Computation,
    threads: Option<u16>,
    compared: Vec<SolverComparison>,
    /// What the solver does not cover, each once.
    uncovered: Vec<String>,
}

impl Check<'_> {
    /// Compares a design under a condition. Returns the result of a run, if the solver covers it; `None` if
    /// interrupted.
    fn design(
        &mut self,
        number: usize,
        design: &SelectedDesign,
        condition: usize,
    ) -> Result<Option<Option<RunResult>>, Failure> {
        let study = self.study;
        let resolved =
            study.conditions[condition].varied.scenario(&study.values(&design.design)?)?.resolve()?;
        let mut scene = resolved.scene.clone();
        scene.solver.method = Method::MonteCarlo;
        let own = |source: MetricSource| {
            let own = study.quantities.iter().zip(&design.values);
            own.filter(move |(one, _)| one.condition == condition && one.quantity.source() == source)
        };
        let mut of_run = None;
        for source in BY_PATHS {
            if own(source).next().is_none() {
                continue;
            }
            let (patterns, threads) = (&resolved.patterns, self.threads);
            let compared = match source {
                MetricSource::Mtf => {
                    let one = |control: &Control<'_>| covered(mtf(&scene, patterns, control));
                    let Some(result) = self.computation.part(&resolved, threads, one)? else {
                        return Ok(None);
                    };
                    result.map(|result| {
                        own(source)
                            .map(|one| {
                                SolverComparison::new(number, one, one.0.quantity.of_sharpness(&result))
                            })
                            .collect::<Vec<_>>()
                    })
                }
                MetricSource::Crosstalk => {
                    let one = |control: &Control<'_>| covered(crosstalk(&scene, &patterns.text, control));
                    let Some(result) = self.computation.part(&resolved, threads, one)? else {
                        return Ok(None);
                    };
                    result.map(|result| {
                        own(source)
                            .map(|one| {
                                SolverComparison::new(number, one, one.0.quantity.of_crosstalk(&result))
                            })
                            .collect()
                    })
                }
                MetricSource::Gloss => {
                    let one = |control: &Control<'_>| covered(gloss(&scene, control));
                    let Some(result) = self.computation.part(&resolved, threads, one)? else {
                        return Ok(None);
                    };
                    result.map(|result| {
                        own(source)
                            .map(|one| SolverComparison::new(number, one, one.0.quantity.of_gloss(&result)))
                            .collect()
                    })
                }
                _ => {
                    let one = |control: &Control<'_>| covered(papilio_display::run(&scene, control));
                    let Some(result) = self.computation.part(&resolved, threads, one)? else {
                        return Ok(None);
                    };
                    if result.as_ref().is_ok_and(|result| result.solver.interrupted) {
                        return Ok(None);
                    }
                    result.map(|result| {
                        let both = |one: &NamedQuantity| {
                            [one.quantity.of(&result), one.quantity.standard_error(&result)]
                        };
                        let compared =
                            own(source).map(|one| SolverComparison::new(number, one, both(one.0))).collect();
                        of_run = Some(result);
                        compared
                    })
                }
            };
            match compared {
                Ok(compared) => self.compared.extend(compared),
                Err(error) => {
                    let error = error.to_string();
                    if !self.uncovered.contains(&error) {
                        self.uncovered.push(error);
                    }
                }
            }
        }
        Ok(Some(of_run))
    }
}

/// Prints a note on the metrics that the Monte Carlo solver does not compute here.
fn note_other_sources(study: &Study) {
    let names = |source: MetricSource| -> Vec<&str> {
        let own = study.quantities.iter().filter(|one| one.quantity.source() == source);
        own.map(|one| one.name.as_str()).collect()
    };
    let sparkle = names(MetricSource::Sparkle);
    if !sparkle.is_empty() {
        print_message(&format!(
            "note: not checked by the Monte Carlo solver: {}\n  = help: {SPARKLE}",
            sparkle.join(", ")
        ));
    }
    let image = names(MetricSource::Image);
    if !image.is_empty() {
        print_message(&format!(
            "note: pictures are not checked by the Monte Carlo solver: {}",
            image.join(", ")
        ));
    }
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

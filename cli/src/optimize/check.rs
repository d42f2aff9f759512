//! The best design once more by the walk: the other solver, which shares nothing that integrates.

use papilio_design::search::{Chosen, Search};
use papilio_display::scene::{Method, Stop};
use serde_json::{Value, json};

use crate::Failure;
use crate::run::with_progress;

/// The walk's relative error of Y.
const RELATIVE_ERROR: f64 = 0.001;

/// A quantity by both solvers.
pub(super) struct Checked {
    name: String,
    adding: Option<f64>,
    walk: Option<f64>,
    /// One sigma of the walk's, where it is known.
    error: Option<f64>,
}

impl Checked {
    pub(super) fn json(&self) -> Value {
        json!({ "name": self.name, "adding": self.adding, "walk": self.walk, "standard_error": self.error })
    }

    /// A line of the table.
    pub(super) fn row(&self) -> Vec<String> {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), crate::report::digits);
        vec![self.name.clone(), number(self.adding), number(self.walk), number(self.error)]
    }
}

/// Runs a design by the walk under every condition; `None` if interrupted.
pub(super) fn check(
    search: &Search,
    best: &Chosen,
    threads: Option<u16>,
) -> Result<Option<Vec<Checked>>, Failure> {
    let study = search.study();
    let values = study.values(&best.design)?;
    let mut results = Vec::new();
    for condition in &study.conditions {
        let resolved = condition.varied.scenario(&values)?.resolve()?;
        let mut scene = resolved.scene.clone();
        scene.solver.method = Method::Walk;
        scene.solver.stop = Stop::RelativeError { target: RELATIVE_ERROR, every_bin: false };
        match with_progress(&resolved, threads, |control| papilio_display::run(&scene, control))? {
            Some(result) if !result.solver.interrupted => results.push(result),
            _ => return Ok(None),
        }
    }
    let checked = study.quantities.iter().zip(&best.values).map(|(one, adding)| Checked {
        name: one.name.clone(),
        adding: *adding,
        walk: one.quantity.of(&results[one.condition]),
        error: one.quantity.standard_error(&results[one.condition]),
    });
    Ok(Some(checked.collect()))
}

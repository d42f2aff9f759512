//! Report of a search: the contents of `papilio optimize --json`, without the check by the other solver.

use std::collections::BTreeMap;

use papilio_scenario::SearchRange;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

use crate::search::{Search, SearchResult, SelectedDesign};

/// Report of a search.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SearchReport {
    /// Version of the program.
    pub papilio: String,
    /// Title of the scenario.
    pub title: String,
    /// SHA-256 of all inputs of the search.
    pub search: String,
    /// Warnings of the scenario and its conditions.
    pub warnings: Vec<String>,
    /// Notes on how the scenario was interpreted.
    pub notes: Vec<String>,
    /// Number of evaluated designs.
    pub evaluations: usize,
    /// Names of the objectives.
    pub objectives: Vec<String>,
    /// The scenario's own design.
    pub scenario: OwnDesign,
    /// The best design, or those of the Pareto front.
    pub designs: Vec<DesignReport>,
}

/// The scenario's own design.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct OwnDesign {
    /// Values of the varied keys.
    pub set: BTreeMap<String, Value>,
    /// Metrics; null where undefined.
    pub quantities: BTreeMap<String, Option<f64>>,
}

/// A design of the result.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct DesignReport {
    /// Values of the varied keys.
    pub set: BTreeMap<String, Value>,
    /// Names of the variables that are at an end of their range.
    pub at_end: Vec<String>,
    /// Metrics; null where undefined.
    pub quantities: BTreeMap<String, Option<f64>>,
    /// Whether it satisfies the constraints.
    pub meets_limits: bool,
    /// Largest relative violation of the constraints.
    pub missed: f64,
}

impl SearchReport {
    /// Creates the report of the designs that a search selected.
    pub fn new(title: &str, search: &Search, results: &[SearchResult], selected: &[SelectedDesign]) -> Self {
        let (own, own_values) = search.own();
        let design = |one: &SelectedDesign| DesignReport {
            set: settings(search, &one.design),
            at_end: at_end(search, &one.design),
            quantities: quantities(search, &one.values),
            meets_limits: one.meets_limits(),
            missed: one.missed,
        };
        Self {
            papilio: env!("CARGO_PKG_VERSION").to_owned(),
            title: title.to_owned(),
            search: search.spec().hash.clone(),
            warnings: search.spec().warnings.clone(),
            notes: search.spec().notes.clone(),
            evaluations: results.iter().map(|one| one.evaluations).sum(),
            objectives: search.spec().objectives.iter().map(|one| one.name.clone()).collect(),
            scenario: OwnDesign { set: settings(search, own), quantities: quantities(search, own_values) },
            designs: selected.iter().map(design).collect(),
        }
    }
}

/// Values of the varied keys of a design.
fn settings(search: &Search, design: &[f64]) -> BTreeMap<String, Value> {
    let settings = search.study().settings(design).unwrap_or_default();
    settings.into_iter().map(|(path, value)| (path.to_owned(), value)).collect()
}

/// Metrics of a design by name; null where undefined.
pub fn quantities(search: &Search, values: &[Option<f64>]) -> BTreeMap<String, Option<f64>> {
    let names = search.study().quantities.iter().map(|one| one.name.clone());
    names.zip(values.iter().copied()).collect()
}

/// Returns whether a variable is at an end of its range, within the precision of a design.
pub fn is_at_end(search: &Search, index: usize, x: f64) -> bool {
    match search.spec().variables[index].range {
        SearchRange::Bounds(from, to) => (x - from).min(to - x) <= 1e-6 * (to - from),
        SearchRange::Choices(_) => false,
    }
}

fn at_end(search: &Search, design: &[f64]) -> Vec<String> {
    let ends = design.iter().enumerate().filter(|(index, x)| is_at_end(search, *index, **x));
    ends.map(|(index, _)| search.spec().variables[index].name.clone()).collect()
}

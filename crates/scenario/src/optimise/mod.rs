//! Searches: a scenario with the variables, conditions, objectives and constraints of its `[optimize]`.

mod quantities;
pub(crate) mod read;

use papilio_display::Quantity;
use serde_json::Value as Json;

use crate::varied::{ParameterisedScenario, read_of_scenarios};

/// A search, read and checked: every bound and every choice gives a valid scenario.
#[derive(Debug, Clone)]
pub struct Optimisation {
    /// Method of the search.
    pub method: SearchMethod,
    /// Number of gradient searches for each combination of choices.
    pub starts: usize,
    /// Seed of the starting points and of the population.
    pub seed: u64,
    /// Largest number of evaluations of one search.
    pub evaluations: usize,
    /// Number of searches along a Pareto front.
    pub points: usize,
    /// Variables.
    pub variables: Vec<SearchVariable>,
    /// Conditions of use, at least one.
    pub conditions: Vec<SearchCondition>,
    /// Objectives, at least one.
    pub objectives: Vec<SearchObjective>,
    /// Limits that every design must satisfy.
    pub constraints: Vec<SearchConstraint>,
    /// Title of the scenario.
    pub title: Option<String>,
    /// SHA-256 of the search, of the scenarios of its conditions, and of their files.
    pub hash: String,
    /// Warnings of the scenario, then those that only its conditions have.
    pub warnings: Vec<String>,
    /// One note for each old name of a key or a value.
    pub notes: Vec<String>,
}

/// Method of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchMethod {
    /// By derivatives, from many starting points.
    Gradient,
    /// By a population.
    Global,
    /// By a population first, then by derivatives from its result.
    Both,
}

/// A variable: a number or a choice.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchVariable {
    /// Name: the first path.
    pub name: String,
    /// Keys that it sets.
    pub keys: Vec<Key>,
    /// Possible values.
    pub range: SearchRange,
    /// Value of the scenario, if it is in the range: a number, or the index of a choice.
    pub own: Option<f64>,
}

/// A key of the scenario that a variable x sets to `slope * x + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Path of the key, in the syntax of `--set`.
    pub path: String,
    /// Slope: 1 as a rule; -1 if the key compensates for another one (`compensated_by`).
    pub slope: f64,
    /// Offset: 0 as a rule.
    pub offset: f64,
}

impl Key {
    /// Key that takes the variable's number unchanged.
    pub fn plain(path: impl Into<String>) -> Self {
        Self { path: path.into(), slope: 1.0, offset: 0.0 }
    }
}

/// Possible values of a variable.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchRange {
    /// A number between two bounds.
    Bounds(f64, f64),
    /// One of several values.
    Choices(Vec<Json>),
}

/// A condition of use: a light, a view or any other keys.
#[derive(Debug, Clone)]
pub struct SearchCondition {
    /// Name; empty if there is only one.
    pub name: String,
    /// Weight in objectives without a condition.
    pub weight: f64,
    /// The scenario under this condition; its paths are those of all variables, in order.
    pub varied: ParameterisedScenario,
}

/// A quantity under a condition, with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedQuantity {
    /// Name in tables and messages: `white.Y (sun)`.
    pub name: String,
    /// Index of the condition, from 0.
    pub condition: usize,
    /// The quantity.
    pub quantity: Quantity,
}

/// An objective: a weighted mean of quantities.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchObjective {
    /// Name in tables.
    pub name: String,
    /// Quantities with their weights, which sum to 1.
    pub parts: Vec<(f64, NamedQuantity)>,
    /// Aim of the objective.
    pub aim: SearchAim,
}

/// Aim of an objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SearchAim {
    /// Larger is better.
    Maximise,
    /// Smaller is better.
    Minimise,
    /// Closer to this value is better.
    Target(f64),
}

/// A constraint: limits of a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchConstraint {
    /// The limited quantity.
    pub quantity: NamedQuantity,
    /// Lower limit.
    pub at_least: Option<f64>,
    /// Upper limit.
    pub at_most: Option<f64>,
}

// Each bound and each choice, with all other keys unchanged, is a valid scenario.
read_of_scenarios!(Optimisation: "an `[optimize]`", read::search);

impl Optimisation {
    /// Returns the quantities of all objectives and constraints, each once.
    pub fn quantities(&self) -> Vec<&NamedQuantity> {
        let of_objectives = self.objectives.iter().flat_map(|one| one.parts.iter().map(|(_, part)| part));
        let all = of_objectives.chain(self.constraints.iter().map(|one| &one.quantity));
        let mut found: Vec<&NamedQuantity> = Vec::new();
        for quantity in all {
            if !found.contains(&quantity) {
                found.push(quantity);
            }
        }
        found
    }
}

impl SearchVariable {
    /// Starting point of a search: the scenario's own value, or the centre of the range.
    pub fn start(&self) -> f64 {
        self.own.unwrap_or(match &self.range {
            SearchRange::Bounds(from, to) => 0.5 * (from + to),
            SearchRange::Choices(_) => 0.0,
        })
    }

    /// Returns each path with its value at `x`.
    pub fn values(&self, x: f64) -> Vec<(String, Json)> {
        let value = |slope: f64, offset: f64| match &self.range {
            SearchRange::Bounds(..) => (slope * x + offset).into(),
            SearchRange::Choices(choices) => choices.get(x as usize).cloned().unwrap_or_default(),
        };
        self.keys.iter().map(|key| (key.path.clone(), value(key.slope, key.offset))).collect()
    }
}

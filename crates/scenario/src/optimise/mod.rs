//! A scenario with an `[optimize]`: what may vary, under which conditions, and what is asked of a design.

mod asked;
mod read;

use papilio_display::Quantity;
use serde_json::Value as Json;

use crate::varied::{Varied, read_of_scenarios};

/// A search, read and checked: every bound and every choice is a scenario that can be.
#[derive(Debug, Clone)]
pub struct Optimisation {
    /// How it is searched.
    pub method: SearchMethod,
    /// Gradient searches of each combination of choices.
    pub starts: usize,
    /// Seed of whatever is drawn.
    pub seed: u64,
    /// Evaluations of one search, at most.
    pub evaluations: usize,
    /// Searches along a front.
    pub points: usize,
    /// What varies.
    pub variables: Vec<SearchVariable>,
    /// Under which conditions; at least one.
    pub conditions: Vec<SearchCondition>,
    /// What makes a design good; at least one.
    pub objectives: Vec<SearchObjective>,
    /// What every design has to meet.
    pub constraints: Vec<SearchConstraint>,
    /// The scenario's title.
    pub title: Option<String>,
    /// SHA-256 of all of it, of the scenarios of its conditions and of their files.
    pub hash: String,
}

/// How designs are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchMethod {
    /// By derivatives, from many starts.
    Gradient,
    /// By a population.
    Global,
    /// By a population first, and from there by derivatives.
    Both,
}

/// A number or a choice that varies.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchVariable {
    /// Its first path.
    pub name: String,
    /// The paths that it moves, each to `slope * x + offset`: path, slope and offset.
    pub keys: Vec<(String, f64, f64)>,
    /// What it may be.
    pub range: SearchRange,
    /// What the scenario says, if that is in the range: a number, or the number of a choice.
    pub own: Option<f64>,
}

/// What a variable may be.
#[derive(Debug, Clone, PartialEq)]
pub enum SearchRange {
    /// A number between these.
    Bounds(f64, f64),
    /// One of these.
    Choices(Vec<Json>),
}

/// A light, a view or anything else that every design has to do with.
#[derive(Debug, Clone)]
pub struct SearchCondition {
    /// Its name; empty if there is one alone.
    pub name: String,
    /// Weight in objectives without a condition.
    pub weight: f64,
    /// The scenario there; its paths are those of all variables, in order.
    pub varied: Varied,
}

/// Something that is asked under a condition.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchQuantity {
    /// For tables: `white.Y (sun)`.
    pub name: String,
    /// Which condition.
    pub condition: usize,
    /// What.
    pub quantity: Quantity,
}

/// What makes a design good: a mean.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchObjective {
    /// For tables.
    pub name: String,
    /// What it is the mean of, each with its weight; the weights sum to 1.
    pub parts: Vec<(f64, SearchQuantity)>,
    /// What is to become of it.
    pub aim: SearchAim,
}

/// What is to become of an objective.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SearchAim {
    /// The larger the better.
    Maximise,
    /// The smaller the better.
    Minimise,
    /// The nearer the better.
    Target(f64),
}

/// A limit.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchConstraint {
    /// Of what.
    pub quantity: SearchQuantity,
    /// No less.
    pub at_least: Option<f64>,
    /// No more.
    pub at_most: Option<f64>,
}

// Bounds and choices, each with all else as it stands, are scenarios that can be.
read_of_scenarios!(Optimisation: "an `[optimize]`", read::search);

impl Optimisation {
    /// Everything that is asked, each thing once.
    pub fn quantities(&self) -> Vec<&SearchQuantity> {
        let of_objectives = self.objectives.iter().flat_map(|one| one.parts.iter().map(|(_, part)| part));
        let all = of_objectives.chain(self.constraints.iter().map(|one| &one.quantity));
        let mut found: Vec<&SearchQuantity> = Vec::new();
        for quantity in all {
            if !found.contains(&quantity) {
                found.push(quantity);
            }
        }
        found
    }
}

impl SearchVariable {
    /// Where a search begins: at its own value, or at the middle of its range.
    pub fn start(&self) -> f64 {
        self.own.unwrap_or(match &self.range {
            SearchRange::Bounds(from, to) => 0.5 * (from + to),
            SearchRange::Choices(_) => 0.0,
        })
    }

    /// What it makes of its keys: each path with its value.
    pub fn values(&self, x: f64) -> Vec<(String, Json)> {
        let value = |slope: f64, offset: f64| match &self.range {
            SearchRange::Bounds(..) => (slope * x + offset).into(),
            SearchRange::Choices(choices) => choices.get(x as usize).cloned().unwrap_or_default(),
        };
        self.keys.iter().map(|(path, slope, offset)| (path.clone(), value(*slope, *offset))).collect()
    }
}

//! `[optimize]`: variables, conditions, objectives and constraints of a search.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use super::limits::MetricName;
use super::numbers::{Count, Seed, Share, Weight};
use super::sweep::Any;
use crate::error::Errors;
use crate::grammar::{choice, forms, table};
use crate::mistake;
use crate::optimise::SearchMethod;
use crate::path::{KeyPath, below};
use crate::read::{Read, Spanned};
use crate::set::Change;
use crate::tree::{Node, Value};
use crate::word::Word;

table! {
    /// A search for better designs, for `papilio optimize` only.
    Optimize {
        /// Method of the search.
        method: Word<SearchMethod> = Word(SearchMethod::Gradient),
        /// Gradient searches for each combination of choices, each from its own starting point.
        starts: Count<1, 10_000> = Count(20),
        /// Seed of starting points and population.
        seed: Seed = Count(0),
        /// Most designs that one search evaluates, all its starts together.
        evaluations: Count<10, 100_000_000> = Count(20_000),
        /// Number of searches along the Pareto front of several objectives.
        points: Count<2, 1000> = Count(15),
        /// Keys that the search may change.
        variables: Vec<Spanned<Variable>>,
        /// Lights, views and other conditions of use. Default: none: the scenario without changes.
        conditions: Vec<Spanned<Condition>> = Vec::new(),
        /// Quantities to improve; several define a Pareto front.
        objectives: Vec<Spanned<Objective>>,
        /// Limits that every design must satisfy. Default: none.
        constraints: Vec<Spanned<Constraint>> = Vec::new(),
    }
}

choice! {
    for SearchMethod {
        /// By derivatives from many starting points (SLSQP).
        Gradient = "gradient",
        /// By a population of designs (differential evolution).
        Global = "global",
        /// A population first, then derivatives from its best design.
        Both = "both",
    }
}

table! {
    /// A key that the search may change: a number or a choice.
    Variable {
        /// A path as in `--set`; or `keys`.
        key: Option<String>,
        /// Several paths that get the same value.
        keys: Option<Vec<Spanned<String>>>,
        /// A key that changes by the opposite amount, so that the sum is constant: for areas and shares of
        /// the light.
        compensated_by: Option<String>,
        /// The smallest and the largest value; or `choices`.
        bounds: Option<Vec<Spanned<Any>>>,
        /// The possible values: materials, files, numbers, tables.
        choices: Option<Choices>,
    }
}

table! {
    /// A condition of use: a light, a view or any other keys.
    Condition {
        /// Name of the condition.
        name: String,
        /// Keys and their values as in `--set`. Default: the scenario without changes.
        set: Changes = Changes(Vec::new()),
        /// Weight in objectives without a `condition`.
        weight: Weight = Weight(1.0),
    }
}

table! {
    /// A quantity to improve: a `metric`, or the difference of a `state` from a `spectrum`, `lab` or `uv`. Without
    /// `condition` and `view` it is the mean over all of them.
    Objective {
        /// A metric of a view, `"gamut_percent_srgb"`, or of a state, `"white.Y"`. Exactly one of `metric`,
        /// `spectrum`, `lab` and `uv`.
        metric: Option<MetricName>,
        /// Aim of a metric; required with `metric`. Differences are minimised.
        aim: Option<Aim>,
        /// The state whose spectrum or colour is compared with `spectrum`, `lab` or `uv`.
        state: Option<String>,
        /// Reflectance factor to compare with: the root mean square difference of the state over the grid.
        spectrum: Option<DesiredSpectrum>,
        /// CIELAB colour to compare with, `[L, a, b]`: the CIEDE2000 difference of the state.
        lab: Option<Vec<Spanned<Any>>>,
        /// Chromaticity to compare with, `[u', v']`: the distance of the state.
        uv: Option<Vec<Spanned<Any>>>,
        /// Name of the condition. Default: all conditions; the objective is the mean.
        condition: Option<String>,
        /// Index of the view, from 0. Default: all views; the objective is the mean.
        view: Option<Count<0, 4999>>,
    }
}

table! {
    /// A limit that every design must satisfy, for any quantity that an objective may have. Without `condition` and `view`
    /// it must hold in all of them.
    Constraint {
        /// A metric of a view, `"gamut_percent_srgb"`, or of a state, `"white.Y"`. Exactly one of `metric`,
        /// `spectrum`, `lab` and `uv`.
        metric: Option<MetricName>,
        /// The state whose spectrum or colour is compared with `spectrum`, `lab` or `uv`.
        state: Option<String>,
        /// Reflectance factor to compare with: the root mean square difference of the state over the grid.
        spectrum: Option<DesiredSpectrum>,
        /// CIELAB colour to compare with, `[L, a, b]`: the CIEDE2000 difference of the state.
        lab: Option<Vec<Spanned<Any>>>,
        /// Chromaticity to compare with, `[u', v']`: the distance of the state.
        uv: Option<Vec<Spanned<Any>>>,
        /// Name of the condition. Default: all conditions; the constraint must hold in each.
        condition: Option<String>,
        /// Index of the view, from 0. Default: all views; the constraint must hold in each.
        view: Option<Count<0, 4999>>,
        /// Lower limit; or `at_most`, or both.
        at_least: Option<Any>,
        /// Upper limit.
        at_most: Option<Any>,
    }
}

forms! {
    /// A reflectance factor: the same at all wavelengths, from a file, or as [nm, value] pairs.
    DesiredSpectrum, format!("{}, a spectrum file, or a list of [nm, value]", Share::in_words()); {
        /// The same at all wavelengths.
        Constant(Share) if Value::Integer(_) | Value::Float(_),
        /// A file with two columns, relative to the folder of the scenario.
        File(String) if Value::Text(_),
        /// Pairs of wavelength and value, linear between them.
        List(Vec<Spanned<Vec<Spanned<Any>>>>) if Value::Array(_),
    }
}

forms! {
    /// Aim of a metric.
    Aim, "\"maximise\", \"minimise\" or { target = ... }"; {
        /// The largest or the smallest value.
        Sense(Sense) if Value::Text(_),
        /// A value near a target.
        Target(AimedValue) if Value::Table(_),
    }
}

choice! {
    /// Sense of an optimisation.
    Sense {
        /// Larger is better.
        Maximise = "maximise",
        /// Smaller is better.
        Minimise = "minimise",
    }
}

table! {
    /// A target value.
    AimedValue {
        /// The desired value.
        target: Any,
    }
}

/// The possible values of a key, of any type.
#[derive(Debug, Clone)]
pub(crate) struct Choices(pub(crate) Vec<Node>);

impl Read for Choices {
    fn in_words() -> String {
        "a list of values".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Array(items) = &node.value else { return node.wrong_type(Self::in_words(), errors) };
        if items.is_empty() {
            errors.push(node.origin, mistake::empty_list());
            return None;
        }
        Some(Self(items.clone()))
    }
}

impl Serialize for Choices {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(Node::to_json))
    }
}

impl JsonSchema for Choices {
    fn schema_name() -> Cow<'static, str> {
        "Choices".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "type": "array" })
    }
    fn inline_schema() -> bool {
        true
    }
}

/// Keys and their values: `a.b = 1` means the same as `"a.b" = 1`.
#[derive(Debug, Clone)]
pub(crate) struct Changes(pub(crate) Vec<Change>);

impl Changes {
    fn add(&mut self, above: &str, node: &Node) {
        let Value::Table(entries) = &node.value else { return };
        for entry in entries {
            let path = below(above, &entry.key);
            match &entry.node.value {
                Value::Table(_) => self.add(&path, &entry.node),
                _ => self.0.push(Change {
                    path: KeyPath::new(&path),
                    origin: entry.key_origin,
                    value: entry.node.clone(),
                }),
            }
        }
    }
}

impl Read for Changes {
    fn in_words() -> String {
        "a table of keys and their values, as { \"lighting.preset\" = \"sunny\" }".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        if !matches!(node.value, Value::Table(_)) {
            return node.wrong_type(Self::in_words(), errors);
        }
        let mut changes = Self(Vec::new());
        changes.add("", node);
        for (i, change) in changes.0.iter().enumerate() {
            if let Some(other) = changes.0[..i].iter().find(|other| other.path == change.path) {
                errors.push(change.origin, mistake::both_names(other.path.text(), change.path.text()));
                return None;
            }
        }
        Some(changes)
    }
}

impl Serialize for Changes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|change| (&change.path, change.value.to_json())))
    }
}

impl JsonSchema for Changes {
    fn schema_name() -> Cow<'static, str> {
        "Changes".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({ "type": "object" })
    }
    fn inline_schema() -> bool {
        true
    }
}

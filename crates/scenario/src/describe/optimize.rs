//! `[optimize]`: what may vary, and what makes a design a good one.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use super::limits::MetricName;
use super::numbers::{Count, Seed, Share, Weight};
use super::sweep::Any;
use crate::error::Errors;
use crate::grammar::{choice, forms, table};
use crate::mistake;
use crate::path::{KeyPath, joined};
use crate::read::{At, Read};
use crate::set::Change;
use crate::tree::{Node, Value};

table! {
    /// A search for better designs; for `papilio optimize` alone.
    Optimize {
        /// How designs are searched.
        method: Method = Method::Gradient,
        /// Number of gradient searches for each combination of choices, each from a starting point of its own.
        starts: Count<1, 10_000> = Count(20),
        /// Seed of the starting points and of the global method.
        seed: Seed = Count(0),
        /// Number of designs that one search may evaluate, all its starts together.
        evaluations: Count<10, 100_000_000> = Count(20_000),
        /// Number of searches along the front of several objectives.
        points: Count<2, 1000> = Count(15),
        /// What may vary.
        variables: Vec<At<Variable>>,
        /// Lights, views and other circumstances that every design has to do with. Default: none, the scenario as it
        /// stands.
        conditions: Vec<At<Condition>> = Vec::new(),
        /// What makes a design good; several objectives make a front.
        objectives: Vec<At<Objective>>,
        /// What every design has to meet. Default: none.
        constraints: Vec<At<Constraint>> = Vec::new(),
    }
}

choice! {
    /// How designs are searched.
    Method {
        /// Downhill from many starts, by derivatives (SLSQP).
        Gradient = "gradient",
        /// By a population of designs (differential evolution).
        Global = "global",
        /// First `"global"`, then `"gradient"` from its best design.
        Both = "both",
    }
}

table! {
    /// A number or a choice that may vary.
    Variable {
        /// A path as in `--set`. Either `key` or `keys`.
        key: Option<String>,
        /// Several paths that take the same value. Either `key` or `keys`.
        keys: Option<Vec<At<String>>>,
        /// A key that compensates the others, so that their sum stays the same: for areas and fractions of the light.
        compensated_by: Option<String>,
        /// The smallest and the largest value. Either `bounds` or `choices`.
        bounds: Option<Vec<At<Any>>>,
        /// The possible values: numbers, names of materials, files, tables. Either `bounds` or `choices`.
        choices: Option<Choices>,
    }
}

table! {
    /// A light, a view or anything else that every design has to do with.
    Condition {
        /// Name of the condition.
        name: String,
        /// Keys and their values as in `--set`: `{ "lighting.preset" = "sunny" }`. Default: the scenario as it stands.
        set: Changes = Changes(Vec::new()),
        /// Weight in objectives that name no condition.
        weight: Weight = Weight(1.0),
    }
}

table! {
    /// What is to be large, small or near something: a `metric`, or how far a `state` is from a `spectrum`, `lab` or `uv`.
    /// Without `condition` and `view` it is the mean over all of them.
    Objective {
        /// A metric of all states together, `"gamut_percent_srgb"`, or of one state, `"white.Y"`. Exactly one of `metric`,
        /// `spectrum`, `lab` and `uv`.
        metric: Option<MetricName>,
        /// What is wanted of the metric; required with `metric`. Distances are minimised.
        aim: Option<Aim>,
        /// The state whose spectrum or colour is compared with `spectrum`, `lab` or `uv`.
        state: Option<String>,
        /// The wanted reflectance factor; the objective is the root mean square difference over the wavelengths.
        spectrum: Option<WantedSpectrum>,
        /// The wanted CIELAB colour, `[L, a, b]`; the objective is the CIEDE2000 difference.
        lab: Option<Vec<At<Any>>>,
        /// The wanted chromaticity, `[u', v']`; the objective is the distance.
        uv: Option<Vec<At<Any>>>,
        /// Name of the condition. Default: all of them; the objective is the mean.
        condition: Option<String>,
        /// Number of the view, from 0. Default: all of them; the objective is the mean.
        view: Option<Count<0, 4999>>,
    }
}

table! {
    /// A limit that every design has to meet, of what an objective may be, too. Without `condition` and `view` it holds in
    /// all of them.
    Constraint {
        /// A metric of all states together, `"gamut_percent_srgb"`, or of one state, `"white.Y"`. Exactly one of `metric`,
        /// `spectrum`, `lab` and `uv`.
        metric: Option<MetricName>,
        /// The state whose spectrum or colour is compared with `spectrum`, `lab` or `uv`.
        state: Option<String>,
        /// A reflectance factor; the limits are on the root mean square difference over the wavelengths.
        spectrum: Option<WantedSpectrum>,
        /// A CIELAB colour, `[L, a, b]`; the limits are on the CIEDE2000 difference.
        lab: Option<Vec<At<Any>>>,
        /// A chromaticity, `[u', v']`; the limits are on the distance.
        uv: Option<Vec<At<Any>>>,
        /// Name of the condition. Default: all of them; the constraint holds in each.
        condition: Option<String>,
        /// Number of the view, from 0. Default: all of them; the constraint holds in each.
        view: Option<Count<0, 4999>>,
        /// Lower limit. At least one of `at_least` and `at_most`.
        at_least: Option<Any>,
        /// Upper limit. At least one of `at_least` and `at_most`.
        at_most: Option<Any>,
    }
}

forms! {
    /// A reflectance factor: the same at all wavelengths, from a file, or as [nm, value] pairs.
    WantedSpectrum, format!("{}, a spectrum file, or a list of [nm, value]", Share::in_words()); {
        /// The same at all wavelengths.
        Constant(Share) if Value::Integer(_) | Value::Float(_),
        /// A two-column file, relative to the scenario.
        File(String) if Value::Text(_),
        /// Pairs of wavelength and value, linear between them.
        List(Vec<At<Vec<At<Any>>>>) if Value::Array(_),
    }
}

forms! {
    /// What is to become of a metric.
    Aim, "\"maximise\", \"minimise\" or { target = ... }"; {
        /// As large or as small as can be.
        Way(Way) if Value::Text(_),
        /// Near a value.
        Target(Target) if Value::Table(_),
    }
}

choice! {
    /// Larger or smaller.
    Way {
        /// The larger the better.
        Maximise = "maximise",
        /// The smaller the better.
        Minimise = "minimise",
    }
}

table! {
    /// A value to come near to.
    Target {
        /// The wanted value.
        target: Any,
    }
}

/// Values of a key, of any kind.
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

/// Keys and the values that they are to have: `a.b = 1` is the same as `"a.b" = 1`.
#[derive(Debug, Clone)]
pub(crate) struct Changes(pub(crate) Vec<Change>);

impl Changes {
    fn take(&mut self, above: &str, node: &Node) {
        let Value::Table(entries) = &node.value else { return };
        for entry in entries {
            let path = joined(above, &entry.key);
            match &entry.node.value {
                Value::Table(_) => self.take(&path, &entry.node),
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
        changes.take("", node);
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

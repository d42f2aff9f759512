//! `[sweep]`: which keys are varied, over what.

use std::borrow::Cow;

use papilio_diagnostics::Diagnostic;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use super::limits::MetricName;
use super::numbers::Count;
use crate::error::Errors;
use crate::grammar::{number, table};
use crate::mistake;
use crate::origin::Origin;
use crate::path::{KeyPath, joined};
use crate::range::Range as NumberRange;
use crate::read::{At, Read};
use crate::tree::{Entry, Node, Value};

table! {
    /// Keys that `papilio sweep` varies: every point of the product of the axes is computed, the last axis fastest.
    Sweep {
        /// The axes: tables of paths as in `--set`, each with a list of values, `{ from, to, step }` or `{ from, to, count
        /// }`. Keys of one axis move together; every combination of the axes is computed, the last axis fastest.
        axes: Vec<At<Axis>>,
        /// Metrics that are drawn: columns of sweep.csv, those of a state as `"white.L_star"`. Default: of a light sweep
        /// all its metrics.
        figures: Vec<At<String>> =
            ["contrast_ratio", "gamut_percent_srgb"].map(|name| At::at_large(name.to_owned())).to_vec(),
        /// Makes a light sweep, for many points: only these metrics are kept, for every view. Default: all results of every
        /// point.
        metrics: Option<Vec<At<MetricName>>>,
    }
}

table! {
    /// Evenly spaced values, both ends included where the steps reach them.
    Range {
        /// First value.
        from: Any,
        /// Last value.
        to: Any,
        /// Step, towards `to`. Either `step` or `count`.
        step: Option<Any>,
        /// Number of values, both ends included. Either `step` or `count`.
        count: Option<Count<2, { MOST_POINTS as u64 }>>,
    }
}

number!(
    /// A value, whatever its key takes.
    Any, NumberRange::ANY
);

/// One axis: paths as of `--set`, each with as many values.
#[derive(Debug, Clone)]
pub(crate) struct Axis(pub(crate) Vec<Swept>);

/// A key that is varied.
#[derive(Debug, Clone)]
pub(crate) struct Swept {
    /// Its path.
    pub(crate) path: KeyPath,
    /// Where the path stands.
    pub(crate) origin: Origin,
    /// One for each point of the axis, each with its place.
    pub(crate) values: Vec<Node>,
}

/// No axis has more points, and no sweep.
pub(crate) const MOST_POINTS: usize = 100_000;

impl Axis {
    /// How many points it has.
    pub(crate) fn len(&self) -> usize {
        self.0.first().map_or(0, |swept| swept.values.len())
    }
}

impl Read for Axis {
    fn in_words() -> String {
        "a table of keys, each with a list of values or { from, to, step }".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Table(entries) = &node.value else {
            return node.wrong_type(Self::in_words(), errors);
        };
        let mut swept = Vec::new();
        let sound = entries.iter().map(|entry| take("", entry, &mut swept, errors)).collect::<Vec<_>>();
        if sound.contains(&None) {
            return None;
        }
        let Some(first) = swept.first() else {
            return node.wrong_type(Self::in_words(), errors);
        };
        let count = first.values.len();
        for other in &swept[1..] {
            if other.values.len() != count {
                let (path, own) = (&other.path, other.values.len());
                let wrong = Diagnostic::new(format!(
                    "`{path}` has {own} values, `{}` has {count}",
                    first.path
                ))
                .expected(format!("{count} values"))
                .hint("keys of one [[sweep.axes]] move together; for all combinations give each its own");
                errors.push(other.origin, wrong);
                return None;
            }
        }
        Some(Self(swept))
    }
}

/// The values under a key; of a table that is no range, those of each of its keys: `a.b = [1]` is the same as
/// `"a.b" = [1]`.
fn take(above: &str, entry: &Entry, swept: &mut Vec<Swept>, errors: &mut Errors) -> Option<()> {
    let path = joined(above, &entry.key);
    let origin = entry.key_origin;
    let values = match &entry.node.value {
        Value::Array(items) => items.clone(),
        Value::Table(_) if entry.node.get("from").is_some() => evenly(&entry.node, errors)?,
        Value::Table(entries) if !entries.is_empty() => {
            let found: Vec<_> = entries.iter().map(|entry| take(&path, entry, swept, errors)).collect();
            return found.into_iter().collect();
        }
        _ => return entry.node.wrong_type("a list of values, or { from, to, step }", errors),
    };
    let path = KeyPath::new(&path);
    if path.first() == "sweep" {
        errors.push(origin, Diagnostic::new("keys of `[sweep]` cannot be swept"));
        return None;
    }
    if values.is_empty() {
        errors.push(entry.node.origin, mistake::empty_list());
        return None;
    }
    swept.push(Swept { path, origin, values });
    Some(())
}

/// The values of a range.
fn evenly(node: &Node, errors: &mut Errors) -> Option<Vec<Node>> {
    let range = Range::read(node, errors)?;
    let (from, to) = (range.from.0, range.to.0);
    let steps = match (range.step.value, range.count.value) {
        (Some(step), None) => {
            let steps = (to - from) / step.0;
            if !steps.is_finite() || steps < 0.0 {
                let wrong = Diagnostic::new(format!("steps of {} do not lead from {from} to {to}", step.0));
                errors.push(
                    range.step.origin,
                    wrong.hint("give `count` instead, or change the sign of the step"),
                );
                return None;
            }
            // A step that misses the end by rounding alone reaches it.
            Steps { each: step.0, count: (steps + 1e-9).floor() }
        }
        (None, Some(count)) => {
            let count = (count.0 - 1) as f64;
            Steps { each: (to - from) / count, count }
        }
        (step, count) => {
            let given = usize::from(step.is_some()) + usize::from(count.is_some());
            errors.push(node.origin, mistake::exactly_one("`step` and `count`", given));
            return None;
        }
    };
    if steps.count >= MOST_POINTS as f64 {
        errors.push(node.origin, mistake::too_many("points", steps.count + 1.0, MOST_POINTS));
        return None;
    }
    let value =
        |i: usize| Node { origin: node.origin, value: Value::Float(tidy(from + steps.each * i as f64)) };
    Some((0..=steps.count as usize).map(value).collect())
}

/// What lies between the values of a range.
struct Steps {
    each: f64,
    /// How many: a whole number.
    count: f64,
}

/// The number without the last digits, which are rounding: .1 + 2 * .1 is .3.
fn tidy(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}

impl Serialize for Axis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = |swept: &Swept| swept.values.iter().map(Node::to_json).collect::<Vec<_>>();
        serializer.collect_map(self.0.iter().map(|swept| (&swept.path, values(swept))))
    }
}

impl JsonSchema for Axis {
    fn schema_name() -> Cow<'static, str> {
        "SweepAxis".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let range = generator.subschema_for::<Range>();
        schemars::json_schema!({
            "type": "object",
            "description": "Paths as of --set, each with as many values.",
            "additionalProperties": { "anyOf": [{ "type": "array" }, range, { "type": "object" }] },
        })
    }
}

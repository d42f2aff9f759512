//! `[sweep]`: keys that vary, and their values.

use std::borrow::Cow;
use std::collections::HashSet;

use papilio_diagnostics::{Diagnostic, number};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use super::limits::MetricName;
use super::numbers::Count;
use crate::error::Errors;
use crate::grammar::{number, table};
use crate::mistake;
use crate::origin::Origin;
use crate::path::{KeyPath, below};
use crate::range::Range as NumberRange;
use crate::read::{Read, Spanned};
use crate::tree::{Entry, Node, Value};
use crate::varied::STUDY_TABLES;

table! {
    /// Keys that `papilio sweep` varies. Every combination of the axes is computed; the last axis varies fastest.
    Sweep {
        /// Tables of keys as in `--set`. Keys of one axis change together. Also `"from:to:step"` and `{ from,
        /// to, count }`.
        axes: Vec<Spanned<Axis>>,
        /// Metrics to draw: columns of sweep.csv, those of a state as `"white.L_star"`. Default: for a compact sweep all stored
        /// metrics.
        figures: Vec<Spanned<String>> =
            ["contrast_ratio", "gamut_percent_srgb"].map(|name| Spanned::without_span(name.to_owned())).to_vec(),
        /// Makes this a compact sweep, for many points: only these metrics are stored, for every view.
        /// Default: all results of every point.
        metrics: Option<Vec<Spanned<MetricName>>>,
    }
}

table! {
    /// Uniformly spaced values, including both ends if the steps reach them.
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
    /// A number without a range.
    Any, NumberRange::ANY
);

/// One axis: paths as in `--set`, with the same number of values each.
#[derive(Debug, Clone)]
pub(crate) struct Axis(pub(crate) Vec<Swept>);

/// A key of an axis.
#[derive(Debug, Clone)]
pub(crate) struct Swept {
    /// Path of the key.
    pub(crate) path: KeyPath,
    /// Place of the path in the text.
    pub(crate) origin: Origin,
    /// One value for each point of the axis, with its place.
    pub(crate) values: Vec<Node>,
    /// A note on a range whose steps do not reach its end.
    pub(crate) note: Option<String>,
}

/// Largest number of points of an axis, and of a sweep.
pub(crate) const MOST_POINTS: usize = 100_000;

impl Axis {
    /// Returns the first point whose values are those of an earlier one: their place, and the values.
    pub(crate) fn repeated(&self) -> Option<(Origin, String)> {
        let mut seen = HashSet::new();
        (0..self.len()).find_map(|point| {
            let nodes: Vec<&Node> = self.0.iter().filter_map(|swept| swept.values.get(point)).collect();
            let values = nodes.iter().map(|node| node.to_json().to_string()).collect::<Vec<_>>().join(", ");
            let origin = nodes.first().map(|node| node.origin)?;
            (!seen.insert(values.clone())).then_some((origin, values))
        })
    }

    /// Returns the number of points.
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
        let sound =
            entries.iter().map(|entry| read_values("", entry, &mut swept, errors)).collect::<Vec<_>>();
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
                .hint("keys of one [[sweep.axes]] change together; for all combinations give each its own");
                errors.push(other.origin, wrong);
                return None;
            }
        }
        Some(Self(swept))
    }
}

/// Reads the values of a key. In a table that is not a range, reads those of each of its keys: `a.b = [1]` means the
/// same as `"a.b" = [1]`.
fn read_values(above: &str, entry: &Entry, swept: &mut Vec<Swept>, errors: &mut Errors) -> Option<()> {
    let path = below(above, &entry.key);
    let origin = entry.key_origin;
    let (values, ends) = match &entry.node.value {
        Value::Array(items) => (items.clone(), None),
        Value::Text(text) if range(text).is_some() => text_range(&entry.node, text, errors)?,
        Value::Table(_) if entry.node.get("from").is_some() => range_values(&entry.node, errors)?,
        Value::Table(entries) if !entries.is_empty() => {
            let found: Vec<_> =
                entries.iter().map(|entry| read_values(&path, entry, swept, errors)).collect();
            return found.into_iter().collect();
        }
        _ => {
            return entry.node.wrong_type("a list of values, { from, to, step } or \"from:to:step\"", errors);
        }
    };
    let path = KeyPath::new(&path);
    // They change no result.
    if STUDY_TABLES.contains(&path.first()) {
        let wrong = Diagnostic::new(format!("keys of `[{}]` cannot be swept", path.first()));
        errors.push(origin, wrong.expected("a key of the display, the light, the viewer or the solver"));
        return None;
    }
    if values.is_empty() {
        errors.push(entry.node.origin, mistake::empty_list());
        return None;
    }
    let note = ends.map(|ends| format!("{path}: {ends}"));
    swept.push(Swept { path, origin, values, note });
    Some(())
}

/// The numbers of a text such as `190:194:1`; two or more, not yet three.
pub(crate) fn range(text: &str) -> Option<Vec<f64>> {
    let numbers: Option<Vec<f64>> = text.split(':').map(|number| number.trim().parse().ok()).collect();
    numbers.filter(|numbers| numbers.len() > 1)
}

/// Returns the values of a range `FROM:TO:STEP`, and where they end if that is before its end.
fn text_range(node: &Node, text: &str, errors: &mut Errors) -> Option<(Vec<Node>, Option<String>)> {
    let Some(Ok([from, to, step])) = range(text).map(<[f64; 3]>::try_from) else {
        let wrong =
            Diagnostic::new(format!("`{text}` is not a range")).expected("FROM:TO:STEP, such as 190:194:1");
        errors.push(node.origin, wrong.hint("for a number of values, write { from, to, count }"));
        return None;
    };
    let entry = |key: &str, number: f64| Entry {
        key: key.to_owned(),
        key_origin: node.origin,
        node: Node { origin: node.origin, value: Value::Float(number) },
    };
    let entries = vec![entry("from", from), entry("to", to), entry("step", step)];
    range_values(&Node { origin: node.origin, value: Value::Table(entries) }, errors)
}

/// Names that are given to the number of values in other programs.
const NOT_COUNT: [&str; 6] = ["steps", "points", "num", "number", "n", "samples"];

/// Returns the values of a range, and where they end if that is before its end.
fn range_values(node: &Node, errors: &mut Errors) -> Option<(Vec<Node>, Option<String>)> {
    if let Value::Table(entries) = &node.value
        && let Some(entry) = entries.iter().find(|entry| NOT_COUNT.contains(&entry.key.as_str()))
    {
        let wrong = Diagnostic::new(format!("there is no key `{}` in a range", entry.key));
        let hint =
            "`count` is the number of values, both ends included; `step` is the distance between two of them";
        errors.push(entry.key_origin, wrong.hint(hint));
        return None;
    }
    let range = Range::read(node, errors)?;
    let (from, to) = (range.from.0, range.to.0);
    let mut ends = None;
    let steps = match (range.step.value, range.count.value) {
        (Some(step), None) => {
            let steps = (to - from) / step.0;
            if !steps.is_finite() || steps < 0.0 {
                let wrong = Diagnostic::new(format!("steps of {} do not lead from {from} to {to}", step.0));
                errors.push(
                    range.step.origin,
                    wrong
                        .expected("a step other than 0, towards the end")
                        .hint("give `count` instead, or change the sign of the step"),
                );
                return None;
            }
            // Rounding errors must not remove the last value.
            let count = (steps + ROUNDING).floor();
            if steps - count > ROUNDING {
                let [each, from, last, to] =
                    [step.0, from, from + step.0 * count, to].map(|x| number(tidy(x)));
                ends = Some(format!("steps of {each} from {from} end at {last}, before {to}"));
            }
            Steps { each: step.0, count }
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
    Some(((0..=steps.count as usize).map(value).collect(), ends))
}

/// Part of a step that rounding errors may cause.
const ROUNDING: f64 = 1e-9;

/// Steps between the values of a range.
struct Steps {
    each: f64,
    /// Number of steps, an integer.
    count: f64,
}

/// Removes the digits of rounding errors: 0.1 + 2 * 0.1 is 0.3.
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
            "description": "Paths as in --set, with the same number of values each.",
            "additionalProperties": { "anyOf": [{ "type": "array" }, range, { "type": "string" }, { "type": "object" }] },
        })
    }
}

//! Ranges of numbers: one declaration defines the test, the description and the JSON Schema.

use papilio_diagnostics::{Diagnostic, number};
use serde_json::{Map, Value as Json, json};

use crate::error::Errors;
use crate::mistake::{Mistake, out_of_range};
use crate::tree::Node;

/// Range of a quantity.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Range {
    least: f64,
    most: f64,
    /// Whether `least` and `most` are excluded.
    open: [bool; 2],
    /// Whether 0 is also allowed; the text follows it in the description.
    zero: Option<&'static str>,
    unit: &'static str,
    /// Hint for a number below the range.
    below: Option<&'static str>,
}

impl Range {
    /// Any number.
    pub(crate) const ANY: Self = Self::from_to(f64::NEG_INFINITY, f64::INFINITY);

    /// A range that includes both ends.
    pub(crate) const fn from_to(least: f64, most: f64) -> Self {
        Self { least, most, open: [false; 2], zero: None, unit: "", below: None }
    }

    /// A range that excludes both ends.
    pub(crate) const fn between(least: f64, most: f64) -> Self {
        Self { open: [true; 2], ..Self::from_to(least, most) }
    }

    /// A range above 0 that includes its upper end.
    pub(crate) const fn above_0_to(most: f64) -> Self {
        Self { open: [true, false], ..Self::from_to(0.0, most) }
    }

    /// Sets the unit, or the name of the quantity.
    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// Allows 0 too; `when` follows it in the description, after a blank.
    pub(crate) const fn or_0(self, when: &'static str) -> Self {
        Self { zero: Some(when), ..self }
    }

    /// Sets the hint for a number that is too small.
    pub(crate) const fn hint_below(self, hint: &'static str) -> Self {
        Self { below: Some(hint), ..self }
    }

    pub(crate) fn contains(&self, value: f64) -> bool {
        let [above, below] = self.open;
        let is_above = if above { value > self.least } else { value >= self.least };
        let is_below = if below { value < self.most } else { value <= self.most };
        value.is_finite() && ((is_above && is_below) || (self.zero.is_some() && value == 0.0))
    }

    /// Returns the end of the range that is nearest to a number outside it, if that end is a part of the
    /// range.
    fn nearest_end(&self, value: f64) -> Option<f64> {
        let end = if value < self.least { self.least } else { self.most };
        (value.is_finite() && self.contains(end)).then_some(end)
    }

    /// Describes the range: "a number from 0 to 1e6 (nm)".
    pub(crate) fn in_words(&self) -> String {
        let (least, most) = (number(self.least), number(self.most));
        let range = match self.open {
            _ if self.least.is_infinite() => "a number".to_owned(),
            [true, true] => format!("a number above {least} and below {most}"),
            [true, false] => format!("a number above {least}, at most {most}"),
            [false, _] => format!("a number from {least} to {most}"),
        };
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let zero = self.zero.map(|when| format!(", or 0{when}")).unwrap_or_default();
        format!("{range}{unit}{zero}")
    }

    /// Reads a number, or reports an error.
    pub(crate) fn read(&self, node: &Node, errors: &mut Errors) -> Option<f64> {
        let Some(value) = node.number() else { return node.wrong_type(self.in_words(), errors) };
        if self.contains(value) {
            // Adding 0 turns -0 into 0, so that both have one hash.
            return Some(value + 0.0);
        }
        let percent = (self.least == 0.0 && self.most == 1.0 && value > 1.0)
            .then_some("this is a fraction relative to 1, not per cent");
        let hint = percent.or(self.below.filter(|_| value < self.least));
        let Mistake { kind, mut diagnostic } = out_of_range(value, self.in_words());
        if let Some(nearest) = self.nearest_end(value) {
            diagnostic = diagnostic.accepted(nearest);
        }
        errors.push(node.origin, Mistake { kind, diagnostic: Diagnostic::hint_if(diagnostic, hint) });
        None
    }

    pub(crate) fn schema(&self) -> Map<String, Json> {
        let mut rules = Map::from_iter([("type".to_owned(), json!("number"))]);
        let [above, below] = self.open;
        let least = if self.zero.is_some() { 0.0 } else { self.least };
        let mut add = |rule: &str, value: f64| {
            if value.is_finite() {
                let whole = value.fract() == 0.0 && value.abs() < 1e15;
                rules.insert(rule.to_owned(), if whole { json!(value as i64) } else { json!(value) });
            }
        };
        add(if above && self.zero.is_none() { "exclusiveMinimum" } else { "minimum" }, least);
        add(if below { "exclusiveMaximum" } else { "maximum" }, self.most);
        rules
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn range_description_test_and_schema_agree() {
        for (range, words, inside, outside) in [
            (Range::from_to(0.0, 1e6).unit("nm"), "a number from 0 to 1e6 (nm)", [0.0, 1e6], [-1e-9, 1.1e6]),
            (Range::between(-90.0, 90.0), "a number above -90 and below 90", [-89.9, 89.9], [-90.0, 90.0]),
            (
                Range::above_0_to(1e5).unit("K"),
                "a number above 0, at most 100000 (K)",
                [1e-9, 1e5],
                [0.0, 1e6],
            ),
            (Range::from_to(1e-4, 1.0).or_0(""), "a number from 0.0001 to 1, or 0", [0.0, 1e-4], [1e-5, 2.0]),
            (Range::ANY, "a number", [-1e300, 1e300], [f64::NAN, f64::INFINITY]),
        ] {
            assert_eq!(range.in_words(), words);
            assert!(inside.iter().all(|value| range.contains(*value)), "{words}");
            assert!(!outside.iter().any(|value| range.contains(*value)), "{words}");
        }
        let schema = |range: Range| Json::Object(range.schema()).to_string();
        assert_eq!(schema(Range::above_0_to(1.0)), r#"{"exclusiveMinimum":0,"maximum":1,"type":"number"}"#);
        assert_eq!(
            schema(Range::from_to(1e-4, 1.0).or_0("")),
            r#"{"maximum":1,"minimum":0,"type":"number"}"#
        );
        assert_eq!(schema(Range::ANY), r#"{"type":"number"}"#);
    }
}

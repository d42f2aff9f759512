//! Metrics by name, and limits of their values.

use papilio_display::scene::Metric;

use super::numbers::Count;
use super::sweep::Any;
use crate::error::Errors;
use crate::grammar::table;
use crate::nearest::no_such_metric;
use crate::read::{Read, Spanned};
use crate::tree::{Node, Value};

table! {
    /// A limit: `at_least`, `at_most` or both.
    Limit {
        /// A metric of a view, `"gamut_percent_srgb"`, or of a state, `"white.Y"`.
        metric: MetricName,
        /// Index of the view, from 0.
        view: Count<0, 4999> = Count(0),
        /// Lower limit; or `at_most`, or both.
        at_least: Option<Any>,
        /// Upper limit.
        at_most: Option<Any>,
    }
}

/// A metric of a view (of all states together), or of a state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MetricName {
    /// The state; `None` for a metric of a view.
    pub(crate) state: Option<String>,
    pub(crate) metric: Metric,
}

impl MetricName {
    /// Returns the metric with this name.
    pub(crate) fn named(text: &str) -> Option<Self> {
        let (state, metric) = Metric::with_state(text)?;
        Some(Self { state: state.map(str::to_owned), metric })
    }

    /// The name as a scenario has it: `white.Y`.
    pub(crate) fn text(&self) -> String {
        self.state.iter().map(String::as_str).chain([self.metric.name()]).collect::<Vec<_>>().join(".")
    }
}

impl Read for MetricName {
    fn in_words() -> String {
        "the name of a metric, as \"contrast_ratio\" or \"white.Y\"".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Text(text) = &node.value else { return node.wrong_type(Self::in_words(), errors) };
        if let Some(named) = Self::named(text) {
            return Some(named);
        }
        let state = text.rsplit_once('.').map_or("white", |(state, _)| state);
        let known: Vec<String> = Metric::ALL.iter().map(written_with(state)).collect();
        errors.push(node.origin, no_such_metric(text, &known));
        None
    }
}

/// Returns the names of metrics, those of a state with `state` as their prefix.
fn written_with(state: &str) -> impl Fn(&Metric) -> String {
    move |metric| match metric.is_of_view() {
        true => metric.name().to_owned(),
        false => format!("{state}.{}", metric.name()),
    }
}

impl serde::Serialize for MetricName {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.text())
    }
}

impl schemars::JsonSchema for MetricName {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "MetricName".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "type": "string" })
    }
    fn inline_schema() -> bool {
        true
    }
}

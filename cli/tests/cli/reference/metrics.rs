//! Tables of all metrics: names, quantities, units, definitions.

use std::collections::BTreeMap;
use std::fmt::Write;

use papilio_display::image::ImageMetrics;
use papilio_display::metric_label;
use papilio_display::result::{StateValues, ViewMetrics};
use papilio_display::scene::Metric;
use papilio_display::spatial::{CrosstalkMetrics, SharpnessMetrics, SparkleMetrics, SpatialScalars};
use schemars::schema_for;
use serde_json::Value;

use super::cell;

/// Tables of metrics, by what computes them.
pub(super) fn tables() -> String {
    let documented = documented();
    let mut text = String::new();
    for source in [None, Some("mtf"), Some("crosstalk"), Some("sparkle"), Some("image")] {
        for is_of_view in [true, false] {
            let all = Metric::ALL
                .iter()
                .filter(|metric| metric.source().command() == source && metric.is_of_view() == is_of_view);
            let rows: Vec<String> = all.map(|metric| row(metric.name(), &documented)).collect();
            if rows.is_empty() {
                continue;
            }
            let command = source.unwrap_or("run");
            let what = if is_of_view { "metrics of a view" } else { "metrics of a state, as `white.NAME`" };
            let _ = writeln!(
                text,
                "\n### papilio {command}: {what}\n\n| name | quantity | unit | definition |\n|---|---|---|---|"
            );
            text += &rows.concat();
        }
    }
    text
}

fn row(name: &str, documented: &BTreeMap<String, String>) -> String {
    // A metric of a state has its label there.
    let label = metric_label(name).unwrap_or_else(|| panic!("`{name}` has no label"));
    let unit = if label.unit.is_empty() { "1" } else { &label.unit };
    let definition = documented.get(name).unwrap_or_else(|| panic!("`{name}` is not documented"));
    format!("| `{name}` | {} | {unit} | {} |\n", cell(&label.quantity), cell(definition))
}

/// Documentation of all metrics, by name.
fn documented() -> BTreeMap<String, String> {
    let tables = [
        schema_for!(ViewMetrics),
        schema_for!(StateValues),
        schema_for!(SharpnessMetrics),
        schema_for!(SpatialScalars),
        schema_for!(CrosstalkMetrics),
        schema_for!(SparkleMetrics),
        schema_for!(ImageMetrics),
    ];
    let mut found = BTreeMap::new();
    for table in tables {
        for (name, field) in table.to_value()["properties"].as_object().into_iter().flatten() {
            let text = field["description"].as_str().unwrap_or_default().to_owned();
            found.insert(name.clone(), text);
        }
    }
    found
}

/// True if a field is a number that may be a metric.
pub(super) fn is_metric(name: &str, field: &Value) -> bool {
    Metric::named(name).is_some() && field.get("$ref").is_none() && field["type"] != "array"
}

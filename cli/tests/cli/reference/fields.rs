//! Tables of the fields of JSON files, from their schemas.

use std::fmt::Write;

use serde_json::Value;

use super::{cell, metrics};

/// File, option of `papilio schema`, and schema of each result.
pub(super) fn schemas() -> [(&'static str, &'static str, Value); 7] {
    [
        ("result.json", "--result", papilio_formats::result_schema()),
        ("mtf.json", "--mtf", papilio_formats::mtf_schema()),
        ("crosstalk.json", "--crosstalk", papilio_formats::crosstalk_schema()),
        ("sparkle.json", "--sparkle", papilio_formats::sparkle_schema()),
        ("image.json", "--image", papilio_formats::image_schema()),
        ("palette.json", "--palette", papilio_formats::palette_schema()),
        ("audit.json", "--audit", papilio_formats::surface_audit_schema()),
    ]
}

/// A table for each file, and one for each kind of table in it.
pub(super) fn tables() -> String {
    let mut text = String::new();
    for (file, option, schema) in schemas() {
        let _ = writeln!(text, "\n### {file}\n\n{} (`papilio schema {option}`)\n", sentence(&schema));
        text += &table(&schema);
        for (name, inner) in schema["$defs"].as_object().into_iter().flatten() {
            let is_table = inner["properties"].as_object().is_some_and(|all| !all.is_empty());
            // Tables of metrics alone are those above.
            if is_table && fields(inner).next().is_some() {
                let _ = writeln!(text, "\n**{name}** of {file}: {}\n", sentence(inner));
                text += &table(inner);
            }
        }
    }
    text
}

fn sentence(schema: &Value) -> String {
    cell(schema["description"].as_str().unwrap_or_default())
}

/// The fields that are not metrics.
fn fields(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let all = schema["properties"].as_object().into_iter().flatten();
    all.filter(|(name, field)| !metrics::is_metric(name, field))
}

fn table(schema: &Value) -> String {
    let mut text = "| field | type | meaning |\n|---|---|---|\n".to_owned();
    for (name, field) in fields(schema) {
        let _ = writeln!(text, "| `{name}` | {} | {} |", cell(&kind(field)), sentence(field));
    }
    let metrics = schema["properties"].as_object().map_or(0, |all| all.len()) - fields(schema).count();
    if metrics > 0 {
        let _ = writeln!(text, "| {metrics} [metrics](#metrics) | number or null | |");
    }
    text
}

/// The type of a field in words.
fn kind(field: &Value) -> String {
    if let Some(name) = field["$ref"].as_str() {
        return format!("`{}`", name.trim_start_matches("#/$defs/"));
    }
    if let Some(choices) = field["anyOf"].as_array() {
        return choices.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    match &field["type"] {
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(" or "),
        Value::String(name) if name == "array" => format!("list of {}", kind(&field["items"])),
        Value::String(name) => name.clone(),
        _ => "any".to_owned(),
    }
}

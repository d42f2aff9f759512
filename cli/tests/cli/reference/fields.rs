//! Tables of the fields of result.json, from its schema.

use std::fmt::Write;

use serde_json::Value;

use super::{cell, metrics};

/// A field of a table: its name, its type, and what it is.
type Field = [String; 3];

/// A table of a file.
struct Table {
    name: String,
    sentence: String,
    fields: Vec<Field>,
    metrics: usize,
}

/// The tables of `result.json`; pages of commands describe the other files. Fields of a larger table are described there only.
pub(super) fn tables() -> String {
    let mut text = String::new();
    let tables = tables_of(&papilio_formats::result_schema());
    for (k, table) in tables.iter().enumerate() {
        let _ = match k {
            0 => writeln!(text, "\n### result.json\n\n{} (`papilio schema --result`)\n", table.sentence),
            _ => writeln!(text, "\n**{}**: {}\n", table.name, table.sentence),
        };
        let shared =
            |other: &&Table| table.fields.iter().filter(|field| other.fields.contains(field)).count();
        let larger = tables
            .iter()
            .enumerate()
            .filter(|(n, other)| (other.fields.len(), *n) > (table.fields.len(), k))
            .map(|(_, other)| other);
        let other = larger.max_by_key(shared).filter(|other| shared(other) >= 3);
        text += &rows_of(table, other);
    }
    text
}

/// The tables of a file: that of the file itself first, without tables that have metrics only.
fn tables_of(schema: &Value) -> Vec<Table> {
    let table = |name: &str, schema: &Value| {
        let all = fields(schema).map(|(name, field)| [name.clone(), cell(&kind(field)), sentence(field)]);
        let all: Vec<Field> = all.collect();
        let metrics = schema["properties"].as_object().map_or(0, |every| every.len()) - all.len();
        Table { name: name.to_owned(), sentence: sentence(schema), fields: all, metrics }
    };
    let inner = schema["$defs"].as_object().into_iter().flatten();
    let inner = inner.map(|(name, inner)| table(name, inner)).filter(|table| !table.fields.is_empty());
    std::iter::once(table("", schema)).chain(inner).collect()
}

/// The rows of a table, and what it has in common with another.
fn rows_of(table: &Table, other: Option<&Table>) -> String {
    let is_shared = |field: &&Field| other.is_some_and(|other| other.fields.contains(field));
    let (same, own): (Vec<&Field>, Vec<&Field>) = table.fields.iter().partition(is_shared);
    let rows: String = own.into_iter().map(row).collect();
    let mut text = if rows.is_empty() {
        String::new()
    } else {
        format!("| field | type | meaning |\n|---|---|---|\n{rows}\n")
    };
    let mut also = Vec::new();
    if let Some(other) = other.filter(|_| !same.is_empty()) {
        let names: Vec<String> = same.iter().map(|[name, ..]| format!("`{name}`")).collect();
        also.push(format!("{} as in **{}**", names.join(", "), other.name));
    }
    if table.metrics > 0 {
        also.push(format!("[metrics](#metrics): {}", table.metrics));
    }
    if !also.is_empty() {
        let _ = writeln!(text, "{}{}.", if rows.is_empty() { "Fields: " } else { "Also " }, also.join("; "));
    }
    text
}

fn row([name, kind, meaning]: &Field) -> String {
    format!("| `{name}` | {kind} | {meaning} |\n")
}

fn sentence(schema: &Value) -> String {
    cell(schema["description"].as_str().unwrap_or_default())
}

/// The fields that are not metrics.
fn fields(schema: &Value) -> impl Iterator<Item = (&String, &Value)> {
    let all = schema["properties"].as_object().into_iter().flatten();
    all.filter(|(name, field)| !metrics::is_metric(name, field))
}

/// The type of a field in words; with `?` if it may be null.
fn kind(field: &Value) -> String {
    if let Some(name) = field["$ref"].as_str() {
        let name = name.trim_start_matches("#/$defs/");
        let by_name = name.strip_prefix("Named_").map(|inner| format!("`{inner}` by name"));
        return by_name.unwrap_or_else(|| format!("`{name}`"));
    }
    let or_null = |kinds: Vec<String>| {
        let all = kinds.iter().filter(|kind| *kind != "null").cloned().collect::<Vec<_>>().join(" or ");
        if kinds.iter().any(|kind| kind == "null") { format!("{all}?") } else { all }
    };
    if let Some(choices) = field["anyOf"].as_array() {
        return or_null(choices.iter().map(kind).collect());
    }
    match &field["type"] {
        Value::Array(kinds) => or_null(kinds.iter().filter_map(Value::as_str).map(str::to_owned).collect()),
        Value::String(name) if name == "array" => format!("list of {}", kind(&field["items"])),
        Value::String(name) => name.clone(),
        _ => "any".to_owned(),
    }
}

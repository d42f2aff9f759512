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

/// A field of a table: its name, its type, and what it is.
type Field = [String; 3];

/// A table of a file.
struct Table {
    name: String,
    sentence: String,
    fields: Vec<Field>,
    metrics: usize,
}

/// A table for each file, and one for each kind of table in it. A field that stands in tables of three files or more is described
/// once, for all files, and fields of another table of the same file there only.
pub(super) fn tables() -> String {
    let files: Vec<(&str, &str, Vec<Table>)> =
        schemas().into_iter().map(|(file, option, schema)| (file, option, tables_of(&schema))).collect();
    let is_common = |field: &Field| {
        let has = |tables: &[Table]| tables.iter().any(|table| table.fields.contains(field));
        files.iter().filter(|(_, _, tables)| has(tables)).count() >= 3
    };
    let mut common: Vec<&Field> =
        files.iter().flat_map(|(_, _, tables)| tables).flat_map(|table| &table.fields).collect();
    common.retain(|field| is_common(field));
    common.sort();
    common.dedup();
    let mut text = "\n### Fields of several files\n\n| field | type | meaning |\n|---|---|---|\n".to_owned();
    common.iter().for_each(|field| text += &row(field));
    let mut told: Vec<(&str, &[Field])> = Vec::new();
    for (file, option, tables) in &files {
        for (k, table) in tables.iter().enumerate() {
            let known = told.iter().find(|(name, fields)| *name == table.name && *fields == table.fields);
            if k > 0 && known.is_some() {
                continue;
            }
            told.push((table.name.as_str(), table.fields.as_slice()));
            let _ = match k {
                0 => writeln!(text, "\n### {file}\n\n{} (`papilio schema {option}`)\n", table.sentence),
                _ => writeln!(text, "\n**{}** of {file}: {}\n", table.name, table.sentence),
            };
            let own = |field: &&Field| !is_common(field);
            let shared = |other: &&Table| {
                table.fields.iter().filter(own).filter(|field| other.fields.contains(field)).count()
            };
            let larger = tables.iter().enumerate().filter(|(n, other)| {
                *n != k && (other.fields.len(), *n) > (table.fields.len(), k) || (*n == 0 && k > 0)
            });
            let other = larger.map(|(_, other)| other).max_by_key(shared).filter(|other| shared(other) >= 3);
            text += &rows_of(table, other, &is_common);
        }
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

/// The rows of a table, and what it has in common with others.
fn rows_of(table: &Table, other: Option<&Table>, is_common: &dyn Fn(&Field) -> bool) -> String {
    let (mut rows, mut common, mut same) = (String::new(), Vec::new(), Vec::new());
    let names: Vec<&str> = table.fields.iter().map(|[name, ..]| name.as_str()).collect();
    for field in &table.fields {
        let [name, kind, _] = field;
        match metrics::family(name, &names) {
            Some((pattern, meaning, true)) => {
                rows += &row(&[pattern.to_owned(), kind.clone(), cell(meaning)])
            }
            Some(_) => {}
            None if is_common(field) => common.push(format!("`{name}`")),
            None if other.is_some_and(|other| other.fields.contains(field)) => same.push(format!("`{name}`")),
            None => rows += &row(field),
        }
    }
    let mut text = if rows.is_empty() {
        String::new()
    } else {
        format!("| field | type | meaning |\n|---|---|---|\n{rows}\n")
    };
    let mut also = Vec::new();
    if !common.is_empty() {
        also.push(format!("{} [of several files](#fields-of-several-files)", common.join(", ")));
    }
    if let Some(other) = other.filter(|_| !same.is_empty()) {
        let of = if other.name.is_empty() { "the file".to_owned() } else { format!("**{}**", other.name) };
        also.push(format!("{} as in {of}", same.join(", ")));
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
        return match name.strip_prefix("Named_") {
            Some(inner) => format!("`{}` by name", inner.trim_start_matches("Named_")),
            None => format!("`{name}`"),
        };
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

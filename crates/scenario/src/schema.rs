//! The JSON Schema of a scenario.

use schemars::generate::SchemaSettings;
use schemars::{Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::describe::File;
use crate::read::Read;

/// The JSON Schema (draft 2020-12) of a scenario file: every key with its
/// meaning, unit, range and default.
pub fn schema() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<File>();
    schema.insert("title".to_owned(), json!("Papilio scenario"));
    schema.to_value()
}

/// A key of a table, as schema and documentation show it.
pub(crate) struct Row {
    pub(crate) key: &'static str,
    /// What it is, without range and default.
    pub(crate) doc: String,
    /// Its default; of a key without one that may be missing, what that means, in words.
    pub(crate) default: Default,
    /// What it may be, in words.
    words: fn() -> String,
    /// The same for a page of documentation, in Markdown.
    pub(crate) on_page: fn() -> String,
    schema: fn(&mut SchemaGenerator) -> Schema,
}

/// What a missing key means.
pub(crate) enum Default {
    /// It must be there.
    Required,
    /// This value, and what else there is to say of it.
    Value(Value, Option<String>),
    /// This, in words.
    Words(String),
}

impl Row {
    /// A key of type `T`; its doc comment may end with "Default: " and what a missing key means, in words.
    pub(crate) fn new<T: Read + Serialize>(key: &'static str, doc: &str, default: Option<T>) -> Self {
        let doc = text(doc);
        let (doc, said) = match doc.split_once(" Default: ") {
            Some((doc, said)) => (doc.to_owned(), Some(said.trim_end_matches('.').to_owned())),
            None => (doc, None),
        };
        let default = match default {
            Some(value) => Default::Value(serde_json::to_value(value).unwrap_or_default(), said),
            None if T::absent().is_none() => Default::Required,
            None => Default::Words(said.unwrap_or_else(|| "none".to_owned())),
        };
        Self { key, doc, default, words: T::in_words, on_page: T::on_page, schema: T::schema_of_value }
    }

    /// What it is, with the range of a number and the default.
    fn description(&self) -> String {
        let words = (self.words)();
        let mut all = self.doc.clone();
        if words.starts_with("a number") || words.starts_with("a whole number") {
            let article = words.chars().next().map(|first| first.to_ascii_uppercase());
            all.push_str(&format!(" {}{}.", article.unwrap_or_default(), &words[1..]));
        }
        match &self.default {
            Default::Required => {}
            Default::Value(value, said) => {
                let said = said.as_ref().map(|said| format!("; {said}")).unwrap_or_default();
                all.push_str(&format!(" Default: {}{said}.", toml(value)));
            }
            Default::Words(words) => all.push_str(&format!(" Default: {words}.")),
        }
        all
    }
}

/// The schema of a table with these keys.
pub(crate) fn of_table(rows: &[Row], doc: &str, generator: &mut SchemaGenerator) -> Schema {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for row in rows {
        let mut schema = (row.schema)(generator);
        schema.insert("description".to_owned(), json!(row.description()));
        match &row.default {
            Default::Required => required.push(row.key),
            Default::Value(value, _) => drop(schema.insert("default".to_owned(), value.clone())),
            Default::Words(_) => {}
        }
        properties.insert(row.key.to_owned(), schema.to_value());
    }
    schemars::json_schema!({
        "type": "object",
        "description": text(doc),
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// A value as TOML writes it on one line.
pub(crate) fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) => {
            number.as_f64().map_or_else(|| number.to_string(), |value| value.to_string())
        }
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(keys) if keys.is_empty() => "{}".to_owned(),
        Value::Object(keys) => {
            let pairs: Vec<String> =
                keys.iter().map(|(key, value)| format!("{key} = {}", toml(value))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
        other => other.to_string(),
    }
}

/// The schema of a table, or of several kinds of tables, with a key that says which kind it is.
pub(crate) fn with_tag(tag: &str, word: &str, mut schema: Schema) -> Schema {
    if let Some(rules) = schema.as_object_mut() {
        add_tag(tag, word, rules);
    }
    schema
}

fn add_tag(tag: &str, word: &str, rules: &mut Map<String, Value>) {
    if let Some(Value::Array(kinds)) = rules.get_mut("oneOf") {
        kinds.iter_mut().filter_map(Value::as_object_mut).for_each(|kind| add_tag(tag, word, kind));
        return;
    }
    if let Some(Value::Object(properties)) = rules.get_mut("properties") {
        properties.insert(tag.to_owned(), json!({ "const": word }));
    }
    if let Some(Value::Array(required)) = rules.get_mut("required") {
        required.insert(0, json!(tag));
    }
}

/// A doc comment as running text.
pub(crate) fn text(doc: &str) -> String {
    doc.lines().map(str::trim).collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// More choices than this are listed without their meanings.
const MOST_EXPLAINED: usize = 6;

/// Words and what they mean, for a page of documentation.
pub(crate) fn choices(words: &[(&str, &str)]) -> String {
    let explained = words.len() <= MOST_EXPLAINED;
    let one = |(word, doc): &(&str, &str)| match explained {
        true => format!("`\"{word}\"`: {}", lower_first(text(doc).trim_end_matches('.'))),
        false => format!("`\"{word}\"`"),
    };
    words.iter().map(one).collect::<Vec<_>>().join(if explained { "; " } else { ", " })
}

/// A sentence as a part of another: a name in capitals keeps them.
fn lower_first(sentence: &str) -> String {
    let mut letters = sentence.chars();
    match (letters.next(), letters.clone().next()) {
        (Some(first), Some(second))
            if !second.is_uppercase() && !NAMES.iter().any(|name| sentence.starts_with(name)) =>
        {
            first.to_lowercase().chain(letters).collect()
        }
        _ => sentence.to_owned(),
    }
}

/// Names that keep their capital within a sentence.
const NAMES: [&str; 6] = ["Gaussian", "Henyey", "Owen", "Sobol", "Ward", "Monte Carlo"];

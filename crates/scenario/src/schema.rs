//! The JSON Schema of a scenario.

use papilio_display::{Label, label_from_name};
use schemars::generate::SchemaSettings;
use schemars::{Schema, SchemaGenerator};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::describe::File;
use crate::describe::microgeometry::SurfaceFile;
use crate::read::Read;

/// Returns the JSON Schema (draft 2020-12) of a scenario file: every key with its
/// meaning, unit, range and default.
pub fn schema() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<File>();
    schema.insert("title".to_owned(), json!("Papilio scenario"));
    schema.to_value()
}

/// Returns the JSON Schema (draft 2020-12) of a file of `papilio gonio`, as [`schema`].
pub fn surface_schema() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<SurfaceFile>();
    schema.insert("title".to_owned(), json!("Papilio surface"));
    schema.to_value()
}

/// A key of a table, for schema and documentation.
pub(crate) struct Row {
    pub(crate) key: &'static str,
    /// Meaning, without range and default.
    pub(crate) doc: String,
    /// Quantity in words, where the words of the key are not enough.
    label: Option<&'static str>,
    /// Default value, or the meaning of a missing key in words.
    pub(crate) default: Default,
    /// Possible values in words.
    words: fn() -> String,
    /// The same in Markdown, for the documentation.
    pub(crate) on_page: fn() -> String,
    schema: fn(&mut SchemaGenerator) -> Schema,
}

/// Meaning of a missing key.
pub(crate) enum Default {
    /// The key is required.
    Required,
    /// This value, with a remark.
    Value(Value, Option<String>),
    /// A meaning in words.
    Words(String),
}

impl Row {
    /// Creates the row of a key of type `T`. Its doc comment may end with "Default: " and the meaning of a
    /// missing key.
    pub(crate) fn new<T: Read + Serialize>(
        key: &'static str,
        doc: &str,
        label: Option<&'static str>,
        default: Option<T>,
    ) -> Self {
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
        let words = T::in_words;
        Self { key, doc, label, default, words, on_page: T::on_page, schema: T::schema_of_value }
    }

    /// Returns the label of the key: quantity and unit.
    pub(crate) fn label(&self) -> Label {
        let of_key = label_from_name(self.key);
        self.label.map_or_else(|| of_key.clone(), |quantity| Label::new(quantity, of_key.unit.as_str()))
    }

    /// Returns the meaning, with the range of a number and the default.
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

/// Returns the schema of a table with these keys.
pub(crate) fn of_table(rows: &[Row], doc: &str, generator: &mut SchemaGenerator) -> Schema {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for row in rows {
        let mut schema = (row.schema)(generator);
        let label = row.label();
        schema.insert("title".to_owned(), json!(label.quantity));
        if !label.unit.is_empty() {
            schema.insert("x-unit".to_owned(), json!(label.unit));
        }
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

/// Formats a value as TOML on one line.
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

/// Adds the key that selects the kind to the schema of a table, or of several kinds of tables.
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

/// Joins the lines of a doc comment.
pub(crate) fn text(doc: &str) -> String {
    doc.lines().map(str::trim).collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// Largest number of choices that are listed with their meanings.
const MOST_EXPLAINED: usize = 6;

/// Formats words with their meanings for the documentation.
pub(crate) fn choices(words: &[(&str, &str)]) -> String {
    let explained = words.len() <= MOST_EXPLAINED;
    let one = |(word, doc): &(&str, &str)| match explained {
        true => format!("`\"{word}\"`: {}", lower_first(text(doc).trim_end_matches('.'))),
        false => format!("`\"{word}\"`"),
    };
    words.iter().map(one).collect::<Vec<_>>().join(if explained { "; " } else { ", " })
}

/// Converts the first letter to lower case, except in names and abbreviations.
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

/// Names that keep their capital letter within a sentence.
const NAMES: [&str; 6] = ["Gaussian", "Henyey", "Owen", "Sobol", "Ward", "Monte Carlo"];

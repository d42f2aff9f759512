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

/// The keys of a table, as they are gathered.
#[derive(Default)]
pub(crate) struct Keys {
    properties: Map<String, Value>,
    required: Vec<&'static str>,
}

impl Keys {
    pub(crate) fn add<T: Read + Serialize>(
        &mut self,
        key: &'static str,
        doc: &str,
        default: Option<T>,
        generator: &mut SchemaGenerator,
    ) {
        let mut schema = T::schema_of_value(generator);
        schema.insert("description".to_owned(), json!(text(doc)));
        match default {
            Some(default) => {
                schema.insert("default".to_owned(), serde_json::to_value(default).unwrap_or_default());
            }
            None if T::absent().is_none() => self.required.push(key),
            None => {}
        }
        self.properties.insert(key.to_owned(), schema.to_value());
    }

    pub(crate) fn into_table(self, doc: &str) -> Schema {
        schemars::json_schema!({
            "type": "object",
            "description": text(doc),
            "properties": self.properties,
            "required": self.required,
            "additionalProperties": false,
        })
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
fn text(doc: &str) -> String {
    doc.lines().map(str::trim).collect::<Vec<_>>().join(" ").trim().to_owned()
}

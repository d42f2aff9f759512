//! Reading: from a tree to typed values. All mistakes of a table are reported, not only the first.

use std::borrow::Cow;
use std::ops::Deref;

use papilio_diagnostics::Diagnostic;
use papilio_formats::is_name;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use crate::error::Errors;
use crate::mistake;
use crate::origin::Origin;
use crate::schema::Row;
use crate::tree::{Entry, Node, Value};

/// A value and its place in the text. A default has the place of its table.
#[derive(Debug, Clone)]
pub(crate) struct Spanned<T> {
    pub(crate) value: T,
    pub(crate) origin: Origin,
}

/// A type that can be read from a tree.
pub(crate) trait Read: Sized + JsonSchema {
    /// Description of the value in words: "a number from 0 to 1".
    fn in_words() -> String;

    /// The same in Markdown, for the documentation.
    fn on_page() -> String {
        Self::in_words()
    }

    /// Reads the value, or reports at least one error.
    fn read(node: &Node, errors: &mut Errors) -> Option<Self>;

    /// The value of a missing key, if it may be missing.
    fn absent() -> Option<Self> {
        None
    }

    /// True if this is the value of a missing key.
    fn is_absent(&self) -> bool {
        false
    }

    /// JSON Schema of a value that is present; TOML has no null.
    fn schema_of_value(generator: &mut SchemaGenerator) -> Schema {
        generator.subschema_for::<Self>()
    }
}

/// A table with a fixed set of keys.
pub(crate) trait Table {
    fn keys() -> Vec<&'static str>;

    /// The keys for schema and documentation; none for a table whose kinds have keys of their own.
    fn rows() -> Vec<Row> {
        Vec::new()
    }
}

impl<T> Deref for Spanned<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> Spanned<T> {
    /// A value without a place in the text: a default.
    pub(crate) fn without_span(value: T) -> Self {
        Self { value, origin: Origin::FILE }
    }
}

impl<T: Read> Spanned<T> {
    pub(crate) fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        T::read(node, errors).map(|value| Self { value, origin: node.origin })
    }

    /// For serde, to skip absent values.
    pub(crate) fn is_absent(&self) -> bool {
        self.value.is_absent()
    }
}

impl<T: Serialize> Serialize for Spanned<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

impl Node {
    /// Reports a value of the wrong type.
    pub(crate) fn wrong_type<T>(&self, expected: impl Into<String>, errors: &mut Errors) -> Option<T> {
        let (expected, found) = (expected.into(), self.kind());
        let hint = match found {
            "a string" if expected.starts_with("a number") => Some(
                "write numbers without quotes, units and percent signs: the unit is in the key's name, and fractions are relative to 1",
            ),
            "a table" if expected.starts_with("a list, each item a table") => {
                Some("write its header in double brackets, once for each item, as in [[display.layers]]")
            }
            _ => None,
        };
        errors
            .push(self.origin, Diagnostic::new(format!("this is {found}")).expected(expected).hint_if(hint));
        None
    }

    /// Returns the number, which may be NaN or infinite; `None` for other types.
    pub(crate) fn number(&self) -> Option<f64> {
        match self.value {
            // Integers above 2^53 lose digits; no quantity is so large.
            Value::Integer(value) => Some(value as f64),
            Value::Float(value) => Some(value),
            _ => None,
        }
    }

    /// Checks that this is a table and that all its keys are `known`.
    pub(crate) fn known_entries(
        &self,
        known: &[&'static str],
        later: &[&'static str],
        errors: &mut Errors,
    ) -> Option<()> {
        let Value::Table(entries) = &self.value else {
            return self.wrong_type("a table", errors);
        };
        for Entry { key, key_origin, .. } in entries {
            if later.contains(&key.as_str()) {
                errors.push(*key_origin, mistake::not_in_this_version(key, &[]));
            } else if !known.contains(&key.as_str()) {
                errors.push(*key_origin, mistake::unknown_key(key, known));
            }
        }
        Some(())
    }

    /// Reads the value of `key`, or returns its default, or the value of a missing key.
    pub(crate) fn field<T: Read>(
        &self,
        key: &str,
        default: Option<T>,
        errors: &mut Errors,
    ) -> Option<Spanned<T>> {
        if let Some(node) = self.get(key) {
            return Spanned::read(node, errors);
        }
        let value = default.or_else(T::absent);
        if value.is_none() {
            errors.push(self.origin, mistake::missing_key(key, T::in_words()));
        }
        value.map(|value| Spanned { value, origin: self.origin })
    }
}

impl<T: Read> Read for Option<T> {
    fn in_words() -> String {
        T::in_words()
    }
    fn on_page() -> String {
        T::on_page()
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        T::read(node, errors).map(Some)
    }
    fn absent() -> Option<Self> {
        Some(None)
    }
    fn is_absent(&self) -> bool {
        self.is_none()
    }
    fn schema_of_value(generator: &mut SchemaGenerator) -> Schema {
        T::schema_of_value(generator)
    }
}

impl<T: Read> Read for Box<T> {
    fn in_words() -> String {
        T::in_words()
    }
    fn on_page() -> String {
        T::on_page()
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        T::read(node, errors).map(Self::new)
    }
}

impl<T: Table> Table for Box<T> {
    fn keys() -> Vec<&'static str> {
        T::keys()
    }
    fn rows() -> Vec<Row> {
        T::rows()
    }
}

impl Read for String {
    fn in_words() -> String {
        "a string".to_owned()
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match &node.value {
            Value::Text(text) => Some(text.clone()),
            _ => node.wrong_type(Self::in_words(), errors),
        }
    }
}

impl Read for bool {
    fn in_words() -> String {
        "true or false".to_owned()
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        match node.value {
            Value::Bool(value) => Some(value),
            _ => node.wrong_type(Self::in_words(), errors),
        }
    }
}

impl<T: Read> Read for Vec<Spanned<T>> {
    fn in_words() -> String {
        format!("a list, each item {}", T::in_words())
    }
    fn on_page() -> String {
        format!("a list, each item {}", T::on_page())
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Array(items) = &node.value else {
            return node.wrong_type(Self::in_words(), errors);
        };
        // All items are read first, so that every wrong one is reported.
        let before = errors.count();
        let items: Vec<Option<Spanned<T>>> = items.iter().map(|item| Spanned::read(item, errors)).collect();
        errors.of_whole_list(before, node);
        items.into_iter().collect()
    }
}

impl<T: JsonSchema> JsonSchema for Spanned<T> {
    fn schema_name() -> Cow<'static, str> {
        T::schema_name()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        T::json_schema(generator)
    }
    fn inline_schema() -> bool {
        T::inline_schema()
    }
}

/// Items with names of the user's choice, in the order of the text.
#[derive(Debug, Clone)]
pub(crate) struct Named<T>(pub(crate) Vec<Item<T>>);

/// A named item.
#[derive(Debug, Clone)]
pub(crate) struct Item<T> {
    pub(crate) name: String,
    pub(crate) name_origin: Origin,
    pub(crate) value: Spanned<T>,
}

impl<T> Named<T> {
    pub(crate) fn get(&self, name: &str) -> Option<&Spanned<T>> {
        self.0.iter().find(|item| item.name == name).map(|item| &item.value)
    }

    pub(crate) fn names(&self) -> Vec<String> {
        self.0.iter().map(|item| item.name.clone()).collect()
    }
}

impl<T: Read> Read for Named<T> {
    fn in_words() -> String {
        format!("a table of names, each with {}", T::in_words())
    }
    fn on_page() -> String {
        format!("a table of names, each with {}", T::on_page())
    }
    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Table(entries) = &node.value else {
            return node.wrong_type(Self::in_words(), errors);
        };
        let item = |entry: &Entry| {
            if !is_name(&entry.key) {
                errors.push(entry.key_origin, papilio_formats::Problem::BadName);
                return None;
            }
            let value = Spanned::read(&entry.node, errors)?;
            Some(Item { name: entry.key.clone(), name_origin: entry.key_origin, value })
        };
        let items: Vec<Option<Item<T>>> = entries.iter().map(item).collect();
        items.into_iter().collect::<Option<_>>().map(Self)
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|item| (&item.name, &item.value)))
    }
}

impl<T: JsonSchema> JsonSchema for Named<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("Named_{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let items = generator.subschema_for::<T>();
        schemars::json_schema!({ "type": "object", "additionalProperties": items })
    }
    fn inline_schema() -> bool {
        true
    }
}

/// Reports a word that is not one of the choices.
pub(crate) fn unknown_word<T>(
    node: &Node,
    word: &str,
    choices: &[&str],
    later: &[&str],
    errors: &mut Errors,
) -> Option<T> {
    if later.contains(&word) {
        errors.push(node.origin, mistake::not_in_this_version(word, choices));
    } else {
        errors.push(node.origin, mistake::unknown_choice(word, choices));
    }
    None
}

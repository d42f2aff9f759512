//! The numeric keys of files, by the schema, and their extreme values.

use std::collections::BTreeSet;

use serde_json::{Map, Value};

/// A number that a file may have.
pub(super) struct Key {
    pub(super) path: String,
    /// True for a list of numbers that the file does not have.
    is_list: bool,
    schema: Value,
}

/// Finds the keys of files.
pub(super) struct Keys {
    schema: Value,
    /// Names of all keys of a table, and of one of them.
    pub(super) known: BTreeSet<(String, String)>,
}

impl Keys {
    pub(super) fn new(schema: Value) -> Self {
        Self { schema, known: BTreeSet::new() }
    }

    /// The forms that a value may have, without references.
    fn forms<'a>(&'a self, schema: &'a Value) -> Vec<&'a Value> {
        let mut schema = schema;
        while let Some(name) = schema["$ref"].as_str() {
            schema = &self.schema["$defs"][name.rsplit('/').next().unwrap()];
        }
        let several = ["anyOf", "oneOf"].iter().filter_map(|name| schema[name].as_array()).flatten();
        let mut forms: Vec<&Value> = several.flat_map(|one| self.forms(one)).collect();
        if forms.is_empty() || schema["type"].is_string() {
            forms.push(schema);
        }
        forms
    }

    fn tables<'a>(&'a self, schema: &'a Value) -> Vec<&'a Map<String, Value>> {
        self.forms(schema)
            .into_iter()
            .filter(|form| form["properties"].is_object())
            .map(|form| form.as_object().unwrap())
            .collect()
    }

    fn numbers(&self, schema: &Value) -> Vec<Value> {
        let is_number = |form: &&Value| matches!(form["type"].as_str(), Some("number" | "integer"));
        self.forms(schema).into_iter().filter(is_number).cloned().collect()
    }

    /// True if a table has the keys of a form, and its words.
    fn fits(&self, form: &Map<String, Value>, table: &toml::Table) -> bool {
        let others = form.get("additionalProperties").is_some_and(Value::is_object);
        table.iter().all(|(key, value)| match form["properties"].get(key) {
            None => others,
            Some(schema) => {
                self.forms(schema).iter().any(|form| match (value.as_str(), &form["const"], &form["enum"]) {
                    (Some(word), Value::String(only), _) => word == only,
                    (Some(word), _, Value::Array(words)) => words.iter().any(|one| one == word),
                    _ => true,
                })
            }
        })
    }

    /// The keys of a file that are not known yet.
    pub(super) fn of(&mut self, file: &toml::Table) -> Vec<Key> {
        let mut found = Vec::new();
        let root = self.schema.clone();
        self.follow(&root, file, "", &mut found);
        found
    }

    fn follow(&mut self, schema: &Value, table: &toml::Table, path: &str, found: &mut Vec<Key>) {
        let forms: Vec<Map<String, Value>> =
            self.tables(schema).into_iter().filter(|form| self.fits(form, table)).cloned().collect();
        for form in forms {
            let properties = form["properties"].as_object().unwrap();
            let id = properties.keys().cloned().collect::<Vec<_>>().join(",");
            for (key, schema) in properties {
                let here = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                self.add(&id, key, &here, false, self.numbers(schema), found);
                let items: Vec<Value> = self
                    .forms(schema)
                    .into_iter()
                    .filter(|form| form["type"] == "array")
                    .map(|form| form["items"].clone())
                    .collect();
                match table.get(key) {
                    Some(toml::Value::Table(inner)) => self.follow(schema, inner, &here, found),
                    Some(toml::Value::Array(list)) => {
                        for (item, (number, element)) in items
                            .iter()
                            .flat_map(|item| list.iter().take(3).enumerate().map(move |at| (item, at)))
                        {
                            let here = format!("{here}.{number}");
                            match element {
                                toml::Value::Table(inner) => self.follow(item, inner, &here, found),
                                _ => self.add(
                                    &id,
                                    &format!("{key}.{number}"),
                                    &here,
                                    false,
                                    self.numbers(item),
                                    found,
                                ),
                            }
                        }
                    }
                    Some(_) => {}
                    None => {
                        for item in &items {
                            self.add(&id, &format!("{key}[]"), &here, true, self.numbers(item), found);
                        }
                        // A table of one number that needs no other key.
                        let optional: Vec<Map<String, Value>> = self
                            .tables(schema)
                            .into_iter()
                            .filter(|form| form["required"].as_array().is_none_or(Vec::is_empty))
                            .cloned()
                            .collect();
                        if !optional.is_empty() && self.numbers(schema).is_empty() {
                            self.follow_optional(&optional, &here, found);
                        }
                    }
                }
            }
            if let Some(others) = form.get("additionalProperties").filter(|others| others.is_object()) {
                let name = table.keys().find(|key| !properties.contains_key(*key));
                if let Some(name) = name {
                    let last = path.rsplit('.').next().unwrap().to_owned();
                    self.add("names", &last, &format!("{path}.{name}"), false, self.numbers(others), found);
                }
            }
        }
    }

    fn follow_optional(&mut self, forms: &[Map<String, Value>], path: &str, found: &mut Vec<Key>) {
        for form in forms {
            let properties = form["properties"].as_object().unwrap();
            let id = properties.keys().cloned().collect::<Vec<_>>().join(",");
            for (key, schema) in properties {
                self.add(&id, key, &format!("{path}.{key}"), false, self.numbers(schema), found);
            }
        }
    }

    fn add(
        &mut self,
        id: &str,
        key: &str,
        path: &str,
        is_list: bool,
        numbers: Vec<Value>,
        found: &mut Vec<Key>,
    ) {
        let is_new = !numbers.is_empty() && self.known.insert((id.to_owned(), key.to_owned()));
        let all = numbers.into_iter().filter(|_| is_new);
        found.extend(all.map(|schema| Key { path: path.to_owned(), is_list, schema }));
    }
}

impl Key {
    /// Values at the extremes, as TOML.
    pub(super) fn values(&self) -> Vec<String> {
        let is_integer = self.schema["type"] == "integer";
        let mut all: Vec<String> = match is_integer {
            true => ["0", "1", "1000", "1000000", "1000000000000000000"].map(str::to_owned).to_vec(),
            false => ["0.0", "1e-300", "1e-6", "1e6", "1e300"].map(str::to_owned).to_vec(),
        };
        for end in ["minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"] {
            let Some(end) = self.schema[end].as_f64() else { continue };
            match is_integer {
                true => all.extend([-1.0, 0.0, 1.0].map(|step| format!("{}", (end + step) as i64))),
                false => all.extend([end.next_down(), end, end.next_up()].map(|value| format!("{value:?}"))),
            }
        }
        all.dedup();
        match self.is_list {
            true => all.into_iter().map(|value| format!("[{value}]")).collect(),
            false => all,
        }
    }
}

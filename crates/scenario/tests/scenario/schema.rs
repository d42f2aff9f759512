//! The published JSON Schema: shipped scenarios satisfy it, wrong ones violate it.

use crate::common::{GOOD, changed, shipped};
use serde_json::Value;

/// Validator for the part of JSON Schema that the scenario's schema uses.
fn valid(schema: &Value, root: &Value, value: &Value) -> bool {
    let Some(rules) = schema.as_object() else { return schema.as_bool() != Some(false) };
    rules.iter().all(|(rule, with)| match rule.as_str() {
        "$ref" => {
            let target = with.as_str().and_then(|path| root.pointer(path.trim_start_matches('#')));
            target.is_some_and(|schema| valid(schema, root, value))
        }
        "type" => match with.as_str() {
            Some("object") => value.is_object(),
            Some("array") => value.is_array(),
            Some("string") => value.is_string(),
            Some("boolean") => value.is_boolean(),
            Some("integer") => value.is_i64(),
            Some("number") => value.is_number(),
            other => panic!("an unknown type: {other:?}"),
        },
        "enum" => with.as_array().unwrap().contains(value),
        "const" => with == value,
        "minimum" => value.as_f64().is_none_or(|v| v >= with.as_f64().unwrap()),
        "maximum" => value.as_f64().is_none_or(|v| v <= with.as_f64().unwrap()),
        "exclusiveMinimum" => value.as_f64().is_none_or(|v| v > with.as_f64().unwrap()),
        "exclusiveMaximum" => value.as_f64().is_none_or(|v| v < with.as_f64().unwrap()),
        "items" => value.as_array().is_none_or(|items| items.iter().all(|item| valid(with, root, item))),
        "required" => with.as_array().unwrap().iter().all(|key| value.get(key.as_str().unwrap()).is_some()),
        "anyOf" => with.as_array().unwrap().iter().any(|schema| valid(schema, root, value)),
        "allOf" => with.as_array().unwrap().iter().all(|schema| valid(schema, root, value)),
        "oneOf" => with.as_array().unwrap().iter().filter(|schema| valid(schema, root, value)).count() == 1,
        "properties" => value.as_object().is_none_or(|object| {
            object.iter().all(|(key, value)| with.get(key).is_none_or(|schema| valid(schema, root, value)))
        }),
        "additionalProperties" => value.as_object().is_none_or(|object| {
            let known = rules.get("properties");
            let mut others =
                object.iter().filter(|(key, _)| known.is_none_or(|known| known.get(key).is_none()));
            others.all(|(_, value)| valid(with, root, value))
        }),
        "$schema" | "$defs" | "title" | "description" | "default" | "examples" | "format" | "x-unit" => true,
        other => panic!("an unknown rule: {other}"),
    })
}

fn satisfies_schema(text: &str) -> bool {
    let schema = papilio_scenario::schema();
    let value: Value = toml::from_str(text).unwrap();
    valid(&schema, &schema, &value)
}

#[test]
fn shipped_scenarios_satisfy_the_schema() {
    for entry in std::fs::read_dir(shipped()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|end| end == "toml") {
            assert!(satisfies_schema(&std::fs::read_to_string(&path).unwrap()), "{}", path.display());
        }
    }
    assert!(satisfies_schema(GOOD));
}

#[test]
fn wrong_scenarios_violate_the_schema() {
    for (from, to) in [
        ("haze", "hase"),
        ("haze = 0.78", "haze = 78"),
        ("model = \"film\"", "model = \"table\""),
        ("model = \"film\"\n", ""),
        ("thickness_nm = 12", "thickness_nm = -5"),
        ("\"gap\"", "\"gab\""),
        ("theta_deg = 8", "theta_deg = \"8\""),
        ("[viewer]", "[sweep]"),
        ("\"k-correlation\"", "\"slab\""),
        ("[viewer]", "[[display.layers]]\nkind = \"coating\"\n[viewer]"),
        ("[viewer]", "[[display.layers]]\nkind = \"medium\"\nalpha = 0.1\n[viewer]"),
        ("[viewer]", "[[display.layers]]\nindex = 1.5\n[viewer]"),
        ("[viewer]", "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"slab\"\n[viewer]"),
    ] {
        assert!(!satisfies_schema(&changed(&[(from, to)])), "{to}");
    }
}

/// Every key says what it is, and every description of a number names its unit or range.
#[test]
fn all_keys_have_descriptions() {
    fn look(schema: &Value, seen: &mut usize) {
        let Some(object) = schema.as_object() else { return };
        if let Some(properties) = object.get("properties").and_then(Value::as_object) {
            for (key, property) in properties.iter().filter(|(_, property)| property.get("const").is_none()) {
                let description = property.get("description").and_then(Value::as_str).unwrap_or_default();
                assert!(description.ends_with('.'), "`{key}` says `{description}`");
                *seen += 1;
            }
        }
        for part in object.values() {
            match part {
                Value::Array(items) => items.iter().for_each(|item| look(item, seen)),
                part => look(part, seen),
            }
        }
    }
    let mut seen = 0;
    look(&papilio_scenario::schema(), &mut seen);
    assert!(seen > 50, "{seen}");
}

/// docs/scenario.md is the page of every key: its tables are made of the grammar. `cargo xtask docs` writes
/// them.
#[test]
fn tables_of_keys_in_the_docs_are_those_of_the_grammar() {
    let path = shipped().join("../docs/scenario.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let made = papilio_scenario::with_key_tables(&page).unwrap();
    if std::env::var_os("PAPILIO_WRITE_DOCS").is_some() {
        return std::fs::write(&path, &made).unwrap();
    }
    let differs = made.lines().zip(page.lines()).find(|(made, page)| made != page);
    assert!(made == page, "docs/scenario.md is out of date, run `cargo xtask docs`: {differs:?}");
}

/// The lists of materials, illuminants and old names in the docs. `cargo xtask docs` writes them.
#[test]
fn tables_of_materials_illuminants_and_old_names_in_the_docs_are_those_of_the_program() {
    for (name, marker) in [
        ("films.md", "<!-- materials -->"),
        ("light.md", "<!-- illuminants -->"),
        ("versions.md", "<!-- old names -->"),
    ] {
        let path = shipped().join("../docs").join(name);
        let page = std::fs::read_to_string(&path).unwrap();
        assert!(page.contains(marker), "{name}");
        let made = papilio_scenario::with_catalogue_tables(&page).unwrap();
        if std::env::var_os("PAPILIO_WRITE_DOCS").is_some() {
            std::fs::write(&path, &made).unwrap();
            continue;
        }
        let differs = made.lines().zip(page.lines()).find(|(made, page)| made != page);
        assert!(made == page, "docs/{name} is out of date, run `cargo xtask docs`: {differs:?}");
    }
}

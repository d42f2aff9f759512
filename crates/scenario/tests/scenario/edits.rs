//! Edits lose no comment, except those of a table or an item that they remove: each line of the shipped
//! scenarios gets a comment that no other has, and each key every kind of edit.

use papilio_scenario::{Edit, edit};
use papilio_testing::sized;
use serde_json::{Value, json};

use crate::common::shipped;

/// A text in which each line ends with a comment of its own and has another one above it, and their number.
fn commented(text: &str) -> (String, usize) {
    let (mut all, mut count, mut is_in_string) = (String::new(), 0, false);
    let mut mark = || {
        count += 1;
        format!("#~{count}~")
    };
    for line in text.lines() {
        if is_in_string || line.contains("\"\"\"") {
            is_in_string ^= line.matches("\"\"\"").count() == 1;
            all += &format!("{line}\n");
        } else {
            all += &format!("{}\n{line} {}\n", mark(), mark());
        }
    }
    (all, count)
}

/// Every path of a value.
fn paths(value: &Value, above: &str, found: &mut Vec<(String, Value)>) {
    let entries: Vec<(String, &Value)> = match value {
        Value::Object(keys) => keys.iter().map(|(key, value)| (key.clone(), value)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(at, value)| (at.to_string(), value)).collect(),
        _ => Vec::new(),
    };
    for (key, value) in entries {
        let path = if above.is_empty() { key } else { format!("{above}.{key}") };
        paths(value, &path, found);
        found.push((path, value.clone()));
    }
}

/// Edits of a key that remove nothing but a plain value.
fn edits(path: &str, value: &Value) -> Vec<Edit> {
    let set = |value: Value| Edit::Set { path: path.to_owned(), value };
    match value {
        Value::Object(keys) => {
            let mut fewer = keys.clone();
            let first = keys.keys().next().cloned();
            first.iter().for_each(|key| drop(fewer.remove(key)));
            let more: serde_json::Map<String, Value> =
                keys.clone().into_iter().chain([("new".to_owned(), json!(1))]).collect();
            vec![set(fewer.into()), set(more.into()), set(json!(3))]
        }
        Value::Array(items) => {
            let mut edits = vec![set(json!([])), set(json!([1, 2]))];
            let mut some = items.clone();
            some.pop();
            edits.push(set(some.into()));
            let item = items.first().cloned().unwrap_or(json!(1));
            for index in [Some(0), Some(items.len() / 2), None] {
                edits.push(Edit::Insert { path: path.to_owned(), index, value: item.clone() });
            }
            if items.len() > 1 {
                edits.push(Edit::Move { path: path.to_owned(), from: 0, to: items.len() - 1 });
                edits.push(Edit::Move { path: path.to_owned(), from: items.len() - 1, to: 0 });
            }
            edits
        }
        _ => {
            let mut edits =
                vec![set(json!(0.125)), set(json!("name")), set(json!([1, 2, 3])), set(json!({ "a": 1 }))];
            if path.rsplit('.').next().is_some_and(|key| key.parse::<usize>().is_err()) {
                edits.push(Edit::Remove { path: path.to_owned() });
            }
            edits
        }
    }
}

/// The comments that a text lacks.
fn lacking(text: &str, count: usize) -> Vec<usize> {
    (1..=count).filter(|number| text.matches(&format!("#~{number}~")).count() != 1).collect()
}

#[test]
fn every_comment_of_a_text_is_there_after_an_edit_that_removes_no_table() {
    let files = std::fs::read_dir(shipped()).unwrap().map(|entry| entry.unwrap().path());
    let mut scenarios: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    scenarios.sort();
    let stride = sized(29, 1);
    let (mut tried, mut made) = (0, 0);
    for path in scenarios {
        let (text, count) = commented(&std::fs::read_to_string(&path).unwrap());
        let value: Value = serde_json::to_value(toml::from_str::<toml::Table>(&text).unwrap()).unwrap();
        let mut found = Vec::new();
        paths(&value, "", &mut found);
        for one in found.iter().flat_map(|(path, value)| edits(path, value)) {
            tried += 1;
            if tried % stride != 0 {
                continue;
            }
            // What cannot be a scenario is refused; nothing else is of interest here.
            if let Ok(edited) = edit(&text, std::slice::from_ref(&one)) {
                made += 1;
                assert_eq!(lacking(&edited, count), [0; 0], "{}: {one:?}\n{edited}", path.display());
            }
        }
    }
    assert!(made > sized(200, 6000), "{made} of {tried} edits");
}

const PANEL: &str = r#"# Of the title.
title = "A"

# Above the front.
[[display.front]] # a touch panel
reflectance = 0.005
absorptance = 0.01 # measured

# Above the diffuser.
[display.diffuser] # as bought
model = "k-correlation"
haze = 0.78 # H78
total_transmittance = 0.9

[display.glass]
index = 1.5 # BK7
surface = "ideal-ar" # none

[display.pixel]
model = "film"
film = [ # from the top
  # the spacer
  { material = "SiO2", thickness_nm = 38.6 }, # thin
  { material = "AlOx", thickness_nm = 9.0 }, # thinner
  # the gap
  { material = "air", thickness_nm = "gap" } # last
]
"#;

fn edited(edits: Value) -> String {
    let edits: Vec<Edit> = serde_json::from_value(edits).unwrap();
    edit(PANEL, &edits).unwrap()
}

#[test]
fn panel_that_becomes_layers_keeps_its_comments_at_their_keys() {
    let text = edited(json!([
        { "op": "transfer", "path": "display.front.0", "to": "display.layers", "index": 0 },
        { "op": "set", "path": "display.layers.0.kind", "value": "component" },
        { "op": "transfer", "path": "display.diffuser", "to": "display.layers", "index": 1 },
        { "op": "set", "path": "display.layers.1.kind", "value": "diffuser" },
        { "op": "insert", "path": "display.layers", "index": 2, "value": { "kind": "medium", "index": "air" } },
        { "op": "transfer", "path": "display.glass", "to": "display.layers", "index": 3 },
        { "op": "remove", "path": "display.layers.3.surface" },
        { "op": "set", "path": "display.layers.3.kind", "value": "medium" },
    ]));
    for part in [
        "# Above the front.\n[[display.layers]] # a touch panel\nkind = \"component\"\nreflectance = 0.005\nabsorptance = 0.01 # measured\n",
        "# Above the diffuser.\n[[display.layers]] # as bought\nkind = \"diffuser\"\nmodel = \"k-correlation\"\nhaze = 0.78 # H78\n",
        "[[display.layers]]\nkind = \"medium\"\nindex = \"air\"\n",
        "[[display.layers]]\nkind = \"medium\"\nindex = 1.5 # BK7\n# none\n",
    ] {
        assert!(text.contains(part), "{part}\nin\n{text}");
    }
    let value: toml::Table = toml::from_str(&text).unwrap();
    let display = value["display"].as_table().unwrap();
    assert_eq!(display["layers"].as_array().unwrap().len(), 4);
    assert!(
        !display.contains_key("front") && !display.contains_key("diffuser") && !display.contains_key("glass")
    );
}

#[test]
fn comments_move_with_their_items_and_leave_with_them() {
    let film = |text: &str| text[text.find("film = [").unwrap()..].to_owned();
    let moved = film(&edited(json!([{ "op": "move", "path": "display.pixel.film", "from": 1, "to": 0 }])));
    let wanted = "film = [ # from the top\n  { material = \"AlOx\", thickness_nm = 9.0 }, # thinner\n  # the spacer\n  { material = \"SiO2\", thickness_nm = 38.6 }, # thin\n  # the gap\n";
    assert!(moved.starts_with(wanted), "{moved}");
    let removed = film(&edited(json!([{ "op": "remove", "path": "display.pixel.film.0" }])));
    assert!(
        removed.starts_with(
            "film = [ # from the top\n  { material = \"AlOx\", thickness_nm = 9.0 }, # thinner\n  # the gap\n"
        ),
        "{removed}"
    );
    assert!(!removed.contains("spacer") && !removed.contains("thin\n"), "{removed}");
    let without = edited(json!([{ "op": "remove", "path": "display.diffuser" }]));
    assert!(
        !without.contains("H78") && !without.contains("as bought") && without.contains("# measured"),
        "{without}"
    );
}

#[test]
fn comment_of_a_key_that_is_gone_becomes_a_line() {
    let text = edited(json!([{ "op": "remove", "path": "display.diffuser.haze" }]));
    assert!(text.contains("model = \"k-correlation\"\n# H78\ntotal_transmittance = 0.9\n"), "{text}");
    let replaced = edited(json!([
        { "op": "set", "path": "display.diffuser", "value": { "model": "lambertian", "total_transmittance": 0.5 } }
    ]));
    assert!(replaced.contains("[display.diffuser] # as bought\nmodel = \"lambertian\"\n"), "{replaced}");
    assert!(replaced.contains("# H78\n") && replaced.contains("total_transmittance = 0.5\n"), "{replaced}");
}

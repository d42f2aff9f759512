//! A wrong value has one message at its place.

use std::path::Path;

use papilio_display::DisplayError;
use papilio_scenario::{Edit, Interface, Scenario, ScenarioErrors, edit, text_of};
use serde_json::{Value, json};

use crate::common::{GOOD, LAYERED, resolve, shipped};

/// Paths of all values of a scenario, tables included.
fn paths(node: &Value, path: &str, found: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let path = if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
        found.push(path.clone());
        paths(value, &path, found);
    };
    match node {
        Value::Object(table) => table.iter().for_each(|(key, value)| below(key, value)),
        Value::Array(items) => {
            items.iter().enumerate().take(2).for_each(|(at, item)| below(&at.to_string(), item));
        }
        _ => {}
    }
}

fn lines(errors: &ScenarioErrors) -> Vec<(Option<(usize, usize)>, String)> {
    errors.iter().map(|error| (error.place.line_column(), error.diagnostic.message.clone())).collect()
}

/// Every value of several scenarios, defaults included, is replaced by wrong ones of each kind: no place has two
/// messages.
#[test]
fn wrong_value_has_one_message_at_its_place() {
    let wrong = [
        json!(-1),
        json!(1e30),
        json!(0.5),
        json!("x"),
        json!("none.csv"),
        json!(true),
        json!([]),
        json!([5, 1]),
        json!([[500, -1]]),
        json!({}),
        json!({ "from": 1 }),
        json!([{}]),
    ];
    let halftone = std::fs::read_to_string(shipped().join("halftone.toml")).unwrap();
    let mut mistakes = 0;
    for text in [GOOD.to_owned(), LAYERED.to_owned(), halftone] {
        let read = |text: &str| Scenario::from_text(text, "s.toml", &shipped(), &[]);
        let filled = serde_json::to_value(read(&text).unwrap().filled()).unwrap();
        let mut all = Vec::new();
        paths(&filled, "", &mut all);
        for (path, value) in all.iter().flat_map(|path| wrong.iter().map(move |value| (path, value))) {
            let set = Edit::Set { path: path.clone(), value: value.clone() };
            let Ok(text) = edit(&text, &[set]) else { continue };
            let Err(errors) = read(&text).and_then(|one| one.resolve().map(drop)) else { continue };
            let all = lines(&errors);
            let mut places: Vec<_> = all.iter().map(|(place, _)| *place).collect();
            places.dedup();
            assert_eq!(places.len(), all.len(), "{path} = {value}: {all:?}");
            mistakes += 1;
        }
    }
    assert!(mistakes > 1000, "{mistakes}");
}

/// A list whose items are all of the same wrong type is one mistake, not one for each item; keys that a table
/// lacks are named together.
#[test]
fn mistakes_of_one_kind_are_named_once() {
    let of = |set: &str| lines(&resolve(GOOD, Path::new(""), &[set]).unwrap_err());
    for (set, message) in [
        ("lighting.spectrum=[500, 600, 700]", "each item of this list is a number"),
        ("display.front=[1, 2]", "each item of this list is a number"),
        ("viewer.theta_deg={}", "the keys `from`, `to` and `step` are missing"),
        ("display.pixel.film.0={}", "the keys `material` and `thickness_nm` are missing"),
        ("display.pixel.film.0={ thickness_nm = 3 }", "the key `material` is missing"),
    ] {
        let all = of(set);
        assert!(all.len() == 1 && all[0].1 == message, "{set}: {all:?}");
    }
    // Items that are wrong in different ways are mistakes of their own.
    assert_eq!(of("display.front=[1, \"a\"]").len(), 2);
    let errors = resolve(GOOD, Path::new(""), &["viewer.theta_deg={}"]).unwrap_err().to_string();
    assert!(errors.contains("expected `from`: a number"), "{errors}");
}

/// Errors of a computation, whose remedies are keys and options of a call: each interface has its own words. The command line accepts
/// what it proposes; no other interface has its options.
#[test]
fn remedies_are_in_the_words_of_each_interface() {
    let resolved = resolve(GOOD, Path::new(""), &[]).unwrap();
    let narrow =
        |what: &str| DisplayError::TooNarrow { what: what.to_owned(), number: 1, nodes: 9000, most: 500 };
    let errors = [
        narrow("a diffuser"),
        DisplayError::TooNarrowInField { width: 1e-6, least: 1e-4, light: "is diffuse" },
        DisplayError::OneView { what: "sharpness", views: 3 },
        DisplayError::NoMatrix { command: "mtf" },
        DisplayError::TooThick { thickness_mm: 9.0, pitch_mm: 0.1, most: 50.0 },
        DisplayError::PlacesByPaths { what: "a mirror".to_owned(), key: "display.glass".to_owned() },
        DisplayError::Azimuth { what: "a sum", key: "solver.method", hint: "use the Monte Carlo solver" },
    ];
    let is_option =
        |word: &str| word.strip_prefix("--").is_some_and(|name| name.starts_with(char::is_alphabetic));
    for error in &errors {
        let located = resolved.located(error).unwrap();
        let [shell, python, page] = [Interface::CommandLine, Interface::Python, Interface::Page].map(|one| {
            (
                located.text(one),
                located.iter().filter_map(|error| error.help(one)).collect::<Vec<_>>().join("\n"),
            )
        });
        assert_eq!(located.to_string(), shell.0);
        for (text, help) in [&python, &page] {
            assert!(!text.split_whitespace().any(is_option), "{text}");
            assert!(help.lines().all(|help| text.contains(help)), "{text}\n{help}");
        }
        assert!(python.1.contains("set={\"") && page.1.contains(" = "), "{}\n{}", python.1, page.1);
        let words: Vec<&str> = shell.1.split_whitespace().collect();
        let sets: Vec<String> =
            words.windows(2).filter(|pair| pair[0] == "--set").map(|pair| pair[1].to_owned()).collect();
        assert!(!sets.is_empty(), "{}", shell.1);
        let read = Scenario::from_text(GOOD, "s.toml", Path::new(""), &sets);
        assert!(read.is_ok(), "{sets:?}: {}", read.unwrap_err());
    }
    let rows = DisplayError::RowsTooUncertain {
        table: "cone",
        count: 2,
        of: 4,
        most: 1e-3,
        named: "row 1".to_owned(),
        more: "",
        enough: 0.032,
    };
    for (interface, words) in [
        (Interface::CommandLine, "--allow-error 0.032"),
        (Interface::Python, "allow_error=0.032"),
        (Interface::Page, "allow error = 0.032"),
    ] {
        assert!(text_of(&rows, interface).ends_with(words), "{}", text_of(&rows, interface));
    }
}

//! `papilio migrate`, and the notes on old names of commands that read a scenario.

use std::fs;
use std::process::Output;

use serde_json::Value;

use crate::common::{papilio, place, stderr, stdout};

const OLD: &str = r#"# Mine.
[solver]
method = "walk" # the reference
paths = 64
[display.pixel]
model = "uniform"
kind = "mirror"
reflectance = { white = 0.5, black = 0.1 }
"#;

const STUDIES: &str = r#"
[[sweep.axes]]
"solver.every_bin" = [true, false]
[[optimize.variables]]
key = "display.pixel.reflectance.white"
bounds = [0.4, 0.6]
[[optimize.conditions]]
name = "all"
set = { "solver.every_bin" = true }
[[optimize.objectives]]
metric = "white.Y"
aim = "maximise"
[tolerance]
samples = 64
[[tolerance.keys]]
key = "display.glass.surface"
choices = { values = ["coated", "fresnel"] }
"#;

#[test]
fn migrate_replaces_old_names_and_keeps_the_rest() {
    let (_folder, file, _) = place(OLD);
    let listed = papilio(&["migrate", &file, "--dry-run"]);
    assert!(
        listed.status.success() && stdout(&listed).contains(":3: \"walk\" -> \"monte-carlo\""),
        "{listed:?}"
    );
    assert_eq!(fs::read_to_string(&file).unwrap(), OLD, "--dry-run writes nothing");
    let before = papilio(&["run", &file, "--json"]);
    let written = papilio(&["migrate", &file]);
    assert!(stderr(&written).contains("1 name replaced"), "{written:?}");
    let new = fs::read_to_string(&file).unwrap();
    let expected = OLD.replace("walk", "monte-carlo").replace("# Mine.\n", "format = 2\n\n# Mine.\n");
    assert_eq!(new, expected);
    let after = papilio(&["run", &file, "--json"]);
    let without_notes = |output| {
        let mut result: Value = serde_json::from_str(&stdout(output)).unwrap();
        result.as_object_mut().unwrap().remove("notes");
        result
    };
    assert_eq!(without_notes(&before), without_notes(&after));
    let again = papilio(&["migrate", &file]);
    assert!(stderr(&again).contains("nothing was changed") && stdout(&again).is_empty(), "{again:?}");
}

#[test]
fn migrate_prints_json_and_writes_to_another_file() {
    let (folder, file, _) = place(OLD);
    let other = folder.path().join("new.toml");
    let output = papilio(&["migrate", &file, "--out", other.to_str().unwrap(), "--json"]);
    let json: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(json["renamed"][0]["line"], 3);
    assert_eq!(json["text"].as_str().unwrap(), fs::read_to_string(&other).unwrap());
    assert_eq!(fs::read_to_string(&file).unwrap(), OLD);
}

#[test]
fn mistakes_that_are_not_old_names_are_named() {
    let (_folder, file, _) = place(&OLD.replace("paths", "pathes"));
    let output = papilio(&["migrate", &file]);
    let text = stderr(&output);
    assert!(output.status.success() && text.contains("1 name replaced"), "{text}");
    // The place in the new text, which has two lines more.
    assert!(text.contains("warning: other mistakes remain") && text.contains(":6:1"), "{text}");
    assert!(text.contains("there is no key `pathes` here"), "{text}");
}

#[test]
fn invalid_files_are_not_migrated() {
    for (text, message) in [
        ("[solver]\nevery_bin = true\nper_wavelength = true\n", "two names of one key"),
        ("format = 9\n", "format 9"),
        ("not a scenario", "error"),
        ("", "is not a scenario"),
        ("title = \"mine\"\n[solver]\nevery_bin = true\n", "is not a scenario"),
    ] {
        let (_folder, file, _) = place(text);
        let output = papilio(&["migrate", &file]);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(stderr(&output).contains(message), "{output:?}");
        assert_eq!(fs::read_to_string(&file).unwrap(), text);
    }
}

#[test]
fn studies_have_notes_on_old_names() {
    let (_, display) = OLD.split_once("paths = 64\n").unwrap();
    let (_folder, file, out) = place(&format!("{display}{STUDIES}"));
    for (command, old) in [("sweep", "every_bin"), ("optimize", "every_bin"), ("tolerance", "coated")] {
        let output = papilio(&[command, &file, "--json", "--out", &format!("{out}-{command}")]);
        let text = stderr(&output);
        assert!(output.status.success(), "{command}: {text}");
        assert_notes_are_written(command, &output, old);
        let notes = text.lines().filter(|line| line.starts_with("note: ") && line.contains(old)).count();
        assert_eq!(notes, 1, "{command}: {text}");
    }
}

/// The JSON of a command has the notes that it prints, of which one is about `what`.
fn assert_notes_are_written(command: &str, output: &Output, what: &str) {
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let written: Vec<&str> =
        json["notes"].as_array().unwrap().iter().map(|note| note.as_str().unwrap()).collect();
    let printed = stderr(output);
    assert!(written.iter().any(|note| note.contains(what)), "{command}: {written:?}");
    assert!(written.iter().all(|note| printed.contains(&format!("note: {note}"))), "{command}: {printed}");
}

#[test]
fn json_of_other_commands_has_their_notes() {
    let (_, display) = OLD.split_once("[display.pixel]").unwrap();
    let text =
        format!("[solver]\nevery_bin = true\n[display.pixel]{display}[display.glass]\nthickness_mm = 0.5\n");
    let (_folder, file, _) = place(&text);
    for command in ["run", "gloss", "palette", "pixel", "mtf"] {
        let output = papilio(&[command, &file, "--json", "--set", "spectrum.step_nm=20"]);
        assert!(output.status.success(), "{command}: {}", stderr(&output));
        assert_notes_are_written(command, &output, "every_bin");
    }
}

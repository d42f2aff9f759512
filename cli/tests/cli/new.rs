//! `papilio new`: scenarios from presets.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn papilio(arguments: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_papilio")).env("NO_COLOR", "1").args(arguments).output().unwrap()
}

/// Every preset runs unchanged, without a warning.
#[test]
fn every_preset_runs_without_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let unknown = papilio(&[Path::new("new"), Path::new("nowhere")]);
    assert_eq!(unknown.status.code(), Some(2));
    let said = String::from_utf8(unknown.stderr).unwrap();
    let presets = said.split_once("the presets are ").unwrap().1.trim();
    assert!(presets.split(", ").count() >= 13, "{said}");
    for name in presets.split(", ") {
        let file = folder.path().join(name).with_extension("toml");
        let new = papilio(&[Path::new("new"), Path::new(name), &file]);
        assert!(new.status.success(), "{name}: {}", String::from_utf8_lossy(&new.stderr));
        assert!(fs::read_to_string(&file).unwrap().starts_with("# "), "{name}");
        let run = papilio(&[Path::new("run"), &file, Path::new("--json")]);
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.success() && !said.contains("warning"), "{name}: {said}");
        let result: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        assert!(result["views"][0]["contrast_ratio"].as_f64().unwrap() > 2.0, "{name}");
    }
}

#[test]
fn printed_command_quotes_a_file_name_with_a_space() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("my office.toml");
    let output = papilio(&[Path::new("new"), Path::new("office"), &file]);
    let said = String::from_utf8(output.stderr).unwrap();
    let quote = if cfg!(windows) { '"' } else { '\'' };
    assert!(said.contains(&format!("papilio run {quote}{}{quote}", file.display())), "{said}");
}

#[test]
fn existing_file_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mine.toml");
    fs::write(&file, "mine").unwrap();
    let output = papilio(&[Path::new("new"), Path::new("office"), &file]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("already exists"));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
    let nowhere = folder.path().join("none").join("x.toml");
    let output = papilio(&[Path::new("new"), Path::new("office"), &nowhere]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("none does not exist") && said.contains("help: create it"), "{said}");
    let printed = papilio(&[Path::new("new"), Path::new("office")]).stdout;
    assert_eq!(papilio(&[Path::new("new"), Path::new("office"), Path::new("-")]).stdout, printed);
    assert!(String::from_utf8(printed).unwrap().contains("illuminance_lx = 500") && !Path::new("-").exists());
}

#[test]
fn name_that_is_no_preset_has_a_suggestion() {
    for (arguments, suggestion) in [
        (
            &["six-ink", "x.toml"][..],
            "six-ink is a display: papilio new --display six-ink --light office x.toml",
        ),
        (&["ofice"], "did you mean `office`?"),
        (&["--light", "livingroom"], "did you mean `living-room`?"),
    ] {
        let arguments: Vec<&Path> = ["new"].iter().chain(arguments).map(Path::new).collect();
        let output = papilio(&arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(suggestion), "{said}");
    }
}

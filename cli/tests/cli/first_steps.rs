//! The first day: new scenarios, quiet runs, a scenario from standard input, completions, the page of a run.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::common::{stderr, stdout};

fn papilio_in(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_papilio"))
        .env("NO_COLOR", "1")
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Every display in every light is written as a scenario that runs without a warning.
#[test]
fn every_display_runs_in_a_room_outdoors_and_in_a_measuring_geometry() {
    let folder = tempfile::tempdir().unwrap();
    for display in ["imod", "epaper", "table"] {
        for light in ["living-room", "daylight", "iec-directional", "d8-included"] {
            let file = format!("{display}-{light}.toml");
            let new = papilio_in(folder.path(), &["new", "--display", display, "--light", light, &file]);
            assert!(new.status.success(), "{display} {light}: {}", stderr(&new));
            let run = papilio_in(folder.path(), &["run", &file, "--json"]);
            assert!(
                run.status.success() && !stderr(&run).contains("warning"),
                "{display} {light}: {}",
                stderr(&run)
            );
            let result: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
            let contrast = result["views"][0]["contrast_ratio"].as_f64().unwrap();
            assert!(contrast > 2.0, "{display} {light}: {contrast}");
        }
    }
    assert!(folder.path().join("example-pixel.csv").is_file(), "the example of a table");
}

#[test]
fn new_scenario_of_a_display_states_what_is_missing_or_in_the_way() {
    let folder = tempfile::tempdir().unwrap();
    let new = |arguments: &[&str]| papilio_in(folder.path(), &[&["new"], arguments].concat());
    let without_file = new(&["--display", "table", "--light", "office"]);
    assert!(stdout(&without_file).contains("example-pixel.csv"));
    assert!(stderr(&without_file).contains("note: the scenario names the file example-pixel.csv"));
    let positional = new(&["office", "--display", "epaper"]);
    assert_eq!(stdout(&positional), stdout(&new(&["--display", "epaper", "--light", "office"])));
    for (arguments, says) in [
        (&["--display", "epaper"][..], "the preset of the light is missing"),
        (&["--light", "nowhere"], "unknown preset `nowhere`"),
        (&["--display", "epaper", "a.toml"], "a file comes after the preset of its light"),
        (&["office", "a.toml", "--light", "office"], "the light is specified twice"),
        (&["--display", "lcd", "--light", "office"], "possible values: imod, epaper, table"),
    ] {
        let wrong = new(arguments);
        assert_eq!(wrong.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&wrong).contains(says), "{arguments:?}: {}", stderr(&wrong));
    }
    fs::write(folder.path().join("example-pixel.csv"), "mine").unwrap();
    let wrong = new(&["--display", "table", "--light", "office", "t.toml"]);
    assert!(stderr(&wrong).contains("example-pixel.csv already exists"), "{}", stderr(&wrong));
    assert!(!folder.path().join("t.toml").exists());
}

/// With `--quiet`, only warnings and errors are printed, and JSON.
#[test]
fn quiet_command_prints_warnings_errors_and_json_only() {
    let folder = tempfile::tempdir().unwrap();
    assert!(papilio_in(folder.path(), &["new", "office", "s.toml"]).status.success());
    for command in [
        &["run", "s.toml", "--quiet"][..],
        &["-q", "pixel", "s.toml"],
        &["brdf", "s.toml", "-q", "--step", "45"],
    ] {
        let silent = papilio_in(folder.path(), command);
        let said: String = stderr(&silent).lines().filter(|line| !line.starts_with("warning")).collect();
        assert!(silent.status.success() && silent.stdout.is_empty(), "{command:?}");
        assert!(command[0] == "brdf" || said.is_empty(), "{command:?}: {said}");
    }
    assert!(folder.path().join("out/s/result.json").is_file());
    let json = papilio_in(folder.path(), &["run", "s.toml", "--quiet", "--json"]);
    assert!(stdout(&json).starts_with('{') && stderr(&json).is_empty());
    let warned = papilio_in(
        folder.path(),
        &["run", "s.toml", "--quiet", "--json", "--set", "display.pixel.film.1.thickness_nm=0.3"],
    );
    assert!(
        stderr(&warned).contains("warning: ") && !stderr(&warned).contains("note: "),
        "{}",
        stderr(&warned)
    );
    let wrong = papilio_in(folder.path(), &["run", "none.toml", "--quiet"]);
    assert!(stderr(&wrong).contains("there is no such file"));
}

/// A scenario from standard input gives the bytes of the same file; its files are in the current folder.
#[test]
fn scenario_from_standard_input_equals_that_from_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    assert!(papilio_in(here, &["new", "--display", "table", "--light", "office", "s.toml"]).status.success());
    let text = fs::read(here.join("s.toml")).unwrap();
    let piped = |arguments: &[&str]| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_papilio"))
            .env("NO_COLOR", "1")
            .current_dir(here)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(&text).unwrap();
        child.wait_with_output().unwrap()
    };
    let set = ["--set", "viewer.theta_deg=10"];
    let one = piped(&[&["run", "-", "--json"], &set[..]].concat());
    let other = papilio_in(here, &[&["run", "s.toml", "--json"], &set[..]].concat());
    assert!(one.status.success() && one.stdout == other.stdout, "{}", stderr(&one));
    let pixel = piped(&["pixel", "-"]);
    assert!(pixel.status.success() && here.join("out/stdin/pixel.csv").is_file(), "{}", stderr(&pixel));
    let wrong = piped(&["run", "-", "--set", "viewer.theta=1"]);
    assert_eq!(wrong.status.code(), Some(2));
    let sweep = piped(&["sweep", "-"]);
    assert!(stderr(&sweep).contains("standard input"), "{}", stderr(&sweep));
}

#[test]
fn completions_name_the_commands_for_every_shell() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = stdout(&papilio_in(Path::new("."), &["completions", shell]));
        for word in ["papilio", "optimize", "inspect", "relative"] {
            assert!(word == "relative" || script.contains(word), "{shell}: {word}");
        }
    }
    let wrong = papilio_in(Path::new("."), &["completions", "tcsh"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn manual_has_a_page_for_each_command_with_its_options() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let written = papilio_in(here, &["man", "--out", "share/man1"]);
    assert!(written.status.success() && stderr(&written).contains("wrote share/man1: papilio.1 and "));
    let page = |name: &str| fs::read_to_string(here.join("share/man1").join(name)).unwrap();
    assert!(page("papilio.1").starts_with(".ie"), "roff");
    for command in ["run", "optimize", "sweep-merge", "diffuser-inspect", "man"] {
        assert!(page("papilio.1").contains(command.split('-').next().unwrap()), "{command}");
        assert!(page(&format!("papilio-{command}.1")).contains(".SH OPTIONS"), "{command}");
    }
    assert!(
        page("papilio-run.1").contains("fB\\-\\-solver") && !here.join("share/man1/papilio-help.1").exists()
    );
    fs::write(here.join("file"), "").unwrap();
    let failed = papilio_in(here, &["man", "--out", "file"]);
    assert_eq!(failed.status.code(), Some(2), "{}", stderr(&failed));
}

/// The page has the figures and tables in itself, and loads nothing.
#[test]
fn page_of_a_run_is_complete_and_self_contained() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    assert!(papilio_in(here, &["new", "--display", "table", "--light", "indoor", "s.toml"]).status.success());
    let text = fs::read_to_string(here.join("s.toml")).unwrap();
    fs::write(
        here.join("s.toml"),
        text.replacen("title = \"table, indoor\"", "title = \"<b>Mine</b> & yours\"", 1),
    )
    .unwrap();
    let run = papilio_in(here, &["run", "s.toml", "--report", "--set", "viewer.theta_deg=[8,20]"]);
    assert!(run.status.success() && stderr(&run).contains("report.html"), "{}", stderr(&run));
    let page = fs::read_to_string(here.join("out/s/report.html")).unwrap();
    let result: serde_json::Value =
        serde_json::from_slice(&fs::read(here.join("out/s/result.json")).unwrap()).unwrap();
    assert!(page.contains(result["hash"].as_str().unwrap()));
    assert!(page.contains("<h1>&lt;b&gt;Mine&lt;/b&gt; &amp; yours</h1>") && !page.contains("<b>Mine"));
    for words in [
        "Seen from 8 deg",
        "Seen from 20 deg",
        "energy balance",
        "example-pixel.csv",
        "k-correlation",
        "discretisation error",
        "illuminance_lx",
        "Notes",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let y = result["views"][0]["states"]["white"]["Y"].as_f64().unwrap();
    assert!(page.contains(&format!("<td>{y:.4}</td>")), "{y}");
    assert!(
        page.matches("<svg").count() >= 2 && page.matches("<svg").count() == page.matches("</svg>").count()
    );
    // No address is loaded; the names of XML namespaces are not addresses.
    let loads = ["src=", "<link", "<script", "@import", "url(http"];
    assert!(loads.iter().all(|load| !page.contains(load)));
    let without_names = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!without_names.contains("http"), "an address");
    // Identifiers of the figures differ.
    let ids: Vec<&str> = page.split("id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    let mut unique = ids.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(unique.len(), ids.len());
    let refused = papilio_in(here, &["run", "s.toml", "--report", "--json"]);
    assert_eq!(refused.status.code(), Some(2));
}

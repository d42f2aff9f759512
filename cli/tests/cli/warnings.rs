//! Warnings of a scenario: each command that prints them has them in its JSON.

use serde_json::Value;

use crate::common::{papilio, place, scenario, stderr};

/// A warning of a spectrum of which colours see a part only.
const NARROW: &str = "spectrum.range_nm=[450,650]";
const WORDS: &str = "colours are computed from 450 to 650 nm only";

/// A study of each kind.
const STUDIES: &str = r#"
[tolerance]
samples = 64
sensitivity_samples = 0
keys = [{ key = "display.pixel.film.1.thickness_nm", normal = { sigma = 0.3 } }]
[optimize]
starts = 1
evaluations = 10
variables = [{ key = "display.pixel.film.1.thickness_nm", bounds = [3, 25] }]
objectives = [{ metric = "gamut_percent_srgb", aim = "maximise" }]
conditions = [{ name = "here" }, { name = "beside", set = { "spectrum.range_nm" = [460, 640] } }]
[sweep]
axes = [{ "display.pixel.film.1.thickness_nm" = [6, 14] }]
"#;

#[test]
fn warnings_that_a_command_prints_are_in_its_json() {
    let display = crate::optimize::SCENARIO.split("[optimize]").next().unwrap();
    let (folder, file, out) = place(&format!("{display}{STUDIES}"));
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (panel, result) = (path("panel.csv"), path("run"));
    std::fs::write(&panel, "state,X,Y,Z\nwhite,0.2,0.2,0.2\n").unwrap();
    let [gloss, palette] = ["epaper", "six-ink"].map(|name| scenario(name).display().to_string());
    let commands: [(&[&str], &str); 11] = [
        (&["run", &file, "--out", &result], "/warnings"),
        (&["pixel", &file], "/warnings"),
        (&["compare", &file, &panel], "/warnings"),
        (&["compare", &result, &panel], "/warnings"),
        (&["sweep", &file, "--out", &out], "/points/1/warnings"),
        (&["sweep", &file, "--out", &out, "--metrics", "white.Y"], "/warnings"),
        (&["tolerance", &file, "--out", &out], "/warnings"),
        (&["optimize", &file, "--out", &out], "/warnings"),
        (&["optimize", &file, "--out", &out, "--no-check"], "/warnings"),
        (&["gloss", &gloss], "/warnings"),
        (&["palette", &palette], "/warnings"),
    ];
    for (command, pointer) in commands {
        let set: &[&str] = if command[1] == result { &[] } else { &["--set", NARROW] };
        let output = papilio(&[command, set, &["--json"]].concat());
        assert!(output.status.success(), "{command:?}: {}", stderr(&output));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        let said: Vec<&str> =
            json.pointer(pointer).unwrap().as_array().unwrap().iter().filter_map(Value::as_str).collect();
        let count = said.iter().filter(|one| one.contains(WORDS)).count();
        assert_eq!(count, 1, "{command:?}: {said:?}");
        // What is printed of several points states their number first.
        for line in stderr(&output).lines().filter_map(|line| line.strip_prefix("warning: ")) {
            assert!(said.iter().any(|one| line.ends_with(one)), "{command:?}: {line}\n{said:?}");
        }
        let beside = said.iter().any(|one| one.contains("from 460"));
        assert_eq!(beside, command[0] == "optimize", "{command:?}: {said:?}");
    }
}

//! `papilio crosstalk`: its files, its JSON and its messages.

use std::fs;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

fn run(name: &str, more: &[&str]) -> std::process::Output {
    papilio().arg("crosstalk").arg(scenario(name)).args(more).output().unwrap()
}

/// Pixels inside which light spreads, below the diffuser of the example: only Monte Carlo computes them.
const SPREAD: &str = "display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.5, black = 0.1 }, spread_um = 5 }";

#[test]
fn crosstalk_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = ["--out", folder.path().to_str().unwrap(), "--set", "spectrum.step_nm=40"];
    let output = run("matrix", &out);
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("seen through, from") && printed.contains("stripe_1"), "{printed}");
    assert_eq!(names(folder.path()), ["crosstalk.csv", "crosstalk.json", "crosstalk.svg", "patterns.csv"]);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let head = "theta_deg,phi_deg,light,way,window,subpixel,share,error";
    assert_eq!(read("crosstalk.csv").lines().next(), Some(head));
    // Three windows and the inactive area, for all light and two lights.
    assert_eq!(read("crosstalk.csv").lines().count(), 1 + 3 * 3 * 4);
    assert_eq!(read("patterns.csv").lines().count(), 1 + 4);
    let result: serde_json::Value = serde_json::from_str(&read("crosstalk.json")).unwrap();
    let view = &result["views"][0];
    assert_eq!(result["subpixels"], serde_json::json!(["red", "green", "blue"]));
    let row: f64 = view["out"][0].as_array().unwrap().iter().map(|share| share.as_f64().unwrap()).sum();
    assert!((row - 1.0).abs() < 1e-12, "{view}");
    assert!(view["own_share_out"].is_f64() && view["in"].is_null() && view["own_share_in"].is_null());
    assert_eq!(view["patterns"][2]["name"], "line_1");
    assert!(view["patterns"][2]["contrast_ratio_via_pixel"].is_f64());
}

#[test]
fn missing_matrix_and_thickness_are_reported() {
    for (name, sets, expected) in [
        ("indoor", &["--json"][..], "the key `display.matrix` is missing"),
        (
            "epaper",
            &["--json", "--set", "display.matrix.ppi=300"],
            "the key `display.glass.thickness_mm` is missing",
        ),
        // All at once.
        ("epaper", &["--json"], "the key `display.matrix` is missing"),
        ("epaper", &["--json"], "--set display.glass.thickness_mm=0.5"),
        // Of a table that does not exist.
        ("six-ink", &["--json"], "the key `display.glass.thickness_mm` is missing"),
        ("matrix", &["--json", "--set", SPREAD], "monte-carlo"),
        // A pitch in mm.
        (
            "matrix",
            &["--json", "--set", "display.matrix={ pitch_um = 0.08467 }"],
            "as thick as a pixel is wide",
        ),
    ] {
        let output = run(name, sets);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{name}: {message}");
        assert!(message.contains(expected), "{message}");
    }
}

/// Metrics of crosstalk in a sweep: own shares and gamut against the height of a printed filter, each
/// followed by its error; and what a run does not compute is named.
#[test]
fn crosstalk_is_a_metric_of_sweeps() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario("printed-filter");
    let run = |more: &[&str]| {
        let mut command = papilio();
        command.arg("sweep").arg(&file).arg("--out").arg(folder.path());
        command.args(["--set", "spectrum.step_nm=40"]).args(more).output().unwrap()
    };
    let height = "sweep.axes.0={ display.matrix.filter.height_um = [5, 60] }";
    let output = run(&["--set", height]);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let at = |row: usize, name: &str| -> f64 {
        let column = rows[0].iter().position(|head| *head == name).unwrap_or_else(|| panic!("{table}"));
        rows[row][column].parse().unwrap()
    };
    for name in ["patch_gamut_percent_srgb", "line_1_gamut_percent_srgb", "own_share_in", "own_share_out"] {
        assert!(at(1, name) > at(2, name), "{name}: {table}");
        let error = at(2, &format!("{name}_de"));
        assert!((0.0..0.05 * at(2, name)).contains(&error), "{name}: {table}");
    }
    let message = |more: &[&str]| {
        let output = run(more);
        assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
        stderr(&output)
    };
    let target = message(&["--set", "solver.target={ metric = \"own_share_in\", error = 0.01 }"]);
    assert!(target.contains("cannot be a target") && target.contains("papilio crosstalk"), "{target}");
}

/// The other solver has the same files, with errors of its own; what adding refuses names it.
#[test]
fn paths_compute_what_adding_refuses() {
    let coarse = ["--json", "--set", "spectrum.step_nm=80"];
    let paths = ["--solver", "monte-carlo", "--set", "solver.paths=4096", "--threads", "2"];
    let output = run("matrix", &[&coarse[..], &paths].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let view = &result["views"][0];
    assert_eq!(result["scenario"]["solver"]["method"], "monte-carlo");
    // The colours of the display, too.
    let colours =
        papilio().arg("run").arg(scenario("printed-filter")).args(paths).arg("--json").output().unwrap();
    assert!(colours.status.success(), "{}", stderr(&colours));
    assert!(view["error"].as_f64().is_some_and(|error| error > 1e-4 && error < 0.1), "{view}");
    assert!(view["patterns"][3]["contrast_ratio"].is_f64(), "{view}");
    let layers = |kind: &str| {
        format!(
            "display={{ pixel = {{ model = \"uniform\", kind = \"{kind}\", reflectance = {{ one = 0.5, two = 0.1 }} }}, \
             matrix = {{ ppi = 200 }}, layers = [{{ kind = \"fresnel\" }}, \
             {{ kind = \"medium\", index = 1.5, thickness_mm = 0.1 }}, {{ kind = \"fresnel\" }}, \
             {{ kind = \"medium\", index = 1.6, thickness_mm = 0.1 }}] }}"
        )
    };
    let mirrors = layers("mirror");
    let refused = stderr(&run("matrix", &[&coarse[..], &["--set", &mirrors]].concat()));
    assert!(
        refused.contains("--set solver.method=monte-carlo") && refused.contains("display.layers"),
        "{refused}"
    );
    let paper = layers("lambertian");
    let general = ["--set", &paper];
    let output = run("matrix", &[&coarse[..], &general].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let output = run("matrix", &[&coarse[..], &general, &paths].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let why = result["views"][0]["patterns"][0]["why_null"].as_str().unwrap().to_owned();
    assert!(why.contains("no state has these names"), "{why}");
}

/// The folder of a result that replaces no other one is named once it is written, not before a refusal.
#[test]
fn folders_are_named_after_success() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let mut command = papilio();
        command.arg("crosstalk").arg(scenario("matrix")).current_dir(folder.path());
        command.args(["--set", "spectrum.step_nm=80", "--set", "pattern.text=l"]).args(more).output().unwrap()
    };
    assert!(run(&[]).status.success());
    let refused = run(&["--set", SPREAD]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(!stderr(&refused).contains("is not replaced"), "{}", stderr(&refused));
    let other = run(&["--set", "viewer.theta_deg=20"]);
    let said = stderr(&other);
    let [note, wrote] = ["is not replaced", "wrote "].map(|words| said.find(words).unwrap());
    assert!(other.status.success() && note < wrote, "{said}");
}

//! The progress of commands, as a log shows it: it never goes back, and says what is done.

use std::path::Path;

use crate::common::{papilio_command, place, scenario, stderr};
use crate::optimize::{SCENARIO, SECOND_AIM};

/// The lines of progress of a command, printed as often as possible.
fn lines(arguments: &[&str]) -> Vec<String> {
    let output = papilio_command().env("PAPILIO_PROGRESS_SECONDS", "0.001").args(arguments).output().unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    stderr(&output).lines().filter(|line| line.contains(" % done")).map(str::to_owned).collect()
}

/// Asserts that per cents never fall, and returns the lines.
fn never_back(arguments: &[&str]) -> Vec<String> {
    let lines = lines(arguments);
    let percent = |line: &String| line.split(' ').next().unwrap().parse::<u32>().unwrap();
    let percents: Vec<u32> = lines.iter().map(percent).collect();
    assert!(lines.len() > 1, "{arguments:?}: no progress");
    assert!(percents.is_sorted() && percents.iter().all(|one| *one <= 100), "{arguments:?}: {lines:#?}");
    lines
}

/// Runs of several views by both solvers, with and without maps; passes of a table of a layered display; the
/// search of a front, and the check of each of its designs.
#[test]
fn progress_never_goes_back() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let [indoor, layers] = ["indoor", "two-diffusers"].map(|name| scenario(name).display().to_string());
    let several = ["--set", "viewer.theta_deg=[0,10,20,30]", "--set", "spectrum.step_nm=40"];
    let run = |file, more: &[&str]| never_back(&[&["run", file, "--out", out], &several[..], more].concat());
    run(&indoor, &["--solver", "monte-carlo", "--set", "solver.relative_error=0.0005"]);
    run(&indoor, &["--cone"]);
    run(&layers, &[]);
    let (_folder, file, out) = place(&format!("{SCENARIO}{SECOND_AIM}"));
    never_back(&["optimize", &file, "--out", &out, "--set", "solver.relative_error=0.005"]);
}

/// While all directions are computed there is no error: none is shown, nor a target of another step.
#[test]
fn progress_of_tables_says_what_is_done() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let coarse = ["--set", "spectrum.step_nm=80", "--out", out];
    let file = scenario("indoor").display().to_string();
    for (more, unit) in
        [(&["--step", "15"][..], "rows"), (&["--step", "30", "--format", "radiant"][..], "parts")]
    {
        let lines = never_back(&[&["brdf", &file], &coarse[..], more].concat());
        let of_table = lines.iter().filter(|line| line.contains(&format!("{unit} done")));
        assert!(of_table.clone().count() > 0, "{lines:#?}");
        assert!(of_table.clone().all(|line| !line.contains("relative error")), "{lines:#?}");
        assert!(!lines.iter().any(|line| line.contains("target 100.00 %")), "{lines:#?}");
    }
    assert!(Path::new(out).join("reflection.csv").exists());
}

/// A wrong interval is named, and does not end the command.
#[test]
fn wrong_interval_of_progress_is_a_warning() {
    let file = scenario("reference-pixel").display().to_string();
    for wrong in ["soon", "0", "-1"] {
        let output = papilio_command()
            .env("PAPILIO_PROGRESS_SECONDS", wrong)
            .args(["run", &file, "--json"])
            .output()
            .unwrap();
        assert!(output.status.success());
        let said = stderr(&output);
        assert!(said.contains(&format!("PAPILIO_PROGRESS_SECONDS = \"{wrong}\" is not")), "{said}");
    }
}

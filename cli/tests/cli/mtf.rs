//! `mtf`: its files, its JSON and its messages.

use std::fs;

use papilio_testing::sized;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

fn run(more: &[&str]) -> std::process::Output {
    papilio().arg("mtf").arg(scenario("laminated-text")).args(more).output().unwrap()
}

const COARSE: [&str; 2] = ["--set", "spectrum.step_nm=40"];
const FRONT: [&str; 2] = ["--set", "display.front=[{ reflectance = 0.05, gap_mm = 0.2 }]"];

#[test]
fn mtf_writes_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let out = ["--out", folder.path().to_str().unwrap()];
    let output = run(&[&out[..], &COARSE].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(printed.contains("MTF at Nyquist") && printed.contains("white on black"), "{printed}");
    let expected = [
        "edges.svg",
        "kernel-black.npy",
        "kernel-black.svg",
        "kernel-white.npy",
        "kernel-white.svg",
        "mtf.csv",
        "mtf.json",
        "mtf.svg",
        "spread.csv",
    ];
    assert_eq!(names(folder.path()), expected);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    let head = "theta_deg,phi_deg,light,state,axis,frequency_per_mm,cycles_per_degree,mtf,phase_rad,error";
    assert_eq!(read("mtf.csv").lines().next(), Some(head));
    let head = "theta_deg,phi_deg,light,state,axis,position_um,line_spread_per_mm,edge_spread,error";
    assert_eq!(read("spread.csv").lines().next(), Some(head));
    let result: serde_json::Value = serde_json::from_str(&read("mtf.json")).unwrap();
    let view = &result["views"][0];
    assert!(view["states"]["white"]["by_light"]["directed.0"]["otf_x"][0][0].as_f64() == Some(1.0), "{view}");
    assert!(
        view["line_contrast"]["white_1_x"].as_f64().unwrap()
            < view["line_contrast"]["black_1_x"].as_f64().unwrap()
    );
    assert!(view["text_contrast_min"].is_f64() && view["yule_nielsen_n"].is_f64());
}

#[test]
fn missing_thickness_is_reported_at_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(scenario("laminated-text")).unwrap();
    let file = folder.path().join("s.toml");
    let without: String = text
        .lines()
        .filter(|line| !line.starts_with("thickness_mm"))
        .map(|line| format!("{line}\n"))
        .collect();
    fs::write(&file, without).unwrap();
    let output = papilio().arg("mtf").arg(&file).arg("--json").output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("thickness_mm") && said.contains("s.toml:"), "{said}");
    // A pitch of zero, and a pattern of states that do not exist.
    for set in ["display.matrix.ppi=0", "pattern.period_mm=[0]"] {
        let output = run(&["--json", "--set", set]);
        assert_eq!(output.status.code(), Some(2), "{set}: {}", stderr(&output));
    }
    let output = run(&["--json", "--set", "pattern={ period_mm = [1], on = \"red\" }"]);
    assert!(stderr(&output).contains("red"), "{}", stderr(&output));
}

/// Half of the modulation at the Nyquist frequency of 300 pixels per inch below 0.537 mm, by a sweep and by a
/// search; errors of the metrics' conditions are named.
#[test]
fn sharpness_is_a_metric_of_sweeps_and_searches() {
    let folder = tempfile::tempdir().unwrap();
    let file = scenario("laminate-thickness");
    let run = |command: &str, more: &[&str]| {
        let out = folder.path().join(command);
        let output = papilio().arg(command).arg(&file).arg("--out").arg(&out).args(more).output().unwrap();
        (output, out)
    };
    let coarse = ["--set", "spectrum.step_nm=100"];
    let (output, out) = run("sweep", &coarse);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = fs::read_to_string(out.join("sweep.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|head| *head == name).unwrap();
    let at = |thickness: &str, name: &str| -> f64 {
        let row = rows.iter().find(|row| row[1] == thickness).unwrap();
        row[column(name)].parse().unwrap()
    };
    assert!((at("0.5", "white.mtf_nyquist_x") - 0.526_884).abs() < 2e-5, "{table}");
    assert!(at("0.1", "line_contrast_white_1_x") > at("0.8", "line_contrast_white_1_x"), "{table}");
    // The check by the other solver walks five seconds.
    let short = ["--no-check", "--set", "optimize.starts=1", "--set", "optimize.evaluations=20"];
    let (output, out) = run("optimize", &[&coarse[..], sized(&short[..], &[])].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let best = fs::read_to_string(out.join("best.toml")).unwrap();
    assert!(best.contains("thickness_mm = 0.537"), "{best}");
    // The table: the scenario's value and the best one, then that of both solvers.
    let printed = String::from_utf8(output.stdout).unwrap();
    let lines =
        printed.lines().filter(|line| line.contains("Modulation transfer of white at Nyquist along x"));
    let values: Vec<Vec<f64>> =
        lines.map(|line| line.split_whitespace().filter_map(|cell| cell.parse().ok()).collect()).collect();
    assert!((values[0][0] - 0.526_884).abs() < 2e-5 && (values[0][1] - 0.5).abs() < 1e-3, "{printed}");
    assert_eq!(values.len(), sized(1, 2), "{printed}");
    if let Some(checked) = values.get(1) {
        assert!((checked[0] - 0.5).abs() < 1e-3 && (checked[1] - 0.5).abs() < 0.01, "{printed}");
    }
    let (output, _) = run("sweep", &["--set", "sweep.metrics=[\"ppd\"]"]);
    assert!(!output.status.success() && stderr(&output).contains("[sparkle]"), "{}", stderr(&output));
}

/// A face by waves has twenty lobes at each wavelength: sharpness below it is left to Monte Carlo, at once
/// and with its hint.
#[test]
fn sharpness_below_a_face_by_waves_is_left_to_monte_carlo() {
    let mtf = |solver: &[&str]| {
        let sets = ["--set", "spectrum.step_nm=100", "--set", "viewer.theta_deg=8", "--json"];
        papilio().arg("mtf").arg(scenario("hazy-face")).args(sets).args(solver).output().unwrap()
    };
    let refused = mtf(&[]);
    assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
    let message = stderr(&refused);
    assert!(message.contains("faces by waves") && message.contains("monte-carlo"), "{message}");
    let computed = mtf(&["--solver", "monte-carlo", "--set", "solver.paths=2048"]);
    assert!(computed.status.success(), "{}", stderr(&computed));
}

/// `solver.relative_error` is the target of transfers, too: a smaller one is met by finer levels, which agree
/// within the errors, and one that cannot be met is a warning, in the JSON too.
#[test]
fn target_of_a_transfer_is_met_or_reported() {
    let at = |name: &str, target: &str, more: &[&str]| {
        let set = format!("solver.relative_error={target}");
        let sets = [&["--json", "--set", &set], &COARSE[..], more].concat();
        let output = papilio().arg("mtf").arg(scenario(name)).args(sets).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (result, stderr(&output))
    };
    let ((coarse, said), (fine, _), (_, impossible)) =
        (at("matrix", "0.05", &[]), at("matrix", "1e-6", &[]), at("matrix", "1e-6", &FRONT));
    let error = |result: &serde_json::Value| result["error_reached"].as_f64().unwrap();
    assert!(!said.contains("is not met") && error(&coarse) <= 0.05, "{said}");
    assert!(error(&fine) < error(&coarse), "{} {}", error(&fine), error(&coarse));
    let otf = |result: &serde_json::Value| -> Vec<f64> {
        let all = result["views"][0]["states"]["white"]["otf"]["otf_x"].as_array().unwrap();
        all.iter().map(|value| value[0].as_f64().unwrap()).collect()
    };
    let apart = otf(&coarse).iter().zip(otf(&fine)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart <= 1.5 * error(&coarse), "{apart}");
    // What a front returns through the lobe is estimated: no level removes this error.
    assert!(impossible.contains("warning: solver.relative_error = 0.000001 is not met"), "{impossible}");
}

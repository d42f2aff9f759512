//! `mtf`: its files, its JSON and its messages.

use std::fs;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

fn run(more: &[&str]) -> std::process::Output {
    papilio().arg("mtf").arg(scenario("laminated-text")).args(more).output().unwrap()
}

const COARSE: [&str; 2] = ["--set", "spectrum.step_nm=40"];

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
        "kernel-white.npy",
        "kernel_black.svg",
        "kernel_white.svg",
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

//! `papilio pixel`: scans as tables that `model = "table"` reads.

use std::fs;
use std::path::Path;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

#[test]
fn pixel_scan_is_written_as_a_pixel_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = papilio().arg("pixel").arg(scenario("indoor")).args(["--out", out]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(folder.path()), ["about.json", "pixel.csv", "pixel.svg"]);
    let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
    assert_eq!(csv.lines().next().unwrap(), "state,theta_deg,wavelength_nm,reflectance");
    assert_eq!(csv.lines().count(), 1 + 8 * 91 * 81);
}

/// The way in and out for other pixel tools: the scan of a film pixel, read back as a table,
/// shows the same display. Angles in glass, so that the table reaches all light.
#[test]
fn pixel_scan_read_back_gives_the_same_display() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let bare = scenario("reference-pixel");
    let output = papilio().arg("pixel").arg(&bare).arg("--out").arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let film = fs::read_to_string(&bare).unwrap();
    let (before, rest) = film.split_once("[display.pixel]").unwrap();
    let after = &rest[rest.find("[lighting]").unwrap()..];
    let table = "[display.pixel]\nmodel = \"table\"\nfile = \"pixel.csv\"\nangles = \"glass\"\n\n";
    fs::write(path("table.toml"), format!("{before}{table}{after}")).unwrap();
    let white = |file: &Path| {
        let output = papilio()
            .arg("run")
            .arg(file)
            .args(["--json", "--set", "viewer.theta_deg=8.5"])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        result["views"][0]["states"]["white"]["Y"].as_f64().unwrap()
    };
    let (from_film, from_table) = (white(&bare), white(&path("table.toml")));
    // Midway between the table's angles linear interpolation is at its worst.
    assert!((from_film - from_table).abs() < 2e-4 * from_film, "{from_film} {from_table}");
}

#[test]
fn pixel_scan_in_glass_is_accepted_below_any_front() {
    let folder = tempfile::tempdir().unwrap();
    let scan = |angles: &str| {
        let arguments = ["--angles", angles, "--step", "45", "--out", folder.path().to_str().unwrap()];
        let output = papilio().arg("pixel").arg(scenario("indoor")).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let csv = fs::read_to_string(folder.path().join("pixel.csv")).unwrap();
        assert_eq!(csv.lines().count(), 1 + 8 * 3 * 81);
        let white = csv.lines().find(|line| line.starts_with("white,45,550,")).unwrap();
        white.rsplit(',').next().unwrap().parse::<f64>().unwrap()
    };
    // At 45 deg in glass light is reflected at the air gap, at 45 deg in air it is not.
    assert!((scan("glass") - scan("air")).abs() > 0.05);
}

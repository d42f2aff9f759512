//! `papilio gloss`: its files and table, and its metrics in a sweep.

use std::fs;

use serde_json::Value;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

#[test]
fn gloss_is_printed_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output = papilio().arg("gloss").arg(scenario("epaper")).args(["--out", out]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("Gloss at 60° (GU)") && text.contains("white"), "{text}");
    assert_eq!(names(folder.path()), ["gloss.csv", "gloss.json"]);
    let csv = fs::read_to_string(folder.path().join("gloss.csv")).unwrap();
    assert!(csv.starts_with("state,metric,value,error\nwhite,gloss_20,"), "{csv}");
    let json: Value = serde_json::from_slice(&fs::read(folder.path().join("gloss.json")).unwrap()).unwrap();
    let (white, black) = (&json["states"]["white"], &json["states"]["black"]);
    assert!(white["gloss_60"].as_f64() > black["gloss_60"].as_f64(), "{json}");
}

/// A compact sweep over the index of glass reports gloss with its error: it increases with the index.
#[test]
fn gloss_is_a_metric_of_sweeps() {
    let folder = tempfile::tempdir().unwrap();
    let output = papilio()
        .arg("sweep")
        .arg(scenario("epaper"))
        .args([
            "--set",
            "sweep={ metrics = ['black.gloss_60'], axes = [{ 'display.glass.index' = [1.4, 1.5, 1.7] }] }",
        ])
        .args(["--out", folder.path().to_str().unwrap()])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let csv = fs::read_to_string(folder.path().join("sweep.csv")).unwrap();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| head.iter().position(|one| *one == name).unwrap();
    let (gloss, error) = (column("black.gloss_60"), column("black.gloss_60_de"));
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    assert!(rows.len() == 3 && rows.windows(2).all(|pair| pair[0][gloss] < pair[1][gloss]), "{csv}");
    assert!(rows.iter().all(|row| row[error] >= 0.0), "{csv}");
}

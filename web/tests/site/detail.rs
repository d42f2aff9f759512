//! Sharpness, crosstalk and sparkle.

use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_scenario::Scenario;
use serde_json::{Value, json};

use crate::answers::{events, indoor};
use crate::client::Server;

fn names(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect()
}

/// Tables and figures are those of the command line, numbers those of the library.
#[test]
fn sharpness_and_crosstalk_equal_the_command_line() {
    let server = Server::start();
    let scenario = server.get("/api/v1/examples/matrix").json()["scenario"].clone();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/matrix.toml");
    let resolved = Scenario::load(path.as_ref(), &[]).unwrap().resolve().unwrap();
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let ask = |command: &str| {
        let answer = server.post("/detail", &json!({ "scenario": scenario, "command": command }));
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()
    };
    let number = |seen: &Value, metric: &str, state: Value| {
        let all = seen["numbers"].as_array().unwrap();
        let one = all.iter().find(|one| one["metric"] == metric && one["state"] == state).unwrap().clone();
        (one["value"].as_f64().unwrap(), one["error"].as_f64().unwrap())
    };

    let seen = ask("mtf");
    let wanted = papilio_display::spatial::mtf(&resolved.scene, &resolved.patterns, &control).unwrap();
    let mut csv = Vec::new();
    papilio_formats::write_mtf_csv(&mut csv, &wanted).unwrap();
    assert_eq!(names(&seen["tables"]), ["mtf", "spread"]);
    assert_eq!(seen["tables"][0]["csv"].as_str().unwrap().as_bytes(), csv);
    let figures = papilio_figures::of_mtf(&wanted, resolved.title.as_deref().unwrap());
    let figures: Vec<Value> =
        figures.into_iter().map(|(name, svg)| json!({ "name": name, "svg": svg })).collect();
    assert_eq!(seen["figures"], Value::Array(figures));
    let white = wanted.views[0].states.get("white").unwrap();
    let expected = (white.scalars.mtf_nyquist_x.unwrap(), white.error.mtf_nyquist_x.unwrap());
    assert_eq!(number(&seen, "mtf_nyquist_x", json!("white")), expected);
    let (line, _) = number(&seen, "line_contrast_white_1_x", Value::Null);
    assert_eq!(Some(line), wanted.views[0].line_contrast.white_1_x);

    let seen = ask("crosstalk");
    let wanted = papilio_display::spatial::crosstalk(&resolved.scene, "", &control).unwrap();
    assert_eq!(names(&seen["tables"]), ["crosstalk", "patterns"]);
    let (own, _) = number(&seen, "own_share_out", Value::Null);
    assert_eq!(Some(own), wanted.views[0].shares.own_share_out);
}

/// A sweep that names metrics of pixels has their values and errors at each point, those of the tab of fine
/// detail.
#[test]
fn sweep_computes_metrics_of_pixels() {
    let server = Server::start();
    let example = server.get("/api/v1/examples/matrix").json()["scenario"].as_str().unwrap().to_owned();
    let sweep = "\n[spectrum]\nstep_nm = 50\n[sweep]\nmetrics = [\"white.f50_x_per_mm\", \"own_share_out\"]\n\
                 axes = [{ \"display.glass.thickness_mm\" = [0.5, 0.7] }]\n";
    let scenario = example + sweep;
    let answer = server.post("/sweep", &json!({ "scenario": scenario }));
    let (before, name, done) = events(&answer.body);
    assert_eq!((before, name.as_str()), (2, "done"), "{done}");
    let drawn: Vec<&str> = names(&done["figures"]);
    assert_eq!(drawn, ["sweep_white.f50_x_per_mm", "sweep_own_share_out"]);
    let table: Vec<Vec<&str>> =
        done["csv"].as_str().unwrap().lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(table[0][2..4], ["white.f50_x_per_mm", "white.f50_x_per_mm_de"]);
    let numbers: Vec<f64> = table[1][2..].iter().map(|cell| cell.parse().unwrap()).collect();
    for (command, metric, state, at) in
        [("mtf", "f50_x_per_mm", json!("white"), 0), ("crosstalk", "own_share_out", Value::Null, 2)]
    {
        let seen = server.post("/detail", &json!({ "scenario": scenario, "command": command })).json();
        let all = seen["numbers"].as_array().unwrap();
        let one = all.iter().find(|one| one["metric"] == metric && one["state"] == state).unwrap();
        assert_eq!(
            [&one["value"], &one["error"]].map(|n| n.as_f64().unwrap()),
            [numbers[at], numbers[at + 1]]
        );
    }
    let offered = server.get("/api/v1/metrics").json();
    let of_sharpness = json!({ "name": "f50_x_per_mm", "of_state": true, "command": "mtf" });
    assert!(offered.as_array().unwrap().contains(&of_sharpness));
}

/// A display without pixels or face is refused with what is missing.
#[test]
fn missing_pixels_and_faces_are_named() {
    let server = Server::start();
    let scenario = indoor(&server);
    for (command, missing) in [("crosstalk", "matrix"), ("sparkle", "[sparkle]"), ("blur", "unknown variant")]
    {
        let answer = server.post("/detail", &json!({ "scenario": scenario, "command": command }));
        // Missing lengths of the layers are named, too.
        let messages = answer.json()["errors"].to_string();
        assert!(messages.contains(missing), "{command}: {messages}");
    }
}

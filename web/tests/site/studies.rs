//! Searches, tolerance analyses, the pixel alone, published samples and new displays: the same results as on the command line.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_design::output::{SearchReport, search_table, tolerance_tables};
use papilio_design::search::{Search, SearchRecords, SearchSchedule};
use papilio_design::tolerance::{Production, Report};
use papilio_design::{DesignError, Evaluator, Study};
use papilio_display::pixel::scan_at;
use papilio_formats::PixelTable;
use papilio_scenario::{Library, Optimisation, Scenario, Tolerance};
use serde_json::{Value, json};

use super::answers::{events, indoor};
use super::client::Server;

fn folder() -> Library {
    Library::Folder(PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/")))
}

/// A search for white and gamut by one gap and one film.
const SEARCH: &str = r#"
[optimize]
starts = 2
evaluations = 30
points = 3
variables = [
  { key = "display.pixel.film.1.thickness_nm", bounds = [8, 16] },
  { key = "display.pixel.gap_nm.red", bounds = [260, 290] },
]
objectives = [{ metric = "gamut_percent_srgb", aim = "maximise" }, { metric = "white.Y", aim = "maximise" }]
constraints = [{ metric = "contrast_ratio", at_least = 15 }]
"#;

#[test]
fn search_equals_that_of_the_command_line() {
    let server = Server::start();
    let scenario = indoor(&server) + SEARCH;
    let answer = server.post("/optimize", &json!({ "scenario": scenario }));
    let (before, name, done) = events(&answer.body);
    assert!(before >= 1 && name == "done", "{done}");
    let stop = AtomicBool::new(false);
    let spec = Optimisation::from_text(&scenario, "scenario", folder(), &[]).unwrap();
    let mut evaluator = Evaluator::new(Arc::new(Study::of(&spec)), &stop);
    let search = Arc::new(Search::new(spec, &mut evaluator).unwrap());
    let mut schedule = SearchSchedule::new(Arc::clone(&search), SearchRecords::default(), 1);
    schedule.run(&evaluator, 1, &mut |_, _| Ok::<(), DesignError>(())).unwrap();
    let results = schedule.results();
    let chosen = search.selected(&results, &mut evaluator).unwrap();
    let title = done["report"]["title"].as_str().unwrap();
    let wanted = SearchReport::new(title, &search, &results, &chosen);
    // Compared as text: parsing a number could change its last bit.
    let designs = serde_json::to_value(&wanted.designs).unwrap().to_string();
    assert!(String::from_utf8_lossy(&answer.body).contains(&designs), "{designs}");
    assert_eq!(done["report"]["evaluations"], wanted.evaluations);
    assert_eq!(done["csv"], search_table(&search, &results));
    assert_eq!(done["scenarios"].as_array().unwrap().len(), wanted.designs.len());
    let figures: Vec<&str> =
        done["figures"].as_array().unwrap().iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(figures, ["trace", "front"]);
    // The scenario of a design is one that the program reads.
    let text = done["scenarios"][0]["text"].as_str().unwrap();
    Scenario::from_text(text, "front", folder(), &[]).unwrap().resolve().unwrap();
}

#[test]
fn search_that_cannot_start_says_why() {
    let server = Server::start();
    let (message, _) = server.post("/optimize", &json!({ "scenario": indoor(&server) })).error();
    assert!(message.contains("[optimize]"), "{message}");
    let wrong = indoor(&server) + &SEARCH.replace("bounds = [8, 16]", "bounds = [16, 8]");
    let (_, path) = server.post("/optimize", &json!({ "scenario": wrong })).error();
    assert!(path.is_some_and(|path| path.starts_with("optimize.variables.0")));
    let (message, _) = server.post("/tolerance", &json!({ "scenario": indoor(&server) })).error();
    assert!(message.contains("[tolerance]"), "{message}");
}

#[test]
fn tolerance_analysis_equals_that_of_the_command_line() {
    let server = Server::start();
    let scenario = indoor(&server)
        + r#"
[tolerance]
samples = 64
keys = [{ name = "absorber", key = "display.pixel.film.1.thickness_nm", relative = true, normal = { sigma = 0.02 } }]
limits = [{ metric = "contrast_ratio", at_least = 23 }]
"#;
    let answer = server.post("/tolerance", &json!({ "scenario": scenario }));
    let (_, name, done) = events(&answer.body);
    assert_eq!(name, "done", "{done}");
    let tolerance = Tolerance::from_text(&scenario, "scenario", folder(), &[]).unwrap();
    let production = Production::new(&tolerance);
    let stop = AtomicBool::new(false);
    let mut evaluator = Evaluator::new(production.study().clone(), &stop);
    let rows: Vec<Vec<f64>> =
        (0..production.rows()).map(|row| production.evaluate(&mut evaluator, row).unwrap()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let wanted = Report::new(&tolerance, &production, &rows);
    // Compared as text: parsing a number could change its last bit.
    let report = serde_json::to_value(&wanted).unwrap().to_string();
    assert!(String::from_utf8_lossy(&answer.body).contains(&report), "{report}");
    let tables = tolerance_tables(&tolerance, &production, &rows, &wanted).unwrap();
    let csv = |name: &str| {
        let (_, bytes) = tables.iter().find(|(file, _)| file.strip_suffix(".csv") == Some(name)).unwrap();
        String::from_utf8(bytes.clone()).unwrap()
    };
    for table in done["tables"].as_array().unwrap() {
        assert_eq!(table["csv"], csv(table["name"].as_str().unwrap()));
    }
    assert!(done["figures"].as_array().unwrap().len() >= 2);
}

#[test]
fn pixel_scan_equals_that_of_the_command_line() {
    let server = Server::start();
    let scenario = indoor(&server);
    let found = server.post("/pixel", &json!({ "scenario": scenario, "absorption": true })).json();
    let resolved =
        Scenario::from_text(&scenario, "s", folder(), &[]).unwrap().resolve_without_light().unwrap();
    let theta_deg: Vec<f64> = (0..=90).map(f64::from).collect();
    let scan = scan_at(&resolved.scene, &theta_deg, &[0.0]).unwrap();
    let wavelength_nm = scan.wavelength_nm;
    let table = PixelTable { theta_deg, phi_deg: Vec::new(), wavelength_nm, states: scan.states };
    let mut wanted = Vec::new();
    table.write(&mut wanted).unwrap();
    let tables = found["tables"].as_array().unwrap();
    assert_eq!(tables[0]["csv"], String::from_utf8(wanted).unwrap());
    let names: Vec<&str> = tables.iter().filter_map(|one| one["name"].as_str()).collect();
    assert_eq!(names, ["pixel", "absorption", "sub-pixels"]);
    let (message, _) = server.post("/pixel", &json!({ "scenario": scenario, "steps": 0 })).error();
    assert!(message.contains("steps"), "{message}");
}

#[test]
fn published_sample_is_predicted_and_an_unknown_one_is_named() {
    let server = Server::start();
    let samples = server.get("/api/v1/samples").json();
    let names: Vec<&str> =
        samples.as_array().unwrap().iter().filter_map(|one| one["name"].as_str()).collect();
    assert!(names.contains(&"ptfe"), "{names:?}");
    let (_, name, done) = events(&server.post("/validate", &json!({ "sample": "ptfe" })).body);
    assert_eq!(name, "done", "{done}");
    let sample = &done["report"]["samples"][0];
    assert_eq!((&sample["name"], &sample["verdict"]), (&json!("ptfe"), &json!("agrees")));
    assert!(done["html"].as_str().unwrap().contains("<html"));
    assert_eq!(done["figures"][0]["name"], json!("sample-ptfe"));
    let (message, _) = server.post("/validate", &json!({ "sample": "nothing" })).error();
    assert!(message.contains("no sample `nothing`") && message.contains("ptfe"), "{message}");
}

#[test]
fn new_display_of_each_kind_can_be_computed_with_its_files() {
    let server = Server::start();
    let kinds = server.get("/api/v1/displays").json();
    for kind in kinds.as_array().unwrap() {
        let new = server.post("/new", &json!({ "display": kind["name"], "light": "office" })).json();
        let mut files = serde_json::Map::new();
        for file in new["files"].as_array().unwrap() {
            let (name, text) = (file["name"].as_str().unwrap(), file["text"].as_str().unwrap());
            let path = format!("/api/v1/files?name={name}");
            let kept = server.send(&path, "application/octet-stream", text.as_bytes()).json();
            files.insert(name.to_owned(), kept["id"].clone());
        }
        let live = server.post("/live", &json!({ "scenario": new["scenario"], "files": files, "edits": [] }));
        assert_eq!(live.status, 200, "{kind} {}", String::from_utf8_lossy(&live.body));
        assert_ne!(live.json()["result"], Value::Null);
    }
    assert!(server.post("/new", &json!({ "display": "imod", "light": "moon" })).error().0.contains("moon"));
}

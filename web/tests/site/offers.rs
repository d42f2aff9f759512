//! What the page offers: values that are accepted, the Monte Carlo solver for what adding refuses, presets,
//! lobes, the comparison with a measured panel, and fits to it.

use std::sync::atomic::AtomicBool;

use papilio_design::fit::Fitting;
use papilio_display::Control;
use papilio_display::compare::compare;
use papilio_formats::{DataFile, read_measured_panel, read_measurement, read_result, write_json};
use papilio_scenario::{Fit, Library, Scenario};
use serde_json::{Value, json};

use crate::answers::{events, indoor};
use crate::client::Server;

fn set(path: &str, value: &Value) -> Value {
    json!([{ "op": "set", "path": path, "value": value }])
}

/// The value that an error offers is accepted, and it is the nearest one: a slightly larger one is refused.
#[test]
fn value_that_an_error_offers_is_accepted() {
    let server = Server::start();
    let scenario = indoor(&server);
    let live = |edits: &Value| server.post("/live", &json!({ "scenario": scenario, "edits": edits }));
    for (path, wrong, offered_at) in [
        ("display.diffuser.haze", json!(0.95), "display.diffuser.total_transmittance"),
        ("display.diffuser.haze", json!(0.93), "display.diffuser.total_transmittance"),
        ("display.diffuser.total_transmittance", json!(0.99), "display.diffuser.total_transmittance"),
        ("display.pixel.film.1.thickness_nm", json!(-5), "display.pixel.film.1.thickness_nm"),
        ("lighting.preset", json!("sunni"), "lighting.preset"),
        ("display.pixel.film.2.material", json!("SiO3"), "display.pixel.film.2.material"),
    ] {
        let answer = live(&set(path, &wrong));
        assert_eq!(answer.status, 422, "{path}");
        let error = &answer.json()["errors"][0];
        assert_eq!(error["path"], offered_at, "{error}");
        let offered = error["accepted"].clone();
        let mut edits = vec![json!({ "op": "set", "path": path, "value": wrong })];
        edits.push(json!({ "op": "set", "path": offered_at, "value": offered }));
        assert_eq!(live(&json!(edits)).status, 200, "{path}: {error}");
        if let Some(number) = offered.as_f64().filter(|number| *number > 0.0) {
            edits[1]["value"] = json!(number + 1e-4);
            assert_eq!(live(&json!(edits)).status, 422, "{path}: {error}");
        }
    }
}

/// Adding refuses a very narrow lobe among layers; the Monte Carlo solver computes it, without a comparison.
#[test]
fn what_adding_refuses_is_computed_by_monte_carlo() {
    let server = Server::start();
    let narrow = server.get("/api/v1/examples/two-diffusers").json()["scenario"].as_str().unwrap().to_owned();
    let coarse = [("display.layers.0.width", json!(0.002)), ("solver.relative_error", json!(0.05))];
    let edits: Vec<Value> = coarse.iter().map(|(path, value)| set(path, value)[0].clone()).collect();
    let refused = server.post("/live", &json!({ "scenario": narrow, "edits": edits }));
    assert_eq!(refused.status, 422);
    assert_eq!(refused.json()["errors"][0]["monte_carlo"], true);
    let scenario = refused.json()["scenario"].clone();
    let (_, name, done) = events(&server.post("/walk", &json!({ "scenario": scenario })).body);
    assert_eq!(name, "done", "{done}");
    assert_eq!(done["fields"]["display"]["layers"][0]["width"], 0.002);
    assert!(done["states"][0]["Y"].as_f64().unwrap() > 0.0 && done["states"][0]["live_Y"].is_null());
    assert_eq!(done["result"]["solver"]["method"], "monte-carlo");
    // Other errors are not for Monte Carlo.
    let wrong = server.post(
        "/live",
        &json!({ "scenario": indoor(&server), "edits": set("display.diffuser.haze", &json!(3)) }),
    );
    assert!(wrong.json()["errors"][0].get("monte_carlo").is_none());
}

#[test]
fn live_result_has_its_preset_and_its_lobes() {
    let server = Server::start();
    let live =
        |edits: &Value| server.post("/live", &json!({ "scenario": indoor(&server), "edits": edits })).json();
    let seen = live(&json!([]));
    assert_eq!(seen["preset"], json!({ "name": "indoor", "changed": false }));
    assert_eq!(live(&set("lighting.directed.0.theta_deg", &json!(-36)))["preset"], Value::Null);
    // The peak of the lobe is in the regular direction: light from -20 deg goes to the right.
    let lobe = &seen["lobes"][0];
    let numbers = |key: &str| -> Vec<f64> {
        lobe[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (theta, relative) = (numbers("theta_deg"), numbers("relative"));
    let peak = relative.iter().position(|value| *value == 1.0).unwrap();
    let index = lobe["index_below"].as_f64().unwrap();
    assert!((theta[peak].to_radians().sin() * index - 20f64.to_radians().sin()).abs() < 1e-9);
}

/// The comparison equals that of `papilio compare` with the result of `papilio run`.
#[test]
fn comparison_with_a_measured_panel_equals_the_command_line() {
    let server = Server::start();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/");
    let bytes = std::fs::read(format!("{root}data/synthetic-panel.csv")).unwrap();
    let kept = server.send("/api/v1/files?name=panel.csv", "application/octet-stream", &bytes).json();
    let scenario = server.get("/api/v1/examples/overcast").json()["scenario"].clone();
    let answer = server.post("/compare", &json!({ "scenario": scenario, "panel": kept["id"] }));
    assert_eq!(answer.status, 200, "{}", String::from_utf8_lossy(&answer.body));
    let set = ["solver.method=adding".to_owned()];
    let resolved = Scenario::load(format!("{root}overcast.toml").as_ref(), &set).unwrap().resolve().unwrap();
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let result = papilio_display::run(&resolved.scene, &control).unwrap();
    let file = papilio_formats::ResultFile {
        papilio: "",
        scenario: &resolved.canonical,
        hash: &resolved.hash,
        seed: 0,
        notes: &[],
        result: &result,
    };
    let mut json_bytes = Vec::new();
    write_json(&mut json_bytes, &file).unwrap();
    let simulated = read_result(&DataFile { name: "r".to_owned(), bytes: json_bytes }).unwrap().simulated;
    let measured = read_measured_panel(&DataFile { name: "p".to_owned(), bytes }).unwrap().value;
    let wanted = serde_json::to_value(compare(&simulated, &measured).unwrap()).unwrap();
    let compared = answer.json();
    assert_eq!(
        compared["comparison"]["states"].as_array().unwrap().len(),
        wanted["states"].as_array().unwrap().len()
    );
    for (ours, theirs) in
        compared["comparison"]["states"].as_array().unwrap().iter().zip(wanted["states"].as_array().unwrap())
    {
        let of = |one: &Value| one["delta_E_2000"].as_f64().unwrap();
        assert!((of(ours) - of(theirs)).abs() < 1e-9 && of(ours) > 0.0, "{ours} {theirs}");
    }
    assert!(compared["csv"].as_str().unwrap().starts_with("theta_deg,phi_deg,state,X_simulated"));
    assert!(compared["figures"].as_array().unwrap().len() >= 2);
    // A measurement that is not stored, and one of other directions.
    let gone = server.post("/compare", &json!({ "scenario": scenario, "panel": "00" }));
    assert_eq!((gone.status, &gone.json()["missing"]), (410, &json!(["00"])));
    let other = b"state,theta_deg,wavelength_nm,reflectance_factor\nwhite,60,400,0.1\nwhite,60,700,0.1\n";
    let kept = server.send("/api/v1/files?name=other.csv", "application/octet-stream", other).json();
    let (message, _) = server.post("/compare", &json!({ "scenario": scenario, "panel": kept["id"] })).error();
    assert!(message.contains("no measured state has a counterpart"), "{message}");
}

/// A fit has the variables of `papilio fit`; its edits give the scenario the fitted values, and metrics are measurements, too.
#[test]
fn fit_equals_the_command_line() {
    let server = Server::start();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/");
    let scenario =
        std::fs::read_to_string(format!("{root}fit.toml")).unwrap().replace("starts = 4", "starts = 1");
    let bytes = std::fs::read(format!("{root}data/synthetic-film.csv")).unwrap();
    let upload = |name: &str, bytes: &[u8]| {
        server.send(&format!("/api/v1/files?name={name}"), "application/octet-stream", bytes).json()
    };
    let kept = upload("film.csv", &bytes);
    assert_eq!(kept["kind"], "panel");
    let request = json!({ "scenario": scenario, "measured": [kept["id"], kept["id"]] });
    let answer = server.post("/fit", &request);
    let (before, name, done) = events(&answer.body);
    assert!(before >= 1 && name == "done", "{done}");
    let spec = Fit::from_text(&scenario, "scenario", Library::Folder(root.into()), &[]).unwrap();
    let measured = read_measurement(&DataFile { name: "film.csv".to_owned(), bytes }).unwrap().value;
    let stop = AtomicBool::new(false);
    let fitting = Fitting::new(spec, &measured, &stop).unwrap();
    let wanted = fitting.run(2, &|_, _| {}).unwrap().unwrap();
    // Compared as text: parsing a number could change its last bit.
    let variables = serde_json::to_value(&wanted.variables).unwrap().to_string();
    assert!(String::from_utf8_lossy(&answer.body).contains(&variables), "{variables}");
    assert_eq!(done["report"]["hash"], wanted.hash);
    assert_eq!(done["csv"].as_str().unwrap().lines().count(), 1 + wanted.observations);
    let names: Vec<&str> =
        done["figures"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["fit-spectra", "fit-residuals"]);
    let edited = server.post("/edit", &json!({ "scenario": scenario, "edits": done["edits"] })).json();
    let edited =
        Scenario::from_text(edited["scenario"].as_str().unwrap(), "s", Library::Folder(root.into()), &[])
            .unwrap();
    let fitted =
        Scenario::from_text(done["scenario"].as_str().unwrap(), "s", Library::Folder(root.into()), &[])
            .unwrap();
    for one in wanted.variables.iter().filter(|one| one.key.starts_with("display.")) {
        let pointer = one.key.trim_start_matches("display").replace('.', "/");
        let of =
            |scenario: &Scenario| scenario.filled_at("display").pointer(&pointer).unwrap().as_f64().unwrap();
        assert_eq!(of(&edited), of(&fitted), "{}", one.key);
        assert!((of(&fitted) - one.best).abs() < 1e-8 * one.best, "{}", one.key);
    }

    // Metrics alone are a measurement; one that needs what the scenario lacks is named with its place.
    let metrics =
        upload("metrics.csv", b"metric,value,standard_deviation\nwhite.Y,0.2,0.01\nppd,0.05,0.01\n");
    assert_eq!(metrics["kind"], "panel");
    let one = scenario.split("[fit]").next().unwrap().to_owned()
        + "[fit]\nvariables = [{ key = \"display.pixel.fill_factor\", bounds = [0.5, 1.0] }]\n";
    let (_, name, failed) =
        events(&server.post("/fit", &json!({ "scenario": one, "measured": [metrics["id"]] })).body);
    let message = failed["errors"][0]["message"].as_str().unwrap();
    assert!(
        name == "failed" && message.contains("`ppd`") && message.contains("metrics.csv:3:1"),
        "{message}"
    );
}

#[test]
fn fit_that_cannot_start_says_why() {
    let server = Server::start();
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/");
    let scenario = std::fs::read_to_string(format!("{root}fit.toml")).unwrap();
    let wrong = |scenario: &str, measured: Value| {
        server.post("/fit", &json!({ "scenario": scenario, "measured": measured }))
    };
    assert!(wrong(&scenario, json!([])).error().0.contains("nothing is measured"));
    let gone = wrong(&scenario, json!(["00"]));
    assert_eq!((gone.status, &gone.json()["missing"]), (410, &json!(["00"])));
    let colours = b"state,X,Y,Z\nwhite,0.2,0.2,0.2\n";
    let kept = server.send("/api/v1/files?name=a.csv", "application/octet-stream", colours).json();
    let (message, _) = wrong(&indoor(&server), json!([kept["id"]])).error();
    assert!(message.contains("no `[fit]`"), "{message}");
    let bad = scenario.replace("bounds = [250, 300]", "bounds = [300, 250]");
    let (_, path) = wrong(&bad, json!([kept["id"]])).error();
    assert!(path.is_some_and(|path| path.starts_with("fit.variables.0")));
    let (_, name, failed) = events(&wrong(&scenario, json!([kept["id"]])).body);
    let message = failed["errors"][0]["message"].as_str().unwrap();
    assert!(
        name == "failed" && message.contains("3 measured numbers cannot determine 8 variables"),
        "{message}"
    );
}

/// The data files of the program, which the page packs with designs, are those of their names; uploaded files are found by their ids.
#[test]
fn data_files_are_listed_and_given() {
    let server = Server::start();
    let entries = server.get("/api/v1/data").json();
    let names: Vec<&str> =
        entries.as_array().unwrap().iter().map(|entry| entry["name"].as_str().unwrap()).collect();
    for name in ["data/H65.bsdf", "H65.bsdf", "../surfaces/etched.toml"] {
        assert!(names.contains(&name), "{name}");
    }
    let file = |file: &str| server.post("/data/file", &json!({ "file": file }));
    let own = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/data/H65.bsdf")).unwrap();
    assert_eq!(file("data/H65.bsdf").body, own);
    let mine = b"wavelength_nm,value\n400,0.1\n500,0.2\n600,0.2\n700,0.2\n";
    let kept = server.send("/api/v1/files?name=mine.csv", "application/octet-stream", mine).json();
    assert_eq!(file(kept["id"].as_str().unwrap()).body, mine);
    for unknown in ["../Cargo.toml", "/etc/passwd", "data/none.csv", ""] {
        assert_eq!(file(unknown).status, 404, "{unknown}");
    }
}

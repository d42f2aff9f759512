//! Valid requests.

use std::io::{BufRead, BufReader, Write};
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_scenario::Scenario;
use serde_json::{Value, json};

use crate::client::Server;

pub(crate) fn indoor(server: &Server) -> String {
    server.get("/api/v1/examples/indoor").json()["scenario"].as_str().unwrap().to_owned()
}

/// The result equals that of `papilio run` to the last bit, independent of earlier requests.
#[test]
fn live_result_equals_the_command_line() {
    let server = Server::start();
    let scenario = indoor(&server);
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/indoor.toml");
    for (key, value) in
        [("lighting.directed.0.theta_deg", -33.5), ("display.pixel.film.1.thickness_nm", 10.25)]
    {
        let set = [format!("{key}={value}")];
        let resolved = Scenario::load(path.as_ref(), &set).unwrap().resolve().unwrap();
        let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
        let wanted = papilio_display::run(&resolved.scene, &control).unwrap();
        let edits = json!([{ "op": "set", "path": key, "value": value }]);
        let answer = server.post("/live", &json!({ "scenario": scenario, "edits": edits }));
        assert_eq!(answer.status, 200, "{answer:?}");
        let seen = answer.json();
        assert_eq!(seen["result"]["hash"], resolved.hash);
        // Compared as text: parsing a number could change its last bit.
        let views = format!("\"views\":{}", serde_json::to_string(&wanted.views).unwrap());
        let text = String::from_utf8_lossy(&answer.body);
        assert!(text.contains(&views), "{key}");
        assert!(seen["scenario"].as_str().unwrap().contains("# its mirror image is at +20 deg"));
        assert_eq!(seen["fields"]["solver"]["method"], "adding");
    }
}

/// A first answer states its error, and the exact answer is the same with and without it.
#[test]
fn first_answer_is_within_its_error_of_the_exact_one() {
    let server = Server::start();
    let scenario = indoor(&server);
    let edits = json!([{ "op": "set", "path": "display.diffuser.haze", "value": 0.2 }]);
    let live = |accuracy: &str| {
        let answer =
            server.post("/live", &json!({ "scenario": scenario, "edits": edits, "accuracy": accuracy }));
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()
    };
    let [before, first, exact] = ["exact", "first", "exact"].map(live);
    assert_eq!(before["result"], exact["result"]);
    assert_eq!((&first["is_final"], &exact["is_final"]), (&json!(false), &json!(true)));
    assert_eq!(first["result"]["hash"], exact["result"]["hash"]);
    let y = |seen: &Value| seen["result"]["views"][0]["states"]["white"]["Y"].as_f64().unwrap();
    let error = |seen: &Value| seen["relative_error"].as_f64().unwrap();
    assert!(error(&first) < 0.05 && error(&exact) <= 1e-3, "{} {}", error(&first), error(&exact));
    let away = (y(&first) / y(&exact) - 1.0).abs();
    assert!(away > 0.0 && away <= error(&first) + error(&exact), "{away}");
    let (message, _) = server.post("/live", &json!({ "scenario": scenario, "accuracy": "coarse" })).error();
    assert!(message.contains("exact"), "{message}");
}

/// One view alone has the same result as among all views, and the directions of all of them are listed.
#[test]
fn answer_of_one_view_is_that_among_all_views() {
    let server = Server::start();
    let scenario = indoor(&server);
    let edits = json!([{ "op": "set", "path": "viewer.theta_deg", "value": [0, 8, 30] }]);
    let live = |view: Value| {
        let given = json!({ "scenario": scenario, "edits": edits, "accuracy": "exact", "view": view });
        let answer = server.post("/live", &given);
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()
    };
    let [all, second, last] = [Value::Null, json!(1), json!(99)].map(live);
    let views = |seen: &Value| seen["result"]["views"].as_array().unwrap().clone();
    assert_eq!((views(&all).len(), views(&second).len(), &all["view"]), (3, 1, &Value::Null));
    assert_eq!((&second["view"], &last["view"], &second["views"]), (&json!(1), &json!(2), &all["views"]));
    assert_eq!(second["views"][2], json!({ "theta_deg": 30.0, "phi_deg": 0.0 }));
    assert_eq!((&second["result"]["hash"], &second["fields"]), (&all["result"]["hash"], &all["fields"]));
    for (alone, number) in [(&second, 1), (&last, 2)] {
        let y = |view: &Value| view["states"]["white"]["Y"].as_f64().unwrap();
        let away = y(&views(alone)[0]) / y(&views(&all)[number]) - 1.0;
        assert!(away.abs() <= alone["relative_error"].as_f64().unwrap(), "{away}");
    }
}

/// Every example and every preset but one has a live result, within the twenty seconds that the page allows. That of the face by
/// waves, with twenty lobes at each wavelength, takes ten of them, and a liquid crystal below a haze film some: every day,
/// they have fewer directions, and all have fewer views and wavelengths, in steps that divide the ranges of all.
#[test]
fn every_example_and_preset_computes() {
    let server = Server::start();
    let few = json!([
        { "op": "set", "path": "spectrum.step_nm", "value": 50 },
        { "op": "set", "path": "viewer.theta_deg", "value": 8 },
    ]);
    let coarse = json!([
        { "op": "set", "path": "spectrum.step_nm", "value": 100 },
        { "op": "set", "path": "viewer.theta_deg", "value": 8 },
        { "op": "set", "path": "solver.relative_error", "value": 0.01 },
    ]);
    let edits = |name: &str| match name {
        "hazy-face" | "mip-lcd-haze" | "mip-lcd-colour" => papilio_testing::sized(coarse.clone(), json!([])),
        _ => papilio_testing::sized(few.clone(), json!([])),
    };
    for list in ["examples", "presets"] {
        let all = server.get(&format!("/api/v1/{list}")).json();
        assert!(all.as_array().unwrap().len() > 10);
        for one in all.as_array().unwrap() {
            let name = one["name"].as_str().unwrap();
            assert!(one["summary"].as_str().unwrap().len() > 10, "{name}");
            let scenario = server.get(&format!("/api/v1/{list}/{name}")).json()["scenario"].clone();
            let answer = server.post("/live", &json!({ "scenario": scenario, "edits": edits(name) }));
            // Live results are by adding, which refuses particles whose polarised light is followed.
            let status = if name == "rayleigh-film" { 422 } else { 200 };
            assert_eq!(answer.status, status, "{name}: {}", String::from_utf8_lossy(&answer.body));
        }
    }
    assert_eq!(server.get("/api/v1/examples/nothing").status, 404);
}

#[test]
fn error_of_a_scenario_has_its_key_and_location() {
    let server = Server::start();
    let scenario = indoor(&server);
    let edits = json!([{ "op": "set", "path": "display.diffuser.haze", "value": 78 }]);
    let answer = server.post("/live", &json!({ "scenario": scenario, "edits": edits }));
    assert_eq!(answer.status, 422);
    let body = answer.json();
    let error = &body["errors"][0];
    assert_eq!(error["path"], "display.diffuser.haze");
    assert_eq!(error["message"], "78 is out of range");
    assert_eq!(error["hint"], "this is a fraction relative to 1, not per cent");
    assert!(error["line"].as_u64().unwrap() > 10 && error["column"].as_u64().unwrap() == 8);
    assert!(body["scenario"].as_str().unwrap().contains("haze = 78"));
    let missing = scenario.replace("total_transmittance", "# total_transmittance");
    let (_, path) = server.post("/live", &json!({ "scenario": missing })).error();
    assert_eq!(path.as_deref(), Some("display.diffuser"));
}

#[test]
fn uploaded_file_is_stored_recognised_and_used() {
    let server = Server::start();
    let bytes = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/data/H65.bsdf")).unwrap();
    let answer = server.send("/api/v1/files?name=my%20film.bsdf", "application/octet-stream", &bytes);
    assert_eq!(answer.status, 200, "{answer:?}");
    let kept = answer.json();
    assert_eq!((kept["kind"].as_str(), kept["name"].as_str()), (Some("bsdf"), Some("my film.bsdf")));
    assert!(kept["words"].as_array().unwrap().iter().any(|line| line.as_str().unwrap().contains("haze")));
    assert!(kept["figures"][0]["svg"].as_str().unwrap().starts_with("<svg"));
    let (scenario, edits) = (indoor(&server), &kept["edits"][0]["edits"]);
    let with = |id: &Value| json!({ "scenario": scenario, "edits": edits, "files": { "my film.bsdf": id } });
    let seen = server.post("/live", &with(&kept["id"]));
    assert_eq!(seen.status, 200, "{}", String::from_utf8_lossy(&seen.body));
    assert_eq!(seen.json()["result"]["scenario"]["inputs"]["my film.bsdf"], kept["id"]);
    // The ids of files that are not stored are returned.
    let gone = server.post("/live", &with(&json!("00")));
    assert_eq!((gone.status, &gone.json()["missing"]), (410, &json!(["00"])));
    // Without an id, the name of a file is not found; the disk is not searched.
    let (message, path) = server.post("/live", &json!({ "scenario": scenario, "edits": edits })).error();
    assert_eq!(message, "there is no file `my film.bsdf` here");
    assert_eq!(path.as_deref(), Some("display.diffuser.file"));
}

#[test]
fn kind_of_each_example_file_is_detected() {
    let server = Server::start();
    let kinds = [
        ("H65-transmission.csv", "spectrum"),
        ("synthetic-absorber.csv", "material"),
        ("fused-silica.yml", "material"),
        ("synthetic-office.hdr", "map"),
        ("synthetic-panel.ies", "luminaire"),
        ("synthetic-room.csv", "profile"),
        ("synthetic-pixel.csv", "pixel"),
        ("synthetic-azimuths.csv", "pixel"),
        ("synthetic-panel.csv", "panel"),
        ("synthetic-paper-white.bsdf", "bsdf"),
    ];
    for (name, kind) in kinds {
        let path = format!("{}/../scenarios/data/{name}", env!("CARGO_MANIFEST_DIR"));
        let bytes = std::fs::read(path).unwrap();
        let answer = server.send(&format!("/api/v1/files?name={name}"), "application/octet-stream", &bytes);
        assert_eq!(answer.json()["kind"], kind, "{name}");
    }
    let broken =
        server.send("/api/v1/files?name=a.bsdf", "application/octet-stream", b"Source  Measured\nnonsense");
    assert_eq!(broken.status, 422);
}

/// What adding refuses because it knows no azimuth: the page offers Monte Carlo.
#[test]
fn azimuth_below_a_film_on_tinted_glass_is_left_to_monte_carlo() {
    let server = Server::start();
    let scenario =
        server.get("/api/v1/examples/mip-lcd-haze").json()["scenario"].as_str().unwrap().to_owned();
    let tinted = scenario.replace("[display.glass]", "[display.glass]\ninternal_transmittance = 0.9");
    let by_adding = tinted.replace("[solver]", "[solver]\nmethod = \"adding\"");
    assert!(tinted != scenario && by_adding != tinted);
    let answer = server.post("/live", &json!({ "scenario": by_adding }));
    let error = &answer.json()["errors"][0];
    assert_eq!((answer.status, &error["monte_carlo"]), (422, &json!(true)), "{error}");
    assert_eq!(error["path"], "solver.method");
}

#[test]
fn cone_that_takes_gigabytes_is_refused() {
    let server = Server::start();
    let scenario = server.get("/api/v1/examples/map").json()["scenario"].as_str().unwrap().to_owned();
    for solver in ["adding", "monte-carlo"] {
        let edited = scenario.replace("[display.diffuser]", "[display.diffuser]\nregular_fraction = 0.1");
        assert_ne!(edited, scenario);
        let edited = edited.replace("[solver]", &format!("[solver]\nmethod = \"{solver}\""));
        let answer = server.post("/cone", &json!({ "scenario": edited, "step_deg": 15 }));
        let said = String::from_utf8_lossy(&answer.body).into_owned();
        assert!(answer.status == 422 && said.contains("--allow-long"), "{solver}: {said}");
    }
}

#[test]
fn angles_cone_figures_and_exports_are_returned() {
    let server = Server::start();
    let scenario = indoor(&server);
    let asked = json!({ "scenario": scenario, "phi_deg": 0, "from_deg": -60, "to_deg": 60, "step_deg": 20 });
    let angles = server.post("/angles", &asked).json();
    assert_eq!(angles["theta_deg"].as_array().unwrap().len(), 7);
    assert_eq!(angles["metrics"]["contrast_ratio"].as_array().unwrap().len(), 7);
    assert_eq!(angles["states"]["red"]["u_prime"].as_array().unwrap().len(), 7);
    let cone = server.post("/cone", &json!({ "scenario": scenario, "step_deg": 15 })).json();
    assert_eq!(cone["data"].as_array().unwrap().len(), 6 * 12);
    // The azimuths divide the circle into equal steps; with steps of 25 deg, the last step would be smaller.
    let cone_of_fives = server.post("/cone", &json!({ "scenario": scenario, "step_deg": 5 })).json();
    let azimuths: Vec<f64> =
        cone_of_fives["phi_deg"].as_array().unwrap().iter().map(|phi| phi.as_f64().unwrap()).collect();
    assert_eq!((azimuths.len(), azimuths[0]), (15, 0.0));
    assert!(azimuths.windows(2).all(|two| two[1] - two[0] == 24.0), "{azimuths:?}");
    assert!(cone["figures"][0]["svg"].as_str().unwrap().starts_with("<svg"));
    let figures = server.post("/figures", &json!({ "scenario": scenario, "names": ["patches"] })).json();
    assert_eq!(figures.as_array().unwrap().len(), 1);
    for (what, start) in [
        ("result.json", "{"),
        ("states.csv", "theta_deg,phi_deg,state"),
        ("spectra.csv", "theta_deg,phi_deg,state,wavelength_nm"),
        ("overview.svg", "<svg"),
        ("overview.png", "\u{fffd}PNG"),
    ] {
        let file = server.post("/export", &json!({ "scenario": scenario, "what": what }));
        if what.ends_with(".png") && !papilio_figures::HAS_PNG {
            assert_eq!(file.status, 501);
            continue;
        }
        assert_eq!(file.status, 200, "{what}");
        assert!(String::from_utf8_lossy(&file.body).starts_with(start), "{what}");
    }
    assert_eq!(server.post("/export", &json!({ "scenario": scenario, "what": "../x" })).status, 404);
}

/// The report contains no address of another file or host.
#[test]
fn report_is_self_contained() {
    let server = Server::start();
    let report = server.post("/export", &json!({ "scenario": indoor(&server), "what": "report.html" }));
    let html = String::from_utf8(report.body).unwrap();
    for part in [
        "<h1>Indoor reading</h1>",
        "Energy balance",
        "<td>total_transmittance</td><td>0.9</td>",
        "Computation",
    ] {
        assert!(html.contains(part), "{part}");
    }
    // No heading, head of a table or line of the results has the name of a type or a key of result.json; keys
    // of the scenario, as in its file, follow the results.
    let (_, rest) = html.split_once("<h2>Results</h2>").unwrap();
    let (results, _) = rest.split_once("<h2>Scenario</h2>").unwrap();
    let texts = results.split('<').filter_map(|part| Some(part.split_once('>')?.1.trim()));
    let headings = html.split("<h2>").skip(1).filter_map(|part| part.split('<').next());
    for text in texts.chain(headings).filter(|text| !text.starts_with("luminance factor by source")) {
        let is_camel = |pair: &[u8]| pair[0].is_ascii_lowercase() && pair[1].is_ascii_uppercase();
        let names_a_type = text.split_whitespace().any(|word| word.as_bytes().windows(2).any(is_camel));
        let is_word = !names_a_type || text.contains("sRGB");
        assert!(is_word && !text.contains('_'), "{text}");
    }
    for address in html.split("src=\"").skip(1).chain(html.split("href=\"").skip(1)) {
        assert!(address.starts_with("data:image/svg+xml,") || address.starts_with('#'));
    }
}

/// Returns the number of events before the last one, and the name and data of the last one.
pub(crate) fn events(body: &[u8]) -> (usize, String, Value) {
    let text = String::from_utf8_lossy(body);
    let all: Vec<(String, Value)> = text
        .split("\n\n")
        .filter_map(|event| {
            let name = event.lines().find_map(|line| line.strip_prefix("event: "))?;
            let data = event.lines().find_map(|line| line.strip_prefix("data: "))?;
            Some((name.to_owned(), serde_json::from_str(data).unwrap()))
        })
        .collect();
    let (name, data) = all.last().unwrap().clone();
    (all.len() - 1, name, data)
}

/// The Monte Carlo run has the hash of `papilio run --solver monte-carlo`, and agrees with adding. The
/// largest of the 24 differences exceeds 5 standard errors once in 70 000 displays.
#[test]
fn monte_carlo_run_reports_progress_and_agrees_with_adding() {
    let server = Server::start();
    let answer = server.post("/walk", &json!({ "scenario": indoor(&server) }));
    assert!(answer.status == 200 && answer.head.contains("text/event-stream"), "{answer:?}");
    let (before, name, done) = events(&answer.body);
    assert!(before >= 1 && name == "done");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/indoor.toml");
    let set = ["solver.method=monte-carlo".to_owned()];
    let resolved = Scenario::load(path.as_ref(), &set).unwrap().resolve().unwrap();
    assert_eq!(done["result"]["hash"], resolved.hash);
    let states = done["states"].as_array().unwrap();
    assert_eq!(states.len(), 8);
    for state in states {
        assert!(state["Y_se"].as_f64().unwrap() > 0.0);
        for z in state["z_of_xyz"].as_array().unwrap() {
            assert!(z.as_f64().unwrap().abs() < 5.0, "{state}");
        }
    }
}

#[test]
fn sweep_reports_each_point() {
    let server = Server::start();
    let sweep = "\n[sweep]\nfigures = [\"contrast_ratio\"]\naxes = [{ \"viewer.theta_deg\" = [0, 8, 16] }]\n";
    let answer = server.post("/sweep", &json!({ "scenario": indoor(&server) + sweep }));
    let (before, name, done) = events(&answer.body);
    assert_eq!((before, name.as_str()), (3, "done"), "{done}");
    assert_eq!(done["figures"][0]["name"], "sweep_contrast_ratio");
    assert_eq!(done["csv"].as_str().unwrap().lines().count(), 1 + 3 * 8);
}

/// A client that disconnects frees its place immediately: a Monte Carlo run that would take hours is started,
/// left, and started again.
#[test]
fn disconnected_client_stops_its_monte_carlo_run() {
    let server = Server::start();
    let scenario =
        indoor(&server).replace("relative_error = 0.001", "relative_error = 1e-6\nsampler = \"random\"");
    let body = json!({ "scenario": scenario }).to_string();
    let begin = || {
        let mut stream = server.connect();
        stream.write_all(&server.request("/api/v1/walk", "application/json", body.as_bytes())).unwrap();
        let mut lines = BufReader::new(stream).lines();
        assert!(lines.next().unwrap().unwrap().contains("200"));
        lines.find(|line| line.as_ref().is_ok_and(|line| line.contains("event: progress"))).unwrap().unwrap();
        lines
    };
    // A quarter of the processors, as in `Site::bind`.
    let places = 1.max(std::thread::available_parallelism().map_or(1, usize::from) / 4);
    let runs: Vec<_> = (0..places).map(|_| begin()).collect();
    // All places are in use: the next run is refused, with the time after which to try again.
    let busy = server.post("/walk", &json!({ "scenario": scenario }));
    assert!(busy.status == 503 && busy.head.contains("retry-after: 1"), "{}", busy.head);
    // Live results have separate places.
    assert_eq!(server.post("/live", &json!({ "scenario": indoor(&server) })).status, 200);
    drop(runs);
    drop(begin());
}

/// Requests of disconnected clients are dropped: two hundred computations of a second each, all different,
/// are started and left, and the next request is processed before the client's limit of a minute.
#[test]
fn request_of_disconnected_client_is_dropped() {
    let server = Server::start();
    let example =
        server.get("/api/v1/examples/two-diffusers").json()["scenario"].as_str().unwrap().to_owned();
    for k in 0..200 {
        let width = format!("width = {}", 0.02 + f64::from(k) * 1e-6);
        let slow = example.replace("width = 0.04", &width).replace("width = 0.03", &width);
        let body = json!({ "scenario": slow }).to_string();
        let mut stream = server.connect();
        stream.write_all(&server.request("/api/v1/live", "application/json", body.as_bytes())).unwrap();
    }
    assert_eq!(server.post("/live", &json!({ "scenario": indoor(&server) })).status, 200);
}

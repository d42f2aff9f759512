//! Surfaces by their geometry: previews, full measurements, files, and surfaces that are layers.

use papilio_formats::{write_totals, write_waves};
use papilio_scenario::SurfaceScenario;
use serde_json::{Value, json};

use crate::answers::events;
use crate::client::Server;

/// Caps by rays, and random heights by both.
const CAPS: &str = "[microgeometry]\nsurface = \"caps\"\npitch_um = 4.5 # as moulded\nradius_um = 2.25\n\
                    aperture_radius_um = 2.25\nincidence_deg = [0, 60]\nrays = 640\n";
const RANDOM: &str = "title = \"Etched\"\n[microgeometry]\nsurface = \"gaussian\"\nrms_nm = 100\ncorrelation_um = 4\nroad = \"both\"\n\
                      wavelength_nm = [450, 650]\nincidence_deg = [0]\nrays = 640\n";

fn table<'a>(seen: &'a Value, name: &str) -> &'a str {
    let all = seen["tables"].as_array().unwrap();
    all.iter().find(|one| one["name"] == name).unwrap()["csv"].as_str().unwrap()
}

fn names(list: &Value) -> Vec<&str> {
    list.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect()
}

/// The full measurement is that of the command line to the last byte; a preview has the same rays, and fewer
/// phase screens.
#[test]
fn measurements_equal_the_command_line() {
    let server = Server::start();
    let surface = SurfaceScenario::from_text(RANDOM, "surface", std::path::Path::new(""), &[]).unwrap();
    let resolved = surface.resolve().unwrap();
    let wanted = resolved.measurement.measured(None, &|| false, &|| {}).unwrap();
    let (mut totals, mut waves) = (Vec::new(), Vec::new());
    write_totals(&mut totals, &wanted.rays.as_ref().unwrap().totals).unwrap();
    write_waves(&mut waves, wanted.waves.as_ref().unwrap(), wanted.rays.as_ref()).unwrap();

    let answer = server.post("/gonio/full", &json!({ "scenario": RANDOM }));
    let (parts, last, full) = events(&answer.body);
    // Eight phase screens and 32 replicates of rays; progress that a slow client does not read is left out.
    assert!((1..=40).contains(&parts) && last == "done", "{parts} {last}: {full}");
    assert_eq!(table(&full, "totals").as_bytes(), totals);
    assert_eq!(table(&full, "waves").as_bytes(), waves);
    assert_eq!(names(&full["figures"]), ["totals", "psd", "cutoff", "waves"]);
    assert_eq!((&full["is_full"], &full["rays"]), (&json!(true), &json!(640)));
    assert_eq!(full["audit"]["hash"], json!(resolved.hash));
    assert!(full["roads"].as_str().unwrap().starts_with("waves hold"), "{}", full["roads"]);

    let seen = server.post("/gonio", &json!({ "scenario": RANDOM, "rays": 1000 })).json();
    assert_eq!(table(&seen, "totals").as_bytes(), totals);
    let screens = |seen: &Value| seen["audit"]["waves"][0]["haze_error"].as_f64().unwrap();
    assert!(seen["is_full"] == json!(false) && screens(&seen) > 0.0 && screens(&seen) != screens(&full));
    let wanted = wanted.waves.unwrap();
    let exact = wanted.along_normal().next().unwrap().1.closed_form.unwrap().one_angle_haze;
    assert_eq!(seen["audit"]["waves"][0]["haze_closed_form"].as_f64(), Some(exact));
}

/// Edits keep comments; light is conserved, with its errors; few rays are followed where few are requested.
#[test]
fn preview_applies_edits_and_counts_light() {
    let server = Server::start();
    let edits = json!([{ "op": "set", "path": "microgeometry.pitch_um", "value": 5 }]);
    let seen = server.post("/gonio", &json!({ "scenario": CAPS, "edits": edits, "rays": 320 })).json();
    assert!(seen["scenario"].as_str().unwrap().contains("pitch_um = 5 # as moulded"), "{}", seen["scenario"]);
    assert_eq!(seen["fields"]["microgeometry"]["index_below"], json!(1.5));
    assert_eq!(seen["rays"], json!(320));
    let totals = seen["totals"].as_array().unwrap();
    assert_eq!(totals.len(), 4);
    for total in totals {
        let part = |name: &str| total[name]["value"].as_f64().unwrap();
        assert!((part("reflected") + part("transmitted") - 1.0).abs() < 1e-9, "{total}");
        // A flat face of glass reflects at least 4 % of the light, and traps nothing in air.
        assert!(part("reflected") > 0.0 && total["reflected"]["error"].as_f64().unwrap() > 0.0);
        assert!(total["from"] == "above" || part("trapped") == 0.0, "{total}");
    }
}

/// What cannot be measured is refused with its key, or with the limits of the page.
#[test]
fn mistakes_and_too_much_work_are_refused() {
    let server = Server::start();
    let fine =
        "[microgeometry]\nsurface = \"exponential\"\nrms_nm = 300\ncorrelation_um = 15.4\ncutoff_um = 1\n";
    let map = "[microgeometry]\nsurface = \"height-map\"\nfile = \"/etc/passwd\"\npixel_um = [1]\n";
    for (text, path, words) in [
        (CAPS.replace("4.5", "4"), Some("microgeometry.pitch_um"), "overlap"),
        (CAPS.replace("\"caps\"", "\"cap\""), Some("microgeometry.surface"), "cap"),
        (map.to_owned(), Some("microgeometry.file"), "there is no file `/etc/passwd` here"),
        (fine.to_owned(), None, "the page allows 2048 x 2048"),
    ] {
        let answer = server.post("/gonio", &json!({ "scenario": text, "rays": 64 }));
        let (message, at) = answer.error();
        assert_eq!((answer.status, at.as_deref()), (422, path), "{message}");
        assert!(message.contains(words), "{message}");
        assert_eq!(answer.json()["scenario"], json!(text));
    }
    let many = CAPS.replace("rays = 640", "rays = 3000000");
    let answer = server.post("/gonio/full", &json!({ "scenario": many }));
    assert!(answer.status == 422 && answer.error().0.contains("at most 2000000"), "{answer:?}");
}

/// Heights, meshes and surfaces are detected, and a map of heights is measured.
#[test]
fn files_of_surfaces_are_read_from_memory() {
    let server = Server::start();
    let send = |name: &str, bytes: &[u8]| {
        let answer = server.send(&format!("/api/v1/files?name={name}"), "application/octet-stream", bytes);
        assert_eq!(answer.status, 200, "{answer:?}");
        answer.json()
    };
    // A ramp of 45 deg that returns, mirrored: two facets.
    let rows = "0,1,2,3\n0,1,2,3\n0,1,2,3\n";
    let heights = send("ramp.csv", rows.as_bytes());
    assert_eq!(
        (&heights["kind"], &heights["words"][0]),
        (&json!("heights"), &json!("ramp.csv: map of 4 x 3 heights"))
    );
    let text = "[microgeometry]\nsurface = \"height-map\"\nfile = \"ramp.csv\"\npixel_um = [1]\nlevel = false\nincidence_deg = [0]\n";
    let files = json!({ "ramp.csv": heights["id"] });
    let seen = server.post("/gonio", &json!({ "scenario": text, "files": files, "rays": 640 })).json();
    let slope = seen["audit"]["heights"]["slope_rms_x"].as_f64().unwrap();
    assert!(slope > 0.5 && seen["audit"]["heights"]["slope_rms_y"] == json!(0.0), "{seen}");

    let mesh = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../surfaces/corner-cubes.obj")).unwrap();
    assert_eq!(send("cubes.obj", &mesh)["kind"], "mesh");
    let surface = send("caps.toml", CAPS.as_bytes());
    assert_eq!(surface["kind"], "surface");
    let edits = surface["edits"][0]["edits"].as_array().unwrap();
    assert_eq!(edits.last().unwrap()["value"]["surface"], "caps.toml");
    let wrong = CAPS.replace("pitch_um", "pitch");
    let answer = server.send("/api/v1/files?name=caps.toml", "application/octet-stream", wrong.as_bytes());
    assert!(answer.status == 422 && answer.error().0.contains("pitch"), "{answer:?}");
}

/// The surface of a layer has the keys of the layer and the indices of its neighbours, and keeps its
/// comments.
#[test]
fn surfaces_of_a_design_are_those_of_its_layers() {
    let server = Server::start();
    let bytes = CAPS.as_bytes();
    let id =
        server.send("/api/v1/files?name=mine.toml", "application/octet-stream", bytes).json()["id"].clone();
    let scenario = "[[display.layers]]\nkind = \"diffuser\"\nmodel = \"microgeometry\"\nsurface = \"mine.toml\"\npitch_um = 6\nrays = 64\n\
                    [[display.layers]]\nkind = \"medium\"\nindex = 1.6\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
                    reflectance = { white = 0.5, black = 0.02 }\n[lighting]\npreset = \"indoor\"\n";
    let files = json!({ "mine.toml": id });
    let answer = server.post("/gonio/layers", &json!({ "scenario": scenario, "files": files }));
    let layers = answer.json();
    assert_eq!(
        (&layers[0]["path"], &layers[0]["file"]),
        (&json!("display.layers.0"), &json!("mine.toml")),
        "{layers}"
    );
    let text = layers[0]["scenario"].as_str().unwrap();
    assert!(
        text.contains("pitch_um = 6.0 # as moulded") || text.contains("pitch_um = 6 # as moulded"),
        "{text}"
    );
    assert!(text.contains("index_below = 1.6") && text.contains("rays = 640"), "{text}");
    let shipped = server.get("/api/v1/surfaces").json();
    assert!(names(&shipped).contains(&"hemispheres"));
    let hemispheres = server.get("/api/v1/surfaces/hemispheres").json();
    assert!(hemispheres["scenario"].as_str().unwrap().contains("surface = \"caps\""));
    assert_eq!(server.get("/api/v1/surfaces/..%2fCargo").status, 404);
}

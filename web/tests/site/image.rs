//! Pictures on the display.

use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::image::{Screen, image};
use papilio_formats::write_rgb_png;
use papilio_scenario::Scenario;
use serde_json::{Value, json};

use crate::answers::indoor;
use crate::client::{Answer, Server};

/// A response of `/image`.
struct Seen {
    head: Value,
    states: Vec<u8>,
    /// X, Y, Z of all pixels in each light.
    lights: Vec<Vec<f32>>,
    /// Number of bytes after the lights.
    rest: usize,
}

fn half(bits: u16) -> f32 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f32::from(bits & 0x3ff) / 1024.0);
    let size = match exponent {
        0 => fraction * 2.0_f32.powi(-14),
        _ => (1.0 + fraction) * 2.0_f32.powi(exponent - 15),
    };
    if bits >> 15 == 1 { -size } else { size }
}

fn unpacked(answer: &Answer) -> Seen {
    assert_eq!(answer.status, 200, "{}", String::from_utf8_lossy(&answer.body));
    let (length, rest) = answer.body.split_at(4);
    let (head, rest) = rest.split_at(u32::from_le_bytes(length.try_into().unwrap()) as usize);
    let head: Value = serde_json::from_slice(head).unwrap();
    let count = head["size"].as_array().unwrap().iter().map(|one| one.as_u64().unwrap() as usize).product();
    let states = if head["held"].is_null() { 0 } else { count };
    let (states, mut rest) = rest.split_at(states.next_multiple_of(4));
    let plane = |_: &Value| {
        let (plane, more) = rest.split_at((6 * count).next_multiple_of(4));
        rest = more;
        let values = plane.chunks_exact(2).map(|two| half(u16::from_le_bytes(two.try_into().unwrap())));
        values.take(3 * count).collect()
    };
    let lights = head["lights"].as_array().unwrap().iter().map(plane).collect();
    let states = states[..states.len().min(count)].to_vec();
    Seen { states, lights, rest: rest.len(), head }
}

/// A picture of 12 x 7 pixels with gradients.
fn gradient() -> Vec<u8> {
    let pixels: Vec<[u8; 3]> = (0..84_u8).map(|k| [20 * (k % 12), 36 * (k / 12), 3 * k]).collect();
    let mut png = Vec::new();
    write_rgb_png(&mut png, 12, &pixels, false).unwrap();
    png
}

fn upload(server: &Server, name: &str, bytes: &[u8]) -> Answer {
    server.send(&format!("/api/v1/files?name={name}"), "application/octet-stream", bytes)
}

/// States and light are those of `papilio image`, and a picture that is held keeps its states in another view
/// and light.
#[test]
fn sum_over_the_lights_equals_papilio_image() {
    let server = Server::start();
    let png = gradient();
    let id = upload(&server, "gradient.png", &png).json()["id"].clone();
    let scenario = server.get("/api/v1/examples/six-ink").json()["scenario"].clone();
    let request = json!({ "scenario": scenario, "files": { "gradient.png": id }, "picture": "gradient.png" });
    let seen = unpacked(&server.post("/image", &request));

    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("web-gradient.png");
    std::fs::write(&file, &png).unwrap();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/six-ink.toml");
    let set = format!("image.file={:?}", file.display().to_string());
    let resolved = Scenario::load(path.as_ref(), &[set]).unwrap().resolve_with_picture().unwrap();
    let picture = resolved.image.as_ref().unwrap();
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let wanted =
        image(&resolved.scene, &picture.source, &picture.settings, Screen::default(), &control).unwrap();

    assert_eq!(seen.head["size"], json!([12, 7]));
    assert_eq!(seen.states, wanted.states);
    assert_eq!(seen.head["states"], json!(wanted.numbers.states));
    let names: Vec<&str> =
        seen.head["lights"].as_array().unwrap().iter().map(|one| one["light"].as_str().unwrap()).collect();
    assert_eq!(names, ["diffuse", "directed.0"]);
    for (k, value) in wanted.seen.as_flattened().iter().enumerate() {
        let sum: f32 = seen.lights.iter().map(|light| light[k]).sum();
        // Two numbers with 11 bits each.
        assert!((sum - value).abs() < 6e-4 * value + 1e-6, "{k}: {sum} {value}");
    }
    // The picture itself follows.
    assert_eq!(seen.rest, (6 * 84_usize).next_multiple_of(4));

    let mut other = request.clone();
    other["theta_deg"] = json!(35);
    other["scenario"] = json!(scenario.as_str().unwrap().replace("LED-B1", "D65"));
    let fresh = unpacked(&server.post("/image", &other));
    other["held"] = seen.head["held"].clone();
    let held = unpacked(&server.post("/image", &other));
    assert_eq!(held.states, seen.states);
    assert_ne!(fresh.states, seen.states);
    assert_eq!((held.rest, &held.head["theta_deg"]), (0, &json!(35.0)));
    assert_ne!(held.lights, seen.lights);

    let export = |what: &str| {
        let mut request = request.clone();
        request["what"] = json!(what);
        server.post("/image/export", &request)
    };
    let states = export("states.png");
    assert_eq!((states.status, &states.body[1..4]), (200, &b"PNG"[..]));
    assert!(export("palette.gpl").body.starts_with(b"GIMP Palette"));
    // The scenario's codes are those of Spectra 6 in 4 bits: 12 columns have 6 bytes.
    let frame = export("frame.bin");
    let [columns, rows] = wanted.numbers.size;
    assert_eq!((frame.status, frame.body.len()), (200, columns.div_ceil(2) * rows));
    let first = [0, 1, 2, 3, 5, 6][usize::from(wanted.states[0])];
    assert_eq!(frame.body[0] >> 4, first);
    assert_eq!(&export("frame.bmp").body[..2], b"BM");
    assert!(String::from_utf8(export("frame.h").body).unwrap().contains("#define FRAME_BITS 4"));
    // Reading a number may change its last bit.
    let as_read: Value = serde_json::from_str(&json!(wanted.numbers.mean_XYZ).to_string()).unwrap();
    assert_eq!(export("image.json").json()["mean_XYZ"], as_read);
    assert_eq!(export("states.exe").status, 404);
    // All files are of the picture that was asked for last: in another light, view or halftone its numbers are others.
    let numbers = export("image.json").json();
    for (key, value) in
        [("theta_deg", json!(35)), ("halftone", json!("ordered")), ("scenario", other["scenario"].clone())]
    {
        let mut changed = request.clone();
        changed[key] = value;
        changed["what"] = json!("image.json");
        let changed = server.post("/image/export", &changed).json();
        assert!(changed["mean_XYZ"].is_array() && changed != numbers, "{key}: {changed}");
        assert_eq!(export("image.json").json(), numbers, "{key}");
    }
}

/// Without a halftone, each pixel has the colour that a halftone would show, and there are no states for a
/// panel.
#[test]
fn picture_without_halftone_has_exact_colours_and_no_states() {
    let server = Server::start();
    let id = upload(&server, "gradient.png", &gradient()).json()["id"].clone();
    let scenario = server.get("/api/v1/examples/six-ink").json()["scenario"].clone();
    let request = |halftone: &str| {
        json!({
            "scenario": scenario, "files": { "gradient.png": id }, "picture": "gradient.png", "halftone": halftone,
        })
    };
    let exact = unpacked(&server.post("/image", &request("none")));
    assert_eq!((exact.states.len(), exact.lights.len()), (0, 1));
    assert_eq!((&exact.head["held"], &exact.head["lights"][0]["light"]), (&Value::Null, &json!("all")));
    assert_eq!(exact.rest, (6 * 84_usize).next_multiple_of(4));
    let export = |halftone: &str, what: &str| {
        let mut request = request(halftone);
        request["what"] = json!(what);
        server.post("/image/export", &request)
    };
    let mean = export("none", "image.json").json()["mean_XYZ"].clone();
    for k in 0..3 {
        let sum: f32 = exact.lights[0].iter().skip(k).step_by(3).sum();
        let mean = mean[k].as_f64().unwrap();
        assert!((f64::from(sum) / 84.0 / mean - 1.0).abs() < 1e-3, "{k}: {sum} {mean}");
    }
    let refused = export("none", "states.png");
    assert_eq!(
        (refused.status, refused.error().0.as_str()),
        (422, "a picture without halftone has no states")
    );
    assert_eq!(export("ordered", "states.png").status, 200);
    assert_eq!(server.post("/image", &request("dots")).status, 422);
    // The states that are decided for another room are shown in this one.
    let scenario = scenario.as_str().unwrap();
    let elsewhere = scenario.replace("[image]", "[image]\nprepared_for = \"daylight\"");
    let other = |scenario: &str| {
        let mut request = request("ordered");
        request["scenario"] = json!(scenario);
        unpacked(&server.post("/image", &request))
    };
    let (here, there) = (other(scenario), other(&elsewhere));
    assert_eq!(
        (&here.head["prepared_elsewhere"], &there.head["prepared_elsewhere"]),
        (&json!(false), &json!(true))
    );
    assert_ne!(here.states, there.states);
}

/// What cannot be shown is refused with its reason.
#[test]
fn bad_picture_view_or_key_is_refused() {
    let server = Server::start();
    let png = gradient();
    let mut huge = png.clone();
    huge[16..24].copy_from_slice(&[0, 0, 0x80, 0, 0, 0, 0x80, 0]);
    for (name, bytes, words) in [
        ("short.png", &png[..png.len() / 2], "short.png"),
        ("head.png", &png[..8], "head.png"),
        ("huge.png", &huge[..], "huge.png"),
        ("empty.jpg", &b"\xff\xd8\xff"[..], "empty.jpg"),
    ] {
        let answer = upload(&server, name, bytes);
        let (message, _) = answer.error();
        assert!(answer.status == 422 && message.contains(words), "{name}: {message}");
    }
    let scenario = indoor(&server);
    let ask = |more: Value| {
        let mut request = json!({ "scenario": scenario });
        request.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        let answer = server.post("/image", &request);
        (answer.status, answer.error())
    };
    let (status, (message, _)) = ask(json!({ "held": "no such key\u{7}" }));
    assert_eq!((status, message.as_str()), (410, "the picture `no such key ` is no longer held"));
    let (status, (_, path)) = ask(json!({ "picture": "absent.png" }));
    assert_eq!((status, path.as_deref()), (422, Some("image.file")));
    assert_eq!(ask(json!({ "picture": "../../etc/passwd" })).0, 422);
    assert_eq!(ask(json!({ "files": { "a.png": "00" }, "picture": "a.png" })).0, 410);
    for angles in [json!({ "theta_deg": 90 }), json!({ "phi_deg": 1e9 })] {
        assert_eq!(ask(angles).0, 400);
    }
    let lamps = "[[lighting.directed]]\ntheta_deg = 30\nshare = 0.01\n".repeat(20);
    let many =
        json!({ "scenario": format!("{scenario}\n{lamps}").replace("diffuse = 0.5", "diffuse = 0.3") });
    let (message, _) = server.post("/image", &many).error();
    assert!(message.contains("at most 14 lamps"), "{message}");
    let large = scenario
        .replace("[display.glass]", "[display.matrix]\nppi = 300\npixels = [3000, 2000]\n[display.glass]");
    let (message, _) =
        server.post("/image/export", &json!({ "scenario": large, "what": "seen.png" })).error();
    assert!(message.contains("too large for the page"), "{message}");
}

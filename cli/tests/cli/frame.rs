//! Frames of `papilio image` for the controller of a panel: their bytes give the states back, and wrong input is
//! answered.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use papilio_formats::panel::{CONTROLLERS, read_shown_states};
use papilio_formats::{DataFile, write_rgb_png};
use papilio_scenario::ExampleDisplay;
use serde_json::{Value, json};

use crate::common::{names, papilio_command as papilio, scenario, stderr, stdout};

/// Columns and rows of the pictures of these tests: rows do not fill whole bytes.
const SIZE: [usize; 2] = [21, 12];

/// Writes a picture of random colours.
fn picture(folder: &Path, seed: usize) -> PathBuf {
    let colour = |at: usize| {
        let value = (at + 1) * 2_654_435_761 + seed * 40_503;
        [value >> 8, value >> 16, value >> 24].map(|value| value as u8)
    };
    let pixels: Vec<[u8; 3]> = (0..SIZE[0] * SIZE[1]).map(colour).collect();
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, SIZE[0], &pixels, false).unwrap();
    let path = folder.join(format!("picture-{seed}.png"));
    fs::write(&path, bytes).unwrap();
    path
}

fn image(file: &Path, picture: &Path, more: &[&str]) -> Output {
    papilio().arg("image").arg(file).arg(picture).args(more).output().unwrap()
}

/// The folder of a run that succeeds, and its `frame`.
fn run(folder: &Path, name: &str, file: &Path, picture: &Path, more: &[&str]) -> (PathBuf, Value) {
    let out = folder.join(name);
    let output = image(file, picture, &[more, &["--out", out.to_str().unwrap()]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let numbers: Value = serde_json::from_slice(&fs::read(out.join("image.json")).unwrap()).unwrap();
    let frame = numbers.get("frame").cloned().unwrap_or_default();
    (out, frame)
}

fn states(out: &Path) -> Vec<u8> {
    read_shown_states(&DataFile::open(&out.join("states.png"), "states.png").unwrap()).unwrap().states
}

/// The bits of a pixel, the most significant first, in rows of whole bytes.
fn code_at(bytes: &[u8], columns: usize, bits: usize, at: usize) -> u8 {
    let row = &bytes[at / columns * (columns * bits).div_ceil(8)..];
    let bit = |at: usize| row[at / 8] >> (7 - at % 8) & 1;
    (0..bits).fold(0, |code, k| code << 1 | bit(at % columns * bits + k))
}

/// The shipped panel has the codes of its controller; frame.bin, frame.h and frame.bmp have the states of
/// states.png, and image.json says how.
#[test]
fn frame_has_the_states_in_the_codes_of_the_controller() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture(folder.path(), 1);
    let (out, frame) =
        run(folder.path(), "out", &scenario("six-ink"), &picture, &["--packed", "4", "--frame", "h,bmp,bin"]);
    let expected = ["frame.bin", "frame.bmp", "frame.h", "image.json", "seen.exr", "seen.png", "states.png"];
    assert_eq!(names(&out), expected);
    let codes = json!({ "black": 0, "white": 1, "yellow": 2, "red": 3, "blue": 5, "green": 6 });
    let whole = json!({
        "size": SIZE, "bits": 4, "planes": false, "bytes_per_row": 11, "controller": "spectra-6", "codes": codes,
        "rotation_deg": 0, "mirrored": false, "changed": null,
    });
    assert_eq!(frame, whole);
    // The inks of the file are black, white, yellow, red, blue, green.
    let wanted: Vec<u8> = states(&out).iter().map(|state| [0, 1, 2, 3, 5, 6][usize::from(*state)]).collect();
    assert!([0, 1, 2, 3, 5, 6].iter().all(|code| wanted.contains(code)), "{wanted:?}");
    let bytes = fs::read(out.join("frame.bin")).unwrap();
    assert_eq!(bytes.len(), 11 * SIZE[1]);
    let found =
        |bytes: &[u8]| -> Vec<u8> { (0..wanted.len()).map(|at| code_at(bytes, SIZE[0], 4, at)).collect() };
    assert_eq!(found(&bytes), wanted);
    let header = fs::read_to_string(out.join("frame.h")).unwrap();
    let listed = header.split('{').nth(1).unwrap().split('}').next().unwrap();
    let numbers = listed.split(',').map(str::trim).filter(|item| !item.is_empty());
    let listed: Vec<u8> =
        numbers.map(|item| u8::from_str_radix(item.trim_start_matches("0x"), 16).unwrap()).collect();
    assert_eq!(listed, bytes);
    assert!(header.contains("black 0, white 1, yellow 2") && header.contains("Six-ink"), "{header}");
    // BMP: 14 + 40 + 16 x 4 bytes, then rows of 12 bytes from the lowest.
    let bmp = fs::read(out.join("frame.bmp")).unwrap();
    let rows: Vec<u8> = bmp[118..].chunks(12).rev().flat_map(|row| row[..11].to_vec()).collect();
    assert_eq!((bmp.len(), found(&rows)), (118 + 12 * SIZE[1], wanted));
    // The schema of image.json has all of its keys.
    let schema = papilio().args(["schema", "--image"]).output().unwrap();
    let schema: Value = serde_json::from_slice(&schema.stdout).unwrap();
    let described = schema["$defs"]["FrameNumbers"]["properties"].as_object().unwrap();
    assert!(schema["properties"].as_object().unwrap().contains_key("frame"));
    assert_eq!(described.keys().collect::<Vec<_>>(), frame.as_object().unwrap().keys().collect::<Vec<_>>());
    // A later run without a frame leaves none behind.
    let (out, frame) = run(folder.path(), "out", &scenario("six-ink"), &picture, &[]);
    assert_eq!(
        (names(&out).join(" "), frame),
        ("image.json seen.exr seen.png states.png".to_owned(), Value::Null)
    );
}

/// A frame for a turned panel is the same frame, each pixel at its turned place; what is seen does not turn.
#[test]
fn frame_is_turned_and_what_is_seen_is_not() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture(folder.path(), 2);
    let of = |name: &str, more: &[&str]| {
        let more = [&["--packed", "8"][..], more].concat();
        let (out, frame) = run(folder.path(), name, &scenario("six-ink"), &picture, &more);
        (fs::read(out.join("frame.bin")).unwrap(), fs::read(out.join("seen.png")).unwrap(), frame)
    };
    let (plain, seen, _) = of("plain", &[]);
    let (turned, seen_turned, frame) = of("turned", &["--rotate", "90", "--mirror"]);
    assert_eq!((seen, &frame["size"]), (seen_turned, &json!([SIZE[1], SIZE[0]])));
    assert_eq!((&frame["rotation_deg"], &frame["mirrored"]), (&json!(90), &json!(true)));
    // A quarter turn and a mirror image are a transposition: rows are columns.
    let [columns, rows] = SIZE;
    for (at, code) in plain.iter().enumerate() {
        assert_eq!(*code, turned[at % columns * rows + at / columns]);
    }
}

/// Codes of the user's own, planes, and without codes the numbers of the states; the fewest bits.
#[test]
fn codes_may_be_given_or_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture(folder.path(), 3);
    let epaper = scenario("epaper");
    let json = |more: &[&str]| -> Value {
        let output = image(&epaper, &picture, &[more, &["--json"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["frame"].clone()
    };
    let numbers = json(&["--frame", "bin"]);
    assert_eq!((&numbers["bits"], &numbers["controller"]), (&json!(1), &Value::Null));
    let states: Vec<u64> =
        numbers["codes"].as_object().unwrap().values().map(|v| v.as_u64().unwrap()).collect();
    assert_eq!(states.len(), 2);
    let own = "display.pixel.codes={ black = 9, white = 2 }";
    let own = json(&["--frame", "bin", "--set", own]);
    assert_eq!((&own["bits"], &own["codes"]["black"]), (&json!(4), &json!(9)));
    let planes = json(&["--packed", "planes", "--set", "display.pixel.codes={ black = 1, white = 6 }"]);
    assert_eq!(
        (&planes["bits"], &planes["planes"], &planes["bytes_per_row"]),
        (&json!(3), &json!(true), &json!(3))
    );
    let named = json(&["--frame", "h", "--set", "display.pixel.codes=black-white-red"]);
    assert_eq!((&named["bits"], &named["planes"]), (&json!(2), &json!(true)));
    let output =
        image(&epaper, &picture, &["--packed", "2", "--out", folder.path().join("o").to_str().unwrap()]);
    let table = stdout(&output);
    assert!(
        table.contains("frame: 21 x 12 pixels, 2 bits for each pixel; codes: white 0, black 1 (the"),
        "{table}"
    );
}

/// A usual panel has the codes of a controller of its kind, without a scenario file.
#[test]
fn usual_panels_have_codes_of_controllers() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture(folder.path(), 7);
    for display in ExampleDisplay::with_panels() {
        let small = ["--set", "display.matrix.pixels=[16,12]", "--frame", "bin", "--json"];
        let output =
            papilio().arg("image").arg(&picture).args(["--on", display.name]).args(small).output().unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        let numbers: Value = serde_json::from_slice(&output.stdout).unwrap();
        let name = numbers["frame"]["controller"].as_str().unwrap();
        assert!(CONTROLLERS.iter().any(|controller| controller.name == name), "{}: {name}", display.name);
    }
}

/// The mask is white exactly where two frames differ, in the rows and columns of the frame, and the rectangle has
/// all of it.
#[test]
fn changed_pixels_are_those_of_two_frames() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = [4, 5].map(|seed| picture(folder.path(), seed));
    let packed = ["--packed", "8", "--rotate", "180"];
    let six = scenario("six-ink");
    let (before, _) = run(folder.path(), "before", &six, &first, &packed);
    let shown = before.join("states.png");
    let since = [&packed[..], &["--since", shown.to_str().unwrap()]].concat();
    let (after, frame) = run(folder.path(), "after", &six, &second, &since);
    let [old, new] = [&before, &after].map(|out| fs::read(out.join("frame.bin")).unwrap());
    let differ: Vec<bool> = old.iter().zip(&new).map(|(old, new)| old != new).collect();
    // A grey PNG of 1 bit, as the reader of pictures sees it: 0 or the luminance of white.
    let mask = DataFile::open(&after.join("changed.png"), "changed.png").unwrap();
    let mask = papilio_formats::read_picture(&mask, &papilio_formats::RgbSpace::srgb()).unwrap().value.xyz();
    assert_eq!(mask.iter().map(|xyz| xyz[1] > 0.5).collect::<Vec<_>>(), differ);
    let count = differ.iter().filter(|one| **one).count();
    assert!(count > 100, "{count}");
    assert_eq!(frame["changed"], json!({ "pixels": count, "rectangle": [0, 0, SIZE[0], SIZE[1]] }));
    // The same frame again: nothing changed.
    let (_, same) = run(folder.path(), "same", &six, &first, &since);
    assert_eq!(same["changed"], json!({ "pixels": 0, "rectangle": null }));
}

#[test]
fn wrong_frames_are_answered() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture(folder.path(), 6);
    let (out, _) = run(folder.path(), "out", &scenario("six-ink"), &picture, &[]);
    let shown = out.join("states.png");
    let shown = shown.to_str().unwrap();
    let other = picture.to_str().unwrap();
    let size = ["--set", "display.matrix.pixels=[24,12]"];
    let states = ["--set", "image.states=[\"white\",\"black\"]"];
    let codes = |text: &'static str| ["--packed", "4", "--set", text];
    for (arguments, parts) in [
        (&["--packed", "2"][..], &["the code of `green` is 6", "--packed 4"][..]),
        (&["--packed", "3"], &["possible values: 1, 2, 4, 8, planes"]),
        (&["--rotate", "45"], &["possible values: 0, 90, 180, 270"]),
        (&["--rotate", "90"], &["no frame is written", "--packed BITS"]),
        (&["--mirror"], &["no frame is written"]),
        (&["--packed", "4", "--set", "image.halftone=none"], &["gives no pixel a state"]),
        (&codes("display.pixel.codes=spectra-7"), &["`spectra-7`", "\"spectra-6\""]),
        (
            &codes("display.pixel.codes=four-grey"),
            &["no code for the states `yellow`, `red`, `blue`, `green`", "dark_grey"],
        ),
        (
            &codes("display.pixel.codes={ black = 0, white = 1 }"),
            &["a code for the states `yellow`", "is missing"],
        ),
        (&codes("display.pixel.codes={ black = 0, white = 256 }"), &["256", "a whole number from 0 to 255"]),
        (&codes("display.pixel.codes=6"), &["the name of a controller", "\"acep-7\""]),
        (
            &codes("display.pixel.codes={ black = 0, white = 1, yellow = 2, red = 2, blue = 3, green = 4 }"),
            &["the states `yellow` and `red` have the same code 2"],
        ),
        (
            &codes("display.pixel.codes={ black=0, white=1, yellow=2, red=3, blue=5, green=6, grean=7 }"),
            &["there is no state `grean`"],
        ),
        (&["--since", "nowhere.png"], &["nowhere.png"]),
        (&["--since", other], &["not numbers of states", "expected states.png"]),
        (&[&["--since", shown], &size[..]].concat(), &["has 21 x 12 pixels, and this picture 24 x 12"]),
        (
            &[&["--since", shown], &states[..]].concat(),
            &["its states are black, white, yellow, red, blue, green"],
        ),
    ] {
        let output = image(&scenario("six-ink"), &picture, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        parts
            .iter()
            .for_each(|part| assert!(stderr(&output).contains(part), "{arguments:?}: {}", stderr(&output)));
    }
    // A mistake in the file has its line and column.
    let text = fs::read_to_string(scenario("six-ink")).unwrap().replace("\"spectra-6\"", "\"acep-6\"");
    let file = folder.path().join("wrong.toml");
    fs::write(&file, &text).unwrap();
    let line = text.lines().position(|line| line.starts_with("codes")).unwrap() + 1;
    let output = image(&file, &picture, &[]);
    assert!(stderr(&output).contains(&format!("wrong.toml:{line}:9")), "{}", stderr(&output));
}

/// The table of docs/panel.md has the controllers of the program, with their codes and sources.
#[test]
fn documentation_has_all_controllers() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/panel.md")).unwrap();
    for controller in CONTROLLERS {
        let row = page.lines().find(|line| line.starts_with(&format!("| `{}` |", controller.name))).unwrap();
        for (state, code) in controller.codes {
            assert!(row.contains(&format!("{state} {code}")), "{row}");
        }
        // Repositories and files of the source.
        let words =
            controller.source.split([' ', ',', ';', '(', ')']).filter(|word| word.contains(['/', '.', '_']));
        words.for_each(|word| assert!(row.contains(word), "{word}: {row}"));
    }
}

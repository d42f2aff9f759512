//! `papilio image`: files, colours of uniform pictures, gamut, light between neighbours, and answers to wrong
//! input.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::Duration;

use papilio_formats::{DataFile, RgbSpace, read_picture, write_rgb_png, write_scene_exr};
use serde_json::Value;

use crate::common::{files, names, papilio_command as papilio, same, scenario, stderr};

fn image(file: &Path, more: &[&str]) -> Output {
    papilio().arg("image").arg(file).args(more).output().unwrap()
}

fn json(file: &Path, more: &[&str]) -> Value {
    let output = image(file, &[more, &["--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Writes a picture of 24 x 16 pixels of these colours in turn.
fn picture(folder: &Path, colours: &[[u8; 3]]) -> PathBuf {
    let pixels: Vec<[u8; 3]> = (0..24 * 16).map(|at| colours[at % colours.len()]).collect();
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, 24, &pixels, false).unwrap();
    let path = folder.join("picture.png");
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn files_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let out = folder.path().join("out");
    let output = image(&scenario("six-ink"), &[file.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!(names(&out), ["image.json", "seen.exr", "seen.png", "states.png"]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("24 x 16 pixels") && table.contains("S-CIELAB: mean"), "{table}");
    let numbers: Value = serde_json::from_slice(&fs::read(out.join("image.json")).unwrap()).unwrap();
    let coverage = numbers["coverage"].as_object().unwrap();
    let sum: f64 = coverage.values().map(|fraction| fraction.as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-12 && numbers["out_of_gamut_fraction"].as_f64().unwrap() > 0.3);
    assert_eq!(numbers["states"].as_array().unwrap().len(), 6);
    assert!(numbers["notes"].is_array());
}

/// The light of a scene: ten times as much is the same picture, and the table says what became white.
#[test]
fn pictures_of_high_dynamic_range_get_a_white() {
    let folder = tempfile::tempdir().unwrap();
    let coverage = [1.0, 10.0].map(|factor| {
        let pixels: Vec<[f32; 3]> = (0..24 * 16)
            .map(|at| [0.5, 0.1, 0.02].map(|value| factor * value * 1.03_f32.powi(at % 200)))
            .collect();
        let path = folder.path().join("scene.exr");
        let mut bytes = Vec::new();
        write_scene_exr(&mut bytes, 24, pixels.len(), |at| pixels[at], None).unwrap();
        fs::write(&path, bytes).unwrap();
        let output = image(&scenario("six-ink"), &[path.to_str().unwrap(), "--json"]);
        assert!(stderr(&output).contains("has no white"), "{}", stderr(&output));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["coverage"].clone()
    });
    assert!(coverage[0]["red"].as_f64().unwrap() > 0.1, "{coverage:?}");
    for (state, share) in coverage[0].as_object().unwrap() {
        let other = coverage[1][state].as_f64().unwrap();
        assert!((share.as_f64().unwrap() - other).abs() < 0.02, "{state} {coverage:?}");
    }
}

/// A frame for two rooms: in each of them it is closer to the photograph than the frame that was made for the other.
#[test]
fn compromise_beats_the_frame_of_the_other_room() {
    let shown = |prepared_for: &str| {
        let prepared_for = format!("image.prepared_for={prepared_for}");
        let more = ["--set", &prepared_for, "--set", "display.matrix.pixels=[150,100]", "--rooms", "D65"];
        let found = json(&scenario("six-ink"), &[&more[..], &["--set", "image.fit=\"cover\""]].concat());
        let in_both = |against: &str| {
            [&found, &found["rooms"][0]].map(|one| one[against]["scielab_mean"].as_f64().unwrap())
        };
        ["against_photograph", "against_mapped"].map(in_both)
    };
    let [here, there, both] = ["\"this\"", "\"D65\"", "[\"this\", \"D65\"]"].map(shown);
    for ((here, there), both) in here.iter().zip(there).zip(both) {
        assert!(both[0] < there[0] && both[1] < here[1], "{here:?} {there:?} {both:?}");
    }
    // Each room's own frame is closest to the target in its light.
    assert!(here[1][0] < both[1][0] && there[1][1] < both[1][1], "{here:?} {there:?} {both:?}");
    let wrong = |list: &str| {
        let prepared_for = format!("image.prepared_for={list}");
        let output = image(&scenario("six-ink"), &["--set", &prepared_for]);
        assert_eq!(output.status.code(), Some(2), "{list}");
        stderr(&output)
    };
    assert!(wrong("[]").contains("the list is empty"), "{}", wrong("[]"));
    // A light that is there twice would weigh double: also under two names, as the scenario's own spectrum.
    for (list, part) in [
        ("[\"this\", \"this\"]", "`this` is in this list twice"),
        ("[\"D65\", \"FL11\", \"D65\"]", "`D65` is in this list twice"),
        ("[\"FL11\", \"this\", \"LED-B1\"]", "`LED-B1` is the same light as `this`"),
    ] {
        let said = wrong(list);
        assert!(said.contains(part) && said.contains("remove one of them"), "{said}");
    }
    assert!(wrong("[\"this\", \"moon\"]").contains("no illuminant named `moon`"));
}

/// Drawings by a mask; a mask with other proportions, or none at all, is answered with its place and a hint.
#[test]
fn regions_are_given_by_a_mask() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let write = |columns: usize, rows: usize| {
        let half = |at: usize| if at % columns < columns / 2 { [0; 3] } else { [255; 3] };
        let mut bytes = Vec::new();
        let pixels: Vec<[u8; 3]> = (0..columns * rows).map(half).collect();
        write_rgb_png(&mut bytes, columns, &pixels, false).unwrap();
        fs::write(folder.path().join("mask.png"), bytes).unwrap();
    };
    let mask = format!("image.regions={:?}", folder.path().join("mask.png").to_str().unwrap());
    let more = [file.to_str().unwrap(), "--set", &mask];
    let fraction = |more: &[&str]| json(&scenario("six-ink"), more)["drawing_fraction"].as_f64().unwrap();
    for (columns, rows) in [(24, 16), (48, 32)] {
        write(columns, rows);
        assert_eq!(fraction(&more), 0.5);
    }
    assert_eq!(fraction(&more[..1]), 0.0);
    assert_eq!(fraction(&[more[0], "--set", "image.regions=drawing"]), 1.0);
    write(24, 10);
    let wrong = stderr(&image(&scenario("six-ink"), &more));
    for part in ["24 x 10 pixels", "24 x 16", "black where it is a drawing"] {
        assert!(wrong.contains(part), "{wrong}");
    }
    let missing = stderr(&image(&scenario("six-ink"), &[more[0], "--set", "image.regions=nowhere.png"]));
    assert!(missing.contains("nowhere.png"), "{missing}");
}

/// Without a scenario file: a photograph on a usual panel, which is upright if the photograph is.
#[test]
fn pictures_are_shown_on_usual_panels() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let lying = json(&file, &["--on", "seven-ink", "--set", "image.halftone=\"nearest\""]);
    assert_eq!(lying["size"], serde_json::json!([600, 448]));
    assert_eq!(lying["states"].as_array().unwrap().len(), 7);
    let pixels = vec![[128, 128, 128]; 8 * 12];
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, 8, &pixels, false).unwrap();
    fs::write(&file, bytes).unwrap();
    let upright = json(&file, &["--on", "four-grey", "--rooms", "office"]);
    assert_eq!(upright["size"], serde_json::json!([480, 800]));
    assert_eq!(upright["rooms"][0]["room"], "office");
    let office = json(&file, &["--on", "four-grey", "--light", "office"]);
    assert_eq!(office["light"]["illuminance_lx"], upright["rooms"][0]["light"]["illuminance_lx"]);
    assert_ne!(office["light"]["illuminance_lx"], upright["light"]["illuminance_lx"]);
    let alone = image(&scenario("six-ink"), &["--light", "office"]);
    assert!(stderr(&alone).contains("--on"), "{}", stderr(&alone));
    let unknown = image(&file, &["--on", "four-grey", "--light", "ofice"]);
    assert!(stderr(&unknown).contains("similar value exists: 'office'"), "{}", stderr(&unknown));
    // A flat grey above the panel's black: tone leaves it, four greys have no layers above them.
    let losses = &upright["losses"];
    assert!(losses["tone"].as_f64().unwrap() < 0.5 && losses["layers"].as_f64().unwrap() < 1e-3, "{losses}");
    assert!(
        losses["gamut"].as_f64().unwrap() < 0.1 && losses["halftone"].as_f64().unwrap() > 0.1,
        "{losses}"
    );
    assert_eq!(lying["losses"], Value::Null);
    let twice = image(&scenario("six-ink"), &[file.to_str().unwrap(), "--on", "six-ink"]);
    assert!(stderr(&twice).contains("takes the place of a scenario"), "{}", stderr(&twice));
    let none = image(Path::new("missing.png"), &["--on", "six-ink"]);
    assert!(stderr(&none).contains("missing.png"), "{}", stderr(&none));
    let unknown = image(&file, &["--on", "imod"]);
    assert!(stderr(&unknown).contains("six-ink, seven-ink"), "{}", stderr(&unknown));
}

/// A folder of pictures: each has its results; the same command does not compute them again, another light does, and a
/// damaged picture does not keep the others from being shown.
#[test]
fn folders_of_pictures_are_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let photographs = folder.path().join("photographs");
    fs::create_dir(&photographs).unwrap();
    for name in ["a.png", "b.PNG", "notes.txt"] {
        fs::copy(&file, photographs.join(name)).unwrap();
    }
    fs::write(photographs.join("b.jpg"), b"\xff\xd8\xff").unwrap();
    let out = folder.path().join("out");
    let run = |more: &[&str]| {
        let arguments = [photographs.to_str().unwrap(), "--out", out.to_str().unwrap()];
        image(&scenario("six-ink"), &[&arguments, more].concat())
    };
    let first = run(&[]);
    assert!(
        !first.status.success() && stderr(&first).contains("1 of 3 pictures could not be shown"),
        "{}",
        stderr(&first)
    );
    assert_eq!(names(&out), ["a", "b.PNG", "pictures.json"]);
    let all = || -> Value { serde_json::from_slice(&fs::read(out.join("pictures.json")).unwrap()).unwrap() };
    let before = all();
    assert_eq!(before[0]["results"], "a");
    assert!(before[0]["hue_error_deg"].as_f64().is_some());
    let written = |name: &str| fs::metadata(out.join(name).join("seen.png")).unwrap().modified().unwrap();
    let time = written("a");
    fs::remove_file(photographs.join("b.jpg")).unwrap();
    fs::rename(out.join("b.PNG"), out.join("b")).unwrap();
    fs::remove_dir_all(out.join("b")).unwrap();
    let again = run(&[]);
    assert!(again.status.success(), "{}", stderr(&again));
    assert_eq!(written("a"), time, "a finished picture is computed again");
    assert_eq!(all()[1]["results"], "b");
    run(&["--set", "lighting.spectrum=D65"]);
    assert!(written("a") > time && all()[0]["hash"] != before[0]["hash"]);
    fs::remove_file(photographs.join("a.png")).unwrap();
    fs::remove_file(photographs.join("b.PNG")).unwrap();
    assert!(stderr(&run(&[])).contains("contains no picture"), "{}", stderr(&run(&[])));
}

/// A finished picture is computed again if one of its files is not as it was written, or if its record does not say how that was.
#[test]
fn pictures_with_missing_or_damaged_files_are_computed_again() {
    let folder = tempfile::tempdir().unwrap();
    let photographs = folder.path().join("photographs");
    fs::create_dir(&photographs).unwrap();
    picture(&photographs, &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let out = folder.path().join("out");
    let run = || {
        let output = image(
            &scenario("six-ink"),
            &[
                photographs.to_str().unwrap(),
                "--rooms",
                "D65",
                "--frame",
                "bmp",
                "--out",
                out.to_str().unwrap(),
            ],
        );
        assert!(output.status.success(), "{}", stderr(&output));
    };
    run();
    let of_one = out.join("picture");
    let whole = files(&of_one);
    assert_eq!(whole.len(), 7, "{:?}", whole.keys());
    for (name, content) in &whole {
        let file = of_one.join(name);
        let mut other = content.clone();
        other[content.len() / 2] ^= 1;
        fs::remove_file(&file).unwrap();
        run();
        same(&files(&of_one), &whole);
        for damaged in [&content[..content.len() / 2], &other] {
            fs::write(&file, damaged).unwrap();
            run();
            same(&files(&of_one), &whole);
        }
    }
    // A record of an earlier version, which has no sums of files.
    let all = out.join("pictures.json");
    let journal = fs::read(&all).unwrap();
    let mut old: Value = serde_json::from_slice(&journal).unwrap();
    ["files", "papilio"].iter().for_each(|key| _ = old[0].as_object_mut().unwrap().remove(*key).unwrap());
    fs::write(&all, old.to_string()).unwrap();
    fs::remove_file(of_one.join("seen.png")).unwrap();
    run();
    same(&files(&of_one), &whole);
    assert_eq!(fs::read(&all).unwrap(), journal);
}

/// A command that resumes another one is killed at its second picture, which is a large one: the records of the pictures that it
/// has not reached stay, and the third one is not computed again.
#[test]
fn records_of_later_pictures_survive_a_killed_resumption() {
    let folder = tempfile::tempdir().unwrap();
    let photographs = folder.path().join("photographs");
    fs::create_dir(&photographs).unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    for name in ["a.png", "c.png"] {
        fs::copy(&file, photographs.join(name)).unwrap();
    }
    let pixels: Vec<[u8; 3]> =
        (0..240 * 160_usize).map(|at| [(at % 251) as u8, (at % 17) as u8, 90]).collect();
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, 240, &pixels, false).unwrap();
    fs::write(photographs.join("b.png"), bytes).unwrap();
    let out = folder.path().join("out");
    let all = out.join("pictures.json");
    let command = || {
        let mut command = papilio();
        command.arg("image").arg(scenario("six-ink")).arg(&photographs).arg("--out").arg(&out);
        command
    };
    assert!(command().output().unwrap().status.success());
    let [first, of_c] =
        [&all, &out.join("c/seen.png")].map(|path| fs::metadata(path).unwrap().modified().unwrap());
    let content = fs::read(&all).unwrap();
    for name in ["a", "b"] {
        fs::remove_file(out.join(name).join("image.json")).unwrap();
    }
    let mut child = command().stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while fs::metadata(&all).unwrap().modified().unwrap() == first {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!out.join("b/image.json").exists(), "the command was killed too late");
    let records: Vec<Value> = serde_json::from_slice(&fs::read(&all).unwrap()).unwrap();
    let results: Vec<&Value> = records.iter().map(|one| &one["results"]).collect();
    assert_eq!(results, ["a", "b", "c"]);
    assert!(command().output().unwrap().status.success());
    assert_eq!(fs::read(&all).unwrap(), content);
    assert_eq!(fs::metadata(out.join("c/seen.png")).unwrap().modified().unwrap(), of_c);
}

/// The numbers of a finished picture are not computed again, and a resumed command writes them as they are in the journal. Each
/// of these is one whose digits, as a whole number divided by a power of ten, give a neighbour of it.
#[test]
fn numbers_of_finished_pictures_stay_as_they_are() {
    const KEYS: [&str; 4] = ["scielab_mean", "hue_error_deg", "chroma_ratio", "local_contrast_ratio"];
    const NUMBERS: [&str; 4] =
        ["1.6094379124341003", "9.311283477587823", "0.9259259259259259", "3.4965075614664802"];
    let folder = tempfile::tempdir().unwrap();
    let photographs = folder.path().join("photographs");
    fs::create_dir(&photographs).unwrap();
    picture(&photographs, &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let out = folder.path().join("out");
    let run = || {
        let output =
            image(&scenario("six-ink"), &[photographs.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert!(output.status.success(), "{}", stderr(&output));
        fs::read_to_string(out.join("pictures.json")).unwrap()
    };
    let mut journal = run();
    for (key, number) in KEYS.into_iter().zip(NUMBERS) {
        let start = journal.find(&format!("\"{key}\":")).unwrap() + key.len() + 3;
        let start = start + journal[start..].find(|c: char| c != ' ').unwrap();
        let end = start + journal[start..].find([',', '\n', '}']).unwrap();
        journal.replace_range(start..end, number);
    }
    fs::write(out.join("pictures.json"), &journal).unwrap();
    assert_eq!(run(), journal);
}

/// A number that was written as JSON is read back bit by bit: a linear congruential sequence (Knuth) of numbers of all sizes,
/// and of numbers from 1 to 2.
#[test]
fn numbers_of_json_are_read_back_bit_by_bit() {
    let mut bits = 1_u64;
    for _ in 0..20_000 {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        for number in [f64::from_bits(bits), f64::from_bits(bits >> 12 | 1.0_f64.to_bits())] {
            if number.is_finite() {
                let text = serde_json::to_string(&number).unwrap();
                let read: f64 = serde_json::from_str(&text).unwrap();
                assert_eq!(read.to_bits(), number.to_bits(), "{text} is read as {read:?}");
            }
        }
    }
}

/// A picture for a screen with a wide gamut states its space, and decodes to the same colours.
#[test]
fn both_spaces_of_screens_have_the_same_colours() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [120, 160, 90]]);
    let decoded = ["srgb", "display-p3"].map(|space| {
        let out = folder.path().join(space);
        let output = image(
            &scenario("six-ink"),
            &[
                file.to_str().unwrap(),
                "--space",
                space,
                "--out",
                out.to_str().unwrap(),
                "--set",
                "image.halftone=none",
            ],
        );
        assert!(output.status.success(), "{}", stderr(&output));
        let seen = DataFile::open(&out.join("seen.png"), "seen.png").unwrap();
        let numbers: Value = serde_json::from_slice(&fs::read(out.join("image.json")).unwrap()).unwrap();
        assert_eq!(numbers["clipped_fraction"], 0.0);
        read_picture(&seen, &RgbSpace::srgb()).unwrap().value
    });
    assert!(decoded[1].space().contains("P3"), "{}", decoded[1].space());
    let pairs = decoded[0].xyz().into_iter().flatten().zip(decoded[1].xyz().into_iter().flatten());
    // A step of a byte is less than 1 % of white.
    pairs.for_each(|(one, other)| assert!((one - other).abs() < 0.01, "{one} {other}"));
}

/// The square-root integrals of image.json are those of `papilio mtf`; a display without blur has the larger
/// ones.
#[test]
fn sharpness_is_that_of_the_transfer() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[255; 3], [0; 3]]);
    let found = json(&scenario("matrix"), &[file.to_str().unwrap()]);
    let mtf = papilio().arg("mtf").arg(scenario("matrix")).arg("--json").output().unwrap();
    let mtf: Value = serde_json::from_slice(&mtf.stdout).unwrap();
    for (k, axis) in ["x", "y"].iter().enumerate() {
        let own = found["sharpness"]["sqri_jnd"][k].as_f64().unwrap();
        let ideal = found["sharpness"]["sqri_ideal_jnd"][k].as_f64().unwrap();
        let expected = mtf["views"][0]["states"]["white"][format!("sqri_jnd_{axis}")].as_f64().unwrap();
        assert!((own - expected).abs() < 1e-2, "{axis}: {own} {expected}");
        assert!(ideal > own + 0.5 && ideal < own + 20.0, "{axis}: {own} {ideal}");
    }
    let without = json(&scenario("six-ink"), &[file.to_str().unwrap()]);
    assert!(without["sharpness"].is_null(), "{}", without["sharpness"]);
}

/// White is the white state, black the black one, with the colours of `papilio run`; a colour that is outside
/// the gamut becomes one inside.
#[test]
fn white_and_black_are_those_of_the_display() {
    let folder = tempfile::tempdir().unwrap();
    let run = papilio().arg("run").arg(scenario("six-ink")).arg("--json").output().unwrap();
    let run: Value = serde_json::from_slice(&run.stdout).unwrap();
    for (colour, state) in [([255; 3], "white"), ([0; 3], "black")] {
        let file = picture(folder.path(), &[colour]);
        let found = json(&scenario("six-ink"), &[file.to_str().unwrap()]);
        assert_eq!(found["coverage"][state], 1.0, "{found}");
        for (k, name) in ["X", "Y", "Z"].iter().enumerate() {
            let [ours, theirs] = [&found["mean_XYZ"][k], &run["views"][0]["states"][state][name]]
                .map(|one| one.as_f64().unwrap());
            assert!((ours - theirs).abs() < 1e-6, "{state} {name}: {ours} {theirs}");
        }
    }
    let green = picture(folder.path(), &[[0, 255, 0]]);
    for intent in ["natural", "vivid", "relative", "absolute", "clip"] {
        for more in ["image.halftone=\"none\"", "image.map_space=\"cam16-ucs\""] {
            let sets =
                [green.to_str().unwrap(), "--set", &format!("image.intent=\"{intent}\""), "--set", more];
            let found = json(&scenario("six-ink"), &sets);
            assert_eq!(
                (&found["out_of_gamut_fraction"], &found["cut_fraction"]),
                (&1.0.into(), &0.0.into()),
                "{intent}"
            );
        }
    }
}

/// Given adjustments are used and reported; `"auto"` is as without the key; other intents have no report.
#[test]
fn adjustments_are_used_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[150, 90, 60]]);
    let file = file.to_str().unwrap();
    let found = |sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|one| ["--set", one]).collect();
        json(&scenario("six-ink"), &[&[file][..], &sets].concat())
    };
    let plain = found(&[]);
    let auto = found(&["image.exposure=\"auto\"", "image.contrast=\"auto\"", "image.white_balance=\"none\""]);
    assert_eq!((&plain["rendition"], &plain["coverage"]), (&auto["rendition"], &auto["coverage"]));
    let given = found(&["image.exposure=-1", "image.saturation=0", "image.white_balance=3000"]);
    let of = |key: &str| given["rendition"][key].as_f64().unwrap();
    assert_eq!((of("exposure"), of("saturation"), of("white_balance_k")), (-1.0, 0.0, 3000.0));
    let luminance = |one: &Value| one["mean_XYZ"][1].as_f64().unwrap();
    assert!(luminance(&given) < 0.8 * luminance(&plain));
    assert!(given["against_photograph"]["chroma_ratio"].as_f64().unwrap() < 0.5, "{given}");
    let relative = found(&["image.intent=\"relative\""]);
    assert!(relative["rendition"].is_null() && !relative["against_photograph"]["hue_error_deg"].is_null());
}

/// A halftone has the mean colour that was to be shown, apart from the errors that leave the picture at its
/// borders.
#[test]
fn halftone_keeps_the_mean_colour() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[120, 125, 118]]);
    let mean = |halftone: &str| {
        let sets = format!("image.halftone=\"{halftone}\"");
        let size = ["--set", "display.matrix.pixels=[160,160]", "--set", "image.fit=\"stretch\""];
        let found = json(
            &scenario("six-ink"),
            &[&[file.to_str().unwrap(), "--set", sets.as_str()][..], &size].concat(),
        );
        [0, 1, 2].map(|k| found["mean_XYZ"][k].as_f64().unwrap())
    };
    // Errors of half a white pixel, at most, leave at each of the 4 x 160 pixels of the border. 160 is a
    // multiple of the sides of neither mask, whose levels are finer.
    let wanted = mean("none");
    let halftones =
        ["refined-error-diffusion", "error-diffusion", "ordered", "void-and-cluster", "direct-binary-search"];
    for halftone in halftones {
        for ((shown, wanted), white) in mean(halftone).into_iter().zip(wanted).zip([0.43, 0.38, 0.13]) {
            assert!((shown - wanted).abs() < 2.0 * white / 160.0, "{halftone}: {shown} {wanted}");
        }
    }
}

/// Without keys, error diffusion is refined; with a kernel it is as the kernel has it.
#[test]
fn kernel_without_halftone_is_plain_error_diffusion() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[60, 90, 130], [200, 160, 90]]);
    let coverage = |sets: &[&str]| {
        let sets = sets.iter().flat_map(|one| ["--set", one]);
        let size = ["--set", "display.matrix.pixels=[90,60]"];
        let all: Vec<&str> = [file.to_str().unwrap()].into_iter().chain(size).chain(sets).collect();
        json(&scenario("six-ink"), &all)["coverage"].clone()
    };
    let plain = "image.halftone=\"error-diffusion\"";
    let kernel = "image.kernel=\"jarvis\"";
    assert_eq!(coverage(&[kernel]), coverage(&[plain, kernel]));
    assert_eq!(coverage(&["image.scan=\"raster\""]), coverage(&[plain, "image.scan=\"raster\""]));
    let refined = "image.halftone=\"refined-error-diffusion\"";
    assert_eq!(coverage(&[]), coverage(&[refined]));
    assert_ne!(coverage(&[refined, kernel]), coverage(&[kernel]));
}

/// Text is black on white, half of the area of stripes is black, and a page has a photograph besides; all on
/// the pixels of the panel.
#[test]
fn texts_and_patterns_are_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let photograph = picture(folder.path(), &[[110, 115, 105]]);
    let photograph = photograph.to_str().unwrap();
    let panel = ["display.glass.thickness_mm=0.5", "display.matrix.ppi=300", "display.matrix.pixels=[96,64]"];
    let run = |picture: &[&str], sets: &[&str]| {
        let sets: Vec<&str> = sets.iter().flat_map(|one| ["--set", one]).collect();
        image(&scenario("epaper"), &[picture, &sets, &["--json"]].concat())
    };
    let of = |picture: &[&str], sets: &[&str]| -> Value {
        let output = run(picture, &[&panel, sets].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let black = |found: &Value| found["coverage"]["black"].as_f64().unwrap();
    let words = ["image.text=\"it is\"", "image.text_size_pt=3"];
    let text = of(&[], &words);
    assert_eq!(text["size"], serde_json::json!([96, 64]));
    assert!((0.003..0.05).contains(&black(&text)), "{text}");
    // The photograph covers 42 x 28 of the 96 x 64 pixels, and has 0.17 of the light of white; black has 0.135.
    let page = of(&[photograph], &words);
    let more = black(&page) - black(&text);
    assert!((more - 0.83 / 0.865 * 1176.0 / 6144.0).abs() < 0.02, "{more}: {page}");
    let stripes = of(&[], &["image.pattern=\"stripes\"", "image.halftone=\"ordered\""]);
    assert_eq!(black(&stripes), 0.5);
    let period = ["image.pattern=\"slanted-edge\"", "image.period_mm=1"];
    for (picture, sets, part) in [
        (vec![], &words[..], "display.matrix.pixels"),
        (vec![], &["image.pattern=\"checker\""], "display.matrix.pixels"),
        (
            vec![photograph],
            &[panel[1], panel[2], "image.pattern=\"checker\""],
            "a test pattern and a picture",
        ),
        (vec![], &[panel[1], panel[2], period[0], period[1]], "a slanted edge has no period"),
        (
            vec![],
            &[panel[1], panel[2], "image.text=\"\u{4e00} a \u{4e01}\""],
            "no glyphs for `\u{4e00}`, `\u{4e01}`",
        ),
        (vec![photograph], &["pattern.text=\"\u{4e00}\""], "no glyphs for `\u{4e00}`"),
        (vec![photograph], &["image.halftone=\"direct-binary-search\""], "add [display.matrix]"),
    ] {
        let output = run(&picture, sets);
        assert_eq!(output.status.code(), Some(2), "{sets:?}");
        assert!(stderr(&output).contains(part), "{sets:?}: {}", stderr(&output));
    }
    let long = format!("image.text=\"{}\"", "word ".repeat(200));
    let cut = run(&[], &[&panel[..], &[&long]].concat());
    assert!(stderr(&cut).contains("are left out"), "{}", stderr(&cut));
    let empty = run(&[], &[&panel[..], &["image.text=\" \"", "pattern.text=\"\""]].concat());
    for part in ["image.text has no letters", "pattern.text has no letters"] {
        assert!(stderr(&empty).contains(part), "{}", stderr(&empty));
    }
}

/// What the panel cannot show of a pattern, here 96 x 64 pixels: a period below two pixels, and half of one that is wider than the panel.
#[test]
fn patterns_that_are_not_seen_are_warned_of() {
    let panel = [
        "display.glass.thickness_mm=0.5",
        "display.matrix.pitch_um=100",
        "display.matrix.pixels=[96,64]",
        "image.halftone=nearest",
    ];
    for (pattern, period_mm, part) in [
        ("stripes", 0.19, Some("is below two pixels (0.2 mm)")),
        ("stripes", 0.2, None),
        ("checker", 0.19, Some("is below two pixels")),
        ("siemens", 0.19, Some("of the star at its rim")),
        ("stripes", 19.1, None),
        ("stripes", 19.3, Some("wider than the panel (9.6 mm): all of it is black")),
        ("checker", 19.3, Some("all of it is black")),
        ("siemens", 19.3, None),
    ] {
        let sets = [format!("image.pattern={pattern}"), format!("image.period_mm={period_mm}")];
        let sets = panel.into_iter().chain(sets.iter().map(String::as_str));
        let sets: Vec<&str> = sets.flat_map(|one| ["--set", one]).chain(["--json"]).collect();
        let output = image(&scenario("epaper"), &sets);
        let said = stderr(&output);
        assert!(output.status.success(), "{said}");
        assert_eq!(said.contains("image.period_mm ="), part.is_some(), "{pattern} {period_mm}: {said}");
        assert!(said.contains(part.unwrap_or_default()), "{pattern} {period_mm}: {said}");
    }
}

/// Below glass, pixels light each other: a uniform picture keeps its colour, the mean of white and black
/// pixels is darker than that of pages.
#[test]
fn neighbours_light_each_other_below_glass() {
    let folder = tempfile::tempdir().unwrap();
    let sets = |more: &'static str| {
        ["--set", "display.glass.thickness_mm=0.5", "--set", "display.matrix.ppi=300", "--set", more]
    };
    let found = |colour: u8, more: &'static str| {
        let file = picture(folder.path(), &[[colour; 3]]);
        json(&scenario("epaper"), &[&[file.to_str().unwrap()][..], &sets(more)].concat())
    };
    let big = "display.matrix.pixels=[128,128]";
    let [white, black, grey] = [255, 0, 188].map(|colour| found(colour, big));
    assert_eq!(white["neighbours_light"], true);
    let y = |one: &Value| one["mean_XYZ"][1].as_f64().unwrap();
    let share = grey["coverage"]["white"].as_f64().unwrap();
    let pages = share * y(&white) + (1.0 - share) * y(&black);
    assert!(y(&grey) < 0.97 * pages, "{} {pages}", y(&grey));
    let missing = image(
        &scenario("epaper"),
        &[picture(folder.path(), &[[9; 3]]).to_str().unwrap(), "--set", "display.matrix.ppi=300"],
    );
    assert!(stderr(&missing).contains("thickness_mm"), "{}", stderr(&missing));
}

/// States may have the codes by which tools of panels recognise inks.
#[test]
fn states_have_device_colours() {
    let folder = tempfile::tempdir().unwrap();
    let good = picture(folder.path(), &[[90; 3]]);
    let out = folder.path().join("out");
    let palette = |more: &[&str]| {
        let arguments = [&[good.to_str().unwrap(), "--out", out.to_str().unwrap()], more].concat();
        let output = image(&scenario("six-ink"), &arguments);
        assert!(output.status.success(), "{}", stderr(&output));
        let bytes = fs::read(out.join("states.png")).unwrap();
        let at = bytes.windows(4).position(|part| part == b"PLTE").unwrap() + 4;
        bytes[at..at + 18].to_vec()
    };
    let codes = [0, 0, 0, 255, 255, 255, 255, 255, 0, 255, 0, 0, 0, 0, 255, 0, 255, 0];
    assert_eq!(palette(&["--device-colours"]), codes);
    let seen = palette(&[]);
    assert!(seen.iter().all(|value| *value < 200) && seen[0] > 20, "{seen:?}");
}

#[test]
fn wrong_input_is_answered() {
    let folder = tempfile::tempdir().unwrap();
    let good = picture(folder.path(), &[[90; 3]]);
    let good = good.to_str().unwrap();
    let text = folder.path().join("text.png");
    fs::write(&text, "not a picture").unwrap();
    for (arguments, part) in [
        (vec![text.to_str().unwrap()], "text.png"),
        (vec!["nowhere.png"], "nowhere.png"),
        (vec![good, "--set", "image.states=[\"white\",\"blak\"]"], "there is no state `blak`"),
        (vec![good, "--set", "image.states=[\"red\",\"red\"]"], "the state `red` is listed twice"),
        (vec![good, "--set", "image.kernel=\"floyd\""], "floyd-steinberg"),
        (vec![good, "--set", "viewer.theta_deg=[0,10]"], "computed for one view"),
        (vec![good, "--set", "image.states=[\"white\"]"], "the state `white` alone"),
        (
            vec![good, "--set", "image.intent=\"relative\"", "--set", "image.contrast=1.2"],
            "contrast is a factor on natural and vivid pictures",
        ),
        (vec![good, "--set", "image.exposure=\"more\""], "a number from -10 to 10 (stops), or \"auto\""),
        (vec![good, "--set", "image.white_balance=100"], "1700"),
        (vec![good, "--set", "image.intent=\"perceptual\""], "natural"),
    ] {
        let output = image(&scenario("six-ink"), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(part), "{arguments:?}: {}", stderr(&output));
        // The user wrote an argument, not the `--set` that it becomes.
        let names_set = arguments[0] != good && stderr(&output).contains("--set");
        assert!(!names_set, "{}", stderr(&output));
    }
    let samples = image(&scenario("printed-filter"), &[good, "--set", "image.samples_per_pixel=3"]);
    assert!(stderr(&samples).contains("remove `samples_per_pixel`"), "{}", stderr(&samples));
    let none = image(&scenario("epaper"), &[]);
    assert!(stderr(&none).contains("papilio image SCENARIO PICTURE"), "{}", stderr(&none));
}

/// The panel holds its states: in other rooms they are the same, and each room has a picture of its own.
/// States that are decided for another light are those of a display in that light.
#[test]
fn states_are_held_while_the_light_changes() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 250, 240]]);
    let file = file.to_str().unwrap();
    let run = |name: &str, more: &[&str]| {
        let out = folder.path().join(name);
        let output = image(&scenario("six-ink"), &[&[file, "--out", out.to_str().unwrap()], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let read = |name: &str| fs::read(out.join(name)).unwrap();
        let numbers: Value = serde_json::from_slice(&read("image.json")).unwrap();
        (numbers, read("states.png"), names(&out))
    };
    let (here, states, files) = run("here", &["--rooms", "D65,office"]);
    let expected =
        ["image.json", "rooms.png", "seen-D65.png", "seen-office.png", "seen.exr", "seen.png", "states.png"];
    assert_eq!(files, expected);
    let there = &here["rooms"];
    assert_eq!((there[0]["room"].as_str(), &there[0]["coverage"]), (Some("D65"), &here["coverage"]));
    assert_ne!(there[0]["mean_XYZ"], here["mean_XYZ"]);
    // In daylight, with states for the lamp: what the room says. With states for daylight: as if decided
    // there.
    let (held, of_lamp, _) =
        run("held", &["--set", "lighting.spectrum=D65", "--set", "image.prepared_for=LED-B1"]);
    assert_eq!(held["mean_XYZ"], there[0]["mean_XYZ"]);
    let (own, _, _) = run("own", &["--set", "lighting.spectrum=D65"]);
    assert_ne!(own["coverage"], held["coverage"]);
    let (fits, wrong) = (&own["against_mapped"], &held["against_mapped"]);
    let mean = |one: &Value| one["scielab_mean"].as_f64().unwrap();
    assert!(mean(fits) < mean(wrong), "{fits} {wrong}");
    // The same indices; the colours of the palette in the file are those of the light.
    let indices = |file: &[u8]| file[file.windows(4).position(|name| name == b"IDAT").unwrap()..].to_vec();
    assert_eq!(indices(&states), indices(&of_lamp));
    let output = image(&scenario("six-ink"), &[file, "--set", "image.prepared_for=moonlight"]);
    let answer = stderr(&output);
    assert!(answer.contains("no preset and no illuminant named `moonlight`"), "{answer}");
}

/// A point of a sweep has the numbers of `papilio image` there; without a picture there is an answer.
#[test]
fn sweeps_have_metrics_of_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let file = picture(folder.path(), &[[200, 150, 125], [20, 60, 200], [255, 0, 0]]);
    let metrics = "sweep.metrics=[\"delta_e_2000_mean\", \"flip_mean\", \"out_of_gamut_fraction\"]";
    let sweep = |picture: &str, out: &str| {
        let out = folder.path().join(out);
        let text = fs::read_to_string(scenario("six-ink")).unwrap();
        let text = text.split("[image]").next().unwrap().replace("data/", "");
        let inks = scenario("six-ink").parent().unwrap().join("data/synthetic-inks-6.csv");
        fs::copy(inks, folder.path().join("synthetic-inks-6.csv")).unwrap();
        let axes = "[sweep]\n[[sweep.axes]]\nimage.kernel = [\"floyd-steinberg\", \"jarvis\"]\n";
        let path = folder.path().join("sweep.toml");
        fs::write(&path, format!("{text}\n{picture}\n[viewer]\ndistance_mm = 500\n{axes}")).unwrap();
        papilio().arg("sweep").arg(path).args(["--set", metrics, "--out"]).arg(&out).output().unwrap()
    };
    let output = sweep("[image]\nfile = \"picture.png\"", "with");
    assert!(output.status.success(), "{}", stderr(&output));
    let csv = fs::read_to_string(folder.path().join("with/sweep.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|one| *one == name).unwrap();
    let alone = ["--set", "image.kernel=jarvis", file.to_str().unwrap()];
    let found = json(&folder.path().join("sweep.toml"), &alone);
    for (name, expected) in [
        ("delta_e_2000_mean", &found["against_source"]["delta_e_2000_mean"]),
        ("flip_mean", &found["against_source"]["flip_mean"]),
        ("out_of_gamut_fraction", &found["out_of_gamut_fraction"]),
    ] {
        let values = [1, 2].map(|row| rows[row][column(name)].parse::<f64>().unwrap());
        assert!((values[1] - expected.as_f64().unwrap()).abs() < 1e-6, "{name}: {values:?} {expected}");
    }
    let error = stderr(&sweep("", "without"));
    assert!(error.contains("the key `file` is missing"), "{error}");
}

/// White, black and every neutral between them are in the gamut of a display that has them, with or without
/// coloured inks. Against the photograph, white is right and black is wrong by the display's black: CIEDE2000
/// of two neutrals has a closed form.
#[test]
fn neutrals_are_in_the_gamut_and_the_photograph_is_the_first_reference() {
    let folder = tempfile::tempdir().unwrap();
    let neutrals: Vec<[u8; 3]> = (0..=255).map(|value| [value; 3]).collect();
    let [neutrals, white, black] =
        [("neutrals", &neutrals[..]), ("white", &[[255; 3]]), ("black", &[[0; 3]])].map(|(name, pixels)| {
            let place = folder.path().join(name);
            fs::create_dir_all(&place).unwrap();
            picture(&place, pixels)
        });
    let display = |name: &str, states: &str| {
        fs::write(folder.path().join(format!("{name}.csv")), format!("state,L,a,b\n{states}")).unwrap();
        let path = folder.path().join(format!("{name}.toml"));
        let text = format!(
            "[display.pixel]\nmodel = \"palette\"\nfile = \"{name}.csv\"\n[display.matrix]\nppi = 127\n\
             [lighting]\nilluminance_lx = 150\nspectrum = \"D50\"\n[viewer]\ntheta_deg = 0\ndistance_mm = 500\n"
        );
        fs::write(&path, text).unwrap();
        path
    };
    let greys = "black,15,0,0\nwhite,75,0,0\n";
    let grey = display("greys", greys);
    let inks =
        display("inks", &format!("{greys}red,30,40,25\nyellow,65,-5,55\nblue,25,10,-30\ngreen,35,-25,5\n"));
    for file in [&grey, &inks] {
        for shown in [&neutrals, &white, &black] {
            let found = json(file, &[shown.to_str().unwrap()]);
            assert_eq!(found["out_of_gamut_fraction"], 0.0, "{file:?} {shown:?}");
        }
    }
    let of = |shown: &std::path::Path| {
        json(&grey, &[shown.to_str().unwrap()])["against_photograph"]["delta_e_2000_mean"].as_f64().unwrap()
    };
    let luminance = |lightness: f64| ((lightness + 16.0) / 116.0).powi(3);
    let lightness = 116.0 * (luminance(15.0) / luminance(75.0)).cbrt() - 16.0;
    let from_50 = (lightness / 2.0 - 50.0).powi(2);
    let expected = lightness / (1.0 + 0.015 * from_50 / (20.0 + from_50).sqrt());
    // States of a palette file are spectra made from four digits, and the white of pictures is D65 of four
    // digits.
    assert!(of(&white) < 0.1, "{}", of(&white));
    assert!((of(&black) - expected).abs() < 0.1, "{} instead of {expected}", of(&black));
}

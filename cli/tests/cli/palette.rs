//! `papilio palette`: colours, files, rooms, measured palettes, and answers to wrong input.

use std::fs;
use std::path::Path;
use std::process::Output;

use papilio_colour::Xyz;
use papilio_formats::{DataFile, RgbSpace, read_picture, write_rgb_png};
use serde_json::Value;

use crate::common::{names, papilio_command as papilio, scenario, stderr};

fn palette(file: &Path, more: &[&str]) -> Output {
    papilio().arg("palette").arg(file).args(more).output().unwrap()
}

fn json(file: &Path, more: &[&str]) -> Value {
    let output = palette(file, &[more, &["--json"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Writes a scenario with a palette of a file, in diffuse light.
fn measured(folder: &Path, csv: &str, more: &str) -> std::path::PathBuf {
    fs::write(folder.join("inks.csv"), csv).unwrap();
    let file = folder.join("inks.toml");
    let pixel = format!("[display.pixel]\nmodel = \"palette\"\nfile = \"inks.csv\"\n{more}");
    fs::write(&file, format!("{pixel}[lighting]\nspectrum = \"D50\"\n")).unwrap();
    file
}

#[test]
fn files_are_written_and_white_is_white() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let output =
        palette(&scenario("six-ink"), &["--relative-to", "display", "--rooms", "office", "--out", out]);
    assert!(output.status.success(), "{}", stderr(&output));
    let expected = [
        "palette-epdoptimize.json",
        "palette.act",
        "palette.ase",
        "palette.css",
        "palette.gpl",
        "palette.json",
        "palette.py",
        "palette.svg",
    ];
    assert_eq!(names(folder.path()), expected);
    let css = fs::read_to_string(folder.path().join("palette.css")).unwrap();
    assert!(css.contains("--state-white: #ffffff;"), "{css}");
    let table = String::from_utf8(output.stdout).unwrap();
    assert!(table.contains("in other rooms") && table.contains("office"), "{table}");
}

/// A colour is the same in palette.json, palette.gpl and seen.png, also one that is too bright for the screen or out of its gamut.
#[test]
fn colours_are_those_of_the_seen_picture() {
    let folder = tempfile::tempdir().unwrap();
    let edge = |(state, [low, high]): (&str, [f64; 2])| {
        let row = |(nm, value): (u32, f64)| format!("{state},{nm},{value}\n");
        [(380, low), (560, low), (565, high), (780, high)].map(row).concat()
    };
    let states = [("white", [0.95; 2]), ("black", [0.02; 2]), ("red", [0.0, 0.98]), ("cyan", [0.98, 0.0])];
    let csv = format!("state,wavelength_nm,reflectance_factor\n{}", states.map(edge).concat());
    let file = measured(folder.path(), &csv, "");
    let usual = [[255; 3], [0; 3], [255, 0, 0], [0, 190, 220]];
    let page = folder.path().join("page.png");
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, 4, &usual, false).unwrap();
    fs::write(&page, bytes).unwrap();
    for (white, key) in [("white", "srgb"), ("display", "srgb_relative")] {
        let out = folder.path().join(key);
        let more = ["--relative-to", white, "--out", out.to_str().unwrap()];
        let written = palette(&file, &more);
        assert!(written.status.success(), "{}", stderr(&written));
        let gpl = fs::read_to_string(out.join("palette.gpl")).unwrap();
        assert!(gpl.contains("\nName: inks.toml, seen from 0 deg"), "{gpl}");
        let all: Value = serde_json::from_slice(&fs::read(out.join("palette.json")).unwrap()).unwrap();
        let set = ["--set", "image.halftone=\"nearest\"", "--set", "image.intent=\"relative\""];
        let shown = papilio().arg("image").arg(&file).arg(&page).args(more).args(set).output().unwrap();
        assert!(shown.status.success(), "{}", stderr(&shown));
        let numbers: Value = serde_json::from_slice(&fs::read(out.join("image.json")).unwrap()).unwrap();
        let seen = DataFile::open(&out.join("seen.png"), "seen.png").unwrap();
        let row = read_picture(&seen, &RgbSpace::srgb()).unwrap().value.row(0);
        for (at, (state, _)) in states.iter().enumerate() {
            assert_eq!(numbers["coverage"][state], 0.25, "{}", numbers["coverage"]);
            let [x, y, z] = row[at].map(f64::from);
            let seen = Xyz { x, y, z }.srgb_clipped();
            let of = |value: &Value| (255.0 * value.as_f64().unwrap()).round() as u8;
            let colour: Vec<u8> = all["colours"][at][key].as_array().unwrap().iter().map(of).collect();
            assert_eq!(seen, colour[..], "{state} {key}");
            let [r, g, b] = seen;
            assert!(gpl.contains(&format!("{r:3} {g:3} {b:3}\t{state}\n")), "{gpl}");
        }
    }
}

/// `papilio image` reads the picture of the scenario and `papilio palette` does not: the folder is the same, in either order. Another
/// picture has a folder of its own.
#[test]
fn palette_and_picture_of_a_scenario_are_in_one_folder() {
    let set = ["--set", "display.matrix.pixels=[24,16]"];
    for commands in [["palette", "image"], ["image", "palette"]] {
        let folder = tempfile::tempdir().unwrap();
        let at = |command: &str, more: &[&str]| {
            let file = scenario("six-ink").canonicalize().unwrap();
            let output =
                papilio().current_dir(folder.path()).arg(command).arg(file).args(set).args(more).output();
            let output = output.unwrap();
            assert!(output.status.success(), "{}", stderr(&output));
            stderr(&output)
        };
        for command in commands {
            let said = at(command, &[]);
            assert!(!said.contains("note: out"), "{command}: {said}");
        }
        assert_eq!(names(&folder.path().join("out")), ["six-ink"]);
        let page = scenario("data/page").with_extension("png").canonicalize().unwrap();
        let said = at("image", &[page.to_str().unwrap()]);
        assert!(said.contains("note: out/six-ink contains the result of another scenario"), "{said}");
    }
}

/// The colours are those of `papilio run`; another light changes them, the same light does not.
#[test]
fn colours_are_those_of_a_run() {
    let all = json(&scenario("six-ink"), &["--rooms", "LED-B1,FL11"]);
    let run = papilio().arg("run").arg(scenario("six-ink")).arg("--json").output().unwrap();
    let run: Value = serde_json::from_slice(&run.stdout).unwrap();
    for colour in all["colours"].as_array().unwrap() {
        let name = colour["state"].as_str().unwrap();
        let state = &run["views"][0]["states"][name];
        assert!(
            ["X", "Y", "Z", "L_star", "a_star", "b_star"].iter().all(|key| colour[key] == state[key]),
            "{name}"
        );
        assert_eq!(all["rooms"]["LED-B1"][name]["delta_e_2000"], 0.0, "{name}");
    }
    assert!(all["rooms"]["FL11"]["red"]["delta_e_2000"].as_f64().unwrap() > 2.0);
    // The lights of the rooms: the scenario's own, and FL11, whose x and y are 0.3805 and 0.3769 (CIE 15).
    let lights = &all["room_lights"];
    assert_eq!(
        (&lights["LED-B1"]["light"], &lights["LED-B1"]["white_XYZ"]),
        (&all["light"], &all["white_XYZ"])
    );
    assert_eq!(lights["FL11"]["light"]["illuminance_lx"], all["light"]["illuminance_lx"]);
    for (key, known) in [("x", 0.3805), ("y", 0.3769)] {
        let value = lights["FL11"]["light"][key].as_f64().unwrap();
        assert!((value - known).abs() < 5e-4, "{key} {value}");
    }
    let white = lights["FL11"]["white_XYZ"][0].as_f64().unwrap();
    assert!((white - 0.3805 / 0.3769).abs() < 2e-3, "{white}");
    assert_eq!(all["white_XYZ"][1], 1.0);
}

/// L*, a*, b* that were entered are those that are computed in the same light.
#[test]
fn measured_lab_is_the_colour_in_its_light() {
    let folder = tempfile::tempdir().unwrap();
    let file = measured(folder.path(), "# my panel\nstate;L;a;b\nwhite;66.5;-4;-2\nred;28;38;22\n", "");
    let all = json(&file, &[]);
    for (colour, lab) in
        all["colours"].as_array().unwrap().iter().zip([[66.5, -4.0, -2.0], [28.0, 38.0, 22.0]])
    {
        for (key, value) in ["L_star", "a_star", "b_star"].iter().zip(lab) {
            assert!((colour[key].as_f64().unwrap() - value).abs() < 1e-3, "{colour}");
        }
    }
    // The white of D65 and the matrix of sRGB are rounded to five digits.
    let white = all["colours"][0]["srgb_relative"].as_array().unwrap();
    assert!(white.iter().all(|value| value.as_f64().unwrap() > 0.9999), "{white:?}");
    let warned = stderr(&palette(&file, &["--json"]));
    assert!(warned.contains("smoothest spectra"), "{warned}");
    let glass = stderr(&palette(&file, &["--json", "--set", "display.glass.index=1.5"]));
    assert!(glass.contains("measured through the panel's own surface"), "{glass}");
}

#[test]
fn wrong_input_is_answered_with_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let answer = |csv: &str, more: &[&str]| {
        let output = palette(&measured(folder.path(), csv, ""), more);
        assert_eq!(output.status.code(), Some(2));
        stderr(&output)
    };
    let good = "state,L,a,b\nwhite,60,0,0\n";
    for (csv, part) in [
        ("state,wavelength_nm\nwhite,400\n", "`wavelength_nm`, `reflectance_factor` or `L`, `a`, `b`"),
        ("state,R,G,B\nwhite,1,2,3\n", "the column `G` is not understood"),
        ("state,L,a,b\n", "there are no rows of data"),
        ("state,L,a,b\nwhite,160,0,0\n", "inks.csv:2:7"),
        ("state,L,a,b\nwhite,60,0,0\nwhite,61,0,0\n", "`white` has two values"),
        ("state,L,a,b\nred,95,90,90\n", "no surface has the colour of state `red`"),
        ("state,wavelength_nm,reflectance_factor\nwhite,0.4,0.1\nwhite,0.7,0.2\n", "micrometres"),
        (
            "state,wavelength_nm,reflectance_factor\nwhite,400,0.1\nwhite,400,0.2\n",
            "`white` at 400 nm has two values",
        ),
        ("state,wavelength_nm,reflectance_factor\nwhite,400,0.1\nwhite,700,0.2\n", "400"),
    ] {
        let text = answer(csv, &[]);
        assert!(text.contains(part), "{csv}: {text}");
    }
    assert!(answer(good, &["--rooms", "offce"]).contains("no preset and no illuminant named `offce`"));
    assert!(
        answer(good, &["--set", "viewer.theta_deg=[0,10]"])
            .contains("computed for one view, and these are 2")
    );
    // Spectra do not need the illuminant, but a wrong name is a mistake.
    let spectra = "state,wavelength_nm,reflectance_factor\nwhite,380,0.5\nwhite,780,0.5\nblack,380,0.1\nblack,780,0.1\n";
    for csv in [good, spectra] {
        let text = answer(csv, &["--set", "display.pixel.illuminant=\"D5O\""]);
        assert!(text.contains("there is no light named `D5O`"), "{text}");
    }
}

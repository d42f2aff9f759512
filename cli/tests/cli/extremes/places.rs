//! Lengths, resolutions and indices of commands with places.

use std::fs;
use std::path::Path;

use papilio_testing::sized;

use super::watch::{End, watch};

/// Displays of Lambertian pixels below a face, and of mirrors below a diffuser.
const PAPER: &str = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\nthickness_mm = 0.5\n[display.pixel]\nmodel = \"uniform\"\n\
    kind = \"lambertian\"\nreflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\nppi = 300\n";
const MIRRORS: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.01\ntotal_transmittance = 0.9\n[display.glass]\nindex = 1.5\n\
    thickness_mm = 1\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\n\
    ppi = 300\n";

/// Lambertian pixels below a lobe and a front that returns light through it.
const FRONT: &str = "[[display.front]]\nreflectance = 0.05\ngap_mm = 0.2\n[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.06\n\
    total_transmittance = 0.9\n[display.glass]\nindex = 1.5\nthickness_mm = 0.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
    reflectance = { white = 0.6, black = 0.03 }\n[display.matrix]\nppi = 300\n";

/// A picture of 160 x 120 pixels, its path.
pub(crate) fn picture_in(folder: &Path) -> String {
    let pixels: Vec<[u8; 3]> = (0..160 * 120).map(|at| [(at * 7 % 256) as u8; 3]).collect();
    let mut picture = Vec::new();
    papilio_formats::write_rgb_png(&mut picture, 160, &pixels, false).unwrap();
    let path = folder.join("picture.png");
    fs::write(&path, picture).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Ordinary values: air in the place of the glass, and nearly. Every command answers.
#[test]
fn places_above_air_are_computed() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture_in(folder.path());
    let mut wrong = Vec::new();
    let all = [("front", FRONT), ("paper", PAPER), ("mirrors", MIRRORS)];
    let everyday = [("front", "1.00001", "image"), ("paper", "1", "mtf")];
    for (name, text) in all {
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        for index in ["1", "1.00001", "1.0006"] {
            for command in ["mtf", "crosstalk", "image"] {
                if sized(!everyday.contains(&(name, index, command)), false) {
                    continue;
                }
                let set = format!("display.glass.index={index}");
                let mut arguments = vec![command, file.to_str().unwrap()];
                if command == "image" {
                    arguments.push(&picture);
                }
                arguments.extend(["--set", &set]);
                let results = tempfile::tempdir().unwrap();
                match watch(&arguments, results.path(), true) {
                    End::Ended(0) => {}
                    other => wrong.push(format!("{name} {arguments:?}: {other:?}")),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The narrowest lobe above the thinnest glass.
#[test]
fn narrow_lobes_above_thin_glass_survive() {
    let folder = tempfile::tempdir().unwrap();
    let picture = picture_in(folder.path());
    let mut wrong = Vec::new();
    for (name, text) in [("front", FRONT), ("mirrors", MIRRORS)] {
        let file = folder.path().join(format!("{name}.toml"));
        fs::write(&file, text).unwrap();
        for command in ["mtf", "image", "crosstalk"] {
            if sized(name != "front" || command == "image", false) {
                continue;
            }
            let mut arguments = vec![command, file.to_str().unwrap()];
            if command == "image" {
                arguments.push(&picture);
            }
            // Half a minute for a narrower lobe.
            let width = sized("display.diffuser.width=1e-3", "display.diffuser.width=1e-6");
            for set in [width, "display.glass.thickness_mm=1e-6"] {
                arguments.extend(["--set", set]);
            }
            let results = tempfile::tempdir().unwrap();
            if let End::Wrong(what) = watch(&arguments, results.path(), true) {
                wrong.push(format!("{name} {arguments:?}: {what}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Lengths and resolutions of commands with places: a few each day, all of them in full.
#[test]
fn places_survive_every_length() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str, bytes: &[u8]| -> String {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let files = [
        place("paper.toml", PAPER.as_bytes()),
        place("mirrors.toml", MIRRORS.as_bytes()),
        place("front.toml", FRONT.as_bytes()),
    ];
    let picture = picture_in(folder.path());
    let thickness =
        ["0.0", "1e-300", "1e-12", "1e-9", "1e-3", "0.005", "0.02", "0.1", "10", "100", "1e3", "1e300"]
            .map(|mm| format!("display.glass.thickness_mm={mm}"));
    let others = [
        "display.matrix.ppi=0.1",
        "display.matrix.ppi=1e5",
        "viewer.text_height_mm=100",
        "viewer.text_height_mm=1e-3",
    ]
    .map(str::to_owned);
    let everyday = ["thickness_mm=1e-300", "thickness_mm=1e3"];
    let mut wrong = Vec::new();
    for set in thickness.iter().chain(&others) {
        for (number, file) in files.iter().enumerate() {
            for command in ["mtf", "crosstalk", "image", "mtf --solver monte-carlo"] {
                let is_everyday = number == 0 && command != "mtf --solver monte-carlo";
                if sized(!(is_everyday && everyday.iter().any(|end| set.ends_with(end))), false) {
                    continue;
                }
                let results = tempfile::tempdir().unwrap();
                let mut arguments: Vec<&str> = command.split(' ').collect();
                arguments.insert(1, file);
                if command == "image" {
                    arguments.insert(2, &picture);
                }
                arguments.extend(["--set", set]);
                if let End::Wrong(what) = watch(&arguments, results.path(), true) {
                    wrong.push(format!("{arguments:?}: {what}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

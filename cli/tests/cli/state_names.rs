//! Names of states that cannot be names of files: every command writes a whole file for each state.

use std::fs;
use std::path::Path;

use papilio_figures::HAS_PNG;
use papilio_formats::write_rgb_png;

use crate::common::{COARSE, names, papilio, place, scenario, stderr, stdout};

/// The names of two states differ in a character that the name of a file cannot have.
const SCENARIO: &str = r#"
title = "Names"
[display.pixel]
model = "palette"
file = "states.csv"
[display.glass]
thickness_mm = 0.5
[display.matrix]
ppi = 127
[display.diffuser]
model = "k-correlation"
haze = 0.25
transmittance = 0.9
[lighting]
illuminance_lx = 150
spectrum = "D50"
[viewer]
theta_deg = 0
distance_mm = 500
[solver]
relative_error = 0.05
[sweep]
figures = ["a/b.Y", "a-b.Y"]
[[sweep.axes]]
"display.diffuser.haze" = [0.2, 0.25]
[tolerance]
samples = 64
sensitivity_samples = 16
[[tolerance.keys]]
key = "display.diffuser.haze"
normal = { sigma = 0.02 }
[[tolerance.limits]]
metric = "a/b.Y"
at_least = 0.01
[[tolerance.limits]]
metric = "a-b.Y"
at_least = 0.01
"#;

/// Runs a command that writes its results to `out`, and returns the names of the files.
fn written(out: &str, arguments: &[&str]) -> Vec<String> {
    let output = papilio(&[arguments, &["--out", out]].concat());
    assert!(output.status.success(), "{arguments:?}: {}{}", stdout(&output), stderr(&output));
    let said = stderr(&output);
    assert!(said.contains("wrote "), "{arguments:?}: {said}");
    names(Path::new(out))
}

/// A figure is whole, and has the name of its state.
fn shows(out: &str, file: &str, state: &str) {
    let text = fs::read_to_string(Path::new(out).join(file)).unwrap();
    assert!(text.trim_end().ends_with("</svg>"), "{file} is not whole");
    assert!(text.contains(state), "{file} does not show {state}");
}

#[test]
fn states_with_characters_of_paths_have_a_file_each() {
    let (folder, file, out) = place(SCENARIO);
    let states = "state,L,a,b\nblack,15,0,0\nwhite,75,0,0\na/b,30,40,25\na-b,65,-5,55\n";
    fs::write(folder.path().join("states.csv"), states).unwrap();
    let out = |command: &str| format!("{out}-{command}");
    let has = |found: &[String], wanted: &[&str]| {
        wanted.iter().for_each(|name| assert!(found.iter().any(|one| one == name), "no {name} in {found:?}"));
    };

    let found = written(&out("mtf"), &["mtf", &file]);
    has(&found, &["kernel-a-b.npy", "kernel-a-b-2.npy", "kernel-a-b.svg", "kernel-a-b-2.svg"]);
    shows(&out("mtf"), "kernel-a-b.svg", "a/b");
    shows(&out("mtf"), "kernel-a-b-2.svg", "a-b");
    let numbers = |name: &str| fs::read(Path::new(&out("mtf")).join(name)).unwrap();
    for name in ["kernel-a-b.npy", "kernel-a-b-2.npy"] {
        assert!(numbers(name).starts_with(b"\x93NUMPY"));
        assert_eq!(numbers(name).len(), numbers("kernel-white.npy").len());
    }

    let found = written(&out("sweep"), &["sweep", &file]);
    has(&found, &["sweep.csv", "sweep_a-b.Y.svg", "sweep_a-b.Y-2.svg"]);
    shows(&out("sweep"), "sweep_a-b.Y.svg", "a/b");
    shows(&out("sweep"), "sweep_a-b.Y-2.svg", "a-b");

    let found = written(&out("tolerance"), &["tolerance", &file]);
    has(&found, &["tolerance.csv", "tolerance_a-b.Y.svg", "tolerance_a-b.Y-2.svg"]);
    let of_states = |name: &String| name.starts_with("tolerance_a-b");
    assert_eq!(found.iter().filter(|name| of_states(name)).count(), 2);

    let found = written(&out("brdf"), &["brdf", &file, "--format", "csv", "--step", "30"]);
    has(&found, &["display-a-b.csv", "display-a-b-2.csv"]);

    let picture = folder.path().join("picture.png");
    let colours = [[200, 40, 30], [230, 220, 20], [255; 3], [0; 3]];
    let pixels: Vec<[u8; 3]> = (0..24 * 16).map(|at| colours[at % colours.len()]).collect();
    let mut bytes = Vec::new();
    write_rgb_png(&mut bytes, 24, &pixels, false).unwrap();
    fs::write(&picture, bytes).unwrap();
    let found = written(&out("image"), &["image", &file, picture.to_str().unwrap(), "--rooms", "D65"]);
    has(&found, &["image.json", "rooms.png", "seen-D65.png", "seen.png", "states.png"]);
}

/// Letters that the font of PNG figures lacks: all files without them are named in one warning, and SVG figures have them.
#[test]
fn letters_that_the_font_lacks_are_named_once() {
    let text = fs::read_to_string(scenario("indoor")).unwrap();
    let state = "[display.pixel.states]\n\"\u{767d}\" = { red = 1.0 }\n[lighting]";
    let (_folder, file, out) = place(&text.replacen("[lighting]", state, 1));
    let png: &[&str] = if HAS_PNG { &["--png"] } else { &[] };
    let output = papilio(&[&["run", &file, "--out", &out], &COARSE[..], png].concat());
    let said = stderr(&output);
    assert!(output.status.success(), "{said}");
    assert!(fs::read_to_string(Path::new(&out).join("patches.svg")).unwrap().contains('\u{767d}'));
    let warnings: Vec<&str> = said.lines().filter(|line| line.contains("Roboto")).collect();
    assert_eq!(warnings.len(), usize::from(HAS_PNG), "{said}");
    for warning in warnings {
        assert!(warning.starts_with("warning: ") && warning.contains(": \u{767d};"), "{warning}");
        assert!(["patches.png", "spectra.png"].iter().all(|name| warning.contains(name)), "{warning}");
    }
}

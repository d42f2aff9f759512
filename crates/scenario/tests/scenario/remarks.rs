//! What is no error, and still should be said.

use std::fs;
use std::path::Path;

use crate::common::{GOOD, changed, resolve};
use papilio_spectra::illuminant_names;

/// Warnings of `GOOD` with these keys set, on the default range.
fn warnings(folder: &Path, sets: &[&str]) -> Vec<String> {
    let all = [&["spectrum.range_nm=[380, 780]", "spectrum.step_nm=5"][..], sets].concat();
    resolve(GOOD, folder, &all).unwrap_or_else(|e| panic!("{e}")).warnings
}

/// A lamp of four lines, each 1 nm wide, on a faint continuum: three fall between the wavelengths
/// of a 5 nm grid, and none between those of a 1 nm grid.
#[test]
fn lines_that_fall_through_the_grid_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let lamp = |step: f64, is_line: fn(f64) -> bool| {
        let points = (0..=(400.0 / step) as u32).map(|i| 380.0 + step * f64::from(i));
        points.map(|nm| format!("{nm},{}\n", if is_line(nm) { 100 } else { 1 })).collect::<String>()
    };
    let lines = |nm: f64| [436.0, 542.0, 546.0, 611.0].contains(&nm);
    fs::write(folder.path().join("lamp.csv"), lamp(1.0, lines)).unwrap();
    // A spectrometer's .1 nm: its line is gone even from a grid of 1 nm.
    fs::write(folder.path().join("fine.csv"), lamp(0.1, |nm| (nm - 546.5).abs() < 0.11)).unwrap();
    let said = |sets: &[&str]| warnings(folder.path(), sets);

    let coarse = said(&["lighting.spectrum=lamp.csv"]);
    assert_eq!(coarse.len(), 1);
    // On the grid only the continuum is left: u' = 4/19, v' = 9/19 but for the ends of the range.
    let words = ["lighting.spectrum changes faster", "u' 0.210", "v' 0.473", "; set spectrum.step_nm = 1"];
    assert!(words.iter().all(|words| coarse[0].contains(words)), "{coarse:?}");
    assert!(said(&["lighting.spectrum=lamp.csv", "spectrum.step_nm=1"]).is_empty());
    let directed = said(&["lighting.directed.0.spectrum=lamp.csv"]);
    assert!(directed[0].starts_with("lighting.directed.0.spectrum changes faster"), "{directed:?}");

    for step in ["spectrum.step_nm=5", "spectrum.step_nm=1", "spectrum.step_nm=0.5"] {
        let fine = said(&["lighting.spectrum=fine.csv", step]);
        assert!(fine[0].contains("give its means over 1 nm"), "{step}: {fine:?}");
    }
}

#[test]
fn narrow_leds_are_told_and_wide_ones_are_not() {
    let said = |sets: &[&str]| warnings(Path::new(""), sets);
    let narrow = "lighting.spectrum={ led_nm = 552, width_nm = 2 }";
    assert_eq!(said(&[narrow]).len(), 1);
    assert!(said(&[narrow, "spectrum.step_nm=1"]).is_empty());
    assert!(said(&["lighting.spectrum={ led_nm = 552, width_nm = 15 }"]).is_empty());
    // Of a mixture, what matters is the whole.
    let mixed = |weight: f64| {
        format!(
            "lighting.spectrum=[{{ led_nm = 552, width_nm = 2, weight = {weight} }}, {{ planck_K = 2856 }}]"
        )
    };
    assert_eq!(said(&[&mixed(100.0)]).len(), 1);
    assert!(said(&[&mixed(0.01)]).is_empty());
}

/// Every light with a name is smooth enough for 5 nm.
#[test]
fn named_lights_pass() {
    for name in illuminant_names() {
        let spectrum = format!("lighting.spectrum={name}");
        for grid in [
            ["spectrum.range_nm=[380, 780]", "spectrum.step_nm=5"],
            ["spectrum.range_nm=[397.5, 700]", "spectrum.step_nm=2.5"],
        ] {
            if let [said, ..] = &warnings(Path::new(""), &[&spectrum, grid[0], grid[1]])[..] {
                panic!("{name} {grid:?}: {said}");
            }
        }
    }
    for cct in [4000, 25_000] {
        assert!(
            warnings(Path::new(""), &[&format!("lighting.spectrum={{ daylight_K = {cct} }}")]).is_empty()
        );
    }
}

#[test]
fn what_is_taken_otherwise_than_it_was_given() {
    let resolved = |sets: &[&str]| resolve(GOOD, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"));
    let says = |notes: &[String], words: &str| notes.iter().any(|note| note.contains(words));
    let uneven = resolved(&["viewer.theta_deg={ from = 0, to = 60, step = 7 }"]);
    assert!(says(&uneven.notes, "viewer.theta_deg: steps of 7 deg from 0 deg end at 56 deg, before 60 deg"));
    let even = resolved(&["viewer.phi_deg={ from = 0, to = 0.3, step = 0.1 }"]);
    assert!(!says(&even.notes, "steps"), "{:?}", even.notes);
    assert!(says(
        &resolved(&["solver.method=walk", "solver.paths=31"]).notes,
        "solver.paths = 31 is rounded up to 32"
    ));
    assert!(!says(&resolved(&["solver.method=walk", "solver.paths=32"]).notes, "solver.paths"));
    let ignored = resolved(&["solver.method=walk", "solver.paths=64", "solver.every_bin=true"]);
    assert!(says(&ignored.warnings, "has no effect beside solver.paths"));
    // -0 is 0, in the result and in the hash.
    let [minus, plus] = ["viewer.theta_deg=-0.0", "viewer.theta_deg=0"].map(|set| resolved(&[set]));
    assert!(minus.scene.viewer.theta_deg[0].is_sign_positive() && minus.hash == plus.hash);
}

#[test]
fn lengths_that_look_like_micrometres_are_told() {
    let text = changed(&[
        ("thickness_nm = 12", "thickness_nm = 0.012"),
        ("red = 275.9", "red = 0.2759"),
        ("dark = 20", "dark = 0"),
        ("[lighting]", "[display.pixel.states]\nteal = { green = { gap_nm = 0.165 } }\n[lighting]"),
    ]);
    let said = resolve(&text, Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}")).warnings;
    let expected = [
        "display.pixel.film.0.thickness_nm is 0.012 nm, which looks like micrometres: 0.012 um = 12 nm",
        "display.pixel.gap_nm.red is 0.2759 nm, which looks like micrometres: 0.2759 um = 275.9 nm",
        "display.pixel.states.teal.green.gap_nm is 0.165 nm, which looks like micrometres: 0.165 um = 165 nm",
    ];
    assert_eq!(said, expected);
    assert!(
        resolve(GOOD, Path::new(""), &["display.pixel.film.0.thickness_nm=0.5"]).unwrap().warnings.is_empty()
    );
}

//! `[display.diffuser.reflection]`: what it means, its notes, its mistakes.

use std::path::Path;

use papilio_display::scene::{Interface, Lobe, LobeReflection, Ready, ReflectedLobe, ReflectingDiffuser};
use papilio_scenario::Resolved;

use crate::common::{GOOD, LAYERED, NO_REFLECTION, changed, changed_in, resolve};

/// Returns `GOOD` with these lines in `[display.diffuser.reflection]`.
fn with(lines: &str) -> String {
    changed(&[("[display.glass]", &format!("[display.diffuser.reflection]\n{lines}\n[display.glass]"))])
}

fn resolved(text: &str, sets: &[&str]) -> Resolved {
    resolve(text, Path::new(""), sets).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the reflecting diffusers of a resolved display.
fn diffusers(resolved: &Resolved) -> Vec<&ReflectingDiffuser> {
    let found = resolved.scene.display.layers.iter().filter_map(|layer| match &layer.interface {
        Interface::Ready(Ready::Reflecting(diffuser)) => Some(&**diffuser),
        _ => None,
    });
    found.collect()
}

fn above(resolved: &Resolved) -> &LobeReflection {
    diffusers(resolved)[0].reflections()[0].as_ref().unwrap()
}

fn below(resolved: &Resolved) -> &LobeReflection {
    diffusers(resolved)[0].reflections()[1].as_ref().unwrap()
}

fn near(found: f64, truth: f64) -> bool {
    (found - truth).abs() < 1e-12
}

#[test]
fn total_reflectance_is_that_along_the_normal() {
    let found = resolved(&with("total_reflectance = 0.08"), &[]);
    assert!(matches!(above(&found).lobe(), ReflectedLobe::Lobe(Lobe::Lambertian)));
    assert!(near(above(&found).scattered()[0], 0.08) && above(&found).mirrored()[0] == 0.0);
    assert_eq!(above(&found), below(&found), "the same from below");

    let lobe = "model = \"k-correlation\"\nwidth = 0.3\nmirror = 0.25\n";
    let found = resolved(&with(&format!("total_reflectance = 0.06\n{lobe}")), &[]);
    let share = 0.25 + 0.75 * (1.0 - 0.3 / 0.3_f64.hypot(1.0));
    assert!(near(above(&found).scattered()[0], 0.75 * 0.06 / share));
    assert!(near(above(&found).mirrored()[0], 0.25 * 0.06 / share));
    let whole = resolved(&with(&format!("reflectance = 0.06\n{lobe}")), &[]);
    assert!(near(above(&whole).scattered()[0], 0.75 * 0.06));
    // Another key of the pair, from the command line, replaces that of the file.
    let other = resolved(
        &with(&format!("reflectance = 0.06\n{lobe}")),
        &["display.diffuser.reflection.total_reflectance=0.06"],
    );
    assert_eq!(above(&other), above(&found));
}

#[test]
fn haze_of_a_reflection_is_that_of_a_diffuser() {
    let found = resolved(&with("reflectance = 0.05\nmodel = \"k-correlation\"\nhaze = 0.78"), &[]);
    let ReflectedLobe::Lobe(Lobe::KCorrelation { width }) = above(&found).lobe() else {
        panic!("another lobe")
    };
    assert!((width - 0.05667).abs() < 5e-6);
}

#[test]
fn below_may_be_described_separately() {
    let text = with(
        "reflectance = 0.05\nbelow = { reflectance = 0.02, model = \"ward\", alpha = 0.2, mirror = 0.5 }",
    );
    let found = resolved(&text, &[]);
    assert!(matches!(below(&found).lobe(), ReflectedLobe::Kernel(_)));
    assert!(near(below(&found).scattered()[0], 0.01) && near(below(&found).mirrored()[0], 0.01));
    assert!(near(above(&found).scattered()[0], 0.05));
}

/// A diffuser of each model, in a panel and as a layer.
#[test]
fn every_described_diffuser_may_reflect() {
    let of = |model: &str, sets: &[&str]| {
        let text =
            changed_in(&with("reflectance = 0.05"), &[("model = \"k-correlation\"\nhaze = 0.78", model)]);
        assert_eq!(diffusers(&resolved(&text, sets)).len(), 1, "{model}");
    };
    of("model = \"lambertian\"", &[]);
    of("model = \"ward\"\nalpha = 0.1", &["display.diffuser.total_transmittance=0.8"]);
    let reflecting =
        [("transmittance = 0.95 }", "transmittance = 0.9, reflection = { reflectance = 0.05 } }")];
    assert_eq!(diffusers(&resolved(&changed_in(LAYERED, &reflecting), &[])).len(), 1);
}

#[test]
fn one_note_says_that_reflection_is_left_out() {
    let count = |text: &str, sets: &[&str]| {
        resolved(text, sets).notes.iter().filter(|note| *note == NO_REFLECTION).count()
    };
    assert_eq!(count(GOOD, &[]), 1);
    assert_eq!(count(LAYERED, &[]), 1, "one note for two diffusers");
    assert_eq!(count(&with("reflectance = 0"), &[]), 0);
    assert_eq!(
        count(GOOD, &["display.diffuser={ model = \"lambertian\", transmittance = 1 }"]),
        0,
        "nothing is lost"
    );
}

/// Each mistake: the lines of the table, its line and column, and words of the message.
#[test]
fn mistakes_are_reported_with_their_place() {
    let cases: [(&str, (usize, usize), &[&str]); 8] = [
        ("mirror = 0.1", (16, 1), &["none of `reflectance` and `total_reflectance`"]),
        ("reflectance = 0.1\ntotal_reflectance = 0.1", (17, 15), &["more than one"]),
        ("reflectance = 8", (17, 15), &["8 is out of range"]),
        (
            "reflectance = 0.1\nwidth = 0.1",
            (18, 9),
            &["`width` cannot be combined with model = \"lambertian\"", "k-correlation"],
        ),
        ("reflectance = 0.1\nmodel = \"ward\"", (16, 1), &["`alpha` is missing"]),
        ("reflectance = 0.1\nmodel = \"k-correlation\"", (16, 1), &["`haze` and `width`"]),
        (
            "total_reflectance = 0.9\nmodel = \"k-correlation\"\nwidth = 1",
            (17, 21),
            &["the whole lobe would be 3.07", "0.2929 at most"],
        ),
        (
            "reflectance = 0.2",
            (16, 1),
            &["transmit and reflect 1.1", "from above at 0 deg", "at most 1 at every incidence"],
        ),
    ];
    for (lines, place, words) in cases {
        let Err(errors) = resolve(&with(lines), Path::new(""), &[]) else { panic!("no error: {lines}") };
        let errors: Vec<_> = errors.iter().collect();
        assert_eq!(errors.len(), 1, "{lines}: {errors:?}");
        let said = errors[0].to_string();
        assert_eq!(errors[0].place.line_column().unwrap_or((0, 0)), place, "{lines}: {said}");
        assert!(words.iter().all(|word| said.contains(word)), "{lines}: {said}");
    }
}

/// Ward's lobe on the disc of the glass needs one index.
#[test]
fn ward_below_needs_one_index() {
    let text = with("reflectance = 0.05\nmodel = \"ward\"\nalpha = 0.2");
    let sets = ["display.glass.index=BK7".to_owned()].map(String::from);
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    let Err(errors) = resolve(&text, Path::new(""), &sets) else { panic!("no error") };
    assert!(errors.to_string().contains("the same index at all wavelengths"), "{errors}");
    let described = changed_in(&text, &[("alpha = 0.2", "alpha = 0.2\nbelow = { reflectance = 0.05 }")]);
    resolved(&described, &sets);
}

#[test]
fn keys_for_the_ordinary_panel_are_refused_beside_a_reflection() {
    for set in ["solver.approximation=single-pass", "solver.angle_medium=unrefracted"] {
        let Err(errors) = resolve(&with("reflectance = 0.02"), Path::new(""), &[set]) else {
            panic!("{set}")
        };
        assert!(errors.to_string().contains("without `reflection`"), "{errors}");
    }
}

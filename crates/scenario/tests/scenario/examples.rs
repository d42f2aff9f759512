//! The shipped scenarios: all of them resolve, and the flagship is the reference display.

use std::path::PathBuf;
use std::sync::LazyLock;

use papilio_display::scene::{Drive, Lobe, Method, Pixel, Stop, Thickness};
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::sized;

use crate::common::{NO_REFLECTION, shipped};

/// Scenarios that take long and are like others: of a measured diffuser, a surface, a map of light.
pub(crate) const LIKE_OTHERS: [&str; 3] = ["measured-h78", "etched-face", "map"];

/// The shipped scenarios, resolved once for all tests: measured diffusers and surfaces take long.
static RESOLVED: LazyLock<Vec<(PathBuf, Resolved)>> = LazyLock::new(|| {
    let files = std::fs::read_dir(shipped()).unwrap().map(|entry| entry.unwrap().path());
    let scenarios = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    let resolved = |path: PathBuf| {
        let scenario = Scenario::load(&path, &[]).unwrap_or_else(|e| panic!("{e}"));
        let resolved = scenario.resolve().unwrap_or_else(|e| panic!("{e}"));
        (path, resolved)
    };
    scenarios.map(resolved).collect()
});

#[test]
fn shipped_scenarios_resolve() {
    assert!(RESOLVED.len() >= 14);
    for (path, resolved) in RESOLVED.iter() {
        assert!(resolved.title.is_some());
        // The published model of this panel returns more light than arrives.
        let is_known = |one: &&String| {
            path.ends_with("spectralon.toml") && one.contains("as much light leaves as arrives")
        };
        let warnings: Vec<_> = resolved.warnings.iter().filter(|one| !is_known(one)).collect();
        assert!(warnings.is_empty(), "{}: {warnings:?}", path.display());
        assert!(
            std::fs::read_to_string(path).unwrap().starts_with("# "),
            "{} explains itself",
            path.display()
        );
    }
}

#[test]
fn indoor_scenario_has_the_reference_display() {
    let resolved = Scenario::load(&shipped().join("indoor.toml"), &[]).unwrap().resolve().unwrap();
    let scene = &resolved.scene;
    assert_eq!((scene.grid.len(), scene.grid.stop_nm()), (81, 780.0));
    let note = "haze 0.78 means a lobe of width 0.05667 (b, direction cosines); above 30 % haze is outside \
                ASTM D1003's scope, see ASTM E2387";
    assert_eq!(resolved.notes, [note, NO_REFLECTION]);
    assert_eq!(scene.display.panel().unwrap().front.len(), 1);
    let diffuser = scene.display.panel().unwrap().diffuser().unwrap();
    let Lobe::KCorrelation { width } = diffuser.lobe else { panic!("not a k-correlation lobe") };
    // Truncated at the hemisphere, haze 0.78 is b = 0.05667; T from the total transmittance 0.90 by the
    // truncation of that lobe.
    assert!((width - 0.05667).abs() < 5e-6);
    let share = 1.0 - width / width.hypot(1.0);
    assert!((diffuser.transmittance[40] - 0.9 / share).abs() < 1e-12);
    let Pixel::Film(film) = &scene.display.pixel else { panic!("not a film") };
    assert_eq!(film.layers[4].thickness, Thickness::Gap);
    assert_eq!(film.dark_gap_nm, Some(20.0));
    let states: Vec<_> = film.states.iter().map(|state| state.name.as_str()).collect();
    assert_eq!(states, ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow"]);
    assert_eq!(film.states[7].drives, [Drive::Share(1.0), Drive::Share(1.0), Drive::Share(0.0)]);
    assert_eq!(film.sub_pixels.iter().map(|sub_pixel| sub_pixel.area).sum::<f64>(), 1.0);
    assert_eq!((scene.lighting.diffuse, scene.lighting.directed[0].theta_deg), (0.5, -20.0));
    assert_eq!(scene.viewer.theta_deg, [8.0]);
    assert_eq!(scene.solver.method, Method::Adding);
    assert_eq!(scene.solver.stop, Stop::RelativeError { target: 0.001, per_wavelength: false });
}

/// The canonical form is itself a scenario, and resolves to the same hash.
#[test]
fn canonical_form_reads_back_with_the_same_hash() {
    let left_out =
        |path: &PathBuf| sized(LIKE_OTHERS.iter().any(|name| path.ends_with(format!("{name}.toml"))), false);
    for (path, resolved) in RESOLVED.iter().filter(|(path, _)| !left_out(path)) {
        let mut canonical = resolved.canonical.clone();
        canonical.as_object_mut().unwrap().remove("inputs");
        let text = toml::to_string(&canonical).unwrap();
        let again =
            Scenario::from_text(&text, "canonical", &shipped(), &[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(again.resolve().unwrap().hash, resolved.hash, "{}", path.display());
    }
}

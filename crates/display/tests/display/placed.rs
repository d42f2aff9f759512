//! Monte Carlo with places, from the scenario to Y with errors.

use std::sync::atomic::AtomicBool;

use papilio_display::spatial::mtf;
use papilio_display::spatial::walk::{pattern, transfer};
use papilio_display::{Control, DisplayError};
use papilio_transport::walk::places::Uniform;

use papilio_scenario::{Resolved, Scenario};

use crate::common::{run, scenario, scenarios};

fn control(stop: &AtomicBool) -> Control<'_> {
    Control { threads: None, progress: &|_| {}, stop }
}

/// Uniform states, in diffuse light and a beam, have the Y of a run; also below a front with gaps.
#[test]
fn uniform_states_have_the_colours_of_a_run() {
    let front = r#"display.front=[{ reflectance = 0.04, absorptance = 0.0, gap_mm = 0.2 }]"#;
    for overrides in [vec![], vec![front]] {
        let resolved = scenario("matrix", &overrides).unwrap();
        let exact = run(&resolved.scene).unwrap();
        let states: Vec<f64> = exact.views[0].states.iter().map(|(_, state)| state.value.Y).collect();
        let stop = AtomicBool::new(false);
        let uniform = Uniform { states: states.len() };
        let found = &pattern(&resolved.scene, &uniform, 1 << 14, &control(&stop)).unwrap()[0];
        assert_eq!(found.via_pixel.len(), states.len());
        for (y, found_y) in states.iter().zip(&found.via_pixel) {
            let sum = found_y.value + found.front.value;
            let error = found_y.standard_error.hypot(found.front.standard_error);
            assert!((sum - y).abs() < 5.0 * error + 1e-3 * y, "{sum} +- {error}, {y}");
            assert!(error < 0.05 * y, "{error} of {y}");
        }
    }
}

/// A lamp makes a double image: less contrast along the plane of incidence than across it, where the phase
/// has no sign.
#[test]
fn transfer_of_a_lamp_is_lower_along_its_plane() {
    let resolved = scenario("matrix", &["lighting.diffuse=0.0", "lighting.directed.0.share=1.0"]).unwrap();
    let stop = AtomicBool::new(false);
    let frequencies = [[5.0, 0.0], [0.0, 5.0]];
    let views = transfer(&resolved.scene, &frequencies, 1 << 14, &control(&stop)).unwrap();
    let white = views[0].states.get("white").unwrap();
    let [along, across] = [0, 1].map(|k| {
        let [re, im] = white.once.otf[k];
        (re.value.hypot(im.value), re.standard_error.hypot(im.standard_error))
    });
    assert!(along.1 < 0.05 && across.1 < 0.05, "{along:?} {across:?}");
    assert!(across.0 - along.0 > 0.1, "{along:?} {across:?}");
    let [_, sideways] = white.once.otf[1];
    assert!(sideways.value.abs() < 5.0 * sideways.standard_error + 1e-9, "{sideways:?}");
}

/// Two methods: the transfer of `papilio mtf` and that of paths, in mixed light; the kernel of the first
/// order of a mirror-like pixel, and the response of paper to small changes.
#[test]
fn transfer_by_paths_equals_that_of_the_deterministic_solver() {
    for (name, overrides, recycled) in
        [("matrix", vec![], false), ("epaper", vec!["display.glass.thickness_mm=0.3"], true)]
    {
        let resolved = scenario(name, &overrides).unwrap();
        let stop = AtomicBool::new(false);
        let exact = mtf(&resolved.scene, &resolved.patterns, &control(&stop)).unwrap();
        let wanted = [0.5, 2.0, 5.0].map(|f| {
            let distance = |k: &usize| (exact.frequency_per_mm[*k] - f).abs();
            (0..exact.frequency_per_mm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
        });
        let along = wanted.map(|k| [exact.frequency_per_mm[k], 0.0]);
        let found = transfer(&resolved.scene, &along, 1 << 15, &control(&stop)).unwrap();
        for (state, exact) in exact.views[0].states.iter() {
            let found = found[0].states.get(state).unwrap();
            let found = if recycled { &found.response } else { &found.once };
            for (at, found) in wanted.iter().zip(&found.otf) {
                for (exact, found) in exact.otf.otf_x[*at].iter().zip(found) {
                    let what = format!("{name}, {state}, number {at}: {found:?}, {exact}");
                    assert!((found.value - exact).abs() < 5.0 * found.standard_error + 1e-3, "{what}");
                    assert!(found.standard_error < 0.05, "{what}");
                }
            }
        }
    }
}

#[test]
fn what_has_no_place_is_refused() {
    let stop = AtomicBool::new(false);
    let error = |overrides: &[&str]| {
        let resolved = scenario("matrix", overrides).unwrap();
        pattern(&resolved.scene, &Uniform { states: 8 }, 32, &control(&stop)).unwrap_err()
    };
    let single_pass = error(&["solver.approximation=single-pass"]);
    assert!(
        matches!(single_pass, DisplayError::NoPlaces { key: "solver.approximation", .. }),
        "{single_pass}"
    );
}

/// All numbers of `papilio mtf` by both solvers: within their errors, and 1e-3 for what is interpolated
/// between other places.
#[test]
fn sharpness_by_paths_has_the_numbers_of_the_deterministic_solver() {
    let stop = AtomicBool::new(false);
    let name = "matrix";
    let by = |solver: &str| {
        let mut overrides = vec![solver, "spectrum.step_nm=20"];
        overrides.extend((solver == "solver.method=monte-carlo").then_some("solver.paths=32768"));
        let resolved = scenario(name, &overrides).unwrap();
        mtf(&resolved.scene, &resolved.patterns, &control(&stop)).unwrap()
    };
    let [exact, found] = ["solver.method=adding", "solver.method=monte-carlo"].map(by);
    let (exact_view, view) = (&exact.views[0], &found.views[0]);
    assert_eq!(exact.frequency_per_mm, found.frequency_per_mm);
    let agrees = |what: &str, exact: Option<f64>, found: Option<f64>, error: Option<f64>| {
        let (Some(exact), Some(found)) = (exact, found) else {
            return assert_eq!(exact.is_some(), found.is_some(), "{name}, {what}");
        };
        let error = error.unwrap_or(0.0);
        let off = (exact - found).abs();
        assert!(off <= 5.0 * error + 4e-3 * exact.abs(), "{name}, {what}: {found} +- {error}, {exact}");
    };
    for (state, found) in view.states.iter() {
        let exact = exact_view.states.get(state).unwrap();
        agrees(&format!("{state} Y"), Some(exact.Y_via_pixel), Some(found.Y_via_pixel), Some(3e-3));
        let numbers = exact.scalars.named().zip(found.scalars.named()).zip(found.error.named());
        for (((number, exact), (_, found)), (_, error)) in numbers {
            agrees(&format!("{state} {number}"), exact, found, error);
        }
        for (k, exact) in exact.otf.otf_x.iter().enumerate() {
            let off = (exact[0] - found.otf.otf_x[k][0]).hypot(exact[1] - found.otf.otf_x[k][1]);
            assert!(off < 5.0 * found.otf.error_x[k] + 1e-3, "{name}, {state}, number {k}: {off}");
        }
        let all: f64 = found.kernel.fractions.iter().sum();
        assert!((all + found.kernel.outside - 1.0).abs() < 1e-9 && found.kernel.outside < 0.5);
    }
    let lines = exact_view.line_contrast.named().zip(view.line_contrast.named());
    for (((number, exact), (_, found)), (_, error)) in lines.zip(view.line_contrast_error.named()) {
        agrees(number, exact, found, error);
    }
    let text = [exact_view.text_contrast_median, view.text_contrast_median];
    agrees("text", text[0], text[1], view.text_contrast_error.map(|error| error[1]));
}

/// What the deterministic solver refuses has an answer by paths: a slab in glass over paper.
#[test]
fn sharpness_of_any_layers_is_computed_by_paths() {
    let stop = AtomicBool::new(false);
    let layers = r#"display.layers=[{ kind = "fresnel" }, { kind = "slab", optical_thickness = 0.5, anisotropy = 0.8, albedo = 0.99, index = 1.5, thickness_mm = 0.2 }]"#;
    let overrides = ["solver.method=monte-carlo", "solver.paths=4096", "spectrum.step_nm=40", layers];
    let resolved = without_glass(&overrides);
    let found = mtf(&resolved.scene, &resolved.patterns, &control(&stop)).unwrap();
    let white = found.views[0].states.get("white").unwrap();
    assert!(white.Y_via_pixel > 0.1 && white.otf.otf_x[0] == [1.0, 0.0], "{white:?}");
    assert!(white.otf.otf_x.iter().zip(&white.otf.error_x).all(|(otf, error)| otf[0] > 0.2 && *error < 0.1));
}

/// Text on paper, without its glass.
fn without_glass(overrides: &[&str]) -> Resolved {
    let text = std::fs::read_to_string(scenarios().join("laminated-text.toml")).unwrap();
    let start = text.find("[display.glass]").unwrap();
    let end = start + text[start..].find("[display.matrix]").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("layers.toml");
    std::fs::write(&file, format!("{}{}", &text[..start], &text[end..])).unwrap();
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scenario::load(&file, &overrides).unwrap().resolve().unwrap()
}

//! Monte Carlo with places, from the scenario to Y with errors.

use std::sync::atomic::AtomicBool;

use papilio_display::spatial::mtf;
use papilio_display::spatial::walk::{pattern, transfer};
use papilio_display::{Control, DisplayError};
use papilio_transport::walk::places::Uniform;

use crate::common::{run, scenario};

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

/// A lamp makes a double image: less contrast along the plane of incidence than across it, where the phase has no sign.
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

/// Two methods: the transfer of `papilio mtf` and that of paths, in mixed light; the kernel of the first order of a mirror-like pixel,
/// and the response of paper to small changes.
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

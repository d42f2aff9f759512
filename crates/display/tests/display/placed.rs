//! Monte Carlo with places, from the scenario to Y with errors.

use std::sync::atomic::AtomicBool;

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

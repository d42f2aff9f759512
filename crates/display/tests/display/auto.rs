//! Tests of `method = "auto"`: the solver that is chosen, and why.

use std::sync::atomic::AtomicBool;

use crate::common::{run_on, scenario};
use papilio_display::result::RunResult;
use papilio_display::scene::{Method, Scene};
use papilio_display::{Control, Forecast, forecast};

fn scene(name: &str, overrides: &[&str]) -> Scene {
    let overrides = [&["spectrum.step_nm=40", "solver.method=auto"], overrides].concat();
    scenario(name, &overrides).unwrap().scene
}

fn of(scene: &Scene) -> Forecast {
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &AtomicBool::new(false) };
    forecast(scene, &control).unwrap()
}

fn reason(result: &RunResult) -> &str {
    result.solver.chosen_because.as_deref().unwrap()
}

/// The result is that of the chosen solver, to the last bit, and says why it was chosen.
#[test]
fn auto_equals_the_solver_that_it_chooses() {
    let cases: [(&str, &[&str], Method, &str); 4] = [
        ("indoor", &[], Method::Adding, "adding takes about"),
        ("two-diffusers", &["solver.relative_error=1e-4"], Method::Adding, "adding takes about"),
        ("sampling", &["solver.paths=4096"], Method::MonteCarlo, "number of paths"),
        (
            "cover-glass",
            &["display.layers.4.haze=0.002", "solver.relative_error=0.3"],
            Method::MonteCarlo,
            "adding refuses",
        ),
    ];
    for (name, overrides, method, why) in cases {
        let auto = scene(name, overrides);
        let chosen = run_on(&auto, Some(1)).unwrap();
        assert!(reason(&chosen).contains(why), "{name}: {}", reason(&chosen));
        assert!(chosen.notes.iter().any(|note| note.contains("`auto` has chosen")), "{:?}", chosen.notes);
        let alone =
            Scene { solver: papilio_display::scene::Solver { method, ..auto.solver.clone() }, ..auto };
        let alone = run_on(&alone, Some(1)).unwrap();
        assert_eq!(chosen.solver.method, alone.solver.method, "{name}");
        assert!(format!("{:?}", chosen.views) == format!("{:?}", alone.views), "{name}");
    }
}

/// The choice depends on counts alone: not on threads, and not on the run.
#[test]
fn choice_does_not_depend_on_threads() {
    for (name, overrides) in [("auto", &[][..]), ("rough-glass", &["solver.relative_error=0.02"])] {
        let scene = scene(name, overrides);
        let [one, three] = [1, 3].map(|threads| run_on(&scene, Some(threads)).unwrap());
        assert_eq!(reason(&one), reason(&three), "{name}");
        assert_eq!(of(&scene), of(&scene), "{name}");
    }
}

/// A smaller target needs more work of both, and Monte Carlo loses against adding in the end.
#[test]
fn smaller_target_takes_more_work_and_ends_with_adding() {
    let at = |target: &str| of(&scene("cover-glass", &[&format!("solver.relative_error={target}")]));
    let [coarse, fine] = ["0.05", "0.00002"].map(at);
    assert!(fine.adding_s > coarse.adding_s, "{coarse:?} {fine:?}");
    assert!(fine.monte_carlo_s.unwrap() > 100.0 * coarse.monte_carlo_s.unwrap(), "{coarse:?} {fine:?}");
    assert_eq!(fine.cheaper, Method::Adding);
}

/// The Monte Carlo solver refuses thick slabs.
#[test]
fn thick_slab_is_for_adding() {
    let thick = of(&scene("slab", &["display.diffuser.optical_thickness=300"]));
    assert_eq!((thick.cheaper, thick.monte_carlo_s), (Method::Adding, None));
    assert!(thick.reason.contains("optical thickness"), "{}", thick.reason);
}

//! Tests of the first answers of prepared displays: their errors hold, and the exact answers do not depend on
//! them.

use std::sync::atomic::AtomicBool;

use crate::common::{prepared_for, scenario, walked};
use papilio_display::Control;
use papilio_display::result::{RunResult, StateValues};
use papilio_display::scene::Scene;
use papilio_testing::everyday;

static NEVER: AtomicBool = AtomicBool::new(false);

const CONTROL: Control<'static> = Control { threads: Some(1), progress: &|_| {}, stop: &NEVER };

/// Displays of every kind, narrow and wide, with the overrides that are moved on the page.
const DISPLAYS: [(&str, &[&str]); 16] = [
    ("indoor", &[]),
    ("indoor", &["display.diffuser.haze=0.05"]),
    ("indoor", &["display.diffuser.haze=0.2", "display.front.0.reflectance=0.02"]),
    ("indoor", &["display.diffuser.haze=0.4", "display.front.0.reflectance=0.04"]),
    ("cover-glass", &[]),
    // Wavelengths between which first answers are interpolated, and films whose fringes are narrower than
    // their steps: the coarser of the two levels resolves them even less, or all are computed.
    ("cover-glass", &["spectrum.step_nm=5"]),
    ("rough-glass", &[]),
    ("rough-glass", &["display.layers.0.alpha=0.4", "viewer.theta_deg=60"]),
    ("measured-h65", &["viewer.theta_deg=[19.5, 40]", "lighting.directed.0.theta_deg=-55"]),
    ("two-diffusers", &[]),
    ("slab", &[]),
    ("table-pixel", &[]),
    ("overcast", &[]),
    ("reflecting-diffuser", &[]),
    // Like others, and they take a second each.
    ("measured-h65", &["viewer.theta_deg=8"]),
    (
        "measured-h65",
        &["spectrum.step_nm=5", "viewer.theta_deg=30", "display.pixel.film.2.thickness_nm=2000"],
    ),
];

fn scene(name: &str, overrides: &[&str]) -> Scene {
    scenario(name, &[&["spectrum.step_nm=40"], overrides].concat()).unwrap().scene
}

/// Returns the values of all states that a page shows, with their errors.
fn values(result: &RunResult) -> Vec<[(&'static str, f64, f64); 4]> {
    let states = result.views.iter().flat_map(|view| view.states.iter());
    let of = |value: &StateValues| {
        [("Y", Some(value.Y)), ("X", Some(value.X)), ("u'", value.u_prime), ("v'", value.v_prime)]
    };
    let errors = |(_, state): (&str, &papilio_display::result::State)| {
        let (value, error) = (of(&state.value), of(state.discretisation_error.as_ref().unwrap()));
        [0, 1, 2, 3].map(|k| (value[k].0, value[k].1.unwrap_or(0.0), error[k].1.unwrap_or(0.0)))
    };
    states.map(errors).collect()
}

#[test]
fn first_answer_is_within_its_error_of_the_exact_one() {
    let mut firsts = 0;
    for (name, overrides) in everyday(14, DISPLAYS) {
        let scene = scene(name, overrides);
        let mut prepared = prepared_for(&scene).unwrap();
        let first = prepared.first(&scene, &CONTROL).unwrap();
        let exact = prepared.run(&scene, &CONTROL).unwrap();
        assert!(exact.solver.is_final, "{name}");
        firsts += usize::from(!first.solver.is_final);
        assert!(!first.warnings.iter().any(|w| w.contains("relative error")), "{name}: {:?}", first.warnings);
        let reached = first.solver.relative_error_reached;
        assert!(reached < 0.1, "{name} {overrides:?}: {reached}");
        for (coarse, fine) in values(&first).into_iter().zip(values(&exact)) {
            for ((what, coarse, error), (_, fine, exact_error)) in coarse.into_iter().zip(fine) {
                let away = (coarse - fine).abs();
                assert!(
                    away <= error + exact_error,
                    "{name} {overrides:?}, {what}: {coarse} is not within {error:e} + {exact_error:e} of {fine}"
                );
            }
        }
    }
    // All others take so little work that they are exact at once.
    assert!(firsts >= 8, "{firsts}");
}

/// The exact answer after a first one equals a single run to the last bit, also if the display was another
/// one in between.
#[test]
fn exact_answer_does_not_depend_on_first_answers() {
    let mut prepared = prepared_for(&scene("indoor", &[])).unwrap();
    for name in ["indoor", "two-diffusers", "cover-glass", "indoor"] {
        let scene = scene(name, &[]);
        let first = format!("{:?}", prepared.first(&scene, &CONTROL).unwrap());
        let exact = prepared.run(&scene, &CONTROL).unwrap();
        let alone = papilio_display::run(&scene, &CONTROL).unwrap();
        assert!(format!("{exact:?}") == format!("{alone:?}"), "{name}");
        assert!(format!("{:?}", prepared.first(&scene, &CONTROL).unwrap()) == first, "{name}");
    }
}

/// First answers by paths are of few, with standard errors that contain the difference; also below a colour filter, and with any stopping rule.
#[test]
fn first_answer_by_paths_is_of_few_of_them() {
    let rules = ["solver.relative_error=0.005", "solver.paths=65536"];
    let indoor = |rule| walked("indoor", &["spectrum.step_nm=40", rule]);
    let filtered = walked("printed-filter", &["spectrum.step_nm=40", "solver.relative_error=0.02"]);
    for scene in [indoor(rules[0]), indoor(rules[1]), filtered].map(|resolved| resolved.unwrap().scene) {
        let mut prepared = prepared_for(&scene).unwrap();
        let first = prepared.first(&scene, &CONTROL).unwrap();
        let exact = prepared.run(&scene, &CONTROL).unwrap();
        assert!(!first.solver.is_final && exact.solver.is_final, "{:?}", first.solver);
        let paths = [&first, &exact].map(|result| result.solver.paths.unwrap());
        assert!(2 * paths[0] <= paths[1], "{paths:?}");
        assert!(first.warnings.len() <= exact.warnings.len(), "{:?}", first.warnings);
        for (of_first, of_exact) in first.views.iter().zip(&exact.views) {
            for ((name, coarse), (_, fine)) in of_first.states.iter().zip(of_exact.states.iter()) {
                let error = coarse.standard_error.Y.hypot(fine.standard_error.Y);
                let away = (coarse.value.Y - fine.value.Y).abs();
                assert!(coarse.standard_error.Y > fine.standard_error.Y, "{name}");
                assert!(away < 5.0 * error, "{name}: {away:e}, {error:e}");
            }
        }
    }
}

/// A scene that demands no more paths has its answer at once.
#[test]
fn few_paths_need_no_first_answer() {
    let scene = walked("indoor", &["spectrum.step_nm=40", "solver.paths=2048"]).unwrap().scene;
    let mut prepared = prepared_for(&scene).unwrap();
    let first = prepared.first(&scene, &CONTROL).unwrap();
    assert!(first.solver.is_final, "{:?}", first.solver);
    assert!(format!("{first:?}") == format!("{:?}", prepared.run(&scene, &CONTROL).unwrap()));
}

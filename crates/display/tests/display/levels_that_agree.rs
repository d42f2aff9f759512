//! Views at which two levels of adding agree by chance: the difference of the levels changes its sign between
//! two views, and says nothing about the error where it vanishes. The stated error must hold there, too.

use crate::common::{run, scenario};

/// A pixel with one state, so that no other state says how well the levels agree.
const ONE_STATE: [&str; 2] =
    ["display.pixel={model=\"uniform\",kind=\"mirror\",reflectance={white=0.6}}", "spectrum.step_nm=80"];

/// Returns Y of white and its stated error, relative to Y, for each view.
fn white(name: &str, overrides: &[&str], views: &str, target: &str) -> Vec<(f64, f64)> {
    let overrides = [overrides, &ONE_STATE, &[views, target]].concat();
    let result = run(&scenario(name, &overrides).unwrap().scene).unwrap();
    let white = result.views.iter().map(|view| view.states.get("white").unwrap());
    white
        .map(|state| {
            let error = state.discretisation_error.as_ref().unwrap().Y;
            (state.value.Y, error / state.value.Y)
        })
        .collect()
}

#[test]
fn errors_hold_where_two_levels_agree_by_chance() {
    let cases: [(&str, &[&str], i32); 3] = [
        ("indoor", &["display.diffuser.haze=0.5", "display.front.0.reflectance=0.02"], 1),
        ("indoor", &["display.front.0.reflectance=0.3"], 1),
        ("two-diffusers", &[], 5),
    ];
    for (name, overrides, step) in cases {
        let angles: Vec<String> = (-40..=40).step_by(step as usize).map(|theta| theta.to_string()).collect();
        let views = format!("viewer.theta_deg=[{}]", angles.join(","));
        let stated = white(name, overrides, &views, "solver.relative_error=0.01");
        let reference = white(name, overrides, &views, "solver.relative_error=2e-6");
        let largest = stated.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        let smallest = stated.iter().map(|(_, error)| *error).fold(f64::INFINITY, f64::min);
        assert!(
            smallest < 0.1 * largest,
            "{name} {overrides:?}: no two levels agree: {smallest:e}, {largest:e}"
        );
        for (((y, error), (exact, rest)), theta) in stated.iter().zip(&reference).zip(&angles) {
            let found = (y / exact - 1.0).abs();
            assert!(found <= error + rest, "{name} {overrides:?}, {theta} deg: {found:e} exceeds {error:e}");
        }
    }
}

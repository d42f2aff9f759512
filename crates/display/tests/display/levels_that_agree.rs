//! Views at which two levels of adding agree by chance: the difference of the levels changes its sign between
//! two views, and says nothing about the error where it vanishes. The stated error must hold there, too.

use std::path::Path;

use papilio_display::result::State;
use papilio_scenario::Scenario;

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

/// Light that a front returns below a narrow lobe with regular transmittance, in views with a field: each of its directions is
/// a group of its own, and the first two levels once agreed on a fraction of this light. Glass that absorbs next to nothing makes
/// the same panel a list of general layers, which has none of the closed forms.
#[test]
fn fields_of_view_below_a_front_agree_with_general_layers() {
    let with = |glass: &str, solver: &str| {
        let text = format!(
            "[spectrum]\nrange_nm = [550, 560]\nstep_nm = 10\n[[display.front]]\nreflectance = 0.1\n[display.glass]\nindex = 1.5\n{glass}\n\
             [display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.02\ntransmittance = 1.0\nregular_fraction = 0.4\n[display.pixel]\n\
             model = \"uniform\"\nkind = \"mirror\"\nreflectance = {{ white = 0.9 }}\n[lighting]\ndiffuse = 0\n[[lighting.directed]]\n\
             theta_deg = 30\nshare = 1\n[viewer]\ntheta_deg = [0, 20]\nfield_deg = 0.1\n[solver]\n{solver}\n"
        );
        let scene =
            Scenario::from_text(&text, "narrow.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
        let result = run(&scene).unwrap();
        result.views.iter().map(|view| view.states.get("white").unwrap().clone()).collect::<Vec<_>>()
    };
    let panel = with("", "relative_error = 0.01");
    let layers = with("internal_transmittance = 0.9999999", "relative_error = 1e-3");
    let paths = with("", "method = \"monte-carlo\"\npaths = 65536");
    for ((panel, layers), paths) in panel.iter().zip(&layers).zip(&paths) {
        let stated = panel.discretisation_error.as_ref().unwrap().Y;
        let [panel, layers, walked] = [panel, layers, paths].map(|state| state.value.Y);
        assert!((panel / layers - 1.0).abs() < 1e-3, "{panel} {layers}");
        assert!((panel - walked).abs() < stated + 4.5 * paths.standard_error.Y, "{panel} {walked}");
        // Y would be 11 % too small without most of this light.
        assert!(paths.standard_error.Y < 0.02 * walked, "{:?}", paths.standard_error.Y);
    }
}

/// a* and b* of a neutral colour are differences that nearly vanish: an error relative to themselves says nothing. X, Y
/// and Z have errors of 1e-7 or more, and by the definition of CIELAB such errors alone change a* by
/// `500/3 (Y/Yn)^(1/3)` of them, b* by `200/3 (Y/Yn)^(1/3)`, and u' by at least a fourth of them.
#[test]
fn errors_of_neutral_colours_contain_those_of_their_amounts_of_light() {
    let grey = "display.pixel={model=\"uniform\",kind=\"mirror\",reflectance={white=0.6,black=0.03}}";
    for target in ["solver.relative_error=0.01", "solver.relative_error=1e-6"] {
        let result =
            run(&scenario("indoor", &[grey, target, "viewer.theta_deg=[8,40]"]).unwrap().scene).unwrap();
        for (name, state) in result.views.iter().flat_map(|view| view.states.iter()) {
            let (value, error) = (&state.value, state.discretisation_error.as_ref().unwrap());
            let of_y = error.Y / value.Y;
            let cube_root = (value.L_star.unwrap() + 16.0) / 116.0;
            assert!(of_y >= 1e-7 && value.a_star.unwrap().abs() < 1.0, "{name}");
            assert!(
                error.a_star.unwrap() > 0.9 * 500.0 / 3.0 * cube_root * of_y,
                "{target} {name}: {error:?}"
            );
            assert!(
                error.b_star.unwrap() > 0.9 * 200.0 / 3.0 * cube_root * of_y,
                "{target} {name}: {error:?}"
            );
            assert!(error.u_prime.unwrap() > 0.25 * 0.2 * of_y, "{target} {name}: {error:?}");
        }
        // From one view to the other, the shift is a difference of two such colours; of a view to itself it has no error.
        for (view, at_least) in result.views.iter().zip([0.0, 1e-8]) {
            let (_, state) = view.states.iter().next().unwrap();
            let metrics = &state.discretisation_error.as_ref().unwrap().metrics;
            let (shift, delta_e) =
                (metrics.shift_with_angle_uv.unwrap(), metrics.delta_E_2000_with_angle.unwrap());
            assert!(if at_least == 0.0 {
                shift == 0.0 && delta_e == 0.0
            } else {
                shift > at_least && delta_e > 1e-6
            });
        }
    }
}

/// Below a narrow lobe, the light that a front returns fluctuates from level to level instead of converging: a stricter
/// target, which is not met, states no larger error than the one before, and both results are within their errors.
#[test]
fn stricter_targets_never_state_larger_errors() {
    let of = |target: &str| {
        let sets = ["display.diffuser.haze=0.3", "spectrum.step_nm=20", target];
        let result = run(&scenario("ring", &sets).unwrap().scene).unwrap();
        let white = result.views[0].states.iter().next().unwrap().1.clone();
        (result.solver.relative_error_reached, white)
    };
    let all =
        ["1e-2", "1e-3", "1e-4", "1e-5", "1e-6"].map(|target| of(&format!("solver.relative_error={target}")));
    for pair in all.windows(2) {
        let ([(looser, a), (stricter, b)], error) =
            ([&pair[0], &pair[1]], |state: &State| state.discretisation_error.as_ref().unwrap().Y);
        assert!(stricter <= looser, "{looser:e} {stricter:e}");
        assert!((a.value.Y - b.value.Y).abs() <= error(a) + error(b), "{:?} {:?}", a.value.Y, b.value.Y);
    }
}

//! Views at which two levels of adding agree by chance: the difference of the levels changes its sign between
//! two views, and says nothing about the error where it vanishes. The stated error must hold there, too.

use std::path::Path;

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

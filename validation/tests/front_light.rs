//! A light guide below the front of screen, alone and beside the room's light.
#![allow(clippy::unwrap_used, reason = "a test says what it expects by unwrapping")]

use std::path::Path;

use papilio_display::result::{RunResult, StateValues};
use papilio_scenario::Scenario;

const FRONT: &str = "[[display.front]]\nreflectance = 0.02\nabsorptance = 0.01\n";
const PIXEL: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";
const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.08\ntransmittance = 0.9\nstraight_through = 0.1\n";
const SOLVERS: [&str; 2] = ["relative_error = 1e-5", "method = \"walk\"\npaths = 4096"];

fn run(display: &str, lighting: &str, solver: &str) -> RunResult {
    let text = format!(
        "[spectrum]\nstep_nm = 20\n{display}{PIXEL}[lighting]\nilluminance_lx = 500\n{lighting}\n[viewer]\ntheta_deg = 8\n\
         [solver]\n{solver}\n"
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let scenario = Scenario::from_text(&text, "light.toml", &folder, &[]).unwrap();
    papilio_validation::run(&scenario.resolve().unwrap().scene).unwrap()
}

fn white(result: &RunResult) -> &StateValues {
    &result.views[0].states.get("white").unwrap().value
}

fn near(what: &str, found: f64, truth: f64, tolerance: f64) {
    assert!((found / truth - 1.0).abs() < tolerance, "{what}: {found} against {truth}");
}

/// It crosses the front once where ambient light crosses twice: 1/(1 - R - A) of one component, with all that is
/// recycled; and the reference white does not see it.
#[test]
fn light_below_the_front_crosses_it_once() {
    for solver in SOLVERS {
        let panel = [FRONT, LOBE].concat();
        let both = run(&panel, "[lighting.front_light]\nilluminance_lx = 500\n", solver);
        let terms = &white(&both).terms;
        near(solver, terms.front_light.unwrap(), terms.diffuse / 0.97, 1e-9);
        let ambient = run(&panel, "", solver);
        assert_eq!(both.illuminant, ambient.illuminant);
        let brighter = white(&both).luminance_cd_m2 / white(&ambient).luminance_cd_m2;
        near(solver, brighter, 1.0 + terms.front_light.unwrap() / white(&ambient).Y, 1e-9);
        assert!(white(&ambient).terms.front_light.is_none());
    }
}

#[test]
fn a_distribution_is_light_from_there() {
    let guide = "[lighting.front_light]\nilluminance_lx = 500\ndistribution = \"data/synthetic-room.csv\"\n";
    let sky =
        "[[lighting.environment]]\nmodel = \"profile\"\nfile = \"data/synthetic-room.csv\"\nshare = 1\n";
    for (solver, tolerance) in SOLVERS.into_iter().zip([1e-4, 0.02]) {
        let panel = [FRONT, LOBE].concat();
        let above = run(&panel, sky, solver);
        let below = run(&panel, guide, solver);
        // By way of the pixel alone: below it the front mirrors nothing of it.
        let truth = white(&above).terms.environment[0] / 0.97;
        near(solver, white(&below).terms.front_light.unwrap(), truth, tolerance);
    }
}

/// A guide that leaks a fifth: a veil of t E_up/pi, and what the front sends back of it lights the panel.
#[test]
fn a_leak_is_a_veil_over_all_states() {
    for solver in SOLVERS {
        let of = |leak: &str| {
            run(
                &[FRONT, LOBE].concat(),
                &format!("[lighting.front_light]\nilluminance_lx = 500\n{leak}"),
                solver,
            )
        };
        let (tight, leaky) = (of(""), of("upward_leak = 0.2\n"));
        for state in ["white", "black"] {
            let of_guide = |result: &RunResult| {
                result.views[0].states.get(state).unwrap().value.terms.front_light.unwrap()
            };
            let truth = of_guide(&tight) * (1.0 + 0.25 * 0.02) + 0.25 * 0.97;
            near(state, of_guide(&leaky), truth, 1e-9);
        }
    }
}

/// Any layers: under a front that only absorbs, the panel is seen as without it, once through the front.
#[test]
fn over_any_layers_a_front_that_absorbs_is_crossed_once() {
    let layers = |sheet: &str| {
        format!(
            "[display]\nlayers = [{sheet}{{ kind = \"fresnel\" }}, {{ kind = \"slab\", optical_thickness = 1, anisotropy = 0.6, \
             albedo = 0.99, index = 1.5 }}]\n"
        )
    };
    let bare = run(&layers(""), "", SOLVERS[0]);
    let below = run(
        &layers("{ kind = \"sheet\", reflectance = 0, absorptance = 0.2 }, "),
        "[lighting.front_light]\nilluminance_lx = 500\n",
        SOLVERS[0],
    );
    near("layers", white(&below).terms.front_light.unwrap(), 0.8 * white(&bare).Y, 1e-6);
}

#[test]
fn what_is_refused() {
    let errors = |display: &str, lighting: &str| {
        let text = format!("{display}{PIXEL}[lighting.front_light]\n{lighting}\n");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
        let scenario = Scenario::from_text(&text, "light.toml", &folder, &[]);
        scenario.and_then(|scenario| scenario.resolve()).unwrap_err().to_string()
    };
    let guide = "illuminance_lx = 100\ndistribution = \"data/synthetic-room.csv\"";
    for (display, lighting, wanted) in [
        ("", guide, "needs a panel whose diffuser is a lobe"),
        (LOBE, "illuminance_lx = 0", "out of range"),
        (LOBE, "illuminance_lx = 100\nupward_leak = 1", "expected a number from 0 to .99"),
        (LOBE, "spectrum = \"D65\"", "`illuminance_lx` is missing"),
    ] {
        let error = errors(display, lighting);
        assert!(error.contains(wanted) && error.contains("light.toml:"), "{error}");
    }
}

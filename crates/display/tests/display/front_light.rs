//! Tests of front lights, alone and in addition to ambient light.
use std::path::Path;

use papilio_display::result::{RunResult, StateValues};
use papilio_scenario::Scenario;

const FRONT: &str = "[[display.front]]\nreflectance = 0.02\nabsorptance = 0.01\n";
const PIXEL: &str =
    "[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";
const LOBE: &str = "[display.diffuser]\nmodel = \"k-correlation\"\nwidth = 0.08\ntransmittance = 0.9\nregular_fraction = 0.1\n";
const SOLVERS: [&str; 2] = ["relative_error = 1e-5", "method = \"monte-carlo\"\npaths = 4096"];

fn scenario(display: &str, lighting: &str, solver: &str) -> String {
    format!(
        "[spectrum]\nstep_nm = 20\n{display}{PIXEL}[lighting]\n{lighting}\n[viewer]\ntheta_deg = 8\n[solver]\n{solver}\n"
    )
}

/// Runs a display in ambient light of 500 lx.
fn run(display: &str, lighting: &str, solver: &str) -> RunResult {
    run_in(display, &format!("illuminance_lx = 500\n{lighting}"), solver)
}

fn run_in(display: &str, lighting: &str, solver: &str) -> RunResult {
    let text = scenario(display, lighting, solver);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    let scenario = Scenario::from_text(&text, "light.toml", &folder, &[]).unwrap();
    crate::common::run(&scenario.resolve().unwrap().scene).unwrap()
}

fn white(result: &RunResult) -> &StateValues {
    &result.views[0].states.get("white").unwrap().value
}

fn near(what: &str, found: f64, truth: f64, tolerance: f64) {
    assert!((found / truth - 1.0).abs() < tolerance, "{what}: {found} against {truth}");
}

/// Front light crosses the front once and ambient light twice: the ratio is 1/(1 - R - A) for one component,
/// including all inter-reflections. The reference white is not lit by the front light.
#[test]
fn front_light_crosses_the_front_once() {
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
fn front_light_with_a_distribution_equals_an_environment() {
    let guide = "[lighting.front_light]\nilluminance_lx = 500\ndistribution = \"data/synthetic-room.csv\"\n";
    let sky =
        "[[lighting.environment]]\nmodel = \"profile\"\nfile = \"data/synthetic-room.csv\"\nshare = 1\n";
    for (solver, tolerance) in SOLVERS.into_iter().zip([1e-4, 0.02]) {
        let panel = [FRONT, LOBE].concat();
        let above = run(&panel, sky, solver);
        let below = run(&panel, guide, solver);
        // Only the contribution via the pixel: the front does not reflect light that starts below it.
        let truth = white(&above).terms.environment[0] / 0.97;
        near(solver, white(&below).terms.front_light.unwrap(), truth, tolerance);
    }
}

/// A light guide that leaks a fifth upwards adds a veil of t E_up/pi, and the part that the front reflects
/// lights the panel.
#[test]
fn upward_leak_adds_the_same_veil_to_all_states() {
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

/// General layers: under a front that only absorbs, the luminance is that without the front times one
/// transmittance.
#[test]
fn front_light_over_general_layers_crosses_an_absorbing_front_once() {
    let layers = |sheet: &str| {
        format!(
            "[display]\nlayers = [{sheet}{{ kind = \"fresnel\" }}, {{ kind = \"slab\", optical_thickness = 1, anisotropy = 0.6, \
             albedo = 0.99, index = 1.5 }}]\n"
        )
    };
    let bare = run(&layers(""), "", SOLVERS[0]);
    let below = run(
        &layers("{ kind = \"component\", reflectance = 0, absorptance = 0.2 }, "),
        "[lighting.front_light]\nilluminance_lx = 500\n",
        SOLVERS[0],
    );
    near("layers", white(&below).terms.front_light.unwrap(), 0.8 * white(&bare).Y, 1e-6);
}

/// Front light alone over a Lambertian panel without an interface: the panel reflects R E, of which the front
/// transmits t and reflects r in each round trip: Y = t R/(1 - R r) relative to a perfect white in the front
/// light.
#[test]
fn front_light_alone_equals_the_closed_form() {
    const PAPER: &str =
        "[display.diffuser]\nmodel = \"lambertian\"\ntransmittance = 0.8\n[display.glass]\nindex = 1\n";
    let dark = "diffuse = 0\n[lighting.front_light]\nilluminance_lx = 300\nspectrum = \"LED-B5\"\n";
    for solver in SOLVERS {
        let alone = run_in(&[FRONT, PAPER].concat(), dark, solver);
        for (state, reflectance) in [("white", 0.6), ("black", 0.05)] {
            let value = &alone.views[0].states.get(state).unwrap().value;
            let panel = 0.8 * reflectance * 0.8;
            let y = 0.97 * panel / (1.0 - 0.02 * panel);
            near(state, value.Y, y, 2e-3);
            near(state, value.luminance_cd_m2, y * 300.0 / std::f64::consts::PI, 2e-3);
            near("all of Y", value.terms.front_light.unwrap(), value.Y, 1e-12);
            assert_eq!(value.R_hemi, None);
            assert_eq!((&value.reflectance_factor, value.peak_nm), (&None, None));
        }
        // L*, a*, b* are relative to the display's white state, u'v' are those of the light.
        let white = white(&alone);
        let lab = [white.L_star, white.a_star, white.b_star].map(Option::unwrap);
        assert!((lab[0] - 100.0).abs() < 1e-9 && lab[1].abs() < 1e-9 && lab[2].abs() < 1e-9, "{lab:?}");
        near("u'", white.u_prime.unwrap(), alone.illuminant.u_prime, 1e-9);
        near("contrast", alone.views[0].metrics.contrast_ratio.unwrap(), 12.0, 0.02);
    }
}

/// The limit of weak ambient light is the result without ambient light.
#[test]
fn dark_environment_is_the_limit_of_a_dim_one() {
    let guide = "[lighting.front_light]\nilluminance_lx = 500\nupward_leak = 0.1\n";
    let panel = [FRONT, LOBE].concat();
    let alone = run_in(&panel, guide, SOLVERS[0]);
    let dim = run_in(&panel, &format!("illuminance_lx = 1e-6\n{guide}"), SOLVERS[0]);
    for (state, value) in alone.views[0].states.iter() {
        let dim = &dim.views[0].states.get(state).unwrap().value;
        near(state, value.value.luminance_cd_m2, dim.luminance_cd_m2, 1e-8);
        near(state, value.value.contrast.unwrap(), dim.contrast.unwrap(), 1e-8);
    }
    assert!(dim.views[0].states.get("white").unwrap().value.reflectance_factor.is_some());
}

/// A light guide whose IES file follows Lambert's law is diffuse.
#[test]
fn lambertian_ies_file_equals_a_diffuse_front_light() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<f64> = (0..=90).map(f64::from).collect();
    let line = |f: &dyn Fn(f64) -> f64| rows.iter().map(|v| f(*v).to_string()).collect::<Vec<_>>().join(" ");
    let candela = line(&|theta| 100.0 * theta.to_radians().cos().max(0.0));
    let file = format!(
        "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 91 1 1 2 0.1 0.1 0\n1 1 1\n{}\n0\n{candela}\n",
        line(&|v| v)
    );
    std::fs::write(folder.path().join("guide.ies"), file).unwrap();
    let guide = |more: &str| {
        let text = scenario(
            &[FRONT, LOBE].concat(),
            &format!("[lighting.front_light]\nilluminance_lx = 500\n{more}"),
            SOLVERS[0],
        );
        let scenario = Scenario::from_text(&text, "light.toml", folder.path(), &[]).unwrap();
        crate::common::run(&scenario.resolve().unwrap().scene).unwrap()
    };
    let (diffuse, file) = (guide(""), guide("distribution = \"guide.ies\"\n"));
    near("ies", white(&file).Y, white(&diffuse).Y, 1e-4);
}

#[test]
fn invalid_front_lights_are_refused() {
    let errors = |display: &str, lighting: &str| {
        let text = format!("{display}{PIXEL}[lighting.front_light]\n{lighting}\n");
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
        let scenario = Scenario::from_text(&text, "light.toml", &folder, &[]);
        scenario.and_then(|scenario| scenario.resolve()).unwrap_err().to_string()
    };
    let guide = "illuminance_lx = 100\ndistribution = \"data/synthetic-room.csv\"";
    let dark = format!("{PIXEL}[lighting]\nilluminance_lx = 0\n");
    let dark = Scenario::from_text(&dark, "light.toml", Path::new(""), &[]).unwrap().resolve().unwrap_err();
    assert!(dark.to_string().contains("only with a front light"), "{dark}");
    for (display, lighting, wanted) in [
        ("", guide, "computed only above a diffuser of the model"),
        (LOBE, "illuminance_lx = 0", "out of range"),
        (LOBE, "illuminance_lx = 100\nupward_leak = 1", "expected a number from 0 to 0.99"),
        (LOBE, "spectrum = \"D65\"", "`illuminance_lx` is missing"),
    ] {
        let error = errors(display, lighting);
        assert!(error.contains(wanted) && error.contains("light.toml:"), "{error}");
    }
}

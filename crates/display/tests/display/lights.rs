//! Tests of all kinds of ambient light, from the scenario to the result.
mod fields_of_view;
mod formulas;
mod third_road;
mod turned_maps;

use std::path::Path;

use papilio_display::result::RunResult;
use papilio_scenario::Scenario;

/// Name and keys of lights of all kinds, each with all of the illuminance.
const LIGHTS: &[(&str, &str)] = &[
    ("ring", "model = \"ring\"\ntheta_deg = 35\nwidth_deg = 10\nshare = 1"),
    ("cap", "model = \"cap\"\nto_deg = 15\nshare = 1"),
    ("trap", "model = \"cap\"\ntheta_deg = -8\nfrom_deg = 5\nshare = 1"),
    ("profile", "model = \"profile\"\nfile = \"data/synthetic-room.csv\"\nshare = 1"),
    ("overcast", "model = \"sky\"\nnumber = 1\nshare = 1"),
    (
        "clear",
        "model = \"sky\"\nnumber = 12\nsun_elevation_deg = 40\nsun_azimuth_deg = 30\nshare = 0.4\nsun_share = 0.6",
    ),
    ("map", "model = \"map\"\nfile = \"data/synthetic-office.hdr\"\nrotate_deg = 33\nshare = 1"),
    ("spectral map", "model = \"map\"\nfile = \"data/synthetic-hall.exr\"\nshare = 1"),
    ("tilted map", "model = \"map\"\nfile = \"data/synthetic-office.hdr\"\ntilt_deg = 30\nshare = 1"),
    (
        "luminaire",
        "model = \"luminaire\"\nfile = \"data/synthetic-panel.ies\"\nelevation_deg = 50\ndistance_m = 2\nshare = 1",
    ),
    (
        "upright",
        "model = \"sky\"\nnumber = 13\nsun_elevation_deg = 40\nsun_azimuth_deg = -60\nshare = 1\ntilt_deg = 90\n\
         ground_reflectance = 0.2",
    ),
];

const PAPER: &str = "[display.glass]\nindex = 1\n[display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\n\
    reflectance = { white = 0.6, black = 0.05 }\n";
const PANEL: &str = "[[display.front]]\nreflectance = 0.02\nabsorptance = 0.01\n[display.diffuser]\n\
    model = \"k-correlation\"\nwidth = 0.08\ntransmittance = 0.9\n[display.glass]\nindex = 1.5\n[display.pixel]\n\
    model = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";
const OVER_MIRROR: &str = "[display.diffuser]\nmodel = \"lambertian\"\ntransmittance = 0.8\n[display.glass]\nindex = 1.5\n\
    [display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.6, black = 0.05 }\n";

fn text(display: &str, environment: &str, solver: &str) -> String {
    format!(
        "title = \"light\"\n[spectrum]\nstep_nm = 20\n{display}[[lighting.environment]]\n{environment}\n[viewer]\n\
         theta_deg = 8\n[solver]\n{solver}\n"
    )
}

fn run(text: &str) -> RunResult {
    run_in(text, &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios"))
}

fn run_in(text: &str, folder: &Path) -> RunResult {
    let scenario = Scenario::from_text(text, "light.toml", folder, &[]).unwrap();
    crate::common::run(&scenario.resolve().unwrap().scene).unwrap()
}

/// What reflectances change within a step of the grid adds to the error by the light between its wavelengths.
#[test]
fn errors_by_the_step_add_up() {
    let mut scene = crate::common::scenario("indoor", &["spectrum.step_nm=20"]).unwrap().scene;
    let errors = |scene: &papilio_display::scene::Scene| {
        let result = crate::common::run(scene).unwrap();
        let of = |(name, state): (&str, &papilio_display::result::State)| {
            let error = state.interpolation_error.unwrap();
            (name.to_owned(), [error.X, error.Y, error.Z])
        };
        result.views[0].states.iter().map(of).collect::<Vec<_>>()
    };
    let of_light = errors(&scene);
    let within = [1e-3, 2e-3, 3e-3];
    scene.unresolved = vec![within; of_light.len()];
    for ((name, both), (_, light)) in errors(&scene).into_iter().zip(of_light) {
        for k in 0..3 {
            let expected = light[k] + within[k];
            assert!(light[k] > 1e-6 && (both[k] - expected).abs() < 1e-15, "{name} {k}: {both:?} {light:?}");
        }
    }
}

#[test]
fn lambertian_display_has_its_reflectance_under_every_light() {
    let diffuse = "model = \"cap\"\nshare = 1";
    let even = run(&text(OVER_MIRROR, diffuse, ""));
    let even = even.views[0].states.get("white").unwrap().value.Y;
    for (name, light) in LIGHTS {
        let white = |display: &str| {
            let result = run(&text(display, light, ""));
            result.views[0].states.get("white").unwrap().value.Y
        };
        let paper = white(PAPER);
        assert!((paper - 0.6).abs() < 1e-6, "{name}: {paper}");
        let seen = white(OVER_MIRROR);
        assert!((seen / even - 1.0).abs() < 1e-5, "{name}: {seen} against {even}");
    }
}

/// Both solvers agree, the contributions sum to Y, and the energy balance closes.
#[test]
fn solvers_agree_under_every_light() {
    for (name, light) in LIGHTS {
        let adding = run(&text(PANEL, light, "relative_error = 1e-4"));
        let walk = run(&text(PANEL, light, "method = \"monte-carlo\"\npaths = 16384"));
        for state in ["white", "black"] {
            let [adding, walk] = [&adding, &walk].map(|result| &result.views[0]);
            let (a, w) = (adding.states.get(state).unwrap(), walk.states.get(state).unwrap());
            let z = (a.value.Y - w.value.Y) / w.standard_error.Y.hypot(1e-4 * a.value.Y);
            assert!(
                z.abs() < 4.0,
                "{name}, {state}: {} against {} +- {}",
                a.value.Y,
                w.value.Y,
                w.standard_error.Y
            );
            assert!(w.standard_error.Y < 0.03 * w.value.Y, "{name}, {state}: {}", w.standard_error.Y);
            let terms = &a.value.terms;
            let parts = terms.environment.iter().chain(&terms.directed).sum::<f64>();
            assert!((parts + terms.diffuse + terms.front_reflection - a.value.Y).abs() < 1e-12, "{name}");
            assert_eq!(terms.environment.len(), usize::from(*name != "luminaire"));
            for ledger in [adding, walk].map(|view| view.ledger.get(state).unwrap()) {
                let taken = &ledger.absorbed;
                let absorbed = taken.front + taken.diffuser + taken.glass + taken.pixel + taken.inactive;
                assert!((ledger.returned + absorbed + ledger.unaccounted - 1.0).abs() < 1e-9, "{name}");
            }
        }
    }
}

/// A cap around any direction equals a disc, and a sphere with a trap equals the sphere minus a disc.
#[test]
fn sphere_with_a_trap_lacks_the_light_of_a_disc() {
    let solver = "relative_error = 1e-5";
    let white = |display: &str, lighting: &str| {
        let text = format!(
            "title = \"light\"\n[spectrum]\nstep_nm = 20\n{display}{lighting}[viewer]\ntheta_deg = 8\n[solver]\n{solver}\n"
        );
        run(&text).views[0].states.get("white").unwrap().value.Y
    };
    let cap = |keys: &str| format!("[[lighting.environment]]\nmodel = \"cap\"\n{keys}share = 1\n");
    let disc = "[[lighting.directed]]\ntheta_deg = -8\nradius_deg = 5\nshare = 1\n";
    let of_disc = white(PANEL, disc);
    let of_cap = white(PANEL, &cap("theta_deg = -8\nto_deg = 5\n"));
    assert!((of_cap / of_disc - 1.0).abs() < 1e-4, "{of_cap} against {of_disc}");
    let (trapped, even) = (white(PANEL, &cap("theta_deg = -8\nfrom_deg = 5\n")), white(PANEL, &cap("")));
    let taken = 5.0_f64.to_radians().sin().powi(2) * 8.0_f64.to_radians().cos();
    let truth = (even - taken * of_disc) / (1.0 - taken);
    assert!((trapped / truth - 1.0).abs() < 1e-4, "{trapped} against {truth}");
}

/// The image of the trap fills the view of a mirror at 8 deg.
#[test]
fn specular_excluded_geometry_excludes_the_mirror_image() {
    let mirror = "[display.glass]\nindex = 1.5\nsurface = \"fresnel\"\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\n\
        reflectance = { white = 0.6, black = 0.05 }\n";
    let of = |preset: &str| {
        let result = run(&format!("[spectrum]\nstep_nm = 20\n{mirror}[lighting]\npreset = \"{preset}\"\n"));
        result.views[0].states.get("white").unwrap().value.Y
    };
    assert_eq!(of("d8-excluded"), 0.0);
    assert!(of("d8-included") > 0.5);
}

/// The luminance by direction, as drawn in figures, integrates to the illuminance on the display.
#[test]
fn luminance_by_direction_integrates_to_the_illuminance() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
    for (name, light) in LIGHTS {
        let scenario = Scenario::from_text(&text(PAPER, light, ""), "light.toml", &folder, &[]).unwrap();
        let room = papilio_display::ambient_light(&scenario.resolve().unwrap().scene).unwrap();
        let columns = room.phi_deg.len();
        let mut lux: f64 = room.directed.iter().map(|lamp| lamp.illuminance_lx).sum();
        for (row, theta) in room.luminance_cd_m2.chunks_exact(columns).zip(&room.theta_deg) {
            // The trapezoidal rule over inclination.
            let weight = if *theta == 90.0 { 0.5 } else { 1.0 };
            let (sin, cos) = theta.to_radians().sin_cos();
            let step = 1.0_f64.to_radians() * std::f64::consts::TAU / columns as f64;
            lux += row.iter().sum::<f64>() * weight * sin * cos * step;
        }
        assert!((lux / 500.0 - 1.0).abs() < 0.02, "{name}: {lux}");
    }
}

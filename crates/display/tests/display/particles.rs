//! Slabs of particles whose polarised light is followed: closed forms, adding where particles are too few to count, and what is refused.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::{BrdfGrid, ConeGrid, Control, DisplayError};

use crate::common::{run, scenario};

/// A bare substrate of n = 4 below a film as the pixel.
const FILM: &str = "display.pixel={ model = \"film\", substrate = { n = 4, k = 0 }, area = { red = 1.0 }, gap_nm = { red = 120, dark = 0 }, \
    default_states = false, states = { white = { red = 1.0 }, black = { red = 0.0 } }, \
    film = [{ material = 2.0, thickness_nm = 60 }, { material = \"air\", thickness_nm = \"gap\" }] }";

const GRID: [&str; 2] = ["spectrum.range_nm=[500,600]", "spectrum.step_nm=50"];

fn of(sets: &[&str]) -> Scene {
    scenario("rayleigh-film", &[&GRID[..], sets].concat()).unwrap().scene
}

/// Luminance factors of the states, with their standard errors.
fn ys(result: &RunResult) -> Vec<(f64, f64)> {
    result.views[0].states.0.iter().map(|(_, state)| (state.value.Y, state.standard_error.Y)).collect()
}

/// Light that a thin cloud scatters once by 90 deg vibrates across the scattering plane, and is seen through a polariser there with twice the
/// brightness of a white that is seen through it, too.
#[test]
fn thin_cloud_is_polarised_across_the_scattering_plane() {
    let cloud = "display.layers=[{ kind = \"slab\", optical_thickness = 0.01, particles = { kind = \"rayleigh\" }, faces = false }]";
    let y = |polariser: &str| ys(&run(&of(&[cloud, polariser, "solver.paths=40000"])).unwrap())[0].0;
    let [mu, mu0] = [30.0_f64, 60.0].map(|theta| theta.to_radians().cos());
    let once = PI * 3.0 / (16.0 * PI) * -(-0.01 * (1.0 / mu + 1.0 / mu0)).exp_m1() / (mu + mu0);
    let [across, along] = ["viewer.polariser=s", "viewer.polariser=p"].map(y);
    // Light that is scattered again: some per cent of it, in both.
    assert!((across / (2.0 * once) - 1.0).abs() < 0.04, "{across} {once}");
    assert!(along < 0.03 * across, "{along} {across}");
}

/// With too few particles to count, a display is that which adding computes, with s and p kept apart to a film pixel: a polariser at an angle below a bare
/// face, a coating, and light between s and p whose phase both change.
#[test]
fn display_with_hardly_any_particles_is_that_of_adding() {
    let few = "{ kind = \"slab\", optical_thickness = 1e-6, particles = { kind = \"mie\", radius_um = 0.2, index = 1.8 }, index = 1.5 }";
    let clear = "{ kind = \"medium\", index = 1.5 }";
    let coating = "{ kind = \"coating\", film = [{ material = 1.38, thickness_nm = 100 }] }, ";
    let pane = "{ kind = \"medium\", index = 1.5 }, { kind = \"medium\", index = 1.0 }, ";
    let uniform = "lighting={ diffuse = 1 }";
    let lamp = "lighting={ diffuse = 0, directed = [{ theta_deg = 65, phi_deg = 180, radius_deg = 10, share = 1, \
                polarisation = { degree = 1, angle_deg = 40 } }] }";
    for (above, lighting, polariser) in [
        (pane, uniform, "viewer.polariser=30"),
        (coating, uniform, "viewer.field_deg=0"),
        (coating, lamp, "viewer.polariser=30"),
        (coating, lamp, "viewer.polariser=-50"),
    ] {
        let light = [lighting, "viewer.theta_deg=65", FILM, polariser];
        let polariser_alone: &[&str] =
            if polariser == "viewer.field_deg=0" { &["viewer={ theta_deg = 65 }"] } else { &[] };
        let layers = |medium: &str| format!("display.layers=[{above}{medium}]");
        let with = |layers: &str, method: &str| {
            ys(&run(&of(&[&light[..], &[layers, method], polariser_alone].concat())).unwrap())
        };
        let found = with(&layers(few), "solver.paths=10000");
        let truth = with(&layers(clear), "solver={ method = \"adding\" }");
        for ((y, error), (truth, _)) in found.into_iter().zip(truth) {
            let case = format!("{above}{lighting}{polariser}: {y} {error} {truth}");
            assert!(
                (y - truth).abs() < 4.0 * error + 1e-5 * truth.max(1.0) && error < 0.02 * truth.max(1.0),
                "{case}"
            );
        }
    }
}

/// Films below particles as the pixel, and as a coating of black glass: at the edge of their stop band, where the phase between s and p changes fast.
#[test]
fn films_below_particles_are_the_same_as_pixel_and_as_coating() {
    let slab = "{ kind = \"slab\", optical_thickness = 0.2, particles = { kind = \"mie\", radius_um = 0.2, index = 1.8 }, index = 1.5 }";
    let bands = "{ material = 2.3, thickness_nm = 70 }, { material = 1.38, thickness_nm = 110 }";
    let films = [bands; 3].join(", ");
    let pixel = format!(
        "display.pixel={{ model = \"film\", substrate = {{ n = 4, k = 0 }}, area = {{ red = 1.0 }}, gap_nm = {{ red = 120, dark = 0 }}, \
         default_states = false, states = {{ white = {{ red = 1.0 }} }}, film = [{films}, {{ material = \"air\", thickness_nm = \"gap\" }}] }}"
    );
    let black = "display.pixel={ model = \"uniform\", kind = \"lambertian\", reflectance = { white = 0.0 } }";
    let coated = format!(
        "display.layers=[{slab}, {{ kind = \"coating\", film = [{films}, {{ material = \"air\", thickness_nm = 120 }}] }}, {{ kind = \"medium\", index = 4 }}]"
    );
    let bare = format!("display.layers=[{slab}]");
    let lamp = "lighting={ diffuse = 0, directed = [{ theta_deg = 50, phi_deg = 180, radius_deg = 10, share = 1, \
                polarisation = { degree = 1, angle_deg = 45 } }] }";
    for polariser in ["viewer.polariser=45", "viewer.polariser=-45"] {
        let seen = |display: [&str; 2]| {
            let sets =
                [&display[..], &[lamp, "viewer.theta_deg=50", polariser, "solver.paths=100000"]].concat();
            let result = run(&of(&sets)).unwrap();
            let state = &result.views[0].states.0[0].1;
            (state.value.radiance.clone(), state.standard_error.radiance.clone())
        };
        let ((as_pixel, error), (as_coating, other)) = (seen([&bare, &pixel]), seen([&coated, black]));
        let brightest = as_pixel.iter().fold(0.0_f64, |most, radiance| most.max(*radiance));
        for (k, (a, b)) in as_pixel.iter().zip(&as_coating).enumerate() {
            let error = error[k].hypot(other[k]);
            assert!(
                (a - b).abs() < 4.5 * error && error < 0.01 * brightest,
                "{polariser} {k}: {a} {b} {error}"
            );
        }
    }
}

/// Adding, and what computes more than colours of views, says that it takes scattered light as unpolarised; `auto` takes paths.
#[test]
fn particles_are_for_runs_by_paths() {
    let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
    let refused = |error: DisplayError| assert!(matches!(error, DisplayError::Particles { .. }), "{error}");
    refused(run(&of(&["solver={ method = \"adding\" }"])).unwrap_err());
    refused(run(&of(&["solver.approximation=unpolarised"])).unwrap_err());
    refused(papilio_display::cone(&of(&[]), ConeGrid::default(), &control).unwrap_err());
    refused(papilio_display::brdf(&of(&[]), BrdfGrid::even(30.0), &control).unwrap_err());
    let result = run(&of(&["solver={ method = \"auto\", relative_error = 0.05 }"])).unwrap();
    assert_eq!(result.solver.method, "monte-carlo");
    let ledger = &result.views[0].ledger.0[0].1;
    // Scattered back, or absorbed below.
    assert!(ledger.returned > 0.05 && ledger.absorbed.pixel > 0.6, "{ledger:?}");
}

//! Colour filters above liquid crystals below flat layers: against the reference matrices of whole stacks below glass that absorbs, and paths.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::Control;
use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::spatial::{crosstalk, walk};
use papilio_scenario::Scenario;

use crate::common::run;
use crate::polarised_crystals::{CELLS, whole_below_gray};

const FRESNEL: &str = "{ kind = \"medium\", index = 1.5, thickness_mm = 0.3 }";
const COVER: &str = "{ kind = \"medium\", index = 1.52, thickness_mm = 0.5 }, { kind = \"medium\", index = 1.0, thickness_mm = 0.1 }, \
    { kind = \"medium\", index = 1.5, thickness_mm = 0.3 }";

/// Cells below stripes of these transmittances and below these layers.
fn below(layers: &str, filter: &str, more: &[&str]) -> Scene {
    let (_, stack) = CELLS.split_once('=').unwrap();
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"liquid-crystal\"\n\
         substrate = \"Ag\"\nstack = {stack}\n{filter}[viewer]\nfield_deg = 0\n"
    );
    let sets: Vec<String> = more.iter().map(|set| (*set).to_owned()).collect();
    Scenario::from_text(&text, "below.toml", Path::new(""), &sets).unwrap().resolve().unwrap().scene
}

/// Three stripes in a period of 90 um; red, a third white, has one white stripe.
fn filter(height_um: f64, transmittance: [f64; 3]) -> String {
    let [red, green, blue] = transmittance;
    format!(
        "[display.matrix]\npitch_um = 90\n[display.matrix.states]\n\
         white = {{ red = \"white\", green = \"white\", blue = \"white\" }}\n\
         red = {{ red = \"white\", green = \"black\", blue = \"black\" }}\n\
         black = {{ red = \"black\", green = \"black\", blue = \"black\" }}\n\
         [display.matrix.filter]\nheight_um = {height_um}\ntransmittance = {{ red = {red}, green = {green}, blue = {blue} }}\n"
    )
}

/// Spectra of a state of a view.
fn spectrum(result: &RunResult, view: usize, state: &str) -> Vec<f64> {
    result.views[view].states.get(state).unwrap().value.reflectance_factor.clone().unwrap()
}

/// What is seen of unpolarised light in each direction, below gray glass that transmits a fraction along the normal.
fn expected(scene: &Scene, direction: (f64, f64), state: usize, transmittance: f64) -> Vec<f64> {
    let of = |bin| whole_below_gray(scene, [direction.0, direction.1], (state, bin), transmittance)[0][0];
    (0..scene.grid.len()).map(of).collect()
}

fn assert_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance, "{what}: {found} {expected}");
    }
}

/// A filter without colour and parts absorbs as glass does, wherever it is: through all orders between the cell and one or three faces, by both solvers,
/// with the phase between s and p.
#[test]
fn gray_filter_is_gray_glass() {
    let views = ["viewer.theta_deg=[0,65]", "viewer.phi_deg=[33,213]"];
    // White is the same at all places.
    let by_paths = ["solver.method=monte-carlo", "solver.paths=1024"];
    let cases = [
        (FRESNEL, &["solver.method=adding"][..], 1e-5),
        (FRESNEL, &by_paths, 1e-3),
        (COVER, &by_paths, 1e-3),
    ];
    for (layers, solver, tolerance) in cases {
        let scene = below(layers, &filter(40.0, [0.7; 3]), &[&views[..], solver].concat());
        let method = solver[0].split('=').next_back().unwrap();
        let found = run(&scene).unwrap();
        assert_eq!(found.solver.method, method);
        for (view, direction) in scene.viewer.directions().enumerate() {
            let expected = expected(&scene, direction, 0, 0.7);
            assert_near(method, &spectrum(&found, view, "white"), &expected, tolerance);
        }
    }
}

/// Oblique light that passes the filter a third of a period before and after it meets the pixel, and returns from the face to the same place of another
/// period: each stripe is one below gray glass of the parts on both of its sides.
#[test]
fn oblique_light_passes_other_parts_of_the_filter() {
    const T: [f64; 3] = [0.8, 0.5, 0.2];
    let sine: f64 = 0.5;
    let height_um = 30.0 / (sine / (2.25 - sine * sine).sqrt());
    let layers = format!("{{ kind = \"medium\", index = 1.5, thickness_mm = {} }}", 1.5e-3 * height_um);
    let scene = below(&layers, &filter(height_um, T), &["viewer.theta_deg=30", "solver.method=adding"]);
    let found = run(&scene).unwrap();
    for (state, of_stripes) in [("white", [0, 0, 0]), ("red", [0, 1, 1])] {
        let stripes = [0, 1, 2].map(|k| {
            let both = T[(k + 1) % 3] * T[(k + 2) % 3];
            expected(&scene, (30.0, 0.0), of_stripes[k], both.sqrt())
        });
        let mean: Vec<f64> =
            (0..scene.grid.len()).map(|bin| stripes.iter().map(|one| one[bin]).sum::<f64>() / 3.0).collect();
        assert_near(state, &spectrum(&found, 0, state), &mean, 1e-5);
    }
}

/// A clear filter changes nothing: with a front of screen, too, and in the light of a lamp.
#[test]
fn clear_filter_leaves_cells_as_they_are() {
    let sheet = "{ kind = \"component\", reflectance = 0.1 }, { kind = \"medium\", index = 1.0, thickness_mm = 0.2 }, ";
    let lamp = "lighting={ illuminance_lx = 500, spectrum = \"D65\", diffuse = 0.5, directed = [{ theta_deg = 35, phi_deg = 20, share = 0.5 }] }";
    let views = [lamp, "viewer.theta_deg=[0,50]", "viewer.phi_deg=[70]", "solver.method=adding"];
    for front in ["", sheet] {
        let layers = format!("{front}{FRESNEL}");
        let [with, without] = [filter(40.0, [1.0; 3]), String::new()].map(|filter| {
            let result = run(&below(&layers, &filter, &views)).unwrap();
            let image = result.views[0].states.get("white").unwrap().value.specular.clone();
            ([0, 1].map(|view| spectrum(&result, view, "white")), image)
        });
        for (with, without) in with.0.iter().zip(&without.0) {
            assert_near(front, with, without, 1e-12);
        }
        assert_near("image", &with.1, &without.1, 1e-9);
    }
}

/// A filter at a height, below a face and a front, in a round lamp, diffuse light and a field of view: both solvers.
#[test]
fn solvers_agree_below_a_front() {
    let layers = format!(
        "{{ kind = \"component\", reflectance = 0.15 }}, {{ kind = \"medium\", index = 1.0, thickness_mm = 0.07 }}, {FRESNEL}"
    );
    let lamp = "lighting={ illuminance_lx = 500, spectrum = \"D65\", diffuse = 0.6, \
        directed = [{ theta_deg = -35, phi_deg = 20, share = 0.4, radius_deg = 4 }] }";
    let views =
        [lamp, "viewer.theta_deg=[35]", "viewer.phi_deg=[20]", "viewer.field_deg=1", "spectrum.step_nm=300"];
    let of = |more: &[&str]| {
        run(&below(&layers, &filter(40.0, [0.8, 0.5, 0.2]), &[&views[..], more].concat())).unwrap()
    };
    let adding = of(&["solver.method=adding", "solver.relative_error=0.01"]);
    let paths = of(&["solver.method=monte-carlo", "solver.paths=2048"]);
    for ((name, adding), (_, paths)) in adding.views[0].states.iter().zip(paths.views[0].states.iter()) {
        let (found, of_paths, error) = (adding.value.Y, paths.value.Y, paths.standard_error.Y);
        assert!(
            (found - of_paths).abs() < 4.5 * error + 1e-3 * found,
            "{name}: {found} {of_paths} ({error})"
        );
    }
}

/// Sharpness by paths below a face: of light that has met the cell once, and of all light by the number of its meetings. Gray filters, by adding, tell how much
/// light has met it how often. Where the way to the face and back is a period, modulation is complete.
#[test]
fn sharpness_by_paths_counts_meetings_with_the_cell() {
    let view = ["viewer.theta_deg=40", "viewer.phi_deg=0"];
    let sine = 40_f64.to_radians().sin();
    let y = |x: f64| {
        let transmittance = x.powf(0.5 * (1.0 - sine * sine / 2.25).sqrt());
        let set = [&view[..], &["solver.method=adding"]].concat();
        let result = run(&below(FRESNEL, &filter(40.0, [transmittance; 3]), &set)).unwrap();
        let state = &result.views[0].states.get("white").unwrap().value;
        state.Y - state.terms.front_reflection
    };
    let scene = below(FRESNEL, "", &[&view[..], &["solver.method=monte-carlo"]].concat());
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let period_mm = 2.0 * 0.3 * sine / (2.25 - sine * sine).sqrt();
    let found = &walk::transfer(&scene, &[[1.0 / period_mm, 0.0]], 2048, &control).unwrap()[0];
    let (_, state) = found.states.iter().find(|(name, _)| *name == "white").unwrap();
    assert!((state.response.otf[0][0].value - 1.0).abs() < 1e-9, "{:?}", state.response.otf);
    let (small, step) = (1e-3, 0.02);
    let once = 2.0 * y(small) / small - y(2.0 * small) / (2.0 * small);
    let all = (3.0 * y(1.0) - 4.0 * y(1.0 - step) + y(1.0 - 2.0 * step)) / (2.0 * step);
    for (found, expected) in [(state.once.luminous, once), (state.response.luminous, all)] {
        let error = 4.5 * found.standard_error + 1e-3 * expected;
        assert!((found.value - expected).abs() < error, "{found:?} {expected}");
    }
    assert!(all > 1.01 * once);
}

/// Shares and colours of fine figures below a filter: both solvers.
#[test]
fn crosstalk_below_a_filter_agrees() {
    let sets = ["viewer.theta_deg=35", "viewer.phi_deg=20", "spectrum.step_nm=150"];
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let of = |more: &[&str]| {
        let scene = below(FRESNEL, &filter(40.0, [0.8, 0.5, 0.2]), &[&sets[..], more].concat());
        crosstalk(&scene, "n", &control).unwrap().views.swap_remove(0)
    };
    let (adding, paths) =
        (of(&["solver.method=adding"]), of(&["solver.method=monte-carlo", "solver.paths=4096"]));
    let mut compared = 0;
    for (adding, paths) in adding.patterns.iter().zip(&paths.patterns) {
        let (Some(a), Some(b)) = (adding.values.contrast_ratio, paths.values.contrast_ratio) else {
            continue;
        };
        let error = paths.error.contrast_ratio.unwrap();
        assert!((a - b).abs() < 4.5 * error + 2e-3 * a, "{}: {a} {b} ({error})", adding.name.name());
        compared += 1;
    }
    assert!(compared >= 3, "{compared}");
}

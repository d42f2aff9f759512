//! Liquid-crystal pixels from the scenario to the result, in all azimuths.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::pixel::scan_at;
use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::{BrdfGrid, Control, DisplayError};
use papilio_optics::lobe::Lobe;
use papilio_scenario::Scenario;
use papilio_spectra::{Grid, material};
use papilio_testing::sized;

use crate::common::{prepared_for, run, scenario, walked};

const TWISTED: &str = "display.pixel.stack=[{ kind = \"polariser\", axis_deg = 20 }, \
    { kind = \"retarder\", axis_deg = 60, retardance_nm = 150, nz = 0.4 }, \
    { kind = \"cell\", gap_um = 2.0, n_o = 1.5, n_e = 1.62, rub_deg = 10, twist_deg = 50, slices = 12, \
      states = { white = { tilt_deg = 5 }, black = { tilt_deg = 60 } } }]";

fn twisted(more: &[&str]) -> Scene {
    let common = [TWISTED, "spectrum.range_nm=[400,700]", "spectrum.step_nm=100", "viewer.field_deg=0"];
    scenario("mip-lcd", &[&common, more].concat()).unwrap().scene
}

/// Spectra of the reflectance factor, `[view][state][wavelength]`.
fn spectra(scene: &Scene) -> Vec<Vec<Vec<f64>>> {
    let result = run(scene).unwrap();
    let view = |view: &papilio_display::result::View| {
        view.states.iter().map(|(_, state)| state.value.reflectance_factor.clone().unwrap()).collect()
    };
    result.views.iter().map(view).collect()
}

/// In diffuse light a bare panel shows the pixel at the mirror angle: the table of harmonics over azimuth against the pixel
/// itself, in an ideal antireflection surface. (Below a face, see `polarised_crystals`.)
#[test]
fn views_at_any_azimuth_see_the_pixel_at_that_azimuth() {
    let angles = ["viewer.theta_deg=[0,25,50,75]", "viewer.phi_deg=[0,33,120,213,300]"];
    let scene = twisted(&[&angles[..], &["display.glass.surface=ideal-ar"]].concat());
    let found = spectra(&scene);
    for (at, (theta_deg, phi_deg)) in scene.viewer.directions().enumerate() {
        let alone = scan_at(&scene, &[theta_deg], &[phi_deg]).unwrap();
        for ((_, pixel), seen) in alone.states.iter().zip(&found[at]) {
            for (pixel, seen) in pixel.iter().zip(seen) {
                assert!((seen - pixel).abs() < 5e-4, "{theta_deg} {phi_deg}: {seen} {pixel}");
            }
        }
    }
}

/// Unpolarised reflectance is the same at opposite azimuths (reciprocity), and this pixel does depend on azimuth.
#[test]
fn azimuths_matter_and_opposite_ones_are_equal() {
    let scene = twisted(&[]);
    let at = |phi_deg: f64| scan_at(&scene, &[50.0], &[phi_deg]).unwrap().states.swap_remove(0).1;
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference(&at(70.0), &at(250.0)) < 1e-10);
    assert!(difference(&at(70.0), &at(-70.0)) > 1e-3);
}

/// The two solvers, with a field of view and a lamp of some size, which both average over azimuth.
#[test]
fn monte_carlo_agrees_with_adding() {
    let common = [
        TWISTED,
        "spectrum.range_nm=[400,700]",
        "spectrum.step_nm=100",
        "viewer.theta_deg=[0,40]",
        "viewer.phi_deg=[0,70]",
        "viewer.field_deg=20",
        "solver.relative_error=0.002",
    ];
    let adding = spectra(&scenario("mip-lcd", &common).unwrap().scene);
    let paths = spectra(&walked("mip-lcd", &common).unwrap().scene);
    for (adding, paths) in adding.iter().flatten().flatten().zip(paths.iter().flatten().flatten()) {
        assert!((adding - paths).abs() < 0.01 * adding + 1e-4, "{adding} {paths}");
    }
}

/// Half of the light is polarised, and the square of the cosine of the retardance of it returns from an almost ideal mirror.
#[test]
fn circular_polariser_leaves_the_square_of_the_cosine() {
    let scene = scenario(
        "circular-polariser",
        &[
            "display.pixel.substrate={ n = 0.001, k = 900 }",
            "display.pixel.stack=[{ kind = \"polariser\", axis_deg = 0, transmittance = 0.49999, extinction = 1e-5, thickness_um = 400 }, \
             { kind = \"retarder\", axis_deg = 45, retardance_nm = 137.5, thickness_um = 400 }]",
            "spectrum.range_nm=[450,650]",
            "spectrum.step_nm=50",
        ],
    )
    .unwrap()
    .scene;
    let found = scan_at(&scene, &[0.0], &[0.0]).unwrap().states.swap_remove(0).1;
    for (k, expected) in [(0, 0.058_489), (2, 0.0), (4, 0.028_636)] {
        assert!((found[k] - expected).abs() < 2e-3 * expected + 2e-4, "{}: {}", k, found[k]);
    }
}

/// Spectra of a stack over silver by inclination, one after the other.
fn over_silver(stack: &str, thetas_deg: &[f64], range: &str) -> Vec<f64> {
    let stack = format!("display.pixel.stack=[{stack}]");
    let changes = [&stack, "display.pixel.substrate=Ag", range, "spectrum.step_nm=10"];
    let scene = scenario("circular-polariser", &changes).unwrap().scene;
    scan_at(&scene, thetas_deg, &[0.0]).unwrap().states.swap_remove(0).1
}

/// So thick that its faces reflect little of the light that it absorbs: what they reflect to a cell interferes, 4e-3 at 20 um.
const POLARISER: &str =
    "{ kind = \"polariser\", axis_deg = 0, transmittance = 0.49, extinction = 1e-4, thickness_um = 4000 }";

/// The reflector below a polariser reflects as below a transparent medium of its index; and a retarder of retardance 0 between the
/// polariser and a reflector, a cell or a helix changes nothing.
#[test]
fn layers_below_a_polariser_are_as_below_a_retarder_without_retardance() {
    let nothing = "{ kind = \"retarder\", axis_deg = 30, retardance_nm = 0 }";
    let cell = "{ kind = \"cell\", gap_um = 3, n_o = 1.5, n_e = 1.6, rub_deg = 40, twist_deg = 70, pretilt_deg = 3 }";
    let helix = "{ kind = \"cholesteric\", pitch_nm = 350, handedness = \"left\", n_o = 1.5, n_e = 1.65, thickness_um = 3 }";
    let range = "spectrum.range_nm=[540,560]";
    for below in ["", cell, helix] {
        let stack = |between: &str| -> Vec<f64> {
            let layers = [POLARISER, between, below].into_iter().filter(|layer| !layer.is_empty());
            over_silver(&layers.collect::<Vec<_>>().join(", "), &[0.0, 30.0], range)
        };
        for (direct, between) in stack("").iter().zip(stack(nothing)) {
            assert!((direct / between - 1.0).abs() < 1e-4, "{below}: {direct} {between}");
        }
    }
    // The light goes twice through 2 T/(1 + extinction), half of it, onto r = (n - n_Ag)/(n + n_Ag).
    let found = over_silver(POLARISER, &[0.0], range);
    let silver = material("Ag").unwrap().on(&Grid::new(540.0, 560.0, 10.0).unwrap()).unwrap();
    for (found, n) in found.iter().zip(silver) {
        let reflectance = ((1.5 - n) / (1.5 + n)).norm_sqr();
        let expected = 0.5 * (0.98_f64 / 1.0001).powi(2) * reflectance;
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
}

/// The default number of slices of cells that turn far, against 2000.
#[test]
fn default_slices_of_a_cell_equal_many() {
    for (cell, theta_deg) in [
        ("gap_um = 6, n_o = 1.5, n_e = 1.63, twist_deg = 240", 40.0),
        ("gap_um = 4, n_o = 1.5, n_e = 1.6, twist_deg = 240, pretilt_deg = 10", 0.0),
        ("gap_um = 20, n_o = 1.5, n_e = 1.63, twist_deg = 360", 0.0),
    ] {
        let [own, many] = ["", ", slices = 2000"].map(|slices| {
            let stack = format!("{POLARISER}, {{ kind = \"cell\", {cell}{slices} }}");
            // The sensitivity of Y is that of its middle, 555 nm.
            let found = over_silver(&stack, &[theta_deg], "spectrum.range_nm=[460,650]");
            found.iter().enumerate().map(|(k, r)| r * (-((k as f64 - 9.5) / 6.0).powi(2)).exp()).sum::<f64>()
        });
        assert!((own / many - 1.0).abs() < 1e-4, "{cell}: {own} {many}");
    }
}

/// Helices of a long and of a short pitch, against cells of 2000 slices that turn as far.
#[test]
fn a_cholesteric_layer_is_a_cell_that_turns_as_far() {
    for (pitch_nm, turns, theta_deg) in [(20_000.0, 0.5, 20.0), (100_000.0, 0.2, 60.0), (550.0, 2.0, 30.0)] {
        let thickness_um = 1e-3 * pitch_nm * turns;
        let index = "n_o = 1.5, n_e = 1.7";
        let helix = format!(
            "{{ kind = \"cholesteric\", pitch_nm = {pitch_nm}, handedness = \"left\", {index}, thickness_um = {thickness_um} }}"
        );
        let cell = format!(
            "{{ kind = \"cell\", gap_um = {thickness_um}, {index}, twist_deg = {}, slices = 2000 }}",
            360.0 * turns
        );
        let range = "spectrum.range_nm=[540,560]";
        let [helix, cell] =
            [helix, cell].map(|layer| over_silver(&format!("{POLARISER}, {layer}"), &[theta_deg], range));
        for (helix, cell) in helix.iter().zip(&cell) {
            assert!((helix - cell).abs() < 2e-4, "{pitch_nm}: {helix} {cell}");
        }
    }
}

/// The error of slices falls with the square of their number, so that 1000 and 2000 give the limit. Fewer slices have their error in a note.
#[test]
fn cells_that_turn_by_up_to_3600_deg_have_slices_enough() {
    for (gap_um, twist_deg, n_e) in
        [(10.0, 3600.0, 1.7), (3.0, 2700.0, 1.7), (7.0, 3300.0, 1.8), (10.0, 1000.0, 1.7)]
    {
        let of = |slices: &str| {
            let stack = format!(
                "display.pixel.stack=[{{ kind = \"polariser\", axis_deg = 10, transmittance = 0.45, extinction = 1e-3 }}, \
                 {{ kind = \"cell\", gap_um = {gap_um}, n_o = 1.5, n_e = {n_e}, rub_deg = 15, twist_deg = {twist_deg}{slices} }}]"
            );
            let angles = [
                "viewer.theta_deg=[0,40]",
                "viewer.phi_deg=10",
                "display.pixel.substrate={ n = 0.05, k = 3.6 }",
            ];
            let light = [
                "spectrum.range_nm=[450,650]",
                "spectrum.step_nm=20",
                "lighting={ diffuse = 1.0, spectrum = \"E\" }",
            ];
            let scenario =
                scenario("circular-polariser", &[&[&*stack][..], &angles, &light].concat()).unwrap();
            let seen = run(&scenario.scene).unwrap();
            let y: Vec<f64> =
                seen.views.iter().map(|view| view.states.iter().next().unwrap().1.value.Y).collect();
            (y, scenario.notes.into_iter().filter(|note| note.contains("`slices`")).collect::<Vec<_>>())
        };
        let ((own, none), (some, note), (more, _)) = (of(""), of(", slices = 1000"), of(", slices = 2000"));
        assert!(none.is_empty(), "{none:?}");
        for ((own, some), more) in own.iter().zip(&some).zip(&more) {
            let limit = more + (more - some) / 3.0;
            assert!((own - limit).abs() < 1e-4, "{gap_um} {twist_deg}: {own} {limit}");
            let Some(stated) = note.first().and_then(|note| note.split("off by up to ").nth(1)) else {
                continue;
            };
            let stated: f64 = stated.split(';').next().unwrap().parse().unwrap();
            assert!((some - limit).abs() < stated, "{gap_um} {twist_deg}: {some} {limit} {stated}");
        }
        assert_eq!(note.len(), 1, "{note:?}");
    }
}

/// A birefringence of ten, and a twist between surfaces that have no azimuth, are noted; usual cells are not.
#[test]
fn impossible_birefringence_and_a_twist_between_vertical_surfaces_are_noted() {
    let constants = "K11_pN = 11, K22_pN = 6, K33_pN = 17, epsilon_parallel = 3.6, epsilon_perpendicular = 7.8, states = { white = { volts = 3 } }";
    let cell = |more: &str| {
        format!("{{ kind = \"cell\", gap_um = 5, n_o = 1.48, n_e = 1.58, {more}, {constants} }}")
    };
    let thick = "{ kind = \"retarder\", axis_deg = 20, retardance_nm = 10000, thickness_um = 1 }".to_owned();
    for (layer, expected) in [
        (thick.clone(), "birefringence of 10"),
        (thick.replace("thickness_um = 1 ", "thickness_um = 40 "), ""),
        ("{ kind = \"cell\", gap_um = 5, n_o = 1.5, n_e = 2.5 }".to_owned(), "birefringence of 1"),
        (cell("pretilt_deg = 90, twist_deg = 60"), "has no meaning"),
        (cell("pretilt_deg = 2, pretilt_bottom_deg = 90, twist_deg = 60"), "has no meaning"),
        (cell("pretilt_deg = 90"), ""),
        (cell("pretilt_deg = 88, twist_deg = 60"), ""),
    ] {
        let stack = format!("display.pixel.stack=[{{ kind = \"polariser\", axis_deg = 10 }}, {layer}]");
        let found = scenario("circular-polariser", &[&stack, "spectrum.step_nm=1"]).unwrap();
        let all: Vec<_> = found
            .notes
            .iter()
            .filter(|note| note.contains("birefringence") || note.contains("no meaning"))
            .collect();
        assert_eq!(all.len(), usize::from(!expected.is_empty()), "{layer}: {all:?}");
        assert!(all.iter().all(|note| note.contains(expected)), "{layer}: {all:?}");
    }
}

/// Uniform light is diffuse light, or a cap of 90 deg: below flat layers, adding computes the pixel at each direction of the former, and looks it
/// up in the table by inclination and azimuth for the latter. Thick retarders and cells have up to 100 harmonics of the azimuth.
#[test]
fn tables_over_azimuth_hold_all_fringes_of_thick_retarders() {
    let all = [
        "{ kind = \"retarder\", axis_deg = 55, retardance_nm = 4000 }",
        "{ kind = \"retarder\", axis_deg = 55, retardance_nm = 10000 }",
        "{ kind = \"cell\", gap_um = 20, n_o = 1.5, n_e = 1.7, rub_deg = 55 }",
    ];
    for layer in sized(&all[..1], &all) {
        let stack = format!("display.pixel.stack=[{{ kind = \"polariser\", axis_deg = 10 }}, {layer}]");
        let of = |light: &str| {
            let light = format!("lighting={{ illuminance_lx = 500, spectrum = \"E\", {light} }}");
            let changes = [
                &stack,
                &light,
                "spectrum.range_nm=[550,555]",
                "spectrum.step_nm=5",
                "viewer.theta_deg=[40,75,85]",
                "viewer.phi_deg=[7,160]",
            ];
            spectra(&scenario("circular-polariser", &changes).unwrap().scene)
        };
        let (each, table) = (of("diffuse = 1.0"), of("environment = [{ model = \"cap\", share = 1.0 }]"));
        for (each, table) in each.iter().flatten().flatten().zip(table.iter().flatten().flatten()) {
            assert!((each - table).abs() < 3e-4, "{layer}: {each} {table}");
        }
    }
}

/// Positions of the bands of cholesteric paper: from n_o p to n_e p along the normal, half of the light there, and bluer from the side by
/// the cosine of the angle in the layer (J. L. Fergason, Mol. Cryst. 1, 293 (1966)).
#[test]
fn cholesteric_paper_reflects_the_bands_of_its_helices() {
    let scene =
        scenario("cholesteric", &["spectrum.range_nm=[400,700]", "spectrum.step_nm=4"]).unwrap().scene;
    let mean = 1.6;
    for (theta_deg, tolerance) in [(0.0_f64, 0.02), (30.0, 0.03)] {
        let scan = scan_at(&scene, &[theta_deg], &[0.0]).unwrap();
        let cosine = (1.0 - (theta_deg.to_radians().sin() / mean).powi(2)).sqrt();
        for (state, pitch_nm) in [("blue", 288.0), ("green", 337.0), ("red", 394.0)] {
            let (_, spectrum) = scan.states.iter().find(|(name, _)| name == state).unwrap();
            // The middle between the half-height edges of the band.
            let most = spectrum.iter().copied().fold(0.0, f64::max);
            assert!((0.42..0.56).contains(&most), "{state} {theta_deg}: {most}");
            let above = |k: &usize| spectrum[*k] > 0.25;
            let (first, last) =
                ((0..spectrum.len()).find(above).unwrap(), (0..spectrum.len()).rfind(above).unwrap());
            let middle = 0.5 * (scan.wavelength_nm[first] + scan.wavelength_nm[last]);
            let expected = mean * pitch_nm * cosine;
            assert!((middle / expected - 1.0).abs() < tolerance, "{state} {theta_deg}: {middle} {expected}");
            if theta_deg == 0.0 {
                let width = (scan.wavelength_nm[last] - scan.wavelength_nm[first]) / (0.18 * pitch_nm);
                assert!((0.8..1.35).contains(&width), "{state}: {width}");
            }
        }
        let (_, black) = scan.states.iter().find(|(name, _)| name == "black").unwrap();
        assert!(black.iter().all(|r| *r < 0.01), "{black:?}");
    }
}

const HAZE_FILM: &str = "display.diffuser={ model = \"k-correlation\", width = 0.06, transmittance = 0.9 }";

/// A haze film spreads unpolarised light over directions of the pixel, on its way in and out: an integral over them, without table, harmonics and
/// paths, trapped light included; by both solvers. The lobe's fraction within r is `1 - (1 + (r/b)^2)^(-1/2)`.
#[test]
fn haze_film_above_a_cell_is_an_integral_over_directions() {
    let views = ["viewer.theta_deg=[0,40]", "viewer.phi_deg=[20]", "display.glass={ index = 1.5 }"];
    let hazy = |method| twisted(&[&views[..], &[HAZE_FILM, "solver.relative_error=0.002", method]].concat());
    let alone = twisted(&[&views[..], &["solver.angle_medium=glass"]].concat());
    let all = ["solver.method=adding", "solver.method=monte-carlo"].map(|method| spectra(&hazy(method)));
    let (hazy, found) = (hazy("solver.method=adding"), &all[0]);
    let (steps, lobe) = (sized(16, 32), Lobe::KCorrelation { width: 0.06 });
    for (view, (theta_deg, phi_deg)) in hazy.viewer.directions().enumerate() {
        let (length, phi) = (theta_deg.to_radians().sin(), phi_deg.to_radians());
        let mut sums = vec![vec![0.0; found[view][0].len()]; found[view].len()];
        for k in 0..steps * steps {
            let [u, v] = [k / steps, k % steps].map(|k| (k as f64 + 0.5) / steps as f64);
            let (sin, cos) = (TAU * v).sin_cos();
            let r = 0.06 * ((1.0 - u).powi(-2) - 1.0).sqrt();
            let (x, y) = (length * phi.cos() + r * cos, length * phi.sin() + r * sin);
            let sine = x.hypot(y) / 1.5;
            if sine >= 1.0 {
                continue;
            }
            let leaves = 0.81 * lobe.fraction_in_disc(x.hypot(y), 1.0) / (steps * steps) as f64;
            let scan = scan_at(&alone, &[sine.asin().to_degrees()], &[y.atan2(x).to_degrees()]).unwrap();
            for (sum, (_, pixel)) in sums.iter_mut().zip(&scan.states) {
                sum.iter_mut().zip(pixel).for_each(|(sum, r)| *sum += leaves * r);
            }
        }
        for found in &all {
            for (found, expected) in found[view].iter().flatten().zip(sums.iter().flatten()) {
                assert!((found - expected).abs() < 0.01 * expected + 1e-3, "{theta_deg}: {found} {expected}");
            }
        }
    }
    // Along the diagonal, seen from another azimuth, it is another display.
    let other = spectra(&twisted(&[&views[..], &[HAZE_FILM, "viewer.phi_deg=[110]"]].concat()));
    assert!((other[1][0][1] / found[1][0][1] - 1.0).abs() > 0.03, "{other:?} {found:?}");
}

/// A film that reflects from both sides and passes some light straight, a round lamp, a field of view: both solvers, their energy balances, too.
#[test]
fn solvers_agree_below_a_reflecting_haze_film() {
    let film = "display.diffuser={ model = \"k-correlation\", width = 0.15, transmittance = 0.85, regular_fraction = 0.3, \
        reflection = { total_reflectance = 0.08, model = \"k-correlation\", width = 0.2 } }";
    let lambertian = "display.diffuser={ model = \"k-correlation\", width = 0.1, transmittance = 0.8, \
        reflection = { total_reflectance = 0.15, model = \"lambertian\" } }";
    let light = "lighting={ illuminance_lx = 500, spectrum = \"D65\", diffuse = 0.5, directed = [ \
        { theta_deg = 30, phi_deg = 50, share = 0.3, radius_deg = 4 }, { theta_deg = -20, share = 0.2 } ] }";
    for film in [film, lambertian] {
        let common = [
            TWISTED,
            film,
            light,
            "display.glass={ index = 1.5 }",
            "spectrum.range_nm=[400,700]",
            "spectrum.step_nm=150",
            "viewer.theta_deg=[0,35]",
            "viewer.phi_deg=[20]",
            "viewer.field_deg=6",
            sized("solver.relative_error=0.002", "solver.relative_error=0.001"),
        ];
        let adding =
            run(&scenario("mip-lcd", &[&common[..], &["solver.method=adding"]].concat()).unwrap().scene);
        let (adding, paths) = (adding.unwrap(), run(&walked("mip-lcd", &common).unwrap().scene).unwrap());
        assert_eq!([&*adding.solver.method, &*paths.solver.method], ["adding", "monte-carlo"]);
        for (adding, paths) in adding.views.iter().zip(&paths.views) {
            for ((name, adding), (_, paths)) in adding.states.iter().zip(paths.states.iter()) {
                let (found, of_paths) = (&adding.value, &paths.value);
                let within = |what: &str, a: f64, b: f64, error: f64| {
                    assert!(
                        (a - b).abs() < 4.5 * error + 2e-4 * b.abs() + 1e-5,
                        "{name} {what}: {a} {b} ({error})"
                    );
                };
                let errors = &paths.standard_error;
                within("Y", found.Y, of_paths.Y, errors.Y);
            }
            for ((_, adding), (name, paths)) in adding.ledger.iter().zip(paths.ledger.iter()) {
                let errors = paths.standard_error.named();
                for (((what, a), (_, b)), (_, error)) in
                    adding.values().named().into_iter().zip(paths.values().named()).zip(errors)
                {
                    assert!((a - b).abs() < 4.5 * error + 2e-4, "{name} {what}: {a} {b} ({error})");
                }
            }
        }
    }
}

/// Light through a clear filter in the plane of the pixels, which is followed direction by direction, is that without filter; a colour
/// filter far above a mirror is seen through other parts, as paths see it.
#[test]
fn colour_filters_are_above_crystals_below_a_haze_film() {
    let common = [
        HAZE_FILM,
        "display.glass={ index = 1.5, thickness_mm = 0.3 }",
        "viewer.theta_deg=[25]",
        "viewer.phi_deg=[40]",
    ];
    let of = |more: &[&str]| run(&twisted(&[&common[..], more].concat())).unwrap();
    let filter = |height_um: &str, t: &str| {
        format!(
            "display.matrix={{ pitch_um = 60, filter = {{ height_um = {height_um}, transmittance = {{ {t} }} }}, \
            states = {{ white = {{ red = \"white\", blue = \"white\" }}, red = {{ red = \"white\", blue = \"black\" }} }} }}"
        )
    };
    let y = |result: &RunResult, state: &str| result.views[0].states.get(state).unwrap().value.Y;
    let exact = ["solver.method=adding", "solver.relative_error=1e-4"];
    let clear = of(&[&exact[..], &[&filter("0", "red = 1, blue = 1")]].concat());
    assert!((y(&clear, "white") / y(&of(&exact), "white") - 1.0).abs() < 2e-4);
    let colours = filter("80", "red = 0.8, blue = 0.3");
    let adding = of(&[&exact[..], &[&colours]].concat());
    let paths = of(&["solver.method=monte-carlo", "solver.relative_error=0.002", &colours]);
    for state in ["white", "red"] {
        let error = paths.views[0].states.get(state).unwrap().standard_error.Y;
        let (a, b) = (y(&adding, state), y(&paths, state));
        assert!((a - b).abs() < 4.5 * error, "{state}: {a} {b} ({error})");
    }
    // Below a film that reflects, paths with places alone compute filters: a clear one changes nothing of what adding computes without it.
    let film = "display.diffuser={ model = \"k-correlation\", width = 0.15, transmittance = 0.8, \
        reflection = { total_reflectance = 0.15, model = \"k-correlation\", width = 0.2 } }";
    let bare = of(&[&exact[..], &[film]].concat());
    let by_paths = ["solver.method=monte-carlo", "solver.relative_error=0.001", film];
    let clear = of(&[&by_paths[..], &[&filter("0", "red = 1, blue = 1")]].concat());
    let (a, b, error) =
        (y(&bare, "white"), y(&clear, "white"), clear.views[0].states.get("white").unwrap().standard_error.Y);
    assert!((a - b).abs() < 4.5 * error && error < 2e-3 * a, "{a} {b} ({error})");
}

/// A map below a haze film is what runs of its directions are.
#[test]
fn map_below_a_haze_film_is_that_of_runs() {
    let film = "display.diffuser={ model = \"k-correlation\", width = 0.12, transmittance = 0.9, \
        reflection = { total_reflectance = 0.05, model = \"k-correlation\", width = 0.12 } }";
    let common =
        [film, "display.glass={ index = 1.5 }", "solver.method=adding", "solver.relative_error=1e-4"];
    let scene = twisted(&[&common[..], &["viewer.theta_deg=[40]", "viewer.phi_deg=[100]"]].concat());
    let grid = papilio_display::ConeGrid {
        theta_deg: vec![0.0, 40.0],
        phi_deg: vec![0.0, 100.0],
        ..Default::default()
    };
    let stop = AtomicBool::new(false);
    let map = papilio_display::cone(&scene, grid, &Control { threads: None, progress: &|_| {}, stop: &stop })
        .unwrap();
    let number = map.states.iter().position(|name| name == "white").unwrap();
    let alone = run(&scene).unwrap();
    let state = &alone.views[0].states.get("white").unwrap().value;
    let found = &map.views[3].states[number];
    let difference = found.luminance_cd_m2 / state.luminance_cd_m2 - 1.0;
    assert!(difference.abs() < 3e-4, "{} {}", found.luminance_cd_m2, state.luminance_cd_m2);
    let other = &map.views[1].states[number];
    assert!((other.luminance_cd_m2 / found.luminance_cd_m2 - 1.0).abs() > 0.02);
}

/// Light from many directions, by both solvers.
#[test]
fn environments_are_seen_below_a_haze_film() {
    let ring = "{ model = \"ring\", theta_deg = 35, width_deg = 10, share = 0.5 }";
    let sky = "{ model = \"sky\", number = 12, sun_elevation_deg = 55, sun_azimuth_deg = 200, share = 0.5 }";
    for light in [ring, sky] {
        let light = format!(
            "lighting={{ illuminance_lx = 500, spectrum = \"D65\", diffuse = 0.5, environment = [{light}] }}"
        );
        let common = [
            HAZE_FILM,
            "display.glass={ index = 1.5 }",
            &light,
            "viewer.theta_deg=[20]",
            "viewer.phi_deg=[60]",
        ];
        let of = |more: &[&str]| run(&twisted(&[&common[..], more].concat())).unwrap();
        let adding = of(&["solver.method=adding", "solver.relative_error=1e-3"]);
        let paths = of(&["solver.method=monte-carlo", "solver.relative_error=2e-3"]);
        for ((name, adding), (_, paths)) in adding.views[0].states.iter().zip(paths.views[0].states.iter()) {
            let (a, b, error) = (adding.value.Y, paths.value.Y, paths.standard_error.Y);
            assert!((a - b).abs() < 4.5 * error + 1e-3 * b, "{name}: {a} {b} ({error})");
        }
    }
}

/// What adding does not know of azimuths is refused where it is requested, and otherwise computed by Monte Carlo.
#[test]
fn haze_films_on_tinted_glass_are_for_monte_carlo() {
    let glass = ["display.glass={ index = 1.5, internal_transmittance = 0.9 }", HAZE_FILM];
    let film = [&glass[..], &["solver.relative_error=0.05", "viewer.theta_deg=0"]].concat();
    let by = run(&twisted(&film)).unwrap();
    assert_eq!(by.solver.method, "monte-carlo");
    let adding = run(&twisted(&[&film[..], &["solver.method=adding"]].concat()));
    assert!(matches!(adding, Err(DisplayError::Azimuth { key: "solver.method", .. })), "{adding:?}");
}

/// A prepared display takes a new table of the pixel when a film is laid on it and removed again.
#[test]
fn films_are_laid_on_and_removed() {
    let grid = ["viewer.theta_deg=[30]", "viewer.phi_deg=[70]", "solver.relative_error=0.02"];
    let unpolarised = ["solver.approximation=unpolarised"];
    for more in [&[][..], &unpolarised] {
        let bare = twisted(&[&grid[..], &["display.glass.surface=ideal-ar"], more].concat());
        let hazy = twisted(&[&grid[..], &["display.glass={ index = 1.5 }", HAZE_FILM], more].concat());
        let mut prepared = prepared_for(&bare).unwrap();
        let (stop, text) = (AtomicBool::new(false), |result: RunResult| format!("{:?}", result.views));
        let control = Control { threads: None, progress: &|_| {}, stop: &stop };
        for scene in [&hazy, &bare, &hazy] {
            let found = text(prepared.run(scene, &control).unwrap());
            assert_eq!(found, text(run(scene).unwrap()));
        }
    }
}

/// Where the computation does not know azimuths, it is refused and not averaged.
#[test]
fn computations_without_azimuth_are_refused() {
    let diffuser = "display.diffuser={ model = \"k-correlation\", haze = 0.5, total_transmittance = 0.9 }";
    let layered = "[spectrum]\nrange_nm = [400, 720]\nstep_nm = 80\n[display]\nlayers = [\n\
        { kind = \"diffuser\", model = \"k-correlation\", haze = 0.5, total_transmittance = 0.9 }, { kind = \"medium\", index = 1.5 }, \
        { kind = \"diffuser\", model = \"k-correlation\", haze = 0.3, total_transmittance = 0.9 }, { kind = \"medium\", index = 1.5 } ]\n\
        [display.pixel]\nmodel = \"liquid-crystal\"\nsubstrate = \"Ag\"\n\
        stack = [ { kind = \"polariser\", axis_deg = 20 }, { kind = \"retarder\", axis_deg = 65, retardance_nm = 150 } ]\n";
    let layered =
        Scenario::from_text(layered, "layered.toml", Path::new(""), &[]).unwrap().resolve().unwrap().scene;
    let stop = AtomicBool::new(false);
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let grid = BrdfGrid {
        theta_i_deg: vec![0.0],
        phi_i_deg: Vec::new(),
        theta_o_deg: vec![0.0],
        dphi_deg: vec![0.0],
    };
    for scene in [&twisted(&[]), &layered] {
        let found = papilio_display::brdf(scene, grid.clone(), &control);
        assert!(matches!(found, Err(DisplayError::Azimuth { .. })));
    }
    let map = papilio_display::cone(&layered, papilio_display::ConeGrid::default(), &control);
    assert!(matches!(map, Err(DisplayError::Azimuth { .. })), "{map:?}");
    // A pixel that is the same at all azimuths may be below a diffuser.
    let round =
        "display.pixel.stack=[{ kind = \"retarder\", plate = \"C\", retardance_nm = 100, thickness_um = 1 }]";
    let uniform = scenario(
        "mip-lcd",
        &[
            round,
            diffuser,
            "display.glass={ index = 1.5 }",
            "spectrum.step_nm=160",
            "spectrum.range_nm=[400,720]",
            "solver.relative_error=0.02",
        ],
    )
    .unwrap()
    .scene;
    run(&uniform).unwrap();
}

/// A run computes the pixel in the directions that its views and lamps need. A map of all views interpolates in a table, within 1e-4; and a prepared
/// display takes what it needs after each change.
#[test]
fn views_see_the_same_pixel_as_a_map_of_all_directions() {
    let scene = twisted(&["viewer.theta_deg=[30]", "viewer.phi_deg=[70]", "viewer.field_deg=0"]);
    let alone = run(&scene).unwrap();
    let stop = AtomicBool::new(false);
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let mut prepared = prepared_for(&scene).unwrap();
    let grid = papilio_display::ConeGrid {
        theta_deg: vec![0.0, 30.0, 60.0],
        phi_deg: vec![0.0, 70.0],
        ..Default::default()
    };
    let map = prepared.cone(&scene, grid, &control).unwrap();
    let other = twisted(&["viewer.theta_deg=[55]", "viewer.phi_deg=[10]", "viewer.field_deg=0"]);
    let text = |result: &papilio_display::result::RunResult| format!("{:?}", result.views);
    assert_eq!(text(&prepared.run(&other, &control).unwrap()), text(&run(&other).unwrap()));
    assert_eq!(text(&prepared.run(&scene, &control).unwrap()), text(&alone));
    // The second inclination at the second azimuth.
    let state = alone.views[0].states.get("white").unwrap();
    let number = map.states.iter().position(|name| name == "white").unwrap();
    let seen = map.views[4].states[number].reflectance_factor_y;
    assert!((seen - state.value.Y).abs() < 1e-4, "{seen} {}", state.value.Y);
}

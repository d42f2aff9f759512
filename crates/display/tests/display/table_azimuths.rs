//! Tables of one's own whose reflectance depends on azimuth, from the file to the result.

use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use papilio_display::pixel::scan_at;
use papilio_display::result::RunResult;
use papilio_display::scene::Scene;
use papilio_display::{BrdfGrid, ConeGrid, Control, DisplayError};
use papilio_optics::lobe::Lobe;
use papilio_scenario::{Resolved, Scenario};
use papilio_testing::sized;

use crate::common::{prepared_for, run};

const NM: [f64; 4] = [400.0, 500.0, 600.0, 700.0];
const STATES: [&str; 2] = ["white", "black"];

/// Steps of the table in inclination and azimuth, degrees.
const STEP_DEG: usize = 10;
const TURN_DEG: usize = 30;

/// `a(theta) + b(theta) cos 2 (phi - phi_0)`, angles in glass; each wavelength has its own `phi_0`.
fn value(state: usize, theta_deg: f64, phi_deg: f64, bin: usize) -> f64 {
    let s2 = theta_deg.to_radians().sin().powi(2);
    let (mean, swing) = [(0.5 - 0.1 * s2, 0.3 * s2), (0.05, 0.04 * s2)][state];
    mean + swing * (2.0 * (phi_deg - 15.0 - 20.0 * bin as f64).to_radians()).cos()
}

/// The same, linear between the inclinations of the table.
fn between(state: usize, theta_deg: f64, phi_deg: f64, bin: usize) -> f64 {
    let at = (theta_deg / STEP_DEG as f64).min(9.0 - 1e-9);
    let [low, high] = [at.floor(), at.floor() + 1.0].map(|k| value(state, k * STEP_DEG as f64, phi_deg, bin));
    low + at.fract() * (high - low)
}

/// The table, turned by an angle, over one turn or half of it.
fn csv(turned_deg: f64, whole_deg: usize) -> String {
    let mut text = "state,phi_deg,theta_deg,wavelength_nm,reflectance\n".to_owned();
    for (state, name) in STATES.iter().enumerate() {
        for theta in (0..=90).step_by(STEP_DEG) {
            for phi in (0..whole_deg).step_by(TURN_DEG) {
                for (bin, nm) in NM.iter().enumerate() {
                    let r = value(state, theta as f64, phi as f64 - turned_deg, bin);
                    text += &format!("{name},{phi},{theta},{nm},{r}\n");
                }
            }
        }
    }
    text
}

/// A display of these layers over the table.
fn display_of(layers: &str, table: &str, set: &[&str]) -> Resolved {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("table.csv"), table).unwrap();
    let text = format!(
        "[spectrum]\nrange_nm = [400, 700]\nstep_nm = 100\n[display]\nlayers = [{layers}]\n[display.pixel]\nmodel = \"table\"\n\
         file = \"table.csv\"\nangles = \"glass\"\n[viewer]\nfield_deg = 0\n"
    );
    let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
    Scenario::from_text(&text, "turned.toml", folder.path(), &set).unwrap().resolve().unwrap()
}

fn display(layers: &str, set: &[&str]) -> Scene {
    display_of(layers, &csv(0.0, 180), set).scene
}

/// Spectra of the reflectance factor, `[view][state][wavelength]`.
fn spectra(scene: &Scene) -> Vec<Vec<Vec<f64>>> {
    let result = run(scene).unwrap();
    let view = |view: &papilio_display::result::View| {
        view.states.iter().map(|(_, state)| state.value.reflectance_factor.clone().unwrap()).collect()
    };
    result.views.iter().map(view).collect()
}

/// Calls `check` with the number of each state and wavelength of a view, and what is seen there.
fn each(found: &[Vec<f64>], mut check: impl FnMut(usize, usize, f64)) {
    let rows = found.iter().enumerate();
    rows.for_each(|(state, row)| row.iter().enumerate().for_each(|(bin, r)| check(state, bin, *r)));
}

const IDEAL: &str = "{ kind = \"ideal-ar\" }, { kind = \"medium\", index = 1.5 }";
const FACE: &str = "{ kind = \"medium\", index = 1.5 }";
const COVER: &str = "{ kind = \"medium\", index = 1.52 }, { kind = \"medium\", index = 1.0 }, { kind = \"medium\", index = 1.5 }";
const METHODS: [&str; 2] = ["solver.method=adding", "solver.method=monte-carlo"];

/// The pixel alone: at the nodes the values of the file, between azimuths the function, between inclinations its linear interpolation.
#[test]
fn pixel_alone_is_the_table_and_its_interpolation() {
    for table in [csv(0.0, 180), csv(0.0, 360)] {
        let scene = display_of(IDEAL, &table, &["solver.angle_medium=glass"]).scene;
        for (theta_deg, phi_deg) in
            [(0.0, 0.0), (40.0, 60.0), (70.0, 47.0), (40.0, -133.0), (57.0, 200.0), (90.0, 5.0)]
        {
            let scan = scan_at(&scene, &[theta_deg], &[phi_deg]).unwrap();
            let found: Vec<Vec<f64>> = scan.states.into_iter().map(|(_, row)| row).collect();
            each(&found, |state, bin, r| {
                let expected = between(state, theta_deg, phi_deg, bin);
                assert!((r - expected).abs() < 1e-6, "{theta_deg} {phi_deg}: {r} {expected}");
                // The error of linear interpolation: an eighth of the square of the step times the second derivative.
                assert!((r - value(state, theta_deg, phi_deg, bin)).abs() < 4e-3);
            });
        }
    }
}

/// Fresnel's reflectances of s and p between two media, at this sine in air.
fn fresnel([above, below]: [f64; 2], sine: f64) -> [f64; 2] {
    let [c, d] = [above, below].map(|n| (1.0 - (sine / n).powi(2)).sqrt());
    [(above * c - below * d) / (above * c + below * d), (below * c - above * d) / (below * c + above * d)]
        .map(|r| r * r)
}

/// Faces between these media, from the air down, over a mirror: all orders of s, all of p, and their mean.
fn chain(indices: &[f64], sine: f64, mirror: f64) -> f64 {
    let of = |polarisation: usize| {
        let (mut above, mut through, mut below, mut index) = (0.0, 1.0, 0.0, 1.0);
        for &next in indices {
            let face = fresnel([index, next], sine)[polarisation];
            let series = 1.0 / (1.0 - below * face);
            above += through * through * face * series;
            below = face + (1.0 - face).powi(2) * below * series;
            through *= (1.0 - face) * series;
            index = next;
        }
        above + through * through * mirror / (1.0 - below * mirror)
    };
    0.5 * (of(0) + of(1))
}

fn in_glass(sine: f64) -> f64 {
    (sine / 1.5).asin().to_degrees()
}

/// In diffuse light a flat display shows the pixel at the mirror angle, at each azimuth: an ordinary face, an air-spaced cover glass and
/// absorbing glass, of which adding has each another form. Both solvers.
#[test]
fn flat_displays_show_the_table_at_the_azimuth_of_the_view() {
    let views = ["viewer.theta_deg=[0,25,50,75]", "viewer.phi_deg=[20,-75,213]"];
    let tinted = "{ kind = \"medium\", index = 1.5, internal_transmittance = 0.9 }";
    for (layers, indices, passes) in [
        (IDEAL, &[][..], 1.0),
        (FACE, &[1.5], 1.0),
        (COVER, &[1.52, 1.0, 1.5], 1.0),
        (tinted, &[1.5], 0.9_f64),
    ] {
        for method in METHODS {
            let scene = display(layers, &[&views[..], &[method]].concat());
            let found = spectra(&scene);
            for ((theta_deg, phi_deg), found) in scene.viewer.directions().zip(&found) {
                let sine = theta_deg.to_radians().sin();
                let inside = in_glass(sine);
                let passed = passes.powf(2.0 / inside.to_radians().cos());
                each(found, |state, bin, r| {
                    let mirror = between(state, inside, phi_deg, bin);
                    let expected = chain(indices, sine, passed * mirror);
                    assert!(
                        (r - expected).abs() < 2e-6,
                        "{layers} {method} {theta_deg} {phi_deg}: {r} {expected}"
                    );
                });
            }
        }
    }
}

/// The same without s and p apart: the reflectance at each face is their mean.
#[test]
fn unpolarised_light_below_a_cover_glass_knows_azimuths() {
    let set = ["solver.approximation=unpolarised", "viewer.theta_deg=60", "viewer.phi_deg=70"];
    for method in METHODS {
        let found = spectra(&display(COVER, &[&set[..], &[method]].concat())).remove(0);
        let sine = 60_f64.to_radians().sin();
        each(&found, |state, bin, r| {
            let mut mirror = between(state, in_glass(sine), 70.0, bin);
            let mut media = [1.5, 1.0, 1.52, 1.0].windows(2);
            let expected = loop {
                let Some(&[below, above]) = media.next() else { break mirror };
                let [s, p] = fresnel([above, below], sine);
                let face = 0.5 * (s + p);
                mirror = face + (1.0 - face).powi(2) * mirror / (1.0 - face * mirror);
            };
            assert!((r - expected).abs() < 2e-6, "{method}: {r} {expected}");
        });
    }
}

/// The mirror image of a lamp of 5 deg, at its azimuth, and the map of all directions.
#[test]
fn image_of_a_lamp_and_map_are_those_of_the_azimuth() {
    let lamp = "lighting.directed=[{theta_deg=50,phi_deg=250,radius_deg=5,share=1}]";
    let set = [lamp, "lighting.diffuse=0", "viewer.theta_deg=50", "viewer.phi_deg=70"];
    let sine = 50_f64.to_radians().sin();
    let brighter = 1.0 / (5.0_f64.to_radians().sin().powi(2) * 50_f64.to_radians().cos());
    let expected =
        |state: usize, bin: usize| chain(&[1.52, 1.0, 1.5], sine, between(state, in_glass(sine), 70.0, bin));
    for method in METHODS {
        each(&spectra(&display(COVER, &[&set[..], &[method]].concat()))[0], |state, bin, r| {
            let away = r / (brighter * expected(state, bin)) - 1.0;
            assert!(away.abs() < 1e-4, "{method}: {away}");
        });
    }
    let stop = AtomicBool::new(false);
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let phi_deg = vec![70.0, 160.0];
    let grid = ConeGrid { theta_deg: vec![0.0, 50.0], phi_deg: phi_deg.clone(), ..ConeGrid::default() };
    for layers in [FACE, COVER] {
        let scene = display(layers, &["viewer.theta_deg=50", "viewer.phi_deg=[70,160]"]);
        let alone = run(&scene).unwrap();
        let map = papilio_display::cone(&scene, grid.clone(), &control).unwrap();
        for (k, view) in alone.views.iter().enumerate() {
            for (state, (_, seen)) in view.states.iter().enumerate() {
                let of_map = map.views[1 + 2 * k].states[state].reflectance_factor_y;
                assert!((of_map - seen.value.Y).abs() < 1e-6, "{layers} {k}: {of_map} {}", seen.value.Y);
            }
        }
        let y = |k: usize| map.views[k].states[0].reflectance_factor_y;
        assert!((y(1) / y(3) - 1.0).abs() > 0.05, "{layers}");
    }
}

const HAZE: &str = "{ kind = \"diffuser\", model = \"k-correlation\", width = 0.06, transmittance = 0.9 }";

/// A haze film on the glass, by both solvers, and over a gap above it, by Monte Carlo: an integral over directions. The lobe's fraction within r is `1 - (1 + (r/b)^2)^(-1/2)`.
/// Between film and pixel, s and p are kept apart.
#[test]
fn haze_film_above_the_table_is_an_integral_over_directions() {
    let (steps, lobe) = ([sized(400, 2000), sized(48, 96)], Lobe::KCorrelation { width: 0.06 });
    let set = ["viewer.theta_deg=[0,40]", "viewer.phi_deg=35", "solver.relative_error=0.002"];
    let all = [(FACE, &[][..], "adding"), (FACE, &[], "monte-carlo"), (COVER, &[1.0, 1.5], "monte-carlo")];
    for (layers, indices, method) in all {
        let layers = layers.replace("{ kind = \"medium\", index = 1.52 }, ", "");
        let method = format!("solver.method={method}");
        let scene = display(&format!("{HAZE}, {layers}"), &[&set[..], &[&*method]].concat());
        let found = spectra(&scene);
        for ((theta_deg, phi_deg), found) in scene.viewer.directions().zip(&found) {
            let (length, phi) = (theta_deg.to_radians().sin(), phi_deg.to_radians());
            let mut sums = vec![vec![0.0; NM.len()]; STATES.len()];
            for k in 0..steps[0] * steps[1] {
                let [u, v] = [k / steps[1], k % steps[1]];
                let [u, v] = [(u, steps[0]), (v, steps[1])].map(|(k, of)| (k as f64 + 0.5) / of as f64);
                let (sin, cos) = (TAU * v).sin_cos();
                let r = 0.06 * ((1.0 - u).powi(-2) - 1.0).sqrt();
                let (x, y) = (length * phi.cos() + r * cos, length * phi.sin() + r * sin);
                let sine = x.hypot(y);
                if sine >= if indices.is_empty() { 1.5 } else { 1.0 } {
                    continue;
                }
                let weight = 0.81 * lobe.fraction_in_disc(sine, 1.0) / (steps[0] * steps[1]) as f64;
                for (state, sums) in sums.iter_mut().enumerate() {
                    for (bin, sum) in sums.iter_mut().enumerate() {
                        let mirror = between(state, in_glass(sine), y.atan2(x).to_degrees(), bin);
                        *sum += weight * chain(indices, sine, mirror);
                    }
                }
            }
            each(found, |state, bin, r| {
                let expected = sums[state][bin];
                assert!(
                    (r - expected).abs() < 0.008 * expected + 2e-4,
                    "{layers} {theta_deg}: {r} {expected}"
                );
            });
        }
    }
}

/// BSDF at these inclinations of light and viewer, `[light][phi_i][viewer][dphi][state]` times the wavelengths.
fn bsdf(scene: &Scene, grid: BrdfGrid) -> papilio_display::BrdfTable {
    let stop = AtomicBool::new(false);
    papilio_display::brdf(scene, grid, &Control { threads: Some(1), progress: &|_| {}, stop: &stop }).unwrap()
}

/// The BSDF below a haze film that reflects: both solvers in the light of a lamp at the same directions, light and viewer exchanged, both
/// turned by half a turn, and the display turned by 90 deg.
#[test]
fn bsdf_by_azimuth_is_that_of_lamps_is_reciprocal_and_turns_with_the_display() {
    let film = HAZE.replace(
        "0.9 }",
        "0.9, reflection = { total_reflectance = 0.04, model = \"k-correlation\", width = 0.06 } }",
    );
    let hazy = format!("{film}, {FACE}");
    let tight = ["solver.relative_error=1e-4"];
    let scene = display(&hazy, &tight);
    let turned = display_of(&hazy, &csv(90.0, 180), &tight).scene;
    let grid = |phi_i_deg: &[f64]| BrdfGrid {
        theta_i_deg: vec![0.0, 25.0, 40.0],
        phi_i_deg: phi_i_deg.to_vec(),
        theta_o_deg: vec![0.0, 25.0, 40.0],
        dphi_deg: vec![0.0, 70.0, 170.0, 190.0, 290.0],
    };
    let (of, across) = (bsdf(&scene, grid(&[20.0, 90.0, 110.0, 180.0])), bsdf(&turned, grid(&[110.0])));
    let at = |table: &papilio_display::BrdfTable, state: usize, [i, phi, o, dphi]: [usize; 4]| {
        let row = ((i * table.grid.phi_i_deg.len() + phi) * 3 + o) * 5 + dphi;
        table.states[state].brdf[row * NM.len()..][..NM.len()]
            .iter()
            .map(|f| f64::from(*f))
            .collect::<Vec<_>>()
    };
    let same = |a: &[f64], b: &[f64], error: f64| {
        let away = a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.max(1e-3)).fold(0.0, f64::max);
        assert!(away < error, "{a:?} {b:?}");
    };
    for state in 0..STATES.len() {
        for i in 1..3 {
            for o in 1..3 {
                for dphi in 0..5 {
                    // The same display, turned.
                    same(&at(&of, state, [i, 0, o, dphi]), &at(&across, state, [i, 0, o, dphi]), 1e-3);
                }
                // From 20 to 90 deg and back (290 = -70 deg); from 110 to 180 deg.
                for (from, to) in [(0, 1), (2, 3)] {
                    let (there, back) = (at(&of, state, [i, from, o, 1]), at(&of, state, [o, to, i, 4]));
                    same(&there, &back, 1e-3);
                }
            }
        }
        let away = at(&of, state, [2, 0, 2, 2])[1] / at(&of, state, [2, 2, 2, 2])[1] - 1.0;
        assert!(away.abs() > 0.03, "{away}");
    }
    let lamp = "lighting.directed=[{theta_deg=40,phi_deg=110,share=1}]";
    let set = [lamp, "lighting.diffuse=0", "viewer.theta_deg=[0,25,40]", "viewer.phi_deg=280"];
    // Every day with a quarter of the paths: at most five times the target of the standard error, as in `cargo xtask full`.
    let walked = sized(("monte-carlo", "4e-3", 0.02), ("monte-carlo", "2e-3", 0.01));
    for (method, stop, error) in [("adding", "1e-4", 5e-4), walked] {
        let (method, stop) = (format!("solver.method={method}"), format!("solver.relative_error={stop}"));
        for (o, found) in spectra(&display(&hazy, &[&set[..], &[&method, &stop]].concat())).iter().enumerate()
        {
            for (state, found) in found.iter().enumerate() {
                let f: Vec<f64> = found.iter().map(|r| r / std::f64::consts::PI).collect();
                same(&at(&of, state, [2, 2, o, 2]), &f, error);
            }
        }
    }
    // The light that leaves, by reciprocity, is the sum over viewers on a fine grid.
    let fine = BrdfGrid { theta_i_deg: vec![25.0], phi_i_deg: vec![0.0], ..BrdfGrid::around(5.0, 90.0) };
    assert!(bsdf(&display(&hazy, &[]), fine).missed() < 0.05);
}

/// Without a scatterer, the table has the mirror part alone: the chain of the faces, at each azimuth.
#[test]
fn bsdf_of_flat_layers_is_the_mirror_part_of_each_azimuth() {
    let grid =
        BrdfGrid { theta_i_deg: vec![0.0, 50.0], theta_o_deg: vec![50.0], ..BrdfGrid::around(90.0, 45.0) };
    let table = bsdf(&display(COVER, &[]), grid);
    for (state, found) in table.states.iter().enumerate() {
        assert!(found.brdf.iter().all(|f| *f == 0.0));
        for (light, [theta_deg, phi_deg]) in table.grid.lights_deg().into_iter().enumerate() {
            let sine = theta_deg.to_radians().sin();
            for bin in 0..NM.len() {
                let expected = chain(&[1.52, 1.0, 1.5], sine, between(state, in_glass(sine), phi_deg, bin));
                for r in
                    [&found.specular, &found.directional_hemispherical].map(|all| all[light * NM.len() + bin])
                {
                    assert!((r - expected).abs() < 2e-6, "{theta_deg} {phi_deg}: {r} {expected}");
                }
            }
        }
    }
}

/// A display that is turned by 30 deg shows what it showed to a viewer and a lamp that are turned back.
#[test]
fn turned_table_is_seen_as_by_turned_viewers_and_lamps() {
    let at = |turned_deg: f64, more: &[&str], layers: &str, table: &str| {
        let lamp = format!(
            "lighting.directed=[{{theta_deg=40,phi_deg={},radius_deg=8,share=0.5}}]",
            230.0 - turned_deg
        );
        let phi = format!("viewer.phi_deg=[{},{}]", 50.0 - turned_deg, 140.0 - turned_deg);
        let set = [&lamp, "lighting.diffuse=0.5", "viewer.theta_deg=[10,40]", "viewer.field_deg=6", &phi];
        spectra(&display_of(layers, table, &[&set[..], more].concat()).scene)
    };
    let hazy = format!("{HAZE}, {FACE}");
    let paths = format!("solver.paths={}", sized(8192, 65536));
    for (layers, more, error) in [
        (FACE, vec!["solver.relative_error=1e-4"], 1e-5),
        (COVER, vec!["solver.relative_error=1e-4"], 1e-5),
        (&hazy, vec!["solver.method=monte-carlo", &paths], 0.02),
    ] {
        let turned = at(0.0, &more, layers, &csv(30.0, 360));
        let back = at(30.0, &more, layers, &csv(0.0, 180));
        let other = at(0.0, &more, layers, &csv(0.0, 180));
        let mut largest = 0.0_f64;
        for (k, turned) in turned.iter().enumerate() {
            each(turned, |state, bin, r| {
                let [back, other] = [&back, &other].map(|all| all[k][state][bin]);
                assert!((r / back - 1.0).abs() < error, "{layers} {k}: {r} {back}");
                largest = largest.max((r / other - 1.0).abs());
            });
        }
        assert!(largest > 0.03, "{layers}: {largest}");
    }
}

/// A prepared display takes a table with azimuths, one without, and layers above them, as a run does.
#[test]
fn tables_and_layers_are_exchanged() {
    let set = ["viewer.theta_deg=[30,60]", "viewer.phi_deg=[70]", "solver.relative_error=0.02"];
    let with = |layers: &str| display(layers, &set);
    let plain = |layers: &str| {
        let text = csv(0.0, 180);
        let rows = text.lines().filter(|line| line.contains(",0,") && line.split(',').nth(1) == Some("0"));
        let rows: Vec<String> = rows.map(|line| line.replacen(",0,", ",", 1)).collect();
        let text = format!("state,theta_deg,wavelength_nm,reflectance\n{}\n", rows.join("\n"));
        display_of(layers, &text, &set).scene
    };
    let hazy = format!("{HAZE}, {FACE}");
    let scenes = [
        with(FACE),
        plain(FACE),
        with(COVER),
        plain(COVER),
        with(COVER),
        with(&hazy),
        plain(&hazy),
        with(FACE),
    ];
    let (stop, text) = (AtomicBool::new(false), |result: RunResult| format!("{:?}", result.views));
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let mut prepared = prepared_for(&scenes[1]).unwrap();
    for (k, scene) in scenes.iter().enumerate() {
        assert_eq!(text(prepared.run(scene, &control).unwrap()), text(run(scene).unwrap()), "{k}");
    }
    // Another table with azimuths below the same layers.
    let turned = display_of(COVER, &csv(30.0, 180), &set).scene;
    for scene in [&scenes[2], &turned, &scenes[2]] {
        assert_eq!(text(prepared.run(scene, &control).unwrap()), text(run(scene).unwrap()));
    }
}

/// Where the computation does not know azimuths, it is refused and not averaged.
#[test]
fn computations_without_azimuth_are_refused() {
    let hazy = format!("{HAZE}, {FACE}");
    let stop = AtomicBool::new(false);
    let control = Control { threads: None, progress: &|_| {}, stop: &stop };
    let grid = BrdfGrid {
        theta_i_deg: vec![0.0],
        phi_i_deg: Vec::new(),
        theta_o_deg: vec![0.0],
        dphi_deg: vec![0.0],
    };
    for layers in [FACE, COVER, &hazy] {
        let found = papilio_display::brdf(&display(layers, &[]), grid.clone(), &control);
        assert!(matches!(found, Err(DisplayError::Azimuth { key: "display.pixel", .. })), "{layers}");
    }
    let twice = format!("{HAZE}, {{ kind = \"medium\", index = 1.5 }}, {hazy}");
    let adding = run(&display(&twice, &["solver.method=adding"]));
    assert!(matches!(adding, Err(DisplayError::Azimuth { key: "solver.method", .. })), "{adding:?}");
    // One film on the glass: what is refused is the light.
    let clear = HAZE.replace("width = 0.06", "width = 0.06, regular_fraction = 0.1");
    let cap = "lighting={environment=[{model=\"cap\",theta_deg=30,phi_deg=70,to_deg=25,share=1}]}";
    let lit = run(&display(&format!("{clear}, {FACE}"), &["solver.method=adding", cap]));
    assert!(lit.unwrap_err().to_string().contains("in light from so many directions"));
    let map = papilio_display::cone(&display(&twice, &[]), ConeGrid::default(), &control);
    assert!(matches!(map, Err(DisplayError::Azimuth { .. })), "{map:?}");
}

/// A colour filter in the plane of the pixels, below a face: both solvers, at two azimuths.
#[test]
fn filters_are_above_tables_with_azimuths() {
    let common = [
        "display.matrix={ pitch_um = 100, layout = \"stripe\" }",
        "display.matrix.filter={ height_um = 0, transmittance = { red = 0.8, green = 0.5, blue = 0.2 } }",
        "display.layers.0.thickness_mm=0.2",
        "viewer.theta_deg=[50]",
        "viewer.phi_deg=[0,60]",
    ];
    let of = |more: &[&str]| run(&display(FACE, &[&common[..], more].concat())).unwrap();
    let (adding, paths) =
        (of(&["solver.method=adding"]), of(&["solver.method=monte-carlo", "solver.paths=1024"]));
    for (adding, paths) in adding.views.iter().zip(&paths.views) {
        for ((name, adding), (_, paths)) in adding.states.iter().zip(paths.states.iter()) {
            let (a, b, error) = (adding.value.Y, paths.value.Y, paths.standard_error.Y);
            assert!((a - b).abs() < 4.5 * error + 1e-3 * a, "{name}: {a} {b} ({error})");
        }
    }
}

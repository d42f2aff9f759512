//! The reference pixel below faces of several panes: s and p are kept apart through all of them, as no sum of means does.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use papilio_display::result::RunResult;
use papilio_display::scene::{Pixel, Scene, SubPixel};
use papilio_display::{Control, run};
use papilio_optics::film::{Film, Layer, Polarisation, SpectralLayer, Thickness, coherent};
use papilio_scenario::Scenario;

const METHODS: [&str; 2] = ["solver.method=adding", "solver.method=monte-carlo"];

/// Fresnel's formulas for s and p between air and glass, from the angles of incidence and refraction.
fn face(theta_deg: f64) -> [f64; 2] {
    let i = theta_deg.to_radians();
    let t = (i.sin() / 1.5).asin();
    [((i - t).sin() / (i + t).sin()).powi(2), ((i - t).tan() / (i + t).tan()).powi(2)]
}

/// Reflectances of the states white and black of the reference pixel in glass, for s and for p: the films of all sub-pixels, one by one.
fn reference_pixel(scene: &Scene, state: usize, bin: usize, beta: f64) -> [f64; 2] {
    let Pixel::Film(pixel) = &scene.display.pixel else { panic!("films") };
    let nm = scene.grid.wavelengths_nm()[bin];
    [Polarisation::S, Polarisation::P].map(|polarisation| {
        let of = |sub_pixel: &SubPixel| {
            let gap_nm = [sub_pixel.gap_nm, pixel.dark_gap_nm.unwrap()][state];
            let layer = |layer: &SpectralLayer| Layer {
                index: layer.index[bin],
                thickness_nm: match layer.thickness {
                    Thickness::Fixed(nm) => nm,
                    Thickness::Gap => gap_nm,
                },
            };
            let layers = pixel.layers.iter().map(layer).collect();
            let film = Film { incidence: 1.5, layers, substrate: pixel.substrate[bin] };
            sub_pixel.area * coherent(&film, nm, beta, polarisation).unwrap().reflectance
        };
        pixel.fill_factor * pixel.sub_pixels.iter().map(of).sum::<f64>()
    })
}

/// The reference pixel below a face, an air-spaced cover glass and two panes: the sum of all orders of s, that of p, and their mean, by both solvers;
/// and how far Y is from it if the mean is taken at each meeting instead.
#[test]
fn reference_pixel_below_panes_is_the_mean_of_sums_of_s_and_p() {
    let toml = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/reference-pixel.toml"),
    );
    let toml = toml.unwrap().replace("[display.glass]\nindex = 1.5\nsurface = \"ideal-ar\"\n", "");
    let of = |faces: usize, more: &str| {
        let media = (0..faces).map(|k| if k % 2 == 0 { 1.5 } else { 1.0 });
        let layers: String =
            media.map(|index| format!("[[display.layers]]\nkind = \"medium\"\nindex = {index}\n")).collect();
        let text = format!("{toml}{layers}");
        let set = [
            "solver.angle_medium=air",
            "spectrum.step_nm=10",
            "viewer.theta_deg=[45,60,70]",
            "viewer.field_deg=0",
            more,
        ];
        let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
        let scene =
            Scenario::from_text(&text, "panes.toml", Path::new(""), &set).unwrap().resolve().unwrap().scene;
        let stop = AtomicBool::new(false);
        let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
        (run(&scene, &control).unwrap(), scene)
    };
    let of_state = |result: &RunResult, view: usize, state: usize| {
        result.views[view].states.get(["white", "black"][state]).unwrap().value.clone()
    };
    // Per cent of Y, by number of faces, view and state.
    let expected =
        [(1, 1, 0, -4.3), (3, 0, 1, 4.6), (3, 1, 1, 10.3), (3, 2, 0, 11.4), (5, 0, 1, 9.2), (5, 1, 1, 20.0)];
    for faces in [1, 3, 5] {
        for method in METHODS {
            let (result, scene) = of(faces, method);
            for (view, theta_deg) in [45.0_f64, 60.0, 70.0].into_iter().enumerate() {
                for state in 0..2 {
                    let found = of_state(&result, view, state).reflectance_factor.unwrap();
                    for (bin, found) in found.iter().enumerate() {
                        let pixel = reference_pixel(&scene, state, bin, theta_deg.to_radians().sin());
                        // From the pixel up, face by face: each is the same for light from both sides.
                        let whole = |(face, pixel): (f64, f64)| {
                            let above =
                                |below: f64| face + (1.0 - face).powi(2) * below / (1.0 - face * below);
                            (0..faces).fold(pixel, |below, _| above(below))
                        };
                        let [s, p] = [0, 1].map(|k| whole((face(theta_deg)[k], pixel[k])));
                        let mean = 0.5 * (s + p);
                        assert!((found - mean).abs() < 2e-6, "{faces} {method} {theta_deg}: {found} {mean}");
                    }
                }
            }
        }
        let [(apart, _), (mixed, _)] =
            ["none", "unpolarised"].map(|one| of(faces, &format!("solver.approximation={one}")));
        for (_, view, state, percent) in expected.into_iter().filter(|one| one.0 == faces) {
            let [apart, mixed] = [&apart, &mixed].map(|result| of_state(result, view, state).Y);
            let found = 100.0 * (mixed / apart - 1.0);
            assert!((found - percent).abs() < 0.1, "{faces} {view} {state}: {found}");
        }
    }
}

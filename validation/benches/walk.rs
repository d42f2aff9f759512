//! The Monte Carlo solver, end to end, on one core: `cargo bench -p papilio-validation --bench walk`.
//!
//! `paths` counts paths (items) per second, including all spectra; `to_0_1_percent` is the
//! CPU time from a resolved scenario to a complete result with 0.1 % in Y of every state, and
//! in every wavelength bin of every state; `layers_to_0_1_percent` is the same for general layers: white
//! paint under rough glass (one state) and a conservative slab over two mirrors, with and without a surface,
//! in diffuse light, and the slab of `scenarios/slab.toml` with an optical thickness of 2 under its lamp;
//! `paths_with_places` counts paths per second over a pattern of stripes, or with a transfer function at 64
//! frequencies (compare `paths` of the same scenario); `resolve` is the time from the file to the scene.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::sync::atomic::AtomicBool;

use divan::Bencher;
use divan::counter::ItemsCount;
use papilio_display::Control;
use papilio_display::scene::{Scene, Stop};
use papilio_display::spatial::walk::{pattern, transfer};
use papilio_scenario::Scenario;
use papilio_transport::walk::places::{Shape, TwoStates};
use papilio_validation::{monte_carlo_scenario, run_on};

fn main() {
    divan::main();
}

fn scene(name: &str, stop: Stop) -> Scene {
    let mut scene = monte_carlo_scenario(name, &[]).unwrap().scene;
    scene.solver.stop = stop;
    scene
}

const PATHS: u64 = 1 << 20;

#[divan::bench(args = ["overcast", "indoor", "table-pixel", "epaper", "reference-pixel", "matrix", "laminated-text"], sample_count = 5, sample_size = 1)]
fn paths(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name, Stop::Paths(PATHS));
    let views = (scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len()) as u64;
    bencher.counter(ItemsCount::new(PATHS * views)).bench(|| run_on(&scene, Some(1)).unwrap());
}

#[divan::bench(args = ["matrix", "laminated-text"], consts = [false, true], sample_count = 5, sample_size = 1)]
fn paths_with_places<const FREQUENCIES: bool>(bencher: Bencher<'_, '_>, name: &str) {
    let scene = monte_carlo_scenario(name, &[]).unwrap().scene;
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let stripes = TwoStates { shape: Shape::Stripes, period_mm: 0.17, states: [0, 1] };
    let frequencies: Vec<[f64; 2]> = (0..64).map(|k| [0.2 * f64::from(k), 0.0]).collect();
    bencher.counter(ItemsCount::new(PATHS)).bench(|| {
        if FREQUENCIES {
            transfer(&scene, &frequencies, PATHS, &control).unwrap().len()
        } else {
            pattern(&scene, &stripes, PATHS, &control).unwrap().len()
        }
    });
}

#[divan::bench(args = ["overcast", "indoor", "sunny", "table-pixel", "epaper"], consts = [false, true])]
fn to_0_1_percent<const PER_WAVELENGTH: bool>(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name, Stop::RelativeError { target: 0.001, per_wavelength: PER_WAVELENGTH });
    bencher.bench(|| run_on(&scene, Some(1)).unwrap());
}

/// Layers and pixel in diffuse light, by name.
const LAYERS: [(&str, &str); 3] = [
    (
        "rough glass",
        "[[display.layers]]\nkind = \"rough\"\nalpha = 0.1\n[[display.layers]]\nkind = \"medium\"\nindex = 1.5\n\
         [display.pixel]\nmodel = \"uniform\"\nkind = \"lambertian\"\nreflectance = { white = 0.5 }\n",
    ),
    (
        "slab",
        "[[display.layers]]\nkind = \"fresnel\"\n[[display.layers]]\nkind = \"slab\"\noptical_thickness = 2.0\n\
         anisotropy = 0.9\nalbedo = 1.0\nindex = 1.5\n[display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\n\
         reflectance = { white = 0.8, black = 0.1 }\n[spectrum]\nstep_nm = 20\n",
    ),
    (
        "slab without surface",
        "[[display.layers]]\nkind = \"slab\"\noptical_thickness = 2.0\nanisotropy = 0.9\nalbedo = 1.0\nindex = 1.0\n\
         [display.pixel]\nmodel = \"uniform\"\nkind = \"mirror\"\nreflectance = { white = 0.8, black = 0.1 }\n\
         [spectrum]\nstep_nm = 20\n",
    ),
];

/// The particle diffuser of `scenarios/slab.toml`.
const PARTICLES: &str = "particles over a film, lamp";

#[divan::bench(args = ["rough glass", "slab", "slab without surface", PARTICLES], consts = [false, true])]
fn layers_to_0_1_percent<const PER_WAVELENGTH: bool>(bencher: Bencher<'_, '_>, name: &str) {
    let stop = Stop::RelativeError { target: 0.001, per_wavelength: PER_WAVELENGTH };
    if name == PARTICLES {
        let mut scene =
            monte_carlo_scenario("slab", &["display.diffuser.optical_thickness=2"]).unwrap().scene;
        scene.solver.stop = stop;
        return bencher.bench(|| run_on(&scene, Some(1)).unwrap());
    }
    let (_, layers) = LAYERS.iter().find(|(of, _)| *of == name).unwrap();
    let text = format!(
        "{layers}[lighting]\nspectrum = \"D65\"\nilluminance_lx = 500\ndiffuse = 1.0\n[viewer]\ntheta_deg = 8\n\
         [solver]\nmethod = \"monte-carlo\"\n"
    );
    let folder = std::env::temp_dir();
    let mut scene = Scenario::from_text(&text, "layers.toml", &folder, &[]).unwrap().resolve().unwrap().scene;
    scene.solver.stop = stop;
    bencher.bench(|| run_on(&scene, Some(1)).unwrap());
}

#[divan::bench(args = ["indoor", "reference-pixel", "table-pixel"])]
fn resolve(bencher: Bencher<'_, '_>, name: &str) {
    bencher.bench(|| monte_carlo_scenario(name, &[]).unwrap());
}

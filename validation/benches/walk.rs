//! The Monte Carlo solver, end to end, on one core: `cargo bench -p papilio-validation --bench walk`.
//!
//! `paths` counts paths (items) per second, including all spectra; `to_0_1_percent` is the
//! CPU time from a resolved scenario to a complete result with 0.1 % in Y of every state, and
//! in every wavelength bin of every state; `resolve` is the time from the file to the scene.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::Bencher;
use divan::counter::ItemsCount;
use papilio_display::scene::{Scene, Stop};
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

#[divan::bench(args = ["overcast", "indoor", "table-pixel", "epaper", "reference-pixel"], sample_count = 5, sample_size = 1)]
fn paths(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name, Stop::Paths(PATHS));
    let views = (scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len()) as u64;
    bencher.counter(ItemsCount::new(PATHS * views)).bench(|| run_on(&scene, Some(1)).unwrap());
}

#[divan::bench(args = ["overcast", "indoor", "sunny", "table-pixel", "epaper"], consts = [false, true])]
fn to_0_1_percent<const PER_WAVELENGTH: bool>(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name, Stop::RelativeError { target: 0.001, per_wavelength: PER_WAVELENGTH });
    bencher.bench(|| run_on(&scene, Some(1)).unwrap());
}

#[divan::bench(args = ["indoor", "reference-pixel", "table-pixel"])]
fn resolve(bencher: Bencher<'_, '_>, name: &str) {
    bencher.bench(|| monte_carlo_scenario(name, &[]).unwrap());
}

//! Adding, end to end, on one core: `cargo bench -p papilio-validation --bench prepared`.
//!
//! `from_scratch` is a complete run from a resolved scene, at 1e-4 in Y of every state. The
//! others run a scene that differs in one respect, with a [`Prepared`] that has stored the rest.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::sync::atomic::AtomicBool;

use divan::Bencher;
use papilio_display::scene::{Interface, Method, Pixel, Ready, Scene, Stop, Thickness};
use papilio_display::{BrdfGrid, ConeGrid, Control, Prepared, brdf, cone};
use papilio_validation::{more_and_more, run_on, scenario};

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    divan::main();
}

fn scene(name: &str) -> Scene {
    let mut scene = scenario(name, &[]).unwrap().scene;
    scene.solver.method = Method::Adding;
    scene.solver.stop = Stop::RelativeError { target: 1e-4, per_wavelength: false };
    scene
}

/// Runs `scene` repeatedly, each time with a larger change: by 1, 2, 3, ...
fn changed(bencher: Bencher<'_, '_>, name: &str, change: impl Fn(&mut Scene, f64)) {
    let scene = scene(name);
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let mut prepared = Prepared::new(&scene, &control).unwrap();
    prepared.run(&scene, &control).unwrap();
    bencher
        .with_inputs(more_and_more(&scene, change))
        .bench_local_refs(|scene| prepared.run(scene, &control).unwrap());
}

#[divan::bench(args = ["indoor", "overcast", "sunny", "table-pixel", "epaper", "reference-pixel", "slab", "rough-glass", "cover-glass"])]
fn from_scratch(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name);
    bencher.bench(|| run_on(&scene, Some(1)).unwrap());
}

#[divan::bench(args = ["indoor", "slab"])]
fn nothing_new(bencher: Bencher<'_, '_>, name: &str) {
    changed(bencher, name, |_, _| {});
}

#[divan::bench(args = ["indoor", "slab", "cover-glass", "measured-h65"])]
fn new_light(bencher: Bencher<'_, '_>, name: &str) {
    changed(bencher, name, |scene, times| scene.lighting.directed[0].theta_deg -= 1e-3 * times);
}

#[divan::bench(args = ["indoor", "slab"])]
fn new_view(bencher: Bencher<'_, '_>, name: &str) {
    changed(bencher, name, |scene, times| scene.viewer.theta_deg[0] += 1e-3 * times);
}

#[divan::bench(args = ["indoor", "slab", "cover-glass", "measured-h65"])]
fn new_film(bencher: Bencher<'_, '_>, name: &str) {
    changed(bencher, name, |scene, times| {
        if let Pixel::Film(film) = &mut scene.display.pixel {
            film.layers[1].thickness = Thickness::Fixed(12.0 + 1e-3 * times);
        }
    });
}

#[divan::bench(args = ["indoor", "slab"])]
fn new_areas(bencher: Bencher<'_, '_>, name: &str) {
    changed(bencher, name, |scene, times| {
        if let Pixel::Film(film) = &mut scene.display.pixel {
            film.fill_factor = 0.9 - 1e-6 * times;
        }
    });
}

#[divan::bench]
fn new_front(bencher: Bencher<'_, '_>) {
    changed(bencher, "indoor", |scene, times| {
        if let Interface::Ready(Ready::Component(front)) = &mut scene.display.layers[0].interface {
            front.reflectance = front.reflectance.map(|r| r + 1e-6 * times);
        }
    });
}

#[divan::bench]
fn new_haze(bencher: Bencher<'_, '_>) {
    changed(bencher, "indoor", |scene, times| {
        if let Interface::Ready(Ready::Diffuser(diffuser)) = &mut scene.display.layers[1].interface {
            diffuser.lobe = papilio_display::scene::Lobe::KCorrelation { width: 0.05 + 1e-6 * times };
        }
    });
}

fn everywhere(threads: Option<usize>, scene: &Scene) {
    let stop = AtomicBool::new(false);
    let control = Control { threads, progress: &|_| {}, stop: &stop };
    cone(scene, ConeGrid::default(), &control).unwrap();
}

#[divan::bench(args = ["indoor", "overcast", "sky", "map", "slab"], consts = [1, 2], sample_count = 3, sample_size = 1)]
fn viewing_cone<const THREADS: usize>(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name);
    bencher.bench(|| everywhere(Some(THREADS), &scene));
}

#[divan::bench(args = ["indoor", "slab"], sample_count = 3, sample_size = 1)]
fn bsdf(bencher: Bencher<'_, '_>, name: &str) {
    let scene = scene(name);
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(2), progress: &|_| {}, stop: &stop };
    bencher.bench(|| brdf(&scene, BrdfGrid::even(10.0), &control).unwrap());
}

//! Pictures, end to end: `cargo bench -p papilio-validation --bench pictures`.
//!
//! `whole` decides the states of a picture and computes what is seen of it, with all differences, without
//! reading or writing files, on one core. `held_...` is a picture that the panel holds while light or view
//! change, as the server of the page computes it, without its response, on one and two cores.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use divan::Bencher;
use papilio_display::image::{HeldPicture, KnownLights, Screen, image};
use papilio_display::scene::Scene;
use papilio_display::{Control, Prepared};
use papilio_scenario::{ImageRequest, Resolved, Scenario};
use papilio_spectra::{LightSpectrum, Spectrum};
use papilio_validation::more_and_more;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The picture of the page, one of 0.66 megapixels, and a panel of 10.3 inch.
const SIZES: [[usize; 2]; 3] = [[480, 360], [936, 702], [1872, 1404]];

fn main() {
    divan::main();
}

fn with_picture(name: &str, [columns, rows]: [usize; 2]) -> Resolved {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../scenarios");
    let edits = [
        format!("image.file='{}'", folder.join("data/chelsea.png").display()),
        format!("display.matrix.pixels=[{columns},{rows}]"),
        "image.fit='cover'".to_owned(),
        "image.perspective=false".to_owned(),
    ];
    let file = folder.join(name).with_extension("toml");
    Scenario::load(&file, &edits).unwrap().resolve_with_picture().unwrap()
}

fn on_cores(threads: usize, stop: &AtomicBool) -> Control<'_> {
    Control { threads: Some(threads), progress: &|_| {}, stop }
}

/// Shows a picture repeatedly, each time with a larger change of the scene.
fn held(bencher: Bencher<'_, '_>, size: [usize; 2], threads: usize, change: impl Fn(&mut Scene, f64)) {
    let mut resolved = with_picture("matrix", size);
    let ImageRequest { source, settings, .. } = resolved.image.take().unwrap();
    let scene = resolved.scene;
    let stop = AtomicBool::new(false);
    let control = on_cores(threads, &stop);
    let picture = HeldPicture::new(&scene, &source, &settings, &control).unwrap();
    let (mut prepared, mut known) = (Prepared::new(&scene, &control).unwrap(), KnownLights::default());
    picture.factors_with(&scene, &mut prepared, &mut known, &control).unwrap();
    bencher
        .with_inputs(more_and_more(&scene, change))
        .bench_local_refs(|scene| picture.factors_with(scene, &mut prepared, &mut known, &control).unwrap());
}

#[divan::bench(args = SIZES, consts = [1, 2], sample_count = 10)]
fn held_illuminance<const THREADS: usize>(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    held(bencher, size, THREADS, |scene, times| scene.lighting.illuminance_lx += times);
}

#[divan::bench(args = SIZES, consts = [1, 2], sample_count = 10)]
fn held_lamp<const THREADS: usize>(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    held(bencher, size, THREADS, |scene, times| scene.lighting.directed[0].theta_deg -= 0.1 * times);
}

#[divan::bench(args = SIZES, consts = [1, 2], sample_count = 10)]
fn held_spectrum<const THREADS: usize>(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    held(bencher, size, THREADS, |scene, times| {
        let warmer = |light: &LightSpectrum| -> LightSpectrum {
            let warmer = |(k, value): (usize, &f64)| value * (1.0 + 1e-3 * times * k as f64);
            Spectrum::from_values(light.iter().enumerate().map(warmer).collect()).into()
        };
        scene.lighting.diffuse_spectrum = warmer(&scene.lighting.diffuse_spectrum);
        scene.lighting.directed[0].spectrum = warmer(&scene.lighting.directed[0].spectrum);
    });
}

#[divan::bench(args = SIZES, consts = [1, 2], sample_count = 10)]
fn held_view<const THREADS: usize>(bencher: Bencher<'_, '_>, size: [usize; 2]) {
    held(bencher, size, THREADS, |scene, times| scene.viewer.theta_deg[0] += 0.1 * times);
}

#[divan::bench(args = ["matrix", "six-ink", "reader"], sample_count = 3)]
fn whole(bencher: Bencher<'_, '_>, name: &str) {
    let resolved = with_picture(name, SIZES[2]);
    let request = resolved.image.as_ref().unwrap();
    let stop = AtomicBool::new(false);
    bencher.bench_local(|| {
        let screen = Screen::default();
        image(&resolved.scene, &request.source, &request.settings, screen, &on_cores(1, &stop)).unwrap()
    });
}

//! Places of light, end to end, on one core: `cargo bench -p papilio-validation --bench spatial`.
//!
//! `mtf` and `crosstalk` are all numbers of the commands from a resolved scene, at two levels; `picture` is
//! X, Y and Z of each of 1404 x 1872 pixels of electronic paper under its cover, with the error; compare the
//! kernels alone: `cargo bench -p papilio-transport`.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::sync::atomic::AtomicBool;

use divan::Bencher;
use papilio_display::Control;
use papilio_display::spatial::{Picture, Precision, crosstalk, mtf, picture};
use papilio_validation::scenario;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    divan::main();
}

static STOP: AtomicBool = AtomicBool::new(false);

fn control() -> Control<'static> {
    Control { threads: Some(1), progress: &|_| {}, stop: &STOP }
}

#[divan::bench(name = "mtf", args = ["matrix", "laminate-thickness", "double-image", "laminated-text"], sample_count = 5, sample_size = 1)]
fn sharpness(bencher: Bencher<'_, '_>, name: &str) {
    let display = scenario(name, &[]).unwrap();
    bencher.bench(|| mtf(&display.scene, &display.patterns, &control()).unwrap());
}

#[divan::bench(name = "crosstalk", args = ["matrix", "laminated-text", "printed-filter"], sample_count = 5, sample_size = 1)]
fn shares(bencher: Bencher<'_, '_>, name: &str) {
    let display = scenario(name, &[]).unwrap();
    bencher.bench(|| crosstalk(&display.scene, &display.patterns.text, &control()).unwrap());
}

#[divan::bench(name = "picture", sample_count = 3, sample_size = 1)]
fn page(bencher: Bencher<'_, '_>) {
    let display = scenario("laminated-text", &[]).unwrap();
    let count = [1404, 1872];
    let state = |x: usize, y: usize| u8::from((x / 3 * 7 + y / 2 * 5 + x * y / 11).is_multiple_of(3));
    let states = (0..count[1]).flat_map(|y| (0..count[0]).map(move |x| state(x, y))).collect();
    let page = Picture { count, states };
    bencher.bench(|| picture(&display.scene, &page, Precision::FAST, &control()).unwrap());
}

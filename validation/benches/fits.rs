//! Fits to measured spectra, on one core: `cargo bench -p papilio-validation --bench fits`.
//!
//! `eight_keys`: gaps, films, fill factor and level of `scenarios/fit.toml`, from the spectra of all eight states through its
//! diffuser (648 numbers with noise), from four starts, with intervals by profile likelihood.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::path::Path;
use std::sync::atomic::AtomicBool;

use divan::Bencher;
use papilio_design::fit::Fitting;
use papilio_display::compare::{Measured, Measurement, Quantity, StandardDeviation};
use papilio_display::{Control, run};
use papilio_scenario::Fit;
use papilio_spectra::Tabulated;
use papilio_validation::scenario;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    divan::main();
}

/// Spectra of the states of a display that differs from the scenario, with noise of 0.0005.
fn measurement() -> Measurement {
    let changed = ["display.pixel.gap_nm.red=271", "display.pixel.film.1.thickness_nm=11.6"];
    let scene = scenario("fit", &changed).unwrap().scene;
    let stop = AtomicBool::new(false);
    let result = run(&scene, &Control { threads: Some(1), progress: &|_| {}, stop: &stop }).unwrap();
    let nm = scene.grid.wavelengths_nm();
    let mut state: u64 = 1;
    // Three uniform numbers of a congruential generator: the sum has a standard deviation of 0.5.
    let mut noise = || {
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        1e-3 * (next() + next() + next())
    };
    let states = result.views[0].states.iter().map(|(name, state)| {
        let factors = state.value.reflectance_factor.as_ref().unwrap();
        let values = factors.iter().map(|value| value + noise()).collect();
        let deviation = Tabulated::new(nm.clone(), vec![5e-4; nm.len()]).unwrap();
        Measured {
            state: name.to_owned(),
            theta_deg: None,
            phi_deg: 0.0,
            quantity: Quantity::Spectrum(Tabulated::new(nm.clone(), values).unwrap()),
            standard_deviation: Some(StandardDeviation::Spectrum(deviation)),
        }
    });
    Measurement { states: states.collect(), metrics: Vec::new() }
}

#[divan::bench(sample_count = 5)]
fn eight_keys(bencher: Bencher<'_, '_>) {
    let measured = measurement();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/fit.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let stop = AtomicBool::new(false);
    bencher.bench_local(|| {
        let spec = Fit::from_text(&text, "fit.toml", path.parent().unwrap(), &[]).unwrap();
        Fitting::new(spec, &measured, &stop).unwrap().run(1, &|_, _| {}).unwrap().unwrap()
    });
}

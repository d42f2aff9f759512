//! Liquid-crystal displays: time per wave, which is a wavelength, a direction and a state.
//!
//! divan prints items per second; an item is the reflectance of one wave. The rows of the task: 81 wavelengths x 50 inclinations
//! x 36 azimuths x 2 states, 291 600 waves through five layers and 40 slices of a cell.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::counter::ItemsCount;
use num_complex::Complex64;
use papilio_optics::berreman::{Part, Slice, SpectralStack, axes};

fn main() {
    divan::main();
}

const BINS: usize = 81;
const SLICES: usize = 40;

/// `thick`: the polariser and the retarders have no fringes.
fn stack(thick: bool) -> SpectralStack {
    let wavelength_nm: Vec<f64> = (0..BINS).map(|k| 380.0 + 5.0 * k as f64).collect();
    let constant = |n: f64, k: f64| vec![Complex64::new(n, k); BINS];
    let plate = |n_e: Complex64, azimuth_deg: f64, um: f64| Part {
        indices: [vec![n_e; BINS], constant(1.5, 0.0), constant(1.5, 0.0)],
        slices: vec![vec![Slice { axes: axes(azimuth_deg, 0.0, 0.0), thickness_nm: 1e3 * um }]],
        repeats: 1,
        rest: 0,
        coherent: !thick || um < 1.0,
    };
    let twisted = |tilt_deg: f64| {
        let slice = |k: usize| Slice {
            axes: axes(63.6 * (k as f64 + 0.5) / SLICES as f64, tilt_deg, 0.0),
            thickness_nm: 3200.0 / SLICES as f64,
        };
        (0..SLICES).map(slice).collect()
    };
    let cell = Part {
        indices: [constant(1.6, 0.0), constant(1.5, 0.0), constant(1.5, 0.0)],
        slices: vec![twisted(2.0), twisted(60.0)],
        repeats: 1,
        rest: 0,
        coherent: true,
    };
    let parts = [
        plate(Complex64::new(1.5, 0.005), 90.0, 20.0),
        plate(1.51.into(), 15.0, 27.5),
        plate(1.51.into(), 75.0, 13.75),
        plate(1.8.into(), 0.0, 0.1),
        cell,
        plate(1.9.into(), 0.0, 0.05),
    ];
    SpectralStack::new(&wavelength_nm, &[1.5; BINS], &parts, &constant(0.9656, 6.4581)).unwrap()
}

#[divan::bench(args = [false, true], sample_count = 5, sample_size = 1)]
fn fifty_inclinations_and_36_azimuths(bencher: divan::Bencher<'_, '_>, thick: bool) {
    let stack = stack(thick);
    // By reciprocity, unpolarised light is reflected in the same way towards opposite azimuths.
    let azimuths_deg: Vec<f64> = (0..18).map(|k| 10.0 * f64::from(k)).collect();
    let mut out = vec![0.0; 18 * 2 * BINS];
    bencher.counter(ItemsCount::new(2 * BINS * 50 * 36)).bench_local(|| {
        for inclination in 0..50 {
            let beta = [0.02 * f64::from(inclination); BINS];
            stack.reflectance(&beta, &azimuths_deg, &mut out).unwrap();
            divan::black_box(&out);
        }
    });
}

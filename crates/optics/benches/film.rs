//! The film kernel: time per (wavelength, beta, gap, polarisation), amortised over the gaps.
//!
//! divan prints items per second; an item is one reflectance of one polarisation.
//! 1 Gitem/s is 1 ns.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::counter::ItemsCount;
use num_complex::Complex64;
use papilio_optics::film::{
    Film, GapFilm, Layer, Polarisation, SimdLevel, SpectralLayer, Thickness, Variable, coherent,
};
use papilio_spectra::{Grid, material};

fn main() {
    divan::main();
}

const ANGLES: usize = 91;

/// The reference IMOD stack under glass, 380 to 780 nm in steps of 5.
fn imod() -> GapFilm {
    let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
    let on = |name: &str| material(name).and_then(|m| m.on(&grid)).unwrap();
    let fixed = |name, nm| SpectralLayer { index: on(name), thickness: Thickness::Fixed(nm) };
    let layers = [
        fixed("Si3N4", 55.9),
        fixed("Cr:Johnson", 12.15),
        fixed("SiO2", 38.6),
        fixed("AlOx", 9.0),
        SpectralLayer { index: on("air"), thickness: Thickness::Gap },
    ];
    let glass = vec![1.5; grid.len()];
    GapFilm::new(&grid.wavelengths_nm(), &glass, &layers, &on("Al")).unwrap()
}

fn levels() -> Vec<SimdLevel> {
    SimdLevel::available()
}

/// `gaps` gaps at 91 betas from 0 to just below `beta_max`.
fn sweep(bencher: divan::Bencher<'_, '_>, level: SimdLevel, gaps: usize, beta_max: f64) {
    let film = imod().with_simd_level(level);
    let beta: Vec<f64> = (0..ANGLES).map(|i| beta_max * i as f64 / ANGLES as f64).collect();
    let gaps_nm: Vec<f64> = (0..gaps).map(|i| 20.0 + 260.0 * i as f64 / gaps as f64).collect();
    let mut out = vec![0.0; ANGLES * gaps * film.wavelengths()];
    bencher
        .counter(ItemsCount::new(2 * out.len()))
        .bench_local(|| film.reflectance(&beta, &gaps_nm, divan::black_box(&mut out)));
}

/// Directions that travel in the gap.
#[divan::bench(args = levels(), consts = [1, 4, 32])]
fn travelling<const GAPS: usize>(bencher: divan::Bencher<'_, '_>, level: &SimdLevel) {
    sweep(bencher, *level, GAPS, 1.0);
}

/// All directions in the glass, a third of them evanescent in the gap.
#[divan::bench(args = levels(), consts = [4, 32])]
fn all_in_glass<const GAPS: usize>(bencher: divan::Bencher<'_, '_>, level: &SimdLevel) {
    sweep(bencher, *level, GAPS, 1.5);
}

/// The same with derivatives: by all thicknesses, and by every n besides.
#[divan::bench(args = levels(), consts = [false, true])]
fn derivatives<const INDEX: bool>(bencher: divan::Bencher<'_, '_>, level: &SimdLevel) {
    let film = imod().with_simd_level(*level);
    let beta: Vec<f64> = (0..ANGLES).map(|i| 1.5 * i as f64 / ANGLES as f64).collect();
    let gaps_nm = [20.0, 85.0, 150.0, 215.0];
    let mut variables: Vec<Variable> = (0..5).map(Variable::Thickness).collect();
    variables.extend((0..5).map(Variable::Index).filter(|_| INDEX));
    let mut reflectance = vec![0.0; ANGLES * gaps_nm.len() * film.wavelengths()];
    let mut out = vec![0.0; variables.len() * reflectance.len()];
    bencher.counter(ItemsCount::new(2 * reflectance.len())).bench_local(|| {
        film.derivatives(&beta, &gaps_nm, &variables, &mut reflectance, divan::black_box(&mut out))
    });
}

/// The reference implementation, for comparison: one wavelength and direction of the same stack.
#[divan::bench]
fn plain(bencher: divan::Bencher<'_, '_>) {
    let layer = |n: f64, k: f64, thickness_nm| Layer { index: Complex64::new(n, k), thickness_nm };
    let layers = vec![
        layer(2.02, 0.0, 55.9),
        layer(3.18, 3.33, 12.15),
        layer(1.46, 0.0, 38.6),
        layer(1.0, 0.0, 192.3),
    ];
    let film = Film { incidence: 1.5, layers, substrate: Complex64::new(0.9656, 6.4581) };
    bencher
        .counter(ItemsCount::new(1_usize))
        .bench_local(|| coherent(divan::black_box(&film), 550.0, 0.5, Polarisation::P));
}

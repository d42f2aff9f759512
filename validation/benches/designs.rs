//! Designs with a stored kernel, on one core: `cargo bench -p papilio-validation --bench designs`.
//!
//! The indoor scenario (8 states, 81 wavelengths) at its own target; items are designs. `thicknesses` and
//! `gaps` change only these, `all` both; they compute X, Y, Z, L*, a*, b* of all states, gamut and contrast.
//! `run` is the same with `Prepared::run`: two levels and all metrics with their errors. `gradient`: gamut,
//! contrast and Y of white with derivatives by 4 thicknesses, 4 gaps, 3 areas and the fill factor;
//! `gradient_of_one`: only the gamut.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::sync::atomic::AtomicBool;

use divan::Bencher;
use divan::counter::ItemsCount;
use papilio_display::scene::{FilmPixel, Metric, Pixel, Scene, Thickness};
use papilio_display::{Control, Designs, Parameter, Prepared, Quantity};
use papilio_validation::scenario;

/// As in the program.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() {
    divan::main();
}

fn scene() -> (Scene, FilmPixel) {
    let scene = scenario("indoor", &[]).unwrap().scene;
    let Pixel::Film(film) = scene.display.pixel.clone() else { unreachable!() };
    (scene, film)
}

fn together(metric: Metric) -> Quantity {
    Quantity::Metric { view: 0, state: None, metric }
}

fn few() -> Vec<Quantity> {
    let white = Quantity::Metric { view: 0, state: Some("white".to_owned()), metric: Metric::Y };
    vec![together(Metric::gamut_percent_srgb), together(Metric::contrast_ratio), white]
}

fn many(film: &FilmPixel) -> Vec<Quantity> {
    let mut all = few();
    for state in &film.states {
        let of = |metric| Quantity::Metric { view: 0, state: Some(state.name.clone()), metric };
        all.extend([Metric::X, Metric::Y, Metric::Z, Metric::L_star, Metric::a_star, Metric::b_star].map(of));
    }
    all
}

/// Returns design number `times`. All designs are different, and close to the first, so that the nodes remain
/// the same.
fn changed(film: &FilmPixel, times: f64, thicknesses: bool, gaps: bool) -> FilmPixel {
    let mut film = film.clone();
    for layer in film.layers.iter_mut().filter(|_| thicknesses) {
        if let Thickness::Fixed(nm) = &mut layer.thickness {
            *nm *= 1.0 + 1e-6 * times;
        }
    }
    film.sub_pixels.iter_mut().filter(|_| gaps).for_each(|sub_pixel| sub_pixel.gap_nm += 1e-4 * times);
    film.dark_gap_nm = film.dark_gap_nm.map(|nm| if gaps { nm + 1e-4 * times } else { nm });
    film
}

fn designs(scene: &Scene, quantities: &[Quantity]) -> Designs {
    let stop = AtomicBool::new(false);
    Designs::new(scene, quantities, &Control { threads: Some(1), progress: &|_| {}, stop: &stop }).unwrap()
}

fn evaluated(bencher: Bencher<'_, '_>, thicknesses: bool, gaps: bool) {
    let (scene, film) = scene();
    let mut designs = designs(&scene, &many(&film));
    let mut times = 0.0;
    let next = || {
        times += 1.0;
        changed(&film, times, thicknesses, gaps)
    };
    let bencher = bencher.counter(ItemsCount::new(1_usize)).with_inputs(next);
    bencher.bench_local_refs(|film| designs.evaluate(film).unwrap());
}

#[divan::bench]
fn thicknesses(bencher: Bencher<'_, '_>) {
    evaluated(bencher, true, false);
}

#[divan::bench]
fn gaps(bencher: Bencher<'_, '_>) {
    evaluated(bencher, false, true);
}

#[divan::bench]
fn all(bencher: Bencher<'_, '_>) {
    evaluated(bencher, true, true);
}

#[divan::bench]
fn run(bencher: Bencher<'_, '_>) {
    let (scene, film) = scene();
    let stop = AtomicBool::new(false);
    let control = Control { threads: Some(1), progress: &|_| {}, stop: &stop };
    let mut prepared = Prepared::new(&scene, &control).unwrap();
    let mut times = 0.0;
    let next = || {
        times += 1.0;
        let pixel = Pixel::Film(changed(&film, times, true, true));
        let mut next = scene.clone();
        next.display.pixel = pixel;
        next
    };
    let bencher = bencher.counter(ItemsCount::new(1_usize)).with_inputs(next);
    bencher.bench_local_refs(|scene| prepared.run(scene, &control).unwrap());
}

fn differentiated(bencher: Bencher<'_, '_>, quantities: &[Quantity]) {
    let (scene, film) = scene();
    let mut designs = designs(&scene, quantities);
    let thickness = (0..4).map(|layer| Parameter::Thickness { layer });
    let of_sub_pixels = (0..3)
        .flat_map(|sub_pixel| [Parameter::Gap { sub_pixel }, Parameter::Area { sub_pixel }])
        .chain([Parameter::DarkGap, Parameter::FillFactor]);
    let parameters: Vec<Parameter> = thickness.chain(of_sub_pixels).collect();
    let mut times = 0.0;
    let next = || {
        times += 1.0;
        changed(&film, times, true, true)
    };
    let bencher = bencher.counter(ItemsCount::new(1_usize)).with_inputs(next);
    bencher.bench_local_refs(|film| designs.derivatives(film, &parameters).unwrap());
}

#[divan::bench]
fn gradient(bencher: Bencher<'_, '_>) {
    differentiated(bencher, &few());
}

#[divan::bench]
fn gradient_of_one(bencher: Bencher<'_, '_>) {
    differentiated(bencher, &few()[..1]);
}

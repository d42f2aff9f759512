//! Gamut mapping and coverages, on one core: `cargo bench -p papilio-colour --bench mapping`. `picture` and
//! `coverages` compute 1404 x 1872 pixels.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::{Bencher, black_box};
use papilio_colour::mapping::{DisplayColours, GamutMapping, GamutTable, Intent, MapSpace, SourceSpace};
use papilio_colour::states::{LeastVariance, StateHull};
use papilio_colour::{Surround, Viewing, Xyz};

fn main() {
    divan::main();
}

const PIXELS: usize = 1404 * 1872;
const ROOM: Viewing =
    Viewing { adapting_luminance_cd_m2: 30.0, background: 0.2, surround: Surround::Average };
const CASES: [&str; 4] = ["relative", "natural", "clip", "relative cam16-ucs"];

/// Black, white, yellow, red, blue, green.
fn inks() -> Vec<Xyz> {
    [
        [0.03, 0.03, 0.021],
        [0.6, 0.6, 0.42],
        [0.45, 0.5, 0.06],
        [0.17, 0.12, 0.05],
        [0.08, 0.08, 0.2],
        [0.1, 0.17, 0.08],
    ]
    .map(|[x, y, z]| Xyz { x, y, z })
    .to_vec()
}

fn mapping(case: &str) -> GamutMapping {
    let states = inks();
    let (intent, space) = match case {
        "natural" => (Intent::Natural, MapSpace::Oklab),
        "clip" => (Intent::Clip, MapSpace::Oklab),
        "relative cam16-ucs" => (Intent::Relative, MapSpace::Cam16Ucs(ROOM)),
        _ => (Intent::Relative, MapSpace::Oklab),
    };
    let display =
        DisplayColours { white: states[1], black: states[0], perfect_white: Xyz { x: 1.0, y: 1.0, z: 0.7 } };
    GamutMapping::new(StateHull::new(&states).unwrap(), display, SourceSpace::Srgb, intent, space).unwrap()
}

/// Linear RGB of pixel `k` of a picture with all colours.
fn pixel(k: usize) -> [f64; 3] {
    [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|step| (step * k as f64).fract().powi(2))
}

#[divan::bench(args = CASES, sample_count = 3, sample_size = 1)]
fn table(bencher: Bencher<'_, '_>, case: &str) {
    let mapping = mapping(case);
    bencher.bench(|| GamutTable::new(&mapping, GamutTable::LEVELS));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn picture(bencher: Bencher<'_, '_>) {
    let table = GamutTable::new(&mapping("relative"), GamutTable::LEVELS);
    let pixels: Vec<_> = (0..PIXELS).map(pixel).collect();
    bencher.bench(|| pixels.iter().map(|rgb| table.map(*rgb)).collect::<Vec<_>>());
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn coverages(bencher: Bencher<'_, '_>) {
    let states = inks();
    let table = GamutTable::new(&mapping("relative"), GamutTable::LEVELS);
    let colours: Vec<_> = (0..PIXELS).map(|k| table.map(pixel(k))).collect();
    let solver = LeastVariance::new(&states).unwrap();
    bencher.bench(|| colours.iter().filter_map(|colour| black_box(solver.coverages(*colour))).count());
}

/// Triangulation and hull of 6, 16 and 64 states.
#[divan::bench(args = [6, 16, 64], sample_count = 3, sample_size = 1)]
fn states(bencher: Bencher<'_, '_>, count: usize) {
    let states: Vec<_> = (1..=count)
        .map(|k| {
            let [x, y, z] = pixel(k);
            Xyz { x, y, z }
        })
        .collect();
    bencher.bench(|| (LeastVariance::new(&states).unwrap(), StateHull::new(&states).unwrap()));
}

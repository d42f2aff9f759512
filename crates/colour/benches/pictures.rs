//! Differences of pictures of 1404 x 1872 pixels, on one core:
//! `cargo bench -p papilio-colour --bench pictures`. Each compares one picture with two others, as
//! `papilio image` does.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::{Bencher, black_box};
use papilio_colour::D65_WHITE;
use papilio_colour::pictures::{FlipPicture, MappedPicture, Picture, Reader, compared, scielab};

fn main() {
    divan::main();
}

const SIZE: [usize; 2] = [1404, 1872];
const PIXELS_PER_DEGREE: f64 = 82.0;

/// Waves of colour.
fn picture(number: usize) -> Picture {
    let value = |k: usize, plane: usize| {
        let (x, y) = ((k % SIZE[0]) as f64, (k / SIZE[0]) as f64);
        let (across, down) = (0.003 * (plane + number + 1) as f64, 0.005 * (plane + 2) as f64);
        0.3 + 0.25 * (across * x).sin() * (down * y).cos()
    };
    let plane = |plane: usize| (0..SIZE[0] * SIZE[1]).map(|k| value(k, plane)).collect();
    Picture::new(SIZE[0], [plane(0), plane(1), plane(2)]).unwrap()
}

#[divan::bench(sample_count = 3)]
fn ciede2000(bencher: Bencher<'_, '_>) {
    let pictures = [0, 1, 2].map(picture);
    bencher.bench_local(|| {
        let [own, one, other] = pictures.clone().map(|picture| picture.into_lab(D65_WHITE).unwrap());
        black_box([own.delta_e_2000(&one).unwrap(), own.delta_e_2000(&other).unwrap()])
    });
}

#[divan::bench(sample_count = 3)]
fn s_cielab(bencher: Bencher<'_, '_>) {
    let pictures = [0, 1, 2].map(picture);
    bencher.bench_local(|| {
        let [own, one, other] = scielab(pictures.clone(), D65_WHITE, PIXELS_PER_DEGREE).unwrap();
        black_box([own.delta_e_2000(&one).unwrap(), own.delta_e_2000(&other).unwrap()])
    });
}

#[divan::bench(sample_count = 3)]
fn flip(bencher: Bencher<'_, '_>) {
    let pictures = [0, 1, 2].map(picture);
    bencher.bench_local(|| {
        let [own, one, other] =
            pictures.each_ref().map(|picture| FlipPicture::new(picture, PIXELS_PER_DEGREE));
        black_box([own.differences(&one).unwrap(), own.differences(&other).unwrap()])
    });
}

/// All of them row by row, as for large pictures.
#[divan::bench(sample_count = 3)]
fn row_by_row(bencher: Bencher<'_, '_>) {
    let pictures = [0, 1, 2].map(|number| {
        picture(number).pixels().map(|pixel| pixel.map(|value| value as f32)).collect::<Vec<_>>()
    });
    let [own, one, other] = pictures.each_ref().map(Vec::as_slice);
    let reader =
        Reader { white: D65_WHITE, per_degree: PIXELS_PER_DEGREE, coloured: [8.0, 2.0], window: 6, step: 1 };
    bencher.bench_local(|| {
        black_box(compared(own, [one, other].map(MappedPicture::from), SIZE[0], reader, 1).unwrap())
    });
}

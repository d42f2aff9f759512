//! Halftones of a page of 1404 x 1872 pixels in eight states, and a mask.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use std::ops::ControlFlow;

use divan::{Bencher, black_box};
use papilio_imaging::halftone::{
    DiffusionKernel, ErrorDiffusion, Filter, Mask, SearchControl, SearchPass, direct_binary_search,
    light_to_dark, ordered, ordered_planes,
};

fn main() {
    divan::main();
}

const COLUMNS: usize = 1404;
const PIXELS: usize = COLUMNS * 1872;

/// The eight states of three sub-pixels.
fn palette() -> Vec<[f64; 3]> {
    let inks = [[0.15, 0.08, 0.01], [0.13, 0.26, 0.04], [0.07, 0.03, 0.35]];
    let of = |state: usize| {
        let coordinate = |k| 0.02 + (0..3).map(|ink| ((state >> ink) & 1) as f64 * inks[ink][k]).sum::<f64>();
        std::array::from_fn(coordinate)
    };
    (0..8).map(of).collect()
}

/// Coverages of three planes that vary smoothly over the page.
fn coverage(plane: usize) -> Vec<f32> {
    let at = |at: usize| {
        let (x, y) = ((at % COLUMNS) as f32, (at / COLUMNS) as f32);
        0.5 + 0.5 * (0.004 * x + 0.003 * y * (1 + plane) as f32).sin()
    };
    (0..PIXELS).map(at).collect()
}

fn wanted() -> Vec<[f32; 3]> {
    let (planes, palette) = ([0, 1, 2].map(coverage), palette());
    let colour = |at: usize| {
        std::array::from_fn(|k| {
            let sum: f64 =
                (0..3).map(|ink| f64::from(planes[ink][at]) * (palette[1 << ink][k] - palette[0][k])).sum();
            (palette[0][k] + sum) as f32
        })
    };
    (0..PIXELS).map(colour).collect()
}

#[divan::bench(args = [DiffusionKernel::FloydSteinberg, DiffusionKernel::Jarvis, DiffusionKernel::Sierra])]
fn error_diffusion_of_a_page(bencher: Bencher<'_, '_>, kernel: DiffusionKernel) {
    let (wanted, palette) = (wanted(), palette());
    let settings = ErrorDiffusion { kernel, ..ErrorDiffusion::default() };
    bencher.bench_local(|| settings.colours(black_box(&wanted), COLUMNS, &palette).unwrap());
}

#[divan::bench]
fn error_diffusion_of_one_plane(bencher: Bencher<'_, '_>) {
    let plane = coverage(0);
    bencher
        .bench_local(|| ErrorDiffusion::default().levels(black_box(&plane), COLUMNS, &[0.0, 1.0]).unwrap());
}

#[divan::bench]
fn ordered_page_of_eight_states(bencher: Bencher<'_, '_>) {
    let [red, green, blue] = [0, 1, 2].map(coverage);
    let share = |on: bool, value: f32| if on { value } else { 1.0 - value };
    let coverages: Vec<f32> = (0..8 * PIXELS)
        .map(|k| {
            let (at, state) = (k / 8, k % 8);
            share(state & 1 > 0, red[at]) * share(state & 2 > 0, green[at]) * share(state & 4 > 0, blue[at])
        })
        .collect();
    let (mask, order) = (Mask::bayer(8).unwrap(), light_to_dark(&palette()));
    bencher.bench_local(|| ordered(black_box(&coverages), COLUMNS, &order, &mask).unwrap());
}

#[divan::bench]
fn ordered_page_of_three_planes(bencher: Bencher<'_, '_>) {
    let [red, green, blue] = [0, 1, 2].map(coverage);
    let mask = Mask::bayer(8).unwrap();
    let planes = [(&red[..], &mask), (&green[..], &mask), (&blue[..], &mask)];
    bencher.bench_local(|| ordered_planes(black_box(&planes), COLUMNS).unwrap());
}

#[divan::bench]
fn void_and_cluster_mask_of_64() -> Mask {
    Mask::void_and_cluster(64, 0).unwrap()
}

/// A part of the page, from error diffusion, with a filter of 13 x 13 pixels.
#[divan::bench(sample_count = 5)]
fn direct_binary_search_of_256_by_256(bencher: Bencher<'_, '_>) {
    let (wanted, palette) = (wanted(), palette());
    let wanted: Vec<[f32; 3]> = (0..256).flat_map(|row| &wanted[row * COLUMNS..][..256]).copied().collect();
    let start = ErrorDiffusion::default().colours(&wanted, 256, &palette).unwrap().states;
    let bell =
        |at: usize| (-(((at % 13) as f64 - 6.0).powi(2) + ((at / 13) as f64 - 6.0).powi(2)) / 8.0).exp();
    let metric = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let filters = [0; 3].map(|_| Filter::new(13, (0..169).map(bell).collect()).unwrap());
    bencher.bench_local(|| {
        let watch = &mut |_| ControlFlow::Continue(());
        let control =
            SearchControl { fixed: &[], few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
        direct_binary_search(&wanted, 256, (&palette, metric), &filters, &start, control).unwrap()
    });
}

/// The whole page in six states with three passes, from error diffusion, as `papilio image` does by default.
#[divan::bench(sample_count = 3)]
fn three_passes_of_a_page(bencher: Bencher<'_, '_>) {
    let (wanted, palette) = (wanted(), &palette()[..6]);
    let start = ErrorDiffusion::default().colours(&wanted, COLUMNS, palette).unwrap().states;
    let metric = [[0.0, 2.0, 0.0], [3.4, -3.4, 0.0], [0.0, 1.9, -1.9]];
    let filters = [(0.83, 16.0), (1.14, 8.0), (1.53, 8.0)].map(|(sigma, mean): (f64, f64)| {
        let reach = (3.0 * sigma).ceil() as i32;
        let bell = |at: i32| (-0.5 * (f64::from(at) / sigma).powi(2)).exp() / sigma / 2.507;
        let values = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| bell(x) * bell(y)));
        Filter::new(2 * reach as usize + 1, values.collect()).unwrap().keeping_means(mean)
    });
    bencher.bench_local(|| {
        let watch = &mut |pass: SearchPass| match pass.pass {
            3 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        };
        let control =
            SearchControl { fixed: &[], few: &[], allowed: &[], threads: 1, stop: &|| false, watch };
        direct_binary_search(&wanted, COLUMNS, (palette, metric), &filters, &start, control).unwrap()
    });
}

//! Spread of an ordinary panel: a film pixel of three sub-pixels and eight states at 81 wavelengths under
//! H78.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark")]

use divan::{Bencher, black_box};
use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_transport::spatial::{
    Accuracy, FaceReturn, LambertianReturn, LineSpread, LitPage, Page, PageLight, PanelSpread, Precision,
};
use papilio_transport::{
    AngularTable, Base, Cone, Diffuser, Front, Medium, Nodes, Panel, Reflector, Source, Top,
};

fn main() {
    divan::main();
}

const BINS: usize = 81;

fn panel() -> Panel {
    let (nodes, basis) = (65, 4);
    let value = |node: usize, k: usize| 0.5 + 0.4 * (0.1 * node as f64 + 0.05 * k as f64).sin();
    let values = (0..nodes).flat_map(|node| (0..basis * BINS).map(move |k| value(node, k)));
    let table = AngularTable {
        nodes: Nodes::Cosines(nodes),
        basis: values.collect::<Vec<f64>>().into(),
        mixture: (0..8 * basis).map(|k| f64::from(u8::from(k % 3 == 0))).collect(),
        common: vec![0.01; BINS],
    };
    let lobe = Lobe::KCorrelation { width: 0.05667 };
    let transmittance = vec![0.95; BINS].into();
    Panel {
        front: Front::none(BINS),
        components: Vec::new(),
        polarisation: None,
        keeps_s_and_p: false,
        top: Top::Diffuser(Diffuser { lobe, transmittance, regular_fraction: 0.0 }),
        medium: Medium::new(vec![1.5; BINS].into()),
        base: Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0; BINS].into() },
        gaps_mm: vec![0.5],
        single_pass: false,
        mueller: None,
        whole: None,
        run: None,
    }
}

fn lights() -> [Source; 3] {
    [Source::Diffuse, Source::Beam(Beta { x: 0.3, y: 0.0 }), Source::Disc(Cone::new(-20.0, 0.0, 0.27, 1.0))]
}

fn spread(panel: &Panel, light: usize) -> PanelSpread {
    let accuracy = Accuracy { digits: 8.0, most_per_mm: 10.0 };
    PanelSpread::new(panel, &Cone::new(0.0, 0.0, 0.0, 1.0), &lights()[light], accuracy).unwrap()
}

#[divan::bench(args = [0, 1, 2])]
fn prepare(bencher: Bencher<'_, '_>, light: usize) {
    let panel = panel();
    bencher.bench(|| spread(black_box(&panel), light));
}

#[divan::bench(args = [0, 1, 2])]
fn strips(bencher: Bencher<'_, '_>, light: usize) {
    let panel = panel();
    let spread = spread(&panel, light);
    let edges: Vec<f64> = (-64..=64).map(|k| 0.01 * f64::from(k)).collect();
    bencher.bench(|| spread.point_spread(&spread.parts()[0]).strips(0, black_box(&edges)));
}

/// What a front 0.2 mm above a lobe returns to Lambertian pixels, tabulated for all frequencies.
#[divan::bench]
fn return_through_a_lobe(bencher: Bencher<'_, '_>) {
    let mut panel = panel();
    panel.front = Front::exact(BINS, [(&[0.05; BINS][..], &[0.0; BINS][..])]);
    panel.gaps_mm = vec![0.2, 0.5];
    let accuracy = Accuracy { digits: 13.0, most_per_mm: 16.0 };
    bencher.bench(|| LambertianReturn::all(black_box(&panel), accuracy).unwrap().len());
}

/// Line spread of eight states of Y, and its transform at 64 frequencies.
#[divan::bench(args = [0, 1, 2])]
fn line(bencher: Bencher<'_, '_>, light: usize) {
    let panel = panel();
    let spread = spread(&panel, light);
    let points = spread.point_spread(&spread.parts()[0]);
    let reflectance = |beta_squared: f64, y: &mut [f64]| {
        y.iter_mut().enumerate().for_each(|(k, y)| *y = 1.0 - 0.01 * k as f64 * beta_squared);
    };
    bencher.bench(|| {
        let line = LineSpread::new(black_box(&points), 0, 8, reflectance);
        let mut sums = [Complex64::ZERO; 8];
        (0..64).for_each(|k| line.add_transfer(10.0 / 63.0 * f64::from(k), &mut sums));
        sums
    });
}

/// Return of bare glass at 6400 frequencies.
#[divan::bench]
fn face_return(bencher: Bencher<'_, '_>) {
    let transmittance = |beta: f64| 1.0 - papilio_optics::interface::fresnel_reflectance(1.5, 1.0, beta);
    bencher.bench(|| {
        let face = FaceReturn::new(1.5, 1.0, 16.0, transmittance).tabulated();
        (0..6400).map(|k| face.at(0.0025 * f64::from(k))).sum::<f64>()
    });
}

/// Recycled light of 1404 x 1872 pixels in eight states at 81 wavelengths: X, Y and Z of each pixel to about
/// 1e-3.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn page(bencher: Bencher<'_, '_>) {
    let count = [1404, 1872];
    let state = |x: usize, y: usize| ((x / 3 * 7 + y / 2 * 5 + x * y / 11) % 8) as u8;
    let states: Vec<u8> = (0..count[1]).flat_map(|y| (0..count[0]).map(move |x| state(x, y))).collect();
    let bell = |bin: usize, middle: f64| (-((bin as f64 - middle) / 12.0).powi(2)).exp();
    let reflectance: Vec<Vec<f64>> = (0..8)
        .map(|state| (0..BINS).map(|bin| 0.03 + 0.57 * bell(bin, 10.0 * f64::from(state))).collect())
        .collect();
    let seen: Vec<[Vec<f64>; 3]> = reflectance
        .iter()
        .map(|rho| {
            [55.0, 40.0, 15.0].map(|middle| {
                rho.iter().enumerate().map(|(bin, rho)| 0.018 * rho * bell(bin, middle)).collect()
            })
        })
        .collect();
    bencher.bench(|| {
        let light = PageLight { reflectance: &reflectance, seen: &seen };
        let page = Page { count, pitch_mm: [0.084_67; 2], states: &states };
        let transmittance = |beta: f64| 1.0 - papilio_optics::interface::fresnel_reflectance(1.5, 1.0, beta);
        let face = FaceReturn::new(1.5, 0.5, 10.0, transmittance).tabulated();
        LitPage::new(&page, &|f| face.at(f), light, Precision::FAST, 0.5).seen(&page, light).len()
    });
}

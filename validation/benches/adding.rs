//! The deterministic solver of a panel on one core: `cargo bench -p papilio-validation --bench adding`.
//!
//! The indoor panel (78 % haze, front 0.5 %) over a pixel with 33 cosines, 4 gaps, 81 wavelengths and
//! 8 states, at the levels that a target of 1e-4 needs. `from_scratch`: kernels and estimates;
//! `narrow_from_scratch`: the same of narrow lobes under a front of 2 %; `diffuse`,
//! `beam`: the kernel of one source; `recycling`: the additional time for the front; `new_light`: a beam
//! moves with a prepared kernel; `new_pixel`: an estimate with a prepared kernel.
//!
//! `slabs`: general layers, by their number and anisotropy (the nodes increase as 1/(1 - g)), at two levels.

#![allow(missing_docs, reason = "a benchmark")]

use std::f64::consts::PI;

use divan::Bencher;
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_transport::adding::Kernel;
use papilio_transport::{
    AngularTable, Base, Component, Cone, Diffuser, Interface, Layer, Medium, Nodes, Reflector, Scattering,
    Source, Stack,
};

fn main() {
    divan::main();
}

const BINS: usize = 81;

/// Returns fringes that shift with gap, angle and wavelength like those of a film.
fn pixel() -> AngularTable {
    let (nodes, gaps) = (33, [275.9, 192.3, 137.8, 20.0]);
    let mut basis = Vec::new();
    for node in 0..nodes {
        let cosine = f64::from(node) / 32.0;
        for gap in gaps {
            for bin in 0..BINS {
                let phase = 4.0 * PI * gap * (0.1 + 0.9 * cosine) / (380.0 + 5.0 * bin as f64);
                basis.push(0.275 + 0.225 * phase.cos());
            }
        }
    }
    let area = [0.493, 0.381, 0.126];
    let share = |state: usize, k: usize| if state >> k & 1 == 1 { area[k] } else { 0.0 };
    let mixture = (0..8).flat_map(|state| {
        let on = [0, 1, 2].map(|k| 0.873 * share(state, k));
        [on[0], on[1], on[2], 0.873 - on.iter().sum::<f64>()]
    });
    let mixture = mixture.collect();
    AngularTable { nodes: Nodes::Cosines(33), basis: basis.into(), mixture, common: vec![0.0; BINS] }
}

fn panel(front_reflectance: f64) -> Stack {
    panel_with_lobe(0.05667, front_reflectance)
}

fn panel_with_lobe(width: f64, front_reflectance: f64) -> Stack {
    let of = |value: f64| vec![value; BINS].into();
    let front = Component { reflectance: of(front_reflectance), absorptance: of(0.01) };
    let diffuser =
        Diffuser { lobe: Lobe::KCorrelation { width }, transmittance: of(0.953), regular_fraction: 0.0 };
    let layers = vec![
        Layer::new(Interface::Component(front), Medium::new(of(1.0))),
        Layer::new(Interface::Diffuser(diffuser), Medium::new(of(1.5))),
    ];
    Stack::new(layers, Base { reflector: Reflector::Specular(pixel()), inactive_absorptance: of(0.127) })
}

fn view() -> [Cone; 1] {
    [Cone::new(8.0, 0.0, 0.05, 1.0)]
}

fn beam(theta_deg: f64) -> Source {
    Source::Beam(Beta::from_source(theta_deg, 0.0, 1.0))
}

fn kernel(level: u32, stack: &Stack, sources: &[Source]) -> Kernel {
    let mut kernel = Kernel::new(level);
    kernel.prepare(stack, &view(), sources);
    kernel
}

#[divan::bench]
fn from_scratch(bencher: Bencher<'_, '_>) {
    let (stack, sources) = (panel(0.005), [Source::Diffuse, beam(-20.0)]);
    bencher.bench(|| [0, 1].map(|level| kernel(level, &stack, &sources).estimate(&stack, 0)));
}

/// By haze: 0.05, 0.2 and 0.4, under a front of 2 %.
#[divan::bench(args = [0.002184, 0.008904, 0.019037])]
fn narrow_from_scratch(bencher: Bencher<'_, '_>, width: f64) {
    let (stack, sources) = (panel_with_lobe(width, 0.02), [Source::Diffuse, beam(-20.0)]);
    bencher.bench(|| [0, 1].map(|level| kernel(level, &stack, &sources).estimate(&stack, 0)));
}

#[divan::bench(args = [0, 1])]
fn diffuse(bencher: Bencher<'_, '_>, level: u32) {
    let stack = panel(0.0);
    bencher.bench(|| kernel(level, &stack, &[Source::Diffuse]));
}

#[divan::bench(args = [0, 1])]
fn beam_alone(bencher: Bencher<'_, '_>, level: u32) {
    let stack = panel(0.0);
    bencher.bench(|| kernel(level, &stack, &[beam(-20.0)]));
}

#[divan::bench(args = [0.005, 0.04])]
fn recycling(bencher: Bencher<'_, '_>, front_reflectance: f64) {
    let (stack, sources) = (panel(front_reflectance), [Source::Diffuse, beam(-20.0)]);
    bencher.bench(|| kernel(1, &stack, &sources));
}

#[divan::bench(args = [0, 1])]
fn new_light(bencher: Bencher<'_, '_>, level: u32) {
    let stack = panel(0.005);
    let mut kernel = kernel(level, &stack, &[Source::Diffuse, beam(-20.0)]);
    let mut theta_deg = -20.0;
    bencher.bench_local(|| {
        theta_deg -= 1e-3;
        kernel.prepare(&stack, &view(), &[Source::Diffuse, beam(theta_deg)]);
    });
}

#[divan::bench(args = [0, 1])]
fn new_pixel(bencher: Bencher<'_, '_>, level: u32) {
    let stack = panel(0.005);
    let kernel = kernel(level, &stack, &[Source::Diffuse, beam(-20.0)]);
    bencher.bench(|| kernel.estimate(&stack, 0));
}

/// Returns a stack of slabs of different thickness over a mirror.
fn slabs_over_mirror(count: usize, anisotropy: f64) -> Stack {
    let slab = |number: usize| {
        Layer::new(
            if number == 0 { Interface::Fresnel } else { Interface::Open },
            Medium::new(vec![1.5].into()).with_scattering(Scattering::unpolarised(
                0.3 + 0.1 * number as f64,
                anisotropy,
                vec![1.0].into(),
            )),
        )
    };
    let mirror = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![0.5].into(),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    let base = Base { reflector: Reflector::Specular(mirror), inactive_absorptance: vec![0.0].into() };
    Stack::general((0..count).map(slab).collect(), base)
}

#[divan::bench(args = [(1, 0.5), (3, 0.5), (6, 0.5), (1, 0.95), (3, 0.95), (6, 0.95), (1, 0.98), (2, 0.98)], sample_count = 3, sample_size = 1)]
fn slabs(bencher: Bencher<'_, '_>, (count, anisotropy): (usize, f64)) {
    let (stack, sources) = (slabs_over_mirror(count, anisotropy), [Source::Diffuse, beam(-20.0)]);
    bencher.bench(|| [0, 1].map(|level| kernel(level, &stack, &sources).estimate(&stack, 0)));
}

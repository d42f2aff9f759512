//! Light before it is scattered: with points of low discrepancy, replicates may agree by chance where paths
//! choose.

use papilio_transport::walk::places::{PlacedWalk, Uniform, What};
use papilio_transport::{Base, Component, Interface, Layer, Medium, Scattering, Source, Stack};

use super::{clear, mirrors, paper, replicates};
use crate::common::{REPLICATES, mean_and_error, one, thick, view};

fn sheet(reflectance: f64) -> Layer {
    let component = Component { reflectance: one(reflectance), absorptance: one(0.0) };
    Layer::new(Interface::Component(component), clear(1.0))
}

fn layer(interface: Interface, medium: Medium) -> Layer {
    Layer::new(interface, medium)
}

/// A slab that absorbs all that it deflects.
fn absorber(optical_thickness: f64) -> Medium {
    let scattering = Scattering::unpolarised(optical_thickness, 0.5, one(0.0));
    clear(1.5).with_scattering(scattering)
}

/// Sums of the reflections of a front of parts (reflectance from above, transmittance, reflectance from
/// below), and a mirror.
fn round_trips(front: f64, transmittance: f64, below: f64, mirror: f64) -> f64 {
    front + transmittance.powi(2) * mirror / (1.0 - below * mirror)
}

/// With 1024 paths for each replicate, a choice with a probability of 40.96/1024 (a face of index 1.5) or
/// 20.02/1024 is made by the same number of paths in nearly all replicates: their spread is zero, and the
/// error is not. Light of most of these displays is known without noise if it follows all alternatives; that
/// of faint ones has honest errors.
#[test]
fn replicates_do_not_agree_by_chance_on_light_that_is_not_scattered() {
    let paths = 1024.0;
    let of = |layers: Vec<Layer>, base: Base| Stack::general(layers, base);
    let coated = || layer(Interface::IdealAr, clear(1.5));
    let face = || layer(Interface::Fresnel, clear(1.5));
    let two =
        |a: f64, b: f64| (a + (1.0 - a).powi(2) * b / (1.0 - a * b), (1.0 - a) * (1.0 - b) / (1.0 - a * b));
    let (bright, faint) = (20.02 / paths, 5.02 / paths);
    let (front, through) = two(bright, 0.04);
    let optical_thickness = -(1.0 - 40.04 / paths).ln();
    for (name, stack, lengths, truth, is_exact) in [
        ("face", of(vec![face()], paper(&[0.0])), vec![0.3], 0.04, true),
        ("sheet", of(vec![sheet(bright), coated()], paper(&[0.0])), vec![0.1, 0.3], bright, true),
        ("faint sheet", of(vec![sheet(faint), coated()], paper(&[0.0])), vec![0.1, 0.3], faint, false),
        ("sheet and face", of(vec![sheet(bright), face()], paper(&[0.0])), vec![0.1, 0.3], front, false),
        (
            "all over a mirror",
            of(vec![sheet(bright), face()], mirrors(&[0.5])),
            vec![0.1, 0.3],
            round_trips(front, through, two(0.04, bright).0, 0.5),
            false,
        ),
        (
            "absorbing slab over a mirror",
            of(vec![layer(Interface::IdealAr, absorber(optical_thickness))], mirrors(&[1.0])),
            vec![0.3],
            (-2.0 * optical_thickness).exp(),
            true,
        ),
    ] {
        let pattern = Uniform { states: 1 };
        let sources = [Source::Diffuse];
        let stack = thick(&stack, &lengths);
        let walk = PlacedWalk::new(&stack, view(0.0), &sources, What::Pattern(&pattern)).unwrap();
        for seed in 0..8 {
            let estimates = replicates(&walk, seed, paths as u64);
            assert_eq!(estimates.len() as u64, REPLICATES);
            let seen = estimates.iter().map(|one| one.rho[0].via_pixel[0] + one.rho[0].front[0]);
            let (mean, error) = mean_and_error(seen);
            let off = (mean - truth).abs();
            assert!(off <= 5.0 * error + 1e-12, "{name}, seed {seed}: {mean} ± {error}, {truth}");
            assert!(error <= if is_exact { 1e-12 } else { 0.01 * truth }, "{name}: {error} of {truth}");
        }
    }
}

//! Panels by *adding* at one or two wavelengths: blocks of wavelengths that are not full.

use crate::common::{Front, Panel};
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_spectra::Spectrum;
use papilio_transport::adding::Kernel;
use papilio_transport::{AngularTable, Base, Cone, Diffuser, Medium, Nodes, Reflector, Source, Stack, Top};

/// A mirror of two states, with the same spectrum at all wavelengths, under a diffuser and a front.
fn panel(bins: usize, front: f64, regular_fraction: f64) -> Stack {
    let all = |value: f64| -> Spectrum { vec![value; bins].into() };
    let cosines = (0..33).map(|k| f64::from(k) / 32.0);
    let basis = cosines.flat_map(|c| all(0.5 + 0.4 * (7.0 * c).cos()).to_vec()).collect();
    let table =
        AngularTable { nodes: Nodes::Cosines(33), basis, mixture: vec![1.0, 0.3], common: vec![0.1; bins] };
    let lobe = Lobe::KCorrelation { width: 0.1 };
    Panel {
        front: Front::of([(&*all(front), &*all(0.0))]),
        top: Top::Diffuser(Diffuser { lobe, transmittance: all(0.9), regular_fraction }),
        medium: Medium::new(all(1.5)),
        base: Base { reflector: Reflector::Specular(table), inactive_absorptance: all(0.02) },
        single_pass: false,
    }
    .stack()
}

/// Every wavelength equals its result alone; faint fronts use forms, strong ones are summed column by
/// column.
#[test]
fn wavelengths_computed_together_equal_single_ones() {
    let sources = [Source::Diffuse, Source::Beam(Beta::from_source(-20.0, 30.0, 1.0))];
    for (front, regular_fraction) in [(0.0, 0.0), (0.04, 0.0), (0.04, 0.2), (0.7, 0.2)] {
        let solve = |bins: usize| {
            let stack = panel(bins, front, regular_fraction);
            let mut kernel = Kernel::new(0);
            kernel.prepare(&stack, &[Cone::new(8.0, 0.0, 0.0, 1.0)], &sources);
            kernel.estimate(&stack, 0)
        };
        let alone = solve(1);
        for bins in [2, 3, 7, 9] {
            let together = solve(bins);
            for (alone, together) in alone.rho.iter().zip(&together.rho) {
                assert_eq!(together.via_pixel.len(), 2 * bins);
                for (k, value) in together.via_pixel.iter().enumerate() {
                    let truth = alone.via_pixel[k / bins];
                    assert!(truth > 0.0 && (value / truth - 1.0).abs() < 1e-12, "{bins}: {value} {truth}");
                }
            }
        }
    }
}

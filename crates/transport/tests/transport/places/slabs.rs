//! Where light that enters a slab at a point leaves it.

use std::f64::consts::PI;

use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::walk::places::{PlacedWalk, Uniform, What};
use papilio_transport::{Base, Interface, Layer, Medium, Reflector, Scattering, Stack};

use super::{clear, paper};
use crate::common::{REPLICATES, assert_unbiased, mean_and_error, one, thick, view};

/// Slab of index 1 over black, isotropic or not: what returns and what passes (van de Hulst), and a
/// semi-infinite one.
#[test]
fn exits_of_slabs_are_known() {
    let slab = |index: f64, thickness: f64, g: f64, albedo: f64| {
        let scattering = Scattering::unpolarised(thickness, g, one(albedo));
        let interface = if index == 1.0 { Interface::Open } else { Interface::Fresnel };
        let medium = clear(index).with_scattering(scattering);
        Stack::general(vec![Layer::new(interface, medium)], paper(&[0.0]))
    };
    let pattern = Uniform { states: 1 };
    for (stack, below, expected) in [
        (slab(1.0, 2.0, 0.75, 0.9), false, 0.09739),
        (slab(1.0, 2.0, 0.75, 0.9), true, 0.66096),
        (slab(1.5, 200.0, 0.0, 0.9), false, 0.259_919),
        (slab(1.0, 200.0, 0.0, 0.9), false, 0.414_947),
        (slab(1.0, 400.0, 0.0, 0.99), false, 0.752_721),
    ] {
        let stack = thick(&stack, &[1.0]);
        let walk = PlacedWalk::new(&stack, view(0.0), &[], What::Pattern(&pattern)).unwrap();
        assert_unbiased(&format!("{expected}"), expected, 0.03, |seed| {
            let replicate = |stream| {
                let (mut sum, paths) = (0.0, 256);
                let numbers = SampleStream::new(Sampler::Sobol, seed, stream);
                walk.exits(&numbers, 0..paths, |exit| {
                    sum += if exit.below == below { exit.light[0] } else { 0.0 };
                });
                sum / paths as f64
            };
            mean_and_error((0..REPLICATES).map(replicate))
        });
    }
}

/// A pencil beam on semi-infinite isotropic media, lengths in transport mean free paths: half and 0.9 of what
/// returns are within known radii; and the transfer of a layer of 20 of them. Values of a separate program,
/// to a few units of their last digit.
#[test]
fn pencil_beams_spread_as_is_known() {
    let medium = |index: f64, thickness: f64, albedo: f64| {
        let scattering = Scattering::unpolarised(thickness, 0.0, one(albedo));
        let interface = if index == 1.0 { Interface::Open } else { Interface::Fresnel };
        let medium = clear(index).with_scattering(scattering);
        Stack::general(vec![Layer::new(interface, medium)], paper(&[0.0]))
    };
    let pattern = Uniform { states: 1 };
    for (index, thickness, albedo, half, most) in
        [(1.0, 100.0, 0.9, 0.836, 3.19), (1.5, 100.0, 0.9, 1.08, 4.04), (1.0, 200.0, 0.99, 1.49, 6.27)]
    {
        let stack = medium(index, thickness, albedo);
        let what = What::Pattern(&pattern);
        let stack = thick(&stack, &[thickness]);
        let walk = PlacedWalk::new(&stack, view(0.0), &[], what).unwrap();
        let replicate = |stream| {
            let mut within = [0.0; 3];
            let numbers = SampleStream::new(Sampler::Sobol, 5, stream);
            walk.exits(&numbers, 0..512, |exit| {
                // The reflection of the face has not entered.
                let [x, y] = exit.place_mm;
                let radius = x.hypot(y);
                if exit.below || radius == 0.0 {
                    return;
                }
                for (sum, edge) in within.iter_mut().zip([half, most, f64::INFINITY]) {
                    *sum += if radius < edge { exit.light[0] } else { 0.0 };
                }
            });
            within
        };
        let all: Vec<[f64; 3]> = (0..REPLICATES).map(replicate).collect();
        for (k, expected) in [(0, 0.5), (1, 0.9)] {
            let (found, error) = mean_and_error(all.iter().map(|within| within[k] / within[2]));
            assert!(
                (found - expected).abs() < 4.0 * error + 0.004,
                "n {index}, {albedo}: {found} +- {error}"
            );
            assert!(error < 0.01, "{error}");
        }
    }
    let stack = medium(1.5, 20.0, 0.99);
    let stack = thick(&stack, &[20.0]);
    let walk = PlacedWalk::new(&stack, view(0.0), &[], What::Pattern(&pattern)).unwrap();
    for (wave, expected) in [(0.1, 0.932), (0.3, 0.666), (1.0, 0.273), (3.0, 0.117)] {
        let replicate = |stream| {
            let (mut sum, mut all) = (0.0, 0.0);
            walk.exits(&SampleStream::new(Sampler::Sobol, 6, stream), 0..256, |exit| {
                let [x, y] = exit.place_mm;
                if !exit.below && (x, y) != (0.0, 0.0) {
                    sum += exit.light[0] * 0.5 * ((wave * x).cos() + (wave * y).cos());
                    all += exit.light[0];
                }
            });
            sum / all
        };
        let (found, error) = mean_and_error((0..REPLICATES).map(replicate));
        assert!((found - expected).abs() < 4.0 * error + 0.003, "{wave}: {found} +- {error}");
    }
}

/// A pencil beam that is scattered once by a semi-infinite isotropic medium, by distance in mean free paths.
/// Two albedos tell how often light was scattered.
#[test]
fn single_scattering_has_a_closed_form() {
    // Light per area and albedo: integral of exp(-z - r) z/r^3 over the depth z, over 4 pi.
    let per_area = |radius: f64, count: usize| {
        let value = |z: f64| {
            let r = radius.hypot(z);
            (-z - r).exp() * z / r.powi(3)
        };
        // Dense near the surface: z = radius sinh(t).
        let step = (40.0 / radius).asinh() / count as f64;
        let at = |k: usize| (k as f64 + 0.5) * step;
        (0..count).map(|k| value(radius * at(k).sinh()) * radius * at(k).cosh()).sum::<f64>() * step
            / (4.0 * PI)
    };
    for (radius, expected) in
        [(0.1, 0.474_913_87), (0.5, 0.030_247_08), (1.0, 0.005_234_79), (2.0, 0.000_456_67), (5.0, 2.55e-6)]
    {
        let digits = 0.5e-8_f64.max(2e-3 * expected * f64::from(u8::from(radius == 5.0)));
        let found = per_area(radius, 40_000);
        assert!((found - expected).abs() < 1.5 * digits, "{radius}: {found}");
    }
    let edges = [0.05, 0.2, 0.5, 1.0, 2.0];
    let expected: Vec<f64> = edges
        .windows(2)
        .map(|pair| {
            let (count, width) = (200, pair[1] - pair[0]);
            let radius = |k: usize| pair[0] + (k as f64 + 0.5) * width / count as f64;
            (0..count).map(|k| 2.0 * PI * radius(k) * per_area(radius(k), 400)).sum::<f64>() * width
                / count as f64
        })
        .collect();
    let albedo = vec![0.8, 0.4];
    let scattering = Scattering::unpolarised(30.0, 0.0, albedo.into());
    let medium = Medium::new(vec![1.0, 1.0].into()).with_scattering(scattering);
    let base =
        Base { reflector: Reflector::lambertian(vec![0.0; 2], 2), inactive_absorptance: vec![0.0; 2].into() };
    let stack = Stack::general(vec![Layer::new(Interface::Open, medium)], base);
    let pattern = Uniform { states: 1 };
    let stack = thick(&stack, &[30.0]);
    let walk = PlacedWalk::new(&stack, view(0.0), &[], What::Pattern(&pattern)).unwrap();
    let replicate = |stream| {
        let (mut sums, paths) = ([0.0; 4], 1024);
        walk.exits(&SampleStream::new(Sampler::Sobol, 9, stream), 0..paths, |exit| {
            let once = (exit.light[0] / exit.light[1] - 2.0).abs() < 0.1;
            let radius = exit.place_mm[0].hypot(exit.place_mm[1]);
            if once && !exit.below && radius >= edges[0] && radius < edges[4] {
                sums[edges.partition_point(|edge| *edge <= radius) - 1] += exit.light[0] / 0.8 / paths as f64;
            }
        });
        sums
    };
    let all: Vec<[f64; 4]> = (0..REPLICATES).map(replicate).collect();
    for (k, expected) in expected.into_iter().enumerate() {
        let (found, error) = mean_and_error(all.iter().map(|sums| sums[k]));
        assert!((found - expected).abs() < 4.5 * error, "{k}: {found} +- {error}, {expected}");
        assert!(error < 0.1 * expected, "{k}: {found} +- {error}");
    }
}

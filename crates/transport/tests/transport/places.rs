//! The walk with places against closed forms, deterministic solvers, published values and the uniform walk.

mod slabs;
mod unscattered;

use std::cell::RefCell;
use std::collections::HashMap;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_optics::rough::Rough;
use papilio_sampling::{SampleStream, Sampler};
use papilio_transport::spatial::closed::lobe_between_rectangles;
use papilio_transport::spatial::{Accuracy, Cells, FaceReturn, Gap, Light, Recycling, Spread, displacement};
use papilio_transport::walk::places::{
    CellGrid, Estimate, KernelTally, Pattern, PlaceError, PlacedWalk, SeenFrom, Shape, TwoStates, Uniform,
    What,
};
use papilio_transport::{
    AngularTable, Base, Cone, Diffuser, Interface, Layer, Medium, Nodes, Reflector, Scattering, Source, Stack,
};

use crate::common::{
    REPLICATES, assert_unbiased, everyday, mean_and_error, one, replicates_of, sized, thick, view,
};

/// Estimates of 32 replicates.
fn replicates(walk: &PlacedWalk<'_>, seed: u64, paths: u64) -> Vec<Estimate> {
    let estimate = |stream| {
        let mut replicate = walk.replicate();
        walk.trace(&mut replicate, &SampleStream::new(Sampler::Sobol, seed, stream), paths);
        walk.estimate(&replicate)
    };
    (0..REPLICATES).map(estimate).collect()
}

/// Estimates by seed, so that several numbers of the same paths are tested.
#[derive(Default)]
struct BySeed(RefCell<HashMap<u64, Vec<Estimate>>>);

impl BySeed {
    /// Mean over the replicates of a seed, and its error.
    fn mean(
        &self,
        (walk, paths): (&PlacedWalk<'_>, u64),
        seed: u64,
        of: impl Fn(&Estimate) -> f64,
    ) -> (f64, f64) {
        let mut seeds = self.0.borrow_mut();
        let estimates = seeds.entry(seed).or_insert_with(|| replicates(walk, seed, paths));
        mean_and_error(estimates.iter().map(of))
    }
}

fn clear(index: f64) -> Medium {
    Medium::new(one(index))
}

fn over(interface: Interface, base: Base) -> Stack {
    Stack::general(vec![Layer::new(interface, clear(1.5))], base)
}

/// States of one wavelength.
fn paper(reflectance: &[f64]) -> Base {
    Base { reflector: Reflector::lambertian(reflectance.to_vec(), 1), inactive_absorptance: one(0.0) }
}

fn mirrors(reflectance: &[f64]) -> Base {
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![1.0].into(),
        mixture: reflectance.to_vec(),
        common: vec![0.0],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
}

/// The diffuser H78 without absorption.
fn diffuser() -> Diffuser {
    Diffuser { lobe: Lobe::KCorrelation { width: 0.05667 }, transmittance: one(1.0), regular_fraction: 0.0 }
}

fn tally(frequencies_per_mm: Vec<[f64; 2]>, sources: usize) -> KernelTally {
    KernelTally { frequencies_per_mm, channels: vec![vec![vec![1.0]]; sources], ..KernelTally::default() }
}

/// Modulation transfer of the lobe H78 over 0.5 mm of glass at 1, 2, 5, 5.9055 and 10 cycles per mm: an
/// independent radial integral, for diffuse light and for a beam in the mirror direction.
#[test]
fn transfer_of_a_lobe_is_known() {
    let stack = over(Interface::Diffuser(diffuser()), mirrors(&[1.0]));
    for (source, expected) in [
        (Source::Diffuse, [0.939_07, 0.834_399, 0.586_456, 0.526_884, 0.324_349]),
        (Source::Beam(Beta { x: 0.0, y: 0.0 }), [0.996_48, 0.986_26, 0.922_89, 0.896_46, 0.754_55]),
    ] {
        let frequencies = [0.0, 1.0, 2.0, 5.0, 5.9055, 10.0].map(|f| [0.6 * f, 0.8 * f]);
        let sources = [source];
        let what = What::Kernel(tally(frequencies.to_vec(), 1));
        let stack = thick(&stack, &[0.5]);
        let walk = PlacedWalk::new(&stack, view(0.0), &sources, what).unwrap();
        let estimates = replicates(&walk, 3, 4096);
        for (k, expected) in expected.into_iter().enumerate() {
            let (found, error) = mean_and_error(estimates.iter().map(|estimate| {
                let transfer = &estimate.spreads[0].once.transfer;
                transfer[1 + k].re / transfer[0].re
            }));
            // The printed digits.
            let deviation = (found - expected).abs();
            assert!(deviation < 4.5 * error + 6e-6, "{:?} {k}: {found} +- {error}, {expected}", sources[0]);
            assert!(error < 3e-3, "{error}");
        }
    }
}

/// Seen obliquely, a beam that is not in the mirror direction makes a double image: complex transfer of the
/// deterministic first order, which also has the light of cells.
#[test]
fn transfer_of_lamps_equals_that_of_the_first_order() {
    let stack = over(Interface::Diffuser(diffuser()), mirrors(&[0.7]));
    let gap = Gap { index: 1.5, thickness_mm: 0.5 };
    let accuracy = Accuracy { digits: 12.0, most_per_mm: 5.0 };
    let seen = view(20.0);
    for light in [Light::Diffuse, Light::Beam(Beta { x: 0.21, y: 0.05 })] {
        let spread = Spread::new(&diffuser(), gap, seen.axis_towards(), light, accuracy);
        let source = match light {
            Light::Diffuse => Source::Diffuse,
            Light::Beam(beta) => Source::Beam(beta),
        };
        let sources = [source];
        let frequencies = vec![[0.0; 2], [1.0, 0.0], [0.0, 3.0], [-4.0, 2.0]];
        let what = What::Kernel(tally(frequencies.clone(), 1));
        let stack = thick(&stack, &[0.5]);
        let walk = PlacedWalk::new(&stack, seen, &sources, what).unwrap();
        let scale = spread.transfer([0.0; 2], |_| 0.7).re;
        let seeds = BySeed::default();
        for (k, frequency) in frequencies.iter().enumerate() {
            let exact = spread.transfer(*frequency, |_| 0.7) / scale;
            for (part, exact) in [("real", exact.re), ("imaginary", exact.im)] {
                // Relative to the light, not to what is left of its modulation.
                assert_unbiased(&format!("{light:?} {frequency:?} {part}"), 1.0 + exact, 0.1, |seed| {
                    seeds.mean((&walk, 256), seed, |estimate| {
                        let found = estimate.spreads[0].once.transfer[k] / scale;
                        1.0 + if part == "real" { found.re } else { found.im }
                    })
                });
            }
        }
    }
}

/// Paper of 0.6 and 0.03 under a flat face: means of stripes at periods of 5, 10 and 50 thicknesses (a dense
/// Fourier sum), and of a checkerboard (fast Fourier transform).
#[test]
fn recycled_light_of_patterns_is_known() {
    let (stack, thickness) = (over(Interface::Fresnel, paper(&[0.6, 0.03])), 0.2);
    let seen = |pattern: TwoStates, expected: f64| {
        let what = What::Pattern(&pattern);
        let stack = thick(&stack, &[thickness]);
        let walk = PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], what).unwrap();
        assert_unbiased(&format!("{pattern:?}"), expected, 0.03, |seed| {
            let estimates = replicates(&walk, seed, 1024);
            mean_and_error(estimates.iter().map(|estimate| estimate.rho[0].via_pixel[0]))
        });
    };
    for (periods, mean) in [(5.0, 0.148_12), (10.0, 0.155_94), (50.0, 0.177_87)] {
        let period_mm = periods * thickness;
        seen(TwoStates { shape: Shape::Stripes, period_mm, states: [0, 1] }, mean);
    }
    let period_mm = 8.0 * thickness;
    let cells = Cells { count: [64, 64], period_mm: [period_mm; 2] };
    let face = FaceReturn::new(1.5, thickness, cells.most_per_mm(), |beta| {
        1.0 - papilio_optics::interface::fresnel_reflectance(1.0, 1.5, beta)
    });
    let reflectance: Vec<f64> =
        (0..64 * 64).map(|k| if (k % 64 < 32) == (k / 64 < 32) { 0.6 } else { 0.03 }).collect();
    let irradiance = Recycling::new(cells, |f| face.at(f)).irradiance(&reflectance, 1e-9);
    let mean = irradiance.iter().zip(&reflectance).map(|(e, r)| e * r).sum::<f64>() / 4096.0;
    // Of uniform paper: 0.362048.
    let through = 0.362_048 / (0.6 / (1.0 - 0.6 * 0.596_346));
    seen(TwoStates { shape: Shape::Checkerboard, period_mm, states: [1, 0] }, through * mean);
}

/// A bare face over a mirror-like pixel conserves directions: each order is a ghost of the stripes, shifted
/// by twice the displacement of the view. All orders, summed over a period.
#[test]
fn mirror_ghosts_beat_with_the_stripes() {
    const POINTS: usize = 1000;
    let stack = over(Interface::Fresnel, mirrors(&[0.6, 0.03]));
    let seen = view(50.0);
    let beta = seen.axis_towards();
    let [shift, _] = displacement(beta, 0.3, 1.5);
    let face = papilio_optics::interface::fresnel_reflectance(1.0, 1.5, beta.length());
    for (periods, second) in [(0.0, 0.180_45), (0.25, 0.099_225), (0.5, 0.018)] {
        // Shifted by whole periods, too.
        let period_mm = 2.0 * shift / (1.0 + periods);
        let reflectance = |order: usize, point: usize| {
            let place = (point as f64 + 0.5) / POINTS as f64 + order as f64 * periods;
            if place.rem_euclid(1.0) < 0.5 { 0.6 } else { 0.03 }
        };
        let of_order = |order: usize| -> f64 {
            let at = |point| (0..=order).map(|k| reflectance(k, point)).product::<f64>();
            (0..POINTS).map(at).sum::<f64>() / POINTS as f64
        };
        assert!((of_order(1) - second).abs() < 1e-3, "{}", of_order(1));
        let orders = (0..8).map(|k| (1.0 - face).powi(2) * face.powi(k) * of_order(k as usize));
        let expected: f64 = orders.sum();
        let pattern = TwoStates { shape: Shape::Stripes, period_mm, states: [0, 1] };
        let what = What::Pattern(&pattern);
        let stack = thick(&stack, &[0.3]);
        let walk = PlacedWalk::new(&stack, seen, &[Source::Diffuse], what).unwrap();
        assert_unbiased(&format!("{periods}"), expected, 0.02, |seed| {
            let estimates = replicates(&walk, seed, 512);
            mean_and_error(estimates.iter().map(|estimate| estimate.rho[0].via_pixel[0]))
        });
    }
}

/// A stripe pattern that is seen at given places: far inside wide stripes each state is seen as if it were
/// everywhere, and the mean over the places of a period is the mean over the period.
#[test]
fn patterns_seen_at_places_have_their_own_light() {
    let stack = over(Interface::Fresnel, paper(&[0.6, 0.03]));
    let pattern = TwoStates { shape: Shape::Stripes, period_mm: 200.0, states: [0, 1] };
    let places_mm = [[50.0, 3.0], [150.0, -7.0]];
    let seen = SeenFrom { pattern: &pattern, places_mm: &places_mm };
    let what = What::Pattern(&seen);
    let stack = thick(&stack, &[0.1]);
    let walk = PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], what).unwrap();
    for (image, expected) in [(0, 0.362_048), (1, 0.011_837)] {
        assert_unbiased(&format!("image {image}"), expected, 0.02, |seed| {
            let estimates = replicates(&walk, seed, 1024);
            mean_and_error(estimates.iter().map(|estimate| estimate.rho[0].via_pixel[image]))
        });
    }
}

/// The response of paper to small changes: `(1 - rho A(0))/(1 - rho A(f))`; and the light that is seen at
/// once is sharp.
#[test]
fn response_of_paper_has_a_closed_form() {
    let stack = over(Interface::Fresnel, paper(&[0.6]));
    let frequencies: Vec<_> = [0.0, 0.05, 0.2, 1.0].map(|f| [f / 0.4, 0.0]).to_vec();
    let kernel = KernelTally {
        cells: Some(CellGrid { count: [1, 1], corner_mm: [-1e-6; 2], cell_mm: [2e-6; 2] }),
        ..tally(frequencies, 1)
    };
    let what = What::Kernel(kernel);
    let stack = thick(&stack, &[0.4]);
    let walk = PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], what).unwrap();
    let seeds = BySeed::default();
    for (k, expected) in [(1, 0.8298), (2, 0.6202), (3, 0.6439)] {
        assert_unbiased(&format!("frequency {k}"), expected, 0.02, |seed| {
            seeds.mean((&walk, 1024), seed, |estimate| {
                let transfer = &estimate.spreads[0].response.transfer;
                transfer[k].re / transfer[0].re
            })
        });
    }
    let mut replicate = walk.replicate();
    walk.trace(&mut replicate, &SampleStream::new(Sampler::Sobol, 1, 0), 512);
    let once = walk.estimate(&replicate).spreads[0].once.clone();
    assert_eq!(once.cells[1], 0.0);
    // Frequencies have the error of a grid of places.
    assert!((once.cells[0] - once.transfer[3].re).abs() < 1e-7 * once.cells[0]);
}

/// Uniform states look as they do to the walk without places: slabs, rough surfaces, gaps in front, mirrors,
/// paper, lamps and discs.
#[test]
fn uniform_states_equal_the_uniform_walk() {
    let beam = Source::Beam(-Cone::new(-30.0, 20.0, 0.0, 1.0).axis_towards());
    let sources = [Source::Diffuse, beam, Source::Disc(Cone::new(-15.0, 0.0, 8.0, 1.0))];
    let component = Interface::component(one(0.1), one(0.02));
    let front = Layer::new(component, clear(1.0));
    let slab = Scattering::unpolarised(1.5, 0.5, one(0.95));
    let milky = clear(1.5).with_scattering(slab).with_transmittance(one(0.9));
    let rough = Layer::new(Interface::Rough(Rough::new(0.3, 1.0, 1.5)), clear(1.5));
    let lobe = Layer::new(Interface::Diffuser(diffuser()), clear(1.5));
    let bare = |medium| Layer::new(Interface::Fresnel, medium);
    let cases = [
        ("front over a lobe", vec![front.clone(), lobe], mirrors(&[0.6, 0.2])),
        ("slab over a mirror", vec![bare(milky.clone())], mirrors(&[0.6, 0.2])),
        ("rough over paper", vec![front.clone(), rough.clone()], paper(&[0.6, 0.2])),
        ("slab over paper", vec![front, bare(milky)], paper(&[0.6, 0.2])),
        ("rough over a mirror", vec![rough], mirrors(&[0.6, 0.2])),
    ];
    for (name, layers, base) in everyday(3, cases) {
        let stack = Stack::general(layers, base);
        let (lengths, pattern) = (vec![0.3; stack.layers().len()], Uniform { states: 2 });
        let seen = view(10.0);
        let what = What::Pattern(&pattern);
        let stack = thick(&stack, &lengths);
        let walk = PlacedWalk::new(&stack, seen, &sources, what).unwrap();
        let cache = RefCell::new(HashMap::new());
        for (source, image) in [(0, 0), (0, 1), (1, 0), (2, 0)] {
            assert_unbiased(&format!("{name}, source {source}, state {image}"), 1.0, 0.3, |seed| {
                let mut cache = cache.borrow_mut();
                let (placed, today) = cache.entry(seed).or_insert_with(|| {
                    let placed = replicates(&walk, 2 * seed, sized(128, 256));
                    let today =
                        replicates_of(&stack, seen, &sources, 2 * seed + 1, sized(32, 64), Sampler::Sobol);
                    (placed, today)
                });
                let of = |rho: &papilio_transport::ReflectanceFactor| rho.via_pixel[image] + rho.front[0];
                let (x, error_x) = mean_and_error(placed.iter().map(|one| of(&one.rho[source])));
                let (y, error_y) = mean_and_error(today.iter().map(|one| of(&one.rho[source])));
                (x / y, (x / y) * (error_x / x).hypot(error_y / y))
            });
        }
    }
}

/// A wrong thickness and wrong channels are refused with a reason.
#[test]
fn bad_thickness_is_refused() {
    let stack = over(Interface::Fresnel, paper(&[0.6]));
    let pattern = Uniform { states: 1 };
    let new = |thickness_mm: f64| {
        let stack = thick(&stack, &[thickness_mm]);
        PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], What::Pattern(&pattern)).err()
    };
    assert_eq!(new(-0.5), Some(PlaceError::Thickness(-0.5)));
    assert_eq!(new(0.0), None);
    let what = What::Kernel(tally(vec![[0.0; 2]], 2));
    let stack = thick(&stack, &[0.5]);
    let error = PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], what).err();
    assert_eq!(error, Some(PlaceError::Channels));
}

/// Paths that are traced together have the means of single ones, which an open interface above the display
/// asks for: a pattern in mixed light, and the sums by frequency, cell, strip and ring.
#[test]
fn paths_in_groups_equal_single_paths() {
    let lobe = |medium| Layer::new(Interface::Diffuser(diffuser()), medium);
    let open = Layer::new(Interface::Open, clear(1.0));
    let together = Stack::general(vec![lobe(clear(1.5))], mirrors(&[0.9, 0.1]));
    let single = Stack::general(vec![open, lobe(clear(1.5))], together.base().clone());
    let sources = [Source::Diffuse, Source::Beam(Beta { x: 0.21, y: 0.05 })];
    let kernel = KernelTally {
        frequencies_per_mm: vec![[0.0; 2], [2.0, 0.0], [4.0, 0.0], [0.0, 3.0]],
        cells: Some(CellGrid { count: [3, 3], corner_mm: [-0.15; 2], cell_mm: [0.1; 2] }),
        strips_mm: [vec![-0.05, 0.02], vec![0.03]],
        rings_mm: vec![0.04, 0.2],
        channels: vec![vec![vec![1.0]]; 2],
    };
    let stripes = TwoStates { shape: Shape::Stripes, period_mm: 0.17, states: [0, 1] };
    let seen = view(20.0);
    type Number = fn(&Estimate) -> f64;
    let numbers: [(&str, Number); 7] = [
        ("diffuse", |one| one.rho[0].via_pixel[0]),
        ("beam", |one| one.rho[1].via_pixel[0]),
        ("real", |one| one.spreads[1].once.transfer[2].re),
        ("imaginary", |one| one.spreads[1].response.transfer[1].im),
        ("cell", |one| one.spreads[0].once.cells[4]),
        ("strip", |one| one.spreads[1].once.strips[0][1]),
        ("ring", |one| one.spreads[0].once.rings[1]),
    ];
    for (k, (name, number)) in numbers.into_iter().enumerate() {
        let [a, b] = [(&together, vec![0.5]), (&single, vec![0.0, 0.5])].map(|(stack, lengths)| {
            let what = if k < 2 { What::Pattern(&stripes) } else { What::Kernel(kernel.clone()) };
            let stack = thick(stack, &lengths);
            let walk = PlacedWalk::new(&stack, seen, &sources, what).unwrap();
            let paths = if stack.layers().len() == 1 { 4096 } else { 1024 };
            mean_and_error(replicates(&walk, 11, paths).iter().map(number))
        });
        let error = a.1.hypot(b.1);
        assert!((a.0 - b.0).abs() < 4.5 * error, "{name}: {a:?} {b:?}");
        assert!(error < 0.02 * a.0.abs().max(0.05), "{name}: {a:?} {b:?}");
    }
    // The result does not depend on how calls divide the paths.
    let stack = thick(&together, &[0.5]);
    let walk = PlacedWalk::new(&stack, seen, &sources, What::Pattern(&stripes)).unwrap();
    let stream = SampleStream::new(Sampler::Sobol, 1, 0);
    let [whole, parts] = [vec![200], vec![1, 63, 7, 129]].map(|counts| {
        let mut replicate = walk.replicate();
        counts.into_iter().for_each(|count| walk.trace(&mut replicate, &stream, count));
        walk.estimate(&replicate)
    });
    assert_eq!(whole, parts);
}

/// A window that is seen from all its places, in diffuse light through a narrow lobe: the light of the window
/// itself.
#[test]
fn window_has_its_own_share_of_light() {
    struct Window([f64; 2]);
    impl Pattern for Window {
        fn images(&self) -> usize {
            2
        }

        fn period_mm(&self) -> [f64; 2] {
            self.0
        }

        fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
            let inside = (0..2).all(|k| (0.0..self.0[k]).contains(&place_mm[k]));
            covered(0, usize::from(!inside), 1.0);
            covered(1, 0, 1.0);
        }
    }
    const WIDTH: f64 = 0.004;
    let narrow = Diffuser { lobe: Lobe::KCorrelation { width: WIDTH }, ..diffuser() };
    let stack = over(Interface::Diffuser(narrow), mirrors(&[1.0, 0.0]));
    for side_mm in [[0.026, 0.076], [0.005, 0.012]] {
        let window = Window(side_mm);
        let what = What::Pattern(&window);
        let stack = thick(&stack, &[1.0]);
        let walk = PlacedWalk::new(&stack, view(0.0), &[Source::Diffuse], what).unwrap();
        let rectangle = side_mm.map(|side| [0.0, side]);
        let blur = WIDTH / 1.5;
        let expected = lobe_between_rectangles(rectangle, rectangle, blur) / (side_mm[0] * side_mm[1]);
        let shares = replicates(&walk, 8, 2048).into_iter().map(|one| {
            let [own, all] = [0, 1].map(|image| one.rho[0].via_pixel[image]);
            own / all
        });
        let (found, error) = mean_and_error(shares);
        // The closed form has no edge of the hemisphere, which cuts a fraction of about the width.
        let allowed = 4.5 * error + 1.5 * WIDTH * expected;
        assert!((found - expected).abs() < allowed, "{side_mm:?}: {found} +- {error}, {expected}");
        assert!(error < 0.003, "{error}");
    }
}

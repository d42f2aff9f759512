//! General stacks by *adding*: physical laws, extreme cases, and comparison with Monte Carlo.

use crate::common::*;
use crate::layers::*;
use num_complex::Complex64;
use papilio_optics::film::{Coating, SpectralLayer, Thickness};
use papilio_optics::lobe::Lobe;
use papilio_optics::rough::{Distribution, Rough};
use papilio_spectra::Spectrum;
use papilio_transport::adding::{Kernel, MOST_NODES, nodes_needed};
use papilio_transport::{
    AngularTable, Base, Cone, Diffuser, Estimate, Interface, Layer, Medium, Nodes, Reflector, Scattering,
    Source, Stack,
};

/// Each level of a slab has at most a fifth of the error of the one before, so that level differences
/// estimate errors. R = 0.439692 is from an independent source.
#[test]
fn slab_error_decreases_at_every_level() {
    let stack = stack([(Interface::Fresnel, slab(1.0, 0.9, 1.0, 1.5))], mirror(0.5));
    let seen = |level: u32| rho(&estimate(level, &stack, view(0.0), &[Source::Diffuse]), 0);
    let finest = seen(6);
    assert_close("the finest", finest, 0.439692, 2e-6);
    let errors: Vec<f64> = (0..3).map(|level| (seen(level) - finest).abs()).collect();
    assert!(errors[0] < 3e-6, "{errors:?}");
    assert!(errors.windows(2).all(|pair| pair[1] < 0.2 * pair[0]), "{errors:?}");
}

/// A stack of all kinds of layers without absorption over a white mirror returns all light.
#[test]
fn lossless_layers_return_all_light() {
    let white = |layers| match layers {
        0 => stack([(Interface::Fresnel, slab(1.0, 0.9, 1.0, 1.5))], mirror(1.0)),
        1 => stack([(Interface::Fresnel, slab(1e6, 0.5, 1.0, 1.5))], mirror(1.0)),
        2 => stack([(Interface::Open, slab(1e6, 0.9, 1.0, 1.0))], lambertian(1.0)),
        3 => stack([(Interface::Fresnel, slab(1e-6, 0.9, 1.0, 1.5))], lambertian(1.0)),
        4 => stack([(Interface::Rough(Rough::new(0.2, 1.0, 1.5)), clear(1.5))], mirror(1.0)),
        _ => stack(
            [
                (sheet(0.3, 0.0), clear(1.0)),
                (Interface::Fresnel, slab(3.0, 0.8, 1.0, 1.5)),
                (Interface::Fresnel, clear(1.0)),
                (Interface::Rough(Rough::new(0.4, 1.0, 1.6)), clear(1.6)),
                (Interface::IdealAr, slab(0.1, -0.5, 1.0, 1.3)),
            ],
            mirror(1.0),
        ),
    };
    for case in 0..6 {
        let stack = white(case);
        for theta in [0.0, 8.0, 75.0, 89.9] {
            let found = estimate(0, &stack, view(theta), &[Source::Diffuse]);
            assert_close(&format!("case {case} at {theta} deg"), rho(&found, 0), 1.0, 1e-9);
        }
    }
}

/// A stack of many kinds of layers without symmetry.
fn mixed() -> Stack {
    stack(
        [
            (sheet(0.05, 0.02), clear(1.0)),
            (diffuser(0.15, 0.9, 0.2), clear(1.3).with_transmittance(one(0.9))),
            (Interface::Fresnel, slab(0.7, 0.6, 0.98, 1.5)),
            (Interface::Fresnel, clear(1.2)),
        ],
        mirror(0.6),
    )
}

#[test]
fn exchanged_view_and_source_give_the_same_value() {
    let ways = [(10.0, 50.0, 0.0), (70.0, 20.0, 130.0), (0.0, 30.0, 0.0), (45.0, 45.0, 180.0)];
    for (a, b, phi) in everyday(2, ways) {
        let there = estimate(2, &mixed(), Cone::new(a, 0.0, 0.0, 1.0), &[beam(b, phi)]);
        let back = estimate(2, &mixed(), Cone::new(b, phi, 0.0, 1.0), &[beam(a, 0.0)]);
        let (there, back) = (rho(&there, 0), rho(&back, 0));
        assert_close(&format!("{a} {b} {phi}"), there / back, 1.0, 1e-9);
    }
}

#[test]
fn split_slab_equals_whole_slab() {
    let sources = [Source::Diffuse, beam(-35.0, 0.0)];
    let whole = stack([(Interface::Fresnel, slab(2.0, 0.8, 0.97, 1.5))], mirror(0.6));
    let parts = [0.1, 0.4, 1.5].map(|tau| slab(tau, 0.8, 0.97, 1.5));
    let [a, b, c] = parts;
    let split = stack([(Interface::Fresnel, a), (Interface::Open, b), (Interface::Open, c)], mirror(0.6));
    let [whole, split] = [whole, split].map(|stack| estimate(0, &stack, view(20.0), &sources));
    for source in 0..2 {
        // The rational function of the thin layer has an error of 1e-7 at grazing angles.
        assert_close("split", rho(&split, source), rho(&whole, source), 1e-7);
    }
}

/// Each level must gain a factor of five or more, and the change to the next level must be at least half of
/// the error relative to the finest level; except for a tenth of the accuracy of the level, since rules of
/// few points are equal at neighbouring levels.
#[test]
fn errors_decrease_with_level() {
    let sources = [Source::Diffuse, beam(-20.0, 0.0), Source::Disc(Cone::new(30.0, 10.0, 5.0, 1.0))];
    let slabs = |g| stack([(Interface::Fresnel, slab(1.0, g, 1.0, 1.5))], mirror(0.5));
    let lobe = stack(
        [(diffuser(0.1, 0.9, 0.0), clear(1.5)), (Interface::Fresnel, slab(1.0, 0.3, 0.9, 1.3))],
        mirror(0.5),
    );
    for (case, stack) in everyday(2, [mixed(), slabs(0.9), lobe, slabs(0.75)]).enumerate() {
        let levels: Vec<Estimate> =
            (0..4).map(|level| estimate(level, &stack, Cone::new(8.0, 0.0, 0.25, 1.0), &sources)).collect();
        for source in 0..sources.len() {
            let value = |level: usize| rho(&levels[level], source);
            let error = |level: usize| (value(level) / value(3) - 1.0).abs();
            assert!(error(0) < 5e-3, "case {case}, source {source}: {}", error(0));
            assert!(
                error(1) < 1e-3 && error(2) < 1e-4,
                "case {case}, source {source}: {} {}",
                error(1),
                error(2)
            );
            for level in 0..2 {
                let change = (value(level) / value(level + 1) - 1.0).abs();
                let promise = (-7.0 - 2.0 * level as f64).exp();
                assert!(
                    error(level) <= 2.0 * change + 0.1 * promise,
                    "case {case}, source {source}, level {level}: {} {change}",
                    error(level)
                );
            }
        }
    }
}

/// Refracted light of one microfacet jumps to zero in grazing directions: convergence is slower than for
/// other layers.
#[test]
fn rough_interface_errors_decrease_with_level() {
    let sources = [Source::Diffuse, beam(-20.0, 0.0)];
    for alpha in [0.15, 0.5] {
        let stack = stack([(Interface::Rough(Rough::new(alpha, 1.0, 1.5)), clear(1.5))], mirror(0.5));
        let levels = [0, 1, 2].map(|level| estimate(level, &stack, view(8.0), &sources));
        for source in 0..2 {
            let [a, b, c] = levels.each_ref().map(|estimate| rho(estimate, source));
            assert_close(&format!("alpha {alpha}, source {source}"), a / c, 1.0, 2e-3);
            assert_close(&format!("alpha {alpha}, source {source}"), b / c, 1.0, 5e-4);
        }
    }
}

/// In the mirror direction of a beam all azimuthal orders contribute: a number of orders that is too small at
/// both levels would not show in their difference. The stated error is four times that.
#[test]
fn rough_interface_in_mirror_direction_has_the_error_of_two_levels() {
    for (alpha, distribution) in [
        (0.4, Distribution::Ggx),
        (0.2, Distribution::Ggx),
        (0.2, Distribution::Beckmann),
        (0.2, Distribution::StudentT { tail: 2.5 }),
    ] {
        let face = Rough::with(distribution, alpha, 1.0, 1.5);
        let stack = stack([(Interface::Rough(face), clear(1.5))], mirror(0.8));
        let [a, b, truth] =
            [0, 1, 4].map(|level| rho(&estimate(level, &stack, view(20.0), &[beam(-20.0, 0.0)]), 0));
        let error = 4.0 * (b - a).abs() + 2e-5 * truth;
        assert!((b - truth).abs() < error, "{distribution:?} {alpha}: {a} {b} {truth}");
    }
}

/// One scatterer below flat layers is followed kernel by kernel. A slab that hardly scatters turns it into
/// one of two, whose operators are composed.
#[test]
fn single_scatterer_equals_composed_operators() {
    let faces = [(diffuser(0.15, 0.9, 0.1), 1.5), (Interface::Rough(Rough::new(0.3, 1.0, 1.5)), 1.0)];
    let bases = [mirror(0.7), lambertian(0.6)];
    let sources = [Source::Diffuse, beam(-25.0, 0.0), beam(40.0, 70.0)];
    for ((face, index), base, gap) in faces.iter().flat_map(|face| {
        bases.iter().flat_map(move |base| [false, true].map(|gap| (face.clone(), base.clone(), gap)))
    }) {
        let of = |above: Medium| {
            let surface = if index == 1.0 { Interface::Open } else { Interface::Fresnel };
            let upper = [(surface, above), (face.clone(), clear(1.5))];
            let lower = [(Interface::Fresnel, clear(1.0)), (Interface::Fresnel, clear(1.5))];
            let layers = upper.into_iter().chain(lower.into_iter().filter(|_| gap));
            let layers = layers.map(|(interface, medium)| Layer::new(interface, medium)).collect();
            estimate(0, &Stack::general(layers, base.clone()), view(15.0), &sources)
        };
        let (alone, two) = (of(clear(index)), of(slab(1e-9, 0.0, 1.0, index)));
        for source in 0..sources.len() {
            assert_close("radiance", rho(&alone, source), rho(&two, source), 1e-6);
        }
        let books =
            |e: &Estimate| [e.ledger.front[0], e.ledger.diffuser[0], e.ledger.glass[0], e.ledger.pixel[0]];
        for (one, other) in books(&alone).into_iter().zip(books(&two)) {
            assert_close("ledger", one, other, 1e-7);
        }
    }
}

#[test]
fn ledger_sums_to_one() {
    for base in [mirror(0.6), lambertian(0.4)] {
        let stack = mixed().with_base(Base { inactive_absorptance: one(0.1), ..base });
        let found = estimate(0, &stack, view(30.0), &[Source::Diffuse]);
        let l = &found.ledger;
        let shares = [l.returned[0], l.front[0], l.diffuser[0], l.glass[0], l.pixel[0], l.inactive[0]];
        assert_close("sum", shares.iter().sum(), 1.0, 1e-12);
        assert!(shares.iter().all(|share| *share > 0.0), "{shares:?}");
        assert_close("returned", l.returned[0], rho(&found, 0), 1e-12);
    }
}

/// A slab so thin that it hardly scatters, one so thick that nothing passes, grazing views.
#[test]
fn extreme_slabs_have_known_limits() {
    let thin = |tau: f64| stack([(Interface::Open, slab(tau, 0.0, 1.0, 1.0))], mirror(0.0));
    let light = [beam(60.0, 0.0)];
    let [small, large] = [1e-6, 2e-6].map(|tau| rho(&estimate(1, &thin(tau), view(0.0), &light), 0));
    // Single scattering: pi tau / (4 pi mu mu0).
    assert_close("single scattering", small / (1e-6 / (4.0 * 0.5)), 1.0, 1e-4);
    assert_close("in proportion", large / small, 2.0, 1e-4);
    let thick = stack([(Interface::Open, slab(1e6, 0.9, 1.0, 1.0))], mirror(0.0));
    let found = estimate(1, &thick, view(0.0), &[Source::Diffuse]);
    // Through a thick conservative layer: 4/3 K(1)/((1 - g) tau), K(1) = 1.27 to a few percent.
    let through = found.ledger.pixel[0];
    assert!((1.5e-5..1.8e-5).contains(&through), "{through}");
    // Error of thirty doublings.
    assert_close("sum", rho(&found, 0) + through, 1.0, 1e-10);
    let grazing = estimate(1, &mixed(), view(89.9), &[Source::Diffuse, beam(-89.9, 0.0)]);
    assert!((0.0..=1.0).contains(&rho(&grazing, 0)) && rho(&grazing, 1) >= 0.0);
    let mirrors =
        stack([(sheet(1.0, 0.0), clear(1.0)), (Interface::Fresnel, slab(1.0, 0.5, 1.0, 1.5))], mirror(1.0));
    assert_close("closed", rho(&estimate(0, &mirrors, view(10.0), &[Source::Diffuse]), 0), 1.0, 1e-12);
}

/// The number of nodes of a level is known beforehand, so that a caller can refuse the stack.
#[test]
fn nodes_needed_equal_nodes_used() {
    let lobe = |width| stack([(diffuser(width, 0.9, 0.0), clear(1.5))], mirror(0.5));
    for level in [0, 2] {
        let mut kernel = Kernel::new(level);
        kernel.prepare(&lobe(0.1), &[view(8.0)], &[beam(-20.0, 0.0)]);
        // And one node for the view, one for the beam.
        assert_eq!(kernel.nodes(), nodes_needed(&lobe(0.1), level) + 2);
    }
    let haze_65 = nodes_needed(&lobe(0.03869), 2);
    assert!(haze_65 < MOST_NODES, "{haze_65}");
    assert!(nodes_needed(&lobe(1e-4), 0) > MOST_NODES);
    assert!(
        nodes_needed(&stack([(Interface::Fresnel, slab(1.0, 0.999, 1.0, 1.5))], mirror(0.5)), 0) > MOST_NODES
    );
}

/// States and wavelengths have the same results as alone, dispersive media included.
#[test]
fn wavelengths_and_states_are_independent() {
    let spectrum = |bins: &[usize], values: [f64; 3]| -> Spectrum {
        bins.iter().map(|b| values[*b]).collect::<Vec<_>>().into()
    };
    let coloured = |bins: &[usize]| {
        let table = AngularTable {
            nodes: Nodes::Constant,
            basis: [[0.1, 0.9, 0.9], [0.2, 0.2, 0.7]]
                .iter()
                .flat_map(|row| bins.iter().map(|b| row[*b]))
                .collect(),
            mixture: vec![1.0, 0.0, 0.3, 0.7],
            common: vec![0.0; bins.len()],
        };
        let albedo = spectrum(bins, [0.9, 1.0, 1.0]);
        let scattering = Scattering::unpolarised(1.0, 0.5, albedo);
        let slab = Medium::new(spectrum(bins, [1.5; 3])).with_scattering(scattering);
        let filter =
            Medium::new(spectrum(bins, [1.4, 1.45, 1.4])).with_transmittance(spectrum(bins, [0.8, 0.9, 1.0]));
        let lobe = Diffuser {
            lobe: Lobe::KCorrelation { width: 0.3 },
            transmittance: spectrum(bins, [0.5, 0.8, 0.8]),
            regular_fraction: 0.0,
        };
        let layers =
            vec![Layer::new(Interface::Diffuser(lobe), filter), Layer::new(Interface::Fresnel, slab)];
        let base = Base {
            reflector: Reflector::Specular(table),
            inactive_absorptance: vec![0.0; bins.len()].into(),
        };
        Stack::general(layers, base)
    };
    let sources = [Source::Diffuse, beam(-30.0, 20.0)];
    let together = estimate(0, &coloured(&[0, 1, 2]), view(15.0), &sources);
    for bin in 0..3 {
        let alone = estimate(0, &coloured(&[bin]), view(15.0), &sources);
        for source in 0..2 {
            for state in 0..2 {
                let (a, b) =
                    (together.rho[source].via_pixel[3 * state + bin], alone.rho[source].via_pixel[state]);
                assert_close("base", a / b, 1.0, 1e-9);
            }
            assert_close("front", together.rho[source].front[bin], alone.rho[source].front[0], 1e-12);
        }
    }
}

/// Monte Carlo through the same stacks: every kind of layer and source, within its error bars.
#[test]
fn monte_carlo_agrees_with_adding() {
    let antireflection = || {
        let layer = SpectralLayer { index: vec![1.38.into()], thickness: Thickness::Fixed(99.6) };
        Interface::Coating(Coating::new(&[550.0], &[1.0], &[layer], &[1.5]).unwrap())
    };
    let lambertian_lobe = Interface::Diffuser(Diffuser {
        lobe: Lobe::Lambertian,
        transmittance: one(0.8),
        regular_fraction: 0.1,
    });
    let gaussian = Rough::with(Distribution::Beckmann, 0.6, 1.0, 1.5);
    let stacks = [
        ("mixed", mixed()),
        ("rough, Gaussian slopes", stack([(Interface::Rough(gaussian), clear(1.5))], mirror(0.8))),
        (
            "rough within",
            stack(
                [
                    (sheet(0.1, 0.0), clear(1.0)),
                    (Interface::Fresnel, clear(1.6)),
                    (Interface::Rough(Rough::new(0.5, 1.6, 1.3)), clear(1.3)),
                ],
                lambertian(0.5),
            ),
        ),
        (
            "two diffusers",
            stack([(diffuser(0.2, 0.9, 0.0), clear(1.0)), (lambertian_lobe, clear(1.5))], mirror(0.7)),
        ),
        ("negative", stack([(Interface::Fresnel, slab(2.0, -0.6, 0.9, 1.4))], lambertian(0.9))),
        (
            "coating",
            stack(
                [(antireflection(), slab(1.5, 0.7, 0.95, 1.5)), (Interface::IdealAr, clear(1.2))],
                mirror(0.8),
            ),
        ),
        ("rough", stack([(Interface::Rough(Rough::new(0.3, 1.0, 1.5)), clear(1.5))], mirror(0.8))),
    ];
    for (name, stack) in everyday(5, stacks) {
        assert_monte_carlo_agrees(name, &stack, 1, sized(16, 64));
    }
}

/// Reflectance and transmittance, mean of s and p, of layers in air on glass, from air or from the glass: the product
/// of their characteristic matrices (Born and Wolf, 1.6.2).
fn by_matrices(layers: &[(f64, f64)], [first, last]: [f64; 2], beta: f64) -> [f64; 2] {
    let of = |is_s: bool| {
        let q = |index: f64| Complex64::from(index * index - beta * beta).sqrt();
        let admittance = |index: f64| if is_s { q(index) } else { q(index) / (index * index) };
        let (mut u, mut v) = (Complex64::ONE, admittance(last));
        for (index, nm) in layers.iter().rev() {
            let (phase, eta) = (q(*index) * (2.0 * std::f64::consts::PI * nm / 550.0), admittance(*index));
            let (sine, cosine) = (phase.sin() * Complex64::I, phase.cos());
            (u, v) = (cosine * u - sine / eta * v, cosine * v - sine * eta * u);
        }
        let eta = admittance(first);
        let sum = eta * u + v;
        [((eta * u - v) / sum).norm_sqr(), 4.0 * eta.re * admittance(last).re / sum.norm_sqr()]
    };
    let [s, p] = [true, false].map(of);
    [0.5 * (s[0] + p[0]), 0.5 * (s[1] + p[1])]
}

/// A guided mode between gaps of air, on glass above paper in diffuse light: its resonances are narrower than the distance of
/// nodes. The sum of all orders, with means by the midpoint rule of 20 000 points.
#[test]
fn sharp_resonances_of_a_coating_are_averaged() {
    let films = [(1.0, 1500.0), (2.0, 300.0), (1.0, 1500.0)];
    let layer =
        |(n, nm): (f64, f64)| SpectralLayer { index: vec![n.into()], thickness: Thickness::Fixed(nm) };
    let coating = Coating::new(&[550.0], &[1.0], &films.map(layer), &[1.5]).unwrap();
    let coated = stack([(Interface::Coating(coating), clear(1.5))], lambertian(0.8));
    const POINTS: usize = 20_000;
    let (mut enters, mut returns) = (0.0, 0.0);
    for point in 0..POINTS {
        let cosine = (point as f64 + 0.5) / POINTS as f64;
        let beta = (1.0 - cosine * cosine).sqrt();
        let weight = 2.0 * cosine / POINTS as f64;
        enters += weight * by_matrices(&films, [1.0, 1.5], beta)[1];
        returns += weight * by_matrices(&films, [1.5, 1.0], beta)[0] / 2.25;
    }
    // Beyond the critical angle all light is reflected.
    returns += 1.0 - 1.0 / 2.25;
    for degrees in [0.0, 45.0] {
        let beta = f64::sin(f64::to_radians(degrees));
        let [front, through] = by_matrices(&films, [1.0, 1.5], beta);
        let expected = front + through * enters / 2.25 * 0.8 / (1.0 - 0.8 * returns);
        let found = [0, 1].map(|level| rho(&estimate(level, &coated, view(degrees), &[Source::Diffuse]), 0));
        assert_close("level 0", found[0], expected, 2e-7);
        assert_close("level 1", found[1], expected, 2e-7);
    }
}

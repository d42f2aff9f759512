//! The virtual goniometer against closed forms, published values and laws.

use crate::*;

const GLASS: f64 = 1.5;

fn measured(surface: &Surface, incidence_deg: &[f64], rays: u64) -> Vec<Total> {
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: GLASS,
        incidence_deg: incidence_deg.to_vec(),
        rays,
        seed: papilio_testing::seeds(),
    };
    let replicates = (0..REPLICATES).map(|number| goniometer.replicate(surface, number, &|| false).unwrap());
    goniometer.totals(&replicates.collect::<Vec<_>>()).unwrap()
}

/// A flat face has Fresnel's reflectances, and sends nothing off the regular directions.
#[test]
fn flat_faces_are_those_of_fresnel() {
    let totals = measured(&Surface::Flat, &[0.0, 30.0, 60.0, 75.0], 8);
    for (total, reflectance) in
        totals.iter().zip([0.04, 0.04152263, 0.08918671, 0.25306056, 0.04, 0.05519017])
    {
        assert!((total.reflected.value - reflectance).abs() < 1e-8, "{total:?}");
        assert!((total.reflected.value - total.regular_reflected.value).abs() < 1e-12);
        assert!((total.transmitted.value - total.regular_transmitted.value).abs() < 1e-12);
        assert!(
            (total.reflected.value + total.transmitted.value - 1.0).abs() < 1e-12
                && total.mean_facets.value == 1.0
        );
    }
}

/// Feng's hemispheres, side by side on squares: values of a separate program. Their standard errors are 1e-3; three of them are allowed.
#[test]
fn hemispheres_are_those_of_a_separate_program() {
    let caps = Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice: Lattice::Square };
    let totals = measured(&Surface::Caps(caps), &[0.0, 30.0, 41.0, 60.0, 75.0], 400);
    let from_air = [
        [0.0252, 0.9436, 0.0312],
        [0.0257, 0.8028, 0.1715],
        [0.0278, 0.5880, 0.3842],
        [0.0387, 0.1615, 0.7998],
        [0.0718, 0.0311, 0.8971],
    ];
    for (total, [reflected, seen, beyond]) in totals.iter().zip(from_air) {
        let within = total.transmitted.value - total.transmitted_beyond.value;
        let pairs =
            [(total.reflected.value, reflected), (within, seen), (total.transmitted_beyond.value, beyond)];
        for (found, expected) in pairs {
            assert!(
                (found - expected).abs() < 3e-3 + 4.0 * total.transmitted_beyond.error,
                "{expected}: {total:?}"
            );
        }
    }
    for (total, transmitted) in totals[5..].iter().zip([0.5220, 0.5122, 0.4263, 0.4704, 0.1076]) {
        let allowed = 3e-3 + 4.0 * total.transmitted.error;
        assert!((total.transmitted.value - transmitted).abs() < allowed, "{transmitted}: {total:?}");
        assert!(total.mean_facets.value > 1.5 && total.mean_facets.value < 3.3, "{total:?}");
    }
}

fn kernel(surface: &Surface, rays: u64) -> Kernel {
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: GLASS,
        incidence_deg: Vec::new(),
        rays,
        seed: papilio_testing::seeds(),
    };
    let replicates = (0..REPLICATES).map(|number| goniometer.replicate(surface, number, &|| false).unwrap());
    goniometer.kernel(&replicates.collect::<Vec<_>>()).unwrap()
}

/// Kernels of caps, of hexagonal and random lattices, and of a random face: reciprocity and uniform light, no ray is lost, and after balancing
/// nothing is.
#[test]
fn kernels_obey_the_laws() {
    let caps = |lattice| Surface::Caps(Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice });
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 2.5, correlation_um: 10.0 }, 1).unwrap();
    let surfaces = [
        caps(Lattice::Square),
        caps(Lattice::Hexagonal),
        caps(Lattice::Random { seed: 3 }),
        Surface::Random(face),
    ];
    for surface in papilio_testing::everyday(2, surfaces) {
        let found = kernel(&surface, 150);
        let Audit { reciprocity_z_rms, reciprocity_tests, energy_z, dropped_rays, .. } = &found.audit;
        assert_eq!(*dropped_rays, 0.0);
        // Student's differences of 32 replicates each have a variance of 62/60; patches with few rays are not quite normal.
        assert!(*reciprocity_tests > 1000 && *reciprocity_z_rms < 1.1, "{surface:?}: {reciprocity_z_rms}");
        let energy = energy_z.iter().map(|z| z * z).sum::<f64>() / energy_z.len() as f64;
        assert!(energy < 1.8, "{surface:?}: {energy}");
        let rows = found.scattered.chunks_exact(found.bands.count() * found.azimuths());
        for (band, row) in rows.enumerate() {
            let all =
                row.iter().sum::<f64>() + found.regular_reflected[band] + found.regular_transmitted[band];
            assert!((all - 1.0).abs() < 1e-6, "{surface:?}, band {band}: {all}");
        }
    }
}

/// Diffuse light: T from air to glass is n^2 T from glass to air, for any surface without losses.
#[test]
fn diffuse_transmittance_is_reciprocal() {
    let side = 32_i32;
    let maps: [fn(f64, f64) -> f64; 4] = [
        // Pyramids, waves, steps with steep flanks, and ridges.
        |x, y| (x - 0.5).abs().max((y - 0.5).abs()),
        |x, y| 0.15 * ((std::f64::consts::TAU * x).sin() + (2.0 * std::f64::consts::TAU * y).cos()),
        |x, y| if (x - 0.5).hypot(y - 0.5) < 0.3 { 0.4 } else { 0.0 },
        |x, _| 0.7 * (x - 0.5).abs(),
    ];
    for (number, height) in maps.into_iter().enumerate() {
        let at = |k: i32| {
            let (x, y) = (f64::from(k % side) / f64::from(side), f64::from(k / side) / f64::from(side));
            10.0 * height(x, y)
        };
        let map =
            HeightMap::new(side as usize, [10.0 / f64::from(side); 2], (0..side * side).map(at).collect());
        let found = kernel(&Surface::Heights(map.unwrap()), 40);
        let bands = &found.bands;
        // Before the laws are imposed, the light of each way has an error of its own.
        assert!(found.audit.reciprocity_z_rms < 1.15, "map {number}: {}", found.audit.reciprocity_z_rms);
        let transmitted = |from: Side| {
            let fraction = |band: usize| {
                let row = &found.scattered[band * bands.count() * found.azimuths()..];
                let there = bands.of(from.other());
                let scattered: f64 =
                    row[there.start * found.azimuths()..there.end * found.azimuths()].iter().sum();
                bands.area(band) * (scattered + found.regular_transmitted[band])
            };
            let all: f64 = bands.of(from).map(|band| bands.area(band)).sum();
            bands.of(from).map(fraction).sum::<f64>() / all
        };
        let (down, up) = (transmitted(Side::Above), transmitted(Side::Below));
        assert!((down - GLASS * GLASS * up).abs() < 1e-6 && down > 0.5, "map {number}: {down} {up}");
    }
}

/// Caps of small slopes: the light along the normal is that of a lens array (closed form), its edge and its peak included.
#[test]
fn caps_are_lenses() {
    for (aperture, reflected, edge, within_half) in
        [(0.2, 0.04000908, 0.10136220, 0.05016755), (0.4, 0.04016713, 0.21166724, 0.10136220)]
    {
        // Caps that cover the plane but for the gaps between their rims, whose light is regular.
        let caps = Caps {
            pitch_um: 2.0 * aperture,
            radius_um: 1.0,
            aperture_um: aperture,
            lattice: Lattice::Square,
        };
        let face = crate::caps::Balls::new(&caps, 0).unwrap();
        let numbers = papilio_sampling::SampleStream::new(
            papilio_sampling::Sampler::Sobol,
            papilio_testing::seeds(),
            0,
        );
        let (mut all, mut back, mut seen, mut largest) = (0.0, 0.0, 0.0, 0.0_f64);
        for path in 0..1 << 14 {
            let [x, y, ..] = numbers.block(path, 0);
            let ray = crate::goniometer::start(&face, Side::Above, [0.0, 1.0], [x, y], 0.0);
            crate::path::follow(&face, [1.0, GLASS], &ray, Side::Above, (&numbers, path), &mut |leaves| {
                if leaves.regular {
                    return;
                }
                all += leaves.weight;
                if leaves.side == Side::Above {
                    back += leaves.weight;
                } else {
                    let beta = GLASS * leaves.along[0].hypot(leaves.along[1]);
                    largest = largest.max(beta);
                    seen += if beta < within_half { leaves.weight } else { 0.0 };
                }
            });
        }
        // A quarter of the squares of slopes lies within half of the largest one: 0.24 of the light, after reflection.
        assert!((seen / all - 0.24).abs() < 2e-3, "{aperture}: {}", seen / all);
        assert!((back / all - reflected).abs() < 1e-5, "{aperture}: {}", back / all);
        assert!(
            (largest - edge).abs() < 1e-4 * edge && largest <= edge * (1.0 + 1e-9),
            "{aperture}: {largest}"
        );
    }
}

/// Small Gaussian slopes: light along the normal is deflected by (n - 1) slopes; half of it by less than (n - 1) alpha sqrt(ln 2).
#[test]
fn small_gaussian_slopes_have_the_closed_form() {
    let alpha = 0.1;
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 0.5 * alpha * 10.0, correlation_um: 10.0 }, 5)
        .unwrap();
    let statistics = face.realisation(0).unwrap().statistics();
    // A realisation of 21 correlation lengths has few independent heights.
    assert!((statistics.rms_um - 0.5).abs() < 0.1, "{statistics:?}");
    let goniometer =
        Goniometer { index_above: 1.0, index_below: GLASS, incidence_deg: Vec::new(), rays: 80, seed: 1 };
    let replicates: Vec<Replicate> = (0..REPLICATES)
        .map(|number| goniometer.replicate(&Surface::Random(face.clone()), number, &|| false).unwrap())
        .collect();
    let found = goniometer.kernel(&replicates).unwrap();
    let bands = &found.bands;
    // The first band is within 2.5 deg of the normal: |beta| up to 0.0436, the median of the slopes' lobe being 0.0416.
    let row = &found.scattered[..bands.count() * found.azimuths()];
    let within: f64 = bands
        .of(Side::Below)
        .take(1)
        .map(|to| row[to * found.azimuths()..][..found.azimuths()].iter().sum::<f64>())
        .sum();
    let all: f64 = bands
        .of(Side::Below)
        .map(|to| row[to * found.azimuths()..][..found.azimuths()].iter().sum::<f64>())
        .sum();
    // Light within the band is convolved with the band itself: a Gaussian of 1/e width w = (n - 1) alpha in the disc of radius b, averaged
    // over starts in the disc, by quadrature.
    let (w, b) = (0.5 * alpha, 2.5_f64.to_radians().sin());
    let expected = averaged_over_disc(w, b);
    assert!((within / all - expected).abs() < 0.02, "{} {expected}", within / all);
}

/// Fraction of a Gaussian `exp(-r^2/w^2)` about a uniform point of a disc of radius b that lies in the disc.
fn averaged_over_disc(w: f64, b: f64) -> f64 {
    let steps = 60;
    let cell = 2.0 * b / f64::from(steps);
    let points: Vec<[f64; 2]> = (0..steps * steps)
        .map(|k| {
            [0, 1].map(|axis| -b + cell * (f64::from(if axis == 0 { k % steps } else { k / steps }) + 0.5))
        })
        .filter(|[x, y]| x.hypot(*y) < b)
        .collect();
    let pairs =
        points.iter().flat_map(|a| points.iter().map(move |b| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)));
    let sum: f64 = pairs.map(|square| (-square / (w * w)).exp()).sum();
    sum * cell * cell / (std::f64::consts::PI * w * w) / points.len() as f64
}

/// Blocks only save time: with and without them, rays meet the same places.
#[test]
fn blocks_do_not_change_what_rays_meet() {
    use crate::heights::Triangles;
    use crate::ray::{Face as _, Met, Ray};
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 4.0, correlation_um: 10.0 }, 7).unwrap();
    let map = face.realisation(0).unwrap();
    let [with, without] = [true, false].map(|blocks| Triangles::with_blocks(&map, blocks));
    let mut dice = papilio_testing::Dice::new(0xb10c, 0);
    let mut facets = 0;
    for _ in 0..3000 {
        let (sine, azimuth) = (dice.between(0.0, 0.999), dice.between(0.0, std::f64::consts::TAU));
        let side = dice.of(Side::ALL);
        let up = if side == Side::Above { -1.0 } else { 1.0 } * (1.0 - sine * sine).sqrt();
        let [low, high] = with.heights_um();
        let z = if side == Side::Above { high } else { low };
        let mut ray = Ray {
            at: [dice.between(0.0, 213.0), dice.between(0.0, 213.0), z],
            along: [sine * azimuth.cos(), sine * azimuth.sin(), up],
        };
        // Where a ray meets a facet, it goes on as from a mirror; where the normal is, on its own side.
        for _ in 0..4 {
            match (with.next(&ray, side), without.next(&ray, side)) {
                (Met::Facet { at, normal }, Met::Facet { at: other, normal: beside }) => {
                    (0..3).for_each(|k| assert!((at[k] - other[k]).abs() < 1e-7, "{at:?} {other:?}"));
                    assert!(crate::ray::dot(normal, beside) > 1.0 - 1e-9 || (at[2] - other[2]).abs() < 1e-7);
                    let cosine = crate::ray::dot(ray.along, normal);
                    ray = Ray { at, along: crate::ray::moved(ray.along, -2.0 * cosine, normal) };
                    facets += 1;
                }
                (one, other) => {
                    assert_eq!(one, other);
                    break;
                }
            }
        }
    }
    assert!(facets > 3000);
}

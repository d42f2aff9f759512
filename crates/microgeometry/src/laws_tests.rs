//! The tracer against exact numbers and against the laws of light, for surfaces of many kinds.

use papilio_optics::interface::fresnel_reflectance;
use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::{Dice, assert_student, assert_unbiased, everyday, mean_and_error, sized};

use crate::bands::{AZIMUTHS, Bands};
use crate::goniometer::start;
use crate::path::{Facets, Leaves, follow};
use crate::ray::Ray;
use crate::*;

const GLASS: f64 = 1.5;

fn goniometer(index: [f64; 2], rays: u64, seed: u64) -> Goniometer {
    Goniometer {
        index_above: index[0],
        index_below: index[1],
        coating: Coating::None,
        incidence_deg: Vec::new(),
        azimuths: None,
        rays,
        seed,
    }
}

fn replicates(of: &Goniometer, surface: &Surface) -> Vec<Replicate> {
    (0..REPLICATES).map(|number| of.replicate(surface, number, &|| false).unwrap()).collect()
}

pub(crate) fn caps(lattice: Lattice, aperture_um: f64, radius_um: f64) -> Surface {
    Surface::Caps(Caps { pitch_um: 4.5, radius_um, aperture_um, lattice })
}

/// Mean of a function of the squared sine of the slope, uniform from 0 to `most`, by the midpoint rule.
fn over_caps(most: f64, of: impl Fn(f64) -> f64) -> f64 {
    let count = 2000;
    (0..count).map(|k| of(most * (f64::from(k) + 0.5) / f64::from(count))).sum::<f64>() / f64::from(count)
}

/// Light at normal incidence from above: the mean of a quantity over all that leaves, its error, and its
/// largest value in transmission.
fn estimate(surface: &Surface, seed: u64, of: impl Fn(&Leaves, f64) -> f64) -> (f64, f64, f64) {
    let (rays, mut most) = (64, 0.0_f64);
    let mut replicate = |number| {
        let numbers = SampleStream::new(Sampler::Sobol, seed, number);
        let mut sum = 0.0;
        let trace = |face: &dyn crate::ray::Face| {
            for path in 0..rays {
                let [x, y, azimuth, _] = numbers.block(path, 0);
                let ray = start(face, Side::Above, [0.0, 1.0], [x, y], azimuth);
                let stays = follow(
                    face,
                    Facets { index: [1.0, GLASS], coating: &Coating::None },
                    &ray,
                    Side::Above,
                    (&numbers, path),
                    &mut |leaves| {
                        let index = if leaves.side == Side::Below { GLASS } else { 1.0 };
                        let value = of(&leaves, index * leaves.along[0].hypot(leaves.along[1]));
                        sum += leaves.weight * value;
                        if leaves.side == Side::Below {
                            most = most.max(value);
                        }
                    },
                );
                assert_eq!(stays.lost, 0.0);
            }
        };
        surface.with_face(number, trace).unwrap();
        sum / rays as f64
    };
    let values: Vec<f64> = (0..REPLICATES).map(&mut replicate).collect();
    let (mean, error) = mean_and_error(values);
    (mean, error, most)
}

/// Shallow caps meet light at normal incidence once. The squared sine of the slope is uniform under it, hence
/// closed forms: the reflectance, the share of transmitted light within a cone, and the edge of the cone.
#[test]
fn lens_arrays_have_the_closed_form() {
    for (steepest, reflectance, edge, quarter) in
        [(0.2, 0.04000908, 0.10136220, 0.23999986), (0.4, 0.04016713, 0.21166724, 0.23999773)]
    {
        let beta = |s: f64| s * ((GLASS * GLASS - s * s).sqrt() - (1.0 - s * s).sqrt());
        let fresnel = |squared: f64| fresnel_reflectance(1.0, GLASS, squared.sqrt());
        let square = steepest * steepest;
        assert!((over_caps(square, fresnel) - reflectance).abs() < 1e-8, "{}", over_caps(square, fresnel));
        assert!((beta(steepest) - edge).abs() < 1e-8);
        let half = beta(0.5 * steepest);
        let within = 0.25 * over_caps(0.25 * square, |s| 1.0 - fresnel(s));
        assert!((within - quarter).abs() < 1e-8, "{within}");

        let surface = caps(Lattice::Square, 2.25, 2.25 / steepest);
        let fill = std::f64::consts::PI / 4.0;
        let flat = 1.0 - fill;
        let is_true = |yes: bool| f64::from(u8::from(yes));
        let (_, _, most) =
            estimate(&surface, 0, |leaves, beta| if leaves.facets == 1 { beta } else { f64::INFINITY });
        // The outermost thousandth of the beam's radius may be missed by 2048 rays.
        assert!(most > edge * 0.999 && most < edge * (1.0 + 1e-9), "{most}, not up to {edge}");
        assert_unbiased("reflectance of caps", fill * reflectance + flat * 0.04, 0.01, |seed| {
            let (mean, error, _) = estimate(&surface, seed, |leaves, _| is_true(leaves.side == Side::Above));
            (mean, error)
        });
        assert_unbiased("light within a cone", fill * quarter + flat * 0.96, 0.02, |seed| {
            let (mean, error, _) =
                estimate(&surface, seed, |leaves, beta| is_true(leaves.side == Side::Below && beta < half));
            (mean, error)
        });
    }
}

/// Grooves of 90 deg below which light is totally reflected: light in the plane across them returns to where
/// it came from, but for the share tan θ that misses the second facet.
#[test]
fn right_angled_grooves_send_light_back() {
    let grooves = Surface::Heights(HeightMap::new(2, [1.0; 2], vec![0.0, 1.0]).unwrap());
    for theta_deg in [0.0_f64, 5.0, 10.0] {
        let (sine, cosine) = theta_deg.to_radians().sin_cos();
        let (rays, mut back) = (20_000_u32, 0);
        let trace = |face: &dyn crate::ray::Face| {
            for path in 0..rays {
                // Equidistant starts: the share is known within a ray at each of the four ends of facets.
                let at = [2.0 * (f64::from(path) + 0.5) / f64::from(rays), 0.37, 0.0];
                let ray = Ray { at, along: [-sine, 0.0, cosine] };
                let numbers = SampleStream::new(Sampler::Random, 1, 0);
                let numbers = (&numbers, u64::from(path));
                let stays = follow(
                    face,
                    Facets { index: [1.0, 2.0], coating: &Coating::None },
                    &ray,
                    Side::Below,
                    numbers,
                    &mut |leaves| {
                        assert_eq!((leaves.side, leaves.weight, leaves.regular), (Side::Below, 1.0, false));
                        if leaves.facets == 2 {
                            let away = [0, 1, 2].map(|k| (leaves.along[k] + ray.along[k]).abs());
                            assert!(away.into_iter().all(|away| away < 1e-12), "{leaves:?}");
                            back += 1;
                        }
                    },
                );
                assert_eq!(stays.lost, 0.0);
            }
        };
        grooves.with_face(0, trace).unwrap();
        let share = f64::from(back) / f64::from(rays);
        let expected = 1.0 - theta_deg.to_radians().tan();
        assert!(
            (share - expected).abs() <= 4.0 / f64::from(rays),
            "{theta_deg} deg: {share}, not {expected}"
        );
    }
}

/// Surfaces of many kinds: caps on all lattices, sines, noise of single heights, pyramids, terraces, random
/// faces.
pub(crate) fn kinds() -> Vec<Surface> {
    let mut dice = Dice::new(25, 0);
    let map = |side: usize, of: &mut dyn FnMut(usize, usize) -> f64| {
        let heights = (0..side * side).map(|at| of(at % side, at / side)).collect();
        Surface::Heights(HeightMap::new(side, [1.0, 0.8], heights).unwrap())
    };
    let turn = |at: usize, side: usize| std::f64::consts::TAU * at as f64 / side as f64;
    let ridge = |at: usize, side: usize| (at as f64 - 0.5 * side as f64).abs();
    let gaussian = Spectrum::Gaussian { rms_um: 2.5, correlation_um: 10.0 };
    vec![
        caps(Lattice::Square, 2.25, 2.25),
        caps(Lattice::Hexagonal, 2.25, 2.25),
        caps(Lattice::Hexagonal, 1.5, 2.0),
        caps(Lattice::Random { seed: 3 }, 2.0, 2.2),
        map(16, &mut |x, y| 3.0 * turn(x, 16).sin() * turn(y, 16).cos()),
        map(12, &mut |x, y| 4.0 * (turn(x, 12) + 2.0 * turn(y, 12)).sin()),
        map(10, &mut |_, _| dice.throw()),
        map(10, &mut |_, _| 5.0 * dice.throw()),
        map(8, &mut |x, y| -ridge(x, 8).max(ridge(y, 8))),
        map(8, &mut |x, y| 1.5 * ridge(x, 8).min(ridge(y, 8))),
        map(6, &mut |x, y| if x < 3 && y < 3 { 2.0 } else { 0.0 }),
        Surface::Random(RandomHeights::new(gaussian, 1).unwrap()),
    ]
}

/// What diffuse light transmits, per étendue, from each side.
pub(crate) fn diffuse(bands: &Bands, one: &Replicate) -> [f64; 2] {
    let count = bands.count();
    let azimuths = one.scattered.len() / (count * count);
    Side::ALL.map(|side| {
        let others = bands.of(side.other());
        let transmitted = |from: usize| {
            let row = &one.scattered[from * count * azimuths..][..count * azimuths];
            let scattered: f64 = row[others.start * azimuths..others.end * azimuths].iter().sum();
            bands.area(from) * (scattered + one.regular[from][1])
        };
        bands.of(side).map(transmitted).sum()
    })
}

/// Without losses, diffuse light of the same radiance over n² on both sides goes down as it comes up, for any
/// geometry. The difference over its standard error follows Student's distribution; no ray is lost.
#[test]
fn diffuse_transmittance_is_the_same_in_both_directions() {
    let kinds = kinds();
    // Random faces come last: making them takes longer than measuring them.
    for (index, kinds) in [([1.0, GLASS], &kinds[..]), ([1.33, 1.6], &kinds[..sized(4, 11)])] {
        let bands = Bands::new(index);
        let all: f64 = bands.of(Side::Above).map(|band| bands.area(band)).sum();
        let score = |(kind, surface): (usize, &Surface)| {
            let found = replicates(&goniometer(index, 8, kind as u64), surface);
            assert_eq!(found.iter().map(|one| one.lost).sum::<f64>(), 0.0, "{surface:?}");
            let differences = found.iter().map(|one| diffuse(&bands, one)).map(|[down, up]| down - up);
            let (mean, error) = mean_and_error(differences);
            assert!(error < 0.01 * all, "the test is weak: {error} of {all}");
            mean / error
        };
        let scores: Vec<f64> = kinds.iter().enumerate().map(score).collect();
        assert_student("diffuse transmittance", &scores, scores.len() as f64);
    }
}

/// A random height map: waves of several directions through one of several functions, with its own pitches
/// and slopes.
pub(crate) fn random_map(number: u64) -> HeightMap {
    let mut dice = Dice::new(50, number);
    let [columns, rows] = [0, 1].map(|_| 8 + dice.below(17));
    let waves: Vec<[f64; 4]> = (0..1 + dice.below(5))
        .map(|_| [dice.below(4) as f64, dice.below(7) as f64 - 3.0, dice.throw(), dice.log_between(0.1, 1.0)])
        .collect();
    let (bend, steps, noise) = (dice.below(6), 1.0 + 3.0 * dice.throw(), 0.3 * dice.throw());
    let height = dice.log_between(0.3, 8.0);
    let heights = (0..columns * rows).map(|at| {
        let [x, y] = [(at % columns) as f64 / columns as f64, (at / columns) as f64 / rows as f64];
        let wave =
            |[kx, ky, turn, size]: &[f64; 4]| size * (std::f64::consts::TAU * (kx * x + ky * y + turn)).sin();
        let sum: f64 = waves.iter().map(wave).sum();
        let bent = match bend {
            0 => sum,
            1 => sum.abs(),
            2 => sum * sum,
            3 => sum.exp(),
            4 => (steps * sum).floor(),
            _ => sum.max(0.0),
        };
        height * (bent + noise * dice.throw())
    });
    let heights: Vec<f64> = heights.collect();
    let pitch = [0, 1].map(|_| dice.log_between(0.5, 2.0));
    HeightMap::new(columns, pitch, heights).unwrap()
}

/// The same for random height maps of fifty kinds, between random media.
#[test]
fn random_maps_obey_reciprocity() {
    let score = |number: u64| {
        let mut dice = Dice::new(51, number);
        let index = [dice.of([1.0, 1.0, 1.33]), dice.between(1.4, 2.2)];
        let bands = Bands::new(index);
        let found = replicates(&goniometer(index, 4, number), &Surface::Heights(random_map(number)));
        assert_eq!(found.iter().map(|one| one.lost).sum::<f64>(), 0.0, "map {number}");
        let (mean, error) =
            mean_and_error(found.iter().map(|one| diffuse(&bands, one)).map(|[down, up]| down - up));
        mean / error
    };
    let scores: Vec<f64> = (0..sized(25, 50)).map(score).collect();
    assert_student("diffuse transmittance of random maps", &scores, scores.len() as f64);
}

/// Kernels conserve energy and are reciprocal. The measured ones, before they are balanced, are so within their
/// errors. Other media are included.
#[test]
fn kernels_obey_the_laws() {
    let gaussian = Spectrum::Gaussian { rms_um: 2.5, correlation_um: 10.0 };
    let random = Surface::Random(RandomHeights::new(gaussian, 1).unwrap());
    let cases = [
        (caps(Lattice::Square, 2.25, 2.25), [1.0, GLASS]),
        // Mostly flat: regular light must come and go by the same bands, also between media that are both
        // denser than air.
        (caps(Lattice::Square, 1.0, 1.0), [1.33, 1.6]),
        (random, [1.0, GLASS]),
    ];
    for (surface, index) in everyday(2, cases) {
        let of = goniometer(index, 100, 4);
        let found = of.kernel(&replicates(&of, &surface)).unwrap();
        let (bands, azimuths) = (&found.bands, found.azimuths());
        let count = bands.count();
        let cell = |from: usize, to: usize, azimuth: usize| {
            bands.area(from) * found.scattered[(from * count + to) * azimuths + azimuth]
        };
        for from in 0..count {
            let row: f64 = found.scattered[from * count * azimuths..][..count * azimuths].iter().sum();
            let sum = row + found.regular_reflected[from] + found.regular_transmitted[from];
            assert!((sum - 1.0).abs() < 1e-6, "{index:?}: band {from} keeps {sum}");
            for (to, azimuth) in (0..from).flat_map(|to| (0..azimuths).map(move |azimuth| (to, azimuth))) {
                assert!((cell(from, to, azimuth) - cell(to, from, azimuth)).abs() < 1e-12);
            }
        }
        let Audit { energy_z, reciprocity_z_rms, reciprocity_tests, dropped_rays, .. } = &found.audit;
        assert_eq!(*dropped_rays, 0.0);
        let known: Vec<f64> = energy_z.iter().copied().filter(|z| *z != 0.0).collect();
        // Neighbouring bands share rays: a quarter of the scores counts as independent.
        assert_student("energy of bands", &known, 0.25 * known.len() as f64);
        // The root mean square of 250 scores is known within 0.045: four of these are allowed. The flatter
        // caps leave 314 patches with light enough.
        assert!(*reciprocity_tests > 250 && (0.8..1.2).contains(reciprocity_z_rms), "{:?}", found.audit);
    }
}

/// A kernel that loses light, or treats one way otherwise than the other, is no face.
#[test]
fn faces_that_break_the_laws_are_refused() {
    let of = goniometer([1.0, GLASS], 10, 1);
    let table = FaceTable::new(
        [1.0, GLASS],
        &of.kernel(&replicates(&of, &caps(Lattice::Square, 2.25, 2.25))).unwrap(),
    );
    assert!(table.kernels().is_ok());
    let mut darker = table.clone();
    darker.regular_reflected[3] *= 0.5;
    let message = darker.kernels().unwrap_err().to_string();
    assert!(message.starts_with("light of band 3 of the kernel of a face adds up to 0.9"), "{message}");
    let mut turned = table;
    // Light of another azimuth: the sum of the row stays.
    let row = &mut turned.scattered[..AZIMUTHS];
    let (first, rest) = row.split_at_mut(1);
    rest[0] += first[0];
    first[0] = 0.0;
    assert!(turned.kernels().is_ok(), "a band and itself: both ways are one");
    let count = Bands::new([1.0, GLASS]).count();
    let row = &mut turned.scattered[..count * AZIMUTHS];
    let light: f64 = row[AZIMUTHS..].iter().sum();
    row[AZIMUTHS..].fill(0.0);
    row[AZIMUTHS] = light;
    let message = turned.kernels().unwrap_err().to_string();
    assert!(message.contains("not reciprocal: between bands"), "{message}");
}

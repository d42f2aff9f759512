//! Rough interfaces: reciprocity, no losses, samples that follow their density, limits.

mod heitz;
mod limits;
mod several;

use std::f64::consts::{FRAC_PI_2, TAU};

use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::rough::{Distribution, OnSide, Rough, Side};
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::{SampleStream, Sampler, warp};
use papilio_testing::{ChiSquare, everyday, sized};

const SIDES: [Side; 2] = [Side::Above, Side::Below];

/// Returns light at this angle in the medium of its side, in the plane phi = 0.
fn beta(face: &Rough, side: Side, theta_deg: f64) -> Beta {
    Beta::towards(theta_deg, 0.0, face.index(side))
}

/// Returns the integral of `integrand` over the disc of this side, between two angles and two azimuths: a
/// two-point Gauss rule in each step of the angle, the midpoint rule in azimuth.
fn integral(
    n: f64,
    [from, to]: [f64; 2],
    [first, last]: [f64; 2],
    steps: [usize; 2],
    integrand: impl Fn(Beta) -> f64,
) -> f64 {
    let (d_theta, d_turn) = ((to - from) / steps[0] as f64, (last - first) / steps[1] as f64);
    let mut sum = 0.0;
    for i in 0..2 * steps[0] {
        let gauss = if i % 2 == 0 { -0.5 } else { 0.5 } / 3.0_f64.sqrt();
        let (sin, cos) = (from + d_theta * ((i / 2) as f64 + 0.5 + gauss)).sin_cos();
        let ring: f64 = (0..steps[1])
            .map(|j| {
                let (x, y) = warp::polar(n * sin, first + d_turn * (j as f64 + 0.5));
                integrand(Beta { x, y })
            })
            .sum();
        sum += ring * n * n * sin * cos;
    }
    0.5 * sum * d_theta * d_turn * TAU
}

/// Returns the integral over a whole side, divided at an angle (radians) where the integrand jumps; the
/// integrand is symmetric about the plane of incidence, phi = 0.
fn over_side(face: &Rough, side: Side, cut: f64, steps: [usize; 2], integrand: impl Fn(Beta) -> f64) -> f64 {
    let half = |angles| integral(face.index(side), angles, [0.0, 0.5], steps, &integrand);
    2.0 * (half([0.0, cut]) + half([cut, FRAC_PI_2]))
}

#[test]
fn density_is_reciprocal_for_all_directions() {
    use Distribution::{Beckmann, Ggx};
    let student = Distribution::StudentT { tail: 2.5 };
    for (distribution, alpha, above, below) in [
        (Ggx, 0.02, 1.0, 1.5),
        (Ggx, 0.2, 1.0, 1.5),
        (Beckmann, 0.5, 1.7, 1.33),
        (Ggx, 1.0, 1.5, 1.52),
        (student, 0.1, 1.0, 1.5),
    ] {
        let face = Rough::with(distribution, alpha, above, below);
        let numbers = SampleStream::new(Sampler::Random, 3, 0);
        for path in 0..sized(1000, 2000) {
            let u = numbers.block(path, 0);
            for from in SIDES {
                for to in SIDES {
                    let (x, y) = warp::uniform_disc(face.index(from), [u[0], u[1]]);
                    let a = Beta { x, y };
                    let (x, y) = warp::uniform_disc(face.index(to), [u[2], u[3]]);
                    let b = Beta { x, y };
                    // Back along the same path: propagation is reversed, and the interface is isotropic.
                    for back in [(b, a), (-b, -a)] {
                        let pair = [
                            face.evaluate(from.at(a), to.at(b)),
                            face.evaluate(to.at(back.0), from.at(back.1)),
                        ];
                        assert!((pair[0] - pair[1]).abs() <= 1e-10 * pair[0], "{from:?} {to:?}: {pair:?}");
                        let pair = [face.single(from, a, to, b), face.single(to, back.0, from, back.1)];
                        assert!((pair[0] - pair[1]).abs() <= 1e-10 * pair[0].max(1e-6), "{pair:?}");
                    }
                }
            }
        }
    }
}

/// Refracted light jumps to zero where q is the same on both sides: there the microfacets are vertical. If
/// divided there, the rule is accurate to 2e-5 (critical angle, narrow peaks), the table of deficits to
/// 1e-5; with four times the steps the largest difference from one is 2e-6.
#[test]
fn scattered_light_sums_to_one() {
    use Distribution::{Beckmann, Ggx};
    let [heavy, light] = [2.4, 8.0].map(|tail| Distribution::StudentT { tail });
    let faces =
        [(Ggx, 0.2), (Beckmann, 0.5), (heavy, 0.2), (Ggx, 1.0), (light, 0.5), (Ggx, 0.5), (Ggx, 0.05)];
    for (distribution, alpha) in everyday(4, faces) {
        let face = Rough::with(distribution, alpha, 1.0, 1.5);
        // Wide lobes need few points.
        let steps = match alpha {
            0.5.. => [180, 110],
            0.1.. => [250, 150],
            _ => [500, 300],
        };
        for from in SIDES {
            for theta_deg in [0.0, 43.0, 75.0] {
                let a = beta(&face, from, theta_deg);
                let q = face.index(from) * f64::to_radians(theta_deg).cos();
                let whole = SIDES.map(|to| {
                    let cut = (q / face.index(to)).min(1.0).acos();
                    over_side(&face, to, cut, steps, |b| face.evaluate(from.at(a), to.at(b)))
                });
                let lost = 1.0 - whole[0] - whole[1];
                assert!(lost.abs() < 3e-5, "{alpha} {from:?} {theta_deg}: {lost:e}");
            }
        }
    }
}

/// Chi-square of samples of `drawn` against the density of `claimed`, on 10 x 8 cells of each side.
fn chi_square(drawn: &Rough, from: Side, a: Beta, claimed: impl Fn(Side, Beta) -> f64) -> ChiSquare {
    let (rings, turns, samples) = (10, 8, 40_000);
    let numbers = SampleStream::new(Sampler::Random, 29, 0);
    let mut counts = vec![0.0; 2 * rings * turns];
    for path in 0..samples {
        let OnSide { side, beta: b } = drawn.sample(from.at(a), numbers.block(path, 0)).unwrap().direction;
        let sine = b.length() / drawn.index(side);
        assert!(sine < 1.0);
        let turn = b.y.atan2(b.x).rem_euclid(TAU) / TAU;
        let ring = ((sine.asin() / FRAC_PI_2 * rings as f64) as usize).min(rings - 1);
        let cell = ring * turns + ((turn * turns as f64) as usize).min(turns - 1);
        counts[usize::from(side == Side::Below) * rings * turns + cell] += 1.0;
    }
    // Wide lobes need few points.
    let steps = if drawn.alpha() < 0.2 { [20, 40] } else { [10, 20] };
    let cells = counts.into_iter().enumerate().map(|(at, count)| {
        let side = SIDES[at / (rings * turns)];
        let (ring, turn) = (at / turns % rings, at % turns);
        let angle = |ring: usize| FRAC_PI_2 * ring as f64 / rings as f64;
        let spread = |turn: usize| turn as f64 / turns as f64;
        let edges = ([angle(ring), angle(ring + 1)], [spread(turn), spread(turn + 1)]);
        let share = integral(drawn.index(side), edges.0, edges.1, steps, |b| claimed(side, b));
        (count, share * samples as f64)
    });
    ChiSquare::of(cells, 10.0)
}

#[test]
fn samples_follow_density() {
    use Distribution::{Beckmann, Ggx};
    let [heavy, light] = [2.4, 8.0].map(|tail| Distribution::StudentT { tail });
    let faces = [
        (Ggx, 0.1, 1.0, 1.5),
        (Beckmann, 0.4, 1.0, 1.5),
        (heavy, 0.15, 1.0, 1.5),
        (light, 0.6, 1.6, 1.4),
        (Ggx, 0.5, 1.6, 1.4),
        (Ggx, 1.0, 1.0, 1.5),
        (Ggx, 0.3, 1.0, 1.5),
    ];
    for (distribution, alpha, above, below) in everyday(4, faces) {
        let face = Rough::with(distribution, alpha, above, below);
        for from in SIDES {
            for theta_deg in [0.0, 40.0, 80.0] {
                let a = beta(&face, from, theta_deg);
                let found = chi_square(&face, from, a, |to, b| face.evaluate(from.at(a), to.at(b)));
                assert!(found.is_likely(), "{alpha} {from:?} {theta_deg}: {found:?}");
            }
        }
    }
}

#[test]
fn wrong_densities_are_refused() {
    let (face, rougher) = (Rough::new(0.3, 1.0, 1.5), Rough::new(0.33, 1.0, 1.5));
    for from in SIDES {
        let a = beta(&face, from, 40.0);
        let found = chi_square(&face, from, a, |to, b| rougher.evaluate(from.at(a), to.at(b)));
        assert!(!found.is_likely(), "rougher: {found:?}");
        // A single microfacet, scaled to one.
        let scale = 1.0 / (1.0 - face.deficit(from, a.length()));
        let found = chi_square(&face, from, a, |to, b| scale * face.single(from, a, to, b));
        assert!(!found.is_likely(), "scaled: {found:?}");
    }
}

/// Samples follow the density also where they are rare: light of several microfacets.
#[test]
fn light_of_several_microfacets_is_sampled_with_its_probability() {
    let face = Rough::new(0.2, 1.0, 1.5);
    let numbers = SampleStream::new(Sampler::Random, 31, 0);
    for from in SIDES {
        let a = beta(&face, from, 30.0);
        let samples = 100_000;
        let mean = (0..samples).map(|path| {
            let OnSide { side: to, beta: b } =
                face.sample(from.at(a), numbers.block(path, 1)).unwrap().direction;
            1.0 - face.single(from, a, to, b) / face.evaluate(from.at(a), to.at(b))
        });
        let mean = mean.sum::<f64>() / samples as f64;
        let deficit = face.deficit(from, a.length());
        // Four sigma of a Bernoulli variable of this probability at most.
        let tolerance = 4.0 * (deficit / samples as f64).sqrt();
        assert!((mean - deficit).abs() < tolerance, "{from:?}: {mean} {deficit}");
    }
}

/// Samples on both sides, with their probabilities, have the mean of samples on one: of the side, of the
/// direction, and of light that has met several microfacets.
#[test]
fn samples_of_both_sides_have_the_mean_of_single_samples() {
    let face = Rough::new(0.5, 1.0, 1.5);
    let numbers = SampleStream::new(Sampler::Random, 37, 0);
    for (from, theta_deg) in [(Side::Above, 30.0), (Side::Below, 30.0), (Side::Below, 60.0)] {
        let a = beta(&face, from, theta_deg);
        let functions = |to: OnSide| {
            let b = to.beta;
            let several = 1.0 - face.single(from, a, to.side, b) / face.evaluate(from.at(a), to);
            let back = f64::from(u8::from(to.side == from));
            [back, back * b.x, (1.0 - back) * b.x, b.squared(), several, back * several]
        };
        let samples = 50_000;
        let mut sums = [[0.0; 2]; 6];
        for path in 0..samples {
            let one = functions(face.sample(from.at(a), numbers.block(path, 1)).unwrap().direction);
            let sides = face.sample_sides(from.at(a), numbers.block(path, 2));
            assert!((sides[0].1 + sides[1].1 - 1.0).abs() < 1e-12);
            let mut both = [0.0; 6];
            for (sample, probability) in sides {
                let Some(direction) = sample else { continue };
                let values = functions(direction);
                both.iter_mut().zip(values).for_each(|(sum, value)| *sum += probability * value);
            }
            for ((sum, one), both) in sums.iter_mut().zip(one).zip(both) {
                let difference = one - both;
                *sum = [sum[0] + difference, sum[1] + difference * difference];
            }
        }
        for (number, [sum, square]) in sums.into_iter().enumerate() {
            let z = sum / f64::sqrt(square);
            assert!(z.abs() < 4.0, "{from:?} {theta_deg}, function {number}: {z}");
        }
    }
}

/// Away from the critical angle; the remaining difference is of the order of alpha squared.
#[test]
fn fine_roughness_reflects_as_fresnel() {
    let face = Rough::new(0.01, 1.0, 1.5);
    let numbers = SampleStream::new(Sampler::Sobol, 41, 0);
    for from in SIDES {
        for theta_deg in [0.0, 20.0, 60.0] {
            let a = beta(&face, from, theta_deg);
            let samples = 1 << 16;
            let reflected = (0..samples).filter(|&path| {
                face.sample(from.at(a), numbers.block(path, 0)).unwrap().direction.side == from
            });
            let share = reflected.count() as f64 / samples as f64;
            let expected = fresnel_reflectance(face.index(from), face.index(from.other()), a.length());
            assert!((share - expected).abs() < 1e-3, "{from:?} {theta_deg}: {share} {expected}");
        }
    }
}

/// An event at the interface: side and direction after it, and the remaining fraction of the light.
type Meets<'a> = &'a dyn Fn(Side, Beta, [f64; 4]) -> (Side, Beta, f64);

/// Fraction of light along the normal that a white mirror under a rough interface does not return, and its
/// standard error.
fn loss_over_a_white_mirror(seed: u64, meets: Meets<'_>) -> (f64, f64) {
    let numbers = SampleStream::new(Sampler::Random, seed, 0);
    let (mut sum, mut squares, paths) = (0.0, 0.0, 200_000);
    for path in 0..paths {
        let (mut side, mut beta, mut weight) = (Side::Above, Beta::default(), 1.0);
        for bounce in 0.. {
            let (to, out, kept) = meets(side, beta, numbers.block(path, bounce));
            weight *= kept;
            if to == Side::Above || weight < 1e-12 {
                break;
            }
            // The mirror reflects it up with the same beta.
            (side, beta) = (Side::Below, out);
        }
        sum += 1.0 - weight;
        squares += (1.0 - weight) * (1.0 - weight);
    }
    let mean = sum / paths as f64;
    (mean, ((squares / paths as f64 - mean * mean) / paths as f64).sqrt())
}

/// One event as given by Walter et al. (2007), in unit vectors: a normal drawn with D cos (eq. 35, 36),
/// reflected or refracted (eq. 39, 40), weighted by eq. 41, except for the shadowing: at the height of the
/// microfacet, drawn uniformly, light arrives and leaves unhindered.
fn walter(alpha: f64, above: f64, below: f64, from: Side, beta: Beta, u: [f64; 4]) -> (Side, Beta, f64) {
    let (n_i, n_o, other) = match from {
        Side::Above => (above, below, Side::Below),
        Side::Below => (below, above, Side::Above),
    };
    let (x, y) = (-beta.x / n_i, -beta.y / n_i);
    let i = [x, y, (1.0 - x * x - y * y).sqrt()];
    let theta_m = (alpha * (u[0] / (1.0 - u[0])).sqrt()).atan();
    let (x, y) = warp::polar(theta_m.sin(), u[1]);
    let m = [x, y, theta_m.cos()];
    let c = i[0] * m[0] + i[1] * m[1] + i[2] * m[2];
    if c <= 0.0 {
        return (from, beta, 0.0);
    }
    let g = (n_o * n_o / (n_i * n_i) - 1.0 + c * c).max(0.0).sqrt();
    let fresnel = fresnel_reflectance(n_i, n_o, n_i * (1.0 - c * c).max(0.0).sqrt());
    let (to, o) = if u[2] < fresnel {
        (from, [0, 1, 2].map(|k| 2.0 * c * m[k] - i[k]))
    } else {
        let eta = n_i / n_o;
        (other, [0, 1, 2].map(|k| eta * ((c - g) * m[k] - i[k])))
    };
    let outward = if to == from { o[2] } else { -o[2] };
    if outward <= 0.0 {
        return (from, beta, 0.0);
    }
    let lambda = |cos: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (cos * cos) - 1.0)).sqrt() - 1.0);
    let (n, height) = if to == from { (n_i, u[3]) } else { (n_o, 1.0 - u[3]) };
    let shadowing = u[3].powf(lambda(i[2])) * height.powf(lambda(outward));
    (to, Beta { x: n * o[0], y: n * o[1] }, c * shadowing / (i[2] * m[2]))
}

/// Renderers that follow one microfacet per event (Mitsuba 3, pbrt-v4) are reported to lose 6.3 % here, at a
/// direction near the normal. On the normal itself two methods give 6.0 %.
#[test]
fn single_microfacet_loses_6_percent_over_white_mirror() {
    let face = Rough::new(0.2, 1.0, 1.5);
    let single = |from: Side, a: Beta, u: [f64; 4]| {
        let OnSide { side: to, beta: b } = face.sample(from.at(a), u).unwrap().direction;
        (to, b, face.single(from, a, to, b) / face.evaluate(from.at(a), to.at(b)))
    };
    let (lost, error) = loss_over_a_white_mirror(37, &single);
    let (expected, its_error) = loss_over_a_white_mirror(38, &|from, a, u| walter(0.2, 1.0, 1.5, from, a, u));
    assert!(error.max(its_error) < 2e-3, "{error} {its_error}");
    assert!(
        (lost - expected).abs() < 4.0 * error.hypot(its_error),
        "{lost} +- {error}, {expected} +- {its_error}"
    );
    assert!((lost - 0.063).abs() < 0.004, "{lost}");
    let whole = |from: Side, a, u| {
        let OnSide { side: to, beta: b } = face.sample(from.at(a), u).unwrap().direction;
        (to, b, 1.0)
    };
    assert_eq!(loss_over_a_white_mirror(37, &whole).0, 0.0);
}

#[test]
fn directions_that_do_not_exist_have_no_density() {
    let face = Rough::new(0.3, 1.0, 1.5);
    let (inside, beyond) = (Beta { x: 0.5, y: 0.0 }, Beta { x: 1.2, y: 0.0 });
    assert_eq!(face.evaluate(Side::Above.at(inside), Side::Above.at(beyond)), 0.0);
    assert_eq!(face.evaluate(Side::Below.at(inside), Side::Above.at(beyond)), 0.0);
    assert!(face.evaluate(Side::Above.at(inside), Side::Below.at(beyond)) > 0.0);
    assert_eq!(face.deficit(Side::Above, 1.2), 0.0);
}

/// Light of several microfacets is distributed back in proportion to the returned light, across in
/// proportion to the transmitted light, and in no other way.
#[test]
fn light_lost_by_one_microfacet_is_distributed_reciprocally() {
    let face = Rough::new(0.4, 1.0, 1.5);
    let sums = SIDES.map(|side| {
        [0, 1].map(|way| over_side(&face, side, 1.0, [250, 150], |b| face.several(side, b.length())[way]))
    });
    assert!((sums[0][1] / sums[1][1] - 1.0).abs() < 1e-6, "{sums:?}");
    for (from, to) in [(Side::Above, Side::Below), (Side::Below, Side::Below), (Side::Above, Side::Above)] {
        let way = usize::from(from != to);
        let (a, b) = (beta(&face, from, 20.0), beta(&face, to, 65.0));
        let again = face.evaluate(from.at(a), to.at(b)) - face.single(from, a, to, b);
        let [d_a, d_b] = [(from, a), (to, b)].map(|(side, beta)| face.several(side, beta.length())[way]);
        let expected = d_a * d_b / sums[from as usize][way];
        assert!((again / expected - 1.0).abs() < 1e-6, "{again} {expected}");
    }
}

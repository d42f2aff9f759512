//! Student's slopes between GGX and Gaussian ones: the limits, and a tail that is measured.

use papilio_optics::Beta;
use papilio_optics::rough::{Distribution, OnSide, Rough, Side};
use papilio_sampling::{SampleStream, Sampler, warp};

use super::{SIDES, beta, chi_square};

/// Largest difference of the light of one microfacet between two faces, relative to the largest value.
fn difference(one: &Rough, other: &Rough) -> f64 {
    let numbers = SampleStream::new(Sampler::Random, 5, 0);
    let (mut worst, mut most) = (0.0_f64, 0.0_f64);
    for path in 0..2000 {
        let u = numbers.block(path, 0);
        for (from, to) in [(SIDES[0], SIDES[0]), (SIDES[0], SIDES[1]), (SIDES[1], SIDES[1])] {
            let (x, y) = warp::uniform_disc(one.index(from), [u[0], u[1]]);
            let a = Beta { x, y };
            let (x, y) = warp::uniform_disc(one.index(to), [u[2], u[3]]);
            let [one, other] = [one, other].map(|face| face.single(from, a, to, Beta { x, y }));
            most = most.max(other);
            worst = worst.max((one - other).abs());
        }
    }
    worst / most
}

#[test]
fn tail_of_2_is_ggx() {
    let student = Distribution::StudentT { tail: 2.0 };
    for alpha in [0.05, 0.4] {
        let [one, ggx] = [student, Distribution::Ggx].map(|slopes| Rough::with(slopes, alpha, 1.0, 1.5));
        assert!(difference(&one, &ggx) < 1e-9, "{alpha}");
        for from in SIDES {
            for theta_deg in [0.0, 70.0] {
                let length = beta(&ggx, from, theta_deg).length();
                let [found, expected] = [&one, &ggx].map(|face| face.several(from, length));
                assert!(
                    (0..2).all(|way| (found[way] - expected[way]).abs() < 1e-7),
                    "{found:?} {expected:?}"
                );
            }
        }
        // The samplers are not the same code.
        let a = beta(&ggx, Side::Below, 30.0);
        let found = chi_square(&one, Side::Below, a, |to: Side, b: Beta| {
            let OnSide { side, beta } = to.at(b);
            papilio_optics::Scatterer::evaluate(&ggx, Side::Below.at(a), side.at(beta))
        });
        assert!(found.is_likely(), "{alpha}: {found:?}");
    }
}

/// The difference from Gaussian slopes falls as 1/gamma.
#[test]
fn large_tail_is_beckmann() {
    let gaussian = Rough::with(Distribution::Beckmann, 0.4, 1.0, 1.5);
    let apart =
        |tail: f64| difference(&Rough::with(Distribution::StudentT { tail }, 0.4, 1.0, 1.5), &gaussian);
    let [near, nearer] = [apart(250.0), apart(1000.0)];
    assert!(nearer < 2e-3, "{nearer}");
    assert!((near / nearer / 4.0 - 1.0).abs() < 0.02, "{near} {nearer}");
}

/// Light along the normal through a face of small slopes: the fraction beyond an angle is that of the steeper
/// slopes.
#[test]
fn transmitted_light_beyond_an_angle_is_that_of_steep_slopes() {
    let numbers = SampleStream::new(Sampler::Sobol, 11, 0);
    for (distribution, alpha) in [
        (Distribution::StudentT { tail: 2.5 }, 0.01),
        (Distribution::StudentT { tail: 5.0 }, 0.03),
        (Distribution::Ggx, 0.01),
        (Distribution::Beckmann, 0.05),
    ] {
        let face = Rough::with(distribution, alpha, 1.0, 1.5);
        let limit = f64::to_radians(2.5).sin();
        let (mut through, mut beyond) = (0.0, 0.0);
        for path in 0..1 << 15 {
            let sides = face.sample_sides(Side::Above.at(Beta::default()), numbers.block(path, 0));
            let (to, probability) = sides[1];
            let Some(to) = to else { continue };
            through += probability;
            beyond += if to.beta.length() > limit { probability } else { 0.0 };
        }
        let (found, expected) = (beyond / through, distribution.steeper(alpha, limit / 0.5));
        assert!((found - expected).abs() < 0.02 * expected + 4e-4, "{distribution:?}: {found} {expected}");
    }
}

//! Listed pairs of directions in any order: analytic samples come back between the pairs, and the stated errors are the true ones.

use std::f64::consts::PI;

use papilio_goniometry::{
    Audit, Channel, Direction, Geometry, MeasuredPart, PairInterpolation, Preparation, ScatterMode, kernel,
};
use papilio_optics::Scatterer;

/// Number `k` of the van der Corput sequence of this base, 0 to 1.
fn corput(mut k: usize, base: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0);
    while k > 0 {
        digit /= base as f64;
        value += digit * (k % base) as f64;
        k /= base;
    }
    value
}

/// Pairs of directions spread over the hemispheres up to these inclinations (Halton's sequence).
fn spread(count: usize, first: usize, [light_deg, viewer_deg]: [f64; 2]) -> Vec<[Direction; 2]> {
    let inclined = |u: f64, most: f64| (u.sqrt() * most.to_radians().sin()).asin().to_degrees();
    let pair = |k: usize| {
        let light = Direction::new(inclined(corput(k, 2), light_deg), 360.0 * corput(k, 3));
        [light, Direction::new(inclined(corput(k, 5), viewer_deg), 360.0 * corput(k, 7))]
    };
    (first..first + count).map(pair).collect()
}

type Sample = fn(Direction, Direction) -> f64;

fn squared_distance(i: Direction, o: Direction) -> f64 {
    (o.leaving() - i.arriving()).squared()
}

fn cosines(i: Direction, o: Direction) -> f64 {
    let cos = |d: Direction| d.theta_deg.to_radians().cos();
    0.4 * (cos(i) * cos(o)).powi(2)
}

fn gaussian(i: Direction, o: Direction) -> f64 {
    2.0 * (-squared_distance(i, o) / 0.09).exp()
}

fn k_correlation(i: Direction, o: Direction) -> f64 {
    0.1 / (2.0 * PI * (0.01 + squared_distance(i, o)).powf(1.5))
}

fn values(pairs: &[[Direction; 2]], sample: Sample) -> Vec<f64> {
    pairs.iter().map(|[i, o]| sample(*i, *o)).collect()
}

/// Relative root mean square difference from the sample at other pairs.
fn difference(interpolation: &PairInterpolation, sample: Sample, others: &[[Direction; 2]]) -> f64 {
    let known = others.iter().filter_map(|[i, o]| Some(interpolation.value(*i, *o)? / sample(*i, *o) - 1.0));
    let differences: Vec<f64> = known.collect();
    assert!(differences.len() > others.len() * 9 / 10, "{} of {}", differences.len(), others.len());
    (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt()
}

#[test]
fn constant_is_constant_between_pairs_and_unknown_beyond_them() {
    let pairs = spread(400, 20, [60.0, 80.0]);
    let constant = PairInterpolation::new(&pairs, &[0.3; 400]).unwrap();
    for [i, o] in spread(300, 5000, [58.0, 78.0]) {
        assert!((constant.value(i, o).unwrap() - 0.3).abs() < 1e-12, "{i:?} {o:?}");
    }
    assert_eq!(constant.value(Direction::new(70.0, 0.0), Direction::new(10.0, 180.0)), None);
    assert_eq!(constant.value(Direction::new(10.0, 0.0), Direction::new(85.0, 180.0)), None);
    assert!(PairInterpolation::new(&pairs[..11], &[0.3; 11]).is_none());
}

/// The error that the pairs state of themselves is that at other pairs, within a factor of 2.5.
#[test]
fn samples_come_back_within_the_stated_error() {
    for (name, sample, most) in [
        ("cosines", cosines as Sample, 0.03),
        ("Gaussian", gaussian, 0.01),
        ("k-correlation", k_correlation, 0.01),
    ] {
        let pairs = spread(1000, 20, [75.0, 75.0]);
        let interpolation = PairInterpolation::new(&pairs, &values(&pairs, sample)).unwrap();
        let stated = interpolation.errors().one_left_out.rms;
        let found = difference(&interpolation, sample, &spread(500, 5000, [70.0, 70.0]));
        assert!(found < most && found < 2.5 * stated + 1e-4, "{name}: {found} {stated}");
    }
}

/// The values of the list itself are not changed.
#[test]
fn listed_pairs_keep_their_values() {
    let pairs = spread(300, 20, [75.0, 75.0]);
    let interpolation = PairInterpolation::new(&pairs, &values(&pairs, k_correlation)).unwrap();
    for [i, o] in &pairs {
        let ratio = interpolation.value(*i, *o).unwrap() / k_correlation(*i, *o);
        assert!((ratio - 1.0).abs() < 1e-9, "{i:?} {o:?}: {ratio}");
    }
}

/// Noise of 3 % is found, by pairs that are mirror images and by pairs that are left out; without it, neither finds it.
#[test]
fn noise_is_part_of_the_stated_error() {
    let one_side = spread(500, 20, [70.0, 70.0]);
    let mirrored =
        one_side.iter().map(|[i, o]| [*i, Direction::new(o.theta_deg, 2.0 * i.phi_deg - o.phi_deg)]);
    let pairs: Vec<[Direction; 2]> = one_side.iter().copied().chain(mirrored).collect();
    let noisy = |size: f64| -> Vec<f64> {
        let mut state = 20_261_127_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1.0 + size * 12.0_f64.sqrt() * ((state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5)
        };
        pairs.iter().map(|[i, o]| cosines(*i, *o).max(0.05) * noise()).collect()
    };
    let of = |size: f64| PairInterpolation::new(&pairs, &noisy(size)).unwrap();
    let (clean, noise) = (of(0.0), of(0.03));
    assert_eq!(noise.points(), 500);
    assert!(clean.asymmetry() < 1e-12, "{}", clean.asymmetry());
    // The mean of two values misses each by the root of one half of the noise.
    assert!((noise.asymmetry() / (0.03 * 0.5_f64.sqrt()) - 1.0).abs() < 0.1, "{}", noise.asymmetry());
    let [without, with] = [&clean, &noise].map(|one| one.errors().one_left_out.rms);
    assert!(with > without + 0.005, "{with} {without}");
}

/// Few incidences with many directions: neighbours of both sides take part, and the error between incidences is stated.
#[test]
fn lists_by_incidence_are_interpolated_between_incidences() {
    let incidences = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0];
    let light = |k: usize| Direction::new(incidences[k / 400], 40.0);
    let of_incidence = spread(2400, 20, [80.0, 80.0]).into_iter().enumerate();
    let pairs: Vec<[Direction; 2]> = of_incidence.map(|(k, [_, o])| [light(k), o]).collect();
    let interpolation = PairInterpolation::new(&pairs, &values(&pairs, k_correlation)).unwrap();
    assert_eq!(interpolation.incidences_deg().unwrap(), incidences);
    let between: Vec<[Direction; 2]> =
        spread(400, 9000, [50.0, 75.0]).into_iter().map(|[_, o]| [Direction::new(37.0, 0.0), o]).collect();
    let found = difference(&interpolation, k_correlation, &between);
    let stated = interpolation.errors().incidence_left_out.unwrap();
    assert!(found < 0.03 && found < stated.rms, "{found} {stated:?}");
}

fn part(pairs: Vec<[Direction; 2]>, values: Vec<f64>) -> MeasuredPart {
    MeasuredPart {
        way: ScatterMode::FrontReflection,
        channels: vec![Channel::Monochrome],
        geometry: Geometry::Pairs(pairs),
        values,
        tis: Vec::new(),
    }
}

/// The kernel of a display from a list: a constant to 1e-4, as albedos are interpolated, extended to the horizon, and a Gaussian lobe along the normal, whose
/// total is 2 pi 0.09 (1 - exp(-1/0.09)).
#[test]
fn kernels_of_lists_have_the_totals_of_the_samples() {
    let hold = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
    let pairs = spread(600, 20, [70.0, 75.0]);
    let (constant, changes) = kernel(&part(pairs.clone(), vec![0.3; 600]), 0, &hold, &[]).unwrap();
    for beta in [0.0, 0.4, 0.8, 0.99] {
        let total = constant.albedo_at(beta);
        assert!((total / (0.3 * PI) - 1.0).abs() < 1e-4, "{beta}: {total}");
    }
    assert!(changes.pairs.is_some_and(|errors| errors.one_left_out.rms < 1e-12));
    let lobe = values(&pairs, gaussian);
    let (scatter, _) = kernel(&part(pairs, lobe), 0, &hold, &[]).unwrap();
    let (total, expected) = (scatter.albedo_at(0.0), 2.0 * PI * 0.09 * (1.0 - (-1.0_f64 / 0.09).exp()));
    assert!((total / expected - 1.0).abs() < 0.01, "{total} {expected}");
    let (at, of) = (Direction::new(20.0, 180.0), Direction::new(35.0, 10.0));
    let [found, truth] = [scatter.evaluate(at.arriving(), of.leaving()), gaussian(at, of)];
    assert!((found / truth - 1.0).abs() < 0.03, "{found} {truth}");
}

/// A list of a single incidence, as of a sphere of d/8 geometry: its lobe holds for smaller incidences, too, at which nothing is known.
#[test]
fn lists_begin_at_their_first_incidence() {
    let hold = Preparation { extrapolate: Some(1.0), ..Preparation::default() };
    let viewers = (0..16).flat_map(|k| {
        (0..12).map(move |turn| Direction::new(5.0 * f64::from(k) + 2.0, 30.0 * f64::from(turn)))
    });
    let pairs: Vec<[Direction; 2]> = viewers.map(|to| [Direction::new(8.0, 0.0), to]).collect();
    let one = part(pairs.clone(), vec![0.3; pairs.len()]);
    let (constant, _) = kernel(&one, 0, &hold, &[]).unwrap();
    for theta_deg in [0.0_f64, 3.0, 8.0] {
        let total = constant.albedo_at(theta_deg.to_radians().sin());
        assert!((total / (0.3 * PI) - 1.0).abs() < 1e-3, "{theta_deg}: {total}");
    }
    assert!(Audit::of(&one, 0).unwrap().incidences.iter().all(|incidence| incidence.integral > 0.0));
}

/// Reciprocity is that of pairs that were listed in both directions: a sample is not blamed for what was not measured, and one
/// that is not reciprocal is found.
#[test]
fn reciprocity_of_lists_is_that_of_listed_opposites() {
    let audit = |pairs: &[[Direction; 2]], sample: Sample| {
        Audit::of(&part(pairs.to_vec(), values(pairs, sample)), 0).unwrap().reciprocity
    };
    let one_way = spread(200, 20, [70.0, 80.0]);
    assert_eq!(audit(&one_way, |_, _| 0.3), None);
    let both: Vec<[Direction; 2]> = one_way.iter().flat_map(|[i, o]| [[*i, *o], [*o, *i]]).collect();
    assert_eq!(audit(&both, |_, _| 0.3), Some([0.0, 0.0]));
    assert!(audit(&both, gaussian).unwrap()[1] < 1e-12);
    // (1 + 0.2 a) and (1 + 0.2 b) differ by 0.2 (a - b) over their mean, at most by 0.2/1.1.
    let [rms, worst] = audit(&both, |_, o| 0.3 * (1.0 + 0.2 * o.theta_deg.to_radians().cos())).unwrap();
    assert!(rms > 0.03 && worst > 0.08 && worst < 0.2, "{rms} {worst}");
}

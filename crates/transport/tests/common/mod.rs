//! Small stacks, and statistics over many seeds.

#![allow(dead_code, reason = "each file of tests uses its part")]

use papilio_sampling::{Numbers, Sampler};
use papilio_spectra::Spectrum;
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Cone, Estimate, Front, Medium, Nodes, Panel, Reflector, Source, Stack, Top,
};

pub(crate) const REPLICATES: u64 = 32;

/// One wavelength, one state.
pub(crate) fn one(value: f64) -> Spectrum {
    vec![value].into()
}

pub(crate) fn mirror(reflectance: f64) -> Base {
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![reflectance].into(),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
}

pub(crate) fn lambertian(reflectance: f64) -> Base {
    Base { reflector: Reflector::Lambertian(vec![reflectance]), inactive_absorptance: one(0.0) }
}

/// A panel in glass of index 1.5 without front.
pub(crate) fn panel(top: Top, base: Base) -> Panel {
    Panel { front: Front::none(1), top, medium: Medium::new(one(1.5)), base, single_pass: false }
}

/// Front of screen from components (R, A).
pub(crate) fn front(components: &[(f64, f64)], first_order: bool) -> Front {
    let components = components.iter().map(|(r, a)| (std::slice::from_ref(r), std::slice::from_ref(a)));
    if first_order { Front::first_order(1, components) } else { Front::exact(1, components) }
}

pub(crate) fn view(theta_deg: f64) -> Cone {
    Cone::new(theta_deg, 0.0, 0.0, 1.0)
}

/// The estimates of 32 replicates.
pub(crate) fn replicates(
    stack: &Panel,
    view: Cone,
    sources: &[Source],
    seed: u64,
    paths: u64,
    sampler: Sampler,
) -> Vec<Estimate> {
    replicates_of(&Stack::Panel(stack.clone()), view, sources, seed, paths, sampler)
}

/// The same for a display in either form.
pub(crate) fn replicates_of(
    stack: &Stack,
    view: Cone,
    sources: &[Source],
    seed: u64,
    paths: u64,
    sampler: Sampler,
) -> Vec<Estimate> {
    let walk = Walk::new(stack, view, sources);
    (0..REPLICATES)
        .map(|stream| {
            let mut replicate = walk.replicate();
            walk.trace(&mut replicate, &Numbers::new(sampler, seed, stream), paths);
            walk.estimate(&replicate)
        })
        .collect()
}

/// Mean and standard error of a quantity over replicates.
pub(crate) fn mean_and_error(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Total reflectance factor of the first wavelength and state under source `i`.
pub(crate) fn rho(estimate: &Estimate, i: usize) -> f64 {
    estimate.rho[i].via_pixel[0] + estimate.rho[i].front[0]
}

/// How many seeds the statistics run over: 48, or as `PAPILIO_SEEDS` says.
#[allow(clippy::expect_used, reason = "a test says what it expects")]
fn seeds() -> u64 {
    std::env::var("PAPILIO_SEEDS").map_or(48, |more| more.parse().expect("PAPILIO_SEEDS is a whole number"))
}

/// Over many seeds, the estimates of a quantity must scatter around the truth as their
/// standard errors say. Two statistics, both tested at 4.5 sigma (7e-6 two-sided; Sidak
/// over 40 cases: 3e-4): the mean of all seeds, and the mean square of the deviations over
/// the mean square of the errors, whose expectation is 1. The errors are pooled over the
/// seeds, since z-scores of each seed would lean to one side where replicates are skewed
/// (Student's t of n of them has mean -skewness/(2 sqrt(n))). Each seed's error must be small
/// enough for the test to mean something.
pub(crate) fn assert_unbiased(
    what: &str,
    truth: f64,
    most_relative_error: f64,
    run: impl Fn(u64) -> (f64, f64),
) {
    let seeds = seeds();
    let (mut deviation, mut square, mut error_square) = (0.0, 0.0, 0.0);
    for seed in 0..seeds {
        let (mean, error) = run(seed);
        assert!(error <= most_relative_error * truth.abs().max(1e-12), "{what}: error {error} of {mean}");
        deviation += mean - truth;
        square += (mean - truth).powi(2);
        error_square += error * error;
    }
    let n = seeds as f64;
    let (deviation, one_error) = (deviation / n, (error_square / n).sqrt());
    if one_error <= 1e-12 * truth.abs().max(1e-12) {
        assert!(deviation.abs() <= 1e-11 * truth.abs().max(1e-3), "{what}: off by {deviation}, no spread");
        return;
    }
    let z = deviation * n.sqrt() / one_error;
    assert!(z.abs() < 4.5, "{what}: mean z {z} over {n} seeds, off by {deviation} from {truth}");
    let ratio = square / error_square;
    // Variance of a squared deviation: 2, and 2/31 for what 32 replicates know of the error,
    // with room for replicates that are no normal variables.
    assert!((ratio - 1.0).abs() < 4.5 * (2.55 / n).sqrt(), "{what}: mean square of z {ratio}");
}

//! Estimates over many seeds against a truth.

use crate::scores::{SIGMA, mean_square_bounds};

/// Seeds of every day.
const EVERYDAY: u64 = 16;

/// How many seeds the statistics run over: 16, or as `PAPILIO_SEEDS` says.
///
/// # Panics
/// If that is no whole number.
#[allow(clippy::expect_used, reason = "a test says what it expects")]
pub fn seeds() -> u64 {
    std::env::var("PAPILIO_SEEDS")
        .map_or(EVERYDAY, |more| more.parse().expect("PAPILIO_SEEDS is a whole number"))
}

/// Over many seeds, the estimates of a quantity must scatter around the truth as their standard errors (of 32 replicates each)
/// say. Two statistics, both tested at 4.5 standard deviations (7e-6 two-sided; Sidak over 40 cases: 3e-4): the mean of all seeds, and
/// the mean square of the deviations over the mean square of the errors, whose expectation is 1. The errors are pooled over
/// the seeds, since z-scores of each seed would lean to one side where replicates are skewed (Student's t of n of them has
/// mean -skewness/(2 sqrt(n))). Each seed's error must be small enough for the test to mean something.
///
/// # Panics
/// If they do not.
pub fn assert_unbiased(what: &str, truth: f64, most_relative_error: f64, run: impl Fn(u64) -> (f64, f64)) {
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
    assert!(z.abs() < SIGMA, "{what}: mean z {z} over {n} seeds, off by {deviation} from {truth}");
    let ratio = square / error_square;
    // Variance of a squared deviation: 2, and 2/31 for what 32 replicates know of the error,
    // with room for replicates that are no normal variables.
    let bounds = mean_square_bounds(1.0, 2.55, n);
    assert!(bounds.contains(&ratio), "{what}: mean square of z {ratio}, not in {bounds:?}");
}

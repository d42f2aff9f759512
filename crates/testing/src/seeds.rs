//! Tests of estimates over many seeds.

use crate::scores::{SIGMA, mean_square_bounds};

/// Default number of seeds.
const EVERYDAY: u64 = 8;

/// Returns the number of seeds of statistical tests: 8, or the value of `PAPILIO_SEEDS`.
///
/// # Panics
/// If `PAPILIO_SEEDS` is not an integer.
#[allow(clippy::expect_used, reason = "a test says what it expects")]
pub fn seeds() -> u64 {
    std::env::var("PAPILIO_SEEDS")
        .map_or(EVERYDAY, |more| more.parse().expect("PAPILIO_SEEDS must be an integer"))
}

/// True in `cargo xtask full`, which sets `PAPILIO_SEEDS`.
fn is_full() -> bool {
    std::env::var_os("PAPILIO_SEEDS").is_some()
}

/// Returns the first `count` of these cases, or all of them in `cargo xtask full`: for cases that take
/// seconds each. Those that have most in common with the others come last.
pub fn everyday<T>(count: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    cases.into_iter().take(if is_full() { usize::MAX } else { count })
}

/// Returns `everyday`, or `full` in `cargo xtask full`: the number of samples, the resolution or the bound of
/// a test that takes long. With the everyday value, too, the test must reject a wrong program.
pub fn sized<T>(everyday: T, full: T) -> T {
    if is_full() { full } else { everyday }
}

/// Tests over many seeds that the estimates of a quantity scatter around the true value in accordance with
/// their standard errors (of 32 replicates each). Two statistics are tested at 4.5 standard deviations (7e-6
/// two-sided; Sidak over 40 cases: 3e-4): the mean of all seeds, and the mean square of the deviations over
/// the mean square of the errors, with expectation 1. The errors are pooled over the seeds, because the
/// z-scores of single seeds are biased where replicates are skewed (Student's t of n of them has mean
/// -skewness/(2 sqrt(n))). Each seed's relative error must be at most `most_relative_error`, so that the test
/// is significant.
///
/// # Panics
/// If a statistic is outside its bounds, or an error is too large.
/// If they do not.
pub fn assert_unbiased(what: &str, truth: f64, most_relative_error: f64, run: impl Fn(u64) -> (f64, f64)) {
    assert_unbiased_over(seeds(), what, truth, most_relative_error, run);
}

/// [`assert_unbiased`] over at least this number of seeds: where rare paths carry most of the light, few
/// seeds do not find them, and their mean and errors are both too small.
///
/// # Panics
/// As [`assert_unbiased`].
pub fn assert_unbiased_over(
    least: u64,
    what: &str,
    truth: f64,
    most_relative_error: f64,
    run: impl Fn(u64) -> (f64, f64),
) {
    let seeds = seeds().max(least);
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
        assert!(
            deviation.abs() <= 1e-11 * truth.abs().max(1e-3),
            "{what}: deviation {deviation} with zero standard error"
        );
        return;
    }
    let z = deviation * n.sqrt() / one_error;
    assert!(z.abs() < SIGMA, "{what}: mean z {z} over {n} seeds, deviation {deviation} from {truth}");
    let ratio = square / error_square;
    // Variance of a squared deviation: 2, plus 2/31 for the uncertainty of the error of 32 replicates,
    // with a margin for replicates that are not normally distributed.
    let bounds = mean_square_bounds(1.0, 2.55, n);
    assert!(bounds.contains(&ratio), "{what}: mean square of z {ratio}, not in {bounds:?}");
}

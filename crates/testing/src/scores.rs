//! Deviations in units of their standard errors.

/// Mean and standard error of a quantity over replicates.
pub fn mean_and_error(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.into_iter().collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Number of replicates of every standard error in the tests.
const REPLICATES: f64 = 32.0;

/// Bound of deviations, in standard deviations: probability 7e-6, two-sided.
pub(crate) const SIGMA: f64 = 4.5;

/// Acceptance interval of a statistic.
pub type Bounds = std::ops::RangeInclusive<f64>;

/// Bounds, at 4.5 standard deviations, of the mean of `n` squares with known mean and variance. They are
/// those of a chi-square variable of the same relative variance (Wilson and Hilferty), which has the skewness
/// of such means. The lower bound of a normal variable would be negative for n < 50, and would exclude
/// nothing.
pub fn mean_square_bounds(mean: f64, variance: f64, n: f64) -> Bounds {
    let freedom = 2.0 * mean * mean * n / variance;
    let spread = 2.0 / (9.0 * freedom);
    let at = |sigma: f64| mean * (1.0 - spread + sigma * spread.sqrt()).max(0.0).powi(3);
    at(-SIGMA)..=at(SIGMA)
}

/// Tests scores against Student's t of 31 degrees of freedom, the distribution of deviations over the
/// standard errors of 32 replicates: mean 0 and mean square 31/29. `independent` is the number of independent
/// scores.
///
/// # Panics
/// If either is outside its bounds.
pub fn assert_student(what: &str, scores: &[f64], independent: f64) {
    let n = scores.len() as f64;
    let (mean, square) = (scores.iter().sum::<f64>() / n, scores.iter().map(|z| z * z).sum::<f64>() / n);
    let freedom = REPLICATES - 1.0;
    let variance = freedom / (freedom - 2.0);
    let fourth = 3.0 * freedom * freedom / ((freedom - 2.0) * (freedom - 4.0));
    assert!(mean.abs() < SIGMA * (variance / independent).sqrt(), "{what}: mean z {mean} of {n}");
    let bounds = mean_square_bounds(variance, fourth - variance * variance, independent);
    assert!(bounds.contains(&square), "{what}: mean square of z {square} of {n}, not in {bounds:?}");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of chi-square at 4.5 standard deviations of a normal variable (3.4e-6 on each side), from
    /// the inverse of the incomplete gamma function.
    #[test]
    fn mean_square_bounds_equal_chi_square_quantiles() {
        for (freedom, low, high) in [(16.0, 1.7151, 55.1204), (48.0, 15.9108, 105.4767)] {
            let bounds = mean_square_bounds(1.0, 2.0, freedom);
            assert!((bounds.start() * freedom - low).abs() < 0.25, "{bounds:?}");
            assert!((bounds.end() * freedom / high - 1.0).abs() < 0.02, "{bounds:?}");
        }
    }
}

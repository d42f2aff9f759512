//! Deviations in units of their standard errors.

/// Mean and standard error of a quantity over replicates.
pub fn mean_and_error(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let values: Vec<f64> = values.into_iter().collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// The replicates of which every standard error of the tests is made.
const REPLICATES: f64 = 32.0;

/// Standard deviations that nothing correct is off by: 7e-6, two-sided.
pub(crate) const SIGMA: f64 = 4.5;

/// What a statistic may be.
pub type Bounds = std::ops::RangeInclusive<f64>;

/// Where the mean of `n` squares lies whose own mean and variance are known, at 4.5 standard deviations: as that of a
/// chi-square variable of the same relative variance (Wilson and Hilferty), which is skewed as such means are. A normal
/// variable's bounds would be below zero for n < 50, and would hold nothing there.
pub fn mean_square_bounds(mean: f64, variance: f64, n: f64) -> Bounds {
    let freedom = 2.0 * mean * mean * n / variance;
    let spread = 2.0 / (9.0 * freedom);
    let at = |sigma: f64| mean * (1.0 - spread + sigma * spread.sqrt()).max(0.0).powi(3);
    at(-SIGMA)..=at(SIGMA)
}

/// Holds scores to Student's t of 31 degrees of freedom, which deviations over the standard errors of 32 replicates follow:
/// mean 0 and mean square 31/29, of as many independent scores as is said.
///
/// # Panics
/// If they are not.
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

    /// Quantiles of chi-square at 4.5 standard deviations of a normal variable (3.4e-6 on each side), by inverting the incomplete
    /// gamma function.
    #[test]
    fn bounds_are_those_of_chi_square() {
        for (freedom, low, high) in [(16.0, 1.7151, 55.1204), (48.0, 15.9108, 105.4767)] {
            let bounds = mean_square_bounds(1.0, 2.0, freedom);
            assert!((bounds.start() * freedom - low).abs() < 0.25, "{bounds:?}");
            assert!((bounds.end() * freedom / high - 1.0).abs() < 0.02, "{bounds:?}");
        }
    }
}

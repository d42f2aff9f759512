//! Probability distributions by their quantile functions.
//!
//! A quantile function converts a uniform number in (0, 1) to a number of the distribution. Low-discrepancy
//! points stay low-discrepancy points: errors of means decrease faster than those of random numbers.
//!
//! | distribution | parameters | range |
//! |---|---|---|
//! | normal | mean, standard deviation `sigma`; may be truncated at both ends | all, or within |
//! | log-normal | `median`, standard deviation `sigma` of the logarithm; may be truncated | above 0, or within |
//! | uniform | `from`, `to` | both ends |
//! | triangular | `from`, `mode` (the most probable value), `to` | both ends |
//! | choices | a weight for each item of a list | 0, 1, ... |
//!
//! A truncated distribution keeps its shape between the ends: values outside are discarded, not moved to the
//! ends.

use std::f64::consts::SQRT_2;

use crate::{erfc, erfc_inv};

/// Probability distribution of a number.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// Normal distribution, possibly truncated.
    Normal {
        /// Mean before truncation.
        mean: f64,
        /// Standard deviation before truncation, above 0.
        sigma: f64,
        /// Lower and upper end; infinite without truncation.
        within: [f64; 2],
    },
    /// Log-normal distribution, possibly truncated.
    LogNormal {
        /// Median before truncation, above 0.
        median: f64,
        /// Standard deviation of the natural logarithm, above 0.
        sigma: f64,
        /// Lower and upper end; 0 and infinity without truncation.
        within: [f64; 2],
    },
    /// Uniform between two ends.
    Uniform {
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// Density that rises linearly to the mode and falls linearly.
    Triangular {
        /// Lower end.
        from: f64,
        /// Most probable value.
        mode: f64,
        /// Upper end.
        to: f64,
    },
    /// One of several items, given by its zero-based index.
    Choices {
        /// Relative probabilities: 0 or more, not all 0.
        weights: Vec<f64>,
    },
}

impl Distribution {
    /// Quantile: the number below which the fraction `u` of the distribution lies, 0 < u < 1; of choices, the
    /// index.
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Normal { mean, sigma, within } => {
                let ends = within.map(|end| (end - mean) / sigma);
                (mean + sigma * truncated_normal_quantile(u, ends)).clamp(within[0], within[1])
            }
            Self::LogNormal { median, sigma, within } => {
                let ends = within.map(|end| (end.max(0.0) / median).ln() / sigma);
                (median * (sigma * truncated_normal_quantile(u, ends)).exp()).clamp(within[0], within[1])
            }
            Self::Uniform { from, to } => from + u * (to - from),
            Self::Triangular { from, mode, to } => {
                let (rise, fall, width) = (mode - from, to - mode, to - from);
                if u * width < rise {
                    from + (u * width * rise).sqrt()
                } else {
                    to - ((1.0 - u) * width * fall).sqrt()
                }
            }
            Self::Choices { ref weights } => {
                let mut rest = u * weights.iter().sum::<f64>();
                let mut chosen = 0;
                for (i, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                    chosen = i;
                    rest -= weight;
                    if rest < 0.0 {
                        break;
                    }
                }
                chosen as f64
            }
        }
    }
}

/// Quantile of the standard normal distribution truncated to `[low, high]`.
fn truncated_normal_quantile(u: f64, [low, high]: [f64; 2]) -> f64 {
    // Computed from the nearer end: probabilities near 1 have lost significant digits.
    if low > 0.0 {
        return -truncated_normal_quantile(1.0 - u, [-high, -low]);
    }
    let (below, above) = (normal_cdf(low), normal_cdf(high));
    normal_quantile(below + u * (above - below))
}

/// Cumulative distribution function of the standard normal distribution.
pub(crate) fn normal_cdf(z: f64) -> f64 {
    0.5 * erfc(-z / SQRT_2)
}

/// Quantile function of the standard normal distribution.
pub(crate) fn normal_quantile(u: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNBOUNDED: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn standard(within: [f64; 2]) -> Distribution {
        Distribution::Normal { mean: 0.0, sigma: 1.0, within }
    }

    /// Abramowitz and Stegun, table 26.5; the tail by Wichura's AS 241, as printed by R.
    #[test]
    fn normal_quantiles_equal_published_values() {
        for (u, z) in [
            (0.5, 0.0),
            (0.975, 1.959963984540054),
            (0.001, -3.090232306167813),
            (1e-10, -6.361340902404056),
            (0.3, -0.5244005127080407),
        ] {
            assert!((standard(UNBOUNDED).quantile(u) - z).abs() < 1e-11, "{u}");
        }
    }

    /// Mean and variance of the quantiles at equidistant probabilities equal those of the distribution.
    #[test]
    fn quantile_moments_equal_closed_forms() {
        let (from, mode, to) = (1.0, 2.0, 5.0);
        let triangle = Distribution::Triangular { from, mode, to };
        let of_triangle = (from * from + mode * mode + to * to - from * mode - from * to - mode * to) / 18.0;
        // A normal distribution truncated at one and two standard deviations.
        let cut = standard([-1.0, 2.0]);
        let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let fraction = normal_cdf(2.0) - normal_cdf(-1.0);
        let mean = (density(-1.0) - density(2.0)) / fraction;
        let variance = 1.0 + (-density(-1.0) - 2.0 * density(2.0)) / fraction - mean * mean;
        let log = Distribution::LogNormal { median: 2.0, sigma: 0.25, within: [0.0, f64::INFINITY] };
        let of_log = 4.0 * (0.0625_f64.exp() - 1.0) * 0.0625_f64.exp();
        let weights = Distribution::Choices { weights: vec![1.0, 0.0, 3.0] };
        let shifted = Distribution::Normal { mean: 3.0, sigma: 0.2, within: UNBOUNDED };
        for (distribution, mean, variance) in [
            (shifted, 3.0, 0.04),
            (cut, mean, variance),
            (log, 2.0 * 0.03125_f64.exp(), of_log),
            (Distribution::Uniform { from: -1.0, to: 3.0 }, 1.0, 16.0 / 12.0),
            (triangle, (from + mode + to) / 3.0, of_triangle),
            (weights, 1.5, 0.75),
        ] {
            let count = 200_000;
            let values: Vec<f64> =
                (0..count).map(|i| distribution.quantile((f64::from(i) + 0.5) / f64::from(count))).collect();
            let found = values.iter().sum::<f64>() / f64::from(count);
            let spread = values.iter().map(|v| (v - found).powi(2)).sum::<f64>() / f64::from(count);
            assert!((found - mean).abs() < 2e-5 * (1.0 + mean.abs()), "{distribution:?} {found} {mean}");
            assert!((spread - variance).abs() < 5e-4 * variance, "{distribution:?} {spread} {variance}");
        }
    }

    /// Far out in either tail, quantiles stay within the ends and keep their digits: mirrored ends give
    /// mirrored numbers.
    #[test]
    fn quantiles_of_opposite_tails_are_mirrored() {
        let (low, high) = (standard([-9.0, -8.0]), standard([8.0, 9.0]));
        for i in 1..100 {
            let u = f64::from(i) / 100.0;
            let (left, right) = (low.quantile(u), high.quantile(1.0 - u));
            assert!((-9.0..=-8.0).contains(&left) && (left + right).abs() < 1e-9, "{left} {right}");
        }
    }

    #[test]
    fn choices_follow_their_weights() {
        let weights = Distribution::Choices { weights: vec![0.0, 1.0, 2.0, 1.0, 0.0] };
        let chosen = [1e-9, 0.2499, 0.2501, 0.7499, 0.7501, 1.0 - 1e-9].map(|u| weights.quantile(u));
        assert_eq!(chosen, [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    }
}

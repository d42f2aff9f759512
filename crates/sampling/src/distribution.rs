//! Numbers as production scatters them, by their quantile functions.
//!
//! A quantile function turns an even number in (0, 1) into one of the distribution, and even sets of points
//! into sets that are as even: errors of averages fall faster than those of random numbers.
//!
//! | distribution | parameters | range |
//! |---|---|---|
//! | normal | mean, standard deviation `sigma`; may be cut off at both ends | all, or within |
//! | log-normal | `median`, standard deviation `sigma` of the logarithm; may be cut off | above 0, or within |
//! | uniform | `from`, `to` | both ends |
//! | triangular | `from`, `mode` (the likeliest), `to` | both ends |
//! | choices | a weight for each of a list | 0, 1, ... |
//!
//! A distribution that is cut off keeps its shape between the ends: what lies beyond is sorted out, not moved.

use std::f64::consts::SQRT_2;

use crate::{erfc, erfc_inv};

/// How a number scatters.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// Bell-shaped.
    Normal {
        /// Mean of the whole, before it is cut off.
        mean: f64,
        /// Standard deviation of the whole, above 0.
        sigma: f64,
        /// Nothing lies beyond; infinite where it is not cut off.
        within: [f64; 2],
    },
    /// Its logarithm is normal.
    LogNormal {
        /// Half of the whole lies below; above 0.
        median: f64,
        /// Standard deviation of the natural logarithm, above 0.
        sigma: f64,
        /// Nothing lies beyond; 0 and infinity where it is not cut off.
        within: [f64; 2],
    },
    /// Alike between two ends.
    Uniform {
        /// The least.
        from: f64,
        /// The largest.
        to: f64,
    },
    /// Rising to the likeliest, and falling.
    Triangular {
        /// The least.
        from: f64,
        /// The likeliest.
        mode: f64,
        /// The largest.
        to: f64,
    },
    /// One of several, called by its number from 0.
    Choices {
        /// How often each is met: 0 or more, and not all 0.
        weights: Vec<f64>,
    },
}

impl Distribution {
    /// The number that a share `u` of all lies below, 0 < u < 1; of choices the number of one.
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::Normal { mean, sigma, within } => {
                let ends = within.map(|end| (end - mean) / sigma);
                (mean + sigma * normal_within(u, ends)).clamp(within[0], within[1])
            }
            Self::LogNormal { median, sigma, within } => {
                let ends = within.map(|end| (end.max(0.0) / median).ln() / sigma);
                (median * (sigma * normal_within(u, ends)).exp()).clamp(within[0], within[1])
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

/// The standard normal number below which a share `u` of those between two ends lies.
fn normal_within(u: f64, [low, high]: [f64; 2]) -> f64 {
    // Counted from the end that is nearer: shares near 1 have lost the digits that matter.
    if low > 0.0 {
        return -normal_within(1.0 - u, [-high, -low]);
    }
    let (below, above) = (share_below(low), share_below(high));
    normal(below + u * (above - below))
}

/// The share of the standard normal distribution below `z`.
pub(crate) fn share_below(z: f64) -> f64 {
    0.5 * erfc(-z / SQRT_2)
}

/// The standard normal number that a share `u` lies below.
pub(crate) fn normal(u: f64) -> f64 {
    -SQRT_2 * erfc_inv(2.0 * u)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

    fn standard(within: [f64; 2]) -> Distribution {
        Distribution::Normal { mean: 0.0, sigma: 1.0, within }
    }

    /// Abramowitz and Stegun, table 26.5, and the tail by Wichura's AS 241, as R prints them.
    #[test]
    fn normal_quantiles_are_those_of_tables() {
        for (u, z) in [
            (0.5, 0.0),
            (0.975, 1.959963984540054),
            (0.001, -3.090232306167813),
            (1e-10, -6.361340902404056),
            (0.3, -0.5244005127080407),
        ] {
            assert!((standard(WHOLE).quantile(u) - z).abs() < 1e-11, "{u}");
        }
    }

    /// Whatever the distribution: the mean and the spread of the quantiles at even shares are its own.
    #[test]
    fn moments_are_those_of_closed_forms() {
        let (from, mode, to) = (1.0, 2.0, 5.0);
        let triangle = Distribution::Triangular { from, mode, to };
        let of_triangle = (from * from + mode * mode + to * to - from * mode - from * to - mode * to) / 18.0;
        // A normal distribution cut off at one and two standard deviations.
        let cut = standard([-1.0, 2.0]);
        let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        let share = share_below(2.0) - share_below(-1.0);
        let mean = (density(-1.0) - density(2.0)) / share;
        let variance = 1.0 + (-density(-1.0) - 2.0 * density(2.0)) / share - mean * mean;
        let log = Distribution::LogNormal { median: 2.0, sigma: 0.25, within: [0.0, f64::INFINITY] };
        let of_log = 4.0 * (0.0625_f64.exp() - 1.0) * 0.0625_f64.exp();
        let weights = Distribution::Choices { weights: vec![1.0, 0.0, 3.0] };
        let shifted = Distribution::Normal { mean: 3.0, sigma: 0.2, within: WHOLE };
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

    /// Far out in either tail, nothing leaves the ends and nothing is lost: mirrored ends give mirrored numbers.
    #[test]
    fn both_tails_are_alike() {
        let (low, high) = (standard([-9.0, -8.0]), standard([8.0, 9.0]));
        for i in 1..100 {
            let u = f64::from(i) / 100.0;
            let (left, right) = (low.quantile(u), high.quantile(1.0 - u));
            assert!((-9.0..=-8.0).contains(&left) && (left + right).abs() < 1e-9, "{left} {right}");
        }
    }

    #[test]
    fn choices_come_by_their_weights() {
        let weights = Distribution::Choices { weights: vec![0.0, 1.0, 2.0, 1.0, 0.0] };
        let chosen = [1e-9, 0.2499, 0.2501, 0.7499, 0.7501, 1.0 - 1e-9].map(|u| weights.quantile(u));
        assert_eq!(chosen, [1.0, 1.0, 2.0, 2.0, 3.0, 3.0]);
    }
}

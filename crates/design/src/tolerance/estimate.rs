//! Estimates with standard errors.

use schemars::JsonSchema;
use serde::Serialize;

use super::plan::REPLICATES;

/// Estimate from a sample, with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ToleranceEstimate")]
pub struct Estimate {
    /// Value.
    pub value: f64,
    /// Standard error, with fifteen degrees of freedom.
    pub standard_error: f64,
}

impl Estimate {
    /// Computes an estimate and its standard error by the jackknife over replicates.
    ///
    /// `estimate` returns the value from all replicates, or from all but the one that is given.
    ///
    /// Source: B. Efron and C. Stein, Ann. Statist. 9, 586 (1981), applied to groups.
    pub(super) fn jackknife(estimate: impl Fn(Option<usize>) -> f64) -> Self {
        let without = (0..REPLICATES).map(|left_out| estimate(Some(left_out)));
        Self { value: estimate(None), standard_error: jackknife_error(without) }
    }
}

/// Standard error by the jackknife, from the values without each of the replicates.
pub(super) fn jackknife_error(without: impl Iterator<Item = f64>) -> f64 {
    let without: Vec<f64> = without.collect();
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
    (squares * (count - 1.0) / count).sqrt()
}

/// Largest standard deviation, relative to the size of a metric or to 1, that rounding errors may cause.
const ROUNDING: f64 = 1e-10;

/// Returns whether a metric does not vary: rounding errors may cause its variance. Some, such as a* of a grey, are differences of
/// numbers of the order of 1, and 0 but for rounding.
pub(super) fn is_rounding(centre: f64, variance: f64) -> bool {
    variance <= (ROUNDING * centre.abs().max(1.0)).powi(2)
}

/// Sums over the rows of each replicate.
pub(super) struct Sums<const N: usize>([[f64; N]; REPLICATES]);

impl<const N: usize> Sums<N> {
    /// Sums terms, each given with its replicate.
    pub(super) fn of(terms: impl Iterator<Item = (usize, [f64; N])>) -> Self {
        let mut sums = [[0.0; N]; REPLICATES];
        for (replicate, terms) in terms {
            sums[replicate].iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        Self(sums)
    }

    /// Sums over all replicates, or over all but one.
    pub(super) fn without(&self, left_out: Option<usize>) -> [f64; N] {
        let included = self.0.iter().enumerate().filter(|(replicate, _)| Some(*replicate) != left_out);
        let mut all = [0.0; N];
        included.for_each(|(_, sums)| all.iter_mut().zip(sums).for_each(|(all, sum)| *all += sum));
        all
    }

    /// Fraction of the rows: the first sum over the last.
    pub(super) fn fraction(&self) -> Estimate {
        Estimate::jackknife(|left_out| {
            let sums = self.without(left_out);
            sums[0] / sums[N - 1]
        })
    }
}

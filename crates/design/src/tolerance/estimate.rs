//! Numbers with their standard errors.

use serde::Serialize;

use super::plan::REPLICATES;

/// A number found from a sample, and one sigma of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error, of fifteen degrees of freedom.
    pub standard_error: f64,
}

impl Estimate {
    /// The jackknife over replicates: `estimate` gives the number from all of them, or from all but one.
    ///
    /// Source: B. Efron and C. Stein, Ann. Statist. 9, 586 (1981), applied to groups.
    pub(super) fn jackknife(estimate: impl Fn(Option<usize>) -> f64) -> Self {
        let count = REPLICATES as f64;
        let without: Vec<f64> = (0..REPLICATES).map(|one| estimate(Some(one))).collect();
        let mean = without.iter().sum::<f64>() / count;
        let squares: f64 = without.iter().map(|value| (value - mean).powi(2)).sum();
        Self { value: estimate(None), standard_error: (squares * (count - 1.0) / count).sqrt() }
    }
}

/// Sums over the rows of each replicate, of all but one of them or of all.
pub(super) struct Sums<const N: usize>([[f64; N]; REPLICATES]);

impl<const N: usize> Sums<N> {
    /// Of these terms, each with the number of its replicate.
    pub(super) fn of(terms: impl Iterator<Item = (usize, [f64; N])>) -> Self {
        let mut sums = [[0.0; N]; REPLICATES];
        for (replicate, terms) in terms {
            sums[replicate].iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
        Self(sums)
    }

    /// Of all replicates but one.
    pub(super) fn without(&self, left_out: Option<usize>) -> [f64; N] {
        let kept = self.0.iter().enumerate().filter(|(replicate, _)| Some(*replicate) != left_out);
        let mut all = [0.0; N];
        kept.for_each(|(_, sums)| all.iter_mut().zip(sums).for_each(|(all, sum)| *all += sum));
        all
    }

    /// A share of the rows: the first sum over the second.
    pub(super) fn share(&self) -> Estimate {
        Estimate::jackknife(|left_out| {
            let sums = self.without(left_out);
            sums[0] / sums[N - 1]
        })
    }
}

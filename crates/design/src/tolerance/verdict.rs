//! Yield.

use schemars::JsonSchema;
use serde::Serialize;

use super::estimate::{Estimate, Sums};
use super::plan::{REPLICATES, replicate};

/// Limits of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Column of the metric.
    pub column: usize,
    /// Lower limit.
    pub at_least: Option<f64>,
    /// Upper limit.
    pub at_most: Option<f64>,
}

/// Yield, and how often each limit fails.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Verdict {
    /// Fraction of displays that meet all limits.
    pub yield_share: Estimate,
    /// Failures of each limit.
    pub failing: Vec<Failing>,
}

/// How often a limit fails.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Failing {
    /// Fraction of displays that do not meet the limit.
    pub share: Estimate,
    /// Fraction of displays that fail only this limit.
    pub alone: Estimate,
}

/// Display that does not meet its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss {
    /// Row of the display.
    pub row: usize,
    /// Limit that it misses most.
    pub limit: usize,
    /// Distance from this limit in standard deviations of the metric; infinite if the metric is undefined.
    pub by: f64,
}

impl Limit {
    /// Distance of a value beyond the limit: 0 or less if it is met, infinite if the value is undefined.
    fn missed_by(&self, value: f64) -> f64 {
        if value.is_nan() {
            return f64::INFINITY;
        }
        let low = self.at_least.map(|least| least - value);
        let high = self.at_most.map(|most| value - most);
        low.into_iter().chain(high).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Verdict {
    /// Computes the yield of displays from their metrics, `columns[metric][row]`.
    ///
    /// Also returns the displays that miss a limit most, at most `worst` of them, the worst first.
    /// `deviations` are the standard deviations of the metrics.
    pub fn of(columns: &[Vec<f64>], limits: &[Limit], deviations: &[f64], worst: usize) -> (Self, Vec<Miss>) {
        let rows = columns.first().map_or(0, Vec::len);
        let missed = |row: usize| -> Vec<f64> {
            limits.iter().map(|limit| limit.missed_by(columns[limit.column][row])).collect()
        };
        // Distance beyond each limit, `[row][limit]`.
        let fails: Vec<Vec<f64>> = (0..rows).map(missed).collect();
        let fraction = |counts: &dyn Fn(&[f64]) -> bool| {
            let terms = fails.iter().enumerate();
            let terms = terms.map(|(row, missed)| (replicate(row), [f64::from(counts(missed)), 1.0]));
            at_least_of_counts(Sums::of(terms).fraction(), rows)
        };
        let failing = |k: usize| Failing {
            share: fraction(&|missed| missed[k] > 0.0),
            alone: fraction(&|missed| missed.iter().enumerate().all(|(i, by)| (*by > 0.0) == (i == k))),
        };
        let verdict = Self {
            yield_share: fraction(&|missed| missed.iter().all(|by| *by <= 0.0)),
            failing: (0..limits.len()).map(failing).collect(),
        };
        (verdict, most_missed(&fails, limits, deviations, worst))
    }
}

/// A fraction whose standard error is at least that of whole numbers: all replicates can have the same count,
/// although the fractions that they estimate differ by less than one display. Rounding to integers adds a
/// variance of 1/12 to each (W. F. Sheppard, Proc. London Math. Soc. 29, 353 (1898)). The fractions 0 and 1
/// keep the error 0: for them, the rule of three states more.
fn at_least_of_counts(fraction: Estimate, rows: usize) -> Estimate {
    let is_mixed = fraction.value > 0.0 && fraction.value < 1.0;
    let of_counts = if is_mixed { (REPLICATES as f64 / 12.0).sqrt() / rows as f64 } else { 0.0 };
    Estimate { standard_error: fraction.standard_error.max(of_counts), ..fraction }
}

/// Rows that miss a limit most, the worst first; equal ones in order of their rows.
fn most_missed(fails: &[Vec<f64>], limits: &[Limit], deviations: &[f64], count: usize) -> Vec<Miss> {
    let in_deviations = |limit: usize, by: f64| {
        let deviation = deviations.get(limits[limit].column).copied().unwrap_or(f64::NAN);
        // For a metric that does not vary, the distance is in the unit of the metric.
        if deviation > 0.0 { by / deviation } else { by }
    };
    let worst_of = |(row, missed): (usize, &Vec<f64>)| {
        let each = missed.iter().enumerate().map(|(limit, by)| (limit, in_deviations(limit, *by)));
        let (limit, by) = each.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)))?;
        (by > 0.0).then_some(Miss { row, limit, by })
    };
    let mut worst: Vec<Miss> = fails.iter().enumerate().filter_map(worst_of).collect();
    worst.sort_by(|a, b| b.by.total_cmp(&a.by).then(a.row.cmp(&b.row)));
    worst.truncate(count);
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_least(column: usize, value: f64) -> Limit {
        Limit { column, at_least: Some(value), at_most: None }
    }

    #[test]
    fn verdict_counts_limits_that_fail_alone_or_together() {
        let rows = 160;
        let a: Vec<f64> = (0..rows).map(|row| f64::from(row % 4)).collect();
        let mut b = a.clone();
        b[1] = f64::NAN;
        let limits = [at_least(0, 1.0), Limit { column: 1, at_least: Some(1.0), at_most: Some(2.0) }];
        let (verdict, found) = Verdict::of(&[a, b], &limits, &[1.0, 2.0], 2);
        let fraction = |count: f64| count / f64::from(rows);
        // Of four displays, the first fails both limits and the last fails only the second; one more is
        // undefined.
        assert_eq!(verdict.yield_share.value, fraction(79.0));
        assert_eq!(verdict.failing[0].share.value, fraction(40.0));
        assert_eq!((verdict.failing[0].alone.value, verdict.failing[1].alone.value), (0.0, fraction(41.0)));
        let worst = [Miss { row: 1, limit: 1, by: f64::INFINITY }, Miss { row: 0, limit: 0, by: 1.0 }];
        assert_eq!(found, worst);
    }

    #[test]
    fn equal_counts_of_all_replicates_have_an_error() {
        // Each of the 16 replicates has the rows of one residue: of ten displays, one fails in each.
        let failing: Vec<f64> = (0..160).map(|row| f64::from(row >= 16)).collect();
        let (verdict, _) = Verdict::of(&[failing], &[at_least(0, 1.0)], &[1.0], 0);
        assert_eq!(verdict.yield_share.value, 0.9);
        let expected = (16.0_f64 / 12.0).sqrt() / 160.0;
        assert!((verdict.yield_share.standard_error / expected - 1.0).abs() < 1e-12, "{verdict:?}");
        let (verdict, _) = Verdict::of(&[vec![1.0; 160]], &[at_least(0, 1.0)], &[1.0], 0);
        assert_eq!((verdict.yield_share.value, verdict.yield_share.standard_error), (1.0, 0.0));
    }

    #[test]
    fn verdict_without_limits_has_full_yield() {
        let (verdict, worst) = Verdict::of(&[vec![1.0; 32]], &[], &[0.0], 5);
        assert_eq!((verdict.yield_share.value, worst.len()), (1.0, 0));
    }
}

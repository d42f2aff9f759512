//! Yield against limits.

use serde::Serialize;

use super::estimate::{Estimate, Sums};
use super::plan::replicate;

/// What a metric has to meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limit {
    /// Which metric, by its column.
    pub column: usize,
    /// It is to be no less.
    pub at_least: Option<f64>,
    /// It is to be no more.
    pub at_most: Option<f64>,
}

/// How many pieces meet all limits, and why the others do not.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The share of pieces that meet all limits.
    pub yield_share: Estimate,
    /// For each limit.
    pub failing: Vec<Failing>,
}

/// How often a limit is not met.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Failing {
    /// The share of pieces that do not meet it.
    pub share: Estimate,
    /// The share of pieces that meet all others.
    pub alone: Estimate,
}

/// A piece that does not meet its limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Miss {
    /// Its row.
    pub row: usize,
    /// The limit that it misses most.
    pub limit: usize,
    /// How far it misses that, in standard deviations of the metric; infinite where the metric is undefined.
    pub by: f64,
}

impl Limit {
    /// How far a value is beyond the limit; 0 or less if it is met, infinite if it is undefined.
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
    /// Of pieces by their metrics, `columns[metric][row]`, and the pieces that miss most, the worst first: `worst` at
    /// most. `deviations` are the standard deviations of the metrics.
    pub fn of(columns: &[Vec<f64>], limits: &[Limit], deviations: &[f64], worst: usize) -> (Self, Vec<Miss>) {
        let rows = columns.first().map_or(0, Vec::len);
        let missed = |row: usize| -> Vec<f64> {
            limits.iter().map(|limit| limit.missed_by(columns[limit.column][row])).collect()
        };
        // For each row: which limits fail.
        let fails: Vec<Vec<f64>> = (0..rows).map(missed).collect();
        let share = |is_it: &dyn Fn(&[f64]) -> bool| {
            let terms = fails.iter().enumerate();
            Sums::of(terms.map(|(row, missed)| (replicate(row), [f64::from(is_it(missed)), 1.0]))).share()
        };
        let failing = |k: usize| Failing {
            share: share(&|missed| missed[k] > 0.0),
            alone: share(&|missed| missed.iter().enumerate().all(|(i, by)| (*by > 0.0) == (i == k))),
        };
        let verdict = Self {
            yield_share: share(&|missed| missed.iter().all(|by| *by <= 0.0)),
            failing: (0..limits.len()).map(failing).collect(),
        };
        (verdict, most_missed(&fails, limits, deviations, worst))
    }
}

/// The rows that miss a limit by most, the worst first; of equals the first.
fn most_missed(fails: &[Vec<f64>], limits: &[Limit], deviations: &[f64], count: usize) -> Vec<Miss> {
    let in_deviations = |limit: usize, by: f64| {
        let deviation = deviations.get(limits[limit].column).copied().unwrap_or(f64::NAN);
        // A metric that does not scatter misses by its own unit.
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
    fn limits_fail_alone_or_together() {
        let rows = 160;
        let a: Vec<f64> = (0..rows).map(|row| f64::from(row % 4)).collect();
        let mut b = a.clone();
        b[1] = f64::NAN;
        let limits = [at_least(0, 1.0), Limit { column: 1, at_least: Some(1.0), at_most: Some(2.0) }];
        let (verdict, found) = Verdict::of(&[a, b], &limits, &[1.0, 2.0], 2);
        let share = |count: f64| count / f64::from(rows);
        // Of four pieces the first fails both, the last the second alone; one more is undefined.
        assert_eq!(verdict.yield_share.value, share(79.0));
        assert_eq!(verdict.failing[0].share.value, share(40.0));
        assert_eq!((verdict.failing[0].alone.value, verdict.failing[1].alone.value), (0.0, share(41.0)));
        let worst = [Miss { row: 1, limit: 1, by: f64::INFINITY }, Miss { row: 0, limit: 0, by: 1.0 }];
        assert_eq!(found, worst);
    }

    #[test]
    fn without_limits_all_is_well() {
        let (verdict, worst) = Verdict::of(&[vec![1.0; 32]], &[], &[0.0], 5);
        assert_eq!((verdict.yield_share.value, worst.len()), (1.0, 0));
    }
}

//! Statistics of z-scores. The numbers of a run come from the same paths, so that those of a run count as
//! one, as if they were all equal.

use super::solvers::Pair;

/// Mean square of Student's t with 31 degrees of freedom, and the variance of its square.
const STUDENT: f64 = 31.0 / 29.0;
const OF_SQUARES: f64 = 2.55;

/// Number of runs (300 scenarios with two seeds, minus those without noise) from which the mean square is
/// known accurately enough to be within `WITHIN`.
const MANY: usize = 500;
const WITHIN: std::ops::RangeInclusive<f64> = 0.85..=1.15;

/// Deviation in standard errors, and the largest fraction of numbers that may exceed it (Student's t: 0.04
/// %).
pub(crate) const FAR: f64 = 4.0;
const MAX_FAR_FRACTION: f64 = 0.005;

/// The z-scores of one kind of number, run by run.
#[derive(Debug, Default)]
pub(crate) struct Scores {
    runs: Vec<Vec<f64>>,
}

impl Scores {
    /// Adds the z-scores of the noisy numbers of a run.
    pub(crate) fn add<'a>(&mut self, pairs: impl Iterator<Item = &'a Pair>) {
        let z: Vec<f64> = pairs.filter(|pair| pair.is_noisy()).map(Pair::z).collect();
        if !z.is_empty() {
            self.runs.push(z);
        }
    }

    fn count(&self) -> f64 {
        self.runs.iter().map(Vec::len).sum::<usize>() as f64
    }

    fn mean_of(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.runs.iter().flatten().map(|z| of(*z)).sum::<f64>() / self.count()
    }

    /// Returns the variance of the mean for numbers of unit variance: one over the number of runs, or more if
    /// the runs have different counts.
    fn of_means(&self) -> f64 {
        self.runs.iter().map(|run| (run.len() as f64).powi(2)).sum::<f64>() / self.count().powi(2)
    }

    /// Returns a summary.
    pub(crate) fn summary(&self) -> String {
        format!(
            "{} numbers of {} runs: mean z {:.3}, mean square {:.3} (Student's t: {STUDENT:.3}), {:.2} % beyond {FAR}",
            self.count(),
            self.runs.len(),
            self.mean_of(|z| z),
            self.mean_of(|z| z * z),
            100.0 * self.far(),
        )
    }

    fn far(&self) -> f64 {
        self.mean_of(|z| f64::from(u8::from(z.abs() > FAR)))
    }

    /// Compares with Student's t at 4.5 standard errors, and with `WITHIN` if there are at least `MANY` runs.
    pub(crate) fn check(&self) -> Result<(), String> {
        let (mean, square) = (self.mean_of(|z| z), self.mean_of(|z| z * z));
        let sigma = |variance: f64| (variance * self.of_means()).sqrt();
        if (square - STUDENT).abs() > 4.5 * sigma(OF_SQUARES) {
            return Err(format!("the mean square of z is {square}"));
        }
        if mean.abs() > 4.5 * sigma(STUDENT) {
            return Err(format!("the mean of z is {mean}"));
        }
        let is_many = self.runs.len() >= MANY;
        if is_many && !WITHIN.contains(&square) {
            return Err(format!("the mean square of z is {square}, outside {WITHIN:?}"));
        }
        if is_many && self.far() > MAX_FAR_FRACTION {
            return Err(format!(
                "{:.2} % of the deviations exceed {FAR} standard errors",
                100.0 * self.far()
            ));
        }
        Ok(())
    }
}

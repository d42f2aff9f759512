//! What z-scores say together. Numbers of a run share their paths: a run's count as one, as if they were all the same.

use super::solvers::Pair;

/// Mean square of Student's t with 31 degrees of freedom, and the variance of its square.
const STUDENT: f64 = 31.0 / 29.0;
const OF_SQUARES: f64 = 2.55;

/// From so many runs on, 300 scenarios with two seeds less those without noise, the mean square is known well enough to lie within
/// `WITHIN`.
const MANY: usize = 500;
const WITHIN: std::ops::RangeInclusive<f64> = 0.85..=1.15;

/// At most so many of the numbers are further off than 4 of their errors (Student's t: 0.04 %).
pub(crate) const FAR: f64 = 4.0;
const MOST_FAR: f64 = 0.005;

/// The z-scores of one kind of number, run by run.
#[derive(Debug, Default)]
pub(crate) struct Scores {
    runs: Vec<Vec<f64>>,
}

impl Scores {
    /// Those of a run that are noise.
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

    /// One over the number of runs, if they are all alike; more, if some have more numbers.
    fn of_means(&self) -> f64 {
        self.runs.iter().map(|run| (run.len() as f64).powi(2)).sum::<f64>() / self.count().powi(2)
    }

    /// What was found, in words.
    pub(crate) fn words(&self) -> String {
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

    /// Held to Student's t at 4.5 sigma, and from `MANY` runs on to `WITHIN`.
    pub(crate) fn hold(&self) -> Result<(), String> {
        let (mean, square) = (self.mean_of(|z| z), self.mean_of(|z| z * z));
        let sigma = |variance: f64| (variance * self.of_means()).sqrt();
        if (square - STUDENT).abs() > 4.5 * sigma(OF_SQUARES) {
            return Err(format!("a mean square of z of {square}"));
        }
        if mean.abs() > 4.5 * sigma(STUDENT) {
            return Err(format!("a mean of z of {mean}"));
        }
        let is_many = self.runs.len() >= MANY;
        if is_many && !WITHIN.contains(&square) {
            return Err(format!("a mean square of z of {square}, not within {WITHIN:?}"));
        }
        if is_many && self.far() > MOST_FAR {
            return Err(format!("{:.2} % further off than {FAR}", 100.0 * self.far()));
        }
        Ok(())
    }
}

//! Production of a scenario's `[tolerance]`: the sampled displays and their evaluation.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_scenario::{ScenarioErrors, Tolerance};
use serde_json::Value;

use super::plan::{Draw, Plan};
use crate::light::quantity;
use crate::parallel::in_parallel;
use crate::{Condition, DesignError, Evaluator, Key, Study, Values, Variable};

/// Displays of a `[tolerance]`, by row.
///
/// A row is one display. Rows for sensitivities also have a second, independent display and the mixtures of
/// both: see [`Plan`].
#[derive(Debug, Clone)]
pub struct Production {
    study: Arc<Study>,
    plan: Plan,
    rows: usize,
    sensitivity_rows: usize,
}

impl Production {
    /// Creates the production of a scenario.
    pub fn new(tolerance: &Tolerance) -> Self {
        let variables = tolerance.keys.iter().map(|key| Variable {
            name: key.name.clone(),
            keys: key
                .paths
                .iter()
                .map(|(path, slope, offset)| Key { path: path.clone(), slope: *slope, offset: *offset })
                .collect(),
            values: if key.choices.is_empty() {
                Values::Number
            } else {
                Values::Choices(key.choices.clone())
            },
        });
        let study = Study {
            conditions: vec![Condition { name: String::new(), varied: tolerance.varied.clone() }],
            variables: variables.collect(),
            quantities: tolerance.metrics.iter().map(quantity).collect(),
        };
        let distributions = tolerance.keys.iter().map(|key| key.distribution.clone()).collect();
        Self {
            study: Arc::new(study),
            plan: Plan::new(distributions, tolerance.correlation.clone(), tolerance.seed),
            rows: tolerance.samples,
            sensitivity_rows: tolerance.sensitivity_samples,
        }
    }

    /// Variables and quantities of the production.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Plan of the displays.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of rows that are also used for sensitivities: the first ones.
    pub fn sensitivity_rows(&self) -> usize {
        self.sensitivity_rows
    }

    /// Number of displays of all rows.
    pub fn displays(&self) -> usize {
        self.rows + self.sensitivity_rows * (1 + self.plan.groups().len())
    }

    /// Displays of a row; its own display is first.
    pub fn draws(&self, row: usize) -> Vec<Draw> {
        let own = [Draw::Own];
        if row >= self.sensitivity_rows {
            return own.to_vec();
        }
        let mixed = (0..self.plan.groups().len()).map(Draw::Mixed);
        own.into_iter().chain([Draw::Other]).chain(mixed).collect()
    }

    /// Number of values of a row: every metric of each of its displays.
    pub fn width(&self, row: usize) -> usize {
        self.draws(row).len() * self.study.quantities.len()
    }

    /// Computes the metrics of a row, display by display; NaN where one is undefined.
    ///
    /// # Errors
    /// If one of its displays cannot be evaluated, or the evaluation was interrupted.
    pub fn evaluate(&self, evaluator: &mut Evaluator<'_>, row: usize) -> Result<Vec<f64>, DesignError> {
        let mut numbers = Vec::with_capacity(self.width(row));
        for draw in self.draws(row) {
            let values = evaluator.evaluate(&self.plan.display(row as u64, draw))?;
            numbers.extend(values.into_iter().map(|number| number.unwrap_or(f64::NAN)));
        }
        Ok(numbers)
    }

    /// Computes the metrics of all rows on `threads` threads. `done` is called with the number of finished rows; setting `stop`
    /// ends the computation.
    ///
    /// # Errors
    /// Those of [`evaluate`](Self::evaluate).
    pub fn evaluate_all(
        &self,
        threads: usize,
        stop: &AtomicBool,
        done: impl Fn(usize) + Sync,
    ) -> Result<Vec<Vec<f64>>, DesignError> {
        let worker = || Evaluator::new(self.study.clone(), stop);
        in_parallel(threads, self.rows, done, worker, |evaluator, row| self.evaluate(evaluator, row))
    }

    /// Values of the keys of a row's own display: for each key, the value of its first path. A choice that is
    /// a table or an array is given by its position in the list of choices, such as "#2".
    pub fn values(&self, row: usize) -> Vec<Value> {
        let display = self.plan.display(row as u64, Draw::Own);
        let values = self.study.variables.iter().zip(display);
        let shown = |(variable, x): (&Variable, f64)| match variable.value(&variable.keys[0], x) {
            Value::Array(_) | Value::Object(_) => format!("#{}", x as usize + 1).into(),
            value => value,
        };
        values.map(shown).collect()
    }

    /// Checks the displays with the smallest and the largest number of each key, and all choices, before any
    /// display is computed.
    ///
    /// # Errors
    /// If the scenario of one of them is invalid, with the location of its key.
    pub fn check(&self, tolerance: &Tolerance) -> Result<(), ScenarioErrors> {
        let count = self.study.variables.len();
        let mut ends: Vec<[(f64, u64); 2]> = vec![[(f64::INFINITY, 0), (f64::NEG_INFINITY, 0)]; count];
        for row in 0..self.rows as u64 {
            for (end, x) in ends.iter_mut().zip(self.plan.display(row, Draw::Own)) {
                let [low, high] = end;
                *low = if x < low.0 { (x, row) } else { *low };
                *high = if x > high.0 { (x, row) } else { *high };
            }
        }
        let mut rows: Vec<u64> = ends.iter().flatten().map(|(_, row)| *row).collect();
        rows.sort_unstable();
        rows.dedup();
        for row in rows {
            if let Ok(values) = self.study.values(&self.plan.display(row, Draw::Own)) {
                tolerance.check(&values)?;
            }
        }
        // All choices are checked, even improbable ones.
        for (index, key) in tolerance.keys.iter().enumerate() {
            for choice in 0..key.choices.len() {
                let mut display = self.plan.display(0, Draw::Own);
                display[index] = choice as f64;
                if let Ok(values) = self.study.values(&display) {
                    tolerance.check(&values)?;
                }
            }
        }
        Ok(())
    }
}

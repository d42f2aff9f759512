//! A scenario's production: the displays that stand for it, what each of them is, and what is made of all of them.

use std::sync::Arc;

use papilio_scenario::{ScenarioErrors, Tolerance};
use serde_json::Value;

use super::plan::{Draw, Plan};
use crate::{Condition, DesignError, Evaluator, Key, Named, Study, Values, Variable};

/// The displays of a `[tolerance]`, by row.
///
/// A row is a display, and, while sensitivities are sought, the other display and the mixtures of both: see [`Plan`].
#[derive(Debug, Clone)]
pub struct Production {
    study: Arc<Study>,
    plan: Plan,
    rows: usize,
    sensitivity_rows: usize,
}

impl Production {
    /// Of a scenario that was read.
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
            quantities: tolerance.metrics.iter().map(Named::of).collect(),
        };
        let distributions = tolerance.keys.iter().map(|key| key.distribution.clone()).collect();
        Self {
            study: Arc::new(study),
            plan: Plan::new(distributions, tolerance.correlation.clone(), tolerance.seed),
            rows: tolerance.samples,
            sensitivity_rows: tolerance.sensitivity_samples,
        }
    }

    /// What varies and what is asked.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Which displays.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// How many of them are for sensitivities, too.
    pub fn sensitivity_rows(&self) -> usize {
        self.sensitivity_rows
    }

    /// How many displays there are in all.
    pub fn displays(&self) -> usize {
        self.rows + self.sensitivity_rows * (1 + self.plan.groups().len())
    }

    /// The displays of a row: its own first.
    pub fn draws(&self, row: usize) -> Vec<Draw> {
        let own = [Draw::Own];
        if row >= self.sensitivity_rows {
            return own.to_vec();
        }
        let mixed = (0..self.plan.groups().len()).map(Draw::Mixed);
        own.into_iter().chain([Draw::Other]).chain(mixed).collect()
    }

    /// How many numbers a row has: of each of its displays every metric.
    pub fn width(&self, row: usize) -> usize {
        self.draws(row).len() * self.study.quantities.len()
    }

    /// The numbers of a row, display by display; NaN where one is undefined.
    ///
    /// # Errors
    /// If one of its displays cannot be, or was stopped.
    pub fn evaluate(&self, evaluator: &mut Evaluator<'_>, row: usize) -> Result<Vec<f64>, DesignError> {
        let mut numbers = Vec::with_capacity(self.width(row));
        for draw in self.draws(row) {
            let found = evaluator.evaluate(&self.plan.piece(row as u64, draw))?;
            numbers.extend(found.into_iter().map(|number| number.unwrap_or(f64::NAN)));
        }
        Ok(numbers)
    }

    /// What each key of a row's own display is: the value of its first path; of a choice that is a table or a list, its
    /// place in the list of choices, as "#2".
    pub fn values(&self, row: usize) -> Vec<Value> {
        let piece = self.plan.piece(row as u64, Draw::Own);
        let values = self.study.variables.iter().zip(piece);
        let shown = |(variable, x): (&Variable, f64)| match variable.value(&variable.keys[0], x) {
            Value::Array(_) | Value::Object(_) => format!("#{}", x as usize + 1).into(),
            value => value,
        };
        values.map(shown).collect()
    }

    /// Nothing, if the displays at both ends of every key can be: found before any is computed.
    ///
    /// # Errors
    /// What is wrong with one of them, with the place of its key.
    pub fn check(&self, tolerance: &Tolerance) -> Result<(), ScenarioErrors> {
        let count = self.study.variables.len();
        let mut ends: Vec<[(f64, u64); 2]> = vec![[(f64::INFINITY, 0), (f64::NEG_INFINITY, 0)]; count];
        for row in 0..self.rows as u64 {
            for (end, x) in ends.iter_mut().zip(self.plan.piece(row, Draw::Own)) {
                let [low, high] = end;
                *low = if x < low.0 { (x, row) } else { *low };
                *high = if x > high.0 { (x, row) } else { *high };
            }
        }
        let mut rows: Vec<u64> = ends.iter().flatten().map(|(_, row)| *row).collect();
        rows.sort_unstable();
        rows.dedup();
        for row in rows {
            if let Ok(values) = self.study.values(&self.plan.piece(row, Draw::Own)) {
                tolerance.check(&values)?;
            }
        }
        // Choices that are rarely met are looked at all the same.
        for (at, key) in tolerance.keys.iter().enumerate() {
            for choice in 0..key.choices.len() {
                let mut piece = self.plan.piece(0, Draw::Own);
                piece[at] = choice as f64;
                if let Ok(values) = self.study.values(&piece) {
                    tolerance.check(&values)?;
                }
            }
        }
        Ok(())
    }
}

//! A light sweep as a study: its points by their numbers.

use std::sync::Arc;

use papilio_scenario::{AskedMetric, LightSweep};
use serde_json::Value;

use crate::{Condition, DesignError, Evaluator, Key, Named, Quantity, Study, Values, Variable};

/// The points of a sweep of which only some metrics are kept.
#[derive(Debug, Clone)]
pub struct LightStudy {
    study: Arc<Study>,
    sweep: LightSweep,
}

impl LightStudy {
    /// Of a sweep that was read.
    pub fn new(sweep: LightSweep) -> Self {
        let variable = |(path, values): (&str, &Vec<Value>)| Variable {
            name: path.to_owned(),
            keys: vec![Key::plain(path)],
            values: if values.iter().all(Value::is_number) {
                Values::Number
            } else {
                Values::Choices(values.clone())
            },
        };
        let study = Study {
            variables: sweep.varied.paths().zip(&sweep.keys).map(variable).collect(),
            conditions: vec![Condition { name: String::new(), varied: sweep.varied.clone() }],
            quantities: sweep.metrics.iter().map(Named::of).collect(),
        };
        Self { study: Arc::new(study), sweep }
    }

    /// What varies and what is asked.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// The metrics of a point; NaN where one is undefined.
    ///
    /// # Errors
    /// If the point cannot be, or was stopped.
    pub fn evaluate(&self, evaluator: &mut Evaluator<'_>, point: usize) -> Result<Vec<f64>, DesignError> {
        let number = |((values, variable), at): ((&Vec<Value>, &Variable), usize)| match variable.values {
            Values::Number => values[at].as_f64().unwrap_or(f64::NAN),
            Values::Choices(_) => at as f64,
        };
        let keys = self.sweep.keys.iter().zip(&self.study.variables);
        let design: Vec<f64> = keys.zip(self.sweep.at(point)).map(number).collect();
        let found = evaluator.evaluate(&design)?;
        Ok(found.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }
}

impl Named {
    /// A metric that a scenario asks for, under its only condition.
    pub(crate) fn of(asked: &AskedMetric) -> Self {
        let quantity =
            Quantity::Metric { view: asked.view, state: asked.state.clone(), metric: asked.metric };
        Self { name: asked.name.clone(), condition: 0, quantity }
    }
}

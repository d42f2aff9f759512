//! A sweep of selected metrics as a study, its points selected by their index.

use std::sync::Arc;

use papilio_scenario::{LightSweep, ReportedMetric};
use serde_json::Value;

use crate::{Condition, DesignError, Evaluator, Key, NamedQuantity, Quantity, Study, Values, Variable};

/// Sweep of which only selected metrics are stored.
#[derive(Debug, Clone)]
pub struct LightStudy {
    study: Arc<Study>,
    sweep: LightSweep,
}

impl LightStudy {
    /// Creates the study of a sweep.
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
            quantities: sweep.metrics.iter().map(NamedQuantity::of).collect(),
        };
        Self { study: Arc::new(study), sweep }
    }

    /// Variables, conditions and quantities of the sweep.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Computes the metrics of a point; NaN where a metric is undefined.
    ///
    /// # Errors
    /// If the point cannot be evaluated, or the evaluation was interrupted.
    pub fn evaluate(&self, evaluator: &mut Evaluator<'_>, point: usize) -> Result<Vec<f64>, DesignError> {
        let number = |((values, variable), index): ((&Vec<Value>, &Variable), usize)| match variable.values {
            Values::Number => values[index].as_f64().unwrap_or(f64::NAN),
            Values::Choices(_) => index as f64,
        };
        let keys = self.sweep.keys.iter().zip(&self.study.variables);
        let design: Vec<f64> = keys.zip(self.sweep.at(point)).map(number).collect();
        let values = evaluator.evaluate(&design)?;
        Ok(values.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    }
}

impl NamedQuantity {
    /// The quantity of a metric that a scenario requests, under the only condition.
    pub(crate) fn of(request: &ReportedMetric) -> Self {
        let quantity =
            Quantity::Metric { view: request.view, state: request.state.clone(), metric: request.metric };
        Self { name: request.name.clone(), condition: 0, quantity }
    }
}

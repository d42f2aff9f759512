//! A sweep of selected metrics as a study, its points selected by their index.

use std::sync::Arc;

use papilio_display::scene::{Method, MetricSource};
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
            quantities: sweep.metrics.iter().map(quantity).collect(),
        };
        Self { study: Arc::new(study), sweep }
    }

    /// Variables, conditions and quantities of the sweep.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Names of the columns of a row: the metrics in order, those of pixels followed by their error.
    pub fn columns(&self) -> Vec<String> {
        let of = |metric: &ReportedMetric| {
            let end = if self.has_standard_error(metric) { "_se" } else { "_de" };
            let error = match metric.name.split_once(", ") {
                Some((name, view)) => format!("{name}{end}, {view}"),
                None => format!("{}{end}", metric.name),
            };
            std::iter::once(metric.name.clone()).chain(has_error(metric).then_some(error))
        };
        self.sweep.metrics.iter().flat_map(of).collect()
    }

    /// True for metrics that are estimated from random numbers.
    fn has_standard_error(&self, metric: &ReportedMetric) -> bool {
        match metric.metric.source() {
            MetricSource::Mtf | MetricSource::Gloss => self.sweep.method == Method::MonteCarlo,
            MetricSource::Sparkle => true,
            MetricSource::Colours | MetricSource::Crosstalk | MetricSource::Image => false,
        }
    }

    /// Computes the [`columns`](Self::columns) of a point; NaN where a metric is undefined.
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
        let values = evaluator.evaluate_with_errors(&design)?;
        let of = |(metric, [value, error]): (&ReportedMetric, [Option<f64>; 2])| {
            std::iter::once(value).chain(has_error(metric).then_some(error))
        };
        let numbers = self.sweep.metrics.iter().zip(values).flat_map(of);
        Ok(numbers.map(|number| number.unwrap_or(f64::NAN)).collect())
    }
}

/// True for metrics whose error is computed with their value.
fn has_error(metric: &ReportedMetric) -> bool {
    !matches!(metric.metric.source(), MetricSource::Colours | MetricSource::Image)
}

/// The quantity of a metric that a scenario requests, under the only condition.
pub(crate) fn quantity(request: &ReportedMetric) -> NamedQuantity {
    let quantity =
        Quantity::Metric { view: request.view, state: request.state.clone(), metric: request.metric };
    NamedQuantity { name: request.name.clone(), condition: 0, quantity }
}

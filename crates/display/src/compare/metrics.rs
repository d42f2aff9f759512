//! Measured metrics, by name, and their simulated counterparts.

use schemars::JsonSchema;
use serde::Serialize;

use super::deviation::z;
use super::left_out::{LeftOut, NO_SUCH_STATE};
use super::pairs::beside;
use super::{Simulated, view_at};
use crate::scene::Metric;

/// Metric of a display that was measured: a contrast, a haze, a frequency of the modulation transfer.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredMetric {
    /// State of a metric of a state.
    pub state: Option<String>,
    /// The metric.
    pub metric: Metric,
    /// Inclination of the meter, degrees. `None`: that of the only view.
    pub theta_deg: Option<f64>,
    /// Azimuth of the meter, degrees.
    pub phi_deg: f64,
    /// Measured value.
    pub value: f64,
    /// Its standard deviation, if it is known.
    pub standard_deviation: Option<f64>,
    /// Where it was written, for messages: `metrics.csv:3:1`; empty if that is not known.
    pub place: String,
}

/// Metric of a view of a simulated display.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedMetric {
    /// Name, as [`MeasuredMetric::name`].
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub standard_deviation: f64,
}

/// Comparison of a simulated and a measured metric.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MetricComparison {
    /// Name of the metric, with its state: `white.Y`.
    pub metric: String,
    /// Inclination of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// Simulated value.
    pub simulated: f64,
    /// Measured value.
    pub measured: f64,
    /// Standard deviation of the simulated value: numerical errors, and tolerances of the inputs.
    pub simulated_deviation: f64,
    /// Standard deviation of the measured value, if it is known.
    pub measured_deviation: Option<f64>,
    /// Difference, simulated minus measured, over the standard deviation of the difference.
    pub z: Option<f64>,
}

impl MeasuredMetric {
    /// Name of the metric, with its state: `white.Y`.
    pub fn name(&self) -> String {
        match &self.state {
            Some(state) => format!("{state}.{}", self.metric.name()),
            None => self.metric.name().to_owned(),
        }
    }

    /// Whether both are the same metric from the same direction.
    pub fn names_the_same_as(&self, other: &Self) -> bool {
        self.metric == other.metric
            && self.state == other.state
            && self.theta_deg == other.theta_deg
            && self.phi_deg == other.phi_deg
    }

    /// Compares the metric with that of the nearest view, with a note if this has another direction; fails with the reason if there is
    /// none.
    pub(super) fn compared(
        &self,
        simulated: &Simulated,
    ) -> Result<(MetricComparison, Option<LeftOut>), LeftOut> {
        let (name, direction) = (self.name(), self.theta_deg.map(|theta| [theta, self.phi_deg]));
        let left_out = |why: String| LeftOut { state: name.clone(), direction, why };
        let (_, view) = view_at(simulated, direction).map_err(left_out)?;
        if self.state.as_ref().is_some_and(|state| view.states.iter().all(|one| one.name != *state)) {
            return Err(left_out(NO_SUCH_STATE.to_owned()));
        }
        let found = view.metrics.iter().find(|one| one.name == name);
        let found = found.ok_or_else(|| left_out(self.missing()))?;
        let comparison = MetricComparison {
            theta_deg: view.theta_deg,
            phi_deg: view.phi_deg,
            simulated: found.value,
            measured: self.value,
            simulated_deviation: found.standard_deviation,
            measured_deviation: self.standard_deviation,
            z: self
                .standard_deviation
                .and_then(|measured| z(found.value - self.value, [found.standard_deviation, measured])),
            metric: name.clone(),
        };
        Ok((comparison, beside(view, direction).map(left_out)))
    }

    /// Why a result does not have the metric.
    fn missing(&self) -> String {
        match self.metric.source().command() {
            Some(command) => {
                format!(
                    "of `papilio {command}`, not of a run (compare with the scenario instead of its result)"
                )
            }
            None => "not defined in the result: it needs states or keys that the display does not have (docs/metrics.md)".to_owned(),
        }
    }
}

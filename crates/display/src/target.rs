//! Target of a Monte Carlo run: one metric, with the tolerance of its standard error.

pub use crate::metrics::{Metric, MetricSource};
use crate::result::{State, View};

/// Tolerance of one metric in every view: the largest allowed standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The metric.
    pub metric: Metric,
    /// The state; `None`: all states for which the metric is defined. Metrics of a view have no state.
    pub state: Option<String>,
    /// The tolerance.
    pub tolerance: Tolerance,
}

/// Tolerance of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Absolute, in the unit of the metric.
    Absolute(f64),
    /// Relative to the value of the metric.
    Relative(f64),
}

impl Target {
    /// Returns the largest ratio of standard error to tolerance; the target is met at 1 or less. `None` if
    /// the metric is not defined.
    pub(crate) fn missed_by(&self, view: &View) -> Option<f64> {
        let over = |[value, error]: [Option<f64>; 2]| {
            let tolerance = match self.tolerance {
                Tolerance::Absolute(error) => error,
                Tolerance::Relative(error) => error * value?.abs(),
            };
            Some(if error? == 0.0 { 0.0 } else { error? / tolerance })
        };
        if self.metric.is_of_view() {
            return over([&view.metrics, &view.standard_error].map(|metrics| self.metric.of_view(metrics)));
        }
        let of = |state: &State| {
            over([self.metric.of_state(&state.value), self.metric.of_state(&state.standard_error)])
        };
        let wanted = |name: &str| self.state.as_deref().is_none_or(|state| state == name);
        let states = view.states.iter().filter(|(name, _)| wanted(name));
        let all = states.filter_map(|(_, state)| of(state));
        all.reduce(f64::max)
    }
}

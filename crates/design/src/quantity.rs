//! One number of a display.

use papilio_display::result::{RunResult, StateValues};
use papilio_display::scene::Metric;

/// What is asked of a display: one number from each.
#[derive(Debug, Clone, PartialEq)]
pub enum Quantity {
    /// A metric of the states together, or of a state.
    Metric {
        /// Which view, from 0.
        view: usize,
        /// The state, if the metric is of one.
        state: Option<String>,
        /// The metric.
        metric: Metric,
    },
}

impl Quantity {
    /// The quantity in a result, if it is defined there.
    pub fn of(&self, result: &RunResult) -> Option<f64> {
        let Self::Metric { view, state, metric } = self;
        let view = result.views.get(*view)?;
        match state {
            None => among(*metric, view.metrics.named()),
            Some(state) => of_state(*metric, &view.states.get(state)?.value),
        }
    }
}

fn among(metric: Metric, mut named: impl Iterator<Item = (&'static str, Option<f64>)>) -> Option<f64> {
    named.find(|(name, _)| *name == metric.name())?.1
}

fn of_state(metric: Metric, values: &StateValues) -> Option<f64> {
    match metric {
        Metric::Y => Some(values.Y),
        Metric::L_star => values.L_star,
        Metric::a_star => values.a_star,
        Metric::b_star => values.b_star,
        Metric::contrast => values.contrast,
        other => among(other, values.metrics.named()),
    }
}

//! Errors of the evaluation of designs.

use papilio_display::DisplayError;
use papilio_scenario::ScenarioErrors;

/// Error of the evaluation of a design.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// The scenario is invalid with these values.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The scene cannot be computed.
    #[error(transparent)]
    Display(#[from] DisplayError),
    /// Metrics of sparkle of a display without an antiglare face.
    #[error(
        "`{metric}` is a metric of an antiglare face, which the scenario does not describe; expected [sparkle] with `slope_rms` or \
         `haze`, and `correlation_um`"
    )]
    NoFace {
        /// Name of the metric.
        metric: String,
    },
    /// A metric of sparkle of several faces or gaps.
    #[error(
        "`{metric}` is of one face and one gap, and [sparkle] has {count}\n  = help: choose one, for example sparkle.{key} = {first}"
    )]
    SeveralFaces {
        /// Name of the metric.
        metric: String,
        /// Number of the faces or gaps.
        count: usize,
        /// Key of the list.
        key: &'static str,
        /// Its first value.
        first: f64,
    },
    /// A measured metric that the scenario does not describe.
    #[error("{error}\n  = note: the measured metric `{metric}` (of `papilio {command}`) needs it: {place}")]
    MeasuredMetric {
        /// What is missing.
        error: Box<DesignError>,
        /// Name of the metric, with its state.
        metric: String,
        /// Command that computes it.
        command: &'static str,
        /// Where it was written.
        place: String,
    },
    /// The design has the wrong length.
    #[error("the design has {found} numbers; expected {expected}, one for each variable")]
    Length {
        /// Number of variables.
        expected: usize,
        /// Length of the design.
        found: usize,
    },
    /// A number that is not finite, or a choice that does not exist.
    #[error("{value} is not a valid value of the variable `{variable}`")]
    Value {
        /// Name of the variable.
        variable: String,
        /// Its number in the design.
        value: f64,
    },
    /// A measurement that cannot be fitted.
    #[error("{reason}")]
    Fit {
        /// Why.
        reason: String,
    },
    /// Too many combinations of choices for a search by derivatives.
    #[error(
        "the choices have {count} combinations; a search by derivatives tries each of them and accepts at \
         most {limit}; use method = \"both\" or \"global\" for more"
    )]
    TooManyChoices {
        /// Number of combinations.
        count: f64,
        /// Largest number of combinations.
        limit: usize,
    },
}

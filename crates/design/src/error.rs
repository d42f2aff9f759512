//! Why a design is worth nothing.

use papilio_display::DisplayError;
use papilio_scenario::ScenarioErrors;

/// Why a design cannot be evaluated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// The scenario cannot be with these values.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The scene cannot be computed.
    #[error(transparent)]
    Display(#[from] DisplayError),
    /// A design of the wrong length.
    #[error("a design has {expected} numbers, one for each variable; these are {found}")]
    Length {
        /// Variables.
        expected: usize,
        /// Numbers.
        found: usize,
    },
    /// A number that is none, or a choice that there is not.
    #[error("{value} is no value of `{variable}`")]
    Value {
        /// The variable.
        variable: String,
        /// The number.
        value: f64,
    },
    /// Choices that cannot be searched one by one.
    #[error(
        "the choices have {count} combinations, and a search by derivatives tries each: {limit} at most; method = \"both\" or \"global\" takes more"
    )]
    TooManyChoices {
        /// How many there are.
        count: f64,
        /// How many there may be.
        limit: usize,
    },
}

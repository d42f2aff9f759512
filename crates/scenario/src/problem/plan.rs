//! What can be wrong with `[sweep]`, `[optimize]` and `[tolerance]`, and what to do about it.

use crate::advice::suggestion;

/// What can be wrong with what is asked of a scenario besides itself.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlanProblem {
    /// A sweep of nothing.
    #[error("there is nothing to sweep: the scenario has no `[[sweep.axes]]`")]
    NoAxes,
    /// Keys of one axis of a sweep that cannot move together.
    #[error("`{path}` has {count} values, `{first}` has {needed}")]
    SweepLengths {
        /// The key.
        path: String,
        /// How many values it has.
        count: usize,
        /// The axis's first key.
        first: String,
        /// How many values that has.
        needed: usize,
    },
    /// A key in more than one place of a sweep.
    #[error("`{path}` is swept twice")]
    SweptTwice {
        /// The key.
        path: String,
    },
    /// A sweep's own key under its axes.
    #[error("a sweep does not sweep itself")]
    SweepOfItself,
    /// A search without anything to search.
    #[error("there is nothing to search: the scenario has no `[optimize]`")]
    NothingToSearch,
    /// Two values between which nothing varies.
    #[error("{}", if from == to { format!("both bounds are {from}") } else { format!("the first bound, {from}, is above the second, {to}") })]
    NoBounds {
        /// The first.
        from: f64,
        /// The second.
        to: f64,
    },
    /// A key that two variables move.
    #[error("`{path}` varies twice")]
    VariesTwice {
        /// The key.
        path: String,
    },
    /// A search's own key among its variables.
    #[error("a search does not change what is said of it")]
    SearchOfItself,
    /// A key that has no number to give.
    #[error("`{path}` and `{with}` have no sum: they are not both numbers in this scenario")]
    NoSum {
        /// The key that gives.
        path: String,
        /// The key that takes.
        with: String,
    },
    /// A search through noise.
    #[error("a search by the walk would follow its noise")]
    WalkSearch,
    /// Two conditions of one name.
    #[error("there are two conditions `{name}`")]
    ConditionTwice {
        /// The name.
        name: String,
    },
    /// A condition that there is not.
    #[error("there is no condition `{name}`")]
    NoSuchCondition {
        /// What was asked for.
        name: String,
        /// The conditions that there are.
        known: Vec<String>,
    },
    /// A view that there is not.
    #[error("there is no view {view}")]
    NoSuchView {
        /// What was asked for.
        view: usize,
        /// How many there are.
        views: usize,
    },
    /// Nothing is said of production.
    #[error("there is nothing that scatters: the scenario has no `[tolerance]`")]
    NoTolerance,
    /// A distribution about a number that the scenario does not have.
    #[error("the scenario has no number at `{path}`")]
    NoNumberThere {
        /// The path.
        path: String,
    },
    /// A range without inside.
    #[error("nothing lies between {from} and {to}")]
    NoInside {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
    /// A logarithmic distribution about a number that has no logarithm.
    #[error("{value} has no logarithm")]
    NoLogarithm {
        /// The number.
        value: f64,
    },
    /// Weights of another number of things.
    #[error("there are {weights} weights of {values} values")]
    WeightsOf {
        /// How many weights.
        weights: usize,
        /// How many values.
        values: usize,
    },
    /// A key that scatters in two ways.
    #[error("`{path}` scatters twice")]
    ScattersTwice {
        /// The key, or the name of two.
        path: String,
    },
    /// A correlation of something that does not scatter.
    #[error("nothing named `{name}` scatters")]
    NothingScatters {
        /// What was asked for.
        name: String,
        /// What scatters.
        known: Vec<String>,
    },
    /// Coefficients that no numbers have together.
    #[error("no numbers have this correlation beside those above it")]
    NoSuchCorrelation,
    /// A limit that nothing has to meet.
    #[error("this limit has neither `at_least` nor `at_most`")]
    NoLimit,
    /// A figure of a metric that a light sweep does not keep.
    #[error("this sweep does not keep `{name}`: it keeps {kept}")]
    NotKept {
        /// What is to be drawn.
        name: String,
        /// What is kept.
        kept: String,
    },
}

impl PlanProblem {
    /// What should stand there.
    pub fn expected(&self) -> Option<String> {
        Some(match self {
            Self::NoAxes => {
                "expected `[[sweep.axes]]`, a table of keys with a list of values each".to_owned()
            }
            Self::NothingToSearch => "expected `[optimize]` with its variables and objectives".to_owned(),
            Self::NoBounds { .. } => "expected the smaller value first, and a larger one".to_owned(),
            Self::NoSuchView { views, .. } => {
                format!("expected a number from 0 to {}", views.saturating_sub(1))
            }
            Self::NoTolerance => {
                "expected [tolerance] with [[tolerance.keys]], each with a key and its distribution"
                    .to_owned()
            }
            Self::NoInside { .. } => "expected a range that ends beyond its beginning".to_owned(),
            Self::NoLogarithm { .. } => "expected a number above 0".to_owned(),
            Self::WeightsOf { values, .. } => format!("expected {values} weights, not all 0"),
            Self::NoSuchCorrelation => "expected a positive definite matrix of coefficients".to_owned(),
            Self::NoLimit => "expected one of them, or both".to_owned(),
            Self::SweepLengths { needed, .. } => format!("expected {needed} values"),
            _ => return None,
        })
    }

    /// What to do about it.
    pub fn hint(&self) -> Option<String> {
        Some(match self {
            Self::NoAxes => "[[sweep.axes]], and below it: display.diffuser.haze = [0.5, 0.7]".to_owned(),
            Self::NothingToSearch => "scenarios/optimize.toml is an example; docs/optimize.md says what there is".to_owned(),
            Self::NoSum { .. } => "give both keys a number, whose sum then stays".to_owned(),
            Self::NoBounds { from, to } if from == to => {
                "what does not vary is no variable: leave it out here, and set the key itself".to_owned()
            }
            Self::WalkSearch => "set solver.method = \"adding\"; the walk checks the best design afterwards".to_owned(),
            Self::NoSuchCondition { known, .. } if known.is_empty() => {
                "[[optimize.conditions]] gives conditions their names".to_owned()
            }
            Self::NoSuchCondition { name, known } => {
                suggestion(name, known.iter().map(String::as_str), "conditions")
            }
            Self::SweepLengths { .. } => {
                "keys of one [[sweep.axes]] move together; for all combinations give each its own".to_owned()
            }
            Self::NotKept { name, .. } => format!("add \"{name}\" to sweep.metrics, or take it out of sweep.figures"),
            Self::NothingScatters { name, known } => suggestion(name, known.iter().map(String::as_str), "names"),
            Self::NoNumberThere { .. } => {
                "say where its middle is (`mean`, `median`, `mode`, or `from` and `to`); of several keys each has to have a number"
                    .to_owned()
            }
            Self::NoSuchCorrelation => {
                "of three numbers, two that follow the third closely follow each other; what moves alike is one item with `keys`"
                    .to_owned()
            }
            _ => return None,
        })
    }
}

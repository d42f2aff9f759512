//! Optimisation of designs.
//!
//! A search consists of [`Task`]s: descents by derivatives from different starting points, and populations.
//! The tasks of a round are independent of each other. They can run in parallel, and their results do not
//! depend on the number of threads. Tasks that use results of others belong to a later round. A
//! [`SearchSchedule`] distributes tasks and the generations of populations as [`WorkItem`]s. The optimisers
//! are those of the crate `basin`: SLSQP (Kraft 1988) for descents, differential evolution (Storn and Price
//! 1997) for populations.

mod aims;
mod descent;
mod front;
mod population;
mod records;
mod rounds;
mod run;
mod schedule;
mod selection;
mod starts;
mod task_problem;

pub use aims::{Aims, FEASIBLE};
pub use front::front;
pub use records::{Batch, Record, SearchRecords, SearchResult};
pub use run::{OnRecord, was_stopped};
pub use schedule::{SearchProgress, SearchSchedule, WorkItem, WorkResult};
pub use selection::SelectedDesign;
pub(crate) use starts::random_point;

use std::sync::Arc;

use papilio_scenario::{Optimisation, SearchMethod, SearchRange};
use serde::{Deserialize, Serialize};

use crate::{DesignError, Evaluator, Study, exact};

/// Largest number of combinations of choices for which descents are started from each of them.
const MOST_COMBINATIONS: usize = 1000;

/// Search that is ready to run.
#[derive(Debug)]
pub struct Search {
    spec: Optimisation,
    study: Arc<Study>,
    aims: Aims,
    /// The scenario's own design, as close as the variables' ranges permit.
    own: Vec<f64>,
    /// Quantities of the scenario's own design.
    own_values: Vec<Option<f64>>,
    /// Combinations of choices: the index of each choice, in the order of the variables that are choices.
    combinations: Vec<Vec<usize>>,
}

/// Part of a search that is independent of the other tasks of its round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Number of the task in the search.
    pub number: usize,
    /// Index of the objective that the task improves.
    pub objective: usize,
    /// Upper limit of each objective, as [`Aims::merit`]; `None` if the objective has no limit.
    #[serde(with = "exact::values")]
    pub limits: Vec<Option<f64>>,
    /// Method and starting point.
    #[serde(rename = "way")]
    pub method: TaskMethod,
    /// Largest number of designs that the task evaluates.
    pub evaluations: usize,
}

/// Method of a task, with its starting point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum TaskMethod {
    /// Descent from the best of several random designs with these choices.
    Start {
        /// Index of the start; the first one begins at the scenario's own numbers.
        start: usize,
        /// Index of each choice.
        choices: Vec<usize>,
    },
    /// Descent from a given design.
    From(#[serde(with = "exact::numbers")] Vec<f64>),
    /// Population, which also varies choices.
    Population,
}

impl Search {
    /// Prepares a search and evaluates the scenario's own design.
    ///
    /// # Errors
    /// If this design cannot be evaluated, or there are too many combinations of choices for a search by
    /// derivatives.
    pub fn new(spec: Optimisation, evaluator: &mut Evaluator<'_>) -> Result<Self, DesignError> {
        let study = Arc::new(evaluator.study().clone());
        let own: Vec<f64> = spec.variables.iter().map(papilio_scenario::SearchVariable::start).collect();
        let own_values = evaluator.evaluate(&own)?;
        let aims = Aims::new(&spec, &own_values);
        let lengths: Vec<usize> = spec
            .variables
            .iter()
            .filter_map(|variable| match &variable.range {
                SearchRange::Choices(choices) => Some(choices.len()),
                SearchRange::Bounds(..) => None,
            })
            .collect();
        let count = lengths.iter().try_fold(1_usize, |count, length| count.checked_mul(*length));
        let accepted = count.filter(|count| *count <= MOST_COMBINATIONS);
        if accepted.is_none() && spec.method == SearchMethod::Gradient {
            let count = lengths.iter().map(|length| *length as f64).product();
            return Err(DesignError::TooManyChoices { count, limit: MOST_COMBINATIONS });
        }
        let combinations = accepted.map_or(Vec::new(), |_| product(&lengths));
        Ok(Self { spec, study, aims, own, own_values, combinations })
    }

    /// Specification of the search, as read from the scenario.
    pub fn spec(&self) -> &Optimisation {
        &self.spec
    }

    /// Study of the search.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// Objectives and constraints.
    pub fn aims(&self) -> &Aims {
        &self.aims
    }

    /// The scenario's own design and its quantities.
    pub fn own(&self) -> (&[f64], &[Option<f64>]) {
        (&self.own, &self.own_values)
    }
}

/// All combinations of indices below these lengths; the last index varies fastest.
fn product(lengths: &[usize]) -> Vec<Vec<usize>> {
    lengths.iter().fold(vec![Vec::new()], |all, length| {
        all.iter().flat_map(|head| (0..*length).map(|last| [head.as_slice(), &[last]].concat())).collect()
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn product_of_lengths_lists_all_combinations() {
        assert_eq!(super::product(&[]), [Vec::<usize>::new()]);
        assert_eq!(super::product(&[2, 3]).len(), 6);
        assert_eq!(super::product(&[2, 3])[4], [1, 1]);
    }
}

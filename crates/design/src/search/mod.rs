//! The search for better designs.
//!
//! A search is made of [`Task`]s, each a descent by derivatives from a place of its own, or a population. They do
//! not know of each other, so that they run side by side, and what they find does not depend on how many do; tasks
//! that build on others come in a later round. A [`Course`] hands them out, and the generations of populations in pieces. The optimisers are those of the crate `basin`: SLSQP (Kraft 1988) for
//! descents, differential evolution (Storn and Price 1997) for populations.

mod aims;
mod course;
mod descent;
mod front;
mod outcome;
mod population;
mod record;
mod rounds;
mod run;
mod scalar;
mod starts;

pub use aims::{Aims, FEASIBLE};
pub use course::{Answer, Course, Piece};
pub use front::front;
pub use outcome::Chosen;
pub use record::{Batch, Found, Kept, Record};
pub use run::{Tell, was_stopped};

use std::sync::Arc;

use papilio_scenario::{Optimisation, SearchMethod, SearchRange};
use serde::{Deserialize, Serialize};

use crate::{DesignError, Evaluator, Study, exact};

/// More combinations of choices than this are not searched one by one.
const MOST_COMBINATIONS: usize = 1000;

/// A search, ready to run.
#[derive(Debug)]
pub struct Search {
    said: Optimisation,
    study: Arc<Study>,
    aims: Aims,
    /// The design that the scenario describes, as near as its variables come to it.
    own: Vec<f64>,
    /// What that is worth.
    own_values: Vec<Option<f64>>,
    /// For each combination of choices the number of each choice, in the order of the variables that are choices.
    combinations: Vec<Vec<usize>>,
}

/// A part of a search that needs no other of its round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Its number in the search.
    pub number: usize,
    /// Which objective is sought.
    pub objective: usize,
    /// For each objective how far it may go, as [`Aims::merit`]s; none: as far as it likes.
    #[serde(with = "exact::values")]
    pub limits: Vec<Option<f64>>,
    /// How.
    pub way: Way,
    /// Designs that it may evaluate.
    pub evaluations: usize,
}

/// How a task searches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Way {
    /// Downhill from the best of some drawn designs with these choices.
    Start {
        /// Which start it is; the first is from the scenario's own numbers.
        start: usize,
        /// The number of each choice.
        choices: Vec<usize>,
    },
    /// Downhill from a design.
    From(#[serde(with = "exact::numbers")] Vec<f64>),
    /// By a population, choices included.
    Population,
}

impl Search {
    /// Prepares a search: evaluates the scenario's own design.
    ///
    /// # Errors
    /// If that cannot be, or there are too many combinations of choices for a search by derivatives.
    pub fn new(said: Optimisation, evaluator: &mut Evaluator<'_>) -> Result<Self, DesignError> {
        let study = Arc::new(evaluator.study().clone());
        let own: Vec<f64> = said.variables.iter().map(papilio_scenario::SearchVariable::start).collect();
        let own_values = evaluator.evaluate(&own)?;
        let aims = Aims::new(&said, &own_values);
        let lengths: Vec<usize> = said
            .variables
            .iter()
            .filter_map(|variable| match &variable.range {
                SearchRange::Choices(choices) => Some(choices.len()),
                SearchRange::Bounds(..) => None,
            })
            .collect();
        let count = lengths.iter().try_fold(1_usize, |count, length| count.checked_mul(*length));
        let few = count.filter(|count| *count <= MOST_COMBINATIONS);
        if few.is_none() && said.method == SearchMethod::Gradient {
            let count = lengths.iter().map(|length| *length as f64).product();
            return Err(DesignError::TooManyChoices { count, limit: MOST_COMBINATIONS });
        }
        let combinations = few.map_or(Vec::new(), |_| product(&lengths));
        Ok(Self { said, study, aims, own, own_values, combinations })
    }

    /// What was said of it.
    pub fn said(&self) -> &Optimisation {
        &self.said
    }

    /// What is varied and asked.
    pub fn study(&self) -> &Arc<Study> {
        &self.study
    }

    /// What makes a design good.
    pub fn aims(&self) -> &Aims {
        &self.aims
    }

    /// The scenario's own design, and what that is worth.
    pub fn own(&self) -> (&[f64], &[Option<f64>]) {
        (&self.own, &self.own_values)
    }
}

/// All combinations of numbers below these lengths, the last one fastest.
fn product(lengths: &[usize]) -> Vec<Vec<usize>> {
    lengths.iter().fold(vec![Vec::new()], |all, length| {
        all.iter().flat_map(|one| (0..*length).map(|at| [one.as_slice(), &[at]].concat())).collect()
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn combinations_are_all_there_are() {
        assert_eq!(super::product(&[]), [Vec::<usize>::new()]);
        assert_eq!(super::product(&[2, 3]).len(), 6);
        assert_eq!(super::product(&[2, 3])[4], [1, 1]);
    }
}

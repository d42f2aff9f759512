//! What a search tells as it goes on, and what is known of one that did not end.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::Task;
use crate::exact;

/// What a task found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// The task.
    pub task: usize,
    /// Which objective it sought.
    pub objective: usize,
    /// The best design that it saw; empty if it saw none.
    #[serde(with = "exact::numbers")]
    pub design: Vec<f64>,
    /// The quantities there.
    #[serde(with = "exact::values")]
    pub values: Vec<Option<f64>>,
    /// Designs that it evaluated; one with its slopes counts as one.
    pub evaluations: usize,
    /// When it saw a better one that meets its limits: the evaluation,
    pub trace_at: Vec<usize>,
    /// and the objective.
    #[serde(with = "exact::numbers")]
    pub trace: Vec<f64>,
}

/// A stretch of the values that a population found, one design after the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// The task.
    pub population: usize,
    /// How many designs of the population were told before; none in journals of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<usize>,
    /// The quantities of each design.
    #[serde(with = "exact::rows")]
    pub rows: Vec<Vec<Option<f64>>>,
}

/// What a search tells as it goes on: a line of a journal.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Record {
    /// A task is done.
    Found(Found),
    /// A population has gone on by one generation.
    Batch(Batch),
}

/// What an earlier search that did not end had told.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Kept {
    pub(super) found: HashMap<usize, Found>,
    pub(super) batches: HashMap<usize, Vec<Vec<Option<f64>>>>,
}

impl Record {
    /// Reads a line.
    ///
    /// # Errors
    /// If it is none.
    pub fn parse(line: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(line).map(Self::Batch).or_else(|_| serde_json::from_str(line).map(Self::Found))
    }
}

impl Kept {
    /// Takes a record; false if there is a gap before it.
    pub fn add(&mut self, record: Record) -> bool {
        match record {
            Record::Found(found) => {
                self.found.insert(found.task, found);
            }
            Record::Batch(batch) => {
                let known = self.batches.entry(batch.population).or_default();
                if batch.from.is_some_and(|from| from != known.len()) {
                    return false;
                }
                known.extend(batch.rows);
            }
        }
        true
    }

    /// Takes what another journal of the same search had told: of a population, that of the one which came farther.
    pub fn join(&mut self, other: Self) {
        self.found.extend(other.found);
        for (population, rows) in other.batches {
            let known = self.batches.entry(population).or_default();
            if known.len() < rows.len() {
                *known = rows;
            }
        }
    }
}

impl Found {
    pub(super) fn none(task: &Task) -> Self {
        let &Task { number: task, objective, .. } = task;
        Self {
            task,
            objective,
            design: vec![],
            values: vec![],
            evaluations: 0,
            trace_at: vec![],
            trace: vec![],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A generation goes on from those before; one that is missing would give its values to other designs.
    #[test]
    fn a_missing_generation_is_found() {
        let batch = |from: Option<usize>| {
            Record::Batch(Batch { population: 3, from, rows: vec![vec![Some(1.0)], vec![None]] })
        };
        let mut kept = Kept::default();
        assert!(kept.add(batch(Some(0))) && kept.add(batch(Some(2))));
        assert!(!kept.add(batch(Some(6))));
        // As written by versions that did not say.
        assert!(kept.add(batch(None)) && kept.add(batch(Some(6))));
        let line = serde_json::to_string(&batch(Some(4))).unwrap();
        assert_eq!(Record::parse(&line).unwrap(), batch(Some(4)));
    }
}

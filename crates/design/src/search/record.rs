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
    /// Takes a record. Of a population, values that are known already are passed over, and so are those after a gap: they would be
    /// taken for those of other designs, and are found again.
    pub fn add(&mut self, record: Record) {
        match record {
            Record::Found(found) => drop(self.found.insert(found.task, found)),
            Record::Batch(batch) => {
                let known = self.batches.entry(batch.population).or_default();
                let from = batch.from.unwrap_or(known.len());
                if let Some(twice) = known.len().checked_sub(from) {
                    known.extend(batch.rows.into_iter().skip(twice));
                }
            }
        }
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
    fn a_generation_after_a_gap_is_passed_over() {
        let batch = |from: Option<usize>, value: f64| {
            Record::Batch(Batch { population: 3, from, rows: vec![vec![Some(value)], vec![None]] })
        };
        let mut kept = Kept::default();
        for (from, value) in [(0, 1.0), (4, 9.0), (2, 2.0)] {
            kept.add(batch(Some(from), value));
        }
        let firsts = |kept: &Kept| -> Vec<Option<f64>> {
            kept.batches[&3].iter().step_by(2).map(|row| row[0]).collect()
        };
        assert_eq!(firsts(&kept), [Some(1.0), Some(2.0)]);
        // Told by two journals: once.
        kept.add(batch(Some(2), 2.0));
        // As written by versions that did not say.
        kept.add(batch(None, 3.0));
        assert_eq!(firsts(&kept), [Some(1.0), Some(2.0), Some(3.0)]);
        let line = serde_json::to_string(&batch(Some(4), 1.0)).unwrap();
        assert_eq!(Record::parse(&line).unwrap(), batch(Some(4), 1.0));
    }
}

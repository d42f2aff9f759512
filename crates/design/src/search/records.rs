//! Records of a search, and the state of an interrupted one.

use std::collections::HashMap;

use serde::{Deserialize, Serialize};

use super::Task;
use crate::exact;

/// Result of a task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SearchResult {
    /// Number of the task.
    pub task: usize,
    /// Index of the objective that the task improved.
    pub objective: usize,
    /// Best design that the task evaluated; empty if there is none.
    #[serde(with = "exact::numbers")]
    pub design: Vec<f64>,
    /// Quantities of this design.
    #[serde(with = "exact::values")]
    pub values: Vec<Option<f64>>,
    /// Number of evaluated designs; a design with its derivatives counts as one.
    pub evaluations: usize,
    /// Numbers of the evaluations at which a better feasible design was found.
    pub trace_at: Vec<usize>,
    /// Values of the objective at these evaluations.
    #[serde(with = "exact::numbers")]
    pub trace: Vec<f64>,
}

/// Quantities of consecutive designs of a population.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// Number of the task.
    pub population: usize,
    /// Number of designs of the population that precede these; missing in journals of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<usize>,
    /// Quantities of each design.
    #[serde(with = "exact::rows")]
    pub rows: Vec<Vec<Option<f64>>>,
}

/// Record of a running search: one line of a journal.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Record {
    /// Result of a finished task.
    Task(SearchResult),
    /// A finished generation of a population.
    Batch(Batch),
}

/// Records of an interrupted search, from which it is resumed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SearchRecords {
    pub(super) results: HashMap<usize, SearchResult>,
    pub(super) batches: HashMap<usize, Vec<Vec<Option<f64>>>>,
}

impl Record {
    /// Parses a line of a journal.
    ///
    /// # Errors
    /// If the line is not a record.
    pub fn parse(line: &str) -> Result<Self, serde_json::Error> {
        serde_json::from_str(line).map(Self::Batch).or_else(|_| serde_json::from_str(line).map(Self::Task))
    }
}

impl SearchRecords {
    /// Adds a record.
    ///
    /// Values of a population that are known already are ignored. Values after a gap are ignored, too,
    /// because they would be assigned to the wrong designs; they are computed again.
    pub fn add(&mut self, record: Record) {
        match record {
            Record::Task(result) => drop(self.results.insert(result.task, result)),
            Record::Batch(batch) => {
                let known = self.batches.entry(batch.population).or_default();
                let from = batch.from.unwrap_or(known.len());
                if let Some(duplicates) = known.len().checked_sub(from) {
                    known.extend(batch.rows.into_iter().skip(duplicates));
                }
            }
        }
    }

    /// Adds the records of another journal of the same search. Of each population, the longer sequence is
    /// used.
    pub fn join(&mut self, other: Self) {
        self.results.extend(other.results);
        for (population, rows) in other.batches {
            let known = self.batches.entry(population).or_default();
            if known.len() < rows.len() {
                *known = rows;
            }
        }
    }
}

impl SearchResult {
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

    /// Without the missing generation, the values would be assigned to the wrong designs.
    #[test]
    fn generation_after_a_gap_is_ignored() {
        let batch = |from: Option<usize>, value: f64| {
            Record::Batch(Batch { population: 3, from, rows: vec![vec![Some(value)], vec![None]] })
        };
        let mut records = SearchRecords::default();
        for (from, value) in [(0, 1.0), (4, 9.0), (2, 2.0)] {
            records.add(batch(Some(from), value));
        }
        let firsts = |records: &SearchRecords| -> Vec<Option<f64>> {
            records.batches[&3].iter().step_by(2).map(|row| row[0]).collect()
        };
        assert_eq!(firsts(&records), [Some(1.0), Some(2.0)]);
        // A record that occurs in two journals is added once.
        records.add(batch(Some(2), 2.0));
        // Journals of earlier versions have no `from`.
        records.add(batch(None, 3.0));
        assert_eq!(firsts(&records), [Some(1.0), Some(2.0), Some(3.0)]);
        let line = serde_json::to_string(&batch(Some(4), 1.0)).unwrap();
        assert_eq!(Record::parse(&line).unwrap(), batch(Some(4), 1.0));
    }
}

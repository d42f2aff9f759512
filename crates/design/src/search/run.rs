//! The tasks of a search side by side; what was found before is taken, what is new is told at once.

use std::collections::{BTreeMap, HashMap};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;

use papilio_display::DisplayError;
use papilio_scenario::SearchRange;
use serde::{Deserialize, Serialize};

use super::descent::descend;
use super::population::{evolve, members};
use super::scalar::Scalar;
use super::starts::best_of_drawn;
use super::{Search, Task, Way};
use crate::{DesignError, Evaluator, exact};

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
    found: HashMap<usize, Found>,
    batches: HashMap<usize, Vec<Vec<Option<f64>>>>,
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
    /// Takes a record.
    pub fn add(&mut self, record: Record) {
        match record {
            Record::Found(found) => drop(self.found.insert(found.task, found)),
            Record::Batch(batch) => self.batches.entry(batch.population).or_default().extend(batch.rows),
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

/// Who is told of every new record, and of how many tasks of its round are done, of how many.
pub type Tell<'a, E> = dyn FnMut(&Record, (usize, usize)) -> Result<(), E> + 'a;

impl Search {
    /// Runs the search, or what is left of it, on so many threads. `tell` gets every new record, the tasks of a round in any order;
    /// an error from it ends the search. All that was found, by task;
    /// `None` if the search was stopped.
    ///
    /// # Errors
    /// That of `tell`, or of the first task that fails.
    pub fn run<E: From<DesignError> + Send>(
        &self,
        evaluator: &Evaluator<'_>,
        threads: usize,
        kept: &Kept,
        tell: &mut Tell<'_, E>,
    ) -> Result<Option<Vec<Found>>, E> {
        let mut found: Vec<Found> = Vec::new();
        for round in 0.. {
            let tasks = self.round(round, &found);
            if tasks.is_empty() {
                break;
            }
            let Some(done) = self.side_by_side(&tasks, evaluator, threads, kept, tell)? else {
                return Ok(None);
            };
            found.extend(done);
        }
        Ok(Some(found))
    }

    fn side_by_side<E: From<DesignError> + Send>(
        &self,
        tasks: &[Task],
        evaluator: &Evaluator<'_>,
        threads: usize,
        kept: &Kept,
        tell: &mut Tell<'_, E>,
    ) -> Result<Option<Vec<Found>>, E> {
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (sender, receiver) = mpsc::channel::<Result<Record, DesignError>>();
        let known = tasks.iter().filter_map(|task| kept.found.get(&task.number));
        let mut done: BTreeMap<usize, Found> = known.map(|found| (found.task, found.clone())).collect();
        let left: Vec<&Task> = tasks.iter().filter(|task| !done.contains_key(&task.number)).collect();
        let mut failure: Option<E> = None;
        std::thread::scope(|scope| {
            for _ in 0..threads.clamp(1, left.len().max(1)) {
                let (sender, next, stop, left) = (sender.clone(), &next, &stop, &left);
                let mut evaluator = evaluator.worker();
                scope.spawn(move || {
                    while !stop.load(Ordering::Relaxed) {
                        let Some(task) = left.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
                        let known = kept.batches.get(&task.number).cloned().unwrap_or_default();
                        let found = self.pursue(task, &mut evaluator, known, &sender);
                        let failed = found.is_err();
                        drop(sender.send(found.map(Record::Found)));
                        if failed {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            for record in receiver {
                let told = record.map_err(E::from).and_then(|record| {
                    let so_far = done.len() + usize::from(matches!(record, Record::Found(_)));
                    tell(&record, (so_far, tasks.len())).map(|()| record)
                });
                match told {
                    Ok(Record::Found(found)) => drop(done.insert(found.task, found)),
                    Ok(Record::Batch(_)) => {}
                    Err(error) => {
                        stop.store(true, Ordering::Relaxed);
                        failure.get_or_insert(error);
                    }
                }
            }
        });
        match failure {
            Some(error) => Err(error),
            None => Ok((done.len() == tasks.len()).then(|| done.into_values().collect())),
        }
    }

    /// Does one task.
    fn pursue(
        &self,
        task: &Task,
        evaluator: &mut Evaluator<'_>,
        known: Vec<Vec<Option<f64>>>,
        sender: &mpsc::Sender<Result<Record, DesignError>>,
    ) -> Result<Found, DesignError> {
        let by_population = task.way == Way::Population;
        let generation = members(self.said.variables.len());
        let mut rows: Vec<Vec<Option<f64>>> = Vec::new();
        let mut tell = |values: &[Option<f64>]| {
            if !by_population {
                return;
            }
            rows.push(values.to_vec());
            if rows.len() == generation {
                let batch = Batch { population: task.number, rows: std::mem::take(&mut rows) };
                drop(sender.send(Ok(Record::Batch(batch))));
            }
        };
        let fixed = self.fixed(task);
        let scalar = Scalar::new(self, task, fixed, by_population, evaluator, known, &mut tell);
        let seed = self.said.seed;
        if scalar.free.is_empty() {
            scalar.cost(&[])?;
            return Ok(scalar.found());
        }
        match &task.way {
            Way::Population => evolve(&scalar, seed, task.evaluations)?,
            Way::From(design) => descend(&scalar, scalar.point(design), task.evaluations)?,
            Way::Start { start: 0, .. } => descend(&scalar, scalar.point(&self.own), task.evaluations)?,
            Way::Start { start, .. } => {
                let stream = self.stream(task);
                let point = best_of_drawn(&scalar, seed, stream, *start as u64)?;
                descend(&scalar, point, task.evaluations)?;
            }
        }
        Ok(scalar.found())
    }

    /// The values that a task does not change.
    fn fixed(&self, task: &Task) -> Vec<f64> {
        match &task.way {
            Way::Population => self.own.clone(),
            Way::From(design) => design.clone(),
            Way::Start { choices, .. } => {
                let mut choices = choices.iter();
                let variables = self.own.iter().zip(&self.said.variables);
                let value = |(own, variable): (&f64, &papilio_scenario::SearchVariable)| match variable.range
                {
                    SearchRange::Choices(_) => choices.next().map_or(*own, |choice| *choice as f64),
                    SearchRange::Bounds(..) => *own,
                };
                variables.map(value).collect()
            }
        }
    }

    /// Random numbers of a start: its own for each combination of choices.
    fn stream(&self, task: &Task) -> u64 {
        match &task.way {
            Way::Start { choices, .. } => {
                self.combinations.iter().position(|one| one == choices).unwrap_or(0) as u64
            }
            _ => 0,
        }
    }
}

/// True if a search that failed so was only stopped.
pub fn was_stopped(error: &DesignError) -> bool {
    matches!(error, DesignError::Display(DisplayError::Interrupted))
}

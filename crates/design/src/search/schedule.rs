//! Schedule of a search: the work items that can be computed now, and the results so far.
//!
//! A [`WorkItem`] and its [`WorkResult`] are plain data, which files and networks transmit without loss.
//! Every process that has the search computes the same result of an item ([`Search::work`]). A schedule can
//! therefore be shared by threads ([`SearchSchedule::run`]), by the workers of a cluster, or by machines that
//! do not communicate ([`SearchSchedule::shard`]).

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::population::Population;
use super::task_problem::{BestDesign, TaskProblem};
use super::{Batch, Record, Search, SearchRecords, SearchResult, Task, TaskMethod};
use crate::{DesignError, Evaluator, exact};

/// Unit of work of a search that is independent of all other open units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum WorkItem {
    /// A complete task.
    Task(Task),
    /// Designs of one generation of a population.
    Designs {
        /// The task.
        population: usize,
        /// Its evaluations before the first of them.
        from: usize,
        /// The designs.
        #[serde(with = "exact::rows_of_numbers")]
        designs: Vec<Vec<f64>>,
    },
}

/// Result of a work item.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum WorkResult {
    /// Result of a task.
    #[serde(rename = "Found")]
    Task(SearchResult),
    /// Quantities of designs of a population.
    Designs {
        /// The task.
        population: usize,
        /// Its evaluations before the first of them.
        from: usize,
        /// Quantities of each design.
        #[serde(with = "exact::rows")]
        values: Vec<Vec<Option<f64>>>,
    },
}

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchProgress {
    /// Number of finished tasks.
    pub done: usize,
    /// Number of tasks that are known: those of the current round and of the rounds before it.
    pub of: usize,
    /// Fraction of the search that is done, with rounds of equal length. It never decreases.
    pub fraction: f64,
}

/// State of a search: results, active populations and open work items.
#[derive(Debug)]
pub struct SearchSchedule {
    search: Arc<Search>,
    /// Records of an earlier run that are not used yet.
    records: SearchRecords,
    /// Number of work items for each generation.
    items_per_generation: usize,
    /// `(k, n)`: only shard k of n of the first round.
    shard: Option<(usize, usize)>,
    /// Current round, from 0.
    round: usize,
    tasks: Vec<Task>,
    /// Results of finished rounds.
    results: Vec<SearchResult>,
    /// Results of the current round, by task.
    done: BTreeMap<usize, SearchResult>,
    active: BTreeMap<usize, ActivePopulation>,
    open: VecDeque<WorkItem>,
    new_records: Vec<Record>,
    finished: bool,
}

/// Population that is being evaluated.
#[derive(Debug)]
struct ActivePopulation {
    task: Task,
    population: Population,
    best: BestDesign,
    /// Designs of the current generation.
    designs: Vec<Vec<f64>>,
    /// Quantities of the designs that are evaluated, by the number of the evaluation.
    values: BTreeMap<usize, Vec<Option<f64>>>,
}

impl Search {
    /// Computes a work item.
    ///
    /// # Errors
    /// If a design cannot be evaluated.
    pub fn work(&self, item: &WorkItem, evaluator: &mut Evaluator<'_>) -> Result<WorkResult, DesignError> {
        Ok(match item {
            WorkItem::Task(task) => WorkResult::Task(self.run_task(task, evaluator)?),
            WorkItem::Designs { population, from, designs } => WorkResult::Designs {
                population: *population,
                from: *from,
                values: designs.iter().map(|design| evaluator.evaluate(design)).collect::<Result<_, _>>()?,
            },
        })
    }
}

impl SearchSchedule {
    /// Creates the schedule of a search, resumed from `records` of an earlier run.
    ///
    /// Each generation of a population is divided into `items_per_generation` work items.
    pub fn new(search: Arc<Search>, records: SearchRecords, items_per_generation: usize) -> Self {
        Self::started(search, records, items_per_generation, None)
    }

    /// Creates the schedule of shard k of n of a search: tasks `k - 1`, `k - 1 + n` and so on of the first
    /// round, and no later round.
    pub fn shard(
        search: Arc<Search>,
        records: SearchRecords,
        items_per_generation: usize,
        (k, n): (usize, usize),
    ) -> Self {
        Self::started(search, records, items_per_generation, Some((k, n)))
    }

    fn started(
        search: Arc<Search>,
        records: SearchRecords,
        items_per_generation: usize,
        shard: Option<(usize, usize)>,
    ) -> Self {
        let mut schedule = Self {
            search,
            records,
            items_per_generation: items_per_generation.max(1),
            shard,
            round: 0,
            tasks: Vec::new(),
            results: Vec::new(),
            done: BTreeMap::new(),
            active: BTreeMap::new(),
            open: VecDeque::new(),
            new_records: Vec::new(),
            finished: false,
        };
        schedule.start_round();
        schedule
    }

    /// Returns the next work item.
    ///
    /// `None` if other items have to be finished first, or if the search is finished.
    pub fn next_item(&mut self) -> Option<WorkItem> {
        self.open.pop_front()
    }

    /// Stores the result of a work item. A result that arrives a second time is ignored.
    pub fn add_result(&mut self, result: WorkResult) {
        match result {
            WorkResult::Task(result) if self.tasks.iter().any(|task| task.number == result.task) => {
                if !self.done.contains_key(&result.task) {
                    self.finish_task(result, true);
                }
            }
            WorkResult::Task(_) => {}
            WorkResult::Designs { population, from, values } => {
                let Some(mut active) = self.active.remove(&population) else { return };
                let is_late = from < active.best.result.evaluations;
                let values = if is_late { Vec::new() } else { values };
                active.values.extend(values.into_iter().enumerate().map(|(index, row)| (from + index, row)));
                self.advance(population, active);
            }
        }
        self.finish_rounds();
    }

    /// The search.
    pub fn search(&self) -> Arc<Search> {
        Arc::clone(&self.search)
    }

    /// Returns the records that are new since the last call: lines of a journal.
    pub fn take_records(&mut self) -> Vec<Record> {
        std::mem::take(&mut self.new_records)
    }

    /// Progress over all rounds.
    pub fn progress(&self) -> SearchProgress {
        let rounds = if self.shard.is_some() { 1 } else { self.search.expected_rounds() };
        let round = self.done.len() as f64 / self.tasks.len().max(1) as f64;
        let fraction = (self.round as f64 + round) / rounds.max(self.round + 1) as f64;
        SearchProgress {
            done: self.results.len() + self.done.len(),
            of: self.results.len() + self.tasks.len(),
            fraction: if self.finished { 1.0 } else { fraction },
        }
    }

    /// Returns true if the search is finished.
    pub fn is_finished(&self) -> bool {
        self.finished
    }

    /// Results of all finished tasks, in order of their numbers, including those of the current round.
    pub fn results(&self) -> Vec<SearchResult> {
        self.results.iter().chain(self.done.values()).cloned().collect()
    }

    /// Starts the next round when all tasks of the current one are finished.
    fn finish_rounds(&mut self) {
        while !self.finished && self.done.len() == self.tasks.len() {
            self.results.extend(std::mem::take(&mut self.done).into_values());
            self.round += 1;
            self.start_round();
        }
    }

    /// Starts a round. Tasks with a stored result are finished at once.
    fn start_round(&mut self) {
        self.tasks = match self.shard {
            Some(_) if self.round > 0 => Vec::new(),
            _ => self.search.round(self.round, &self.results),
        };
        if let Some((k, n)) = self.shard {
            self.tasks.retain(|task| task.number % n == k - 1);
        }
        self.finished = self.tasks.is_empty();
        for task in self.tasks.clone() {
            if let Some(result) = self.records.results.remove(&task.number) {
                self.finish_task(result, false);
            } else if task.method == TaskMethod::Population && !self.search.own.is_empty() {
                self.start_population(task);
            } else {
                self.open.push_back(WorkItem::Task(task));
            }
        }
        self.finish_rounds();
    }

    fn finish_task(&mut self, result: SearchResult, is_new: bool) {
        self.new_records.extend(is_new.then(|| Record::Task(result.clone())));
        self.done.insert(result.task, result);
    }

    /// Starts a population from its stored generations.
    fn start_population(&mut self, task: Task) {
        let number = task.number;
        let point = TaskProblem::new(&self.search, &task).point(&self.search.own);
        let population = Population::new(point, self.search.spec.seed);
        let best = BestDesign::none(&task);
        let mut active =
            ActivePopulation { task, population, best, designs: Vec::new(), values: BTreeMap::new() };
        active.next_generation(&self.search);
        let mut stored = self.records.batches.remove(&number).unwrap_or_default().into_iter();
        while stored.len() >= active.designs.len() && !active.is_finished() {
            active.finish_generation(&self.search, stored.by_ref().take(active.designs.len()).collect());
        }
        if active.is_finished() {
            self.finish_task(active.best.result, true);
            return;
        }
        self.open_generation(number, &active);
        self.active.insert(number, active);
    }

    /// Starts the next generation if all designs of the current one are evaluated.
    fn advance(&mut self, number: usize, mut active: ActivePopulation) {
        let first = active.best.result.evaluations;
        let evaluated = active.values.range(first..first + active.designs.len()).count();
        if evaluated == active.designs.len() {
            let rows: Vec<_> = std::mem::take(&mut active.values).into_values().collect();
            self.new_records.push(Record::Batch(Batch {
                population: number,
                from: Some(first),
                rows: rows.clone(),
            }));
            active.finish_generation(&self.search, rows);
            if active.is_finished() {
                self.finish_task(active.best.result, true);
                return;
            }
            self.open_generation(number, &active);
        }
        self.active.insert(number, active);
    }

    /// Adds the designs of a generation to the open work items.
    fn open_generation(&mut self, population: usize, active: &ActivePopulation) {
        let size = active.designs.len().div_ceil(self.items_per_generation).max(1);
        let first = active.best.result.evaluations;
        for (index, designs) in active.designs.chunks(size).enumerate() {
            let from = first + index * size;
            self.open.push_back(WorkItem::Designs { population, from, designs: designs.to_vec() });
        }
    }
}

impl ActivePopulation {
    fn is_finished(&self) -> bool {
        self.best.result.evaluations >= self.task.evaluations.max(1)
    }

    /// Sets the designs of the next generation; the last one has as many as there are evaluations left.
    fn next_generation(&mut self, search: &Search) {
        let problem = TaskProblem::new(search, &self.task);
        let left = self.task.evaluations.max(1) - self.best.result.evaluations;
        let points = self.population.next_points();
        self.designs = points.iter().take(left).map(|point| problem.design(point)).collect();
    }

    /// Stores the quantities of the designs of the current generation.
    fn finish_generation(&mut self, search: &Search, rows: Vec<Vec<Option<f64>>>) {
        let problem = TaskProblem::new(search, &self.task);
        let costs = rows.iter().map(|values| problem.cost(values)).collect();
        for (design, values) in std::mem::take(&mut self.designs).into_iter().zip(&rows) {
            self.best.update(&problem, design, values);
        }
        if !self.is_finished() {
            self.population.set_costs(costs);
            self.next_generation(search);
        }
    }
}

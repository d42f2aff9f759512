//! The course of a search: which pieces of it can be done now, by whom and wherever; and what is known of it.
//!
//! A [`Piece`] is plain data, and so is its [`Answer`]: both go through files and wires without loss. Whoever has the
//! search does a piece ([`Search::work`]), and the answer is the same. So a course is shared by threads
//! ([`Search::run`]), by the workers of a cluster, or by machines that never hear of each other ([`Course::part`]).

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::population::Population;
use super::scalar::{Best, Problem};
use super::{Batch, Found, Kept, Record, Search, Task, Way};
use crate::{DesignError, Evaluator, exact};

/// A part of a search that needs no other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Piece {
    /// A task, from its beginning to its end.
    Task(Task),
    /// Designs of a population's generation.
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

/// What became of a piece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// What a task found.
    Found(Found),
    /// What designs of a population are worth.
    Designs {
        /// The task.
        population: usize,
        /// Its evaluations before the first of them.
        from: usize,
        /// The quantities of each.
        #[serde(with = "exact::rows")]
        values: Vec<Vec<Option<f64>>>,
    },
}

/// How far a search has come.
#[derive(Debug)]
pub struct Course {
    search: Arc<Search>,
    kept: Kept,
    /// Into how many pieces a generation is cut.
    cut: usize,
    /// Of so many parts of the first round, this one alone.
    part: Option<(usize, usize)>,
    /// The first round is 0.
    round: usize,
    tasks: Vec<Task>,
    /// Of the rounds that are over.
    found: Vec<Found>,
    /// Of this one.
    done: BTreeMap<usize, Found>,
    growing: BTreeMap<usize, Growing>,
    open: VecDeque<Piece>,
    news: Vec<Record>,
    over: bool,
}

/// A population on its way.
#[derive(Debug)]
struct Growing {
    task: Task,
    population: Population,
    best: Best,
    /// The generation that is being evaluated, and what is known of it.
    designs: Vec<Vec<f64>>,
    values: BTreeMap<usize, Vec<Option<f64>>>,
}

impl Search {
    /// Does a piece.
    ///
    /// # Errors
    /// If a design cannot be evaluated.
    pub fn work(&self, piece: &Piece, evaluator: &mut Evaluator<'_>) -> Result<Answer, DesignError> {
        Ok(match piece {
            Piece::Task(task) => Answer::Found(self.pursue(task, evaluator)?),
            Piece::Designs { population, from, designs } => Answer::Designs {
                population: *population,
                from: *from,
                values: designs.iter().map(|one| evaluator.evaluate(one)).collect::<Result<_, _>>()?,
            },
        })
    }
}

impl Course {
    /// A search from its beginning, or from what is `kept` of it; generations of populations in so many pieces.
    pub fn new(search: Arc<Search>, kept: Kept, cut: usize) -> Self {
        Self::begun(search, kept, cut, None)
    }

    /// Part `k` of `n` of a search's first round: its tasks `k - 1`, `k - 1 + n` and so on, and nothing that builds on them.
    pub fn part(search: Arc<Search>, kept: Kept, cut: usize, (k, n): (usize, usize)) -> Self {
        Self::begun(search, kept, cut, Some((k, n)))
    }

    fn begun(search: Arc<Search>, kept: Kept, cut: usize, part: Option<(usize, usize)>) -> Self {
        let mut course = Self {
            search,
            kept,
            cut: cut.max(1),
            part,
            round: 0,
            tasks: Vec::new(),
            found: Vec::new(),
            done: BTreeMap::new(),
            growing: BTreeMap::new(),
            open: VecDeque::new(),
            news: Vec::new(),
            over: false,
        };
        course.begin();
        course
    }

    /// A piece that nobody has yet; `None`: none until others are done, or the search is over.
    pub fn piece(&mut self) -> Option<Piece> {
        self.open.pop_front()
    }

    /// Takes what became of a piece.
    pub fn take(&mut self, answer: Answer) {
        match answer {
            // What is known already is not news, though it came twice.
            Answer::Found(found) if self.tasks.iter().any(|task| task.number == found.task) => {
                if !self.done.contains_key(&found.task) {
                    self.end(found, true);
                }
            }
            Answer::Found(_) => {}
            Answer::Designs { population, from, values } => {
                let Some(mut growing) = self.growing.remove(&population) else { return };
                let is_late = from < growing.best.found.evaluations;
                let values = if is_late { Vec::new() } else { values };
                growing.values.extend(values.into_iter().enumerate().map(|(at, one)| (from + at, one)));
                self.grow(population, growing);
            }
        }
        self.turn();
    }

    /// The search.
    pub fn search(&self) -> Arc<Search> {
        Arc::clone(&self.search)
    }

    /// What is new since this was asked last: lines of a journal.
    pub fn news(&mut self) -> Vec<Record> {
        std::mem::take(&mut self.news)
    }

    /// Tasks of this round that are done, and all of them.
    pub fn progress(&self) -> (usize, usize) {
        if self.over && self.tasks.is_empty() {
            return (self.found.len(), self.found.len());
        }
        (self.done.len(), self.tasks.len())
    }

    /// Whether nothing is left to do.
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// All that was found so far, by task; of the round that is going on, too.
    pub fn found(&self) -> Vec<Found> {
        self.found.iter().chain(self.done.values()).cloned().collect()
    }

    /// Ends the round if all of it is done.
    fn turn(&mut self) {
        while !self.over && self.done.len() == self.tasks.len() {
            self.found.extend(std::mem::take(&mut self.done).into_values());
            self.round += 1;
            self.begin();
        }
    }

    /// Begins a round; those that are known are over at once.
    fn begin(&mut self) {
        self.tasks = match self.part {
            Some(_) if self.round > 0 => Vec::new(),
            _ => self.search.round(self.round, &self.found),
        };
        if let Some((k, n)) = self.part {
            self.tasks.retain(|task| task.number % n == k - 1);
        }
        self.over = self.tasks.is_empty();
        for task in self.tasks.clone() {
            if let Some(found) = self.kept.found.remove(&task.number) {
                self.end(found, false);
            } else if task.way == Way::Population && !self.search.own.is_empty() {
                self.populate(task);
            } else {
                self.open.push_back(Piece::Task(task));
            }
        }
        self.turn();
    }

    fn end(&mut self, found: Found, is_new: bool) {
        self.news.extend(is_new.then(|| Record::Found(found.clone())));
        self.done.insert(found.task, found);
    }

    /// Begins a population, with what is known of it.
    fn populate(&mut self, task: Task) {
        let number = task.number;
        let point = Problem::new(&self.search, &task).point(&self.search.own);
        let population = Population::new(point, self.search.said.seed);
        let best = Best::none(&task);
        let mut growing = Growing { task, population, best, designs: Vec::new(), values: BTreeMap::new() };
        growing.ask(&self.search);
        let mut known = self.kept.batches.remove(&number).unwrap_or_default().into_iter();
        while known.len() >= growing.designs.len() && !growing.is_over() {
            growing.learn(&self.search, known.by_ref().take(growing.designs.len()).collect());
        }
        if growing.is_over() {
            self.end(growing.best.found, true);
            return;
        }
        self.give_out(number, &growing);
        self.growing.insert(number, growing);
    }

    /// Goes on by a generation, if all of this one is known.
    fn grow(&mut self, number: usize, mut growing: Growing) {
        let first = growing.best.found.evaluations;
        let known = growing.values.range(first..first + growing.designs.len()).count();
        if known == growing.designs.len() {
            let rows: Vec<_> = std::mem::take(&mut growing.values).into_values().collect();
            self.news.push(Record::Batch(Batch {
                population: number,
                from: Some(first),
                rows: rows.clone(),
            }));
            growing.learn(&self.search, rows);
            if growing.is_over() {
                self.end(growing.best.found, true);
                return;
            }
            self.give_out(number, &growing);
        }
        self.growing.insert(number, growing);
    }

    /// The designs of a generation, in pieces.
    fn give_out(&mut self, population: usize, growing: &Growing) {
        let size = growing.designs.len().div_ceil(self.cut).max(1);
        let first = growing.best.found.evaluations;
        for (at, designs) in growing.designs.chunks(size).enumerate() {
            let from = first + at * size;
            self.open.push_back(Piece::Designs { population, from, designs: designs.to_vec() });
        }
    }
}

impl Growing {
    fn is_over(&self) -> bool {
        self.best.found.evaluations >= self.task.evaluations.max(1)
    }

    /// Learns which designs the next generation has.
    fn ask(&mut self, search: &Search) {
        let problem = Problem::new(search, &self.task);
        self.designs = self.population.next().iter().map(|point| problem.design(point)).collect();
    }

    /// Takes what the designs of this generation are worth.
    fn learn(&mut self, search: &Search, rows: Vec<Vec<Option<f64>>>) {
        let problem = Problem::new(search, &self.task);
        let costs = rows.iter().map(|values| problem.cost(values)).collect();
        for (design, values) in std::mem::take(&mut self.designs).into_iter().zip(&rows) {
            self.best.see(&problem, design, values);
        }
        self.population.take(costs);
        if !self.is_over() {
            self.ask(search);
        }
    }
}

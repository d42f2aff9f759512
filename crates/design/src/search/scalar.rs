//! One task as an optimiser sees it: a number to make small, others to keep below 0, in the unit cube.

use std::cell::RefCell;

use papilio_scenario::{SearchRange, SearchVariable};

use super::{Aims, FEASIBLE, Found, Search, Task, Way};
use crate::{DesignError, Evaluator, Slopes};

/// What is worse than any design that can be.
const WORST: f64 = 1e12;

/// A task as numbers: designs of points of the unit cube, and how good they are.
pub(super) struct Problem<'a> {
    pub(super) search: &'a Search,
    pub(super) task: &'a Task,
    /// The variables that the optimiser moves.
    pub(super) free: Vec<usize>,
    /// What the others stay at.
    fixed: Vec<f64>,
}

/// What a task has found so far.
#[derive(Debug)]
pub(super) struct Best {
    pub(super) found: Found,
    /// By how much it misses its limits, and its merit.
    rank: (f64, f64),
}

/// A descent at work.
pub(super) struct Scalar<'a, 'stop> {
    pub(super) problem: Problem<'a>,
    work: RefCell<Work<'a, 'stop>>,
}

/// Where a descent's values come from, and the best of them.
struct Work<'a, 'stop> {
    evaluator: &'a mut Evaluator<'stop>,
    last: Option<(Vec<f64>, Slopes, bool)>,
    best: Best,
}

impl<'a> Problem<'a> {
    pub(super) fn new(search: &'a Search, task: &'a Task) -> Self {
        let choices_too = task.way == Way::Population;
        let is_free = |one: &SearchVariable| choices_too || matches!(one.range, SearchRange::Bounds(..));
        let variables = search.said.variables.iter().enumerate();
        let free = variables.filter(|(_, one)| is_free(one)).map(|(at, _)| at).collect();
        Self { search, task, free, fixed: search.fixed(task) }
    }

    fn aims(&self) -> &Aims {
        &self.search.aims
    }

    /// The design of a point of the unit cube.
    pub(super) fn design(&self, point: &[f64]) -> Vec<f64> {
        let mut design = self.fixed.clone();
        for (&at, u) in self.free.iter().zip(point) {
            design[at] = match &self.search.said.variables[at].range {
                SearchRange::Bounds(from, to) => (from + u * (to - from)).clamp(*from, *to),
                SearchRange::Choices(choices) => {
                    (u * choices.len() as f64).floor().min(choices.len() as f64 - 1.0).max(0.0)
                }
            };
        }
        design
    }

    /// The point of a design; choices in the middle of theirs.
    pub(super) fn point(&self, design: &[f64]) -> Vec<f64> {
        let coordinate = |at: &usize| match &self.search.said.variables[*at].range {
            SearchRange::Bounds(from, to) => (design[*at] - from) / (to - from),
            SearchRange::Choices(choices) => (design[*at] + 0.5) / choices.len() as f64,
        };
        self.free.iter().map(coordinate).collect()
    }

    /// Merit and misses of a design, the limits of the other objectives last.
    fn judged(&self, values: &[Option<f64>]) -> (f64, Vec<f64>) {
        let mut misses = self.aims().misses(values);
        let limits = self.task.limits.iter().enumerate();
        misses.extend(limits.filter_map(|(at, limit)| {
            limit.map(|limit| self.aims().merit(at, values).map_or(f64::INFINITY, |merit| merit - limit))
        }));
        (self.aims().merit(self.task.objective, values).unwrap_or(f64::INFINITY), misses)
    }

    /// One number that orders designs: those that meet their limits by merit, before all others by what they miss.
    pub(super) fn cost(&self, values: &[Option<f64>]) -> f64 {
        let (merit, misses) = self.judged(values);
        let missed = misses.into_iter().fold(0.0, f64::max);
        if missed <= FEASIBLE { merit.min(WORST) } else { (WORST * (1.0 + missed)).min(f64::MAX) }
    }

    /// The slopes of merit, and of the misses row by row.
    fn slopes(&self, Slopes { values, slopes }: &Slopes) -> (Vec<f64>, Vec<f64>) {
        let all = self.search.said.variables.len();
        let aims = self.aims();
        let of_limits = self.task.limits.iter().enumerate().filter(|(_, limit)| limit.is_some());
        let merit = aims.merit_slopes(self.task.objective, values, slopes, all);
        let mut misses = aims.miss_slopes(slopes, all);
        of_limits.for_each(|(at, _)| misses.extend(aims.merit_slopes(at, values, slopes, all)));
        let free = |row: &[f64]| self.free.iter().map(|&at| row[at] * self.width(at)).collect::<Vec<f64>>();
        (free(&merit), misses.chunks(all).flat_map(free).collect())
    }

    fn width(&self, variable: usize) -> f64 {
        match &self.search.said.variables[variable].range {
            SearchRange::Bounds(from, to) => to - from,
            SearchRange::Choices(_) => 0.0,
        }
    }

    /// How many numbers are to be kept below 0.
    pub(super) fn limits(&self) -> usize {
        self.aims().limits() + self.task.limits.iter().flatten().count()
    }
}

impl Best {
    pub(super) fn none(task: &Task) -> Self {
        Self { found: Found::none(task), rank: (f64::INFINITY, f64::INFINITY) }
    }

    /// Counts a design, and keeps it if it is the best so far: the one that misses its limits least, then the one of
    /// best merit.
    pub(super) fn see(&mut self, problem: &Problem<'_>, design: Vec<f64>, values: &[Option<f64>]) {
        self.found.evaluations += 1;
        let (merit, misses) = problem.judged(values);
        let missed = misses.into_iter().fold(0.0, f64::max);
        let missed = if missed <= FEASIBLE { 0.0 } else { missed };
        if (missed, merit) >= self.rank || merit.is_nan() {
            return;
        }
        self.rank = (missed, merit);
        let found = &mut self.found;
        found.design = design;
        found.values = values.to_vec();
        if missed == 0.0 && merit.is_finite() {
            found.trace_at.push(found.evaluations);
            found.trace.push(problem.aims().value(problem.task.objective, values).unwrap_or(merit));
        }
    }
}

impl<'a, 'stop> Scalar<'a, 'stop> {
    pub(super) fn new(search: &'a Search, task: &'a Task, evaluator: &'a mut Evaluator<'stop>) -> Self {
        let work = Work { evaluator, last: None, best: Best::none(task) };
        Self { problem: Problem::new(search, task), work: RefCell::new(work) }
    }

    /// What was found.
    pub(super) fn found(self) -> Found {
        self.work.into_inner().best.found
    }

    /// How many designs were evaluated so far.
    pub(super) fn evaluations(&self) -> usize {
        self.work.borrow().best.found.evaluations
    }

    /// Values and, if wanted, slopes at a point; what was asked last is known.
    fn look(&self, point: &[f64], slopes: bool) -> Result<Slopes, DesignError> {
        let design = self.problem.design(point);
        let mut work = self.work.borrow_mut();
        if let Some((at, known, has_slopes)) = &work.last
            && *at == design
            && (*has_slopes || !slopes)
        {
            return Ok(known.clone());
        }
        let new = if slopes {
            work.evaluator.derivatives(&design)?
        } else {
            Slopes { values: work.evaluator.evaluate(&design)?, slopes: Vec::new() }
        };
        work.last = Some((design.clone(), new.clone(), slopes));
        work.best.see(&self.problem, design, &new.values);
        Ok(new)
    }

    /// Merit and misses at a point.
    pub(super) fn value(&self, point: &[f64]) -> Result<(f64, Vec<f64>), DesignError> {
        Ok(self.problem.judged(&self.look(point, false)?.values))
    }

    /// One number that orders points.
    pub(super) fn cost(&self, point: &[f64]) -> Result<f64, DesignError> {
        Ok(self.problem.cost(&self.look(point, false)?.values))
    }

    /// The slopes of merit, and of the misses row by row, at a point.
    pub(super) fn slopes(&self, point: &[f64]) -> Result<(Vec<f64>, Vec<f64>), DesignError> {
        Ok(self.problem.slopes(&self.look(point, true)?))
    }
}

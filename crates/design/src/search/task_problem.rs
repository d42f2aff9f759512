//! Numerical problem of a task: an objective to minimise and constraints to keep below 0, in the unit cube.

use std::cell::RefCell;

use papilio_scenario::{SearchRange, SearchVariable};

use super::{Aims, FEASIBLE, Search, SearchResult, Task, TaskMethod};
use crate::{DesignError, Evaluator, Slopes};

/// Cost that exceeds the merit of every feasible design.
const WORST: f64 = 1e12;

/// TaskProblem of a task: the designs of points of the unit cube, their merits and violations.
pub(super) struct TaskProblem<'a> {
    pub(super) search: &'a Search,
    pub(super) task: &'a Task,
    /// Variables that the optimiser changes.
    pub(super) free: Vec<usize>,
    /// Values of all variables, of which the others keep theirs.
    fixed: Vec<f64>,
}

/// Best design of a task so far.
#[derive(Debug)]
pub(super) struct BestDesign {
    pub(super) result: SearchResult,
    /// Largest violation, and merit.
    rank: (f64, f64),
}

/// A running descent.
pub(super) struct DescentTask<'a, 'stop> {
    pub(super) problem: TaskProblem<'a>,
    work: RefCell<Work<'a, 'stop>>,
}

/// Evaluator of a descent, its last point and its best design.
struct Work<'a, 'stop> {
    evaluator: &'a mut Evaluator<'stop>,
    last: Option<(Vec<f64>, Slopes, bool)>,
    best: BestDesign,
}

impl<'a> TaskProblem<'a> {
    pub(super) fn new(search: &'a Search, task: &'a Task) -> Self {
        let choices_too = task.method == TaskMethod::Population;
        let is_free = |one: &SearchVariable| choices_too || matches!(one.range, SearchRange::Bounds(..));
        let variables = search.spec.variables.iter().enumerate();
        let free = variables.filter(|(_, one)| is_free(one)).map(|(variable, _)| variable).collect();
        Self { search, task, free, fixed: search.fixed(task) }
    }

    fn aims(&self) -> &Aims {
        &self.search.aims
    }

    /// Design of a point of the unit cube.
    pub(super) fn design(&self, point: &[f64]) -> Vec<f64> {
        let mut design = self.fixed.clone();
        for (&variable, u) in self.free.iter().zip(point) {
            design[variable] = match &self.search.spec.variables[variable].range {
                SearchRange::Bounds(from, to) => (from + u * (to - from)).clamp(*from, *to),
                SearchRange::Choices(choices) => {
                    (u * choices.len() as f64).floor().min(choices.len() as f64 - 1.0).max(0.0)
                }
            };
        }
        design
    }

    /// Point of a design; choices are at the centres of their intervals.
    pub(super) fn point(&self, design: &[f64]) -> Vec<f64> {
        let coordinate = |variable: &usize| match &self.search.spec.variables[*variable].range {
            SearchRange::Bounds(from, to) => (design[*variable] - from) / (to - from),
            SearchRange::Choices(choices) => (design[*variable] + 0.5) / choices.len() as f64,
        };
        self.free.iter().map(coordinate).collect()
    }

    /// Merit and violations of a design; those of the limits on other objectives are last.
    fn merit_and_violations(&self, values: &[Option<f64>]) -> (f64, Vec<f64>) {
        let mut violations = self.aims().violations(values);
        let limits = self.task.limits.iter().enumerate();
        violations.extend(limits.filter_map(|(objective, limit)| {
            limit.map(|limit| {
                self.aims().merit(objective, values).map_or(f64::INFINITY, |merit| merit - limit)
            })
        }));
        (self.aims().merit(self.task.objective, values).unwrap_or(f64::INFINITY), violations)
    }

    /// Cost that orders designs: feasible ones by merit, then all others by their largest violation.
    pub(super) fn cost(&self, values: &[Option<f64>]) -> f64 {
        let (merit, violations) = self.merit_and_violations(values);
        let missed = violations.into_iter().fold(0.0, f64::max);
        if missed <= FEASIBLE { merit.min(WORST) } else { (WORST * (1.0 + missed)).min(f64::MAX) }
    }

    /// Derivatives of the merit, and of the violations row by row.
    fn slopes(&self, Slopes { values, slopes }: &Slopes) -> (Vec<f64>, Vec<f64>) {
        let all = self.search.spec.variables.len();
        let aims = self.aims();
        let limited = self.task.limits.iter().enumerate().filter(|(_, limit)| limit.is_some());
        let merit = aims.merit_slopes(self.task.objective, values, slopes, all);
        let mut violations = aims.violation_slopes(slopes, all);
        limited
            .for_each(|(objective, _)| violations.extend(aims.merit_slopes(objective, values, slopes, all)));
        let free = |row: &[f64]| {
            self.free.iter().map(|&variable| row[variable] * self.width(variable)).collect::<Vec<f64>>()
        };
        (free(&merit), violations.chunks(all).flat_map(free).collect())
    }

    /// Width of the range of a variable.
    fn width(&self, variable: usize) -> f64 {
        match &self.search.spec.variables[variable].range {
            SearchRange::Bounds(from, to) => to - from,
            SearchRange::Choices(_) => 0.0,
        }
    }

    /// Number of violations to be kept below 0.
    pub(super) fn limits(&self) -> usize {
        self.aims().limits() + self.task.limits.iter().flatten().count()
    }
}

impl BestDesign {
    pub(super) fn none(task: &Task) -> Self {
        Self { result: SearchResult::none(task), rank: (f64::INFINITY, f64::INFINITY) }
    }

    /// Counts a design and stores it if it is the best so far: the one with the smallest violation, or of
    /// equal ones that with the best merit.
    pub(super) fn update(&mut self, problem: &TaskProblem<'_>, design: Vec<f64>, values: &[Option<f64>]) {
        self.result.evaluations += 1;
        let (merit, violations) = problem.merit_and_violations(values);
        let missed = violations.into_iter().fold(0.0, f64::max);
        let missed = if missed <= FEASIBLE { 0.0 } else { missed };
        if (missed, merit) >= self.rank || merit.is_nan() {
            return;
        }
        self.rank = (missed, merit);
        let result = &mut self.result;
        result.design = design;
        result.values = values.to_vec();
        if missed == 0.0 && merit.is_finite() {
            result.trace_at.push(result.evaluations);
            result.trace.push(problem.aims().value(problem.task.objective, values).unwrap_or(merit));
        }
    }
}

impl<'a, 'stop> DescentTask<'a, 'stop> {
    pub(super) fn new(search: &'a Search, task: &'a Task, evaluator: &'a mut Evaluator<'stop>) -> Self {
        let work = Work { evaluator, last: None, best: BestDesign::none(task) };
        Self { problem: TaskProblem::new(search, task), work: RefCell::new(work) }
    }

    /// Result of the task.
    pub(super) fn result(self) -> SearchResult {
        self.work.into_inner().best.result
    }

    /// Number of designs evaluated so far.
    pub(super) fn evaluations(&self) -> usize {
        self.work.borrow().best.result.evaluations
    }

    /// Evaluates a point, with derivatives if requested. The last point is stored.
    fn evaluate(&self, point: &[f64], slopes: bool) -> Result<Slopes, DesignError> {
        let design = self.problem.design(point);
        let mut work = self.work.borrow_mut();
        if let Some((last, known, has_slopes)) = &work.last
            && *last == design
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
        work.best.update(&self.problem, design, &new.values);
        Ok(new)
    }

    /// Merit and violations at a point.
    pub(super) fn value(&self, point: &[f64]) -> Result<(f64, Vec<f64>), DesignError> {
        Ok(self.problem.merit_and_violations(&self.evaluate(point, false)?.values))
    }

    /// Cost of a point.
    pub(super) fn cost(&self, point: &[f64]) -> Result<f64, DesignError> {
        Ok(self.problem.cost(&self.evaluate(point, false)?.values))
    }

    /// Derivatives of the merit, and of the violations row by row, at a point.
    pub(super) fn slopes(&self, point: &[f64]) -> Result<(Vec<f64>, Vec<f64>), DesignError> {
        Ok(self.problem.slopes(&self.evaluate(point, true)?))
    }
}

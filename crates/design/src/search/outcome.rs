//! What a search came to: the best design, or the front, as they are handed on.

use papilio_display::result::RunResult;
use papilio_scenario::SearchRange;

use super::{FEASIBLE, Found, Search, Way, front};
use crate::{DesignError, Evaluator};

/// Digits that designs are handed on with: far finer than anything is made.
const DIGITS: usize = 7;

/// A design that a search hands on.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Its numbers, rounded.
    pub design: Vec<f64>,
    /// What it is worth, from full runs of its scenarios; `None` where that is not defined.
    pub values: Vec<Option<f64>>,
    /// How far it misses its limits, relative; at most [`FEASIBLE`] and what rounding does if it meets them.
    pub missed: f64,
    /// The task that found it.
    pub task: usize,
}

impl Chosen {
    /// True if it meets its limits, to what rounding does.
    pub fn meets_limits(&self) -> bool {
        self.missed <= 100.0 * FEASIBLE
    }
}

impl Search {
    /// The best design of one objective, or the front of several, run in full; where nothing meets the limits, what misses them least.
    ///
    /// # Errors
    /// If a design cannot be computed.
    pub fn chosen(&self, found: &[Found], evaluator: &mut Evaluator<'_>) -> Result<Vec<Chosen>, DesignError> {
        let front = front(&self.aims, found);
        let front = self.thinned(front, found);
        let numbers = if front.is_empty() {
            let missed = |at: &usize| self.aims.missed(&found[*at].values);
            let some = (0..found.len()).filter(|at| !found[*at].design.is_empty());
            some.min_by(|a, b| missed(a).total_cmp(&missed(b))).into_iter().collect()
        } else {
            front
        };
        numbers.into_iter().map(|at| self.in_full(&found[at], evaluator)).collect()
    }

    /// How many descents ended because their share of the evaluations was used up, and how many descents there were.
    pub fn cut_short(&self, found: &[Found]) -> (usize, usize) {
        let (mut cut, mut descents, mut done) = (0, 0, 0);
        // Choices alone are tried, not descended.
        if !self.said.variables.iter().any(|one| matches!(one.range, SearchRange::Bounds(..))) {
            return (0, 0);
        }
        for round in 0.. {
            let tasks = self.round(round, &found[..done.min(found.len())]);
            if tasks.is_empty() || done >= found.len() {
                break;
            }
            let own = tasks.iter().zip(&found[done..]).filter(|(task, _)| task.way != Way::Population);
            for (task, one) in own {
                descents += 1;
                cut += usize::from(one.evaluations >= task.evaluations);
            }
            done += tasks.len();
        }
        (cut, descents)
    }

    /// A front without designs that hardly differ from the one before; its ends stay.
    fn thinned(&self, front: Vec<usize>, found: &[Found]) -> Vec<usize> {
        let merits = |at: usize| -> Vec<f64> {
            let of = |objective| self.aims.merit(objective, &found[at].values).unwrap_or(f64::NAN);
            (0..self.aims.objectives()).map(of).collect()
        };
        let Some((&first, &last)) = front.first().zip(front.last()) else { return front };
        let apart = |one: usize, other: usize| -> f64 {
            let each =
                merits(one).into_iter().zip(merits(other)).zip(merits(first).into_iter().zip(merits(last)));
            each.map(|((a, b), (from, to))| (a - b).abs() / (to - from).abs().max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max)
        };
        let least = 0.5 / self.said.points as f64;
        let mut kept = vec![first];
        for at in front {
            let before = kept[kept.len() - 1];
            if at == last && at != first && kept.len() > 1 && apart(at, before) < least {
                kept.pop();
            }
            if at != first && (at == last || apart(at, before) >= least) {
                kept.push(at);
            }
        }
        kept
    }

    fn in_full(&self, found: &Found, evaluator: &mut Evaluator<'_>) -> Result<Chosen, DesignError> {
        let design = self.rounded(&found.design);
        let values = self.values_of(&self.runs(&design, evaluator)?);
        let missed = self.aims.missed(&values);
        Ok(Chosen { design, values, missed, task: found.task })
    }

    /// A design with a few digits, within its bounds.
    fn rounded(&self, design: &[f64]) -> Vec<f64> {
        let each = design.iter().zip(&self.said.variables);
        each.map(|(x, variable)| match variable.range {
            SearchRange::Bounds(from, to) => {
                let short = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(*x);
                if (from..=to).contains(&short) { short } else { *x }
            }
            SearchRange::Choices(_) => *x,
        })
        .collect()
    }

    /// The results of a design under each condition.
    ///
    /// # Errors
    /// As of a run.
    pub fn runs(&self, design: &[f64], evaluator: &mut Evaluator<'_>) -> Result<Vec<RunResult>, DesignError> {
        (0..self.study.conditions.len()).map(|condition| evaluator.run(design, condition)).collect()
    }

    /// What is asked, of the results under each condition.
    pub fn values_of(&self, results: &[RunResult]) -> Vec<Option<f64>> {
        self.study.quantities.iter().map(|one| one.quantity.of(&results[one.condition])).collect()
    }
}

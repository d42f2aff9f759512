//! Selected designs of a search: the best design, or the designs of the front.

use papilio_display::result::RunResult;
use papilio_scenario::SearchRange;

use super::{FEASIBLE, Search, SearchResult, TaskMethod, front};
use crate::{DesignError, Evaluator};

/// Significant digits of selected designs: far finer than manufacturing tolerances.
const DIGITS: usize = 7;

/// Design that a search selects as a result.
#[derive(Debug, Clone, PartialEq)]
pub struct SelectedDesign {
    /// Rounded numbers of the design.
    pub design: Vec<f64>,
    /// Quantities from full runs of its scenarios; `None` where undefined.
    pub values: Vec<Option<f64>>,
    /// Largest relative violation of the constraints; for a feasible design at most [`FEASIBLE`], plus the
    /// effect of rounding.
    pub missed: f64,
    /// Number of the task that found it.
    pub task: usize,
}

impl SelectedDesign {
    /// Returns true if the design satisfies the constraints, up to the effect of rounding.
    pub fn meets_limits(&self) -> bool {
        self.missed <= 100.0 * FEASIBLE
    }
}

impl Search {
    /// Selects the best design of one objective, or the front of several, and computes them in full.
    ///
    /// If no design satisfies the constraints, selects the one with the smallest violation.
    ///
    /// # Errors
    /// If a design cannot be computed.
    pub fn selected(
        &self,
        results: &[SearchResult],
        evaluator: &mut Evaluator<'_>,
    ) -> Result<Vec<SelectedDesign>, DesignError> {
        let front = front(&self.aims, results);
        let front = self.thinned(front, results);
        let indices = if front.is_empty() {
            let missed = |index: &usize| self.aims.missed(&results[*index].values);
            let valid = (0..results.len()).filter(|index| !results[*index].design.is_empty());
            valid.min_by(|a, b| missed(a).total_cmp(&missed(b))).into_iter().collect()
        } else {
            front
        };
        indices.into_iter().map(|index| self.in_full(&results[index], evaluator)).collect()
    }

    /// Number of descents that used up their evaluations, and number of all descents.
    pub fn cut_short(&self, results: &[SearchResult]) -> (usize, usize) {
        let (mut cut, mut descents, mut done) = (0, 0, 0);
        // Without numeric variables, there are no descents.
        if !self.spec.variables.iter().any(|one| matches!(one.range, SearchRange::Bounds(..))) {
            return (0, 0);
        }
        for round in 0.. {
            let tasks = self.round(round, &results[..done.min(results.len())]);
            if tasks.is_empty() || done >= results.len() {
                break;
            }
            let own =
                tasks.iter().zip(&results[done..]).filter(|(task, _)| task.method != TaskMethod::Population);
            for (task, one) in own {
                descents += 1;
                cut += usize::from(one.evaluations >= task.evaluations);
            }
            done += tasks.len();
        }
        (cut, descents)
    }

    /// Removes designs of a front that hardly differ from the one before. The ends remain.
    fn thinned(&self, front: Vec<usize>, results: &[SearchResult]) -> Vec<usize> {
        let merits = |index: usize| -> Vec<f64> {
            let merit = |objective| self.aims.merit(objective, &results[index].values).unwrap_or(f64::NAN);
            (0..self.aims.objectives()).map(merit).collect()
        };
        let Some((&first, &last)) = front.first().zip(front.last()) else { return front };
        let distance = |one: usize, other: usize| -> f64 {
            let each =
                merits(one).into_iter().zip(merits(other)).zip(merits(first).into_iter().zip(merits(last)));
            each.map(|((a, b), (from, to))| (a - b).abs() / (to - from).abs().max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max)
        };
        let least = 0.5 / self.spec.points as f64;
        let mut thinned = vec![first];
        for index in front {
            let before = thinned[thinned.len() - 1];
            if index == last && index != first && thinned.len() > 1 && distance(index, before) < least {
                thinned.pop();
            }
            if index != first && (index == last || distance(index, before) >= least) {
                thinned.push(index);
            }
        }
        thinned
    }

    /// Rounds the design of a result and computes it in full.
    fn in_full(
        &self,
        result: &SearchResult,
        evaluator: &mut Evaluator<'_>,
    ) -> Result<SelectedDesign, DesignError> {
        let design = self.rounded(&result.design);
        let of_runs = self.values_of(&self.runs(&design, evaluator)?);
        let values = of_runs.into_iter().zip(evaluator.of_pixels(&design)?);
        let values: Vec<Option<f64>> = values.map(|(of_run, of_pixels)| of_run.or(of_pixels)).collect();
        let missed = self.aims.missed(&values);
        Ok(SelectedDesign { design, values, missed, task: result.task })
    }

    /// Rounds a design to [`DIGITS`] significant digits, within its bounds.
    fn rounded(&self, design: &[f64]) -> Vec<f64> {
        let each = design.iter().zip(&self.spec.variables);
        each.map(|(x, variable)| match variable.range {
            SearchRange::Bounds(from, to) => {
                let short = format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(*x);
                if (from..=to).contains(&short) { short } else { *x }
            }
            SearchRange::Choices(_) => *x,
        })
        .collect()
    }

    /// Computes the results of a design under each condition.
    ///
    /// # Errors
    /// Those of [`Evaluator::run`].
    pub fn runs(&self, design: &[f64], evaluator: &mut Evaluator<'_>) -> Result<Vec<RunResult>, DesignError> {
        (0..self.study.conditions.len()).map(|condition| evaluator.run(design, condition)).collect()
    }

    /// Quantities of the study from the results under each condition.
    pub fn values_of(&self, results: &[RunResult]) -> Vec<Option<f64>> {
        self.study.quantities.iter().map(|one| one.quantity.of(&results[one.condition])).collect()
    }
}

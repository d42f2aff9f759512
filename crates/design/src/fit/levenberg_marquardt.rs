//! Levenberg-Marquardt method within the unit cube.
//!
//! A step minimises the linear residuals within the cube (`bounded`). The Jacobian is renewed by differences where the last step was not predicted well, and otherwise by Broyden's
//! rank-one formula, which needs no evaluation.

use super::bounded::step;
use super::problem::Problem;
use crate::DesignError;

/// Most iterations of a descent.
const ITERATIONS: usize = 100;
/// Remaining decrease of chi-square at which a descent has converged: small compared with 1, by which one
/// standard error changes it.
const DECREASE: f64 = 1e-4;
/// The same relative to chi-square.
const RELATIVE_DECREASE: f64 = 1e-9;
/// Damping of the step that decides about convergence: a direction in which the effects of the variables cancel to 1e-4,
/// the errors of the derivatives, does not count.
const LEAST_DAMPING: f64 = 1e-8;
/// Damping at which steps are too short for a change.
const MOST_DAMPING: f64 = 1e12;
/// Predicted decrease of chi-square that may be the noise of the residuals, where no step decreases it.
const NOISE: f64 = 0.1;
/// Steps whose actual decrease is within this factor of the predicted one do not need new derivatives.
const WELL_PREDICTED: f64 = 0.25;

/// End of a descent.
#[derive(Debug, Clone)]
pub(super) struct Minimum {
    pub(super) point: Vec<f64>,
    /// Sum of the squared residuals.
    pub(super) chi_square: f64,
    pub(super) residuals: Vec<f64>,
    /// Columns of the Jacobian.
    pub(super) jacobian: Vec<Vec<f64>>,
    pub(super) has_converged: bool,
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Descends from a point; the coordinates of `held` stay. With `jacobian`, an approximate Jacobian at the
/// start is known, and the Jacobian at the end may be approximate, too. `None` if the residuals are not defined at the start.
pub(super) fn descend(
    problem: &mut Problem<'_, '_>,
    start: &[f64],
    held: &[bool],
    jacobian: Option<Vec<Vec<f64>>>,
) -> Result<Option<Minimum>, DesignError> {
    let Some(residuals) = problem.residuals(start)? else { return Ok(None) };
    let is_constrained = jacobian.is_some();
    let mut is_exact = !is_constrained;
    let jacobian = match jacobian {
        Some(known) => known,
        None => match problem.jacobian(start)? {
            Some(columns) => columns,
            None => return Ok(None),
        },
    };
    let chi_square = dot(&residuals, &residuals);
    let mut now = Minimum { point: start.to_vec(), chi_square, residuals, jacobian, has_converged: false };
    let (mut damping, mut growth) = (1e-3, 2.0);
    for _ in 0..ITERATIONS {
        let enough = DECREASE.max(RELATIVE_DECREASE * now.chi_square);
        let undamped = now.step(held, LEAST_DAMPING);
        let decrease = undamped.as_ref().map_or(0.0, |step| now.predicted_decrease(step));
        let largest = undamped.iter().flatten().fold(0.0_f64, |most, step| most.max(step.abs()));
        if decrease <= enough || largest < 1e-9 {
            if is_exact || is_constrained {
                now.has_converged = true;
                break;
            }
            let Some(columns) = problem.jacobian(&now.point)? else { break };
            (now.jacobian, is_exact) = (columns, true);
            continue;
        }
        let Some(step) = now.step(held, damping) else {
            damping *= 10.0;
            continue;
        };
        let predicted = now.predicted_decrease(&step);
        let point: Vec<f64> = now.point.iter().zip(&step).map(|(u, by)| (u + by).clamp(0.0, 1.0)).collect();
        let residuals = problem.residuals(&point)?;
        let chi_square = residuals.as_ref().map_or(f64::INFINITY, |residuals| dot(residuals, residuals));
        let ratio = (now.chi_square - chi_square) / predicted;
        let needs_new = match residuals.filter(|_| chi_square < now.chi_square) {
            Some(residuals) => {
                now.broyden(&step, &residuals);
                (now.point, now.chi_square, now.residuals) = (point, chi_square, residuals);
                damping = (damping * (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0)).max(1e-12);
                growth = 2.0;
                is_exact = false;
                (ratio - 1.0).abs() > WELL_PREDICTED
            }
            None => {
                damping *= growth;
                growth *= 2.0;
                !is_exact
            }
        };
        if needs_new {
            let Some(columns) = problem.jacobian(&now.point)? else { break };
            (now.jacobian, is_exact) = (columns, true);
        }
        if damping > MOST_DAMPING {
            // Not even the shortest steps along exact derivatives improve more than the noise of the residuals.
            now.has_converged =
                is_exact && chi_square.is_finite() && decrease <= NOISE.max(1e-3 * now.chi_square);
            break;
        }
    }
    Ok(Some(now))
}

impl Minimum {
    /// Step of all coordinates but the held ones within the cube, with a damping relative to the diagonal.
    fn step(&self, held: &[bool], damping: f64) -> Option<Vec<f64>> {
        step(&self.jacobian, &self.residuals, &self.point, held, damping)
    }

    /// Decrease of chi-square that the Jacobian predicts of a step.
    fn predicted_decrease(&self, step: &[f64]) -> f64 {
        let moved = self.moved(step);
        self.chi_square - dot(&moved, &moved)
    }

    /// Residuals that the Jacobian predicts after a step.
    pub(super) fn moved(&self, step: &[f64]) -> Vec<f64> {
        let mut moved = self.residuals.clone();
        for (column, by) in self.jacobian.iter().zip(step).filter(|(_, by)| **by != 0.0) {
            moved.iter_mut().zip(column).for_each(|(residual, slope)| *residual += slope * by);
        }
        moved
    }

    /// Broyden's update by the residuals after a step.
    fn broyden(&mut self, step: &[f64], after: &[f64]) {
        let length = dot(step, step);
        if length == 0.0 {
            return;
        }
        let errors: Vec<f64> =
            after.iter().zip(self.moved(step)).map(|(found, moved)| found - moved).collect();
        for (column, by) in self.jacobian.iter_mut().zip(step).filter(|(_, by)| **by != 0.0) {
            column.iter_mut().zip(&errors).for_each(|(slope, error)| *slope += error * by / length);
        }
    }
}

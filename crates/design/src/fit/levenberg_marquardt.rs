//! Levenberg-Marquardt method within the unit cube.
//!
//! Steps are clamped to the cube; a coordinate at a bound that would leave it is held for one iteration. The
//! Jacobian is renewed by differences where the last step was not predicted well, and otherwise by Broyden's
//! rank-one formula, which needs no evaluation.

use super::matrix::solve;
use super::problem::Problem;
use crate::DesignError;

/// Most iterations of a descent.
const ITERATIONS: usize = 100;
/// Remaining decrease of chi-square at which a descent has converged: small compared with 1, by which one
/// standard error changes it.
const DECREASE: f64 = 1e-4;
/// The same relative to chi-square.
const RELATIVE_DECREASE: f64 = 1e-9;
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
        let free = free(&now, held);
        let normal = Normal::of(&now, &free);
        let enough = DECREASE.max(RELATIVE_DECREASE * now.chi_square);
        let undamped = normal.step(1e-12).map(|step| now.clamped(&free, &step));
        let decrease = undamped.as_ref().map_or(0.0, |step| now.predicted_decrease(step));
        let largest = undamped.iter().flatten().fold(0.0_f64, |most, step| most.max(step.abs()));
        if free.is_empty() || (decrease <= enough || largest < 1e-9) {
            if is_exact || is_constrained {
                now.has_converged = true;
                break;
            }
            let Some(columns) = problem.jacobian(&now.point)? else { break };
            (now.jacobian, is_exact) = (columns, true);
            continue;
        }
        let Some(step) = normal.step(damping).map(|step| now.clamped(&free, &step)) else {
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
        if damping > 1e12 {
            break;
        }
    }
    Ok(Some(now))
}

/// Coordinates that may move: not held, and not at a bound that they would leave.
fn free(now: &Minimum, held: &[bool]) -> Vec<usize> {
    let is_free = |k: &usize| {
        let slope = dot(&now.jacobian[*k], &now.residuals);
        let leaves = now.point[*k] <= 0.0 && slope > 0.0 || now.point[*k] >= 1.0 && slope < 0.0;
        !held[*k] && !leaves && now.jacobian[*k].iter().any(|one| *one != 0.0)
    };
    (0..now.point.len()).filter(is_free).collect()
}

/// Normal equations of the free coordinates.
struct Normal {
    matrix: Vec<f64>,
    slopes: Vec<f64>,
}

impl Normal {
    fn of(now: &Minimum, free: &[usize]) -> Self {
        let pairs = free.iter().flat_map(|i| free.iter().map(move |k| (*i, *k)));
        Self {
            matrix: pairs.map(|(i, k)| dot(&now.jacobian[i], &now.jacobian[k])).collect(),
            slopes: free.iter().map(|i| -dot(&now.jacobian[*i], &now.residuals)).collect(),
        }
    }

    /// Step with a damping relative to the diagonal.
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let n = self.slopes.len();
        let mut matrix = self.matrix.clone();
        (0..n).for_each(|i| matrix[i * n + i] *= 1.0 + damping);
        solve(&matrix, &self.slopes)
    }
}

impl Minimum {
    /// Step of all coordinates that stays in the cube.
    fn clamped(&self, free: &[usize], step: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; self.point.len()];
        for (&k, by) in free.iter().zip(step) {
            all[k] = (self.point[k] + by).clamp(0.0, 1.0) - self.point[k];
        }
        all
    }

    /// Decrease of chi-square that the Jacobian predicts of a step.
    fn predicted_decrease(&self, step: &[f64]) -> f64 {
        let moved = self.moved(step);
        self.chi_square - dot(&moved, &moved)
    }

    /// Residuals that the Jacobian predicts after a step.
    fn moved(&self, step: &[f64]) -> Vec<f64> {
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

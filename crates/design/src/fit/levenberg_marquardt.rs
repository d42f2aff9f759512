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
/// Predicted decrease of chi-square that may be the error of derivatives along a flat direction, where no step decreases it. If it
/// is not, the search for intervals finds the better minimum.
const NOISE: f64 = 2.0;
/// Decrease in [`LAST`] iterations after which a descent has arrived where its iterations end.
const ARRIVED: f64 = 0.3;
/// Iterations after which steps follow the curvature of a valley.
const CURVED: usize = 12;
/// Number of iterations whose decrease together decides whether a descent has arrived.
const LAST: usize = 10;
/// Decrease in these iterations, relative to chi-square, at which it has.
const LAST_DECREASE: f64 = 1e-6 * LAST as f64;
/// Part of a step by which the residuals are moved for their curvature along it.
const PART: f64 = 0.1;
/// Longest curved part of a step, relative to the straight one.
const LONGEST_CURVE: f64 = 0.75;
/// Step of derivatives, in widths of the bounds.
const STEP: f64 = 1e-4;
/// The same where the shorter one gives derivatives along which nothing improves.
const WIDE_STEP: f64 = 2e-3;
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
        None => match problem.jacobian(start, STEP)? {
            Some(columns) => columns,
            None => return Ok(None),
        },
    };
    let chi_square = dot(&residuals, &residuals);
    let mut now = Minimum { point: start.to_vec(), chi_square, residuals, jacobian, has_converged: false };
    let (mut damping, mut growth, mut width) = (1e-3, 2.0, STEP);
    let mut passed: Vec<f64> = Vec::with_capacity(ITERATIONS);
    for iteration in 0..ITERATIONS {
        passed.push(now.chi_square);
        let enough = DECREASE.max(RELATIVE_DECREASE * now.chi_square);
        let undamped = now.step(held, LEAST_DAMPING);
        let decrease = undamped.as_ref().map_or(0.0, |step| now.predicted_decrease(step));
        let is_small = decrease <= NOISE.max(1e-3 * now.chi_square);
        if is_exact && is_small && now.decrease_since(&passed) <= LAST_DECREASE * now.chi_square {
            now.has_converged = true;
            break;
        }
        let largest = undamped.iter().flatten().fold(0.0_f64, |most, step| most.max(step.abs()));
        if decrease <= enough || largest < 1e-9 {
            if is_exact || is_constrained {
                now.has_converged = true;
                break;
            }
            let Some(columns) = problem.jacobian(&now.point, width)? else { break };
            (now.jacobian, is_exact) = (columns, true);
            continue;
        }
        let Some(step) = now.step(held, damping) else {
            damping *= 10.0;
            continue;
        };
        let predicted = now.predicted_decrease(&step);
        let is_curved = iteration >= CURVED && is_exact;
        let step = if is_curved { now.curved(problem, held, damping, step)? } else { step };
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
                iteration >= CURVED || (ratio - 1.0).abs() > WELL_PREDICTED
            }
            None => {
                damping *= growth;
                growth *= 2.0;
                !is_exact
            }
        };
        if needs_new {
            let Some(columns) = problem.jacobian(&now.point, width)? else { break };
            (now.jacobian, is_exact) = (columns, true);
        }
        if damping > MOST_DAMPING {
            // Not even the shortest steps along exact derivatives improve more than the noise of the residuals.
            now.has_converged = is_exact && chi_square.is_finite() && is_small;
            if now.has_converged || width > STEP {
                break;
            }
            // A small jump of the residuals spoils derivatives over a short distance.
            width = WIDE_STEP;
            let Some(columns) = problem.jacobian(&now.point, width)? else { break };
            (now.jacobian, is_exact, damping, growth) = (columns, true, 1e-3, 2.0);
        }
    }
    now.has_converged |= passed.len() == ITERATIONS && now.decrease_since(&passed) <= ARRIVED;
    Ok(Some(now))
}

impl Minimum {
    /// Step of all coordinates but the held ones within the cube, with a damping relative to the diagonal.
    fn step(&self, held: &[bool], damping: f64) -> Option<Vec<f64>> {
        step(&self.jacobian, &self.residuals, &self.point, held, damping)
    }

    /// Decrease of chi-square in the last iterations; infinite if there were fewer.
    fn decrease_since(&self, passed: &[f64]) -> f64 {
        let before = passed.len().checked_sub(LAST + 1).map(|at| passed[at]);
        before.map_or(f64::INFINITY, |before| before - self.chi_square)
    }

    /// A step along the curve on which the residuals stay where the straight one would lead them: half of the step that
    /// cancels their second derivative along it (geodesic acceleration: M. K. Transtrum and J. P. Sethna, arXiv:1201.5885).
    fn curved(
        &self,
        problem: &mut Problem<'_, '_>,
        held: &[bool],
        damping: f64,
        straight: Vec<f64>,
    ) -> Result<Vec<f64>, DesignError> {
        let moved = |by: f64| -> Vec<f64> {
            self.point.iter().zip(&straight).map(|(u, step)| (u + by * step).clamp(0.0, 1.0)).collect()
        };
        let Some(near) = problem.residuals(&moved(PART))? else { return Ok(straight) };
        let linear = self.moved(&straight);
        let second: Vec<f64> = near
            .iter()
            .zip(&self.residuals)
            .zip(&linear)
            .map(|((near, here), linear)| 2.0 / PART * ((near - here) / PART - (linear - here)))
            .collect();
        let Some(curve) = step(&self.jacobian, &second, &moved(1.0), held, damping) else {
            return Ok(straight);
        };
        let is_short = dot(&curve, &curve).sqrt() <= LONGEST_CURVE * dot(&straight, &straight).sqrt();
        let both = straight.iter().zip(&curve).map(|(straight, curve)| straight + 0.5 * curve);
        Ok(if is_short { both.collect() } else { straight })
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

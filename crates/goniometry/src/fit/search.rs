//! Least-squares search with the crate `basin`.
//!
//! The crate decomposes the Jacobian at each step, which is slow for ten thousand cells. All quantities of a
//! step, `J^T J`, `J^T r` and `|r|`, are invariant under a rotation of the residuals' space. The crate is
//! therefore given `n + 1` residuals: the components along the derivatives, and the length of the remainder.

use std::convert::Infallible;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction, DenseMatrix, Executor,
    Jacobian, Residual, TrustRegionReflective,
};

use super::problem::{Problem, dot};
use crate::models::Meaning;

/// Tolerance of scaled gradients; residuals are relative to the data, parameters are logarithms.
const GRADIENT: f64 = 1e-15;
/// Tolerance of relative steps.
const STEP: f64 = 1e-13;
const ITERATIONS: u64 = 200;

/// Result of a search.
pub(super) struct End {
    pub(super) values: Vec<f64>,
    /// Half the sum of the squared residuals, relative to that of the data.
    pub(super) cost: f64,
    pub(super) iterations: usize,
}

/// Searches the local minimum from a start, which is first clamped to the parameters' ranges.
pub(super) fn search(problem: &Problem<'_>, start: &[f64]) -> End {
    let bounds = |side: usize| -> Vec<f64> {
        problem.meanings.iter().map(|meaning| to_search(meaning.range[side], meaning.logarithmic)).collect()
    };
    let (lower, upper) = (bounds(0), bounds(1));
    let start: Vec<f64> = problem
        .meanings
        .iter()
        .zip(start)
        .map(|(meaning, value)| {
            to_search(value.clamp(meaning.range[0], meaning.range[1]), meaning.logarithmic)
        })
        .collect();
    let solver = TrustRegionReflective::new()
        .with_absolute_scaled_gradient_tolerance(GRADIENT)
        .with_relative_step_tolerance(STEP);
    let squares = Squares { problem, lower, upper };
    let first = start.clone();
    let Ok(result) = Executor::from_start(squares, solver, start).max_iter(ITERATIONS).run() else {
        return End { values: from_search(problem, &first), cost: f64::INFINITY, iterations: 0 };
    };
    End {
        values: from_search(problem, result.param()),
        cost: result.cost(),
        iterations: usize::try_from(result.iter()).unwrap_or(usize::MAX),
    }
}

fn to_search(value: f64, logarithmic: bool) -> f64 {
    if logarithmic { value.ln() } else { value }
}

fn from_search(problem: &Problem<'_>, sought: &[f64]) -> Vec<f64> {
    let one = |(meaning, x): (&Meaning, &f64)| if meaning.logarithmic { x.exp() } else { *x };
    problem.meanings.iter().zip(sought).map(one).collect()
}

/// The problem in the form required by `basin`.
struct Squares<'a> {
    problem: &'a Problem<'a>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Squares<'_> {
    /// Rotated residuals and their Jacobian, row by row: modified Gram-Schmidt
    /// on both together, as accurate as Householder's method for least squares (Bjoerck 1967).
    fn rotated(&self, sought: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let values = from_search(self.problem, sought);
        let n = sought.len();
        let mut columns = self.problem.columns(&values);
        for ((column, meaning), value) in columns.iter_mut().zip(&self.problem.meanings).zip(&values) {
            if meaning.logarithmic {
                column.iter_mut().for_each(|slope| *slope *= value);
            }
        }
        let (mut residuals, mut rotated) = (vec![0.0; n + 1], vec![0.0; (n + 1) * n]);
        for k in 0..=n {
            let (unit, rest) = columns[k..].split_at_mut(1);
            let length = dot(&unit[0], &unit[0]).sqrt();
            let entry = if k == n { &mut residuals[n] } else { &mut rotated[k * n + k] };
            *entry = length;
            if length == 0.0 {
                continue;
            }
            unit[0].iter_mut().for_each(|x| *x /= length);
            for (j, other) in rest.iter_mut().enumerate() {
                let along = dot(&unit[0], other);
                other.iter_mut().zip(&unit[0]).for_each(|(x, unit)| *x -= along * unit);
                let entry = if k + 1 + j == n { &mut residuals[k] } else { &mut rotated[k * n + k + 1 + j] };
                *entry = along;
            }
        }
        (residuals, rotated)
    }
}

impl Constraints for Squares<'_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl CostFunction for Squares<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, sought: &Vec<f64>) -> Result<f64, Infallible> {
        let residuals = self.problem.residuals(&from_search(self.problem, sought));
        Ok(0.5 * dot(&residuals, &residuals))
    }
}

impl Residual for Squares<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;

    fn residual(&self, sought: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok(self.rotated(sought).0)
    }
}

impl Jacobian for Squares<'_> {
    type Jacobian = DenseMatrix;

    fn jacobian(&self, sought: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let n = sought.len();
        Ok(DenseMatrix::from_row_slice(n + 1, n, &self.rotated(sought).1))
    }
}

//! The search for the least sum of squares, by the crate `basin`.

use std::convert::Infallible;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction, DenseMatrix, Executor,
    Jacobian, Residual, TrustRegionReflective,
};

use super::Problem;

/// Scaled gradients below this end a search; residuals are relative to the data, parameters logarithms.
const GRADIENT: f64 = 1e-15;
/// Steps below this, relative, end it too.
const STEP: f64 = 1e-13;
const ITERATIONS: u64 = 200;

/// Where a search ended.
pub(super) struct End {
    pub(super) values: Vec<f64>,
    /// Half the sum of the squared residuals, relative to the data's.
    pub(super) cost: f64,
    pub(super) iterations: usize,
}

/// The minimum downhill of a start, which is moved into the parameters' ranges.
pub(super) fn search(problem: &Problem<'_>, start: &[f64]) -> End {
    let bounds = |side: usize| -> Vec<f64> {
        problem.meanings.iter().map(|meaning| forth(meaning.range[side], meaning.logarithmic)).collect()
    };
    let (lower, upper) = (bounds(0), bounds(1));
    let start: Vec<f64> = problem
        .meanings
        .iter()
        .zip(start)
        .map(|(meaning, value)| forth(value.clamp(meaning.range[0], meaning.range[1]), meaning.logarithmic))
        .collect();
    let solver = TrustRegionReflective::new()
        .with_absolute_scaled_gradient_tolerance(GRADIENT)
        .with_relative_step_tolerance(STEP);
    let squares = Squares { problem, lower, upper };
    let begun = start.clone();
    let Ok(result) = Executor::from_start(squares, solver, start).max_iter(ITERATIONS).run() else {
        return End { values: back(problem, &begun), cost: f64::INFINITY, iterations: 0 };
    };
    End {
        values: back(problem, result.param()),
        cost: result.cost(),
        iterations: usize::try_from(result.iter()).unwrap_or(usize::MAX),
    }
}

fn forth(value: f64, logarithmic: bool) -> f64 {
    if logarithmic { value.ln() } else { value }
}

fn back(problem: &Problem<'_>, sought: &[f64]) -> Vec<f64> {
    let one = |(meaning, x): (&crate::models::Meaning, &f64)| if meaning.logarithmic { x.exp() } else { *x };
    problem.meanings.iter().zip(sought).map(one).collect()
}

/// The problem as the crate asks for it.
struct Squares<'a> {
    problem: &'a Problem<'a>,
    lower: Vec<f64>,
    upper: Vec<f64>,
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
        let residuals = self.problem.residuals(&back(self.problem, sought));
        Ok(0.5 * residuals.iter().map(|r| r * r).sum::<f64>())
    }
}

impl Residual for Squares<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Error = Infallible;

    fn residual(&self, sought: &Vec<f64>) -> Result<Vec<f64>, Infallible> {
        Ok(self.problem.residuals(&back(self.problem, sought)))
    }
}

impl Jacobian for Squares<'_> {
    type Jacobian = DenseMatrix;

    fn jacobian(&self, sought: &Vec<f64>) -> Result<DenseMatrix, Infallible> {
        let values = back(self.problem, sought);
        let meanings = &self.problem.meanings;
        let mut slopes = self.problem.slopes(&values);
        for row in slopes.chunks_exact_mut(meanings.len()) {
            for ((slope, meaning), value) in row.iter_mut().zip(meanings).zip(&values) {
                *slope *= if meaning.logarithmic { *value } else { 1.0 };
            }
        }
        Ok(DenseMatrix::from_row_slice(self.problem.data.len(), meanings.len(), &slopes))
    }
}

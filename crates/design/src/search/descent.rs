//! Descent by derivatives: sequential least squares programming (SLSQP, Kraft 1988), by the crate `basin`.

use basin::{
    BoxBounds, ConstraintDescription, ConstraintJacobian, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, DenseMatrix, Executor, Gradient, NoLinearConstraints, NoNonlinearBlock, NonlinearBlock,
    NonlinearBlocks, NonlinearInequalityValues, SelectedFirstOrderState, Slsqp,
};

use super::task_problem::DescentTask;
use crate::DesignError;

/// Absolute accuracy of merits and violations, which are of the order of 1.
const ACCURACY: f64 = 1e-9;
const ITERATIONS: u64 = 200;

/// Runs a descent from a point of the unit cube until it converges, or until the task has evaluated
/// `evaluations` designs, including those evaluated before.
pub(super) fn descend(
    scalar: &DescentTask<'_, '_>,
    start: Vec<f64>,
    evaluations: usize,
) -> Result<(), DesignError> {
    let variables = start.len();
    let problem = Descent {
        scalar,
        lower: vec![0.0; variables],
        upper: vec![1.0; variables],
        limits: scalar.problem.limits(),
        evaluations,
    };
    let solver = Slsqp::new().with_absolute_accuracy_tolerance(ACCURACY);
    let outcome =
        Executor::new(problem, solver, SelectedFirstOrderState::new(start)).max_iter(ITERATIONS).run();
    match outcome {
        Err(ConstraintSolveError::Evaluation(StopReason::Failed(error))) => Err(error),
        // The best evaluated design is the result, even without convergence.
        _ => Ok(()),
    }
}

/// Reason why a point is not evaluated.
#[derive(Debug, thiserror::Error)]
enum StopReason {
    #[error("the task has used up its evaluations")]
    UsedUp,
    #[error(transparent)]
    Failed(#[from] DesignError),
}

struct Descent<'a, 'b, 'stop> {
    scalar: &'a DescentTask<'b, 'stop>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    limits: usize,
    evaluations: usize,
}

impl<'b, 'stop> Descent<'_, 'b, 'stop> {
    /// Returns the task if it has evaluations left.
    fn scalar(&self) -> Result<&DescentTask<'b, 'stop>, StopReason> {
        (self.scalar.evaluations() < self.evaluations).then_some(self.scalar).ok_or(StopReason::UsedUp)
    }
}

impl Constraints for Descent<'_, '_, '_> {
    type Set = ConstraintSet<
        BoxBounds<Vec<f64>>,
        NoLinearConstraints,
        NonlinearBlocks<NoNonlinearBlock, NonlinearBlock>,
    >;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new()
            .with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
            .with_nonlinear_inequalities(self.limits)
    }
}

impl CostFunction for Descent<'_, '_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = StopReason;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, StopReason> {
        Ok(self.scalar()?.value(point)?.0)
    }
}

impl Gradient for Descent<'_, '_, '_> {
    type Gradient = Vec<f64>;

    fn gradient(&self, point: &Vec<f64>) -> Result<Vec<f64>, StopReason> {
        Ok(self.scalar()?.slopes(point)?.0)
    }
}

impl NonlinearInequalityValues for Descent<'_, '_, '_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = StopReason;

    fn nonlinear_inequalities(&self, point: &Vec<f64>) -> Result<Vec<f64>, ConstraintSolveError<StopReason>> {
        let value = self.scalar().and_then(|scalar| Ok(scalar.value(point)?));
        Ok(value.map_err(ConstraintSolveError::Evaluation)?.1)
    }
}

impl ConstraintJacobian for Descent<'_, '_, '_> {
    type Param = Vec<f64>;
    type Jacobian = DenseMatrix;
    type Error = StopReason;

    fn constraint_jacobian(&self, point: &Vec<f64>) -> Result<DenseMatrix, ConstraintSolveError<StopReason>> {
        let value = self.scalar().and_then(|scalar| Ok(scalar.slopes(point)?));
        let slopes = value.map_err(ConstraintSolveError::Evaluation)?.1;
        Ok(DenseMatrix::from_row_slice(self.limits, self.lower.len(), &slopes))
    }
}

//! Downhill by derivatives: sequential least squares programming (Kraft 1988), by the crate `basin`.

use basin::{
    BoxBounds, ConstraintDescription, ConstraintJacobian, ConstraintSet, ConstraintSolveError, Constraints,
    CostFunction, DenseMatrix, Executor, Gradient, NoLinearConstraints, NoNonlinearBlock, NonlinearBlock,
    NonlinearBlocks, NonlinearInequalityValues, SelectedFirstOrderState, Slsqp,
};

use super::scalar::Scalar;
use crate::DesignError;

/// Merits and misses are of the size of 1: this is far below what anybody sees.
const ACCURACY: f64 = 1e-9;
const ITERATIONS: u64 = 200;

/// Goes down from a point of the unit cube, until the task has evaluated so many designs: those that it evaluated before
/// count, too.
pub(super) fn descend(
    scalar: &Scalar<'_, '_>,
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
    let ended =
        Executor::new(problem, solver, SelectedFirstOrderState::new(start)).max_iter(ITERATIONS).run();
    match ended {
        Err(ConstraintSolveError::Evaluation(Ended::Failed(error))) => Err(error),
        // However it ended: the best design that it saw is what counts.
        _ => Ok(()),
    }
}

/// Why there is no value at a point.
#[derive(Debug, thiserror::Error)]
enum Ended {
    #[error("its evaluations are used up")]
    UsedUp,
    #[error(transparent)]
    Failed(#[from] DesignError),
}

struct Descent<'a, 'b, 'stop> {
    scalar: &'a Scalar<'b, 'stop>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    limits: usize,
    evaluations: usize,
}

impl<'b, 'stop> Descent<'_, 'b, 'stop> {
    /// The task, while it may evaluate designs.
    fn scalar(&self) -> Result<&Scalar<'b, 'stop>, Ended> {
        (self.scalar.evaluations() < self.evaluations).then_some(self.scalar).ok_or(Ended::UsedUp)
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
    type Error = Ended;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, Ended> {
        Ok(self.scalar()?.value(point)?.0)
    }
}

impl Gradient for Descent<'_, '_, '_> {
    type Gradient = Vec<f64>;

    fn gradient(&self, point: &Vec<f64>) -> Result<Vec<f64>, Ended> {
        Ok(self.scalar()?.slopes(point)?.0)
    }
}

impl NonlinearInequalityValues for Descent<'_, '_, '_> {
    type Param = Vec<f64>;
    type Values = Vec<f64>;
    type Error = Ended;

    fn nonlinear_inequalities(&self, point: &Vec<f64>) -> Result<Vec<f64>, ConstraintSolveError<Ended>> {
        let found = self.scalar().and_then(|scalar| Ok(scalar.value(point)?));
        Ok(found.map_err(ConstraintSolveError::Evaluation)?.1)
    }
}

impl ConstraintJacobian for Descent<'_, '_, '_> {
    type Param = Vec<f64>;
    type Jacobian = DenseMatrix;
    type Error = Ended;

    fn constraint_jacobian(&self, point: &Vec<f64>) -> Result<DenseMatrix, ConstraintSolveError<Ended>> {
        let found = self.scalar().and_then(|scalar| Ok(scalar.slopes(point)?));
        let slopes = found.map_err(ConstraintSolveError::Evaluation)?.1;
        Ok(DenseMatrix::from_row_slice(self.limits, self.lower.len(), &slopes))
    }
}

//! By a population: differential evolution (Storn and Price 1997), by the crate `basin`.

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, ConstraintSolveError, Constraints, CostFunction, De,
    Executor, PopulationProgress,
};

use super::scalar::Scalar;
use super::starts::drawn;
use crate::DesignError;

/// Members for each variable, and the fewest and the most of them.
const MEMBERS: usize = 8;
const FEWEST: usize = 16;
const MOST: usize = 120;

/// Members of a population over so many variables.
pub(super) fn members(variables: usize) -> usize {
    (MEMBERS * variables).clamp(FEWEST, MOST)
}

/// Evolves a population; the scenario's own design is its first member.
pub(super) fn evolve(scalar: &Scalar<'_, '_>, seed: u64, evaluations: usize) -> Result<(), DesignError> {
    let variables = scalar.free.len();
    let members = members(variables);
    let own = scalar.point(&scalar.search.own);
    let others = (1..members as u64).map(|member| drawn(seed, u64::MAX, member, variables));
    let population = std::iter::once(own).chain(others).collect();
    let problem = Evolution { scalar, lower: vec![0.0; variables], upper: vec![1.0; variables] };
    let solver = De::new(seed).with_pop_size(members).with_dither(0.5, 1.0);
    let ended = Executor::new(problem, solver, PopulationProgress::from_population(population))
        .max_iter(u64::MAX)
        .max_cost_evals(evaluations as u64)
        .run();
    match ended {
        Err(ConstraintSolveError::Evaluation(error)) => Err(error),
        _ => Ok(()),
    }
}

struct Evolution<'a, 'b, 'stop> {
    scalar: &'a Scalar<'b, 'stop>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Constraints for Evolution<'_, '_, '_> {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl CostFunction for Evolution<'_, '_, '_> {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = DesignError;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, DesignError> {
        self.scalar.cost(point)
    }
}

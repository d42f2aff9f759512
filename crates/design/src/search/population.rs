//! Differential evolution (Storn and Price 1997), by the crate `basin`.
//!
//! A generation depends only on the one before it. Its members can therefore be evaluated in parallel.

use std::cell::RefCell;
use std::convert::Infallible;
use std::vec::IntoIter;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction, De, PopulationProgress,
    Problem, Solver,
};

use super::starts::random_point;

/// Members per variable, and the smallest and largest number of members.
const MEMBERS: usize = 8;
const FEWEST: usize = 16;
const MOST: usize = 120;

/// Population in the unit cube, between two generations.
pub(super) struct Population {
    solver: De,
    /// Second instance of the optimiser, one generation ahead, from which the points of the next generation
    /// are obtained.
    look_ahead: De,
    /// `None` before the first generation is evaluated.
    state: Option<PopulationProgress<Vec<f64>>>,
    first: Vec<Vec<f64>>,
}

impl Population {
    /// Creates a population whose first member is `own`.
    pub(super) fn new(own: Vec<f64>, seed: u64) -> Self {
        let variables = own.len();
        let members = (MEMBERS * variables).clamp(FEWEST, MOST);
        let others = (1..members as u64).map(|member| random_point(seed, u64::MAX, member, variables));
        let solver = || De::new(seed).with_pop_size(members).with_dither(0.5, 1.0);
        Self {
            solver: solver(),
            look_ahead: solver(),
            state: None,
            first: std::iter::once(own).chain(others).collect(),
        }
    }

    /// Returns the points of the next generation. Must be called once for each generation.
    pub(super) fn next_points(&mut self) -> Vec<Vec<f64>> {
        // The costs do not affect the points of the same generation.
        let unknown = vec![0.0; self.first.len()];
        step(&mut self.look_ahead, self.state.clone(), &self.first, unknown).1
    }

    /// Sets the costs of these points, in order.
    pub(super) fn set_costs(&mut self, costs: Vec<f64>) {
        self.state = step(&mut self.solver, self.state.take(), &self.first, costs).0;
    }
}

/// Advances the optimiser by one generation with these costs; also returns the points of the generation.
fn step(
    solver: &mut De,
    state: Option<PopulationProgress<Vec<f64>>>,
    first: &[Vec<f64>],
    costs: Vec<f64>,
) -> (Option<PopulationProgress<Vec<f64>>>, Vec<Vec<f64>>) {
    let variables = first.first().map_or(0, Vec::len);
    let costs = RecordedCosts {
        points: RefCell::default(),
        costs: RefCell::new(costs.into_iter()),
        lower: vec![0.0; variables],
        upper: vec![1.0; variables],
    };
    let mut problem = Problem::new(costs);
    let state = match state {
        None => solver.init(&mut problem, PopulationProgress::from_population(first.to_vec())).ok(),
        Some(state) => solver.next_iter(&mut problem, state).ok().map(|step| step.state),
    };
    let points = problem.inner().points.take();
    (state, points)
}

impl std::fmt::Debug for Population {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Population").field("members", &self.first.len()).finish_non_exhaustive()
    }
}

/// Cost function that returns given costs in order and records the points.
struct RecordedCosts {
    points: RefCell<Vec<Vec<f64>>>,
    costs: RefCell<IntoIter<f64>>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Constraints for RecordedCosts {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl CostFunction for RecordedCosts {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, Infallible> {
        self.points.borrow_mut().push(point.clone());
        Ok(self.costs.borrow_mut().next().unwrap_or(f64::MAX))
    }
}

//! By a population: differential evolution (Storn and Price 1997), by the crate `basin`.
//!
//! A generation is made of the one before it alone, so that its members can be evaluated side by side, wherever.

use std::cell::RefCell;
use std::convert::Infallible;
use std::vec::IntoIter;

use basin::{
    BoxBounds, ConstraintDescription, ConstraintSet, Constraints, CostFunction, De, PopulationProgress,
    Problem, Solver,
};

use super::starts::drawn;

/// Members for each variable, and the fewest and the most of them.
const MEMBERS: usize = 8;
const FEWEST: usize = 16;
const MOST: usize = 120;

/// A population in the unit cube, between two generations.
pub(super) struct Population {
    /// The optimiser, and its twin, which is always a generation ahead: it says which points the next one has.
    solver: De,
    scout: De,
    /// `None`: the first generation is not known yet.
    state: Option<PopulationProgress<Vec<f64>>>,
    first: Vec<Vec<f64>>,
}

impl Population {
    /// Around a point, its first member.
    pub(super) fn new(own: Vec<f64>, seed: u64) -> Self {
        let variables = own.len();
        let members = (MEMBERS * variables).clamp(FEWEST, MOST);
        let others = (1..members as u64).map(|member| drawn(seed, u64::MAX, member, variables));
        let solver = || De::new(seed).with_pop_size(members).with_dither(0.5, 1.0);
        Self {
            solver: solver(),
            scout: solver(),
            state: None,
            first: std::iter::once(own).chain(others).collect(),
        }
    }

    /// The points of the next generation; to be asked once for each.
    pub(super) fn next(&mut self) -> Vec<Vec<f64>> {
        // What a point costs does not change what is asked in the same generation.
        let unknown = vec![0.0; self.first.len()];
        stepped(&mut self.scout, self.state.clone(), &self.first, unknown).1
    }

    /// Takes what those points cost, in order.
    pub(super) fn take(&mut self, costs: Vec<f64>) {
        self.state = stepped(&mut self.solver, self.state.take(), &self.first, costs).0;
    }
}

/// A generation with these costs; and its points.
fn stepped(
    solver: &mut De,
    state: Option<PopulationProgress<Vec<f64>>>,
    first: &[Vec<f64>],
    costs: Vec<f64>,
) -> (Option<PopulationProgress<Vec<f64>>>, Vec<Vec<f64>>) {
    let variables = first.first().map_or(0, Vec::len);
    let told = Told {
        asked: RefCell::default(),
        costs: RefCell::new(costs.into_iter()),
        lower: vec![0.0; variables],
        upper: vec![1.0; variables],
    };
    let mut problem = Problem::new(told);
    let state = match state {
        None => solver.init(&mut problem, PopulationProgress::from_population(first.to_vec())).ok(),
        Some(state) => solver.next_iter(&mut problem, state).ok().map(|step| step.state),
    };
    let asked = problem.inner().asked.take();
    (state, asked)
}

impl std::fmt::Debug for Population {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Population").field("members", &self.first.len()).finish_non_exhaustive()
    }
}

/// Costs that are told in order, whatever the points.
struct Told {
    asked: RefCell<Vec<Vec<f64>>>,
    costs: RefCell<IntoIter<f64>>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Constraints for Told {
    type Set = ConstraintSet<BoxBounds<Vec<f64>>>;

    fn constraints(&self) -> <Self::Set as ConstraintDescription>::Borrowed<'_> {
        ConstraintSet::new().with_bounds(BoxBounds::new(Some(&self.lower), Some(&self.upper)))
    }
}

impl CostFunction for Told {
    type Param = Vec<f64>;
    type Output = f64;
    type Error = Infallible;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, Infallible> {
        self.asked.borrow_mut().push(point.clone());
        Ok(self.costs.borrow_mut().next().unwrap_or(f64::MAX))
    }
}

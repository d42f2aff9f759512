//! Starting points of descents.

use papilio_sampling::{SampleStream, Sampler};

use super::task_problem::DescentTask;
use crate::DesignError;

/// Number of random points of which the best one is the start of a descent.
pub(super) const POINTS_PER_START: u64 = 8;

/// Point of the unit cube: Owen-scrambled Sobol numbers in the first dimensions, random numbers in the
/// others.
pub(crate) fn random_point(seed: u64, stream: u64, number: u64, variables: usize) -> Vec<f64> {
    let numbers = SampleStream::new(Sampler::Sobol, seed, stream);
    let blocks = 0..variables.div_ceil(4) as u32;
    blocks.flat_map(|block| numbers.block(number, block)).take(variables).collect()
}

/// Best of the random points of a start; no more points than the task may evaluate.
pub(super) fn best_random_point(
    scalar: &DescentTask<'_, '_>,
    seed: u64,
    stream: u64,
    start: u64,
) -> Result<Vec<f64>, DesignError> {
    let mut best: Option<(f64, Vec<f64>)> = None;
    let most = POINTS_PER_START.min(scalar.problem.task.evaluations as u64).max(1);
    for number in (start * POINTS_PER_START..).take(most as usize) {
        let point = random_point(seed, stream, number, scalar.problem.free.len());
        let cost = scalar.cost(&point)?;
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, point));
        }
    }
    Ok(best.map(|(_, point)| point).unwrap_or_default())
}

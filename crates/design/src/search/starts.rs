//! Where descents begin.

use papilio_sampling::{Numbers, Sampler};

use super::scalar::Scalar;
use crate::DesignError;

/// A descent begins at the best of so many drawn points.
pub(super) const DRAWN: u64 = 8;

/// A point of the unit cube: of Owen-scrambled Sobol points in the first dimensions, of random ones in the rest.
pub(super) fn drawn(seed: u64, stream: u64, number: u64, variables: usize) -> Vec<f64> {
    let numbers = Numbers::new(Sampler::Sobol, seed, stream);
    let blocks = 0..variables.div_ceil(4) as u32;
    blocks.flat_map(|block| numbers.block(number, block)).take(variables).collect()
}

/// The best of the points that are drawn for a start, as many as the task may evaluate.
pub(super) fn best_of_drawn(
    scalar: &Scalar<'_, '_>,
    seed: u64,
    stream: u64,
    start: u64,
) -> Result<Vec<f64>, DesignError> {
    let mut best: Option<(f64, Vec<f64>)> = None;
    let most = DRAWN.min(scalar.problem.task.evaluations as u64).max(1);
    for number in (start * DRAWN..).take(most as usize) {
        let point = drawn(seed, stream, number, scalar.problem.free.len());
        let cost = scalar.cost(&point)?;
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, point));
        }
    }
    Ok(best.map(|(_, point)| point).unwrap_or_default())
}

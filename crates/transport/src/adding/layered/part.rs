//! A part of the stack as operators of one azimuthal order, and the combination of two parts.

use super::algebra::Operator;
use super::grid::Grid;
use crate::front::Flat;

/// For light that arrives at each node, the fraction that is absorbed in each [`Account`].
pub(super) type Absorbed = [Vec<f64>; 4];

/// Reflection, transmission and absorption of a part.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Reflection of light from above.
    pub(super) above: Operator,
    /// Reflection of light from below.
    pub(super) below: Operator,
    /// Transmission of light from above; light from below takes the transpose.
    pub(super) down: Operator,
    /// Fractions of light from above and from below that are absorbed: of order 0 only.
    pub(super) absorbed: Option<[Absorbed; 2]>,
}

/// Returns zero absorption.
pub(super) fn nothing(nodes: usize) -> Absorbed {
    std::array::from_fn(|_| vec![0.0; nodes])
}

fn sum(mut a: Absorbed, others: [Absorbed; 2]) -> Absorbed {
    for other in others {
        for (place, more) in a.iter_mut().zip(other) {
            place.iter_mut().zip(more).for_each(|(x, y)| *x += y);
        }
    }
    a
}

impl Part {
    /// Returns a flat part, given by `flat` at each node.
    pub(super) fn flat(grid: &Grid, flat: impl Fn(f64) -> Flat) -> Self {
        Self::of_flats(grid, &grid.beta.iter().map(|&beta| flat(beta)).collect::<Vec<_>>())
    }

    /// Returns a flat part, given at each node.
    pub(super) fn of_flats(grid: &Grid, flats: &[Flat]) -> Self {
        let diagonal = |f: fn(&Flat) -> f64| Operator::diagonal(grid.regular, flats.iter().map(f).collect());
        Self {
            above: diagonal(|f| f.above),
            below: diagonal(|f| f.below),
            down: diagonal(|f| f.t),
            absorbed: None,
        }
    }

    /// Returns a part that absorbs everything.
    pub(super) fn dark(grid: &Grid) -> Self {
        Self::flat(grid, |_| Flat { t: 0.0, above: 0.0, below: 0.0 })
    }

    /// Returns the light that is neither reflected nor transmitted, from above and from below, of light that
    /// the media of these indices carry.
    pub(super) fn lost(&self, grid: &Grid, [above, below]: [f64; 2]) -> [Vec<f64>; 2] {
        let ones = vec![1.0; grid.len()];
        let lost = |back: &Operator, through: &Operator, index: f64| -> Vec<f64> {
            let back = back.pull_back(&ones, &grid.scale);
            let through = through.pull_back(&ones, &grid.scale);
            (0..grid.len())
                .map(|i| if grid.beta[i] < index { 1.0 - back[i] - through[i] } else { 0.0 })
                .collect()
        };
        [lost(&self.above, &self.down, above), lost(&self.below, &self.down.transposed(), below)]
    }

    /// Combines this part with `lower` below it, all inter-reflections included.
    pub(super) fn over(&self, lower: &Self, grid: &Grid) -> Self {
        let up = self.down.transposed();
        // Light in the gap between the two for light from above: propagating down, then up.
        let falls = self.below.after(&lower.above).one_plus(-1.0).solve(&self.down);
        let rises = lower.above.after(&falls);
        // The same for light from below.
        let rises_first = lower.above.after(&self.below).one_plus(-1.0).solve(&lower.down.transposed());
        let falls_then = self.below.after(&rises_first);
        let absorbed = match (&self.absorbed, &lower.absorbed) {
            (Some([above, below]), Some([lower_above, lower_below])) => {
                let pull = |operator: &Operator, books: &Absorbed| -> Absorbed {
                    std::array::from_fn(|i| operator.pull_back(&books[i], &grid.scale))
                };
                Some([
                    sum(above.clone(), [pull(&falls, lower_above), pull(&rises, below)]),
                    sum(lower_below.clone(), [pull(&falls_then, lower_above), pull(&rises_first, below)]),
                ])
            }
            _ => None,
        };
        Self {
            above: self.above.plus(&up.after(&rises)),
            below: lower.below.plus(&lower.down.after(&falls_then)),
            down: lower.down.after(&falls),
            absorbed,
        }
    }
}

//! A part of the stack as operators of one azimuthal order, and two parts as one.

use super::algebra::Operator;
use super::grid::Grid;
use crate::estimate::Account;
use crate::front::Flat;

/// For light that arrives at each node, the fraction that is absorbed in each [`Account`].
pub(super) type Absorbed = [Vec<f64>; 4];

/// What a part does to light.
#[derive(Debug, Clone)]
pub(super) struct Part {
    /// Light from above, sent back.
    pub(super) above: Operator,
    /// Light from below, sent back.
    pub(super) below: Operator,
    /// Light from above, let through; light from below takes the transposed way.
    pub(super) down: Operator,
    /// Fractions of light from above and from below that are absorbed: of order 0 alone.
    pub(super) absorbed: Option<[Absorbed; 2]>,
}

/// No absorption.
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
    /// A flat part: at each node what `flat` says.
    pub(super) fn flat(grid: &Grid, flat: impl Fn(f64) -> Flat) -> Self {
        let flats: Vec<Flat> = grid.beta.iter().map(|&beta| flat(beta)).collect();
        let diagonal = |f: fn(&Flat) -> f64| Operator::diagonal(grid.regular, flats.iter().map(f).collect());
        Self {
            above: diagonal(|f| f.above),
            below: diagonal(|f| f.below),
            down: diagonal(|f| f.t),
            absorbed: None,
        }
    }

    /// A part that takes everything.
    pub(super) fn dark(grid: &Grid) -> Self {
        Self::flat(grid, |_| Flat { t: 0.0, above: 0.0, below: 0.0 })
    }

    /// Books what is neither sent back nor let through, of light that media of these indices,
    /// above and below, carry.
    pub(super) fn booked(mut self, grid: &Grid, account: Account, [above, below]: [f64; 2]) -> Self {
        let ones = vec![1.0; grid.len()];
        let lost = |back: &Operator, through: &Operator, index: f64| -> Vec<f64> {
            let back = back.pull_back(&ones, &grid.scale);
            let through = through.pull_back(&ones, &grid.scale);
            (0..grid.len())
                .map(|i| if grid.beta[i] < index { 1.0 - back[i] - through[i] } else { 0.0 })
                .collect()
        };
        let mut books = [nothing(grid.len()), nothing(grid.len())];
        books[0][account as usize] = lost(&self.above, &self.down, above);
        books[1][account as usize] = lost(&self.below, &self.down.transposed(), below);
        self.absorbed = Some(books);
        self
    }

    /// This part above `lower`: light goes to and fro between them until none is left.
    pub(super) fn over(&self, lower: &Self, grid: &Grid) -> Self {
        let up = self.down.transposed();
        // Light in the gap between the two for light from above: going down, then going up.
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

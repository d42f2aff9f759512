//! Branches of light that has not been scattered.
//!
//! Before light is scattered, all paths meet the same interfaces and media at nearly the same angle: a choice
//! between reflection and transmission has nearly the same probability for each of them. With points of low
//! discrepancy, the number of paths of a replicate that take an alternative is then one of the two integers
//! next to its mean. Where one of the two is improbable, all replicates often have the other, and their
//! spread does not show the error. Nothing is therefore chosen: such light follows all bright alternatives,
//! with their weights. Faint ones are followed by roulette, with numbers that are independent for each path.

use super::dice::{Counts, Dice};
use super::path::Path;

/// Light of at least this fraction is followed; fainter light by roulette, which restores this fraction.
const BRIGHT: f64 = 1.0 / 64.0;

/// Branches that are still to be followed. Memory is kept.
#[derive(Debug, Clone, Default)]
pub(super) struct Branches {
    all: Vec<(Path, Counts)>,
    waiting: usize,
}

impl Branches {
    /// Adds a copy of a path; returns it, to be changed.
    pub(super) fn add(&mut self, path: &Path, counts: Counts) -> &mut (Path, Counts) {
        let number = self.waiting;
        self.waiting += 1;
        match self.all.get_mut(number) {
            Some((copy, of_copy)) => {
                copy.copy(path);
                *of_copy = counts;
            }
            None => self.all.push((path.clone(), counts)),
        }
        &mut self.all[number]
    }

    /// Removes the branch that was added last.
    pub(super) fn drop_last(&mut self) {
        self.waiting = self.waiting.saturating_sub(1);
    }

    /// Takes the branch that was added last, in exchange for a path that has ended.
    pub(super) fn take(&mut self, path: &mut Path) -> Option<Counts> {
        self.waiting = self.waiting.checked_sub(1)?;
        let (next, counts) = &mut self.all[self.waiting];
        std::mem::swap(path, next);
        Some(*counts)
    }
}

/// Weight of a branch with this fraction of the light; `None` if roulette ends it.
pub(super) fn weight(fraction: f64, dice: &mut Dice<'_>) -> Option<f64> {
    let survival = (fraction / BRIGHT).min(1.0);
    let survives = survival >= 1.0 || (survival > 0.0 && dice.of_connection() < survival);
    survives.then(|| 1.0 / survival)
}

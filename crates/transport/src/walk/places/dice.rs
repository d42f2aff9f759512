//! Random numbers of a path with a place.

use papilio_sampling::PLANNED_BLOCKS;

use crate::walk::PathNumbers;

/// Distance of the blocks of a branch from those of the branch before.
const OF_BRANCH: u32 = 1 << 18;

/// Random numbers of a path.
pub(super) struct Dice<'n> {
    numbers: &'n PathNumbers<'n>,
    pub(super) counts: Counts,
    branches: u32,
}

/// What a branch of a path has used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counts {
    /// Planes that it has reached.
    pub(super) steps: u32,
    event: u32,
    of_connections: u32,
    branch: u32,
}

impl<'n> Dice<'n> {
    pub(super) fn new(numbers: &'n PathNumbers<'n>) -> Self {
        let counts = Counts { steps: 0, event: 0, of_connections: 1, branch: 0 };
        Self { numbers, counts, branches: 0 }
    }

    /// Counts of a new branch. It has the same planned numbers as the others, and further numbers of its own.
    pub(super) fn branch(&mut self) -> Counts {
        self.branches += 1;
        Counts { branch: self.branches, ..self.counts }
    }

    /// Numbers of the next event; those of points of the sources are left out.
    pub(super) fn next(&mut self) -> [f64; 4] {
        let Counts { event, branch, .. } = &mut self.counts;
        *event += if *event + 2 == PLANNED_BLOCKS { 2 } else { 1 };
        let own = if *event < PLANNED_BLOCKS { 0 } else { branch.wrapping_mul(OF_BRANCH) };
        self.numbers.block(event.wrapping_add(own))
    }

    /// A number for a connection or a roulette; independent of those of events.
    pub(super) fn of_connection(&mut self) -> f64 {
        let Counts { of_connections, branch, .. } = &mut self.counts;
        *of_connections += 1;
        let own = branch.wrapping_mul(OF_BRANCH);
        self.numbers.block((u32::MAX - *of_connections).wrapping_sub(own))[0]
    }
}

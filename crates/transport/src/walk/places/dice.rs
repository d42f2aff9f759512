//! Random numbers of a path with a place.

use papilio_sampling::PLANNED_BLOCKS;

use crate::walk::PathNumbers;

/// Random numbers of a path.
pub(super) struct Dice<'n> {
    pub(super) numbers: &'n PathNumbers<'n>,
    /// Planes that the path has reached.
    pub(super) steps: u32,
    event: u32,
    of_connections: u32,
}

impl<'n> Dice<'n> {
    pub(super) fn new(numbers: &'n PathNumbers<'n>) -> Self {
        Self { numbers, steps: 0, event: 0, of_connections: 1 }
    }

    /// Numbers of the next event; those of points of the sources are left out.
    pub(super) fn next(&mut self) -> [f64; 4] {
        self.event += if self.event + 2 == PLANNED_BLOCKS { 2 } else { 1 };
        self.numbers.block(self.event)
    }

    /// A number for a connection; independent of those of events.
    pub(super) fn of_connection(&mut self) -> f64 {
        self.of_connections += 1;
        self.numbers.block(u32::MAX - self.of_connections)[0]
    }
}

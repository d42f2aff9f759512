//! A path, and the sums of all paths.

use papilio_optics::Beta;
use papilio_sampling::SampleStream;

use crate::layers::Departure;
use crate::skeleton::Propagation::{self, Down};

/// Light that is followed backwards.
pub(super) struct Path {
    pub(super) beta: Beta,
    pub(super) going: Propagation,
    pub(super) plane: usize,
    pub(super) weight: f64,
    pub(super) events: u32,
    /// The beam that it goes to: then it must not be scattered.
    pub(super) beam: Option<usize>,
}

/// What all paths have received from each source; the random numbers of the current path.
pub(super) struct Run<'n> {
    pub(super) received: Vec<f64>,
    pub(super) numbers: &'n SampleStream,
    pub(super) path: u64,
    pub(super) blocks: u32,
}

impl Run<'_> {
    pub(super) fn random(&mut self) -> [f64; 4] {
        self.blocks += 1;
        self.numbers.block(self.path, self.blocks - 1)
    }
}

impl Path {
    /// Leaves an element towards the plane above or below it.
    pub(super) fn depart(&mut self, element: usize, Departure { beta, going }: Departure) {
        (self.beta, self.going, self.plane) = (beta, going, element + usize::from(going == Down));
    }

    /// Russian roulette, which changes no mean: faint light continues by chance, and all light after many
    /// events.
    pub(super) fn survives(&mut self, run: &mut Run<'_>) -> bool {
        self.events += 1;
        let survival = (self.weight / 0.1).min(if self.events > 1000 { 0.95 } else { 1.0 });
        let survives = survival >= 1.0 || run.random()[0] < survival;
        self.weight = if survives { self.weight / survival } else { 0.0 };
        survives
    }
}

//! The general tracer: any layers in any order.

use super::PathNumbers;
use crate::{Cone, Estimate, Ledger, Rho, Source};

#[derive(Debug)]
pub(super) struct Layered<'a> {
    stack: &'a crate::Layered,
    sources: &'a [Source],
}

/// The sums of a replicate, and room to work in.
#[derive(Debug, Clone)]
pub(super) struct Tally {}

impl<'a> Layered<'a> {
    pub(super) fn new(stack: &'a crate::Layered, _view: Cone, sources: &'a [Source]) -> Self {
        Self { stack, sources }
    }

    pub(super) fn tally(&self) -> Tally {
        Tally {}
    }

    pub(super) fn path(&self, _numbers: &PathNumbers<'_>, _tally: &mut Tally) {}

    pub(super) fn estimate(&self, _tally: &Tally, _scale: f64) -> Estimate {
        let len = self.stack.base.states() * self.stack.base.bins();
        let rho = Rho { base: vec![0.0; len], front: vec![0.0; self.stack.base.bins()] };
        Estimate { rho: vec![rho; self.sources.len()], ledger: Ledger::zeros(len) }
    }
}

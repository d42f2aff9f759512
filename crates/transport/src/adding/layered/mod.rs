//! Any layers: operators on nodes of |beta|, one set for each azimuthal order.

use crate::{Cone, Estimate, Layered, Source};

/// Prepared for a stack, its views and its sources.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    #[allow(dead_code, reason = "to be written")]
    level: u32,
}

impl Kernel {
    pub(super) fn new(level: u32) -> Self {
        Self { level }
    }

    pub(super) fn prepare(&mut self, _stack: &Layered, _views: &[Cone], _sources: &[Source]) {}

    pub(super) fn estimate(&self, _stack: &Layered, _view: usize) -> Estimate {
        Estimate::default()
    }

    pub(super) fn nodes(&self) -> usize {
        0
    }
}

//! Kernels between nodes with weight: they depend neither on views nor on sources, and are kept for the next
//! preparation.

use papilio_optics::rough::Rough;
use papilio_optics::scatter::Scatter;

use super::rough::RoughOrders;
use super::scatter::ScatterOrders;

/// Kernels of scatterers without a closed series, by scatterer.
#[derive(Debug, Clone, Default)]
pub(super) struct Known {
    rough: Vec<(Rough, RoughOrders)>,
    scatter: Vec<(Scatter, f64, ScatterOrders)>,
}

/// Size in bytes above which they are not kept.
const MOST_KEPT: usize = 192 << 20;

impl Known {
    /// Returns the kernels of a rough interface on grids with these nodes.
    pub(super) fn rough(&self, face: &Rough, nodes: &[f64]) -> Option<&RoughOrders> {
        let known = self.rough.iter().find(|(known, orders)| known == face && orders.nodes() == nodes);
        known.map(|(_, orders)| orders)
    }

    /// Returns those of a kernel in a disc of this radius.
    pub(super) fn scatter(&self, scatter: &Scatter, disc: f64, nodes: &[f64]) -> Option<&ScatterOrders> {
        let like = |(known, of, orders): &&(Scatter, f64, ScatterOrders)| {
            known == scatter && *of == disc && orders.nodes() == nodes
        };
        self.scatter.iter().find(like).map(|(_, _, orders)| orders)
    }

    /// Keeps the kernels of a rough interface.
    pub(super) fn add_rough(&mut self, face: &Rough, orders: RoughOrders) {
        self.rough.push((face.clone(), orders));
        self.limit();
    }

    /// Keeps those of a kernel in a disc of this radius.
    pub(super) fn add_scatter(&mut self, scatter: &Scatter, disc: f64, orders: ScatterOrders) {
        self.scatter.push((scatter.clone(), disc, orders));
        self.limit();
    }

    fn limit(&mut self) {
        let rough = self.rough.iter().map(|(_, orders)| orders.bytes()).sum::<usize>();
        let scatter = self.scatter.iter().map(|(_, _, orders)| orders.bytes()).sum::<usize>();
        if rough + scatter > MOST_KEPT {
            *self = Self::default();
        }
    }
}

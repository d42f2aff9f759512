//! A base that scatters by a kernel for each state: the kernel of each state is a layer of its own, over
//! black.

use std::sync::atomic::AtomicBool;

use papilio_spectra::StateSpectra;

use super::Kernel;
use crate::{
    AngularTable, Base, Cone, Estimate, Interface, Layer, Ledger, Medium, Nodes, ReflectanceFactor,
    Reflector, ScatterFace, ScatterKernel, Source, Stack,
};

/// Prepared kernels of all states.
#[derive(Debug)]
pub(super) struct Pixels {
    /// Base for which they were prepared.
    base: Base,
    /// The layers alone over black, then with the pixel of each state below.
    stacks: Vec<(Stack, Kernel)>,
}

impl Pixels {
    /// Prepares the kernels; incomplete if `stop` is set during the computation.
    pub(super) fn new(
        stack: &Stack,
        (level, ledger): (f64, bool),
        views: &[Cone],
        sources: &[Source],
        stop: &AtomicBool,
    ) -> Self {
        let Reflector::Scattering(states) = &stack.base().reflector else {
            return Self { base: stack.base().clone(), stacks: Vec::new() };
        };
        let alone = std::iter::once(None).chain(states.iter().map(Some));
        let prepared = alone.map(|pixel| {
            let stack = over_black(stack, pixel);
            let mut kernel = Kernel::new(level, ledger);
            kernel.prepare(&stack, views, sources, stop);
            (stack, kernel)
        });
        Self { base: stack.base().clone(), stacks: prepared.collect() }
    }

    /// Returns whether they were prepared for this base.
    pub(super) fn serves(&self, base: &Base) -> bool {
        self.base == *base
    }

    pub(super) fn nodes(&self) -> usize {
        self.stacks.iter().map(|(_, kernel)| kernel.nodes()).max().unwrap_or(0)
    }

    /// Returns the estimate of a view; invalid if `stop` was set during the computation.
    pub(super) fn estimate(&self, view: usize, stop: &AtomicBool) -> Estimate {
        let mut all = self.stacks.iter().map(|(stack, kernel)| kernel.estimate(stack, view, stop));
        let alone = all.next().unwrap_or_default();
        let bins = self.base.bins();
        let front = |rho: ReflectanceFactor| ReflectanceFactor {
            via_pixel: StateSpectra::zeros(0, bins),
            front: rho.front,
        };
        let mut estimate =
            Estimate { rho: alone.rho.into_iter().map(front).collect(), ledger: Ledger::zeros(0, bins) };
        for state in all {
            for (rho, of_state) in estimate.rho.iter_mut().zip(&state.rho) {
                let ReflectanceFactor { via_pixel: base, front } = rho;
                base.extend(of_state.front.iter().zip(&*front).map(|(whole, front)| whole - front));
            }
            let (sum, one) = (&mut estimate.ledger, state.ledger);
            sum.returned.extend(one.returned.iter().copied());
            sum.front.extend(one.front.iter().copied());
            sum.diffuser.extend(one.diffuser.iter().copied());
            sum.glass.extend(one.glass.iter().copied());
            sum.pixel.extend(one.pixel.iter().copied());
            sum.inactive.extend(one.inactive.iter().copied());
            sum.unaccounted.extend(one.unaccounted.iter().copied());
        }
        estimate
    }
}

/// Returns the layers with the pixel of each state as the last of them, over black; `None` if the base does
/// not scatter by kernels.
pub(super) fn each_as_layers(stack: &Stack) -> Option<Vec<Stack>> {
    let Reflector::Scattering(states) = &stack.base().reflector else { return None };
    Some(states.iter().map(|pixel| over_black(stack, Some(pixel))).collect())
}

/// Returns the layers, and the pixel of a state as the last of them, over black.
fn over_black(stack: &Stack, pixel: Option<&ScatterKernel>) -> Stack {
    let bins = stack.base().bins();
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![0.0; bins].into(),
        mixture: vec![1.0],
        common: vec![0.0; bins],
    };
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance: vec![0.0; bins].into() };
    let mut layers = stack.layers.clone();
    if let Some(pixel) = pixel {
        let index =
            layers.last().map_or_else(|| vec![1.0; bins].into(), |layer| layer.medium.index().clone());
        let face = ScatterFace::pixel(pixel.clone(), &index);
        layers.push(Layer::new(Interface::Scatter(Box::new(face)), Medium::new(index)));
    }
    Stack::general(layers, base)
}

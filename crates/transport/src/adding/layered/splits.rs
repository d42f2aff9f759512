//! The directions between which the nodes of a grid are placed: indices of media, and where the kernels of
//! layers jump or have kinks.

use super::grid::Density;
use super::prepare::indices;
use crate::Stack;

/// Returns the directions at which the nodes of a wavelength are split.
pub(super) fn splits(stack: &Stack, bin: usize) -> Splits {
    let mut kinks: Vec<f64> = stack.elements().flat_map(|(kind, _)| kind.kinks()).collect();
    kinks.sort_by(f64::total_cmp);
    kinks.dedup();
    Splits { kinks, ..smooth_splits(stack, bin) }
}

/// The same for light that is smooth at kinks, or smoothed.
pub(super) fn smooth_splits(stack: &Stack, bin: usize) -> Splits {
    let mut splits = indices(stack, bin);
    splits.extend(stack.elements().flat_map(|(kind, _)| kind.edges(bin)));
    splits.sort_by(f64::total_cmp);
    splits.dedup();
    Splits { indices: splits, kinks: Vec::new() }
}

/// A range of `|beta|`, its number of nodes, and whether roots are removed at its ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Between {
    pub(super) ends: [f64; 2],
    pub(super) count: usize,
    pub(super) roots: bool,
}

/// The `|beta|` between which nodes are placed, each list ascending.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Splits {
    /// Indices, and other places at which light jumps or has a root.
    pub(super) indices: Vec<f64>,
    /// Kinks of the kernels of surfaces.
    pub(super) kinks: Vec<f64>,
}

impl Splits {
    /// Indices alone.
    #[cfg(test)]
    pub(super) fn at(indices: &[f64]) -> Self {
        Self { indices: indices.to_vec(), kinks: Vec::new() }
    }

    /// Ranges of nodes of a density.
    pub(super) fn ranges(&self, density: &Density) -> Vec<Between> {
        let mut ends: Vec<f64> = self.indices.iter().chain(&self.kinks).copied().collect();
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        ends.retain(|end| Some(end) <= self.indices.last());
        let starts = std::iter::once(0.0).chain(ends.iter().copied());
        let range = |(a, b): (f64, f64)| {
            if self.kinks.is_empty() {
                return Between { ends: [a, b], count: density.count(a, b), roots: true };
            }
            let roots = [a, b].iter().any(|end| self.indices.contains(end));
            let few = (density.least / 4).max(2) + if roots { 2 } else { 0 };
            Between { ends: [a, b], count: few.max(density.count(a, b) - density.least), roots }
        };
        starts.zip(ends.iter().copied()).map(range).collect()
    }
}

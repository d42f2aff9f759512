//! What is prepared of a stack before its base is known.

use super::base::Above;
use super::convergence::{Convergence, Stage};
use super::directions::{Directions, extras};
use super::elements::{Element, compose, elements};
use super::grid::Grid;
use super::part::{Absorbed, nothing};
use super::precision::{Precision, density};
use super::scatterers::{Scattered, Scatterers};
use crate::{Interface, Layered};

/// Wavelengths at which the layers above the base are alike, and what these do.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) bins: Vec<usize>,
    pub(super) grid: Grid,
    /// Index of the medium above the base.
    pub(super) index: f64,
    /// By azimuthal order.
    pub(super) orders: Vec<Above>,
    /// Extra nodes of the sources' rays, ascending.
    pub(super) lights: Vec<usize>,
    /// Of light from above at each node, the share that arrives at the base.
    pub(super) arriving: Vec<f64>,
    /// Of light that rises from the base, the share that returns to it.
    pub(super) returning: Vec<f64>,
    /// Of light that rises from the base, the share that leaves.
    pub(super) leaving: Vec<f64>,
    /// Of light from above, the share that leaves without having met the base.
    pub(super) leaving_front: Vec<f64>,
    /// Absorbed shares of light from above and of light that rises from the base.
    pub(super) absorbed: [Absorbed; 2],
}

/// All groups, prepared.
pub(super) fn groups(stack: &Layered, directions: &Directions, precision: &Precision) -> Vec<Group> {
    let mut kinds: Vec<(Vec<u64>, Vec<usize>)> = Vec::new();
    for bin in 0..stack.base.bins() {
        let key = optics(stack, bin);
        match kinds.iter_mut().find(|(known, _)| *known == key) {
            Some((_, bins)) => bins.push(bin),
            None => kinds.push((key, vec![bin])),
        }
    }
    // Groups of the same indices share their nodes, and what scatters.
    let mut families: Vec<(Vec<f64>, Vec<Vec<usize>>)> = Vec::new();
    for (_, bins) in kinds {
        let indices = indices(stack, bins[0]);
        match families.iter_mut().find(|(known, _)| *known == indices) {
            Some((_, family)) => family.push(bins),
            None => families.push((indices, vec![bins])),
        }
    }
    families.into_iter().flat_map(|(_, family)| prepare(stack, family, directions, precision)).collect()
}

/// Indices of all media at a wavelength, air first.
fn indices(stack: &Layered, bin: usize) -> Vec<f64> {
    std::iter::once(1.0).chain(stack.layers.iter().map(|layer| layer.medium.index()[bin])).collect()
}

/// Everything that the layers above the base depend on at a wavelength.
fn optics(stack: &Layered, bin: usize) -> Vec<u64> {
    let mut key = Vec::new();
    for layer in &stack.layers {
        match &layer.interface {
            Interface::Sheet { reflectance, absorptance } => {
                key.extend([reflectance[bin].to_bits(), absorptance[bin].to_bits()]);
            }
            Interface::Coating(_) => key.push(bin as u64),
            Interface::Diffuser(diffuser) => key.push(diffuser.transmittance[bin].to_bits()),
            Interface::Open | Interface::Coated | Interface::Fresnel | Interface::Rough(_) => {}
        }
        key.push(layer.medium.index()[bin].to_bits());
        key.extend(layer.medium.transmittance().map(|t| t[bin].to_bits()));
        key.extend(layer.medium.scattering().map(|s| s.albedo[bin].to_bits()));
    }
    key
}

/// Where the nodes of a wavelength are split, ascending.
fn splits(stack: &Layered, bin: usize) -> Vec<f64> {
    let mut splits = indices(stack, bin);
    splits.sort_by(f64::total_cmp);
    splits.dedup();
    splits
}

/// Nodes with weight that the stack takes at most, over its wavelengths.
pub(super) fn nodes_needed(stack: &Layered, precision: &Precision) -> usize {
    let at = |bin| density(stack, bin, precision).total(&splits(stack, bin));
    (0..stack.base.bins()).map(at).max().unwrap_or(0)
}

/// Groups of wavelengths at which all indices are alike.
fn prepare(
    stack: &Layered,
    family: Vec<Vec<usize>>,
    directions: &Directions,
    precision: &Precision,
) -> Vec<Group> {
    let first = family[0][0];
    let index = stack.layers.last().map_or(1.0, |layer| layer.medium.index()[first]);
    let mut grid = Grid::new(&splits(stack, first), density(stack, first, precision), &directions.beta);
    let lights = extras(&directions.sources);
    let mut scatterers = Scatterers::default();
    let mut growing: Vec<Growing<'_>> = family
        .into_iter()
        .map(|bins| {
            let beyond_first = !lights.is_empty();
            let elements = elements(stack, bins[0], &grid, precision, beyond_first, &mut scatterers);
            let convergence = Convergence::new(extras(&directions.views), lights.clone());
            let group = Group {
                bins,
                grid: grid.clone(),
                index,
                orders: Vec::new(),
                lights: lights.clone(),
                arriving: Vec::new(),
                returning: Vec::new(),
                leaving: Vec::new(),
                leaving_front: Vec::new(),
                absorbed: [nothing(0), nothing(0)],
            };
            Growing { group, elements, convergence, stage: Stage::All }
        })
        .collect();
    for order in 0.. {
        let beyond = order >= scatterers.orders().max(1);
        if grid.regular > 0 && (beyond || growing.iter().all(|one| one.stage != Stage::All)) {
            scatterers = scatterers.extras(&grid);
            grid = grid.extras();
        }
        let scattered = scatterers.scattered(order, &grid);
        for one in growing.iter_mut().filter(|one| one.stage != Stage::Done) {
            one.grow(&scattered, order, &grid, precision.tolerance);
        }
        if growing.iter().all(|one| one.stage == Stage::Done) {
            break;
        }
    }
    growing.into_iter().map(|one| one.group).collect()
}

/// A group on its way.
struct Growing<'a> {
    group: Group,
    elements: Vec<Element<'a>>,
    convergence: Convergence,
    stage: Stage,
}

impl Growing<'_> {
    /// Adds an order.
    fn grow(&mut self, scattered: &[Scattered], order: usize, grid: &Grid, tolerance: f64) {
        let part = compose(&self.elements, scattered, order, grid);
        let group = &mut self.group;
        if let Some(absorbed) = &part.absorbed {
            let (air, medium) = (grid.below(1.0), grid.below(group.index));
            group.arriving = part.down.pull_back(&medium, &grid.scale);
            group.returning = part.below.pull_back(&medium, &grid.scale);
            group.leaving = part.down.transposed().pull_back(&air, &grid.scale);
            group.leaving_front = part.above.pull_back(&air, &grid.scale);
            group.absorbed = absorbed.clone();
        }
        group.orders.push(Above::new(&part, &group.lights));
        self.stage = self.convergence.add(&part, tolerance);
    }
}

//! Scattering interfaces between the nodes of the grid, order by order.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use num_complex::Complex64;

use super::super::algebra::Operator;
use super::super::elements::{actions, sum_of};
use super::super::grid::Grid;
use super::super::known::Known;
use super::super::matrix::Matrix;
use super::super::precision::Precision;
use super::super::scatterers::{Scattered, Scatterers};
use super::NotCovered;
use super::orders::Orders;
use crate::Stack;
use crate::layers::Action;

/// Light at each site: two for each scatterer. Of light that arrives from above and from below, or that it
/// emits upwards and downwards. `None` without light.
pub(super) type Light = Vec<Option<Orders>>;

/// Largest `|beta|` whose azimuthal orders are resolved.
const ALONG: f64 = 0.95;

/// Most nodes times orders, positive and negative.
const MOST_NUMBERS: usize = 1 << 18;

/// Most lobes of light in one way: faces by waves have some twenty, whose orders take minutes.
const MOST_LOBES: usize = 4;

/// Orders that are dropped, relative to the accuracy of the level.
const DROPPED: f64 = 0.5;

/// Kernel of an order, scaled.
#[derive(Debug)]
struct Kernel {
    /// Nodes below this one have no light of the order.
    first: usize,
    /// Between the nodes with weight from there on.
    block: Matrix,
    /// From extra nodes to nodes with weight, and the other way; `[node, extra]`.
    beams: [Matrix; 2],
}

impl Kernel {
    /// `least` is the smallest element that matters.
    fn new((kernel, factor): &(Arc<Matrix>, f64), (regular, extras): (usize, usize), least: f64) -> Self {
        let matters = |i: usize| {
            let elements = (0..regular).flat_map(|j| [kernel[(i, j)], kernel[(j, i)]]);
            elements.map(|element| (factor * element).abs()).any(|element| element > least)
        };
        let first = (0..regular).find(|i| matters(*i)).unwrap_or(regular);
        let block =
            Matrix::from_fn(regular - first, regular - first, |i, j| factor * kernel[(first + i, first + j)]);
        let from = Matrix::from_fn(regular, extras, |i, extra| factor * kernel[(i, regular + extra)]);
        let to = Matrix::from_fn(regular, extras, |j, extra| factor * kernel[(regular + extra, j)]);
        Self { first, block, beams: [from, to] }
    }
}

/// All scatterers of a stack at one wavelength.
#[derive(Debug)]
pub(super) struct Kernels {
    /// Numbers of the scattering elements.
    pub(super) elements: Vec<usize>,
    /// Transmission from above, reflection from above, reflection from below; `[order][scatterer]`.
    orders: Vec<Vec<[Option<Kernel>; 3]>>,
    scale: Vec<f64>,
    regular: usize,
    /// Highest order at each node with weight.
    of_nodes: Vec<usize>,
    /// Highest order of light that is scattered towards each extra node, `[scatterer][extra]`.
    of_extras: Vec<Vec<usize>>,
    /// Orders that are smaller than others of the same node by this factor are dropped.
    tolerance: f64,
}

impl Kernels {
    pub(super) fn new(
        stack: &Stack,
        bin: usize,
        grid: &Grid,
        precision: &Precision,
        stop: &AtomicBool,
    ) -> Result<Self, NotCovered> {
        let known = Known::default();
        let mut scatterers = Scatterers::default();
        let farthest = grid.beta[grid.regular..].iter().copied().fold(0.0, f64::max);
        let alone = stack.elements().filter(|(kind, _)| kind.scatters()).count() == 1;
        // Of a single scatterer, orders of light on both circles are those of one with half of their radius.
        // Along the layers kernels have no largest order, and there is no light.
        let circle = if alone { (2.0 * farthest).max(ALONG) } else { ALONG };
        let (both, of) = ([circle; 2], (grid, precision));
        let actions = actions(stack, bin, of, (Some(both), false), &known, &mut scatterers, stop);
        if stop.load(Ordering::Relaxed) {
            return Err(NotCovered::Stopped);
        }
        let (mut elements, mut ways) = (Vec::new(), Vec::new());
        for (element, action) in actions.into_iter().enumerate() {
            match action {
                None | Some(Action::Regular | Action::Clear { .. }) => {}
                Some(Action::Kernels(kernels)) if kernels.iter().all(Vec::is_empty) => {}
                Some(Action::Slab { .. }) => return Err(NotCovered::Slab),
                Some(Action::Kernels(kernels)) if kernels.iter().any(|lobes| lobes.len() > MOST_LOBES) => {
                    return Err(NotCovered::Waves);
                }
                Some(action @ (Action::Whole { .. } | Action::Kernels(_))) => {
                    elements.push(element);
                    ways.push(action);
                }
            }
        }
        let tolerance = (-precision.digits).exp();
        let mut largest = vec![[[0.0_f64; 2]; 3]; elements.len()];
        let mut kernels = Self {
            elements,
            orders: Vec::new(),
            scale: grid.scale.clone(),
            regular: grid.regular,
            of_nodes: vec![0; grid.regular],
            of_extras: Vec::new(),
            tolerance: DROPPED * tolerance,
        };
        for order in 0..scatterers.orders() {
            let scattered = scatterers.scattered(order, grid);
            let of_order: Vec<[Given; 3]> = ways.iter().map(|action| ways_of(action, &scattered)).collect();
            // Each kernel has a scale of its own, and so has its light of beams: a weak one beside a narrow
            // lobe matters, too.
            let mut matters = false;
            for (given, largest) in of_order.iter().flatten().zip(largest.iter_mut().flatten()) {
                let Some(given) = given else { continue };
                for (size, largest) in sizes(given, grid.regular).into_iter().zip(largest) {
                    *largest = largest.max(size);
                    matters |= size > tolerance * *largest;
                }
            }
            if !matters {
                break;
            }
            if grid.len() * (2 * order + 1) > MOST_NUMBERS {
                return Err(NotCovered::TooMany);
            }
            let count = (grid.regular, grid.len() - grid.regular);
            let kernel = |(given, [largest, _]): (&Given, &[f64; 2])| {
                given.as_ref().map(|given| Kernel::new(given, count, tolerance * largest))
            };
            let of_order: Vec<[Option<Kernel>; 3]> = of_order
                .iter()
                .zip(&largest)
                .map(|(ways, largest)| [0, 1, 2].map(|way| kernel((&ways[way], &largest[way]))))
                .collect();
            let first = of_order.iter().flatten().flatten().map(|kernel| kernel.first).min();
            kernels.of_nodes[first.unwrap_or(grid.regular)..].fill(order);
            kernels.orders.push(of_order);
        }
        let of_site = |site| (0..kernels.extras()).map(|extra| kernels.of_extra(site, extra)).collect();
        kernels.of_extras = (0..kernels.elements.len()).map(of_site).collect();
        Ok(kernels)
    }

    /// Returns the highest order that matters of light between a scatterer and an extra node.
    fn of_extra(&self, site: usize, extra: usize) -> usize {
        let mut largest = vec![0.0_f64; self.regular];
        let mut highest = 0;
        for (order, sites) in self.orders.iter().enumerate() {
            for (node, largest) in largest.iter_mut().enumerate() {
                let kernels = sites[site].iter().flatten();
                let size = kernels
                    .flat_map(|kernel| kernel.beams.iter().map(|beam| beam[(node, extra)].abs()))
                    .fold(0.0, f64::max);
                *largest = largest.max(size);
                if size > self.tolerance * *largest {
                    highest = order;
                }
            }
        }
        highest
    }

    /// Returns the highest order at each node with weight.
    pub(super) fn of_nodes(&self) -> &[usize] {
        &self.of_nodes
    }

    /// Returns the number of extra nodes.
    pub(super) fn extras(&self) -> usize {
        self.scale.len() - self.regular
    }

    /// Returns the effect on light of what scatterers emit, for light in several problems: what it has when
    /// it arrives there.
    pub(super) fn arriving(&self, emitted: &[Light]) -> Vec<Light> {
        let mut arriving: Vec<Light> = emitted.iter().map(|_| vec![None; 2 * self.elements.len()]).collect();
        for site in 0..self.elements.len() {
            let highest_of = |k: usize| {
                let sides = emitted[k][2 * site..][..2].iter().flatten();
                sides.map(Orders::highest).max()
            };
            let mut problems: Vec<(usize, usize)> =
                (0..emitted.len()).filter_map(|k| Some((k, highest_of(k)?))).collect();
            for (problem, highest) in &problems {
                let highest = (*highest).min(self.orders.len().saturating_sub(1));
                arriving[*problem][2 * site..][..2].fill(Some(Orders::zeros(self.regular, highest)));
            }
            for (order, sites) in self.orders.iter().enumerate() {
                problems.retain(|(_, highest)| *highest >= order);
                let kernels = || sites[site].iter().flatten();
                let first = kernels().map(|kernel| kernel.first).min().unwrap_or(self.regular);
                if problems.is_empty() || first == self.regular {
                    continue;
                }
                let light =
                    [0, 1].map(|side| self.columns(emitted, (&problems, first), 2 * site + side, order));
                let [up, down] = light.each_ref().map(Option::as_ref);
                let [through, above, below] = sites[site].each_ref().map(Option::as_ref);
                let columns = 4 * problems.len();
                let mut sums = [0, 1].map(|_| Matrix::zeros(self.regular - first, columns));
                let ways = [(through, down, 0), (through, up, 1), (above, up, 0), (below, down, 1)];
                for (number, (kernel, light, side)) in ways.into_iter().enumerate() {
                    let (Some(kernel), Some(light)) = (kernel, light) else { continue };
                    // Light that is transmitted up takes the reverse of what goes down.
                    let reversed = number == 0;
                    sums[side].add_block_product((&kernel.block, kernel.first - first), light, reversed);
                }
                for (side, sum) in sums.iter().enumerate() {
                    self.spread(sum, (&problems, first), order, 2 * site + side, &mut arriving);
                }
            }
        }
        arriving.iter_mut().for_each(|light| self.settle(light));
        arriving
    }

    /// Drops orders that do not matter, and sides without light.
    pub(super) fn settle(&self, light: &mut Light) {
        for light in light {
            light.take_if(|light| light.largest() == 0.0);
            light.iter_mut().for_each(|light| light.settle(self.tolerance));
        }
    }

    /// Returns an order and its negative of light in some problems, real and imaginary parts, scaled, at the
    /// nodes from `first` on.
    fn columns(
        &self,
        light: &[Light],
        (problems, first): (&[(usize, usize)], usize),
        site: usize,
        order: usize,
    ) -> Option<Matrix> {
        let mut columns = None;
        for (number, (problem, _)) in problems.iter().enumerate() {
            let Some(light) = light[*problem][site].as_ref().filter(|light| light.highest() >= order) else {
                continue;
            };
            let columns =
                columns.get_or_insert_with(|| Matrix::zeros(self.regular - first, 4 * problems.len()));
            for (part, order) in [order as isize, -(order as isize)].into_iter().enumerate() {
                for node in first..self.regular {
                    let value = light.at(node, order) / self.scale[node];
                    columns[(node - first, 4 * number + 2 * part)] = value.re;
                    columns[(node - first, 4 * number + 2 * part + 1)] = value.im;
                }
            }
        }
        columns
    }

    /// Writes such columns to the light of problems.
    fn spread(
        &self,
        columns: &Matrix,
        (problems, first): (&[(usize, usize)], usize),
        order: usize,
        site: usize,
        light: &mut [Light],
    ) {
        for (number, (problem, _)) in problems.iter().enumerate() {
            let Some(light) = &mut light[*problem][site] else { continue };
            for (part, order) in [order as isize, -(order as isize)].into_iter().enumerate() {
                let [re, im] = [0, 1].map(|k| columns.column(4 * number + 2 * part + k));
                for node in first..self.regular {
                    let value = Complex64::new(re[node - first], im[node - first]);
                    *light.at_mut(node, order) = value / self.scale[node];
                }
            }
        }
    }

    /// Adds what a beam sees: what light has when it arrives at a scatterer and is emitted towards an extra
    /// node, upwards and downwards with these factors, at an azimuth.
    pub(super) fn add_beam(
        &self,
        site: usize,
        (extra, turn): (usize, Option<f64>),
        [up, down]: [Complex64; 2],
        [from_above, from_below]: &mut [Option<Orders>; 2],
    ) {
        // A whole ring has order 0 alone.
        let highest = if turn.is_some() { self.of_extras[site][extra] } else { 0 };
        for light in [&mut *from_above, &mut *from_below] {
            light.get_or_insert_with(|| Orders::zeros(self.regular, highest)).grow(highest);
        }
        for (order, sites) in self.orders.iter().enumerate().take(highest + 1) {
            let [through, above, below] = &sites[site];
            let at = |kernel: &Option<Kernel>, way: usize, node: usize| {
                kernel.as_ref().map_or(0.0, |kernel| kernel.beams[way][(node, extra)])
            };
            let phase = Complex64::cis(-turn.unwrap_or(0.0) * order as f64);
            for node in 0..self.regular {
                let scale = 1.0 / self.scale[node];
                let a = scale * (down * at(through, TO, node) + up * at(above, TO, node));
                let b = scale * (up * at(through, FROM, node) + down * at(below, TO, node));
                for (light, value) in [(&mut *from_above, a), (&mut *from_below, b)] {
                    let Some(light) = light else { continue };
                    *light.at_mut(node, order as isize) += value * phase;
                    if order > 0 {
                        *light.at_mut(node, -(order as isize)) += value * phase.conj();
                    }
                }
            }
        }
    }
}

/// Kernel and its factor.
type Given = Option<(Arc<Matrix>, f64)>;

/// Ways of [`Kernel::beams`].
const FROM: usize = 0;
const TO: usize = 1;

/// Returns the kernels of a scatterer in an order.
fn ways_of(action: &Action, scattered: &[Scattered]) -> [Given; 3] {
    let kernel = |operator: &Operator, factor: f64| operator.kernel.clone().map(|kernel| (kernel, factor));
    match action {
        Action::Whole { number } => match &scattered[*number] {
            Scattered::Whole(part) => [&part.down, &part.above, &part.below].map(|one| kernel(one, 1.0)),
            Scattered::Kernel(_) => [None, None, None],
        },
        Action::Kernels(ways) => {
            ways.each_ref().map(|way| sum_of(way, scattered).and_then(|(sum, factor)| kernel(&sum, factor)))
        }
        Action::Regular | Action::Clear { .. } | Action::Slab { .. } => [None, None, None],
    }
}

/// Returns the largest element of a kernel between nodes with weight, and between them and extra nodes.
fn sizes((kernel, factor): &(Arc<Matrix>, f64), regular: usize) -> [f64; 2] {
    let mut sizes = [0.0_f64; 2];
    for j in 0..kernel.columns() {
        let (nodes, extras) = kernel.column(j).split_at(regular);
        let largest = |all: &[f64]| all.iter().fold(0.0, |most: f64, x| most.max((factor * x).abs()));
        sizes[usize::from(j >= regular)] = sizes[usize::from(j >= regular)].max(largest(nodes));
        if j < regular {
            sizes[1] = sizes[1].max(largest(extras));
        }
    }
    sizes
}

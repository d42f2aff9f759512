//! A rough interface as azimuthal orders on a grid.
//!
//! The kernel of [`Rough`] has no closed Fourier series: it is sampled over the azimuth ([`transforms`]).
//!
//! The fractions of light that return to each side and that cross are known independently of the nodes, from
//! the quadrature of the optics. Over the nodes refracted light converges slowly, as it jumps to zero where
//! microfacets are vertical. Its kernel is multiplied by a factor for each direction on either side, which
//! makes the light that crosses correct from both sides and keeps the kernel reciprocal. The light that
//! reflection then lacks is reflected regularly, so that none is lost.

mod surface;
mod transforms;

use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use papilio_optics::rough::{Rough, Side};

use super::algebra::Operator;
use super::azimuth::Sampling;
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::Part;
pub(super) use surface::inside_width;
pub(super) use transforms::azimuth_width;
use transforms::{Transforms, orders};

/// Orders of a rough interface's kernel: from above to above, from above to below, from below to below. Far from a
/// peak they nearly cancel, which takes double precision.
#[derive(Debug, Clone)]
pub(super) struct RoughOrders {
    zeroth: [Matrix; 3],
    /// `[order - 1][kernel]`, each indexed by [`place`].
    later: Vec<[Vec<f64>; 3]>,
    /// Factors of the light that crosses, by node above and below.
    factors: [Vec<f64>; 2],
    /// Light of each node that returns to its side, from above and from below.
    returned: [Vec<f64>; 2],
    /// Light of each node that the quadrature misses, from above and from below.
    missing: [Vec<f64>; 2],
    /// The nodes with weight.
    nodes: Vec<f64>,
}

const WAYS: [(Side, Side); 3] =
    [(Side::Above, Side::Above), (Side::Above, Side::Below), (Side::Below, Side::Below)];

impl RoughOrders {
    /// Computes the orders; those beyond the first only if they are requested, for light scattered on circles
    /// of this `|beta|`. Light that one microfacet scatters from one extra node to another is left out
    /// ([`once`](super::once)). What `known`, the orders for other extra nodes, contains is not computed
    /// again.
    pub(super) fn new(
        face: &Rough,
        beyond_first: Option<f64>,
        sampling: Sampling<'_>,
        known: Option<&Self>,
    ) -> Self {
        let Sampling { grid, digits, stop } = sampling;
        let count = beyond_first.map_or(1, |radius| orders(face, radius, digits));
        let (len, regular) = (grid.len(), grid.regular);
        let (mut all, known) = Self::between_nodes(grid, count, known);
        let mut transforms = Transforms::new(count, digits);
        let edge = Edge::new(face, grid);
        for (way, (from, to)) in WAYS.into_iter().enumerate() {
            for j in (0..len).filter(|&j| grid.beta[j] < face.index(from)) {
                if stop.load(Ordering::Relaxed) {
                    return all;
                }
                let first = if from == to { j } else { 0 };
                let among = if known.is_some() && j < regular { 0..0 } else { first.min(regular)..regular };
                let extras = if j < regular { regular..len } else { 0..0 };
                // Apart, so that their sums do not depend on the number of extra nodes.
                for rows in [among, extras] {
                    let rows = rows.filter(|&i| grid.beta[i] < face.index(to));
                    for (i, values) in transforms.column(face, (from, j), to, rows, (grid, &edge)) {
                        let lit = if from == to { 1.0 } else { edge.lit(j, i) };
                        let scale = grid.scale[i] * grid.scale[j] * lit;
                        all.set(way, i, j, len, &values, scale);
                        if from == to {
                            all.set(way, j, i, len, &values, scale);
                        }
                    }
                }
            }
        }
        all.balance(face, grid, digits as usize + 7, known);
        all.missing = missing(face, &all.part(face, 0, grid), grid);
        all
    }

    /// Returns this number of orders, of zeros but between nodes with weight if `known` has as many; and
    /// `known` if so.
    fn between_nodes<'k>(grid: &Grid, count: usize, known: Option<&'k Self>) -> (Self, Option<&'k Self>) {
        let known = known.filter(|known| known.orders() == count);
        let mut all = blank(grid, count);
        if let Some(known) = known {
            all.copy(known);
        }
        (all, known)
    }

    /// Copies the kernels between nodes with weight.
    fn copy(&mut self, known: &Self) {
        let (len, before, regular) = (self.zeroth[0].columns(), known.zeroth[0].columns(), self.nodes.len());
        for (zeroth, known) in self.zeroth.iter_mut().zip(&known.zeroth) {
            for j in 0..regular {
                zeroth.column_mut(j)[..regular].copy_from_slice(&known.column(j)[..regular]);
            }
        }
        for (order, known) in self.later.iter_mut().zip(&known.later) {
            for (way, (kernel, known)) in order.iter_mut().zip(known).enumerate() {
                if WAYS[way].0 == WAYS[way].1 {
                    let places = places(way, regular);
                    kernel[..places].copy_from_slice(&known[..places]);
                } else {
                    for j in 0..regular {
                        kernel[j * len..][..regular].copy_from_slice(&known[j * before..][..regular]);
                    }
                }
            }
        }
    }

    /// Determines the light that crosses, from both sides, by a rule of this order: finer from level to
    /// level, so that its error shows in their difference.
    fn balance(&mut self, face: &Rough, grid: &Grid, order: usize, known: Option<&Self>) {
        let len = grid.len();
        // Light that single microfacets should send across, of which the nodes miss some.
        let part = self.part(face, 0, grid);
        let ones = vec![1.0; len];
        let single = Operator { kernel: Some(Arc::new(self.zeroth[1].clone())), ..part.down.clone() };
        self.returned = self.fractions_returned(face, grid, order, known);
        let goal = |side: Side, whole: &Operator, single: &Operator| -> Vec<f64> {
            let [whole, single] = [whole, single].map(|operator| operator.pull_back(&ones, &grid.scale));
            let returned = &self.returned[side as usize];
            let one = |i: usize| {
                single[i] + if grid.beta[i] < face.index(side) { 1.0 - returned[i] - whole[i] } else { 0.0 }
            };
            (0..len).map(one).collect()
        };
        let goals = [
            goal(Side::Above, &part.down, &single),
            goal(Side::Below, &part.down.transposed(), &single.transposed()),
        ];
        self.factors = factors(&self.zeroth[1], goals, grid);
    }

    /// Returns the light of each node that returns to its side, from above and from below.
    fn fractions_returned(
        &self,
        face: &Rough,
        grid: &Grid,
        order: usize,
        known: Option<&Self>,
    ) -> [Vec<f64>; 2] {
        let regular = grid.regular;
        [Side::Above, Side::Below].map(|side| match known {
            Some(known) => {
                let extras = face.returned(side, &grid.beta[regular..], order);
                [&known.returned[side as usize][..regular], &extras].concat()
            }
            None => face.returned(side, &grid.beta, order),
        })
    }

    fn set(&mut self, way: usize, out: usize, from: usize, len: usize, values: &[f64], scale: f64) {
        self.zeroth[way][(out, from)] = values[0] * scale;
        // As many as the rule resolves; the others are zero.
        for (order, value) in self.later.iter_mut().zip(&values[1..]) {
            order[way][place(way, out, from, len)] = value * scale;
        }
    }

    /// Returns the nodes with weight.
    pub(super) fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Returns the size in bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * (3 + 2 * self.later.len()) * self.zeroth[0].columns().pow(2)
    }

    /// Returns the number of orders.
    pub(super) fn orders(&self) -> usize {
        1 + self.later.len()
    }

    /// Returns the light of each node that the quadrature misses, from above and from below, which is
    /// reflected regularly.
    pub(super) fn missing_straight(&self) -> &[Vec<f64>; 2] {
        &self.missing
    }

    /// Returns the part of the interface in an order.
    pub(super) fn part(&self, face: &Rough, order: usize, grid: &Grid) -> Part {
        let len = grid.len();
        let operator = |way: usize| {
            let mut kernel = match order.checked_sub(1) {
                None => Some(self.zeroth[way].clone()),
                Some(later) => self
                    .later
                    .get(later)
                    .map(|kernels| Matrix::from_fn(len, len, |i, j| kernels[way][place(way, i, j, len)])),
            };
            if let Some(kernel) = kernel.as_mut().filter(|_| WAYS[way].0 != WAYS[way].1) {
                let [above, below] = &self.factors;
                for (from, column) in kernel.columns_mut() {
                    column.iter_mut().zip(below).for_each(|(value, below)| *value *= above[from] * below);
                }
            }
            Operator { regular: grid.regular, straight: vec![0.0; len], kernel: kernel.map(Arc::new) }
        };
        let [above, down, below] = [operator(0), operator(1), operator(2)];
        let mut part = Part { above, below, down, absorbed: None };
        if order == 0 {
            add_multiple_scattering(face, grid, &mut part);
        }
        for (operator, missing) in [&mut part.above, &mut part.below].into_iter().zip(&self.missing) {
            operator.straight.iter_mut().zip(missing).for_each(|(straight, missing)| *straight += missing);
        }
        part
    }
}

/// Returns the factors of a kernel at each node above and below that make it send these fractions of each
/// node's light from above and from below (R. Sinkhorn, P. Knopp, Pacific J. Math. 21, 343 (1967)). The
/// remaining error is at most the difference of the nodes' own sums of both.
fn factors(kernel: &Matrix, [from_above, from_below]: [Vec<f64>; 2], grid: &Grid) -> [Vec<f64>; 2] {
    /// Sweeps: each leaves a tenth of the error or less, except for small errors common to many nodes.
    const SWEEPS: usize = 12;
    /// Largest factor: where the nodes miss more than this, factors do not correct it.
    const MOST: f64 = 4.0;
    let len = grid.len();
    let back = kernel.transposed();
    let next = |kernel: &Matrix, goal: &[f64], others: &[f64]| -> Vec<f64> {
        let one = |j: usize| {
            let terms = kernel.column(j)[..grid.regular].iter().zip(others).zip(&grid.scale);
            let found: f64 = terms.map(|((k, other), scale)| k * other * scale).sum();
            if found > 0.0 { (goal[j] * grid.scale[j] / found).clamp(1.0 / MOST, MOST) } else { 1.0 }
        };
        (0..len).map(one).collect()
    };
    let (mut above, mut below) = (vec![1.0; len], vec![1.0; len]);
    for _ in 0..SWEEPS {
        below = next(&back, &from_below, &above);
        above = next(kernel, &from_above, &below);
    }
    [above, below]
}

/// Returns kernels of zeros, of this number of orders.
fn blank(grid: &Grid, count: usize) -> RoughOrders {
    let len = grid.len();
    let zeroth = || Matrix::zeros(len, len);
    let later = || -> [Vec<f64>; 3] { std::array::from_fn(|way| vec![0.0; places(way, len)]) };
    RoughOrders {
        zeroth: [zeroth(), zeroth(), zeroth()],
        // Allocated separately: copies would touch the memory of zeros.
        later: (1..count).map(|_| later()).collect(),
        factors: [vec![1.0; len], vec![1.0; len]],
        returned: Default::default(),
        missing: Default::default(),
        nodes: grid.beta[..grid.regular].to_vec(),
    }
}

/// Returns the number of elements of a kernel between `len` nodes: reflections are symmetric.
fn places(way: usize, len: usize) -> usize {
    let (from, to) = WAYS[way];
    if from == to { len * (len + 1) / 2 } else { len * len }
}

/// Returns the index of a pair of nodes among them.
fn place(way: usize, out: usize, from: usize, len: usize) -> usize {
    let (side, to) = WAYS[way];
    let (less, more) = (out.min(from), out.max(from));
    if side == to { more * (more + 1) / 2 + less } else { from * len + out }
}

/// Returns the light of each node that the quadrature misses, from above and from below.
fn missing(face: &Rough, part: &Part, grid: &Grid) -> [Vec<f64>; 2] {
    let ones = vec![1.0; grid.len()];
    let missing = |side: Side, back: &Operator, through: &Operator| {
        let [back, through] = [back, through].map(|operator| operator.pull_back(&ones, &grid.scale));
        let one = |i: usize| if grid.beta[i] < face.index(side) { 1.0 - back[i] - through[i] } else { 0.0 };
        (0..grid.len()).map(one).collect()
    };
    [
        missing(Side::Above, &part.above, &part.down),
        missing(Side::Below, &part.below, &part.down.transposed()),
    ]
}

/// Adds the light that meets several microfacets, the same at all azimuths: back in proportion to what each
/// direction sends back, across in proportion to what it sends across.
fn add_multiple_scattering(face: &Rough, grid: &Grid, part: &mut Part) {
    let several = |side: Side, way: usize| -> Vec<f64> {
        let one = |i: usize| {
            if grid.beta[i] < face.index(side) { face.several(side, grid.beta[i])[way] } else { 0.0 }
        };
        (0..grid.len()).map(|i| one(i) * grid.scale[i]).collect()
    };
    let [back, across] = [0, 1].map(|way| [Side::Above, Side::Below].map(|side| several(side, way)));
    for ((from, to), operator, outward, inward) in [
        (WAYS[0], &mut part.above, &back[0], &back[0]),
        (WAYS[1], &mut part.down, &across[1], &across[0]),
        (WAYS[2], &mut part.below, &back[1], &back[1]),
    ] {
        let total = face.several_total(from, to);
        // An interface of few and gentle slopes has no shadowing.
        if let Some(kernel) = operator.kernel.as_mut().filter(|_| total > 0.0) {
            let len = outward.len();
            *kernel =
                Matrix::from_fn(len, len, |i, j| kernel[(i, j)] + outward[i] * inward[j] / total).into();
        }
    }
}

/// Border of refracted light: where microfacets are vertical, q is the same on both sides, and beyond that
/// there is none. If the border crosses a node's range of directions, the node is weighted by the fraction
/// that is lit.
struct Edge {
    /// Light crosses where `sign (|beta_below|^2 - |beta_above|^2)` is below the limit: 1 if the medium
    /// below is the denser one, -1 if not.
    sign: f64,
    limit: f64,
    /// Borders of each node's range of directions, in |beta|^2.
    shares: Vec<[f64; 2]>,
}

impl Edge {
    fn new(face: &Rough, grid: &Grid) -> Self {
        let [above, below] = [Side::Above, Side::Below].map(|side| face.index(side).powi(2));
        let mut end = 0.0;
        let mut share = |i: usize| {
            if i >= grid.regular {
                return [grid.beta[i].powi(2); 2];
            }
            let begin = end;
            end += grid.scale[i].powi(2) / PI;
            [begin, end]
        };
        Self {
            sign: (below - above).signum(),
            limit: (below - above).abs(),
            shares: (0..grid.len()).map(&mut share).collect(),
        }
    }

    /// Returns the lit fraction of the ranges of two nodes, above and below.
    fn lit(&self, above: usize, below: usize) -> f64 {
        let (thin, dense) = if self.sign > 0.0 { (above, below) } else { (below, above) };
        let ([x0, x1], [y0, y1]) = (self.shares[thin], self.shares[dense]);
        // Lit where y < x + limit.
        let (height, from, to) = (y1 - y0, x0 + self.limit - y0, x1 + self.limit - y0);
        let up_to = |u: f64| {
            if u <= 0.0 {
                0.0
            } else if u < height {
                0.5 * u * u / height
            } else {
                u - 0.5 * height
            }
        };
        if to > from {
            ((up_to(to) - up_to(from)) / (to - from)).clamp(0.0, 1.0)
        } else if height > 0.0 {
            (from / height).clamp(0.0, 1.0)
        } else {
            f64::from(u8::from(from > 0.0))
        }
    }

    /// Returns a `|beta|` below that is lit from this one above: this one if it is.
    fn within(&self, above: f64, below: f64) -> f64 {
        let edge = (above * above + self.sign * self.limit * (1.0 - 1e-9)).max(0.0).sqrt();
        if self.sign > 0.0 { below.min(edge) } else { below.max(edge) }
    }
}

/// Returns the width in direction cosines of the lobe into which light of this `|beta|` is refracted.
pub(in super::super) fn refraction_width(face: &Rough, beta: f64) -> f64 {
    let normal = |side: Side| (face.index(side).powi(2) - beta * beta).max(0.0).sqrt();
    face.alpha() * (normal(Side::Above) - normal(Side::Below)).abs().max(1e-9)
}

//! A rough face as azimuthal orders on a grid.
//!
//! The kernel of [`Rough`] has no closed Fourier series: it is sampled over the azimuth,
//! by the trapezoid rule, which converges exponentially.
//!
//! How much light returns to each side and how much crosses is known apart from all nodes, by the optics' own quadrature.
//! Over the nodes refracted light converges slowly, as it jumps to zero where facets stand upright: its kernel is multiplied by a factor for
//! each direction on either side that makes what crosses right from both, and stays reciprocal. What reflected light
//! lacks then is mirrored, so that none is lost.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_optics::Beta;
use papilio_optics::rough::{Rough, Side};

use super::algebra::Operator;
use super::azimuth::{MOST_INTERVALS, graded};
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::Part;

/// Azimuthal orders, at most.
const MOST_ORDERS: usize = 400;

/// The orders of a rough face's kernel: from above to above, from above to below, from below to
/// below; single precision serves all but order 0, which holds the energy.
#[derive(Debug, Clone)]
pub(super) struct RoughOrders {
    zeroth: [Matrix; 3],
    /// `[order - 1][kernel]`, each by [`place`].
    later: Vec<[Vec<f32>; 3]>,
    /// What the quadrature finds missing of each node's light, from above and from below.
    missing: [Vec<f64>; 2],
}

const WAYS: [(Side, Side); 3] =
    [(Side::Above, Side::Above), (Side::Above, Side::Below), (Side::Below, Side::Below)];

impl RoughOrders {
    /// To so many natural digits in azimuth; orders beyond the first only where they are asked for.
    /// What one microfacet sends from one extra node to another is left out ([`once`](super::once)). Not finished if `stop` is set before.
    pub(super) fn new(face: &Rough, grid: &Grid, digits: f64, beyond_first: bool, stop: &AtomicBool) -> Self {
        let count = if beyond_first { orders(face, digits) } else { 1 };
        let len = grid.len();
        let zeroth = || Matrix::zeros(len, len);
        let blank = || -> [Vec<f32>; 3] { std::array::from_fn(|way| vec![0.0; places(way, len)]) };
        let mut all = Self {
            zeroth: [zeroth(), zeroth(), zeroth()],
            // Each by itself: copies would touch what stays zero.
            later: (1..count).map(|_| blank()).collect(),
            missing: Default::default(),
        };
        let mut transforms = Transforms::new(count, digits, Edge::new(face, grid));
        for (way, (from, to)) in WAYS.into_iter().enumerate() {
            for j in (0..len).filter(|&j| grid.beta[j] < face.index(from)) {
                if stop.load(Ordering::Relaxed) {
                    return all;
                }
                let first = if from == to { j } else { 0 };
                let end = if j < grid.regular { len } else { grid.regular };
                let rows = (first.min(end)..end).filter(|&i| grid.beta[i] < face.index(to));
                for (i, values) in transforms.column(face, (from, j), to, rows, grid) {
                    let lit = if from == to { 1.0 } else { transforms.edge.lit(j, i) };
                    let scale = grid.scale[i] * grid.scale[j] * lit;
                    all.set(way, i, j, len, &values, scale);
                    if from == to {
                        all.set(way, j, i, len, &values, scale);
                    }
                }
            }
        }
        all.balance(face, grid, digits as usize + 7);
        all.missing = missing(face, &all.part(face, 0, grid), grid);
        all
    }

    /// Makes what crosses right, from both sides, by a rule of this order: finer from level to level, so that an error of it shows
    /// in their difference.
    fn balance(&mut self, face: &Rough, grid: &Grid, order: usize) {
        let len = grid.len();
        // What one facet should send across, of which the nodes miss something.
        let part = self.part(face, 0, grid);
        let ones = vec![1.0; len];
        let single = Operator { kernel: Some(self.zeroth[1].clone()), ..part.down.clone() };
        let goal = |side: Side, whole: &Operator, single: &Operator| -> Vec<f64> {
            let [whole, single] = [whole, single].map(|operator| operator.pull_back(&ones, &grid.scale));
            let returned = face.returned(side, &grid.beta, order);
            let one = |i: usize| {
                single[i] + if grid.beta[i] < face.index(side) { 1.0 - returned[i] - whole[i] } else { 0.0 }
            };
            (0..len).map(one).collect()
        };
        let goals = [
            goal(Side::Above, &part.down, &single),
            goal(Side::Below, &part.down.transposed(), &single.transposed()),
        ];
        let [above, below] = factors(&self.zeroth[1], goals, grid);
        for (from, column) in self.zeroth[1].columns_mut() {
            column.iter_mut().zip(&below).for_each(|(value, below)| *value *= above[from] * below);
        }
        for order in &mut self.later {
            for (from, column) in order[1].chunks_exact_mut(len).enumerate() {
                column
                    .iter_mut()
                    .zip(&below)
                    .for_each(|(value, below)| *value *= (above[from] * below) as f32);
            }
        }
    }

    fn set(&mut self, way: usize, out: usize, from: usize, len: usize, values: &[f64], scale: f64) {
        self.zeroth[way][(out, from)] = values[0] * scale;
        for (order, value) in self.later.iter_mut().zip(&values[1..]) {
            order[way][place(way, out, from, len)] = (value * scale) as f32;
        }
    }

    /// How many orders there are.
    pub(super) fn orders(&self) -> usize {
        1 + self.later.len()
    }

    /// What the quadrature finds missing of each node's light, from above and from below, which is mirrored.
    pub(super) fn missing_straight(&self) -> &[Vec<f64>; 2] {
        &self.missing
    }

    /// The face's part in an order.
    pub(super) fn part(&self, face: &Rough, order: usize, grid: &Grid) -> Part {
        let len = grid.len();
        let operator = |way: usize| {
            let kernel = match order.checked_sub(1) {
                None => Some(self.zeroth[way].clone()),
                Some(later) => self.later.get(later).map(|kernels| {
                    Matrix::from_fn(len, len, |i, j| f64::from(kernels[way][place(way, i, j, len)]))
                }),
            };
            Operator { regular: grid.regular, straight: vec![0.0; len], kernel }
        };
        let [above, down, below] = [operator(0), operator(1), operator(2)];
        let mut part = Part { above, below, down, absorbed: None };
        if order == 0 {
            again(face, grid, &mut part);
        }
        for (operator, missing) in [&mut part.above, &mut part.below].into_iter().zip(&self.missing) {
            operator.straight.iter_mut().zip(missing).for_each(|(straight, missing)| *straight += missing);
        }
        part
    }
}

/// By what to multiply a kernel at each node above and below, so that it sends these fractions of each node's light from above and from
/// below (R. Sinkhorn, P. Knopp, Pacific J. Math. 21, 343 (1967)). What is left is no more than what the nodes' own sums of both differ by.
fn factors(kernel: &Matrix, [from_above, from_below]: [Vec<f64>; 2], grid: &Grid) -> [Vec<f64>; 2] {
    /// Sweeps: each leaves a tenth or less, but of what is alike for many nodes, and wrong by little.
    const SWEEPS: usize = 12;
    /// Where the nodes miss more than this, factors do not mend it.
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

/// Numbers of a kernel between so many nodes: reflections are the same both ways.
fn places(way: usize, len: usize) -> usize {
    let (from, to) = WAYS[way];
    if from == to { len * (len + 1) / 2 } else { len * len }
}

/// Where a pair of nodes stands among them.
fn place(way: usize, out: usize, from: usize, len: usize) -> usize {
    let (side, to) = WAYS[way];
    let (less, more) = (out.min(from), out.max(from));
    if side == to { more * (more + 1) / 2 + less } else { from * len + out }
}

/// What the quadrature finds missing of each node's light, from above and from below.
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

/// Adds the light that meets several microfacets, the same in all azimuths: back by what each direction sends back,
/// across by what it sends across.
fn again(face: &Rough, grid: &Grid, part: &mut Part) {
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
        // A face of few and gentle slopes hides nothing.
        if let Some(kernel) = operator.kernel.as_mut().filter(|_| total > 0.0) {
            let len = outward.len();
            *kernel = Matrix::from_fn(len, len, |i, j| kernel[(i, j)] + outward[i] * inward[j] / total);
        }
    }
}

/// Where refracted light ends: where facets stand upright, q is the same on both sides, and beyond that there is none. As the edge crosses a
/// node's share of the directions, it is counted by the part that is lit.
struct Edge {
    /// Light crosses where `sign (|beta_below|^2 - |beta_above|^2)` is below the limit: 1 if the medium below is the denser one, -1 if not.
    sign: f64,
    limit: f64,
    /// |beta|^2 where each node's share of the directions begins and ends.
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

    /// How much of two nodes' shares, above and below, is lit.
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

    /// `|beta|` below that is lit from this one above, this one if it is.
    fn within(&self, above: f64, below: f64) -> f64 {
        let edge = (above * above + self.sign * self.limit * (1.0 - 1e-9)).max(0.0).sqrt();
        if self.sign > 0.0 { below.min(edge) } else { below.max(edge) }
    }
}

/// The distance in direction cosines over which the kernel changes most: refracted light
/// about the normal, where a facet's slope bends it by the difference of the indices.
pub(crate) fn width(face: &Rough) -> f64 {
    face.alpha() * (face.index(Side::Above) - face.index(Side::Below)).abs().min(1.0)
}

/// Orders that hold this many natural digits of light, up to grazing.
fn orders(face: &Rough, digits: f64) -> usize {
    ((digits / width(face)).ceil() as usize).clamp(8, MOST_ORDERS)
}

/// The first Fourier coefficients of one microfacet's kernel, by the trapezoid rule over the
/// azimuth. Rules have half as many intervals as a power of two, so that pairs of directions
/// share them, and their sums are matrix products.
struct Transforms {
    orders: usize,
    digits: f64,
    edge: Edge,
    /// By the logarithm of the number of intervals from 0 to pi: `[order, azimuth]`.
    cosines: Vec<Option<Matrix>>,
}

impl Transforms {
    fn new(orders: usize, digits: f64, edge: Edge) -> Self {
        Self { orders, digits, edge, cosines: vec![None; MOST_INTERVALS.ilog2() as usize + 1] }
    }

    /// Coefficients of the kernel from one direction to the nodes `rows` on the side `to`.
    fn column(
        &mut self,
        face: &Rough,
        (from, j): (Side, usize),
        to: Side,
        rows: impl Iterator<Item = usize>,
        grid: &Grid,
    ) -> Vec<(usize, Vec<f64>)> {
        let mut of_rule = vec![Vec::new(); self.cosines.len()];
        let mut all = Vec::new();
        let a = grid.beta[j];
        for i in rows {
            if from != to && self.edge.lit(j, i) == 0.0 {
                continue;
            }
            let b = if from == to { grid.beta[i] } else { self.edge.within(a, grid.beta[i]) };
            let ends = [(from, a), (to, b)];
            if let Some(rule) = rule(face, ends, self.digits) {
                of_rule[rule].push((i, b));
                continue;
            }
            let mut values = vec![0.0; self.orders];
            graded(azimuth_width(face, ends), &mut values, |turn| {
                let (sin, cos) = turn.sin_cos();
                face.single(from, Beta { x: a, y: 0.0 }, to, Beta { x: b * cos, y: b * sin })
            });
            all.push((i, values));
        }
        for (rule, rows) in of_rule.into_iter().enumerate().filter(|(_, rows)| !rows.is_empty()) {
            let half = 1_usize << rule;
            let turns: Vec<f64> = (0..=half).map(|k| (PI * k as f64 / half as f64).cos()).collect();
            let pairs: Vec<_> =
                rows.iter().map(|&(_, b)| face.single_by_azimuth((from, a), (to, b))).collect();
            let values = Matrix::from_fn(half + 1, rows.len(), |k, row| pairs[row](turns[k]));
            let mut sums = Matrix::zeros(self.orders, rows.len());
            sums.add_product(self.cosines(rule), &values, half + 1);
            all.extend(rows.iter().enumerate().map(|(row, &(i, _))| (i, sums.column(row).to_vec())));
        }
        all
    }

    /// Weights times cosines of a rule; 0 for orders that it does not tell apart from lower ones.
    fn cosines(&mut self, rule: usize) -> &Matrix {
        let (half, orders) = (1_usize << rule, self.orders);
        self.cosines[rule].get_or_insert_with(|| {
            let weight = |k: usize| if k == 0 || k == half { 0.5 } else { 1.0 } / half as f64;
            Matrix::from_fn(orders, half + 1, |m, k| {
                // The angle's turns, so that no digits are lost.
                let angle = PI * (m * k % (2 * half)) as f64 / half as f64;
                if m > half { 0.0 } else { weight(k) * angle.cos() }
            })
        })
    }
}

/// The kernel's width in azimuth: alpha times the change of the wave vector's component along the normal, over the radius.
pub(super) fn azimuth_width(face: &Rough, [(from, a), (to, b)]: [(Side, f64); 2]) -> f64 {
    let normal = |side: Side, beta: f64| (face.index(side).powi(2) - beta * beta).max(0.0).sqrt();
    let (q_a, q_b) = (normal(from, a), normal(to, b));
    let turn = if from == to { q_a + q_b } else { (q_a - q_b).abs() };
    (face.alpha() * turn / (a * b).sqrt().max(1e-9)).max(1e-9)
}

/// The logarithm of the number of intervals from 0 to pi that a pair of directions takes; `None` if there would be too many.
fn rule(face: &Rough, ends: [(Side, f64); 2], digits: f64) -> Option<usize> {
    // Poles are double: three digits more.
    let half = ((digits + 3.0) / azimuth_width(face, ends).asinh()).ceil().max(12.0);
    (half <= MOST_INTERVALS as f64 / 2.0).then(|| (half as usize).next_power_of_two().ilog2() as usize)
}

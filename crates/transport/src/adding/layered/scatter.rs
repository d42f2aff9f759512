//! Kernels given by tables or formulas as azimuthal orders on a grid.
//!
//! They have no closed Fourier series: they are sampled over the azimuth, by the trapezoid rule. Scattered
//! light that the quadrature over directions misses keeps its direction, so that none is lost.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_optics::scatter::Scatter;
use papilio_optics::{Beta, Scatterer};

use super::algebra::Operator;
use super::azimuth::{MOST_INTERVALS, Sampling, graded, rounded_up, trapezoid};
use super::grid::Grid;
use super::matrix::Matrix;

/// Smallest number of azimuths between 0 and pi for a pair of nodes, for the light off the peak.
const LEAST_AZIMUTHS: usize = 24;
/// Largest number of azimuthal orders.
const MOST_ORDERS: usize = 1500;
/// Largest number of elements of all orders.
const MOST_NUMBERS: usize = 1 << 25;
/// Number of extra nodes, views first, for which scattered light is integrated; for others it is
/// interpolated.
const INTEGRATED: usize = 100;

/// Orders of a kernel, of light from above.
#[derive(Debug, Clone)]
pub(super) struct ScatterOrders {
    zeroth: Matrix,
    /// By order from the first on, `[in][out]`. Far from a peak they nearly cancel, which takes double precision.
    later: Vec<Vec<f64>>,
    /// Light of each node that the quadrature misses, averaged over both directions.
    missing: Vec<f64>,
    /// All nodes, and the number of those with weight.
    beta: Vec<f64>,
    regular: usize,
}

impl ScatterOrders {
    /// Computes the orders in a disc of this radius for that of air; those beyond the first only if there are
    /// lights with an azimuth, given the largest `|beta|` of views and of those. Light scattered from one
    /// extra node to another is left out ([`once`](super::once)). What `known`, the orders for other extra
    /// nodes, contains is not computed again.
    pub(super) fn new(
        (scatter, disc): (&Scatter, f64),
        beyond_first: Option<[f64; 2]>,
        sampling: Sampling<'_>,
        known: Option<&Self>,
    ) -> Self {
        let Sampling { grid, digits, stop } = sampling;
        let (len, regular) = (grid.len(), grid.regular);
        let count = beyond_first.map_or(1, |ends| {
            let most = (MOST_NUMBERS / (len * len).max(1)).clamp(8, MOST_ORDERS);
            rounded_up(orders(scatter, ends.map(|end| end / disc), digits)).clamp(8, most)
        });
        let known = known.filter(|known| known.orders() == count);
        let mut all = Self {
            zeroth: Matrix::zeros(len, len),
            // Allocated separately: copies would touch the memory of zeros.
            later: (1..count).map(|_| vec![0.0; len * len]).collect(),
            missing: Vec::new(),
            beta: grid.beta.clone(),
            regular,
        };
        let was = all.copied(known);
        let mut values = vec![0.0; count];
        let [from, to] = scatter.discs().map(|radius| radius * disc);
        let within = |radius: f64| (0..len).filter(|&i| grid.beta[i] < radius).collect::<Vec<_>>();
        let (sources, targets) = (within(from), within(to));
        for (number, &j) in sources.iter().enumerate() {
            let both = scatter.is_reciprocal();
            for &i in &targets[if both { number } else { 0 }..] {
                if stop.load(Ordering::Relaxed) {
                    return all;
                }
                if (i >= regular && j >= regular) || (was[i].is_some() && was[j].is_some()) {
                    continue;
                }
                fourier(scatter, [grid.beta[j], grid.beta[i]].map(|b| b / disc), digits, &mut values);
                let scale = grid.scale[i] * grid.scale[j] / (disc * disc);
                all.set(i, j, &values, scale);
                if both {
                    all.set(j, i, &values, scale);
                }
            }
        }
        all.missing = all.missing(scatter, disc, grid, (digits / 2.0) as usize, known, stop);
        all
    }

    /// Copies what `known` contains between nodes with weight, and between them and the same extra ones;
    /// returns for each node its number there.
    fn copied(&mut self, known: Option<&Self>) -> Vec<Option<usize>> {
        let Some(known) = known else { return vec![None; self.beta.len()] };
        let (len, before, regular) = (self.beta.len(), known.beta.len(), self.regular);
        let number = |(i, beta): (usize, &f64)| match i < regular {
            true => Some(i),
            false => known.beta[regular..].iter().position(|other| other == beta).map(|k| regular + k),
        };
        let was: Vec<Option<usize>> = self.beta.iter().enumerate().map(number).collect();
        for (j, was_j) in was.iter().enumerate() {
            let Some(was_j) = *was_j else { continue };
            // Between extra nodes there is nothing.
            let to = was[..if j < regular { len } else { regular }].iter().enumerate();
            for (i, was_i) in to.filter_map(|(i, was)| was.map(|was| (i, was))) {
                self.zeroth[(i, j)] = known.zeroth[(was_i, was_j)];
                for (order, known) in self.later.iter_mut().zip(&known.later) {
                    order[j * len + i] = known[was_j * before + was_i];
                }
            }
        }
        was
    }

    fn set(&mut self, out: usize, from: usize, values: &[f64], scale: f64) {
        let len = self.zeroth.columns();
        self.zeroth[(out, from)] = values[0] * scale;
        let some = values.iter().rposition(|value| *value != 0.0).unwrap_or(0);
        for (order, value) in self.later.iter_mut().zip(values[..=some].iter().skip(1)) {
            order[from * len + out] = value * scale;
        }
    }

    /// Returns the light in the disc that the quadrature misses. Scattered light is integrated more finely
    /// from level to level, so that its error shows in their difference.
    fn missing(
        &self,
        scatter: &Scatter,
        disc: f64,
        grid: &Grid,
        fineness: usize,
        known: Option<&Self>,
        stop: &AtomicBool,
    ) -> Vec<f64> {
        let ones = vec![1.0; grid.len()];
        let kernel = Some(self.zeroth.clone().into());
        let there = Operator { regular: grid.regular, straight: vec![0.0; grid.len()], kernel };
        let back = there.transposed();
        let ways = [(scatter.clone(), there), (scatter.reversed(), back)];
        let found = ways.map(|(scatter, operator)| (scatter, operator.pull_back(&ones, &grid.scale)));
        // A reciprocal kernel is its own reverse.
        let found = if scatter.is_reciprocal() { &found[..1] } else { &found };
        // Beyond the edge of either direction there is no regular light.
        let end = scatter.edges().fold(1.0, f64::min);
        let missing = |i: usize| {
            let beta = grid.beta[i] / disc;
            let total = |scatter: &Scatter| {
                if i < grid.regular + INTEGRATED {
                    scatter.albedo_by(beta, fineness)
                } else {
                    scatter.albedo_at(beta)
                }
            };
            let of = |(scatter, found): &(Scatter, Vec<f64>)| total(scatter) - found[i];
            if let Some(known) = known.filter(|_| i < grid.regular) {
                known.missing[i]
            } else if beta < end && !stop.load(Ordering::Relaxed) {
                found.iter().map(of).sum::<f64>() / found.len() as f64
            } else {
                0.0
            }
        };
        (0..grid.len()).map(missing).collect()
    }

    /// Returns the missing light of each node, which keeps its direction.
    pub(super) fn missing_straight(&self) -> &[f64] {
        &self.missing
    }

    /// Returns the nodes with weight.
    pub(super) fn nodes(&self) -> &[f64] {
        &self.beta[..self.regular]
    }

    /// Returns the size in bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * (1 + self.later.len()) * self.zeroth.columns().pow(2)
    }

    /// Returns the number of orders.
    pub(super) fn orders(&self) -> usize {
        1 + self.later.len()
    }

    /// Returns the kernel as an operator in an order.
    pub(super) fn operator(&self, order: usize, grid: &Grid) -> Operator {
        let len = grid.len();
        let kernel = match order.checked_sub(1) {
            None => Some(self.zeroth.clone()),
            Some(later) => {
                self.later.get(later).map(|values| Matrix::from_fn(len, len, |i, j| values[j * len + i]))
            }
        };
        Operator { regular: grid.regular, straight: self.missing.clone(), kernel: kernel.map(Arc::new) }
    }
}

/// Returns the number of orders of light between views and lights of these largest `|beta|`, if each is
/// scattered via other directions.
fn orders(scatter: &Scatter, [view, light]: [f64; 2], digits: f64) -> usize {
    if let Scatter::Rings(kernel) = scatter {
        return kernel.orders();
    }
    if !scatter.is_gaussian() {
        return (digits / scatter.width()).ceil() as usize;
    }
    // Widths decrease towards the horizon; a Gaussian of width w has orders exp(-(m w)^2/4).
    let [a, b] = [view, light].map(|end| scatter.azimuth_width(end.min(1.0), 1.0));
    (2.0 * digits.sqrt() / a.hypot(b)).min(MOST_ORDERS as f64).ceil() as usize
}

/// Computes the first Fourier coefficients of a kernel between two directions.
fn fourier(scatter: &Scatter, [a, b]: [f64; 2], digits: f64, out: &mut [f64]) {
    if let Scatter::Rings(kernel) = scatter {
        return kernel.fourier([a, b], out);
    }
    let width = scatter.azimuth_width(a, b).max(1e-9);
    // Poles are double: three digits more. The last order that the rule resolves must be negligible: for a
    // pole at w it is exp(-m w), for a Gaussian exp(-(m w)^2/4).
    let digits = digits + 3.0;
    let half = (if scatter.is_gaussian() { 2.0 * digits.sqrt() } else { digits } / width).ceil() as usize;
    let value = |phi: f64| {
        let (sin, cos) = phi.sin_cos();
        scatter.evaluate(Beta { x: a, y: 0.0 }, Beta { x: b * cos, y: b * sin })
    };
    if half > MOST_INTERVALS {
        return graded(width, out, value);
    }
    trapezoid(half.max(LEAST_AZIMUTHS), out, value);
}

#[cfg(test)]
mod tests {
    use super::super::grid::Density;
    use super::super::lobes::LobeOrders;
    use super::super::splits::Splits;
    use super::*;
    use papilio_optics::lobe::Lobe;
    use papilio_optics::scatter::Table;

    /// A finely tabulated k-correlation lobe has the orders of its closed series.
    #[test]
    fn table_has_orders_of_its_lobe() {
        let lobe = Lobe::KCorrelation { width: 0.2 };
        let radial: Vec<f64> = (0..=250).map(|k| 2.0 * (f64::from(k) / 250.0).powi(2)).collect();
        let values: Vec<f64> =
            radial.iter().map(|r| lobe.density(Beta::default(), Beta { x: *r, y: 0.0 })).collect();
        let scatter: Scatter = Table::new(&[0.0], &radial, &[0.0], &values).unwrap().into();
        let grid = Grid::new(&Splits::at(&[1.0]), Density { least: 8, spacing: 0.14, angle: None }, &[0.3]);
        let sampling = Sampling { grid: &grid, digits: 9.0, stop: &AtomicBool::new(false) };
        let found = ScatterOrders::new((&scatter, 1.0), Some([1.0; 2]), sampling, None);
        let mut closed = LobeOrders::new(lobe, 1.0);
        let mut largest = 0.0_f64;
        for order in [0, 1, 5, 20] {
            let found = found.operator(order, &grid).kernel.unwrap();
            let closed = closed.order(order, &grid).unwrap();
            // Orders are summed: an error is relative to order 0.
            largest = (0..grid.len()).map(|i| closed[(i, i)]).fold(largest, f64::max);
            for i in 0..grid.len() {
                for j in (0..grid.len()).filter(|j| i < grid.regular || *j < grid.regular) {
                    let error = found[(i, j)] - closed[(i, j)];
                    assert!(error.abs() < 1e-5 * largest, "{order} {i} {j}: {error} of {largest}");
                }
            }
        }
    }
}

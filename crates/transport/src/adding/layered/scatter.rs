//! Kernels given by numbers or formulas as azimuthal orders on a grid.
//!
//! They have no closed Fourier series: they are sampled over the azimuth, by the trapezoid rule.
//! What the quadrature over directions finds missing of the light that a kernel sends keeps its
//! direction, so that none is lost.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::scatter::Scatter;

use super::algebra::Operator;
use super::grid::Grid;
use super::matrix::Matrix;

/// Azimuths between 0 and pi for a pair of nodes: at least, for what lies off the peak; at most.
const AZIMUTHS: (usize, usize) = (24, 512);
/// Azimuthal orders, at most.
const MOST_ORDERS: usize = 400;

/// The orders of a kernel, of light from above.
#[derive(Debug, Clone)]
pub(super) struct ScatterOrders {
    zeroth: Matrix,
    /// By order from the first on, `[in][out]`: single precision serves all but order 0, which
    /// holds the energy.
    later: Vec<Vec<f32>>,
    /// What the quadrature finds missing of each node's light, on average over both ways.
    missing: Vec<f64>,
}

impl ScatterOrders {
    /// In a disc of this radius for the air's, to so many natural digits in azimuth; orders beyond the first only where they
    /// are asked for.
    pub(super) fn new(scatter: &Scatter, disc: f64, grid: &Grid, digits: f64, beyond_first: bool) -> Self {
        let len = grid.len();
        let orders = ((digits / scatter.width()).ceil() as usize).clamp(8, MOST_ORDERS);
        let count = if beyond_first { orders } else { 1 };
        let mut all = Self {
            zeroth: Matrix::zeros(len, len),
            later: vec![vec![0.0; len * len]; count - 1],
            missing: Vec::new(),
        };
        let mut values = vec![0.0; count];
        let [from, to] = scatter.discs().map(|radius| radius * disc);
        let within = |radius: f64| (0..len).filter(|&i| grid.beta[i] < radius).collect::<Vec<_>>();
        let (sources, targets) = (within(from), within(to));
        for (number, &j) in sources.iter().enumerate() {
            let both = scatter.is_reciprocal();
            for &i in &targets[if both { number } else { 0 }..] {
                fourier(scatter, [grid.beta[j], grid.beta[i]].map(|b| b / disc), digits, &mut values);
                let scale = grid.scale[i] * grid.scale[j] / (disc * disc);
                all.set(i, j, &values, scale);
                if both {
                    all.set(j, i, &values, scale);
                }
            }
        }
        all.missing = all.missing(scatter, disc, grid, (digits / 2.0) as usize);
        all
    }

    fn set(&mut self, out: usize, from: usize, values: &[f64], scale: f64) {
        let len = self.zeroth.columns();
        self.zeroth[(out, from)] = values[0] * scale;
        for (order, value) in self.later.iter_mut().zip(&values[1..]) {
            order[from * len + out] = (value * scale) as f32;
        }
    }

    /// What the quadrature finds missing, of light in the disc. What is sent is integrated more finely from level to level, so
    /// that an error of it shows in their difference.
    fn missing(&self, scatter: &Scatter, disc: f64, grid: &Grid, fineness: usize) -> Vec<f64> {
        let ones = vec![1.0; grid.len()];
        let kernel = Some(self.zeroth.clone());
        let there = Operator { regular: grid.regular, straight: vec![0.0; grid.len()], kernel };
        let back = there.transposed();
        let ways = [(scatter.clone(), there), (scatter.reversed(), back)];
        let found = ways.map(|(scatter, operator)| (scatter, operator.pull_back(&ones, &grid.scale)));
        // Light that either way ends before does not go straight on there.
        let end = scatter.edges().fold(1.0, f64::min);
        let missing = |i: usize| {
            let beta = grid.beta[i] / disc;
            let of = |(scatter, found): &(Scatter, Vec<f64>)| scatter.total_by(beta, fineness) - found[i];
            if beta < end { 0.5 * found.iter().map(of).sum::<f64>() } else { 0.0 }
        };
        (0..grid.len()).map(missing).collect()
    }

    /// How many orders there are.
    pub(super) fn orders(&self) -> usize {
        1 + self.later.len()
    }

    /// The kernel as an operator in an order.
    pub(super) fn operator(&self, order: usize, grid: &Grid) -> Operator {
        let len = grid.len();
        let kernel = match order.checked_sub(1) {
            None => Some(self.zeroth.clone()),
            Some(later) => self
                .later
                .get(later)
                .map(|values| Matrix::from_fn(len, len, |i, j| f64::from(values[j * len + i]))),
        };
        Operator { regular: grid.regular, straight: self.missing.clone(), kernel }
    }
}

/// The first Fourier coefficients of a kernel between two directions.
fn fourier(scatter: &Scatter, [a, b]: [f64; 2], digits: f64, out: &mut [f64]) {
    // Where in the complex plane of azimuths a lobe of this width has its pole.
    let width = scatter.width();
    let excess = (width * width + (a - b) * (a - b)) / (2.0 * a * b).max(1e-12);
    let pole = (excess + (excess * (excess + 2.0)).sqrt()).ln_1p();
    // Poles are double: three digits more.
    let half = (((digits + 3.0) / pole).ceil() as usize).clamp(AZIMUTHS.0, AZIMUTHS.1);
    out.fill(0.0);
    for k in 0..=half {
        let phi = PI * k as f64 / half as f64;
        let ends = if k == 0 || k == half { 0.5 } else { 1.0 };
        let (sin, cos) = phi.sin_cos();
        let to = Beta { x: b * cos, y: b * sin };
        let value = ends / half as f64 * scatter.value(Beta { x: a, y: 0.0 }, to);
        // cos(m phi) by its recurrence; orders that this rule does not tell apart from lower ones are none.
        let (mut now, mut before) = (1.0, cos);
        for sum in out.iter_mut().take(half + 1) {
            *sum += value * now;
            (now, before) = (2.0 * cos * now - before, now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Density;
    use super::super::lobes::LobeOrders;
    use super::*;
    use papilio_optics::lobe::Lobe;
    use papilio_optics::scatter::Table;

    /// A finely tabulated k-correlation lobe has the orders of its closed series.
    #[test]
    fn a_table_has_the_orders_of_its_lobe() {
        let lobe = Lobe::KCorrelation { width: 0.2 };
        let radial: Vec<f64> = (0..=250).map(|k| 2.0 * (f64::from(k) / 250.0).powi(2)).collect();
        let values: Vec<f64> =
            radial.iter().map(|r| lobe.density(Beta::default(), Beta { x: *r, y: 0.0 })).collect();
        let scatter: Scatter = Table::new(&[0.0], &radial, &[0.0], &values).unwrap().into();
        let grid = Grid::new(&[1.0], Density { least: 8, spacing: 0.14, angle: None }, &[0.3]);
        let found = ScatterOrders::new(&scatter, 1.0, &grid, 9.0, true);
        let mut closed = LobeOrders::new(lobe);
        let mut largest = 0.0_f64;
        for order in [0, 1, 5, 20] {
            let found = found.operator(order, &grid).kernel.unwrap();
            let closed = closed.order(order, &grid).unwrap();
            // Orders are summed: an error counts beside order 0.
            largest = (0..grid.len()).map(|i| closed[(i, i)]).fold(largest, f64::max);
            for i in 0..grid.len() {
                for j in 0..grid.len() {
                    let error = found[(i, j)] - closed[(i, j)];
                    assert!(error.abs() < 1e-5 * largest, "{order} {i} {j}: {error} of {largest}");
                }
            }
        }
    }
}

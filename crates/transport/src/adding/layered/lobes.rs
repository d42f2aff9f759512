//! Azimuthal orders of diffusers' lobes on a grid.
//!
//! Those of the k-correlation lobe follow from order 0, a complete elliptic integral, by a recurrence that is
//! run backwards, for several nodes at once ([`side_by_side`]). It begins beyond the orders that are wanted,
//! and all orders below come with them: batches of orders grow with their number, so that all of them take
//! little more than the last. Faces have dozens of lobes, each with its orders: a batch is then stored in
//! pieces, and computed again for each of them.

use std::f64::consts::PI;
use std::ops::Range;

use papilio_optics::lobe::{FaceLobe, Gaussian, KCorrelation, Lobe};

use papilio_optics::with_widest_simd;

use super::grid::Grid;
use super::matrix::Matrix;
use crate::adding::panel::lobes::{LANES, side_by_side};

/// Least number of orders that are computed together.
const LEAST_BATCH: usize = 16;
/// Size in bytes, as square matrices, above which no further orders are computed together.
const MOST_BYTES: usize = 32 << 20;
/// Largest number of stored orders of a face's lobe: in the piece that begins with order 0, whose operators
/// take most memory, and in later pieces.
const MOST_OF_FACE: [usize; 2] = [4, 32];
/// Natural digits by which the error at the start of the recurrence decreases before the last order.
const DIGITS: f64 = 20.0;

/// Orders of a lobe's kernel on a grid, scaled, for any two nodes; orders are requested in ascending
/// sequence.
#[derive(Debug, Clone)]
pub(super) struct LobeOrders {
    shape: Shape,
    /// Orders that are computed together.
    batch: Range<usize>,
    /// Largest number of stored orders: in the first piece, and in later ones.
    most: [usize; 2],
    /// The first that is stored.
    first: usize,
    stored: Vec<Triangle>,
}

/// A symmetric matrix: its columns down to the diagonal.
#[derive(Debug, Clone)]
struct Triangle {
    len: usize,
    values: Vec<f64>,
}

impl Triangle {
    fn zeros(len: usize) -> Self {
        Self { len, values: vec![0.0; len * (len + 1) / 2] }
    }

    fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.values[j * (j + 1) / 2..][..=j]
    }

    fn whole(&self) -> Matrix {
        let mut matrix = Matrix::zeros(self.len, self.len);
        for j in 0..self.len {
            matrix.column_mut(j)[..=j].copy_from_slice(&self.values[j * (j + 1) / 2..][..=j]);
        }
        matrix.mirror_upper();
        matrix
    }
}

#[derive(Debug, Clone, Copy)]
enum Shape {
    KCorrelation {
        width: f64,
    },
    Gaussian(Gaussian),
    /// Within a disc of this radius.
    Lambertian {
        disc: f64,
    },
}

impl LobeOrders {
    /// Begins the orders of a lobe; `disc` is the radius of the disc of a Lambertian one, 1 for that of air.
    pub(super) fn new(lobe: Lobe, disc: f64) -> Self {
        let shape = match lobe {
            Lobe::KCorrelation { width } => Shape::KCorrelation { width },
            Lobe::Lambertian => Shape::Lambertian { disc },
        };
        Self { shape, batch: 0..0, most: [usize::MAX; 2], first: 0, stored: Vec::new() }
    }

    /// Begins the orders of the lobe of a face.
    pub(super) fn of_face(lobe: FaceLobe) -> Self {
        let shape = match lobe {
            FaceLobe::KCorrelation(KCorrelation { width }) => Shape::KCorrelation { width },
            FaceLobe::Gaussian(gaussian) => Shape::Gaussian(gaussian),
        };
        Self { shape, batch: 0..0, most: MOST_OF_FACE, first: 0, stored: Vec::new() }
    }

    /// Returns the kernel of this order.
    pub(super) fn order(&mut self, order: usize, grid: &Grid) -> Option<Matrix> {
        if matches!(self.shape, Shape::Lambertian { .. }) && order > 0 {
            return None;
        }
        if !(self.first..self.first + self.stored.len()).contains(&order) {
            self.fill(order, grid);
        }
        self.stored.get(order - self.first).map(Triangle::whole)
    }

    fn fill(&mut self, first: usize, grid: &Grid) {
        if !self.batch.contains(&first) {
            self.batch = first..end_of_batch(first, grid.len());
        }
        self.first = first;
        // Before the next piece needs the memory.
        self.stored = Vec::new();
        let count = self.batch.end;
        let most = self.most[usize::from(first > 0)];
        let orders = first..count.min(first.saturating_add(most));
        self.stored = match self.shape {
            Shape::Lambertian { disc } => vec![lambertian(disc, grid)],
            Shape::KCorrelation { width } => k_correlation(width, orders, count, grid),
            Shape::Gaussian(lobe) => gaussian(lobe, orders, count, grid),
        };
    }
}

/// Number of the order after the last one of a batch that begins with `first`. Those before are computed
/// again.
fn end_of_batch(first: usize, len: usize) -> usize {
    let fits = MOST_BYTES / (8 * len * len).max(1);
    first + first.clamp(LEAST_BATCH, fits.max(LEAST_BATCH))
}

/// Computes order 0 of a Lambertian lobe within a disc.
fn lambertian(disc: f64, grid: &Grid) -> Triangle {
    let area = PI * disc * disc;
    let inside = |i: usize| if grid.beta[i] <= disc { grid.scale[i] } else { 0.0 };
    let mut kernel = Triangle::zeros(grid.len());
    for j in 0..grid.len() {
        let column = kernel.column_mut(j).iter_mut().enumerate();
        column.for_each(|(i, value)| *value = inside(i) * inside(j) / area);
    }
    kernel
}

/// Computes some orders of a Gaussian lobe, among `count`.
fn gaussian(lobe: Gaussian, orders: Range<usize>, count: usize, grid: &Grid) -> Vec<Triangle> {
    let mut all = vec![Triangle::zeros(grid.len()); orders.len()];
    let mut values = vec![0.0; count];
    for j in 0..grid.len() {
        for i in 0..=j {
            lobe.orders(grid.beta[i], grid.beta[j], &mut values);
            for (matrix, value) in all.iter_mut().zip(&values[orders.start..]) {
                matrix.column_mut(j)[i] = grid.scale[i] * grid.scale[j] * value;
            }
        }
    }
    all
}

/// Computes some orders of the k-correlation lobe, among `count`.
fn k_correlation(width: f64, orders: Range<usize>, count: usize, grid: &Grid) -> Vec<Triangle> {
    let farthest = grid.beta.iter().copied().fold(0.0, f64::max);
    // Successive orders decrease by this in the logarithm, or more.
    let decay = 2.0 * (0.5 * width / farthest.max(width)).asinh();
    // The same for all nodes, so that values do not depend on the other nodes.
    let from = count + (0.5 * DIGITS / decay).ceil() as usize;
    let mut all = vec![Triangle::zeros(grid.len()); orders.len()];
    let mut ratios = Vec::new();
    with_widest_simd(
        #[inline(always)]
        || {
            for j in 0..grid.len() {
                for start in (0..=j).step_by(LANES) {
                    let nodes = start..(start + LANES).min(j + 1);
                    let radii = std::array::from_fn(|k| grid.beta[(start + k).min(j)]);
                    let begins = (count, Some(from));
                    side_by_side(width, grid.beta[j], radii, begins, &mut ratios, |m, values| {
                        if !orders.contains(&m) {
                            return;
                        }
                        let column = &mut all[m - orders.start].column_mut(j)[nodes.clone()];
                        for ((out, value), scale) in
                            column.iter_mut().zip(values).zip(&grid.scale[nodes.clone()])
                        {
                            *out = grid.scale[j] * scale * value;
                        }
                    });
                }
            }
        },
    );
    all
}

#[cfg(test)]
mod tests {
    use super::super::grid::Density;
    use super::super::splits::Splits;
    use super::*;
    use papilio_optics::{Beta, Scatterer};

    /// Compared with the trapezoid rule, which converges exponentially for periodic functions.
    #[test]
    fn orders_equal_fourier_coefficients_of_lobe() {
        for (width, a, b) in [(0.06, 0.3, 0.35), (0.5, 0.9, 0.1), (0.02, 1e-9, 0.02), (0.1, 0.0, 0.3)] {
            let lobe = Lobe::KCorrelation { width };
            let steps = 4000;
            let mean = |m: usize| -> f64 {
                (0..steps)
                    .map(|step| {
                        let phi = 2.0 * PI * f64::from(step) / f64::from(steps);
                        let to = Beta { x: b * phi.cos(), y: b * phi.sin() };
                        lobe.density(Beta { x: a, y: 0.0 }, to) * (m as f64 * phi).cos()
                    })
                    .sum::<f64>()
                    / f64::from(steps)
            };
            let density = Density { least: 0, spacing: 1.0, angle: None };
            let grid = Grid::new(&Splits::default(), density, &[a, 1.3, b]);
            let mut orders = LobeOrders::new(lobe, 1.0);
            let scale = mean(0);
            for order in 0..40 {
                let (found, expected) = (orders.order(order, &grid).unwrap(), mean(order));
                for found in [found[(0, 2)], found[(2, 0)]] {
                    assert!((found - expected).abs() < 1e-11 * scale, "{width} {a} {b} {order}: {found}");
                }
            }
        }
    }

    /// A face's lobe has the orders of a diffuser's, bit for bit, and stores few of them.
    #[test]
    fn pieces_of_batches_equal_whole_batches() {
        let density = Density { least: 8, spacing: 1.0, angle: None };
        let grid = Grid::new(&Splits::default(), density, &[0.3, 0.35]);
        let width = 0.1;
        let mut pieces = LobeOrders::of_face(FaceLobe::KCorrelation(KCorrelation { width }));
        let mut whole = LobeOrders::new(Lobe::KCorrelation { width }, 1.0);
        let mut most = 0;
        for order in 0..130 {
            assert_eq!(pieces.order(order, &grid), whole.order(order, &grid), "{order}");
            assert!(pieces.stored.len() <= MOST_OF_FACE[1]);
            most = most.max(whole.stored.len());
        }
        assert!(most > MOST_OF_FACE[1], "the test needs batches of several pieces");
    }
}

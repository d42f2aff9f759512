//! The stack closed by its base: what a view sees by way of the pixel.
//!
//! The light that arrives at the base from the view's direction obeys `x = t + G B x`, t what the
//! layers let through, B the base's reflectance, G what the layers send back down. B differs by
//! state and wavelength, G does not: all of them are iterated at once, one matrix product for
//! each order of reflection; where light is nearly trapped, a direct solution is cheaper.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{PartialPivLu, Solve};
use faer::{Accum, Mat, Par};

use super::algebra::Operator;
use super::grid::Grid;

/// The layers above the base in one azimuthal order.
#[derive(Debug, Clone)]
pub(super) struct Above {
    /// Light from above, let through to the base.
    pub(super) down: Operator,
    /// Light from the base, sent back to it.
    pub(super) below: Operator,
}

/// Light on its way up from the base, for a unit beam that entered at a node: densities over
/// the nodes with weight, scaled, by column (state and wavelength), and the rest.
#[derive(Debug)]
pub(super) struct Rising {
    /// Scattered light, `[node, column]`.
    pub(super) scattered: Mat<f64>,
    /// The beam itself, by column.
    pub(super) beam: Vec<f64>,
    /// The number of the beam's node.
    pub(super) node: usize,
}

/// Light that is sent back this often, or less, is followed by iteration ...
const ITERATIONS: usize = 60;
/// ... to this relative error.
const TOLERANCE: f64 = 1e-11;

impl Above {
    /// Light that rises from a specular base, its reflectance `[node, column]`.
    pub(super) fn rise(&self, node: usize, base: &Mat<f64>) -> Rising {
        let (n, columns) = (self.down.regular, base.ncols());
        let beam: Vec<f64> = (0..columns)
            .map(|c| {
                let b = base[(node, c)];
                let open = 1.0 - self.below.straight[node] * b;
                if open > 0.0 { b * self.down.straight[node] / open } else { 0.0 }
            })
            .collect();
        // What one reflection makes of it, unscattered light's trips between base and layers
        // summed already.
        let once = |i: usize, c: usize| {
            let b = base[(i, c)];
            b / (1.0 - self.below.straight[i] * b).max(f64::MIN_POSITIVE)
        };
        let arrives =
            Mat::from_fn(n, columns, |i, c| self.down.at(i, node) + self.below.at(i, node) * beam[c]);
        let Some(kernel) = self.below.kernel.as_ref().filter(|_| n > 0) else {
            let scattered = Mat::from_fn(n, columns, |i, c| {
                if arrives[(i, c)] == 0.0 { 0.0 } else { once(i, c) * arrives[(i, c)] }
            });
            return Rising { scattered, beam, node };
        };
        let gain = Mat::from_fn(n, columns, once);
        let mut rising = Mat::from_fn(n, columns, |i, c| gain[(i, c)] * arrives[(i, c)]);
        let mut open: Vec<bool> = vec![true; columns];
        let mut before = vec![f64::INFINITY; columns];
        for _ in 0..ITERATIONS {
            let mut next = arrives.clone();
            matmul(next.as_mut(), Accum::Add, kernel.get(..n, ..n), rising.as_ref(), 1.0, Par::Seq);
            for c in 0..columns {
                let (mut change, mut size) = (0.0_f64, 0.0_f64);
                for i in 0..n {
                    let value = next[(i, c)] * gain[(i, c)];
                    change = change.max((value - rising[(i, c)]).abs());
                    size = size.max(value.abs());
                    rising[(i, c)] = value;
                }
                // Changes fall geometrically: what is left is their sum.
                let ratio = (change / before[c]).min(1.0);
                open[c] = change > TOLERANCE * size * (1.0 - ratio);
                before[c] = change;
            }
            if !open.contains(&true) {
                return Rising { scattered: rising, beam, node };
            }
        }
        for c in (0..columns).filter(|c| open[*c]) {
            self.solve(c, base, &arrives, &mut rising);
        }
        Rising { scattered: rising, beam, node }
    }

    fn solve(&self, column: usize, base: &Mat<f64>, arrives: &Mat<f64>, rising: &mut Mat<f64>) {
        let n = self.down.regular;
        // 1 - B G acts on what rises.
        let b = base.get(.., column..column + 1);
        let kernel =
            Mat::from_fn(self.below.len(), self.below.len(), |i, j| -b[(i, 0)] * self.below.at(i, j));
        let straight = (0..self.below.len()).map(|i| 1.0 - b[(i, 0)] * self.below.straight[i]).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel) };
        let lu = PartialPivLu::new(closed.weighted_block().as_ref());
        let mut right = Mat::from_fn(n, 1, |i, _| b[(i, 0)] * arrives[(i, column)]);
        lu.solve_in_place(right.as_mut());
        for i in 0..n {
            rising[(i, column)] = right[(i, 0)];
        }
    }

    /// The kernel of the whole display between the beam and another extra node, by column.
    pub(super) fn leaves(&self, rising: &Rising, to: usize, base: &Mat<f64>) -> Vec<f64> {
        let n = self.down.regular;
        (0..base.ncols())
            .map(|c| {
                let beam = rising.beam[c];
                let (mut out, mut back) = (0.0, self.down.at(to, rising.node));
                for i in 0..n {
                    out += self.down.at(i, to) * rising.scattered[(i, c)];
                    back += self.below.at(to, i) * rising.scattered[(i, c)];
                }
                out += self.down.at(rising.node, to) * beam;
                back += self.below.at(to, rising.node) * beam;
                let b = base[(to, c)];
                let open = 1.0 - self.below.straight[to] * b;
                out + if open > 0.0 { self.down.straight[to] * b / open * back } else { 0.0 }
            })
            .collect()
    }
}

/// The sum of a functional (its value for unit light at each node) over light that rises, by column.
pub(super) fn total(rising: &Rising, share: &[f64], grid: &Grid) -> Vec<f64> {
    (0..rising.beam.len())
        .map(|c| {
            let scattered: f64 =
                (0..grid.regular).map(|i| share[i] * grid.scale[i] * rising.scattered[(i, c)]).sum();
            scattered + share[rising.node] * rising.beam[c]
        })
        .collect()
}

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
use super::part::Part;

/// The layers above the base in one azimuthal order, as far as views and sources ask for it.
/// Extra nodes count from the first of them, lights from the first light.
#[derive(Debug, Clone)]
pub(super) struct Above {
    regular: usize,
    /// Light from above that is sent back, `[extra, light]`.
    front: Mat<f64>,
    /// Light that passes to the base unscattered, by node.
    down_straight: Vec<f64>,
    /// From extra nodes to the nodes with weight.
    down: Mat<f64>,
    /// Between extra nodes and lights: down from an extra node to a light's, `[extra, light]`, ...
    to_light: Mat<f64>,
    /// ... and down from a light's to an extra one.
    from_light: Mat<f64>,
    /// Light that is sent back to the base unscattered, by node.
    below_straight: Vec<f64>,
    /// From all nodes to the nodes with weight.
    below: Mat<f64>,
    /// Between extra nodes and lights, `[extra, light]`.
    below_light: Mat<f64>,
}

/// Light on its way up from the base, for a unit beam that entered at an extra node: densities
/// over the nodes with weight, scaled, by column (state and wavelength), and the rest.
#[derive(Debug)]
pub(super) struct Rising {
    /// Scattered light, `[node, column]`.
    scattered: Mat<f64>,
    /// The beam itself, by column.
    beam: Vec<f64>,
    /// The beam's extra node.
    extra: usize,
}

/// Light that is sent back this often, or less, is followed by iteration ...
const ITERATIONS: usize = 60;
/// ... to this relative error.
const TOLERANCE: f64 = 1e-11;

impl Above {
    /// Of a part, with the numbers of the lights' extra nodes.
    pub(super) fn new(part: &Part, lights: &[usize]) -> Self {
        let (n, len) = (part.down.regular, part.down.len());
        let extras = len - n;
        let pairs = |at: &dyn Fn(usize, usize) -> f64| {
            Mat::from_fn(extras, lights.len(), |extra, light| at(n + extra, n + lights[light]))
        };
        Self {
            regular: n,
            front: pairs(&|extra, light| part.above.at(extra, light)),
            down_straight: part.down.straight.clone(),
            down: Mat::from_fn(n, extras, |i, extra| part.down.at(i, n + extra)),
            to_light: pairs(&|extra, light| part.down.at(light, extra)),
            from_light: pairs(&|extra, light| part.down.at(extra, light)),
            below_straight: part.below.straight.clone(),
            below: Mat::from_fn(n, len, |i, j| part.below.at(i, j)),
            below_light: pairs(&|extra, light| part.below.at(extra, light)),
        }
    }

    /// How many nodes have weight.
    pub(super) fn regular(&self) -> usize {
        self.regular
    }

    /// The kernel between an extra node and a light of what never meets the base.
    pub(super) fn front(&self, extra: usize, light: usize) -> f64 {
        self.front[(extra, light)]
    }

    /// Light that rises from a specular base, its reflectance `[node, column]`.
    pub(super) fn rise(&self, extra: usize, base: &Mat<f64>) -> Rising {
        let (n, columns) = (self.regular, base.ncols());
        let node = n + extra;
        let beam: Vec<f64> = (0..columns)
            .map(|c| round_trips(base[(node, c)], self.below_straight[node]) * self.down_straight[node])
            .collect();
        let arrives =
            Mat::from_fn(n, columns, |i, c| self.down[(i, extra)] + self.below[(i, node)] * beam[c]);
        let gain = Mat::from_fn(n, columns, |i, c| round_trips(base[(i, c)], self.below_straight[i]));
        let mut scattered = Mat::from_fn(n, columns, |i, c| gain[(i, c)] * arrives[(i, c)]);
        let open = self.iterate(&arrives, &gain, &mut scattered);
        for column in open {
            self.solve(column, base, &arrives, &mut scattered);
        }
        Rising { scattered, beam, extra }
    }

    /// Follows light between base and layers; says which columns are not done after many orders.
    fn iterate(&self, arrives: &Mat<f64>, gain: &Mat<f64>, rising: &mut Mat<f64>) -> Vec<usize> {
        let (n, columns) = (self.regular, arrives.ncols());
        let mut open: Vec<usize> = (0..columns).collect();
        let mut before = vec![f64::INFINITY; columns];
        let mut next = Mat::zeros(n, columns);
        for _ in 0..ITERATIONS {
            if open.is_empty() || n == 0 {
                return Vec::new();
            }
            next.copy_from(arrives);
            matmul(next.as_mut(), Accum::Add, self.below.get(.., ..n), rising.as_ref(), 1.0, Par::Seq);
            open.clear();
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
                if change > TOLERANCE * size * (1.0 - ratio) {
                    open.push(c);
                }
                before[c] = change;
            }
        }
        open
    }

    fn solve(&self, column: usize, base: &Mat<f64>, arrives: &Mat<f64>, rising: &mut Mat<f64>) {
        let n = self.regular;
        // 1 - B G acts on what rises.
        let b: Vec<f64> = (0..n).map(|i| base[(i, column)]).collect();
        let kernel = Mat::from_fn(n, n, |i, j| -b[i] * self.below[(i, j)]);
        let straight = (0..n).map(|i| 1.0 - b[i] * self.below_straight[i]).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel) };
        let lu = PartialPivLu::new(closed.weighted_block().as_ref());
        let mut right = Mat::from_fn(n, 1, |i, _| b[i] * arrives[(i, column)]);
        lu.solve_in_place(right.as_mut());
        for i in 0..n {
            rising[(i, column)] = right[(i, 0)];
        }
    }

    /// The kernel of the whole display between the beam and a light at extra node `to`, by column.
    pub(super) fn leaves(&self, rising: &Rising, light: usize, to: usize, base: &Mat<f64>) -> Vec<f64> {
        let (n, extra) = (self.regular, rising.extra);
        let one = |c: usize| {
            let beam = rising.beam[c];
            let mut out = self.from_light[(extra, light)] * beam;
            let mut back = self.to_light[(extra, light)] + self.below_light[(extra, light)] * beam;
            for i in 0..n {
                out += self.down[(i, to)] * rising.scattered[(i, c)];
                back += self.below[(i, n + to)] * rising.scattered[(i, c)];
            }
            let trips = round_trips(base[(n + to, c)], self.below_straight[n + to]);
            out + self.down_straight[n + to] * trips * back
        };
        (0..base.ncols()).map(one).collect()
    }
}

/// Unscattered light that rises after all its round trips between a base and layers that
/// mirror it, for one that arrives. None, if they let nothing in.
fn round_trips(base: f64, layers: f64) -> f64 {
    let open = 1.0 - base * layers;
    if open > 0.0 { base / open } else { 0.0 }
}

impl Rising {
    /// The sum of a functional (its value for unit light at each node), by column.
    pub(super) fn total(&self, share: &[f64], grid: &Grid) -> Vec<f64> {
        let one = |c: usize| {
            let scattered: f64 =
                (0..grid.regular).map(|i| share[i] * grid.scale[i] * self.scattered[(i, c)]).sum();
            scattered + share[grid.regular + self.extra] * self.beam[c]
        };
        (0..self.beam.len()).map(one).collect()
    }
}

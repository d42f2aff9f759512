//! The stack closed by its base: what a view sees by way of the pixel.
//!
//! The light that arrives at the base from the view's direction obeys `x = t + G B x`, t what the
//! layers let through, B the base's reflectance, G what the layers send back down. B differs by
//! state and wavelength, G does not: all of them are iterated at once, one matrix product for
//! each order of reflection; where light is nearly trapped, a direct solution is cheaper.

use super::algebra::Operator;
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::Part;

/// The layers above the base in one azimuthal order, as far as views and sources ask for it.
/// Extra nodes count from the first of them, lights from the first light.
#[derive(Debug, Clone)]
pub(super) struct Above {
    regular: usize,
    /// Light from above that is sent back, `[extra, light]`.
    front: Matrix,
    /// Light that passes to the base unscattered, by node.
    down_straight: Vec<f64>,
    /// From extra nodes to the nodes with weight.
    down: Matrix,
    /// Between extra nodes and lights: down from an extra node to a light's, `[extra, light]`, ...
    to_light: Matrix,
    /// ... and down from a light's to an extra one.
    from_light: Matrix,
    /// Light that is sent back to the base unscattered, by node.
    below_straight: Vec<f64>,
    /// From all nodes to the nodes with weight.
    below: Matrix,
    /// Between extra nodes and lights, `[extra, light]`.
    below_light: Matrix,
}

/// Light on its way up from the base, for a unit beam that entered at an extra node: densities
/// over the nodes with weight, scaled, by column (state and wavelength), and the rest.
#[derive(Debug)]
pub(super) struct Rising {
    /// Scattered light, `[node, column]`.
    scattered: Matrix,
    /// The beam itself, by column.
    beam: Vec<f64>,
    /// The beam's extra node.
    extra: usize,
}

/// Light that is sent back this often, or less, is followed by iteration.
const ITERATIONS: usize = 40;

impl Above {
    /// Of a part, with the numbers of the lights' extra nodes.
    pub(super) fn new(part: &Part, lights: &[usize]) -> Self {
        let (n, len) = (part.down.regular, part.down.len());
        let extras = len - n;
        let pairs = |at: &dyn Fn(usize, usize) -> f64| {
            Matrix::from_fn(extras, lights.len(), |extra, light| at(n + extra, n + lights[light]))
        };
        Self {
            regular: n,
            front: pairs(&|extra, light| part.above.at(extra, light)),
            down_straight: part.down.straight.clone(),
            down: Matrix::from_fn(n, extras, |i, extra| part.down.at(i, n + extra)),
            to_light: pairs(&|extra, light| part.down.at(light, extra)),
            from_light: pairs(&|extra, light| part.down.at(extra, light)),
            below_straight: part.below.straight.clone(),
            below: Matrix::from_fn(n, len, |i, j| part.below.at(i, j)),
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

    /// Light that rises from a specular base, its reflectance `[node, column]`, to this error
    /// relative to the largest density or to `floor`, by column; `floor` is raised to what is found.
    pub(super) fn rise(&self, extra: usize, base: &Matrix, tolerance: f64, floor: &mut [f64]) -> Rising {
        let (n, columns) = (self.regular, base.columns());
        let node = n + extra;
        let mut beam = vec![0.0; columns];
        let mut arrives = Matrix::zeros(n, columns);
        let mut gain = Matrix::zeros(n, columns);
        for (c, beam) in beam.iter_mut().enumerate() {
            let base = base.column(c);
            *beam = round_trips(base[node], self.below_straight[node]) * self.down_straight[node];
            if n == 0 {
                continue;
            }
            let scattered = self.down.column(extra).iter().zip(self.below.column(node));
            arrives.column_mut(c).iter_mut().zip(scattered).for_each(|(x, (d, g))| *x = d + g * *beam);
            let straight = base.iter().zip(&self.below_straight);
            gain.column_mut(c).iter_mut().zip(straight).for_each(|(x, (b, g))| *x = round_trips(*b, *g));
        }
        let mut scattered = Matrix::zeros(n, columns);
        let open = self.iterate(&arrives, &gain, &mut scattered, tolerance, floor);
        for column in open {
            self.solve(column, base, &arrives, &mut scattered);
        }
        Rising { scattered, beam, extra }
    }

    /// Follows light between base and layers; says which columns are not done after many orders.
    fn iterate(
        &self,
        arrives: &Matrix,
        gain: &Matrix,
        rising: &mut Matrix,
        tolerance: f64,
        floor: &mut [f64],
    ) -> Vec<usize> {
        let n = self.regular;
        if n == 0 {
            return Vec::new();
        }
        let mut open: Vec<usize> = (0..arrives.columns()).collect();
        let mut before = vec![f64::INFINITY; arrives.columns()];
        let mut next = arrives.clone();
        for _ in 0..ITERATIONS {
            open.clear();
            for (c, old) in rising.columns_mut() {
                let (change, size) = reflect(old, next.column(c), gain.column(c));
                let size = size.max(floor[c]);
                // Changes fall geometrically: what is left is their sum.
                let ratio = (change / before[c]).min(1.0);
                if change > tolerance * size * (1.0 - ratio) {
                    open.push(c);
                }
                (before[c], floor[c]) = (change, size);
            }
            if open.is_empty() {
                break;
            }
            next.copy_from(arrives);
            next.add_product(&self.below, rising, n);
        }
        open
    }

    fn solve(&self, column: usize, base: &Matrix, arrives: &Matrix, rising: &mut Matrix) {
        let n = self.regular;
        // 1 - B G acts on what rises.
        let b: Vec<f64> = (0..n).map(|i| base[(i, column)]).collect();
        let kernel = Matrix::from_fn(n, n, |i, j| -b[i] * self.below[(i, j)]);
        let straight = (0..n).map(|i| 1.0 - b[i] * self.below_straight[i]).collect();
        let closed = Operator { regular: n, straight, kernel: Some(kernel) };
        let mut right = Matrix::from_fn(n, 1, |i, _| b[i] * arrives[(i, column)]);
        closed.weighted_block().factors().solve(&mut right);
        rising.column_mut(column).copy_from_slice(right.column(0));
    }

    /// The kernel of the whole display between the beam and a light at extra node `to`, by column.
    pub(super) fn leaves(&self, rising: &Rising, light: usize, to: usize, base: &Matrix) -> Vec<f64> {
        let (n, extra) = (self.regular, rising.extra);
        let one = |c: usize| {
            let beam = rising.beam[c];
            let mut out = self.from_light[(extra, light)] * beam;
            let mut back = self.to_light[(extra, light)] + self.below_light[(extra, light)] * beam;
            if n > 0 {
                let ways = self.down.column(to).iter().zip(self.below.column(n + to));
                for (rising, (down, below)) in rising.scattered.column(c).iter().zip(ways) {
                    out += down * rising;
                    back += below * rising;
                }
            }
            let trips = round_trips(base[(n + to, c)], self.below_straight[n + to]);
            out + self.down_straight[n + to] * trips * back
        };
        (0..base.columns()).map(one).collect()
    }
}

/// Unscattered light that rises after all its round trips between a base and layers that
/// mirror it, for one that arrives. None, if they let nothing in.
fn round_trips(base: f64, layers: f64) -> f64 {
    let open = 1.0 - base * layers;
    if open > 0.0 { base / open } else { 0.0 }
}

/// Sets `rising` to `next` times `gain`; the largest change and the largest value.
fn reflect(rising: &mut [f64], next: &[f64], gain: &[f64]) -> (f64, f64) {
    // Chunks of fixed size, so that they become vectors.
    let (rising, rising_rest) = rising.as_chunks_mut::<8>();
    let (next, next_rest) = next.as_chunks::<8>();
    let (gain, gain_rest) = gain.as_chunks::<8>();
    let (mut change, mut size) = ([0.0; 8], [0.0; 8]);
    for ((rising, next), gain) in rising.iter_mut().zip(next).zip(gain) {
        for k in 0..8 {
            let value = next[k] * gain[k];
            change[k] = larger((value - rising[k]).abs(), change[k]);
            size[k] = larger(value.abs(), size[k]);
            rising[k] = value;
        }
    }
    for ((rising, next), gain) in rising_rest.iter_mut().zip(next_rest).zip(gain_rest) {
        let value = next * gain;
        change[0] = larger((value - *rising).abs(), change[0]);
        size[0] = larger(value.abs(), size[0]);
        *rising = value;
    }
    [change, size].map(|lanes| lanes.into_iter().fold(0.0, larger)).into()
}

/// The larger one; a comparison that vectors can do.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl Rising {
    /// The sum of a functional (its value for unit light at each node), by column.
    pub(super) fn total(&self, share: &[f64], grid: &Grid) -> Vec<f64> {
        let weights: Vec<f64> = (0..grid.regular).map(|i| share[i] * grid.scale[i]).collect();
        let one = |c: usize| {
            let scattered: f64 = weights.iter().zip(self.scattered.column(c)).map(|(w, x)| w * x).sum();
            scattered + share[grid.regular + self.extra] * self.beam[c]
        };
        (0..self.beam.len()).map(one).collect()
    }
}

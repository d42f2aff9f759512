//! One scatterer below flat layers: wavelengths share its kernels.
//!
//! Where nothing scatters above the last scatterer, light between the two meets flat layers that keep its
//! direction. If the scatterer, too, returns light from above only in its own direction, or the flat layers
//! return none, then everything that differs by wavelength is a factor for each node: `g = 1/(1 - u a)` sums
//! the round trips between the reflectance u of the flat layers and a of the scatterer. The light that rises
//! is returned by `B + D diag(g u) D'`, with B the reflection of the scatterer and D its transmission. No
//! product of two kernels is formed: it is applied to the light, kernel by kernel.

use std::sync::Arc;

use super::algebra::Operator;
use super::base::Ends;
use super::grid::Grid;
use super::matrix::Matrix;
use super::part::{Absorbed, Part, nothing};
use super::prepare::Shares;

/// One way of scattering: a regular factor for each node, and a shared kernel with its factor.
#[derive(Debug, Clone)]
pub(super) struct Face {
    pub(super) straight: Vec<f64>,
    pub(super) kernel: Option<(Arc<Matrix>, f64)>,
}

impl Face {
    /// Shares the kernel of an operator.
    pub(super) fn of(operator: &Operator, factor: f64) -> Self {
        let straight = operator.straight.iter().map(|x| x * factor).collect();
        Self { straight, kernel: operator.kernel.as_ref().map(|kernel| (Arc::clone(kernel), factor)) }
    }

    /// Returns an element of the kernel, scaled.
    pub(super) fn at(&self, out: usize, from: usize) -> f64 {
        self.kernel.as_ref().map_or(0.0, |(kernel, factor)| factor * kernel[(out, from)])
    }

    /// Returns the sum of the magnitudes of the kernel from a node to the first ones, weighted.
    fn magnitude(&self, from: usize, weights: &[f64]) -> f64 {
        let Some((kernel, factor)) = &self.kernel else { return 0.0 };
        let terms = kernel.column(from).iter().zip(weights).map(|(k, weight)| k.abs() * weight);
        factor.abs() * terms.sum::<f64>()
    }

    /// Returns a functional of the outgoing light as a functional of the incoming
    /// ([`Operator::pull_back`]); of light in the opposite direction if `reversed`.
    fn pull_back(&self, share: &[f64], grid: &Grid, reversed: bool) -> Vec<f64> {
        let mut pulled: Vec<f64> = share.iter().zip(&self.straight).map(|(s, d)| s * d).collect();
        // Of the accounts of absorbed light, most are empty.
        let kernel = self.kernel.as_ref().filter(|_| share.iter().any(|share| *share != 0.0));
        if let Some((kernel, factor)) = kernel {
            let weights: Vec<f64> =
                share.iter().zip(&grid.scale).take(grid.regular).map(|(s, c)| s * c * factor).collect();
            let sums = if reversed { kernel.times(&weights) } else { kernel.transposed_times(&weights) };
            for ((value, sum), scale) in pulled.iter_mut().zip(&sums).zip(&grid.scale) {
                *value += sum / scale;
            }
        }
        pulled
    }

    /// Returns the share of light that is neither returned by `back` nor transmitted, on the side of a medium
    /// of this index.
    fn lost(&self, back: &Self, reversed: bool, grid: &Grid, index: f64) -> Vec<f64> {
        let ones = vec![1.0; grid.len()];
        let (back, through) = (back.pull_back(&ones, grid, false), self.pull_back(&ones, grid, reversed));
        let one = |i: usize| if grid.beta[i] < index { 1.0 - back[i] - through[i] } else { 0.0 };
        (0..grid.len()).map(one).collect()
    }
}

/// The layers down to the only scatterer, at one wavelength.
#[derive(Debug)]
pub(super) struct Single<'a> {
    /// Flat layers above it.
    upper: &'a Part,
    /// Transmission of the scatterer from above.
    pub(super) down: Face,
    /// Its reflection of light from above and from below.
    pub(super) above: Face,
    pub(super) below: Face,
    /// Round trips between the two, by node.
    trips: Vec<f64>,
}

impl<'a> Single<'a> {
    /// Returns the layers, if round trips keep the direction of light.
    pub(super) fn new(upper: &'a Part, [down, above, below]: [Face; 3]) -> Option<Self> {
        let reflects = upper.below.straight.iter().any(|r| *r != 0.0);
        if upper.down.kernel.is_some() || (reflects && above.kernel.is_some()) {
            return None;
        }
        let open = upper.below.straight.iter().zip(&above.straight).map(|(u, a)| 1.0 - u * a);
        let gap = Operator::diagonal(upper.down.regular, open.collect());
        Some(Self { upper, down, above, below, trips: gap.inverse_straight() })
    }

    /// Returns the light that arrives at the scatterer in direction number `i`, per unit from above.
    pub(super) fn arrives(&self, i: usize) -> f64 {
        self.upper.down.straight[i] * self.trips[i]
    }

    /// Returns the light that returns to the scatterer in direction number `i`, per unit that leaves it
    /// upwards.
    pub(super) fn returns(&self, i: usize) -> f64 {
        self.upper.below.straight[i] * self.trips[i]
    }

    /// Returns the kernel of light from above that leaves upwards, between two nodes.
    pub(super) fn front(&self, out: usize, from: usize) -> f64 {
        self.upper.down.straight[out] * self.above.at(out, from) * self.arrives(from)
    }

    /// Returns the upper bound of the light that is scattered twice between each view and light,
    /// `[extra, light]`, if everything below is white: it takes each direction in between.
    pub(super) fn often(&self, ends: Ends<'_>, regular: usize) -> Matrix {
        let Ends { views, lights } = ends;
        let passes: Vec<f64> = self.upper.down.straight[..regular].iter().map(|t| t.abs()).collect();
        let mut often = Matrix::zeros(self.trips.len() - regular, lights.len());
        for (l, column) in often.columns_mut() {
            let light = regular + lights[l];
            let of_light = |(i, t): (usize, &f64)| {
                (self.down.at(i, light).abs() + t * self.above.at(i, light).abs()) * self.arrives(light).abs()
            };
            let transmitted: Vec<f64> = passes.iter().enumerate().map(of_light).collect();
            let reflected: Vec<f64> = transmitted.iter().zip(&passes).map(|(x, t)| x * t).collect();
            for &v in views {
                let view = regular + v;
                let sum = self.down.magnitude(view, &transmitted) + self.above.magnitude(view, &reflected);
                column[v] = sum * self.arrives(view).abs();
            }
        }
        often
    }

    /// Returns the fractions of light that the scatterer absorbs, from above and from below, between media of
    /// these indices.
    pub(super) fn lost(&self, grid: &Grid, [above, below]: [f64; 2]) -> [Vec<f64>; 2] {
        [self.down.lost(&self.above, false, grid, above), self.down.lost(&self.below, true, grid, below)]
    }

    /// Computes the fractions of light above a medium of this index, below flat layers `lower` that return no
    /// light to the scatterer; `books` are the absorbed fractions of the scatterer itself.
    pub(super) fn shares(
        &self,
        books: &[Absorbed; 2],
        lower: Option<&Part>,
        index: f64,
        grid: &Grid,
    ) -> Shares {
        let len = grid.len();
        let (air, medium) = (grid.below(1.0), grid.below(index));
        let times =
            |a: &dyn Fn(usize) -> f64, b: &[f64]| -> Vec<f64> { (0..len).map(|i| a(i) * b[i]).collect() };
        let arrives = |share: &[f64]| times(&|i| self.arrives(i), share);
        // Functionals of light: that arrives from above, that arrives from below; of what then falls, of what
        // rises.
        let through = |share: &[f64]| self.down.pull_back(share, grid, false);
        let up = |share: &[f64]| self.down.pull_back(share, grid, true);
        let below = |falls: &[f64]| {
            let again = up(&times(&|i| self.returns(i), &through(falls)));
            let once = self.below.pull_back(falls, grid, false);
            once.iter().zip(again).map(|(a, b)| a + b).collect::<Vec<_>>()
        };
        let above = |leaves: &[f64]| arrives(&self.above.pull_back(leaves, grid, false));
        let u_t = |share: &[f64]| times(&|i| self.upper.down.straight[i], share);
        let none = [nothing(len), nothing(len)];
        let upper = self.upper.absorbed.as_ref().unwrap_or(&none);
        let sum = |parts: [Vec<f64>; 3]| -> Vec<f64> {
            (0..len).map(|i| parts.iter().map(|part| part[i]).sum()).collect()
        };
        let absorbed_above =
            |place: usize| sum([upper[0][place].clone(), arrives(&books[0][place]), above(&upper[1][place])]);
        let absorbed_below = |place: usize| {
            let trips = times(&|i| self.trips[i], &upper[1][place]);
            let falls = times(&|i| self.returns(i), &books[0][place]);
            sum([books[1][place].clone(), up(&trips), up(&falls)])
        };
        let mut absorbed: [Absorbed; 2] =
            [std::array::from_fn(absorbed_above), std::array::from_fn(absorbed_below)];
        let passes = |share: &[f64]| match lower {
            Some(lower) => times(&|i| lower.down.straight[i], share),
            None => share.to_vec(),
        };
        if let Some(lower) = lower {
            let more = lower.absorbed.as_ref().unwrap_or(&none);
            for place in 0..absorbed[0].len() {
                let first = arrives(&through(&more[0][place]));
                absorbed[0][place].iter_mut().zip(first).for_each(|(sum, x)| *sum += x);
                let rises = sum([
                    passes(&absorbed[1][place]),
                    passes(&below(&more[0][place])),
                    more[1][place].clone(),
                ]);
                absorbed[1][place] = rises;
            }
        }
        let direct = |share: &[f64]| match lower {
            Some(lower) => times(&|i| lower.below.straight[i], share),
            None => vec![0.0; len],
        };
        let kept = grid.kept(index);
        let on_kept = |all: Vec<f64>| -> Vec<f64> { kept.iter().map(|&i| all[i]).collect() };
        let leaving_front =
            sum([times(&|i| self.upper.above.straight[i], &air), above(&u_t(&air)), vec![0.0; len]]);
        Shares {
            scale: on_kept(grid.scale.clone()),
            arriving: on_kept(arrives(&through(&passes(&medium)))),
            returning: on_kept(sum([passes(&below(&passes(&medium))), direct(&medium), vec![0.0; len]])),
            leaving: on_kept(passes(&up(&arrives(&air)))),
            leaving_front: on_kept(leaving_front),
            absorbed: absorbed.map(|places| places.map(on_kept)),
        }
    }
}

/// Reflection of the light that rises, kernel by kernel.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// Transmission of the scatterer.
    down: Face,
    /// Light that arrives at the scatterer, by extra node.
    arrives: Vec<f64>,
    /// Light that returns to the scatterer, by node; none if no light does.
    returns: Option<Vec<f64>>,
    /// Its own reflection.
    below: Option<(Arc<Matrix>, f64)>,
    /// Number of nodes with weight that the medium below carries, and of all of them.
    carried: usize,
    regular: usize,
}

impl Chain {
    pub(super) fn new(single: &Single<'_>, carried: usize, regular: usize) -> Self {
        let len = single.trips.len();
        let returns: Vec<f64> = (0..len).map(|i| single.returns(i)).collect();
        Self {
            down: single.down.clone(),
            arrives: (regular..len).map(|i| single.arrives(i)).collect(),
            returns: returns.iter().any(|r| *r != 0.0).then_some(returns),
            below: single.below.kernel.clone(),
            carried,
            regular,
        }
    }

    /// Returns the size in bytes of what it does not share.
    pub(super) fn bytes(&self) -> usize {
        let returns = self.returns.as_ref().map_or(0, Vec::len);
        8 * (self.down.straight.len() + self.arrives.len() + returns) + self.bytes_of_kernels(false)
    }

    /// Returns the size in bytes of the kernels that others have, too.
    pub(super) fn shared_bytes(&self) -> usize {
        self.bytes_of_kernels(true)
    }

    fn bytes_of_kernels(&self, shared: bool) -> usize {
        let kernels = [self.down.kernel.as_ref(), self.below.as_ref()].into_iter().flatten();
        let counted = kernels.filter(|(kernel, _)| (Arc::strong_count(kernel) > 1) == shared);
        8 * counted.map(|(kernel, _)| kernel.columns() * kernel.columns()).sum::<usize>()
    }

    /// Returns whether another one has the same kernels: they differ by factors for each direction alone.
    pub(super) fn shares(&self, other: &Self) -> bool {
        type Kernel = Option<(Arc<Matrix>, f64)>;
        let same = |one: &Kernel, other: &Kernel| match (one, other) {
            (Some((one, a)), Some((other, b))) => Arc::ptr_eq(one, other) && a == b,
            (None, None) => true,
            _ => false,
        };
        same(&self.down.kernel, &other.down.kernel)
            && same(&self.below, &other.below)
            && self.returns.is_some() == other.returns.is_some()
            && (self.carried, self.regular) == (other.carried, other.regular)
    }

    /// Adds the reflection of light by kernels to light on the nodes with weight: what keeps its direction is
    /// left out. `chains` is one for each column; they share their kernels. `reversed`: its transpose.
    pub(super) fn add(chains: &[&Self], rising: &Matrix, sum: &mut Matrix, reversed: bool) {
        let Some(first) = chains.first() else { return };
        match &first.below {
            Some((kernel, factor)) if reversed => sum.add_transposed_product(kernel, rising, *factor),
            Some((kernel, factor)) => sum.add_scaled_product(kernel, rising, *factor),
            None => {}
        }
        let Some((kernel, factor)) = first.again() else { return };
        let mut back = first.leaves(rising);
        for ((c, back), chain) in back.columns_mut().zip(chains) {
            chain.add_regular(back, sum.column_mut(c));
            chain.send_back(rising.column(c), back);
        }
        sum.add_scaled_product(kernel, &back, factor);
    }

    /// Returns the kernel of the transmission, if light returns to it.
    fn again(&self) -> Option<(&Matrix, f64)> {
        let (kernel, factor) = self.down.kernel.as_ref()?;
        self.returns.as_ref().map(|_| (&**kernel, *factor))
    }

    /// Returns the light that the scatterer transmits upwards by its kernel, on the nodes with weight.
    fn leaves(&self, rising: &Matrix) -> Matrix {
        let mut leaves = Matrix::zeros(self.regular, rising.columns());
        if let Some((kernel, factor)) = &self.down.kernel {
            leaves.add_transposed_product(kernel, rising, *factor);
        }
        leaves
    }

    /// Adds light that leaves by the kernel, returns, and passes the scatterer regularly.
    fn add_regular(&self, leaves: &[f64], sum: &mut [f64]) {
        let factors = self.returns.iter().flatten().zip(&self.down.straight);
        for ((sum, leaves), (r, d)) in sum.iter_mut().zip(leaves).zip(factors) {
            *sum += r * d * leaves;
        }
    }

    /// Adds to light that leaves by the kernel that which passes the scatterer regularly, and sends both back
    /// to it.
    fn send_back(&self, rising: &[f64], leaves: &mut [f64]) {
        let passes = rising.iter().zip(&self.down.straight).take(self.carried);
        leaves.iter_mut().zip(passes).for_each(|(back, (rises, d))| *back += d * rises);
        leaves.iter_mut().zip(self.returns.iter().flatten()).for_each(|(back, r)| *back *= r);
    }

    /// Returns light on the nodes with weight, times the kernels towards every extra node, `[extra, column]`:
    /// of light that leaves, and of light that is reflected once more. All are read out of one product, which
    /// depends on the light alone. `chains` is one for each column.
    pub(super) fn towards_extras(chains: &[&Self], rising: &Matrix) -> [Matrix; 2] {
        let Some(first) = chains.first() else { return [Matrix::zeros(0, 0), Matrix::zeros(0, 0)] };
        let n = first.regular;
        let mut leaves = first.scattered_to_extras(rising);
        let mut below = Matrix::zeros(leaves.rows(), rising.columns());
        if let Some((kernel, factor)) = first.again() {
            let mut back = first.leaves(rising);
            for ((c, back), chain) in back.columns_mut().zip(chains) {
                chain.send_back(rising.column(c), back);
            }
            below.add_product_of_rows(kernel, n, &back, n);
            for ((c, column), chain) in below.columns_mut().zip(chains) {
                let factors = chain.returns.iter().flatten().zip(&chain.down.straight).skip(n);
                for ((sum, (r, d)), leaves) in column.iter_mut().zip(factors).zip(leaves.column(c)) {
                    *sum = *sum * factor + r * d * leaves;
                }
            }
        }
        if let Some((kernel, factor)) = &first.below {
            below.add_transposed_product_of_columns(kernel, n, rising, *factor);
        }
        Self::pass_flat_layers(chains, &mut leaves);
        [leaves, below]
    }

    /// Returns the same of light that leaves.
    pub(super) fn leaves_towards_extras(chains: &[&Self], rising: &Matrix) -> Matrix {
        let Some(first) = chains.first() else { return Matrix::zeros(0, 0) };
        let mut leaves = first.scattered_to_extras(rising);
        Self::pass_flat_layers(chains, &mut leaves);
        leaves
    }

    /// Returns the light that the scatterer transmits upwards by its kernel towards every extra node,
    /// `[extra, column]`.
    fn scattered_to_extras(&self, rising: &Matrix) -> Matrix {
        let mut leaves = Matrix::zeros(self.arrives.len(), rising.columns());
        if let Some((kernel, factor)) = &self.down.kernel {
            leaves.add_transposed_product_of_columns(kernel, self.regular, rising, *factor);
        }
        leaves
    }

    fn pass_flat_layers(chains: &[&Self], leaves: &mut Matrix) {
        for ((_, column), chain) in leaves.columns_mut().zip(chains) {
            column.iter_mut().zip(&chain.arrives).for_each(|(leaves, arrives)| *leaves *= arrives);
        }
    }

    /// Returns the reflection of light from extra nodes `entering` to the nodes with weight, and to all extra
    /// ones.
    pub(super) fn entering(&self, entering: &[usize]) -> [Matrix; 2] {
        let (n, beams) = (self.regular, entering.len());
        let direct = |out: usize, from: usize| {
            self.below.as_ref().map_or(0.0, |(kernel, factor)| factor * kernel[(out, from)])
        };
        let mut columns = Matrix::from_fn(self.carried, beams, |i, e| direct(i, n + entering[e]));
        let mut pairs = Matrix::from_fn(self.arrives.len(), beams, |e, b| direct(n + e, n + entering[b]));
        if let (Some((kernel, factor)), Some(returns)) = (self.again(), &self.returns) {
            let straight = &self.down.straight;
            let back = Matrix::from_fn(n, beams, |k, b| returns[k] * factor * kernel[(n + entering[b], k)]);
            columns.add_scaled_product(kernel, &back, factor);
            let own = |e: usize| returns[n + e] * straight[n + e] * factor;
            for (b, column) in columns.columns_mut() {
                let e = entering[b];
                let kernel = kernel.column(n + e);
                for (i, sum) in column.iter_mut().enumerate() {
                    *sum += straight[i] * back[(i, b)] + own(e) * kernel[i];
                }
            }
            pairs.add_product_of_rows(kernel, n, &back.scaled(factor), n);
            for (b, column) in pairs.columns_mut() {
                let b = entering[b];
                for (e, sum) in column.iter_mut().enumerate() {
                    *sum += own(e) * kernel[(n + b, n + e)] + own(b) * kernel[(n + e, n + b)];
                }
            }
        }
        [columns, pairs]
    }
}

//! Groups of wavelengths whose light is followed together.
//!
//! Behind a single scatterer, wavelengths differ by factors for each direction and share their kernels
//! ([`single`](super::super::single)): one product serves the columns of many groups.
//!
//! Each scattering event makes a lobe wider and its series of azimuthal orders shorter. Light that has met
//! the base more than once has been scattered twice as often as light that has met it once: it is negligible
//! from about half of the orders on, where light that has met the base once takes no iteration, but a sum
//! over the nodes.

use std::ops::Range;

use super::reflections::Reflections;
use super::{Above, Back, Rising};
use crate::adding::layered::matrix::Matrix;
use crate::adding::layered::single::Chain;

/// Number of columns after which a block ends: products then take as long for each column as with more.
const COLUMNS: usize = 96;

/// Layers of some groups of wavelengths over their bases.
#[derive(Debug)]
pub(in super::super) struct Block<'a> {
    /// Number of each group, with its columns.
    groups: Vec<(usize, Range<usize>)>,
    /// Layers of each column.
    layers: Vec<&'a Above>,
    /// Reflectance below the last scatterer, `[node, column]`.
    base: Matrix,
}

impl<'a> Block<'a> {
    /// Divides groups into blocks: for each group its number, its layers, and the reflectance below them,
    /// `[node, column]`. Each block is built when it is needed.
    pub(in super::super) fn divide(
        groups: impl IntoIterator<Item = (usize, &'a Above, &'a Matrix)>,
    ) -> impl Iterator<Item = Self> {
        let mut blocks: Vec<Vec<(usize, &Above, &Matrix)>> = Vec::new();
        for group in groups {
            let columns = |block: &[(usize, &Above, &Matrix)]| -> usize {
                block.iter().map(|(_, _, base)| base.columns()).sum()
            };
            match blocks.last_mut() {
                Some(block) if block[0].1.shares_kernels(group.1) && columns(block) < COLUMNS => {
                    block.push(group);
                }
                _ => blocks.push(vec![group]),
            }
        }
        blocks.into_iter().map(|block| Self::new(&block))
    }

    /// Builds a block of these groups, which share their kernels.
    pub(in super::super) fn new(all: &[(usize, &'a Above, &'a Matrix)]) -> Self {
        let (mut groups, mut layers) = (Vec::new(), Vec::new());
        for (number, above, base) in all {
            groups.push((*number, layers.len()..layers.len() + base.columns()));
            layers.extend(std::iter::repeat_n(*above, base.columns()));
        }
        let bases: Vec<&Matrix> = all.iter().map(|(_, _, base)| *base).collect();
        Self { groups, layers, base: Matrix::beside(&bases) }
    }

    /// Returns the number of each group, with its columns.
    pub(in super::super) fn groups(&self) -> impl Iterator<Item = (usize, Range<usize>)> {
        self.groups.iter().cloned()
    }

    /// Returns the number of all columns.
    pub(in super::super) fn columns(&self) -> usize {
        self.layers.len()
    }

    /// Returns the layers of the group with these columns.
    pub(in super::super) fn above(&self, columns: &Range<usize>) -> &'a Above {
        self.layers[columns.start]
    }

    /// Returns the light of a beam that rises from the base, to this error relative to the largest density or
    /// to `floor`, by column; `floor` is raised to the largest density found. `once_alone`: only light that
    /// has met the base once, where that is known apart.
    pub(in super::super) fn rise(
        &self,
        extra: usize,
        tolerance: f64,
        floor: &mut [f64],
        once_alone: bool,
    ) -> Rising {
        let (beam, arrives) = self.arrives(extra);
        let reflections = Reflections::new(&self.layers, &self.base, false);
        let once = reflections.once(&arrives);
        if once_alone && !self.chains().is_empty() {
            return Rising { scattered: once, beam, extra, once: None, is_once_alone: true };
        }
        let scattered = reflections.rising(arrives, tolerance, floor);
        Rising { scattered, beam, extra, once: Some(once), is_once_alone: false }
    }

    /// Returns the regular light of a beam that rises, by column, and its scattered light that arrives at the
    /// base for the first time or after the regular light.
    fn arrives(&self, extra: usize) -> (Vec<f64>, Matrix) {
        let n = self.layers.first().map_or(0, |above| above.carried);
        let mut beam = Vec::with_capacity(self.layers.len());
        let mut arrives = Matrix::zeros(n, self.layers.len());
        for (c, above) in self.layers.iter().enumerate() {
            let entering = above.entering(extra);
            let rises = above.regular_rise(n + extra, self.base[(n + extra, c)]);
            beam.push(rises);
            let scattered = above.down.column(entering).iter().zip(above.below_extras.column(entering));
            for (arrives, (down, below)) in arrives.column_mut(c).iter_mut().zip(scattered) {
                *arrives = down + below * rises;
            }
        }
        (beam, arrives)
    }

    /// Returns the solution of the transposed problem: light on the nodes whose product with the light that
    /// arrives at the base, scattered, is the total of a functional of the light that rises; `functional` is
    /// its value at each node with weight, scaled.
    pub(in super::super) fn functional_of_arriving(&self, functional: &[f64], tolerance: f64) -> Matrix {
        let n = self.layers.first().map_or(0, |above| above.carried);
        let values = Matrix::from_fn(n, self.layers.len(), |i, _| functional[i]);
        let reflections = Reflections::new(&self.layers, &self.base, true);
        reflections.rising(values, tolerance, &mut vec![0.0; self.layers.len()])
    }

    /// Returns scattered light that rises, times the kernels towards each of these extra nodes,
    /// `[column, node]`: of light that leaves, and of light that is reflected once more.
    pub(in super::super) fn scattered_to(&self, scattered: &Matrix, extras: &[usize]) -> [Matrix; 2] {
        let Some(first) = self.layers.first() else { return [Matrix::zeros(0, 0), Matrix::zeros(0, 0)] };
        match &first.below {
            Back::Chain(_) => {
                let towards = Chain::towards_extras(&self.chains(), scattered);
                towards.map(|towards| towards.transposed_rows(extras))
            }
            Back::Formed(_) => [&first.down, &first.below_extras].map(|kernel| {
                let mut sums = Matrix::zeros(scattered.columns(), extras.len());
                sums.add_transposed_product(scattered, &kernel.some_columns(extras), 1.0);
                sums
            }),
        }
    }

    /// Returns the same of the light of a beam. What the base has reflected only once does not leave if it is
    /// apart.
    pub(in super::super) fn rising_to(&self, rising: &Rising, extras: &[usize]) -> [Matrix; 2] {
        if rising.is_once_alone {
            return self.once_to(&rising.scattered, extras);
        }
        let [mut leaving, again] = self.scattered_to(&rising.scattered, extras);
        if let Some(above) = self.layers.first().filter(|above| above.first_apart) {
            let first = above.down.column(above.entering(rising.extra));
            let towards: Vec<usize> = extras.iter().map(|extra| above.entering(*extra)).collect();
            let once =
                Matrix::from_fn(above.carried, extras.len(), |i, to| first[i] * above.down[(i, towards[to])]);
            leaving.add_transposed_product(&self.base, &once, -1.0);
        }
        [leaving, again]
    }

    /// Returns, of the light of a beam, that which has met the base once, as [`Self::rising_to`] does; `None`
    /// where the light of each order is needed as a whole.
    pub(in super::super) fn met_once(&self, rising: &Rising, extras: &[usize]) -> Option<[Matrix; 2]> {
        let is_apart = self.layers.iter().any(|above| above.first_apart);
        rising
            .once
            .as_ref()
            .filter(|_| !is_apart && !self.chains().is_empty())
            .map(|once| self.once_to(once, extras))
    }

    fn once_to(&self, once: &Matrix, extras: &[usize]) -> [Matrix; 2] {
        let chains = self.chains();
        let towards = Chain::leaves_towards_extras(&chains, once);
        [towards.transposed_rows(extras), Matrix::zeros(once.columns(), extras.len())]
    }

    fn chains(&self) -> Vec<&'a Chain> {
        self.layers.iter().filter_map(|above| above.below.chain()).collect()
    }

    /// Returns the kernel of the whole display between a view's extra node and a light, for the columns of a
    /// group: the beam entered at one of them and leaves at `to`, the other; `sums` are those of
    /// [`Self::rising_to`].
    pub(in super::super) fn leaves(
        &self,
        rising: &Rising,
        sums: [&[f64]; 2],
        pair: (usize, usize),
        to: usize,
        columns: &Range<usize>,
    ) -> Vec<f64> {
        self.above(columns).leaves(rising, sums, pair, to, (&self.base, columns.clone()))
    }
}

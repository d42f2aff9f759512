//! Sums over the nodes of the base's table, and gradients with respect to it.

use papilio_optics::with_widest_simd;

use crate::angular::mix;
use crate::numerics::product::{add_product, add_transposed_product};

/// Reflectances of a specular base at some nodes over angle, and the mixtures of them that are its states.
#[derive(Debug, Clone, Copy)]
pub struct TableValues<'a> {
    /// Basis reflectances, `[node][basis][wavelength]`.
    pub basis: &'a [f64],
    /// The fraction of each basis in each state, `[state][basis]`.
    pub mixture: &'a [f64],
    /// Additional reflectance common to all states, `[wavelength]`.
    pub common: &'a [f64],
}

/// Derivatives of a number by the table of a specular base; shapes are those of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableGradient {
    /// By each basis reflectance, `[node][basis][wavelength]`.
    pub basis: Vec<f64>,
    /// By the fraction of each basis in each state, `[state][basis]`.
    pub mixture: Vec<f64>,
    /// By the common reflectance of all states, `[wavelength]`.
    pub common: Vec<f64>,
}

impl TableGradient {
    /// Returns derivatives of zero.
    pub fn zero(values: &TableValues<'_>) -> Self {
        let zeros = |like: &[f64]| vec![0.0; like.len()];
        Self { basis: zeros(values.basis), mixture: zeros(values.mixture), common: zeros(values.common) }
    }
}

/// Weighted sums over the nodes of a table.
#[derive(Debug, Clone)]
pub struct TableSums<'a> {
    values: TableValues<'a>,
    /// `[sum][node]`.
    weights: &'a [f64],
    /// Number of sums.
    count: usize,
    /// `[sum][basis][wavelength]`.
    of_basis: Vec<f64>,
    /// Sums of the weights.
    totals: Vec<f64>,
    /// `[sum][state][wavelength]`.
    of_states: Vec<f64>,
}

impl<'a> TableSums<'a> {
    /// Computes this number of sums with the weights `[sum][node]`.
    pub fn new(count: usize, weights: &'a [f64], values: TableValues<'a>) -> Self {
        let nodes = weights.len() / count.max(1);
        let width = values.basis.len() / nodes.max(1);
        let states = values.mixture.len() * values.common.len() / width.max(1);
        let columns = states * values.common.len();
        let totals: Vec<f64> = weights.chunks_exact(nodes.max(1)).map(|row| row.iter().sum()).collect();
        let (mut of_basis, mut of_states) = (vec![0.0; count * width], vec![0.0; count * columns]);
        add_product(weights, values.basis, nodes, &mut of_basis);
        with_widest_simd(
            #[inline(always)]
            || {
                let sums =
                    of_basis.chunks_exact(width.max(1)).zip(of_states.chunks_exact_mut(columns.max(1)));
                for (total, (basis, states)) in totals.iter().zip(sums) {
                    mix((values.mixture, values.common), basis, *total, states);
                }
            },
        );
        Self { values, weights, count, of_basis, totals, of_states }
    }

    /// Returns the sums of the states, `[sum][state][wavelength]`.
    pub fn of_states(&self) -> &[f64] {
        &self.of_states
    }

    /// Returns the same, without the rest.
    pub fn into_states(self) -> Vec<f64> {
        self.of_states
    }

    /// Returns the number of states times that of wavelengths.
    pub(super) fn columns(&self) -> usize {
        self.of_states.len() / self.count.max(1)
    }

    /// Adds to the gradient of a number with this derivative by each sum of each state,
    /// `[sum][state][wavelength]`.
    pub(super) fn pull_back(&self, by_sums: &[f64], gradient: &mut TableGradient) {
        let bins = self.values.common.len();
        let basis = self.of_basis.len() / (self.count * bins).max(1);
        let mut by_basis = vec![0.0; self.of_basis.len()];
        for (sum, of_states) in by_sums.chunks_exact(self.columns().max(1)).enumerate() {
            for (state, seen) in of_states.chunks_exact(bins).enumerate() {
                gradient.common.iter_mut().zip(seen).for_each(|(c, seen)| *c += self.totals[sum] * seen);
                for b in 0..basis {
                    let at = (sum * basis + b) * bins;
                    let share = self.values.mixture[state * basis + b];
                    let pairs = self.of_basis[at..][..bins].iter().zip(seen);
                    gradient.mixture[state * basis + b] +=
                        pairs.map(|(value, seen)| value * seen).sum::<f64>();
                    if share != 0.0 {
                        let row = by_basis[at..][..bins].iter_mut().zip(seen);
                        row.for_each(|(sum, seen)| *sum += share * seen);
                    }
                }
            }
        }
        add_transposed_product(self.weights, &by_basis, self.count, &mut gradient.basis);
    }
}

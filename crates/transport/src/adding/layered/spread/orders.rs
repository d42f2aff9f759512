//! Light by azimuthal order: at each place the orders that it has.
//!
//! Kernels of a narrow lobe have hundreds of orders almost along the layers, where light of a view is far
//! from its peak and has few. Orders that are small compared with the others of the same node are dropped.

use num_complex::Complex64;

use super::super::grid::NEAREST;

/// Smallest light of a node relative to that of the brightest one whose orders matter.
const DARK: f64 = 1e-9;

/// Light at the nodes with weight.
#[derive(Debug, Clone)]
pub(super) struct Orders {
    highest: usize,
    /// `[node][order]`, from the most negative order on.
    values: Vec<Complex64>,
    /// Highest order that matters at each node.
    reach: Vec<usize>,
}

impl Orders {
    pub(super) fn zeros(nodes: usize, highest: usize) -> Self {
        Self {
            highest,
            values: vec![Complex64::ZERO; nodes * (2 * highest + 1)],
            reach: vec![highest; nodes],
        }
    }

    pub(super) fn highest(&self) -> usize {
        self.highest
    }

    pub(super) fn at(&self, node: usize, order: isize) -> Complex64 {
        self.values[self.place(node, order)]
    }

    pub(super) fn at_mut(&mut self, node: usize, order: isize) -> &mut Complex64 {
        let place = self.place(node, order);
        &mut self.values[place]
    }

    fn place(&self, node: usize, order: isize) -> usize {
        node * (2 * self.highest + 1) + self.highest.wrapping_add_signed(order)
    }

    /// Returns the orders of a node up to one, from the most negative one on.
    fn row(&self, node: usize, highest: usize) -> &[Complex64] {
        &self.values[node * (2 * self.highest + 1) + self.highest - highest..][..2 * highest + 1]
    }

    /// Adds a multiple of orders to those of a node.
    pub(super) fn add_row(&mut self, node: usize, factor: f64, orders: &[Complex64]) {
        let begin = node * (2 * self.highest + 1) + self.highest - orders.len() / 2;
        let row = &mut self.values[begin..][..orders.len()];
        row.iter_mut().zip(orders).for_each(|(sum, x)| *sum += factor * x);
    }

    /// Adds other light at the same nodes.
    pub(super) fn add(&mut self, other: &Self) {
        self.grow(other.highest);
        for node in 0..self.reach.len() {
            self.add_row(node, 1.0, other.row(node, other.highest));
            self.reach[node] = self.reach[node].max(other.reach[node]);
        }
    }

    /// Makes room for higher orders.
    pub(super) fn grow(&mut self, highest: usize) {
        if highest > self.highest {
            let mut grown = Self::zeros(self.reach.len(), highest);
            for node in 0..self.reach.len() {
                grown.add_row(node, 1.0, self.row(node, self.highest));
            }
            *self = Self { reach: std::mem::take(&mut self.reach), ..grown };
        }
    }

    /// Drops the orders that are smaller than the largest one of their node by this factor.
    pub(super) fn settle(&mut self, tolerance: f64) {
        let least = self.largest() * DARK * DARK;
        let highest = self.highest;
        for (reach, row) in self.reach.iter_mut().zip(self.values.chunks_exact(2 * highest + 1)) {
            let largest = row.iter().map(Complex64::norm_sqr).fold(0.0, f64::max);
            let least = (tolerance * tolerance * largest).max(least);
            let matters = |m: &usize| row[highest + m].norm_sqr().max(row[highest - m].norm_sqr()) > least;
            *reach = (0..=highest).rev().find(matters).unwrap_or(0);
        }
        let needed = self.reach.iter().copied().max().unwrap_or(0);
        if needed < highest {
            let mut values = Vec::with_capacity(self.reach.len() * (2 * needed + 1));
            (0..self.reach.len()).for_each(|node| values.extend_from_slice(self.row(node, needed)));
            (self.values, self.highest) = (values, needed);
        }
    }

    /// Returns the square of the largest value.
    pub(super) fn largest(&self) -> f64 {
        self.values.iter().map(Complex64::norm_sqr).fold(0.0, f64::max)
    }

    /// Returns the highest order that matters at some nodes.
    pub(super) fn reach(&self, nodes: std::ops::Range<usize>) -> usize {
        self.reach[nodes].iter().copied().max().unwrap_or(0)
    }

    /// Writes the orders between nodes: those that matter there.
    pub(super) fn interpolate(
        &self,
        nodes: std::ops::Range<usize>,
        factors: &[f64; NEAREST],
        out: &mut Vec<Complex64>,
    ) {
        let highest = self.reach(nodes.clone());
        out.clear();
        out.resize(2 * highest + 1, Complex64::ZERO);
        for (node, factor) in nodes.zip(factors) {
            out.iter_mut().zip(self.row(node, highest)).for_each(|(sum, x)| *sum += factor * x);
        }
    }
}

/// Light on the rings of a wave: of each ring an odd number of orders, from the most negative one on.
#[derive(Debug, Clone, Default)]
pub(super) struct OnRings {
    ends: Vec<usize>,
    values: Vec<Complex64>,
}

impl OnRings {
    /// Makes room for so many rings and orders in all.
    pub(super) fn with_capacity(rings: usize, orders: usize) -> Self {
        Self { ends: Vec::with_capacity(rings), values: Vec::with_capacity(orders) }
    }

    /// Adds the orders of the next ring; none if it has no light.
    pub(super) fn push(&mut self, orders: &[Complex64]) {
        self.values.extend_from_slice(orders);
        self.ends.push(self.values.len());
    }

    /// Adds rings without light until there are so many.
    pub(super) fn pad(&mut self, rings: usize) {
        self.ends.resize(rings, self.values.len());
    }

    pub(super) fn ring(&self, ring: usize) -> &[Complex64] {
        let begin = if ring == 0 { 0 } else { self.ends[ring - 1] };
        &self.values[begin..self.ends[ring]]
    }

    /// Multiplies each ring by a factor.
    pub(super) fn scaled(mut self, factor: impl Fn(usize) -> f64) -> Self {
        let mut begin = 0;
        for (ring, end) in self.ends.iter().enumerate() {
            let factor = factor(ring);
            self.values[begin..*end].iter_mut().for_each(|value| *value *= factor);
            begin = *end;
        }
        self
    }

    /// Returns the mean over the azimuth.
    pub(super) fn mean(&self, ring: usize) -> Complex64 {
        let orders = self.ring(ring);
        orders.get(orders.len() / 2).copied().unwrap_or_default()
    }
}

/// Returns the orders up to one, or all.
pub(super) fn up_to(orders: &[Complex64], highest: usize) -> &[Complex64] {
    let dropped = (orders.len() / 2).saturating_sub(highest);
    &orders[dropped..orders.len() - dropped]
}

//! The effect of operators on beams at a few nodes, where a whole operator would be too large.

use std::ops::Range;

use super::algebra::Operator;
use super::matrix::{Factors, Matrix};

/// Light of unit beams, each of which entered at a node of its own.
#[derive(Debug)]
pub(super) struct Beams {
    /// The node of each beam.
    nodes: Vec<usize>,
    /// Remaining regular light of each beam.
    straight: Vec<f64>,
    /// Scattered light, `[node, beam]`, scaled; `None` before any scattering.
    scattered: Option<Matrix>,
}

impl Beams {
    /// Returns unit beams at these nodes.
    pub(super) fn units(nodes: Vec<usize>) -> Self {
        Self { straight: vec![1.0; nodes.len()], nodes, scattered: None }
    }

    /// Applies the transpose of an operator (its reverse) to unit beams at these nodes.
    pub(super) fn sent_back_by(operator: &Operator, nodes: Vec<usize>) -> Self {
        let straight = nodes.iter().map(|&node| operator.straight[node]).collect();
        let scattered = operator.kernel.as_ref().map(|kernel| kernel.transposed_rows(&nodes));
        Self { nodes, straight, scattered }
    }

    /// Returns the node of each beam.
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Selects beams by number.
    pub(super) fn some(&self, numbers: impl Iterator<Item = usize>) -> Self {
        let numbers: Vec<usize> = numbers.collect();
        Self {
            nodes: numbers.iter().map(|&beam| self.nodes[beam]).collect(),
            straight: numbers.iter().map(|&beam| self.straight[beam]).collect(),
            scattered: self.scattered.as_ref().map(|scattered| scattered.some_columns(&numbers)),
        }
    }

    /// Returns scattered light at a node.
    pub(super) fn at(&self, node: usize, beam: usize) -> f64 {
        self.scattered.as_ref().map_or(0.0, |scattered| scattered[(node, beam)])
    }
}

impl Operator {
    /// Applies the operator to beams.
    pub(super) fn send(&self, beams: &Beams) -> Beams {
        let straight = beams.nodes.iter().zip(&beams.straight).map(|(&node, x)| self.straight[node] * x);
        Beams {
            nodes: beams.nodes.clone(),
            straight: straight.collect(),
            scattered: self.send_to(beams, 0..self.len()),
        }
    }

    /// Returns the scattered light that it makes of beams at some nodes; `None` if there is none.
    pub(super) fn send_to(&self, beams: &Beams, rows: Range<usize>) -> Option<Matrix> {
        if self.kernel.is_none() && beams.scattered.is_none() {
            return None;
        }
        let mut sent = Matrix::zeros(rows.len(), beams.nodes.len());
        for (beam, column) in sent.columns_mut() {
            if let Some(scattered) = &beams.scattered {
                let terms = self.straight[rows.clone()].iter().zip(&scattered.column(beam)[rows.clone()]);
                column.iter_mut().zip(terms).for_each(|(x, (d, s))| *x = d * s);
            }
            if let Some(kernel) = &self.kernel {
                let from = &kernel.column(beams.nodes[beam])[rows.clone()];
                column.iter_mut().zip(from).for_each(|(x, k)| *x += k * beams.straight[beam]);
            }
        }
        if let (Some(kernel), Some(scattered)) = (&self.kernel, &beams.scattered) {
            sent.add_product_of_rows(kernel, rows.start, scattered, self.regular);
        }
        Some(sent)
    }

    /// Solves for the beams from which the operator makes these, with the factors of its
    /// [`weighted_block`](Operator::weighted_block) if it has a kernel, or of its transpose.
    pub(super) fn unsend(&self, mut beams: Beams, factors: Option<&Factors>, of_transpose: bool) -> Beams {
        let inverse = self.inverse_straight();
        for (x, &node) in beams.straight.iter_mut().zip(&beams.nodes) {
            *x *= inverse[node];
        }
        let (Some(kernel), Some(factors)) = (&self.kernel, factors) else {
            for (_, column) in beams.scattered.iter_mut().flat_map(Matrix::columns_mut) {
                column.iter_mut().zip(&inverse).for_each(|(x, inverse)| *x *= inverse);
            }
            return beams;
        };
        let mut x = beams.scattered.unwrap_or_else(|| Matrix::zeros(self.len(), beams.nodes.len()));
        for (beam, column) in x.columns_mut() {
            let from = kernel.column(beams.nodes[beam]);
            column.iter_mut().zip(from).for_each(|(x, k)| *x -= k * beams.straight[beam]);
        }
        factors.solve_either(&mut x, of_transpose);
        x.eliminate(kernel, self.regular);
        for (_, column) in x.columns_mut() {
            column.iter_mut().zip(&inverse).skip(self.regular).for_each(|(x, inverse)| *x *= inverse);
        }
        Beams { scattered: Some(x), ..beams }
    }
}

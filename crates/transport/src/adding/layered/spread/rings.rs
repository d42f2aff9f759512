//! Directions at which the phases of a frequency are resolved.
//!
//! Light between scatterers is smooth in `|beta|` but for the phases. It is known at the nodes of the grid;
//! between them it is interpolated at the rings, on which the phases are resolved. Light that leaves almost
//! along the layers has phases that no rule resolves, and too little weight to matter: beyond a largest phase
//! there are no rings.

use std::f64::consts::PI;

use super::super::grid::{Grid, Interpolation, NEAREST};
use super::chain::{Chain, moved_mm};
use crate::Stack;
use crate::numerics::quadrature::gauss;

/// Points of a panel of rings, and the radians of the phase that they integrate.
const POINTS: usize = 10;
const RADIANS: f64 = 6.0;

/// Nodes of the grid within a panel.
const NODES: f64 = 5.0;

/// Directions of one `|beta|`.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    pub(super) beta: f64,
    /// Area of direction cosines; 0 where light is only evaluated.
    pub(super) weight: f64,
    /// Nodes between which light is interpolated, and their factors.
    pub(super) nodes: std::ops::Range<usize>,
    pub(super) factors: [f64; NEAREST],
    pub(super) chain: Chain,
}

/// What rings are made for.
pub(super) struct Resolution<'a> {
    pub(super) stack: &'a Stack,
    pub(super) bin: usize,
    pub(super) grid: &'a Grid,
    pub(super) interpolation: &'a Interpolation,
    /// Largest phase.
    pub(super) most: f64,
}

impl Resolution<'_> {
    /// Returns the rings for a frequency in radians per mm, and at last those of the extra nodes of the grid,
    /// without weight.
    pub(super) fn rings(&self, per_mm: f64) -> Vec<Ring> {
        let mut rings = Vec::new();
        // Light up to 76 degrees in a medium has its phases, however large they are.
        let thickness = self.stack.thickness_mm();
        let most = self.most.max(4.0 * per_mm * thickness);
        for ([a, b], count) in self.grid.ranges() {
            let beta = |x: f64| (a * a + (b * b - a * a) * (0.25 * PI * (x + 1.0)).sin().powi(2)).sqrt();
            let area = |x: f64| 0.25 * PI * PI * (b * b - a * a) * (0.5 * PI * (x + 1.0)).sin();
            let panels = (count as f64 / NODES).ceil().max(2.0) as usize;
            let width = 2.0 / panels as f64;
            // The last ones first.
            let mut rest: Vec<[f64; 2]> = (0..panels)
                .rev()
                .map(|k| {
                    [
                        -1.0 + k as f64 * width,
                        if k + 1 == panels { 1.0 } else { -1.0 + (k + 1) as f64 * width },
                    ]
                })
                .collect();
            while let Some([from, to]) = rest.pop() {
                let phase = |x: f64| per_mm * self.moved_mm(beta(x));
                let begin = phase(from);
                if begin > most {
                    continue;
                }
                // A medium that ends there has no largest phase.
                let inside = to - 1e-3 * (to - from);
                if phase(inside) - begin > RADIANS && to - from > 1e-9 {
                    let middle = 0.5 * (from + to);
                    rest.extend([[middle, to], [from, middle]]);
                    continue;
                }
                for node in gauss(from, to, POINTS) {
                    rings.push(self.ring(beta(node.x), area(node.x) * node.weight));
                }
            }
        }
        let extras = &self.grid.beta[self.grid.regular..];
        rings.extend(extras.iter().map(|beta| self.ring(*beta, 0.0)));
        rings
    }

    fn moved_mm(&self, beta: f64) -> f64 {
        let layers = self.stack.layers.iter();
        layers.map(|layer| moved_mm(layer.medium.index()[self.bin], layer.thickness_mm, beta)).sum()
    }

    fn ring(&self, beta: f64, weight: f64) -> Ring {
        let (nodes, factors) = self.interpolation.factors(beta);
        let chain = Chain::new(self.stack, self.bin, beta);
        Ring { beta, weight, nodes, factors, chain }
    }
}

//! The closest colours of a hull, interpolated on a lattice, for pictures.
//!
//! **What.** [`GamutMapping::closest`] at the nodes of a lattice of coordinates, each computed when it is first
//! needed, with linear interpolation of X, Y, Z: the hull is convex, so that an interpolated colour is in it.
//! What the hull contains is not interpolated. The result does not depend on the order of the colours, nor on threads.
//!
//! **Range.** Chromatic coordinates from -0.5 to 0.5 of the white's lightness; others are computed one by one.

use std::sync::OnceLock;

use super::GamutMapping;
use crate::Xyz;

/// Steps of the lattice in lightness, 0 to 1, and as many from -0.5 to 0.5.
const STEPS: usize = 64;
const NODES: usize = STEPS + 1;

/// Nodes of a lattice that are known so far.
#[derive(Debug)]
pub struct ClosestLattice<'a> {
    mapping: &'a GamutMapping,
    /// X, Y, Z by lightness, a and b, of the nodes that were needed.
    nodes: Vec<OnceLock<[f64; 3]>>,
}

impl<'a> ClosestLattice<'a> {
    /// A lattice without nodes.
    pub fn new(mapping: &'a GamutMapping) -> Self {
        let nodes = (0..NODES * NODES * NODES).map(|_| OnceLock::new()).collect();
        Self { mapping, nodes }
    }

    /// The colour of the hull closest to coordinates that it does not contain.
    pub fn closest(&self, target: [f64; 3]) -> Xyz {
        let [lightness, a, b] = target;
        let mut base = [0; 3];
        let mut parts = [0.0; 3];
        for (k, value) in [lightness, a + 0.5, b + 0.5].into_iter().enumerate() {
            if !(0.0..=1.0).contains(&value) {
                return self.mapping.closest(target);
            }
            base[k] = ((value * STEPS as f64) as usize).min(STEPS - 1);
            parts[k] = value * STEPS as f64 - base[k] as f64;
        }
        let mut sum = Xyz { x: 0.0, y: 0.0, z: 0.0 };
        for corner in 0..8_usize {
            let on = [0, 1, 2].map(|k| corner >> k & 1);
            let weight: f64 = (0..3).map(|k| if on[k] == 1 { parts[k] } else { 1.0 - parts[k] }).product();
            if weight > 0.0 {
                sum = sum + self.node([0, 1, 2].map(|k| base[k] + on[k])) * weight;
            }
        }
        sum
    }

    fn node(&self, at: [usize; 3]) -> Xyz {
        let index = (at[0] * NODES + at[1]) * NODES + at[2];
        let closest = || {
            let [lightness, a, b] = at.map(|k| k as f64 / STEPS as f64);
            self.mapping.closest([lightness, a - 0.5, b - 0.5]).to_array()
        };
        let [x, y, z] = *self.nodes[index].get_or_init(closest);
        Xyz { x, y, z }
    }
}

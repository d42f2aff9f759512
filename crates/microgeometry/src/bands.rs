//! Bands of |beta| into which directions are sorted, on both sides of a surface.

use std::f64::consts::PI;
use std::ops::Range;

use crate::Side;

/// Bands of |beta| = n sin θ. Those up to the lower index are the same on both sides; 1, the limit of
/// directions in air, is an edge.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Edges of the bands above and below, from 0 to the index of the side.
    edges: [Vec<f64>; 2],
}

/// Steps of the angle in air, degrees.
const STEP_DEG: f64 = 2.5;

/// Azimuths in a half turn.
pub(crate) const AZIMUTHS: usize = 36;

impl Bands {
    /// Bands of about 2.5 deg: in air up to 1, in the rarer medium up to its index, in the denser one beyond.
    ///
    /// Both sides have the same bands up to the lower index, so that regular light leaves a band for one
    /// band.
    pub(crate) fn new(index: [f64; 2]) -> Self {
        let mut limits = [1.0, index[0], index[1]];
        limits.sort_by(f64::total_cmp);
        let edges = index.map(|index| {
            let mut edges = vec![0.0];
            let mut from = 0.0;
            for to in limits.into_iter().filter(|limit| *limit <= index) {
                if to - from > 1e-9 * to {
                    let start = (from / to).asin();
                    let count = ((PI / 2.0 - start).to_degrees() / STEP_DEG).ceil().max(1.0) as usize;
                    let edge = |k: usize| to * (start + (PI / 2.0 - start) * k as f64 / count as f64).sin();
                    edges.extend((1..count).map(edge).chain([to]));
                    from = to;
                }
            }
            edges
        });
        Self { edges }
    }

    /// Edges of the bands of a side, ascending from 0 to its index.
    pub fn edges(&self, side: Side) -> &[f64] {
        &self.edges[side as usize]
    }

    /// Number of bands on both sides.
    pub fn count(&self) -> usize {
        self.edges.iter().map(|edges| edges.len() - 1).sum()
    }

    /// Numbers of the bands of a side: those above come first.
    pub fn of(&self, side: Side) -> Range<usize> {
        let above = self.edges[0].len() - 1;
        match side {
            Side::Above => 0..above,
            Side::Below => above..self.count(),
        }
    }

    /// The side of a band, and its edges.
    pub fn band(&self, number: usize) -> (Side, [f64; 2]) {
        let side = if self.of(Side::Above).contains(&number) { Side::Above } else { Side::Below };
        let at = number - self.of(side).start;
        (side, [self.edges(side)[at], self.edges(side)[at + 1]])
    }

    /// The number of the band with a |beta|.
    pub(crate) fn number(&self, side: Side, beta: f64) -> usize {
        let edges = self.edges(side);
        let at = edges.partition_point(|edge| *edge <= beta).clamp(1, edges.len() - 1) - 1;
        self.of(side).start + at
    }

    /// Area of a band in the plane of beta: the étendue of its directions per area of the surface.
    pub fn area(&self, number: usize) -> f64 {
        let (_, [from, to]) = self.band(number);
        PI * (to * to - from * from)
    }
}

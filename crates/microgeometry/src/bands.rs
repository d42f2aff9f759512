//! Bands of |beta| into which directions are sorted, on both sides of a surface.

use std::f64::consts::PI;
use std::ops::Range;

use crate::Side;

/// Bands of |beta| = n sin θ. Those up to 1, the directions that exist in air, are the same on both sides.
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
    /// Bands of 2.5 deg in air, and as wide ones in the angle beyond.
    pub(crate) fn new(index: [f64; 2]) -> Self {
        let edges = index.map(|index| {
            let steps = |from: f64, to: f64, scale: f64| {
                let count = ((to - from).to_degrees() / STEP_DEG).ceil().max(1.0) as usize;
                (0..count).map(move |k| scale * (from + (to - from) * k as f64 / count as f64).sin())
            };
            let within: Vec<f64> = steps(0.0, PI / 2.0, 1.0).collect();
            match index > 1.0 {
                true => {
                    let critical = (1.0 / index).asin();
                    within.into_iter().chain(steps(critical, PI / 2.0, index)).chain([index]).collect()
                }
                false => {
                    let below = within.into_iter().filter(|edge| *edge < index - 1e-9);
                    below.chain([index]).collect()
                }
            }
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

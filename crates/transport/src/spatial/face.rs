//! Light that a flat face returns to a Lambertian plane below it.
//!
//! **What.** Light that leaves the plane at an inclination theta in a medium of thickness d comes back at a distance of
//! `2 d tan(theta)`, weakened by the reflectance F of the face (1 beyond the critical angle):
//! `A(f) = 2 integral of F(theta) J_0(4 pi f d tan(theta)) sin(theta) cos(theta) dtheta`.
//!
//! If all light came back, the integral would be `a K_1(a)`, a = 4 pi f d. What the face lets through is subtracted: an
//! integral up to the critical angle, in which the transmittance ends as a square root.
//!
//! **Intuition.** A(0) of bare glass is 0.596. Most of it is totally reflected, beyond a circle of radius
//! `2 d tan(critical angle)`: A(f) is negative where that circle is half a period.
//!
//! **Source.** Clapper, Yule, J. Opt. Soc. Am. 43, 600 (1953) for f = 0 and infinity.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::numerics::bessel::{j0, x_k1};
use crate::numerics::quadrature::{Node, gauss};

/// Width of a panel of the rule in radians of the phase `4 pi f d tan(theta)`: 16 points then integrate to 1e-14.
const PHASE_OF_PANEL: f64 = 8.0;
const POINTS: usize = 16;

/// Width of a panel of the table of what leaves, in radians of the phase at the critical angle, and the points on each.
const PHASE_OF_TABLE: f64 = 4.0;
pub(super) const POINTS_OF_TABLE: usize = 16;

/// Highest frequency times the thickness: less than 1e-6 of the light comes back beyond.
const HIGHEST: f64 = 100.0;

/// Step of the index below which a face reflects nothing.
const NO_INDEX_STEP: f64 = 1e-6;

/// Light that the face above a Lambertian plane returns to it, by spatial frequency.
#[derive(Debug, Clone)]
pub struct FaceReturn {
    thickness_mm: f64,
    /// The highest value of `a = 4 pi f d`.
    most: f64,
    /// tan(theta) at the critical angle.
    edge: f64,
    /// tan(theta) and the weight of what leaves.
    leaving: Vec<[f64; 2]>,
    table: Option<Table>,
    /// True above a medium like air, from which all light leaves.
    is_open: bool,
}

/// A over `a`, as Chebyshev polynomials.
#[derive(Debug, Clone)]
struct Table {
    /// Width of a panel.
    panel: f64,
    /// Coefficients on each panel: of what leaves on the first, where `a K_1(a)` is not analytic, of A on all others. What leaves is
    /// limited to the band of the critical angle, so that 16 points on a panel determine it to 1e-13.
    coefficients: Vec<[f64; POINTS_OF_TABLE]>,
}

impl FaceReturn {
    /// Prepares a face over a medium.
    ///
    /// - `transmittance`: of the face for light from below, 0 to 1, as a function of `|beta|` from 0 to 1.
    /// - `most_per_mm`: the highest frequency at which light comes back, cycles per mm: none does at higher ones, nor above 100/thickness.
    pub fn new(index: f64, thickness_mm: f64, most_per_mm: f64, transmittance: impl Fn(f64) -> f64) -> Self {
        if index <= 1.0 + NO_INDEX_STEP {
            let nothing = Vec::new();
            return Self { thickness_mm, most: 0.0, edge: 0.0, leaving: nothing, table: None, is_open: true };
        }
        let most = 4.0 * PI * (most_per_mm * thickness_mm).min(HIGHEST);
        let edge = (1.0 / (index * index - 1.0).max(1e-12).sqrt()).min(LONGEST_WAY);
        let panels = (most * edge / PHASE_OF_PANEL).ceil().max(1.0);
        // tan(theta) and the weight of what leaves.
        let mut leaving: Vec<[f64; 2]> = Vec::new();
        for panel in 0..panels as usize {
            let ends = [panel, panel + 1].map(|end| end as f64 / panels);
            // |beta| = 1 - (1 - v)^2: the square root at the critical angle becomes a straight line.
            leaving.extend(gauss(ends[0], ends[1], POINTS).map(|node| {
                let rest = 1.0 - node.x;
                let beta = 1.0 - rest * rest;
                let slope = 2.0 * rest;
                let tangent = beta / (index * index - beta * beta).sqrt();
                // 2 sin cos dtheta = 2 beta dbeta / n^2
                [tangent, 2.0 * beta * slope * node.weight / (index * index) * transmittance(beta)]
            }));
        }

//! Light that the layers of a panel return to its pixel, by spatial frequency.
//!
//! - A Lambertian pixel under a flat face: the halo `A(f) = 2 integral of F(theta) J_0(4 pi f D(theta)) sin cos dtheta`
//!   ([`FaceReturn`]), with further orders between the face and a front of screen above it, each at a larger distance.
//! - A Lambertian pixel under a diffuser and a front that returns the fraction g: what leaves the diffuser along beta is
//!   spread by `B(beta, f)`, the transform of the lobe around beta over the directions in the glass, and again on its way down:
//!   `A(f) = g/(pi n^2) integral of B(beta, f)^2 exp(-2 pi i f.2D_air(beta)) d^2 beta` over the disc of air.
//! - A mirror-like pixel under a flat face: light keeps its direction, and comes back at twice the shift of one crossing of the
//!   glass: `F(theta) exp(-2 pi i f.2D)`, a ghost.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_optics::interface::fresnel_reflectance;

use super::super::face::FrontReturn;
use super::super::spread::{Bundle, Incoming, Pair, Spread};
use super::super::{Accuracy, FaceReturn, Gap, displacement};
use super::Heights;
use crate::layers::Indices;
use crate::numerics::quadrature::{Pole, radial};
use crate::specular::FlatTop;
use crate::{Diffuser, Panel, Top};

/// Reflection of flat faces in one direction, above a mirror.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ghosts {
    /// Shift of a return trip through the glass, `[wavelength]`, and through the air above it, mm.
    glass_mm: Vec<[f64; 2]>,
    air_mm: [f64; 2],
    /// Reflectance of the face, its transmittance squared times the reflectance of the front above it, and the product of the
    /// reflectances between them, `[wavelength]`.
    face: Vec<[f64; 3]>,
}

impl Ghosts {
    /// Prepares the return of a face in this direction, and of a front above it.
    pub(super) fn new(panel: &Panel, heights: Heights, face: &FlatTop, beta: Beta) -> Option<Self> {
        if panel.single_pass {
            return None;
        }
        let of = |bin: usize| {
            let front = panel.front.reflectance_below[bin];
            [face.below[bin], face.t[bin].powi(2) * front, face.above[bin] * front]
        };
        let glass = |index: &f64| displacement(beta, 2.0 * heights.glass_mm, *index);
        Some(Self {
            glass_mm: panel.medium.index().iter().map(glass).collect(),
            air_mm: displacement(beta, 2.0 * heights.front_mm, 1.0),
            face: (0..panel.base.bins()).map(of).collect(),
        })
    }

    /// Returns the fraction that comes back of light that is modulated at this frequency, `[wavelength]`.
    pub(super) fn at(&self, f: [f64; 2]) -> Vec<Complex64> {
        let shifted = |way: &[f64; 2]| Complex64::cis(-2.0 * PI * (f[0] * way[0] + f[1] * way[1]));
        let air = shifted(&self.air_mm);
        let of = |(glass, [face, front, between]): (&[f64; 2], &[f64; 3])| {
            shifted(glass) * (face + front * air / (1.0 - between * air))
        };
        self.glass_mm.iter().zip(&self.face).map(of).collect()
    }
}

/// What comes back to a Lambertian pixel.
#[derive(Debug, Clone)]
pub(super) struct Halo {
    indices: Indices,
    /// For each index.
    faces: Vec<Face>,
    /// What the front sends back of the light that reaches it, `[wavelength]`.
    front: Vec<f64>,
}

/// What is above the glass.
#[derive(Debug, Clone)]
enum Face {
    /// A flat face, and the orders of light between it and a front that reflects everything.
    Flat(FaceReturn, Vec<FrontReturn>),
    /// A diffuser below a front that reflects everything.
    Diffuser(Arc<[Lit]>),
}

/// Light that leaves a diffuser in a direction.
#[derive(Debug)]
struct Lit {
    weight: f64,
    /// Return trip through the air along x, mm.
    air_mm: f64,
    /// Weights and places of its light on the pixel along x, mm.
    below: Vec<[f64; 2]>,
}

/// Orders of light between the face and a front above it: each is weaker by the product of their reflectances, and
/// most of what the face reflects is grazing.
const ORDERS: usize = 4;

impl Halo {
    /// Prepares the return to the pixel of a panel; `None` if nothing comes back.
    pub(super) fn new(panel: &Panel, heights: Heights, accuracy: Accuracy) -> Option<Self> {
        let reflects = panel.front.reflectance_below.max() > 0.0;
        let has_face = !matches!(panel.top, Top::Diffuser(_));
        if panel.single_pass || !(reflects || has_face) {
            return None;
        }
        let indices = Indices::new(&panel.medium, accuracy.digits);
        let face = |index: &f64| match &panel.top {
            Top::Diffuser(diffuser) => Face::Diffuser(lit(diffuser, *index, heights, accuracy)),
            Top::IdealAr | Top::Fresnel(_) => flat(panel, *index, heights, accuracy.most_per_mm),
        };
        let faces = indices.nodes.iter().map(face).collect();
        let front = &panel.front.reflectance_below;
        let front = match &panel.top {
            Top::Diffuser(diffuser) => {
                front.iter().zip(diffuser.transmittance.iter()).map(|(r, t)| r * t * t).collect()
            }
            Top::IdealAr | Top::Fresnel(_) => front.to_vec(),
        };
        Some(Self { indices, faces, front })
    }

    /// Returns the fraction that comes back of light that is modulated at this frequency (cycles per mm), `[wavelength]`.
    pub(super) fn at(&self, frequency_per_mm: f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.front.len()];
        for (number, face) in self.faces.iter().enumerate() {
            // A polynomial in the reflectance of the front.
            let terms: Vec<f64> = match face {
                Face::Flat(face, orders) => {
                    let orders = orders.iter().map(|order| order.at(frequency_per_mm));
                    std::iter::once(face.at(frequency_per_mm)).chain(orders).collect()
                }
                Face::Diffuser(lit) => {
                    let all = lit.iter().map(|lit| lit.at(2.0 * PI * frequency_per_mm));
                    vec![0.0, all.sum()]
                }
            };
            let all = |front: &f64| terms.iter().rfold(0.0, |sum, term| front * sum + term);
            let values: Vec<f64> = self.front.iter().map(all).collect();
            self.indices.add(number, &values, &mut sum);
        }
        sum
    }
}

impl Lit {
    /// The real part: that of the opposite direction has the opposite imaginary part.
    fn at(&self, wave: f64) -> f64 {
        let spread: Complex64 =
            self.below.iter().map(|[weight, x]| Complex64::from_polar(*weight, -wave * x)).sum();
        self.weight * (spread * spread * Complex64::cis(-wave * self.air_mm)).re
    }
}

/// Prepares a flat face and a front above it.
fn flat(panel: &Panel, index: f64, heights: Heights, most_per_mm: f64) -> Face {
    let reflectance = |beta: f64| match panel.top {
        Top::Fresnel(_) => fresnel_reflectance(1.0, index, beta),
        Top::IdealAr | Top::Diffuser(_) => 0.0,
    };
    let largest = panel.front.reflectance_below.max();
    let order = |order: usize| {
        let lengths = [heights.glass_mm, order as f64 * heights.front_mm];
        FrontReturn::new(index, lengths, most_per_mm, |beta| {
            let r = reflectance(beta);
            // The last order stands for all that follow.
            let rest = if order == ORDERS { 1.0 / (1.0 - r * largest) } else { 1.0 };
            (1.0 - r).powi(2) * r.powi(order as i32 - 1) * rest
        })
    };
    let orders = if largest > 0.0 { ORDERS } else { 0 };
    let alone = FaceReturn::new(index, heights.glass_mm, most_per_mm, |beta| 1.0 - reflectance(beta));
    Face::Flat(alone, (1..=orders).map(order).collect())
}

/// Natural digits that this return has less than other light: little comes back.
const DIGITS_LESS: f64 = 4.0;

/// Prepares a diffuser below a front that reflects everything.
fn lit(diffuser: &Diffuser, index: f64, heights: Heights, accuracy: Accuracy) -> Arc<[Lit]> {
    let digits = (accuracy.digits - DIGITS_LESS).max(4.0);
    let accuracy = Accuracy { digits, ..accuracy };
    let gap = Gap { index, thickness_mm: heights.glass_mm };
    // Phase of the light at the rim of the disc of air.
    let phase = 4.0
        * PI
        * accuracy.most_per_mm
        * (heights.glass_mm / (index * index - 1.0).sqrt() + heights.front_mm);
    let turns = (digits + phase).ceil();
    let grazing = Pole { at: 1.0 + 1.0 / (1.0 + 0.1 * phase), off: 0.0 };
    let mut all = Vec::new();
    for node in radial(1.0, &[], &[grazing], digits) {
        for turn in 0..turns as usize {
            let (sin, cos) = (PI * (turn as f64 + 0.5) / turns).sin_cos();
            let beta = Beta { x: node.x * cos, y: node.x * sin };
            let pair = Pair::new(diffuser, gap, Bundle::point(beta), Incoming::Pixel, accuracy);
            let below = Spread::of(pair);
            all.push(Lit {
                weight: node.weight / (turns * PI * index * index),
                air_mm: displacement(beta, 2.0 * heights.front_mm, 1.0)[0],
                below: below.samples().iter().map(|sample| [sample.weight, sample.shift_mm[0]]).collect(),
            });
        }
    }
    all.into()
}

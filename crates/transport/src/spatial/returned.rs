//! Light that the layers of a panel return to its pixel, by spatial frequency.
//!
//! - A Lambertian pixel under a flat face: the halo of eq. `A(f) = 2 integral of F(theta) J_0(4 pi f D(theta)) sin cos dtheta`
//!   ([`FaceReturn`]), with further orders between the face and a front of screen above it, each at a larger distance.
//! - A mirror-like pixel under a flat face: light keeps its direction, and comes back at twice the shift of one crossing of the
//!   glass: `F(theta) exp(-2 pi i f.2D)`, a ghost.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_optics::Beta;
use papilio_optics::interface::fresnel_reflectance;
use rustfft::num_complex::Complex64;

use super::face::FrontReturn;
use super::panel_spread::Heights;
use super::{Accuracy, FaceReturn, displacement};
use crate::adding::Indices;
use crate::specular::FlatTop;
use crate::{Panel, Top};

/// What comes back to the pixel of what leaves it.
#[derive(Debug, Clone)]
pub(super) enum Returned {
    /// Nothing, or nothing that is known.
    Nothing,
    /// By the faces above a mirror, in one direction.
    Ghosts(Arc<Ghosts>),
    /// By the faces above a Lambertian pixel.
    Halo(Arc<Halo>),
}

impl PartialEq for Returned {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Nothing, Self::Nothing) => true,
            (Self::Ghosts(one), Self::Ghosts(other)) => one == other,
            (Self::Halo(one), Self::Halo(other)) => Arc::ptr_eq(one, other),
            _ => false,
        }
    }
}

/// Reflection of flat faces in one direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ghosts {
    /// Shift of a return trip through the glass, `[wavelength]`, and through the air above it, mm.
    glass_mm: Vec<[f64; 2]>,
    air_mm: [f64; 2],
    /// Reflectance of the face, its transmittance squared times that of the front above it, and the reflectance of both of light
    /// between them, `[wavelength]`.
    face: Vec<[f64; 3]>,
}

/// Reflection of flat faces above a Lambertian plane.
#[derive(Debug)]
pub(super) struct Halo {
    indices: Indices,
    /// For each index, the face, and the orders of light between it and a front that reflects everything.
    faces: Vec<(FaceReturn, Vec<FrontReturn>)>,
    /// Reflectance of the front from below, `[wavelength]`.
    front: Vec<f64>,
}

/// Orders of light between the face and a front above it: each is weaker by the product of their reflectances, and
/// most of what the face reflects is grazing.
const ORDERS: usize = 4;

impl Returned {
    /// Prepares the return of a flat face, and of a front above it, to a mirror in this direction.
    pub(super) fn ghosts(panel: &Panel, heights: Heights, beta: Beta) -> Self {
        if panel.single_pass {
            return Self::Nothing;
        }
        let bins = panel.base.bins();
        let mut alone = FlatTop::new(bins);
        alone.set_surface(panel, beta.squared());
        let face = |bin: usize| {
            let front = panel.front.reflectance_below[bin];
            [alone.below[bin], alone.t[bin].powi(2) * front, alone.above[bin] * front]
        };
        let twice = |shift: [f64; 2]| shift.map(|shift| 2.0 * shift);
        let glass = |index: &f64| twice(displacement(beta, heights.glass_mm, *index));
        Self::Ghosts(Arc::new(Ghosts {
            glass_mm: panel.medium.index().iter().map(glass).collect(),
            air_mm: twice(displacement(beta, heights.front_mm, 1.0)),
            face: (0..bins).map(face).collect(),
        }))
    }

    /// Prepares the return of a flat face, and of a front above it, to a Lambertian pixel.
    pub(super) fn by_face(panel: &Panel, heights: Heights, accuracy: Accuracy) -> Self {
        if panel.single_pass {
            return Self::Nothing;
        }
        let (most, glass) = (accuracy.most_per_mm, heights.glass_mm);
        let indices = Indices::new(&panel.medium, accuracy.digits);
        let front = panel.front.reflectance_below.to_vec();
        let orders = if panel.front.reflectance_below.max() > 0.0 { ORDERS } else { 0 };
        let face = |index: &f64| {
            let reflectance = |beta: f64| match panel.top {
                Top::Fresnel(_) => fresnel_reflectance(1.0, *index, beta),
                Top::IdealAr | Top::Diffuser(_) => 0.0,
            };
            let order = |order: usize| {
                let lengths = [glass, order as f64 * heights.front_mm];
                FrontReturn::new(*index, lengths, most, |beta| {
                    let r = reflectance(beta);
                    // The last order stands for all that follow.
                    let rest = if order == ORDERS {
                        1.0 / (1.0 - r * panel.front.reflectance_below.max())
                    } else {
                        1.0
                    };
                    (1.0 - r).powi(2) * r.powi(order as i32 - 1) * rest
                })
            };
            let alone = FaceReturn::new(*index, glass, most, |beta| 1.0 - reflectance(beta));
            (alone, (1..=orders).map(order).collect())
        };
        let faces = indices.nodes.iter().map(face).collect();
        Self::Halo(Arc::new(Halo { indices, faces, front }))
    }

    /// Returns the fraction that comes back of light that is modulated at this frequency (cycles per mm), `[wavelength]`; empty
    /// if nothing does.
    pub(super) fn at(&self, frequency_per_mm: [f64; 2]) -> Vec<Complex64> {
        match self {
            Self::Nothing => Vec::new(),
            Self::Ghosts(ghosts) => ghosts.at(frequency_per_mm),
            Self::Halo(halo) => halo
                .at(frequency_per_mm[0].hypot(frequency_per_mm[1]))
                .into_iter()
                .map(Complex64::from)
                .collect(),
        }
    }
}

impl Halo {
    fn at(&self, frequency_per_mm: f64) -> Vec<f64> {
        let mut sum = vec![0.0; self.front.len()];
        for (number, (face, orders)) in self.faces.iter().enumerate() {
            let face = face.at(frequency_per_mm);
            let orders: Vec<f64> = orders.iter().map(|order| order.at(frequency_per_mm)).collect();
            let all = |front: &f64| orders.iter().rfold(0.0, |sum, order| front * (order + sum)) + face;
            let values: Vec<f64> = self.front.iter().map(all).collect();
            self.indices.add(number, &values, &mut sum);
        }
        sum
    }
}

impl Ghosts {
    fn at(&self, f: [f64; 2]) -> Vec<Complex64> {
        let shifted = |way: &[f64; 2]| Complex64::cis(-2.0 * PI * (f[0] * way[0] + f[1] * way[1]));
        let air = shifted(&self.air_mm);
        let of = |(glass, [face, front, between]): (&[f64; 2], &[f64; 3])| {
            shifted(glass) * (face + front * air / (1.0 - between * air))
        };
        self.glass_mm.iter().zip(&self.face).map(of).collect()
    }
}

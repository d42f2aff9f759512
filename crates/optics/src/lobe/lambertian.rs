//! The Lambertian lobe.
//!
//! `1/pi` for any two directions of the air hemisphere (`|beta| <= 1`), 0 elsewhere: the ideal diffuser whose
//! BTDF, referred to air, is the constant T/pi.

use std::f64::consts::PI;

use papilio_sampling::warp;

use crate::Beta;
use crate::scatterer::{Sample, Scatterer};

/// The same radiance in every direction of the air hemisphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lambertian;

impl Lambertian {
    /// Returns the direction of [`sample`](Scatterer::sample).
    #[inline(always)]
    pub(super) fn sample_direction(self, from: Beta, u: [f64; 2]) -> Option<Beta> {
        if from.squared() > 1.0 {
            return None;
        }
        let (x, y) = warp::uniform_disc(1.0, u);
        Some(Beta { x, y })
    }

    /// Returns the fraction of the lobe within the disc `|beta_o| <= radius`.
    #[inline(always)]
    pub fn fraction_within(self, radius: f64) -> f64 {
        (radius * radius).min(1.0)
    }
}

impl Scatterer for Lambertian {
    type Direction = Beta;

    #[inline(always)]
    fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        if from.squared() <= 1.0 && to.squared() <= 1.0 { 1.0 / PI } else { 0.0 }
    }

    #[inline(always)]
    fn sample(&self, from: Beta, u: [f64; 4]) -> Option<Sample<Beta>> {
        Some(Sample::exact(self.sample_direction(from, [u[0], u[1]])?, 1.0 / PI))
    }

    #[inline(always)]
    fn density(&self, from: Beta, to: Beta) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, from: Beta) -> f64 {
        if from.squared() > 1.0 { 0.0 } else { 1.0 }
    }
}

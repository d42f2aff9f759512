//! Lobes of the layers that scatter light on its way down, for drawings of the display.
//!
//! **What.** The BTDF of each diffuser in the plane of incidence, relative to its maximum, against the inclination in the
//! medium below. It is proportional to the radiance there. Rough interfaces and scattering slabs are left out: their
//! shapes need tables that take longer than a drawing may wait.

use papilio_optics::{Beta, Scatterer};
use papilio_transport::{Interface as Ready, ScatterFace};
use schemars::JsonSchema;
use serde::Serialize;

use crate::DisplayError;
use crate::run::Control;
use crate::scene::{Interface, Scene};

/// Lobe of a diffuser, for light from one direction.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TransmittedLobe {
    /// Number of the interface among those that scatter (diffusers, measured and rough ones), from the top, from 0.
    pub number: usize,
    /// Refractive index of the medium below, at the middle wavelength.
    pub index_below: f64,
    /// Inclinations of propagation in the medium below, degrees, ascending; positive to the right of the drawing.
    pub theta_deg: Vec<f64>,
    /// BTDF at these inclinations relative to its maximum, 0 to 1.
    pub relative: Vec<f64>,
}

/// Distances from the regular direction at which a lobe is sampled, in direction cosines: geometric, so that a lobe of
/// any width has points on its flanks.
const NEAREST: f64 = 5e-4;
const STEPS: i32 = 48;
const FURTHEST: f64 = 3.0;

/// Computes the lobes of all diffusers of a scene, top to bottom, for light of the first directed source, projected on the
/// plane of azimuth 0. Without a directed source, the light arrives along the normal.
///
/// # Errors
/// A surface that cannot be measured; if its measurement was stopped.
pub fn transmitted_lobes(scene: &Scene, control: &Control<'_>) -> Result<Vec<TransmittedLobe>, DisplayError> {
    let bin = scene.grid.len() / 2;
    let source = scene.lighting.directed.first();
    let beta = source.map_or(0.0, |one| Beta::from_source(one.theta_deg, one.phi_deg, 1.0).x);
    let from = Beta { x: beta, y: 0.0 };
    let mut number = 0;
    let mut lobes = Vec::new();
    for layer in &scene.display.layers {
        let index = layer.medium.index[bin];
        let lobe = match &layer.interface {
            Interface::Ready(Ready::Diffuser(diffuser)) => {
                sampled(number, index, from, |to| diffuser.lobe.evaluate(from, to))
            }
            Interface::Ready(Ready::Scatter(face)) => of_face(number, index, from, face),
            Interface::OfSurface(surface) => match surface.interface(&scene.grid, control)? {
                Ready::Scatter(face) => of_face(number, index, from, &face),
                _ => continue,
            },
            Interface::Rough { .. } => None,
            _ => continue,
        };
        number += 1;
        lobes.extend(lobe);
    }
    Ok(lobes)
}

fn of_face(number: usize, index: f64, from: Beta, face: &ScatterFace) -> Option<TransmittedLobe> {
    let kernel = &face.transmission()?.scatter;
    sampled(number, index, from, |to| kernel.evaluate(from, to))
}

/// Samples a lobe in the disc of the medium below; `None` if no light is scattered there.
fn sampled(number: usize, index: f64, from: Beta, btdf: impl Fn(Beta) -> f64) -> Option<TransmittedLobe> {
    let step = |k: i32| NEAREST * (FURTHEST / NEAREST).powf(f64::from(k) / f64::from(STEPS));
    let apart = (0..=STEPS).rev().map(|k| -step(k)).chain([0.0]).chain((0..=STEPS).map(step));
    let inside = apart.map(|apart| from.x + apart).filter(|x| x.abs() < index);
    let (theta_deg, values): (Vec<f64>, Vec<f64>) =
        inside.map(|x| ((x / index).asin().to_degrees(), btdf(Beta { x, y: 0.0 }))).unzip();
    let peak = values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
    let relative = values.iter().map(|value| if value.is_finite() { value / peak } else { 1.0 }).collect();
    (peak > 0.0).then_some(TransmittedLobe { number, index_below: index, theta_deg, relative })
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::lobe::Lobe;

    /// Half width of a k-correlation lobe: f falls as (1 + (d/b)^2)^(-3/2), to a half at d = b sqrt(2^(2/3) - 1).
    #[test]
    fn half_width_of_a_lobe_is_that_of_its_formula() {
        let (width, index, from) = (0.12, 1.5, Beta { x: -0.3, y: 0.0 });
        let lobe = Lobe::KCorrelation { width };
        let seen = sampled(0, index, from, |to| lobe.evaluate(from, to)).unwrap();
        let value = |x: f64| lobe.evaluate(from, Beta { x, y: 0.0 }) / lobe.evaluate(from, from);
        let half = width * (2f64.powf(2.0 / 3.0) - 1.0).sqrt();
        let is_half = (value(from.x + half) - 0.5).abs();
        let peak = seen.relative.iter().position(|value| *value == 1.0).unwrap();
        assert!((seen.theta_deg[peak] - (-0.2f64).asin().to_degrees()).abs() < 1e-9);
        assert!(seen.theta_deg.is_sorted() && seen.relative.iter().all(|value| (0.0..=1.0).contains(value)));
        // The samples lie on the curve of the formula.
        for (theta, relative) in seen.theta_deg.iter().zip(&seen.relative) {
            assert!((value(index * theta.to_radians().sin()) - relative).abs() < 1e-9);
        }
        assert!(is_half < 1e-9, "{is_half}");
    }
}

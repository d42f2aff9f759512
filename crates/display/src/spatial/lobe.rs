//! A lobe over mirror-like pixels, to first order: the weights of the pixel's angular table with a place each.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::spatial::{Accuracy, Binned, Gap, Light, Peak, Spread};
use papilio_transport::{Diffuser, Panel, Source};

use super::curve::Curves;
use super::{Level, Response};
use crate::DisplayError;
use crate::setup::ViewPoint;

/// Light of a source, if its spread has been worked out.
pub(super) fn light(source: &Source) -> Option<Light> {
    match source {
        Source::Diffuse => Some(Light::Diffuse),
        Source::Beam(beta) => Some(Light::Beam(*beta)),
        Source::Disc(_) | Source::Field(_) => None,
    }
}

pub(super) fn response(
    panel: &Panel,
    diffuser: &Diffuser,
    thickness_mm: f64,
    (view, light): (&ViewPoint, Light),
    weights: &[f64],
    level: Level,
) -> Result<Box<dyn Response>, DisplayError> {
    let index = panel.medium.index();
    if index.iter().any(|n| *n != index[0]) {
        let what = "a diffuser over glass with dispersion".to_owned();
        return Err(DisplayError::PlacesNotComputed { what, key: "display.glass.index".to_owned() });
    }
    // Both pass the diffuser and the front twice.
    let passed: Vec<f64> = (0..weights.len())
        .map(|bin| weights[bin] * (diffuser.transmittance[bin] * panel.front.transmittance[bin]).powi(2))
        .collect();
    let gap = Gap { index: index[0], thickness_mm };
    let accuracy = Accuracy { digits: level.digits, most_per_mm: level.most_per_mm };
    let spread = Spread::new(diffuser, gap, view.field.axis_towards(), light, accuracy);
    let curves = Curves::new(&panel.base, &panel.medium, index[0], &passed);
    let states = curves.states();
    let samples = spread.samples();
    let mut by_sample = Vec::with_capacity(samples.len() * states);
    for sample in samples {
        let beta_squared = sample.beta.squared();
        by_sample.extend((0..states).map(|state| sample.weight * curves.at(state, beta_squared)));
    }
    Ok(Box::new(LobeResponse { spread, curves, by_sample }))
}

struct LobeResponse {
    spread: Spread,
    curves: Curves,
    /// Light of each sample, `[sample][state]`.
    by_sample: Vec<f64>,
}

impl LobeResponse {
    fn by_state(&self, binned: &Binned) -> Vec<Vec<f64>> {
        let of_state = |state: usize| binned.sums(|beta_squared| self.curves.at(state, beta_squared));
        (0..self.curves.states()).map(of_state).collect()
    }
}

impl Response for LobeResponse {
    fn transfer(&self, [fx, fy]: [f64; 2]) -> Vec<Complex64> {
        let states = self.curves.states();
        let mut sums = vec![Complex64::ZERO; states];
        let own = self.spread.own_mm();
        for (sample, lights) in self.spread.samples().iter().zip(self.by_sample.chunks_exact(states)) {
            let turns = fx * (sample.shift_mm[0] - own[0]) + fy * (sample.shift_mm[1] - own[1]);
            let phase = Complex64::cis(-2.0 * PI * turns);
            sums.iter_mut().zip(lights).for_each(|(sum, light)| *sum += phase * light);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(&self.spread.point_spread().strips(axis, edges_mm))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(&self.spread.point_spread().rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(&self.spread.point_spread().cells(x_mm, y_mm))
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.spread.point_spread().images().iter().map(|image| image.at_mm).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.spread.point_spread().peaks().to_vec()
    }
}

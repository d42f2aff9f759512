//! A diffuser over any pixel, to first order: the weights of the pixel's angular table with a place each.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::spatial::{Accuracy, Binned, PanelSpread, Part, Peak, PointSpread};
use papilio_transport::{Panel, Source};

use super::curve::Curves;
use super::{Level, Response};
use crate::DisplayError;
use crate::setup::ViewPoint;

pub(super) fn response(
    panel: &Panel,
    lengths_mm: &[f64],
    (view, source): (&ViewPoint, &Source),
    weights: &[f64],
    level: Level,
) -> Result<Box<dyn Response>, DisplayError> {
    let accuracy = Accuracy { digits: level.digits, most_per_mm: level.most_per_mm };
    let spread = PanelSpread::new(panel, lengths_mm, &view.field, source, accuracy).map_err(|error| {
        DisplayError::PlacesNotComputed { what: error.to_string(), key: "display".to_owned() }
    })?;
    let of_part = |part: &Part| {
        let passed: Vec<f64> = weights.iter().zip(&part.through).map(|(weight, t)| weight * t).collect();
        let curves = Curves::new(&panel.base, &panel.medium, part.index(), &passed);
        let states = curves.states();
        let lights = part.samples.iter().flat_map(|sample| {
            let beta_squared = sample.beta.squared();
            let curves = &curves;
            (0..states).map(move |state| sample.weight * curves.at(state, beta_squared))
        });
        let lights = lights.collect();
        PartResponse { curves, lights }
    };
    let parts = spread.parts().iter().map(of_part).collect();
    Ok(Box::new(LobeResponse { spread, parts, states: panel.base.states() }))
}

struct LobeResponse {
    spread: PanelSpread,
    parts: Vec<PartResponse>,
    states: usize,
}

/// Y of the light of a part of the spread.
struct PartResponse {
    curves: Curves,
    /// Light of each sample, `[sample][state]`.
    lights: Vec<f64>,
}

impl LobeResponse {
    /// Sums what each part has in bins, `[state][bin]`.
    fn by_state(&self, binned: impl Fn(&PointSpread<'_>) -> Binned) -> Vec<Vec<f64>> {
        let mut sums: Vec<Vec<f64>> = vec![Vec::new(); self.states];
        for (part, response) in self.spread.parts().iter().zip(&self.parts) {
            let binned = binned(&self.spread.point_spread(part));
            for (state, sum) in sums.iter_mut().enumerate() {
                let values = binned.sums(|beta_squared| response.curves.at(state, beta_squared));
                sum.resize(values.len(), 0.0);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
            }
        }
        sums
    }

    fn points(&self) -> impl Iterator<Item = PointSpread<'_>> {
        self.spread.parts().iter().map(|part| self.spread.point_spread(part))
    }
}

impl Response for LobeResponse {
    fn transfer(&self, [fx, fy]: [f64; 2]) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.states];
        let own = self.spread.own_mm();
        for (part, response) in self.spread.parts().iter().zip(&self.parts) {
            for (sample, lights) in part.samples.iter().zip(response.lights.chunks_exact(self.states)) {
                let turns = fx * (sample.shift_mm[0] - own[0]) + fy * (sample.shift_mm[1] - own[1]);
                let phase = Complex64::cis(-2.0 * PI * turns);
                sums.iter_mut().zip(lights).for_each(|(sum, light)| *sum += phase * light);
            }
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.strips(axis, edges_mm))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.by_state(|points| points.cells(x_mm, y_mm))
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.points().flat_map(|points| points.images().to_vec()).map(|image| image.at_mm).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.points().flat_map(|points| points.peaks().to_vec()).collect()
    }
}

//! A second pattern: a filter at a height above the pixel, inside the lowest medium.

use super::path::Path;
use super::tracer::{FlatWork, Tracer, per_beta};
use crate::Layer;
use crate::skeleton::Propagation;
use crate::window::Window;

/// Windows with transmittances at a height above the pixel. Between them the filter is clear.
#[derive(Debug, Clone, PartialEq)]
pub struct FilterPlane {
    /// Height above the pixel in the lowest medium, mm.
    pub height_mm: f64,
    /// Period along x and y, mm.
    pub period_mm: [f64; 2],
    /// Windows in fractions of the period; no two overlap.
    pub windows: Vec<Window>,
    /// Transmittance of each window along the normal, `[window][wavelength]`; an oblique pass has its power
    /// 1/cos(theta).
    pub transmittance: Vec<Vec<f64>>,
}

impl FilterPlane {
    /// Window above a place, mm.
    pub fn window_at(&self, place_mm: [f64; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|k| (place_mm[k] / self.period_mm[k]).rem_euclid(1.0));
        self.windows.iter().position(|window| {
            let mut rectangles = window.rectangles.iter();
            rectangles.any(|one| (one.x[0]..one.x[1]).contains(&x) && (one.y[0]..one.y[1]).contains(&y))
        })
    }

    /// Transmittance of a pass at a place.
    fn pass(&self, place_mm: [f64; 2], bin: usize, slant: f64) -> f64 {
        match self.window_at(place_mm).map(|window| self.transmittance[window][bin]) {
            Some(t) if t > 0.0 => t.powf(slant),
            Some(_) => 0.0,
            None => 1.0,
        }
    }
}

impl Tracer<'_> {
    /// Moves a path across the lowest medium, through the filter inside.
    pub(super) fn move_through(&self, filter: &FilterPlane, path: &mut Path, flat: &mut FlatWork) {
        let layer = self.stack.layers.len() - 1;
        let Layer { medium, thickness_mm, .. } = &self.stack.layers[layer];
        let above = thickness_mm - filter.height_mm;
        let [first, second] = match path.going {
            Propagation::Down => [above, filter.height_mm],
            Propagation::Up => [filter.height_mm, above],
        };
        let beta = path.beta;
        path.move_back(|place| per_beta(medium, place, beta, first));
        path.passes_filter();
        let places = path.place_mm.len();
        for (bin, factor) in flat.factors.iter_mut().enumerate() {
            let cosine = (1.0 - beta.squared() / medium.index()[bin].powi(2)).max(0.0).sqrt();
            let place = path.place_mm[bin.min(places - 1)];
            *factor = if cosine > 0.0 { filter.pass(place, bin, 1.0 / cosine) } else { 0.0 };
        }
        path.light.multiply(&flat.factors);
        path.move_back(|place| per_beta(medium, place, beta, second));
    }
}

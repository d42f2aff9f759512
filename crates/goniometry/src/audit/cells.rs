//! Quality of a tensor tree: sums over its cells, without interpolation.
//!
//! f is constant over a cell, and the fraction of the square that a cell covers is its fraction of the
//! projected solid angle. The hemispherical value for a direction of the light is therefore the sum of value
//! x area x pi, exactly. An anisotropic tree has a mean over azimuths of the light. Details finer than a
//! cell, such as half-widths and haze, are unknown. The grid error is the part of the light that a display has elsewhere
//! than the cells, because it spreads it over rings.

use std::f64::consts::PI;

use papilio_optics::scatter::Scatter;

use super::{Audit, Incidence, reciprocity};
use crate::geometry::LitSquare;
use crate::tree::{moved_by_rings, ring_kernel};
use crate::{Direction, MeasuredPart, TensorTree};

/// Inclinations of the light: 0 to 85 deg in steps of 5.
const INCIDENCES: u32 = 18;

/// Audits one channel, given by its index.
pub(super) fn audit(tree: &TensorTree, part: &MeasuredPart, channel: usize) -> Audit {
    let values = part.channel(channel);
    let kernel = Scatter::from(ring_kernel(part, tree, channel, |_| 1.0));
    let at = |theta_deg: f64| Incidence {
        grid_error: Some(moved_by_rings(part, tree, channel, &kernel, theta_deg)),
        ..incidence(tree, part, channel, theta_deg)
    };
    let incidences: Vec<Incidence> = (0..INCIDENCES).map(|k| at(5.0 * f64::from(k))).collect();
    let count = |is: fn(&f64) -> bool| values.iter().filter(|value| is(value)).count();
    let lit = || values.iter().copied().filter(|value| *value > 0.0);
    let peak = lit().fold(0.0, f64::max);
    // Haze and clarity stay unknown: a cell about the direct beam is wider than the cone that haze excludes.
    Audit {
        cells: values.len(),
        lit: lit().count(),
        unmeasured: count(|value| value.is_nan()),
        negative: count(|value| *value < 0.0),
        dark_beyond_deg: 90.0,
        range: [lit().fold(f64::INFINITY, f64::min), peak],
        asymmetry: tree.asymmetry(values),
        reciprocity: reciprocity::of_pairs(part, channel, peak),
        incidences,
        ..Audit::empty()
    }
}

fn incidence(tree: &TensorTree, part: &MeasuredPart, channel: usize, theta_deg: f64) -> Incidence {
    let lights = tree.lights(theta_deg);
    let mean = |of: &dyn Fn(Direction) -> f64| {
        lights.iter().map(|light| of(*light)).sum::<f64>() / lights.len() as f64
    };
    let integral = tree.mean_total(part.channel(channel), theta_deg);
    let peak = mean(&|light| part.evaluate(channel, light, light.specular()).unwrap_or(0.0).max(0.0));
    Incidence::of_cells(theta_deg, integral, peak)
}

impl TensorTree {
    /// Relative root mean square difference of the totals of an anisotropic tree between azimuths of the light.
    pub(crate) fn asymmetry(&self, values: &[f64]) -> f64 {
        let (mut differences, mut squares) = (0.0, 0.0);
        for theta in [30.0, 60.0] {
            let totals: Vec<f64> =
                self.lights(theta).iter().map(|light| self.total(values, *light)).collect();
            let mean = totals.iter().sum::<f64>() / totals.len() as f64;
            differences += totals.iter().map(|total| (total - mean).powi(2)).sum::<f64>();
            squares += totals.len() as f64 * mean * mean;
        }
        if squares > 0.0 { f64::sqrt(differences / squares) } else { 0.0 }
    }

    /// Integral of f cos over the hemisphere, for light from this direction.
    pub(crate) fn total(&self, values: &[f64], light: Direction) -> f64 {
        let mut sum = 0.0;
        self.each_lit(values, light, &mut |LitSquare { size, value, .. }| sum += value * size * size);
        PI * sum
    }
}

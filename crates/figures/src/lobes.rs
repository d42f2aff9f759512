//! The lobes of a measurement, drawn by [`scattering`].

use papilio_goniometry::{Audit, Fill, MeasuredPart, Measurement, Shape};
use papilio_optics::Beta;

use crate::scattering::{ScatterCurve, ScatterMap, Scattering, scattering};

/// Incidences of the polar maps, degrees. The nearest incidences of the file are drawn.
const MAPS_DEG: [f64; 2] = [0.0, 45.0];
/// Largest number of curves: more cannot be told apart by their colours.
const CURVES: usize = 7;

/// Returns a file name and a figure for each part of a measurement that has an audit. The figure shows the
/// luminous channel.
pub fn lobes(measurement: &Measurement, audits: &[Option<Audit>]) -> Vec<(String, String)> {
    let one = |(part, audit): (&MeasuredPart, &Option<Audit>)| {
        let shape_with = |fill: Fill| Shape::of_part(part, part.luminous(), fill);
        let last_deg = audit.as_ref()?.dark_beyond_deg;
        let shape =
            MeasuredLobe { plain: shape_with(Fill::None)?, filled: shape_with(Fill::Tail)?, last_deg };
        let name = part.way.name().replace(' ', "-");
        let quantity = if part.way.is_transmission() { "BTDF (1/sr)" } else { "BRDF (1/sr)" };
        let figure = Scattering { quantity: quantity.to_owned(), curves: curves(&shape), maps: maps(&shape) };
        Some((name, scattering(&figure, &measurement.provenance.sample)))
    };
    measurement.parts.iter().zip(audits).filter_map(one).collect()
}

/// A lobe within the inclinations at which light was measured. It extends to the last inclination with light.
/// Without this limit, its edge would follow the outline of the cells, or decrease between the last cell with
/// light and the first one without.
struct MeasuredLobe {
    plain: Shape,
    filled: Shape,
    last_deg: f64,
}

impl MeasuredLobe {
    /// Returns the value at an inclination and a difference of direction cosines; NaN where no light was
    /// measured.
    fn value(&self, incidence: usize, theta_deg: f64, delta: Beta) -> f64 {
        let dark = theta_deg.abs() > self.last_deg + 1e-6 || self.plain.value(incidence, delta) <= 0.0;
        if dark { f64::NAN } else { self.filled.value(incidence, delta) }
    }
}

/// Returns curves in the plane of incidence: of each incidence, or of the first, the last and others at equal steps between them.
fn curves(shape: &MeasuredLobe) -> Vec<ScatterCurve> {
    let value = |k: usize, from: f64, to: f64| {
        shape.value(k, to, Beta { x: to.to_radians().sin() - from.to_radians().sin(), y: 0.0 })
    };
    let curve = |(k, from): (usize, f64)| ScatterCurve {
        name: None,
        incidence_deg: from,
        points: false,
        values: (-356..=356).map(|q| 0.25 * f64::from(q)).map(|to| (to, value(k, from, to))).collect(),
    };
    let incidences: Vec<f64> = shape.plain.incidences_deg().collect();
    let count = incidences.len().min(CURVES);
    let number = |k: usize| k * (incidences.len() - 1) / (count - 1).max(1);
    (0..count).map(number).map(|k| curve((k, incidences[k]))).collect()
}

/// Returns the maps of the hemisphere at the incidences closest to `MAPS_DEG`.
fn maps(shape: &MeasuredLobe) -> Vec<ScatterMap> {
    let incidences: Vec<f64> = shape.plain.incidences_deg().collect();
    let nearest = |wanted: f64| {
        let off = |k: &usize| (incidences[*k] - wanted).abs();
        (0..incidences.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    };
    let mut chosen: Vec<usize> = MAPS_DEG.into_iter().filter_map(nearest).collect();
    chosen.dedup();
    let theta_deg: Vec<f64> = (0..=89).map(f64::from).collect();
    let phi_deg: Vec<f64> = (0..120).map(|k| 3.0 * f64::from(k)).collect();
    let map = |k: usize| {
        let from = Beta { x: incidences[k].to_radians().sin(), y: 0.0 };
        let value = |theta: f64, phi: f64| {
            let to = Beta::towards(theta, phi, 1.0) - from;
            shape.value(k, theta, Beta { x: to.x, y: to.y.abs() })
        };
        let values = theta_deg.iter().flat_map(|theta| phi_deg.iter().map(|phi| value(*theta, *phi)));
        ScatterMap {
            incidence_deg: incidences[k],
            values: values.collect(),
            theta_deg: theta_deg.clone(),
            phi_deg: phi_deg.clone(),
        }
    };
    chosen.into_iter().map(map).collect()
}

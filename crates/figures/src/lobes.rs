//! A measurement's lobes, as [`scattering`] draws them.

use papilio_goniometry::{Audit, Fill, Measurement, Part, Shape};
use papilio_optics::Beta;

use crate::scattering::{ScatterCurve, ScatterMap, Scattering, scattering};

/// Incidences that the polar maps show, degrees; the nearest ones that the file has.
const MAPS_DEG: [f64; 2] = [0.0, 45.0];

/// A figure for each part of a measurement, with the name of its file: its luminous channel. Parts without an audit have none.
pub fn lobes(measurement: &Measurement, audits: &[Option<Audit>]) -> Vec<(String, String)> {
    let one = |(part, audit): (&Part, &Option<Audit>)| {
        let seen = |fill: Fill| Shape::of_part(part, part.luminous(), fill);
        let last_deg = audit.as_ref()?.dark_beyond_deg;
        let shape = Seen { plain: seen(Fill::None)?, filled: seen(Fill::Tail)?, last_deg };
        let name = part.way.name().replace(' ', "-");
        let quantity = if part.way.is_transmission() { "BTDF (1/sr)" } else { "BRDF (1/sr)" };
        let figure = Scattering { quantity: quantity.to_owned(), curves: curves(&shape), maps: maps(&shape) };
        Some((name, scattering(&figure, &measurement.provenance.sample)))
    };
    measurement.parts.iter().zip(audits).filter_map(one).collect()
}

/// A lobe as far as light was seen. Its rim would be as jagged as the cells, or fall off between the last lit and the first dark one:
/// lobes go on up to the last inclination with light.
struct Seen {
    plain: Shape,
    filled: Shape,
    last_deg: f64,
}

impl Seen {
    /// Towards an inclination, at this difference of direction cosines; NaN where no light was seen.
    fn value(&self, incidence: usize, theta_deg: f64, delta: Beta) -> f64 {
        let dark = theta_deg.abs() > self.last_deg + 1e-6 || self.plain.value(incidence, delta) <= 0.0;
        if dark { f64::NAN } else { self.filled.value(incidence, delta) }
    }
}

/// Each incidence in the plane of incidence.
fn curves(shape: &Seen) -> Vec<ScatterCurve> {
    let value = |k: usize, from: f64, to: f64| {
        shape.value(k, to, Beta { x: to.to_radians().sin() - from.to_radians().sin(), y: 0.0 })
    };
    let curve = |(k, from): (usize, f64)| ScatterCurve {
        name: None,
        incidence_deg: from,
        points: false,
        values: (-356..=356).map(|q| 0.25 * f64::from(q)).map(|to| (to, value(k, from, to))).collect(),
    };
    shape.plain.incidences_deg().enumerate().map(curve).collect()
}

/// The hemisphere at the incidences nearest to those wanted.
fn maps(shape: &Seen) -> Vec<ScatterMap> {
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

//! Uniform radiance in a part of the hemisphere around any direction: a partial sphere, or a sphere with a
//! gloss trap.
//!
//! # Model
//! The radiance is uniform where the angle from the axis is between two given angles, and zero below the
//! display's horizon. At one inclination, the lit directions are an interval of azimuths: the angle is less
//! than a where
//!
//! `cos a <= cos(theta) cos(theta_0) + sin(theta) sin(theta_0) cos(phi - phi_0)`.
//!
//! This condition is evaluated for lookups and integrals. The Monte Carlo solver draws directions from cells,
//! weighted with the lit fraction of their projected solid angle, which is exact over azimuth and computed by
//! a Gauss rule over inclination. Rows end at the largest and smallest inclination of the region's edges.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use papilio_transport::{Edge, Field, Radiance};

use super::pose::by_inclination;

/// Largest height of a row of cells, degrees.
const ROW_DEG: f64 = 0.25;
const COLUMNS: usize = 720;
/// Points and weights of the Gauss rule from 0 to 1.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_095),
    (0.230_765_344_947_158, 0.239_314_335_249_683),
    (0.5, 0.284_444_444_444_444),
    (0.769_234_655_052_842, 0.239_314_335_249_683),
    (0.953_089_922_969_332, 0.118_463_442_528_095),
];

/// Returns uniform light from directions at an angle of `from_deg` to `to_deg` from (`theta_deg`, `phi_deg`),
/// all in degrees, 0 to 180; `None` if none of it is above the horizon.
pub fn cap(theta_deg: f64, phi_deg: f64, from_deg: f64, to_deg: f64) -> Option<Field> {
    if theta_deg == 0.0 {
        return Field::ring(from_deg, to_deg.min(90.0));
    }
    let (axis, turn) = if theta_deg < 0.0 { (-theta_deg, phi_deg + 180.0) } else { (theta_deg, phi_deg) };
    let (axis, turn) = (axis.to_radians(), turn.to_radians());
    let edges = edges(axis.to_degrees(), [from_deg, to_deg]);
    let column = TAU / COLUMNS as f64;
    let mut radiance = vec![0.0; (edges.len() - 1) * COLUMNS];
    for (row, edge) in radiance.chunks_exact_mut(COLUMNS).zip(edges.windows(2)) {
        let squares = [edge[0], edge[1]].map(|edge| edge.to_radians().sin().powi(2));
        for (along, weight) in rule() {
            let theta = (squares[0] + along * (squares[1] - squares[0])).sqrt().asin();
            let [inner, outer] = [from_deg, to_deg].map(|angle| half_width(theta, axis, angle.to_radians()));
            for (start, end) in [(turn + inner, turn + outer), (turn - outer, turn - inner)] {
                add_light(row, start / column, end / column, weight);
            }
        }
    }
    let region = Region { axis: by_inclination(axis, turn), angles: [from_deg, to_deg].map(f64::to_radians) };
    Some(Field::of(Arc::new(region), &edges, COLUMNS, radiance)?.0)
}

/// Directions whose angle from an axis is between two angles, radians.
#[derive(Debug)]
struct Region {
    axis: [f64; 3],
    angles: [f64; 2],
}

impl Radiance for Region {
    fn at(&self, direction: [f64; 3]) -> f64 {
        // Half of the chord is accurate for the smallest angles.
        let apart = direction.iter().zip(self.axis).map(|(x, y)| (x - y).powi(2));
        let square = 0.25 * apart.sum::<f64>();
        let [from, to] = self.angles.map(|angle| (0.5 * angle).sin().powi(2));
        if (from..=to).contains(&square) { 1.0 } else { 0.0 }
    }

    fn edges(&self) -> Vec<Edge> {
        let edge = |radius| Edge { centre: self.axis, radius, scale: f64::INFINITY };
        self.angles.into_iter().filter(|angle| (1e-9..PI - 1e-9).contains(angle)).map(edge).collect()
    }

    fn span(&self) -> [f64; 2] {
        let axis = self.axis[0].hypot(self.axis[1]).atan2(self.axis[2]);
        let [from, to] = self.angles;
        let inner = if axis < from { from - axis } else { axis - to };
        [inner.clamp(0.0, FRAC_PI_2), (axis + to).min(FRAC_PI_2)]
    }

    fn is_even(&self) -> bool {
        true
    }
}

/// Points and weights over a row, from 0 to 1. If a row ends at an edge of the region, the width in azimuth
/// begins as a square root, which the substitution `sin^2` makes smooth.
fn rule() -> [(f64, f64); 5] {
    let rule = GAUSS.map(|(t, weight)| ((FRAC_PI_2 * t).sin().powi(2), weight * (PI * t).sin()));
    let sum: f64 = rule.iter().map(|(_, weight)| weight).sum();
    rule.map(|(along, weight)| (along, weight / sum))
}

/// Half of the width in azimuth, radians, within which the angle from the axis is less than `angle`.
fn half_width(theta: f64, axis: f64, angle: f64) -> f64 {
    let across = theta.sin() * axis.sin();
    let cosine = (angle.cos() - theta.cos() * axis.cos()) / across;
    if across == 0.0 {
        if theta.max(axis) < angle { PI } else { 0.0 }
    } else {
        cosine.clamp(-1.0, 1.0).acos()
    }
}

/// Adds `weight` to the columns from `start` to `end`, which are positions on the circle in units of columns.
fn add_light(row: &mut [f64], start: f64, end: f64, weight: f64) {
    let mut at = start;
    while at < end - 1e-12 {
        // Rounding must not cause a step of zero width.
        let next = ((at + 1e-9).floor() + 1.0).min(end);
        let column = (0.5 * (at + next)).floor().rem_euclid(row.len() as f64) as usize;
        row[column.min(row.len() - 1)] += weight * (next - at);
        at = next;
    }
}

/// Inclinations between rows, degrees: uniformly spaced, and those at which the region begins and ends in the
/// plane of its axis.
fn edges(axis_deg: f64, angles_deg: [f64; 2]) -> Vec<f64> {
    let rows = (90.0 / ROW_DEG) as usize;
    let mut edges: Vec<f64> = (0..=rows).map(|row| 90.0 * row as f64 / rows as f64).collect();
    for angle in angles_deg {
        edges.extend([axis_deg + angle, (axis_deg - angle).abs()].into_iter().filter(|edge| *edge < 90.0));
    }
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|next, last| *next - *last < 1e-6);
    // The last row must end at the horizon, even if edges were merged.
    if let Some(last) = edges.last_mut() {
        *last = 90.0;
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    /// A cap above the horizon has the irradiance of a disc, pi sin^2(a) cos(theta): the ratio of radiance to
    /// irradiance is the reciprocal.
    #[test]
    fn cap_above_the_horizon_equals_a_disc() {
        for (theta, phi, angle) in
            [(8.0, 0.0, 5.0), (-8.0, 0.0, 5.0), (40.0, 77.0, 20.0), (3.0, -120.0, 30.0)]
        {
            let field = cap(theta, phi, 0.0, angle).unwrap();
            let truth = 1.0 / (PI * angle.to_radians().sin().powi(2) * theta.to_radians().cos());
            let at = |off: f64| field.radiance(Beta::from_source(theta + off, phi, 1.0)) / truth;
            for off in [0.0, 0.9 * angle, -0.9 * angle] {
                assert!((at(off) - 1.0).abs() < 2e-5, "{theta} {phi} {off}: {}", at(off));
            }
            assert_eq!((at(angle + 0.6), at(-angle - 0.6)), (0.0, 0.0));
        }
    }

    /// The irradiance is that of the hemisphere, pi, less that of the trap.
    #[test]
    fn hemisphere_with_a_trap_lacks_the_light_of_the_trap() {
        let field = cap(-8.0, 0.0, 5.0, 180.0).unwrap();
        let truth = 1.0 / (PI - PI * 5.0_f64.to_radians().sin().powi(2) * 8.0_f64.to_radians().cos());
        for (theta, phi) in [(0.0, 0.0), (8.0, 0.0), (-14.0, 0.0), (60.0, 45.0), (-89.9, 0.0), (89.9, 0.0)] {
            let at = field.radiance(Beta::from_source(theta, phi, 1.0)) / truth;
            assert!((at - 1.0).abs() < 1e-6, "{theta} {phi}: {at}");
        }
        for off in [0.0, 4.0, -4.0] {
            assert_eq!(field.radiance(Beta::from_source(-8.0 + off, 0.0, 1.0)), 0.0);
        }
        assert_eq!(cap(0.0, 33.0, 0.0, 180.0), Field::ring(0.0, 90.0));
    }
}
